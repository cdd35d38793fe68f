#include "engine/measure/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/io.h"

namespace etalon {

bool passed(const Report& report)
{
    const bool finite = std::all_of(report.runs.begin(), report.runs.end(), [](const RendererRun& run) {
        const FilmCheck checked = check(run.film);
        return checked.nan_pixels + checked.inf_pixels == 0;
    });
    return finite && std::all_of(report.comparisons.begin(), report.comparisons.end(),
                                 [](const RunComparison& pair) { return passed(pair.comparison.verdict); });
}

std::string summary(const Report& report)
{
    const auto count = [&](const auto& predicate) {
        return std::count_if(report.comparisons.begin(), report.comparisons.end(),
                             [&](const RunComparison& pair) { return predicate(pair.comparison.verdict); });
    };
    const auto tested = count([](Verdict verdict) { return verdict != Verdict::not_tested; });
    const auto failed = count([](Verdict verdict) { return !passed(verdict); });
    if (report.comparisons.empty()) return "nothing compared";
    const std::string outcome = failed > 0       ? fmt::format("{} {}", failed, failed == 1 ? "fails" : "fail")
                                : passed(report) ? std::string("no fault found")
                                                 : std::string("a picture is not finite");
    return fmt::format("{} of {} {} tested: {}", tested, report.comparisons.size(),
                       report.comparisons.size() == 1 ? "pair" : "pairs", outcome);
}

std::vector<std::filesystem::path> write_report(const Report& report, const std::filesystem::path& folder)
{
    make_folder(folder);
    std::vector<std::filesystem::path> written{folder / "report.html", folder / "report.json"};
    const auto save = [&](const std::string& stem, const Image& picture,
                          const std::map<std::string, std::string>& metadata) {
        written.push_back(folder / (stem + ".png"));
        write_png(picture, metadata, written.back());
    };
    for (const RendererRun& run : report.runs) {
        save(run.name, develop(run.film, report.develop), run.film.metadata);
        written.push_back(folder / (run.name + ".exr"));
        write_film(run.film, written.back());
    }
    for (const RunComparison& pair : report.comparisons) {
        const RendererRun& a = report.runs[pair.a];
        const RendererRun& b = report.runs[pair.b];
        const std::string stem = a.name + "-" + b.name;
        save(stem, relative_difference_picture(a.film, b.film), {});
        if (pair.comparison.test) save(stem + "-z", z_picture(a.film, b.film), {});
    }
    // The report last: when it is there, everything it names is.
    replace_file(written[1], report_json(report));
    replace_file(written[0], report_html(report));
    return written;
}

}  // namespace etalon
