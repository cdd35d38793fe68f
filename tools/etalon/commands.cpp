#include "tools/etalon/measuring.h"
#include "tools/etalon/option_rows.h"

namespace etalon::cli {
namespace {

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
        .description =
            "Renders each SCENE (a .gltf or .glb file, builtin:NAME, or - for a GLB on standard input) into a "
            "picture. A path-traced picture says its estimated error with a 95% interval. Ctrl-C finishes the "
            "current pass and writes what there is. Of several scenes, one that fails is named and the others go on; "
            "the exit code is then the worst.",
        .argument = "SCENE...",
        .least = 1,
        .most = 100'000,
        .options = together(
            {{{.name = "output",
               .letter = 'o',
               .argument = "FILE",
               .help = "Where to: .png (developed), .exr (radiance, variance, AOVs) or - (PNG on standard output); "
                       "{name} is the scene's name, #### the frame's number; may be repeated",
               .completes = Completes::file,
               .repeats = true,
               .heading = "Output"},
              {.name = "renderer",
               .letter = 'r',
               .argument = "NAME",
               .help = "Vulkan rasterizer, Vulkan path tracer, or the CPU reference of either",
               .standard = "raster",
               .choices = {"raster", "path", "reference", "reference-raster"},
               .heading = "Output"},
              {.name = "max-error",
               .argument = "E",
               .help =
                   "Path tracers: as many samples as the relative standard error E of the picture needs, found by a "
                   "pilot that is not part of the picture; --spp is then the most. The rasterizer: the fastest "
                   "settings that came so near to the path-traced picture when `etalon tradeoff` measured this scene",
               .heading = "Speed and accuracy"},
              {.name = "max-time",
               .argument = "SECONDS",
               .help = "Path tracers: as many samples as fit into this time from the start of the program (of each "
                       "further picture from the end of the one before) to the written file; --spp is then the most. "
                       "The rasterizer: the most accurate settings that `etalon tradeoff` measured to be fast enough",
               .heading = "Speed and accuracy"},
              {.name = "adaptive",
               .argument = "WHAT",
               .help = "The Vulkan path tracer: --spp samples a pixel on average, more where the first 16 saw more "
                       "variance, without bias: to make the picture's error small, or relmse, to which dark parts "
                       "count as much as bright ones",
               .standard = "off",
               .choices = {"off", "error", "relmse"},
               .heading = "Speed and accuracy"},
              {.name = "error",
               .help = "Measure how far the picture is from the light that really reaches its pixels: 2,048 of them "
                       "at random are path-traced by the reference, in 5 seconds at most; the error is said with its "
                       "interval, and goes with a coarse map into the picture's texts and beside it as .error.json",
               .heading = "Output"},
              {.name = "aovs",
               .help = "Also put depth, normal, albedo, emission, object and material id and uv into .exr files",
               .heading = "Output"},
              {.name = "profile",
               .help = "Say what each stage took, the device's passes by its own clock; path tracing is slower for it",
               .heading = "Behaviour"},
              {.name = "degrade",
               .help = "What is predicted to need more than --memory gets smaller textures or a smaller picture, each "
                       "half as wide and high until it fits, and says so; without it, it is refused",
               .heading = "Behaviour"}},
             view_rows(),
             animation_rows(),
             frame_rows(),
             light_rows(),
             shading_rows(),
             sampling_rows(),
             part_rows(),
             post_rows(),
             develop_rows(),
             device_rows(),
             load_rows(),
             json_rows(),
             progress_rows()}),
        .examples = {{"etalon render chair.glb -o chair.png", "The rasterizer's picture of a file"},
                     {"etalon render builtin:cornell --renderer path --spp 256 -o cornell.png -o cornell.exr",
                      "A path-traced picture, with its radiance and error"},
                     {"etalon render builtin:cornell --renderer path --max-error 0.05 -o cornell.exr",
                      "As many samples as an error of 5% needs"},
                     {"etalon render chair.glb --renderer path --max-time 10 -o chair.png",
                      "The best picture that ten seconds allow, with its error"},
                     {"etalon render chair.glb --error -o chair.png",
                      "A rasterized picture that says how far it is from the truth"},
                     {"etalon render builtin:cornell --renderer path --spp 4096 --resume cornell.state -o cornell.exr",
                      "What is interrupted goes on where it stood when the same is typed again"},
                     {"etalon render a.glb b.glb --size 640x480 -o 'out/{name}.png'",
                      "Several scenes with one device start-up"},
                     {"etalon render builtin:cornell --renderer path --spp 16 --post atrous,bloom -o clean.png",
                      "Denoised along surfaces, with some glare"},
                     {"etalon render fox.glb --animation Run --frames 0:47 --fps 24 -o 'out/####.png'",
                      "Two seconds of an animation"},
                     {"cat chair.glb | etalon render - -o - > chair.png", "From standard input to standard output"}},
        .exit_codes =
            "0 written; 1 a finding under --strict; 2 bad usage or input; 3 the machine cannot; 130 interrupted (143 "
            "by SIGTERM, 129 by SIGHUP)",
        .run = render,
    };
}

