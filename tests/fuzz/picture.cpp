// Any bytes are a picture for a texture, of the size that was decided from its header, or an Error.
#include <cstdint>

#include "engine/base/error.h"
#include "engine/image/io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace etalon;
    static const Limits limits = [] {
        Limits made;
        made.image_pixels = 1 << 16;  // the same code as for 2^28, at the speed of a fuzzer
        return made;
    }();
    try {
        const Texels texels = decode_texels(std::as_bytes(std::span(data, size)), "fuzz", limits);
        const std::size_t values = 4 * std::size_t(texels.width) * std::size_t(texels.height);
        assume(values > 0 && values <= 4 * limits.image_pixels);
        assume((texels.is_8_bit ? texels.bytes.size() : texels.wide.size()) == values);
    } catch (const Error& error) {
        assume(error.blame() == Blame::input && error.what()[0] != '\0');
    }
    return 0;
}
