#include "engine/measure/diff.h"

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/output.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

CompareSettings compare_settings(const Arguments& arguments)
{
    constexpr double kMost = 1e30;
    CompareSettings settings;
    settings.false_alarm = arguments.number("false-alarm", 1e-12, 0.5).value_or(settings.false_alarm);
    settings.budgets = {.rmse = arguments.number("max-rmse", 0, kMost),
                        .relmse = arguments.number("max-relmse", 0, kMost),
                        .psnr = arguments.number("min-psnr", 0, kMost),
                        .ssim = arguments.number("min-ssim", -1, 1),
                        .flip = arguments.number("max-flip", 0, 1),
                        .max = arguments.number("max-difference", 0, kMost),
                        .mean_relative = arguments.number("max-relative", 0, kMost)};
    return settings;
}

}  // namespace

int diff(const Arguments& arguments)
{
    const CompareSettings settings = compare_settings(arguments);
    const std::string& a = arguments.positional()[0];
    const std::string& b = arguments.positional()[1];
    const std::optional<std::string> output = arguments.text("output");
    if (output == "-" && arguments.has("json"))
        throw Error(Blame::input, "-o - and --json both want standard output", "leave one of them out");
    if (output) check_output(*output);

    const FileDiff result = diff_files(a, b, settings);
    if (output == "-")
        put(encode_png(relative_difference_picture(result.a, result.b), {}));
    else if (output)
        write_png(relative_difference_picture(result.a, result.b), {{"etalon:difference", a + " - " + b}}, *output);
    if (arguments.has("json"))
        put(diff_json(result, a, b));
    else if (output != "-")
        put(diff_table(result));
    return passed(result.comparison.verdict) ? 0 : 1;
}

}  // namespace etalon::cli