Command merge_command()
{
    return {
        .name = "merge",
        .summary = "Make one picture of shards",
        .description =
            "Puts the films that `etalon render --shard I/N -o FILE.exr` wrote together again, in any order. The "
            "picture has the bits that one run would have given it. A shard that is missing is named; one that is "
            "given twice, damaged, or of another picture is refused.",
        .argument = "SHARD.exr...",
        .least = 1,
        .most = 1'000'000,
        .completes = Completes::file,
        .options =
            together({{{.name = "output",
                        .letter = 'o',
                        .argument = "FILE",
                        .help = "Where to: .exr, .png (developed) or - (PNG on standard output); may be repeated",
                        .completes = Completes::file,
                        .repeats = true,
                        .heading = "Output"}},
                      develop_rows(),
                      json_rows()}),
        .examples = {{"etalon merge part1.exr part2.exr part3.exr -o whole.exr", "Three shards as one film"}},
        .exit_codes = "0 merged; 2 bad usage or input; 3 the machine cannot",
        .run = merge,
    };
}

Command compare_command()
{
    return {
        .name = "compare",
        .summary = "Render a scene with every renderer and measure how much they disagree",
        .description =
            "Renders SCENE with the Vulkan rasterizer, the Vulkan path tracer and the CPU reference of both, "
            "compares them (by statistics where both sides carry variance), prints a table and writes pictures, "
            "difference pictures, report.json and report.html.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({{{.name = "output",
                               .letter = 'o',
                               .argument = "FOLDER",
                               .help = "Where the report goes; out/NAME of the scene when absent",
                               .completes = Completes::folder,
                               .heading = "Output"},
                              {.name = "renderers",
                               .argument = "LIST",
                               .help = "Which renderers take part, separated by commas",
                               .standard = "raster,path,reference,reference-raster",
                               .heading = "Output"},
                              {.name = "false-alarm",
                               .argument = "P",
                               .help = "How often two equal renderers would be called different",
                               .standard = "0.001",
                               .heading = "Verdict"}},
                             view_rows(),
                             animation_rows(),
                             light_rows(),
                             shading_rows(),
                             sampling_rows(),
                             develop_rows(),
                             device_rows(),
                             load_rows(),
                             json_rows(),
                             progress_rows()}),
        .examples = {{"etalon compare builtin:cornell -o out/cornell", "All renderers on a bundled scene"},
                     {"etalon compare chair.glb --renderers path,reference --spp 256 --size 256x256",
                      "The path tracer against the reference only"}},
        .exit_codes =
            "0 they agree; 1 they do not; 2 bad usage or input; 3 the machine cannot; 130 interrupted (143 by SIGTERM, "
            "129 by SIGHUP)",
        .run = compare,
    };
}

Command diff_command()
{
    return {
        .name = "diff",
        .summary = "Compare two picture files",
        .description =
            "Compares A with B, the one trusted more. Films (.exr written by etalon) that carry variance are "
            "compared by a statistical test with a stated false-alarm rate; other pictures must be equal, or within "
            "the budgets given.",
        .argument = "A B",
        .least = 2,
        .most = 2,
        .completes = Completes::file,
        .options = together({{{.name = "output",
                               .letter = 'o',
                               .argument = "FILE.png",
                               .help = "Write the difference in false colour; - for standard output",
                               .completes = Completes::file,
                               .heading = "Output"},
                              {.name = "false-alarm",
                               .argument = "P",
                               .help = "How often two equal pictures would be called different",
                               .standard = "0.001",
                               .heading = "Verdict"},
                              {.name = "max-rmse",
                               .argument = "X",
                               .help = "Budget: root mean square difference, nit",
                               .heading = "Verdict"},
                              {.name = "max-relmse",
                               .argument = "X",
                               .help = "Budget: relative mean square difference",
                               .heading = "Verdict"},
                              {.name = "max-difference",
                               .argument = "X",
                               .help = "Budget: largest difference of a value, nit",
                               .heading = "Verdict"},
                              {.name = "max-relative",
                               .argument = "X",
                               .help = "Budget: mean difference relative to the mean",
                               .heading = "Verdict"},
                              {.name = "min-psnr",
                               .argument = "DB",
                               .help = "Budget: peak signal to noise ratio of the developed pictures, dB",
                               .heading = "Verdict"},
                              {.name = "min-ssim",
                               .argument = "X",
                               .help = "Budget: structural similarity of the developed pictures",
                               .heading = "Verdict"},
                              {.name = "max-flip",
                               .argument = "X",
                               .help = "Budget: mean FLIP of the developed pictures, 0 to 1: what an eye sees when "
                                       "they are flipped in place",
                               .heading = "Verdict"}},
                             json_rows()}),
        .examples = {{"etalon diff new.exr golden.exr -o difference.png", "By statistics, with a difference picture"},
                     {"etalon diff a.png b.png --min-ssim 0.98 --json", "Within a budget, as JSON"}},
        .exit_codes = "0 equal or within the budgets; 1 different; 2 bad usage or input; 3 the machine cannot",
        .run = diff,
    };
}

