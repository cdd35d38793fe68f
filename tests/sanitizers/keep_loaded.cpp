// Linked into every program of a build with the address sanitizer: libraries that were loaded stay mapped, so that LSan
// can name the frames of a Vulkan driver in its stacks and does not take what the driver still holds for lost.
extern "C" int dlclose(void*)
{
    return 0;
}
