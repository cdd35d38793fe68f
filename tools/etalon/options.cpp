#include "tools/etalon/options.h"

#include <algorithm>
#include <numeric>

#include "tools/etalon/knob_options.h"

namespace etalon::cli {
namespace {

using Rows = std::vector<Option>;

const Rows& view_rows()
{
    static const Rows rows = {
        {.name = "size", .argument = "WxH", .help = "Picture size in pixels; the scene's own hint or 1280x720 when absent", .heading = "View"},
        {.name = "scene", .argument = "N", .help = "Which of the file's scenes, from 0; the file's default when absent", .heading = "View"},
        {.name = "camera", .argument = "NAME|INDEX", .help = "Which camera; the first when absent, framed when there is none", .heading = "View"},
        {.name = "orbit", .argument = "AZ,EL[,DIST]", .help = "Look at the scene's centre from this azimuth and elevation in degrees, this far in metres", .heading = "View"},
    };
    return rows;
}

const Rows& light_rows()
{
    static const Rows rows = {
        {.name = "environment", .argument = "FILE|none", .help = "Equirectangular EXR or HDR that replaces the scene's environment", .completes = Completes::file, .heading = "Light"},
        {.name = "environment-rotation", .argument = "D", .help = "Turn the environment about the vertical by D degrees", .standard = "0", .heading = "Light"},
        {.name = "environment-intensity", .argument = "X", .help = "Multiply the environment's radiance by X", .standard = "1", .heading = "Light"},
        {.name = "background", .argument = "transparent|COLOUR|environment", .help = "What shows where nothing is hit; COLOUR is #rrggbb (sRGB) or r,g,b (linear)", .standard = "environment", .heading = "Light"},
    };
    return rows;
}

const Rows& shading_rows()
{
    static const Rows rows = {
        {.name = "shading", .argument = "MODEL", .help = "Shading model", .standard = "auto", .choices = {"auto", "blinn-phong", "pbr"}, .heading = "Light"},
    };
    return rows;
}

const Rows& sampling_rows()
{
    static const Rows rows = [] {
        Rows all = knob_rows();
        all.push_back({.name = "seed", .argument = "S", .help = "Seed of the random numbers: same seed, device and build, same bits", .standard = "0", .heading = "Speed and accuracy"});
        return all;
    }();
    return rows;
}

const Rows& develop_rows()
{
    static const Rows rows = {
        {.name = "exposure", .argument = "EV", .help = "Multiply radiance by 2^EV before it becomes a picture", .standard = "0", .heading = "Picture"},
        {.name = "tone", .argument = "CURVE", .help = "Curve from radiance to the display", .standard = "none", .choices = {"none", "aces", "neutral"}, .heading = "Picture"},
    };
    return rows;
}

const Rows& device_rows()
{
    static const Rows rows = {
        {.name = "device", .argument = "N|NAME", .help = "Vulkan device by its number in `etalon info` or part of its name", .heading = "Device"},
        {.name = "require-device", .argument = "KIND", .help = "Fail with exit code 3 unless the device is of this kind", .choices = {"cpu", "gpu"}, .heading = "Device"},
        {.name = "validate", .help = "Run under the Vulkan validation layers; any message of theirs is an error", .heading = "Device"},
    };
    return rows;
}

const Rows& load_rows()
{
    static const Rows rows = {
        {.name = "strict", .help = "Warnings about the scene or the picture become errors", .heading = "Behaviour"},
    };
    return rows;
}

const Rows& json_rows()
{
    static const Rows rows = {
        {.name = "json", .help = "Print the result, or the error, as JSON on standard output", .heading = "Behaviour"},
    };
    return rows;
}

const Rows& progress_rows()
{
    static const Rows rows = {
        {.name = "progress", .argument = "FORM", .help = "How progress is shown on standard error: auto is a bar on a terminal, lines elsewhere", .standard = "auto", .choices = {"auto", "bar", "plain", "json", "none"}, .heading = "Behaviour"},
    };
    return rows;
}

const Rows& help_rows()
{
    static const Rows rows = {{.name = "help", .letter = 'h', .help = "Show this help", .heading = "Behaviour"}};
    return rows;
}

Rows together(std::initializer_list<Rows> groups)
{
    Rows all;
    for (const Rows& rows : groups) all.insert(all.end(), rows.begin(), rows.end());
    all.insert(all.end(), help_rows().begin(), help_rows().end());
    return all;
}

Command render_command()
{
    return {
        .name = "render",
        .summary = "Render scenes to pictures",
        .description = "Renders each SCENE (a .gltf or .glb file, builtin:NAME, or - for a GLB on standard input) into a picture. A path-traced "
                       "picture says its estimated error with a 95% interval. Ctrl-C finishes the current pass and writes what there is.",
        .argument = "SCENE...",
        .least = 1,
        .most = 100'000,
        .options = together({{{.name = "output", .letter = 'o', .argument = "FILE", .help = "Where to: .png (developed), .exr (radiance, variance, AOVs) or - (PNG on standard output); {name} is the scene's name; may be repeated", .completes = Completes::file, .repeats = true, .heading = "Output"},
                              {.name = "renderer", .letter = 'r', .argument = "NAME", .help = "Vulkan rasterizer, Vulkan path tracer, or the CPU reference of either", .standard = "raster", .choices = {"raster", "path", "reference", "reference-raster"}, .heading = "Output"},
                              {.name = "aovs", .help = "Also put depth, normal, albedo, emission, object and material id and uv into .exr files", .heading = "Output"}},
                             view_rows(), light_rows(), shading_rows(), sampling_rows(), develop_rows(), device_rows(), load_rows(), json_rows(), progress_rows()}),
        .examples = {{"etalon render chair.glb -o chair.png", "The rasterizer's picture of a file"},
                     {"etalon render builtin:cornell --renderer path --spp 256 -o cornell.png -o cornell.exr", "A path-traced picture, with its radiance and error"},
                     {"etalon render a.glb b.glb --size 640x480 -o 'out/{name}.png'", "Several scenes with one device start-up"},
                     {"cat chair.glb | etalon render - -o - > chair.png", "From standard input to standard output"}},
        .exit_codes = "0 written; 1 a finding under --strict; 2 bad usage or input; 3 the machine cannot; 130 interrupted",
        .run = render,
    };
}

Command compare_command()
{
    return {
        .name = "compare",
        .summary = "Render a scene with every renderer and measure how much they disagree",
        .description = "Renders SCENE with the Vulkan rasterizer, the Vulkan path tracer and the CPU reference of both, compares them (by statistics where "
                       "both sides carry variance), prints a table and writes pictures, difference pictures, report.json and report.html.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({{{.name = "output", .letter = 'o', .argument = "FOLDER", .help = "Where the report goes; out/NAME of the scene when absent", .completes = Completes::folder, .heading = "Output"},
                              {.name = "renderers", .argument = "LIST", .help = "Which renderers take part, separated by commas", .standard = "raster,path,reference,reference-raster", .heading = "Output"},
                              {.name = "false-alarm", .argument = "P", .help = "How often two equal renderers would be called different", .standard = "0.001", .heading = "Verdict"}},
                             view_rows(), light_rows(), shading_rows(), sampling_rows(), develop_rows(), device_rows(), load_rows(), json_rows(), progress_rows()}),
        .examples = {{"etalon compare builtin:cornell -o out/cornell", "All renderers on a bundled scene"},
                     {"etalon compare chair.glb --renderers path,reference --spp 256 --size 256x256", "The path tracer against the reference only"}},
        .exit_codes = "0 they agree; 1 they do not; 2 bad usage or input; 3 the machine cannot; 130 interrupted",
        .run = compare,
    };
}

