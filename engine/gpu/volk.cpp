// volk's loader of Vulkan functions, compiled here and nowhere else.
#define VOLK_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#include <volk.h>