Command tradeoff_command()
{
    return {
        .name = "tradeoff",
        .summary = "Measure what each speed/accuracy setting buys and costs on a scene",
        .description =
            "Renders SCENE again and again with other settings, one knob at a time and several at once, times each "
            "picture and measures its error against a path-traced reference. Prints the settings that nothing else "
            "beats in both (the frontier) and writes a page with the plot, the pictures and all values. Other work on "
            "the machine widens the intervals.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options =
            together({measuring_rows("tradeoff", "How long to measure",
                                     "At most 15 seconds, 3 rounds, and one knob at a time only", "Whose settings"),
                      {{.name = "no-cache",
                        .help = "Make the reference anew and do not keep it; else it goes into the user's cache "
                                "(512 MiB at most), by the content of the scene, the settings and the build",
                        .heading = "Measuring"}},
                      view_rows(),
                      animation_rows(),
                      light_rows(),
                      shading_rows(),
                      sampling_rows(),
                      develop_rows(),
                      device_rows(),
                      load_rows(),
                      json_rows(),
                      progress_rows()}),
        .examples = {{"etalon tradeoff chair.glb",
                      "A minute's measurement, and the page out/chair-tradeoff/tradeoff.html"},
                     {"etalon tradeoff builtin:cornell --renderer path --budget 300 --json", "The path tracer alone"}},
        .exit_codes = "0 measured; 2 bad usage or input; 3 the machine cannot; 130 interrupted",
        .run = tradeoff,
    };
}

Command stability_command()
{
    return {
        .name = "stability",
        .summary = "Find out where a scene's picture holds under harmless changes, and where it breaks",
        .description =
            "Changes SCENE in ways that must leave its picture alone (scale, distance from the origin, order of "
            "triangles, brightness against exposure and more), by more and more, and compares: path-traced pictures by "
            "statistics, rasterized ones within the derived budget. Says for each change up to what size the picture "
            "holds and where it breaks.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({measuring_rows("stability", "How long to try",
                                            "At most 15 seconds, and only the promised ranges", "Which renderer"),
                             {{.name = "false-alarm",
                               .argument = "P",
                               .help = "How often a scene that holds would be said to break, over the whole table",
                               .standard = "0.001",
                               .heading = "Measuring"}},
                             view_rows(),
                             animation_rows(),
                             light_rows(),
                             shading_rows(),
                             sampling_rows(),
                             device_rows(),
                             load_rows(),
                             json_rows(),
                             progress_rows()}),
        .examples = {{"etalon stability chair.glb",
                      "A minute's trial, and the page out/chair-stability/stability.html"},
                     {"etalon stability builtin:cornell --quick", "The promised ranges alone"}},
        .exit_codes =
            "0 every promised range holds; 1 one breaks; 2 bad usage or input; 3 the machine cannot; 130 "
            "interrupted",
        .run = stability,
    };
}

Command explain_command()
{
    return {
        .name = "explain",
        .summary = "Say what a picture of a scene requires of a renderer, and why",
        .description =
            "Prints each requirement of SCENE under these settings with the first object that causes it. Everything "
            "a renderer builds (vertex attributes, textures, shader code, passes) follows from this list. Of the "
            "device's renderers also what each costs, and what the scene leaves of their shaders and data; what no "
            "picture shows and is left out; and what the author of the scene could leave out. --measure draws 320x180 "
            "pixels of 4 samples unless --size and --spp say otherwise.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({{{.name = "renderer",
                               .letter = 'r',
                               .argument = "NAME",
                               .help = "For which renderer",
                               .standard = "raster",
                               .choices = {"raster", "path", "reference", "reference-raster"},
                               .heading = "Output"},
                              {.name = "measure",
                               .help = "Also draw the picture, as required, with everything on and without each "
                                       "requirement: what they cost, and whether the pixels are alike to the bit",
                               .heading = "Measuring"},
                              {.name = "budget",
                               .argument = "SECONDS",
                               .help = "How long to measure",
                               .standard = "60",
                               .heading = "Measuring"},
                              {.name = "quick", .help = "At most 15 seconds", .heading = "Measuring"}},
                             view_rows(),
                             animation_rows(),
                             light_rows(),
                             shading_rows(),
                             sampling_rows(),
                             device_rows(),
                             load_rows(),
                             json_rows(),
                             progress_rows()}),
        .examples = {{"etalon explain chair.glb", "What the rasterizer needs for it, and what its author may spare"},
                     {"etalon explain builtin:cornell --renderer path --measure",
                      "What specialising the path tracer saves, and that no pixel changes"}},
        .exit_codes =
            "0 fine; 1 --measure found other pixels; 2 bad usage or input; 3 the machine cannot; 130 interrupted",
        .run = explain,
    };
}