Command diff_command()
{
    return {
        .name = "diff",
        .summary = "Compare two picture files",
        .description = "Compares A with B, the one trusted more. Films (.exr written by etalon) that carry variance are compared by a statistical test with a stated "
                       "false-alarm rate; other pictures must be equal, or within the budgets given.",
        .argument = "A B",
        .least = 2,
        .most = 2,
        .completes = Completes::file,
        .options = together({{{.name = "output", .letter = 'o', .argument = "FILE.png", .help = "Write the difference in false colour; - for standard output", .completes = Completes::file, .heading = "Output"},
                              {.name = "false-alarm", .argument = "P", .help = "How often two equal pictures would be called different", .standard = "0.001", .heading = "Verdict"},
                              {.name = "max-rmse", .argument = "X", .help = "Budget: root mean square difference, nit", .heading = "Verdict"},
                              {.name = "max-relmse", .argument = "X", .help = "Budget: relative mean square difference", .heading = "Verdict"},
                              {.name = "max-difference", .argument = "X", .help = "Budget: largest difference of a value, nit", .heading = "Verdict"},
                              {.name = "max-relative", .argument = "X", .help = "Budget: mean difference relative to the mean", .heading = "Verdict"},
                              {.name = "min-psnr", .argument = "DB", .help = "Budget: peak signal to noise ratio of the developed pictures, dB", .heading = "Verdict"},
                              {.name = "min-ssim", .argument = "X", .help = "Budget: structural similarity of the developed pictures", .heading = "Verdict"}},
                             json_rows()}),
        .examples = {{"etalon diff new.exr golden.exr -o difference.png", "By statistics, with a difference picture"},
                     {"etalon diff a.png b.png --min-ssim 0.98 --json", "Within a budget, as JSON"}},
        .exit_codes = "0 equal or within the budgets; 1 different; 2 bad usage or input; 3 the machine cannot",
        .run = diff,
    };
}

