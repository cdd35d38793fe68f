// The page docs/limits.md, made from the table of limits: `limits_page` prints it, `limits_page FILE` compares.
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/base/limits.h"

namespace {

using etalon::Limit;

std::string value(const Limit& row, std::uint64_t amount)
{
    if (amount == etalon::kUnlimited) return "–";
    constexpr std::uint64_t kKiB = 1024;
    if (row.unit == "bytes")
        for (const auto& [unit, bytes] : {std::pair("GiB", kKiB * kKiB * kKiB), std::pair("MiB", kKiB * kKiB)})
            if (amount % bytes == 0) return fmt::format("{} {}", amount / bytes, unit);
    std::string digits = std::to_string(amount);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ',');
    return digits;
}

std::string page()
{
    std::string text = R"(# Limits
Made from the table in `engine/base/limits.cpp` by `build/dev/tools/limits_page > docs/limits.md`; a test compares them.

What a scene asks for is refused before it is allocated. `--limits strict` suits files of strangers, `--limits none` lifts what only
guards time and memory ("–"); without the rest a reader would overrun its stack or its integers. What is over a limit of this table is a fault of the
input: exit code 2, with the place in the file.

| limit | at most so much of | standard | strict | none | why |
| --- | --- | --: | --: | --: | --- |
)";
    for (const Limit& row : etalon::limit_table())
        text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", row.name, row.bounds, value(row, row.standard),
                            value(row, row.strict), value(row, row.none), row.why);
    text += R"(
## Memory
`--memory N` (as `800M` or `4G`) is what a run may need in all; by default three quarters of the machine's memory, or of what its control group
(version 1 or 2) or the limit on its address space leave. What it will need is predicted, from the size of the picture before anything is read, and from the
scene before a device is made; more than N is refused with both figures and exit code 3. `--limits none` lifts this too. `etalon info SCENE` shows what each renderer would need.

With `render --degrade` what needs more is made smaller instead: the sides of all textures or those of the picture, whichever take more, are halved until it fits. A warning, `--json` and the
metadata of the picture then say what was given up and how far it changes the texels (RMS, relative to their mean); the picture's error says that it does not hold this bias, which nobody
has measured. A scene is still read whole first, as far as the limits above let it.

| held for | raster | path | reference | reference-raster |
| --- | --: | --: | --: | --: |
| libraries, driver and compiler, MiB | 220 | 210 | 134 | 134 |
| a pixel, bytes | 20 + 24 a sample | 396 | 304 | 39 |
| … with `--aovs` | + 200 | + 200 | + 200 | + 200 |
| a byte of vertex attributes and indices, bytes | 3.6 | 1 | 1 | 1 |
| a triangle each time it is shown, bytes | – | 136 | 316 | 468 |
| a texel of 8 bits a channel, bytes | 20 | 12 | 8 | 16 |

These are differences of peak resident sizes (2026-11-23, lavapipe 22.3.6): pictures of 512² against 1536², grids of 245,000 against 980,000 triangles, one against four textures of
2048². On a GPU part of it is the device's; Etalon then asks as if it were the host's.
)";
    return text;
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 2) return std::fputs(page().c_str(), stdout) < 0 ? 3 : 0;
    std::ifstream file(argv[1]);
    const std::string is{std::istreambuf_iterator<char>(file), {}};
    if (is == page()) return 0;
    std::fprintf(stderr, "%s is not what the table says: limits_page > %s\n", argv[1], argv[1]);
    return 1;
}
