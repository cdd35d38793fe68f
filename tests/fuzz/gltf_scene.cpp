// Any bytes become a Scene that can be posed and described, or an Error.
#include <cstdint>

#include "engine/base/error.h"
#include "engine/scene/inventory.h"
#include "engine/scene/load.h"
#include "engine/scene/pose.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace etalon;
    static const std::filesystem::path nowhere = "/dev/null";  // no folder, so that no file is ever read
    static const LoadOptions options = [] {  // made once: limits ask the system how much memory there is
        LoadOptions made;
        made.limits.zero_filled_bytes = 1 << 16;  // the same code as for 256 MB, at the speed of a fuzzer
        return made;
    }();
    try {
        const Scene scene = parse_gltf(std::as_bytes(std::span(data, size)), nowhere, "fuzz", options);
        static_cast<void>(describe(scene));
        PoseSettings settings;
        settings.no_environment = true;  // painting the studio's picture would take most of the time
        settings.time = 0.25;
        static_cast<void>(pose(scene, settings));
    } catch (const Error& error) {
        assume(error.blame() == Blame::input && error.what()[0] != '\0');
    }
    return 0;
}