Command explain_command()
{
    return {
        .name = "explain",
        .summary = "Say what a picture of a scene requires of a renderer, and why",
        .description = "Prints each requirement of SCENE under these settings with the first object that causes it. Everything a renderer builds "
                       "(vertex attributes, textures, shader code, passes) follows from this list.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({{{.name = "renderer", .letter = 'r', .argument = "NAME", .help = "For which renderer", .standard = "raster", .choices = {"raster", "path", "reference", "reference-raster"}, .heading = "Output"}},
                             view_rows(), light_rows(), shading_rows(), sampling_rows(), load_rows(), json_rows()}),
        .examples = {{"etalon explain chair.glb", "What the rasterizer needs for it"}},
        .exit_codes = "0 fine; 2 bad usage or input; 3 the machine cannot",
        .run = explain,
    };
}

Command info_command()
{
    return {
        .name = "info",
        .summary = "Say what this machine can do, or what a scene holds",
        .description = "Without SCENE: versions, every Vulkan device with the reasons it was or was not chosen, and a proof of each back end (a triangle drawn "
                       "and read back under a time limit); paste it into a bug report. With SCENE: its scenes, cameras, lights, materials, animations, "
                       "variants and the memory it will take.",
        .argument = "[SCENE]",
        .least = 0,
        .most = 1,
        .options = together({device_rows(), load_rows(), json_rows()}),
        .examples = {{"etalon info", "The machine"}, {"etalon info chair.glb --json", "A scene, as JSON"}},
        .exit_codes = "0 fine; 2 bad usage or input; 3 no back end works",
        .run = info,
    };
}

Command view_command()
{
    return {
        .name = "view",
        .summary = "Open a scene in a window",
        .description = "Opens SCENE in a window, drawn by the rasterizer or by the progressive path tracer. Which keys and mouse moves there are is said "
                       "on standard error; Ctrl-C closes it as well.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({{{.name = "renderer", .letter = 'r', .argument = "NAME", .help = "With which renderer the window opens", .standard = "raster", .choices = {"raster", "path"}, .heading = "Output"},
                              {.name = "frames", .argument = "N", .help = "Close after N frames", .heading = "Output"},
                              {.name = "screenshot", .argument = "FILE.png", .help = "Write the last frame shown when the window closes", .completes = Completes::file, .heading = "Output"}},
                             view_rows(), light_rows(), shading_rows(), develop_rows(), device_rows(), load_rows(), json_rows()}),
        .examples = {{"etalon view chair.glb", "Look around a file"}, {"etalon view builtin:cornell --renderer path", "Watch the path tracer converge"}},
        .exit_codes = "0 closed; 2 bad usage or input; 3 no display or no device",
        .run = view,
    };
}

Command completion_command()
{
    return {
        .name = "completion",
        .summary = "Print the completion script of a shell",
        .description = "Prints the completion script for bash, zsh or fish on standard output.",
        .argument = "SHELL",
        .least = 1,
        .most = 1,
        .completes = Completes::nothing,
        .options = together({json_rows()}),
        .examples = {{"etalon completion bash > ~/.local/share/bash-completion/completions/etalon", "For bash, from the next shell on"}},
        .exit_codes = "0 fine; 2 unknown shell",
        .run = completion,
    };
}

Command man_command()
{
    return {
        .name = "man",
        .summary = "Print the manual page",
        .description = "Prints the manual page in roff on standard output.",
        .argument = "",
        .completes = Completes::nothing,
        .options = together({json_rows()}),
        .examples = {{"etalon man | man -l -", "Read it"}},
        .exit_codes = "0 fine",
        .run = man,
    };
}

/// Optimal string alignment: insertions, deletions, substitutions and swaps of neighbours, each at cost 1.
std::size_t edit_distance(std::string_view a, std::string_view b)
{
    std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    std::iota(cost[0].begin(), cost[0].end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        cost[i][0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t changed = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, changed});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    }
    return cost[a.size()][b.size()];
}

}  // namespace

const std::vector<Command>& commands()
{
    static const std::vector<Command> all = {render_command(), compare_command(), diff_command(), explain_command(),
                                             info_command(), view_command(), completion_command(), man_command()};
    return all;
}

const Command* find_command(std::string_view name)
{
    const auto found = std::find_if(commands().begin(), commands().end(), [&](const Command& c) { return c.name == name; });
    return found == commands().end() ? nullptr : &*found;
}

const Option* find_option(const Command& command, std::string_view name)
{
    const auto found = std::find_if(command.options.begin(), command.options.end(), [&](const Option& o) { return o.name == name; });
    return found == command.options.end() ? nullptr : &*found;
}

std::string_view nearest(std::string_view word, std::span<const std::string> candidates)
{
    constexpr std::size_t kLongest = 64;  // nothing that long was mistyped from a name of ours
    if (word.size() > kLongest) return {};
    std::string_view best;
    std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = candidate.starts_with(word) && word.size() > 2 ? 1 : edit_distance(word, candidate);
        if (distance < least) {
            least = distance;
            best = candidate;
        }
    }
    return best;
}

}  // namespace etalon::cli
