#include "tools/etalon/scenes.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/scene/load.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

std::vector<std::byte> read_stdin()
{
    constexpr std::size_t kMost = std::size_t{4} << 30;  // GLB counts its bytes in 32 bits
    std::vector<std::byte> bytes;
    std::array<std::byte, 65536> block;
    while (const std::size_t size = std::fread(block.data(), 1, block.size(), stdin)) {
        if (bytes.size() + size > kMost) throw Error(Blame::input, "standard input holds more than 4 GiB");
        bytes.insert(bytes.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(size));
    }
    if (bytes.empty()) throw Error(Blame::input, "standard input is empty", "pipe a .glb into it");
    return bytes;
}

}  // namespace

Scene open_scene(const std::string& argument, const Arguments& arguments)
{
    check_picture(arguments);
    LoadOptions options{.strict = arguments.has("strict"), .limits = limits(arguments)};
    if (const auto variant = arguments.text("variant")) options.variant = *variant;
    Scene scene =
        argument == "-" ? parse_gltf(read_stdin(), {}, "standard input", options) : load_scene(argument, options);
    const Terminal terminal = Terminal::of_standard_error();
    for (const std::string& warning : scene.warnings) warn(terminal, fmt::format("{}: {}", argument, warning));
    if (!scene.broken_rules.empty())
        warn(terminal,
             fmt::format("{}: breaks {} {} of glTF without harm to the picture (etalon info lists them)", argument,
                         scene.broken_rules.size(), scene.broken_rules.size() == 1 ? "rule" : "rules"));
    return scene;
}

std::string short_name(const std::string& argument)
{
    if (argument == "-") return "stdin";
    if (argument.starts_with(kBuiltinPrefix)) return argument.substr(kBuiltinPrefix.size());
    const std::string stem = std::filesystem::path(argument).stem().string();
    return stem.empty() ? "scene" : stem;
}

std::string with_name(const std::string& pattern, const std::string& name)
{
    constexpr std::string_view kPlaceholder = "{name}";
    std::string out = pattern;
    for (std::size_t at = 0; (at = out.find(kPlaceholder, at)) != std::string::npos; at += name.size())
        out.replace(at, kPlaceholder.size(), name);
    return out;
}

}  // namespace etalon::cli