Command info_command()
{
    return {
        .name = "info",
        .summary = "Say what this machine can do, or what a scene holds",
        .description =
            "Without SCENE: versions, every Vulkan device with the reasons it was or was not chosen, and a proof of "
            "each back end (a triangle drawn and read back under a time limit); paste it into a bug report. With "
            "SCENE: its scenes, cameras, lights, materials, animations, variants and the memory it will take.",
        .argument = "[SCENE]",
        .least = 0,
        .most = 1,
        .options = together({device_rows(), load_rows(), json_rows()}),
        .examples = {{"etalon info", "The machine"}, {"etalon info chair.glb --json", "A scene, as JSON"}},
        .exit_codes = "0 fine; 2 bad usage or input; 3 no back end works",
        .run = info,
    };
}

/// A window keeps adding samples while one looks at it, so it stops later than a picture does.
Rows view_sampling_rows()
{
    Rows rows = sampling_rows();
    for (Option& row : rows)
        if (row.name == "spp") row.standard = std::to_string(kViewSamples);
    return rows;
}

Command view_command()
{
    return {
        .name = "view",
        .summary = "Open a scene in a window",
        .description =
            "Opens SCENE in a window, drawn by the rasterizer or by the progressive path tracer. Which keys and "
            "mouse moves there are is said on standard error; Ctrl-C closes it as well.",
        .argument = "SCENE",
        .least = 1,
        .most = 1,
        .options = together({{{.name = "renderer",
                               .letter = 'r',
                               .argument = "NAME",
                               .help = "With which renderer the window opens",
                               .standard = "raster",
                               .choices = {"raster", "path"},
                               .heading = "Output"},
                              {.name = "frames", .argument = "N", .help = "Close after N frames", .heading = "Output"},
                              {.name = "screenshot",
                               .argument = "FILE.png",
                               .help = "Write the last frame shown when the window closes",
                               .completes = Completes::file,
                               .heading = "Output"}},
                             view_rows(),
                             animation_rows(),
                             light_rows(),
                             shading_rows(),
                             view_sampling_rows(),
                             develop_rows(),
                             device_rows(),
                             load_rows(),
                             json_rows()}),
        .examples = {{"etalon view chair.glb", "Look around a file"},
                     {"etalon view builtin:cornell --renderer path", "Watch the path tracer converge"}},
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
        .examples = {{"etalon completion bash > ~/.local/share/bash-completion/completions/etalon",
                      "For bash, from the next shell on"}},
        .exit_codes = "0 fine; 2 unknown shell",
        .run = completion,
    };
}

Command post_command()
{
    return {
        .name = "post",
        .summary = "Apply post passes to a film",
        .description =
            "Reads FILM (.exr, as render writes it), applies the passes of --post on the Vulkan device, or in double "
            "precision on the CPU with --reference, and writes the result.",
        .argument = "FILM.exr",
        .least = 1,
        .most = 1,
        .completes = Completes::file,
        .options =
            together({{{.name = "output",
                        .letter = 'o',
                        .argument = "FILE",
                        .help = "Where to: .exr, .png (developed) or - (PNG on standard output); may be repeated",
                        .completes = Completes::file,
                        .repeats = true,
                        .heading = "Output"},
                       {.name = "reference", .help = "Without a device: in double precision", .heading = "Device"}},
                      post_rows(),
                      develop_rows(),
                      device_rows(),
                      json_rows()}),
        .examples = {{"etalon post fox.exr --post outline -o lines.png", "Lines along silhouettes and creases"},
                     {"etalon post noisy.exr --post atrous,exposure,tone:curve=agx,fxaa -o shown.png",
                      "Denoised, exposed by its histogram, and toned before its edges are smoothed"}},
        .exit_codes = "0 written; 2 bad usage or input; 3 the machine cannot",
        .run = post,
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

}  // namespace

const std::vector<Command>& commands()
{
    static const std::vector<Command> all = {render_command(),    merge_command(),      post_command(),
                                             compare_command(),   diff_command(),       tradeoff_command(),
                                             stability_command(), explain_command(),    info_command(),
                                             view_command(),      completion_command(), man_command()};
    return all;
}

}  // namespace etalon::cli
