// Any words after --<knob> or --post set what they say, and say it again as it was, or are an Error.
#include <cstdint>
#include <string_view>

#include "engine/base/error.h"
#include "engine/image/post.h"
#include "engine/scene/knobs.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using namespace etalon;

// "name=value" of a knob; anything else is a chain of passes.
void read(std::string_view text)
{
    const std::size_t sign = text.find('=');
    const std::string_view name = text.substr(0, sign);
    if (sign != std::string_view::npos && find_knob(name) != nullptr) {
        RenderSettings settings, again;
        set_knob(settings, name, text.substr(sign + 1));
        check_knobs(settings);
        set_knob(again, name, knob_value(settings, name));
        assume(knob_value(settings, name) == knob_value(again, name));
        return;
    }
    const std::string said = describe(parse_post(text));
    assume(describe(parse_post(said)) == said);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        read(std::string_view(reinterpret_cast<const char*>(data), size));
    } catch (const Error& error) {
        assume(error.blame() == Blame::input && error.what()[0] != '\0');
    }
    return 0;
}
