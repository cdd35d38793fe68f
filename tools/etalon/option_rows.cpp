#include "tools/etalon/option_rows.h"

#include <fmt/format.h>

#include "engine/image/post.h"
#include "tools/etalon/knob_options.h"

namespace etalon::cli {

const Rows& view_rows()
{
    static const Rows rows = {
        {.name = "size",
         .argument = "WxH",
         .help = "Picture size in pixels; the scene's own hint or 1280x720 when absent",
         .heading = "View"},
        {.name = "scene",
         .argument = "N",
         .help = "Which of the file's scenes, from 0; the file's default when absent",
         .heading = "View"},
        {.name = "camera",
         .argument = "NAME|INDEX",
         .help = "Which camera; the first when absent, framed when there is none",
         .heading = "View"},
        {.name = "orbit",
         .argument = "AZ,EL[,DIST]",
         .help = "Look at the scene's centre from this azimuth and elevation in degrees, this far in metres",
         .heading = "View"},
        {.name = "projection",
         .argument = "KIND",
         .help = "camera: as the camera has it; orthographic: as large as what is as far away as the scene's centre; "
                 "equirectangular: all directions, for path tracers",
         .standard = "camera",
         .choices = {"camera", "orthographic", "equirectangular"},
         .heading = "View"},
        {.name = "lens",
         .argument = "F[,FOCUS[,BLADES]]",
         .help = "Path tracers: a lens of this f-stop (on a film 24 mm high), focused at FOCUS metres (the scene's "
                 "centre when absent), with a polygonal aperture of 3 to 64 BLADES (round when absent)",
         .heading = "View"},
    };
    return rows;
}

const Rows& animation_rows()
{
    static const Rows rows = {
        {.name = "time",
         .argument = "T",
         .help = "Pose the scene as its animation has it at T seconds; its rest pose when absent",
         .heading = "Animation"},
        {.name = "animation",
         .argument = "NAME|INDEX|all",
         .help = "Which of the file's animations, as `etalon info SCENE` lists them; the first when absent",
         .heading = "Animation"},
    };
    return rows;
}

const Rows& frame_rows()
{
    static const Rows rows = {
        {.name = "frames",
         .argument = "A:B",
         .help = "A picture of each frame from A to B; frame n shows the animation at n/fps seconds",
         .heading = "Animation"},
        {.name = "fps",
         .argument = "N",
         .help = "Frames a second of --frames",
         .standard = "24",
         .heading = "Animation"},
    };
    return rows;
}

const Rows& light_rows()
{
    static const Rows rows = {
        {.name = "environment",
         .argument = "FILE|none",
         .help = "Equirectangular EXR or HDR that replaces the scene's environment",
         .completes = Completes::file,
         .heading = "Light"},
        {.name = "environment-rotation",
         .argument = "D",
         .help = "Turn the environment about the vertical by D degrees",
         .standard = "0",
         .heading = "Light"},
        {.name = "environment-intensity",
         .argument = "X",
         .help = "Multiply the environment's radiance by X",
         .standard = "1",
         .heading = "Light"},
        {.name = "background",
         .argument = "transparent|COLOUR|environment",
         .help = "What shows where nothing is hit; COLOUR is #rrggbb (sRGB) or r,g,b (linear)",
         .standard = "environment",
         .heading = "Light"},
    };
    return rows;
}

const Rows& shading_rows()
{
    static const Rows rows = {
        {.name = "shading",
         .argument = "MODEL",
         .help = "Shading model",
         .standard = "auto",
         .choices = {"auto", "blinn-phong", "pbr"},
         .heading = "Light"},
    };
    return rows;
}

const Rows& sampling_rows()
{
    static const Rows rows = [] {
        Rows all = knob_rows();
        all.push_back({.name = "seed",
                       .argument = "S",
                       .help = "Seed of the random numbers: same seed, device and build, same bits",
                       .standard = "0",
                       .heading = "Speed and accuracy"});
        return all;
    }();
    return rows;
}

const Rows& part_rows()
{
    static const Rows rows = {
        {.name = "resume",
         .argument = "FILE",
         .help = "Path tracers: take up the samples that FILE holds, if it is there, and keep all of them in it, to "
                 "go on later with a larger --spp; the picture has the bits of one run. {name} and #### as in -o",
         .completes = Completes::file,
         .heading = "Speed and accuracy"},
        {.name = "checkpoint",
         .argument = "S",
         .help = "With --resume: also write FILE every S seconds, so that no more is ever lost",
         .standard = "60",
         .heading = "Speed and accuracy"},
        {.name = "shard",
         .argument = "I/N",
         .help = "Path tracers: part I of N of the picture's rows alone; `etalon merge` makes one picture of all N, "
                 "with the bits of one run",
         .heading = "Speed and accuracy"},
    };
    return rows;
}

namespace {

/// Of every pass and each of its parameters, as the table has them.
std::vector<Detail> post_details()
{
    std::vector<Detail> details;
    for (const PostPass& pass : post_passes()) {
        details.push_back({std::string(pass.name), std::string(pass.what)});
        for (const PostParameter& parameter : pass.parameters)
            details.push_back({fmt::format("  {}={}", parameter.name, value_text(parameter, parameter.standard)),
                               fmt::format("{} ({})", parameter.what, range_of(parameter))});
    }
    return details;
}

}  // namespace

const Rows& post_rows()
{
    static const Rows rows = {
        {.name = "post",
         .argument = "PASSES",
         .help = "Passes over the finished film, in the order given: sobel,bilateral:sigma_s=3,sigma_r=0.1. Unless all "
                 "of them scale it, the picture's error is no longer known. Passes, their parameters and standards",
         .heading = "Picture",
         .details = post_details()},
    };
    return rows;
}

const Rows& develop_rows()
{
    static const Rows rows = {
        {.name = "exposure",
         .argument = "EV",
         .help = "Multiply radiance by 2^EV before it becomes a picture",
         .standard = "0",
         .heading = "Picture"},
        {.name = "tone",
         .argument = "CURVE",
         .help = "Curve from radiance to the display",
         .standard = "none",
         .choices = {"none", "aces", "neutral", "reinhard", "agx"},
         .heading = "Picture"},
    };
    return rows;
}

const Rows& device_rows()
{
    static const Rows rows = {
        {.name = "backend",
         .argument = "NAME",
         .help =
             "What draws: auto is Vulkan, and OpenGL for the rasterizer where Vulkan does not work and no device was "
             "named",
         .standard = "auto",
         .choices = {"auto", "vulkan", "opengl"},
         .heading = "Device"},
        {.name = "device",
         .argument = "N|NAME",
         .help = "Device of the backend by its number in `etalon info` or part of its name",
         .heading = "Device"},
        {.name = "require-device",
         .argument = "KIND",
         .help = "Fail with exit code 3 unless the device is of this kind",
         .choices = {"cpu", "gpu"},
         .heading = "Device"},
        {.name = "validate",
         .help = "Run under the Vulkan validation layers, or listen to OpenGL's debug messages; any is an error",
         .heading = "Device"},
    };
    return rows;
}

const Rows& load_rows()
{
    static const Rows rows = {
        {.name = "variant",
         .argument = "NAME",
         .help = "Which of the file's material variants, as `etalon info SCENE` lists them; none when absent",
         .heading = "View"},
        {.name = "limits",
         .argument = "LEVEL",
         .help = "How much a scene may ask for before it is refused (docs/limits.md); strict suits files of strangers",
         .standard = "standard",
         .choices = {"none", "standard", "strict"},
         .heading = "Behaviour"},
        {.name = "memory",
         .argument = "N",
         .help = "Bytes that may be needed in all, as 800M or 4G; what is predicted to need more is refused. Three "
                 "quarters of the machine's when absent",
         .heading = "Behaviour"},
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
        {.name = "progress",
         .argument = "FORM",
         .help = "How progress is shown on standard error: auto is a bar on a terminal, lines elsewhere",
         .standard = "auto",
         .choices = {"auto", "bar", "plain", "json", "none"},
         .heading = "Behaviour"},
    };
    return rows;
}

const Rows& help_rows()
{
    static const Rows rows = {{.name = "help", .letter = 'h', .help = "Show this help", .heading = "Behaviour"}};
    return rows;
}

}  // namespace etalon::cli
