// Linked into every program of a build with the address sanitizer: libraries that were loaded stay mapped, so that LSan
// can name the frames of a Vulkan driver in its stacks and does not take what the driver still holds for lost.
extern "C" int dlclose(void*)
{
    return 0;
}

// The validation layer (1.3.239) loses objects of its own whenever a device dies: 929225 bytes in 1942 pieces over the
// device tests, every one with the layer in its stack. Objects that we fail to destroy do not hide behind it: the layer
// names each at vkDestroyDevice, and the tests fail on any message. That holds for lavapipe (22.3.6) too, which loses
// two of its own objects where an allocation fails while a third is made. OSMesa (22.3.6) keeps the framebuffer of
// every context it ever had, 480 bytes. And glibc 2.36's setlocale keeps the parts of LOCPATH.
extern "C" const char* __lsan_default_suppressions()
{
    return "leak:libVkLayer_khronos_validation.so\nleak:libvulkan_lvp.so\nleak:libOSMesa.so\nleak:__argz_add_sep\n";
}

// Of a library that was loaded later and has threads (OpenImageIO) LSan follows thread-local storage that is gone by
// then, and dies of it.
extern "C" const char* __asan_default_options()
{
    return "intercept_tls_get_addr=0";
}
