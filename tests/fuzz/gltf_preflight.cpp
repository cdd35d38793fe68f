// Any bytes are either refused with an Error that blames the input, or come out with every span inside its buffer.
#include <cstdint>

#include "engine/base/error.h"
#include "engine/scene/preflight.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

// Reads both ends: the address sanitizer knows whether they are ours.
void touch(std::span<const std::byte> bytes)
{
    if (bytes.empty()) return;
    const volatile std::byte* data = bytes.data();
    static_cast<void>(data[0]);
    static_cast<void>(data[bytes.size() - 1]);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace etalon;
    static const std::filesystem::path nowhere = "/dev/null";  // no folder, so that no file is ever read
    static const Limits limits;                                // made once: it asks the system how much memory there is
    try {
        const CheckedGltf checked = preflight(std::as_bytes(std::span(data, size)), nowhere, limits);
        for (const GltfBuffer& buffer : checked.buffers) touch(buffer.bytes);
        for (const GltfImage& image : checked.images)
            if (image.bytes) touch(*image.bytes);
    } catch (const Error& error) {
        assume(error.blame() == Blame::input && error.what()[0] != '\0');
    }
    return 0;
}
