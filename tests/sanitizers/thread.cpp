// Linked into every program of a build with the thread sanitizer, which cannot see the atomics of libraries that were
// not built with it. Both were seen in the device tests, each with the library's frames alone below our Vulkan call:
// lavapipe (Mesa 22.3.6) counts references to its fences, and destroying one looks like a race with its last use;
// the validation layer (1.3.239) takes locks of its queue threads in two orders, in one process in six; OpenImageIO
// (2.4.7) hands jobs to the threads of its pool without a lock.
extern "C" const char* __tsan_default_suppressions()
{
    return "race:libvulkan_lvp.so\n"
           "race:libOpenImageIO_Util.so\n"
           "deadlock:libVkLayer_khronos_validation.so\n";
}
