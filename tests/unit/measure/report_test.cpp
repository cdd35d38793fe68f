#include "engine/measure/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "engine/measure/agreement.h"
#include "films.h"

namespace etalon {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Contender contender(Renderer kind, const std::string& name, std::uint64_t seed, bool measured, double scale = 1)
{
    return {.kind = kind, .name = name, .label = "renderer " + name, .render = [=](const Progress&) {
                RendererRun run{.device = "none", .stages = {{"tracing", 1.25}}};
                run.film = test::noisy_film(48, 32, 16, seed);
                for (vec3& pixel : run.film.mean) pixel *= float(scale);
                if (!measured) run.film.variance.clear();
                return run;
            }};
}

/// A report of three renderers, two of them with error, and of names that want to be markup.
Report sample(double scale_of_b = 1)
{
    const std::vector<Contender> contenders{contender(Renderer::raster, "raster", 1, false),
                                            contender(Renderer::path, "path", 2, true),
                                            contender(Renderer::reference, "reference", 3, true, scale_of_b)};
    const Report head{.scene = "<script>alert(1)</script> & \"x\"",
                      .command = "etalon compare '<b>'",
                      .settings = {{"size", "48x32"}, {"</script>", "<!--"}},
                      .versions = {{"etalon", "0.1.0"}},
                      .notes = {"no light: <studio>"}};
    return measure_agreement(head, contenders, {}, {});
}

TEST(Agreement, renders_each_and_compares_within_a_family_and_once_across)
{
    const Report report = sample();
    ASSERT_EQ(report.runs.size(), 3u);
    ASSERT_EQ(report.comparisons.size(), 2u);
    EXPECT_EQ(report.runs[1].name, "path");
    EXPECT_EQ(report.comparisons[0].comparison.verdict, Verdict::not_tested);
    EXPECT_EQ(report.comparisons[1].comparison.verdict, Verdict::indistinguishable);
    EXPECT_TRUE(passed(report));
    EXPECT_EQ(summary(report), "1 of 2 pairs tested: no fault found");
    EXPECT_FALSE(passed(sample(1.05)));
    EXPECT_EQ(summary(sample(1.05)), "1 of 2 pairs tested: 1 fails");
}

TEST(Agreement, hands_two_rasterizers_to_their_judge_device_first)
{
    const std::vector<Contender> contenders{contender(Renderer::raster, "raster", 1, false),
                                            contender(Renderer::path, "path", 2, true),
                                            contender(Renderer::reference, "reference", 3, true),
                                            contender(Renderer::reference_raster, "reference-raster", 4, false)};
    const Film device = contenders[0].render({}).film;
    int calls = 0;
    const auto judge = [&](const Film& first, const Film& second) {
        ++calls;
        EXPECT_EQ(first.mean, device.mean);
        Comparison result = compare(first, second);
        result.verdict = Verdict::over_budget;
        return result;
    };
    const Report report = measure_agreement({}, contenders, {.compare = {}, .judge_rasters = judge}, {});
    EXPECT_EQ(calls, 1);
    std::vector<std::string> pairs;
    for (const RunComparison& pair : report.comparisons)
        pairs.push_back(report.runs[pair.a].name + " " + report.runs[pair.b].name);
    EXPECT_THAT(pairs, testing::ElementsAre("raster path", "raster reference-raster", "path reference"));
    EXPECT_EQ(summary(report), "2 of 3 pairs tested: 1 fails");
}

TEST(Agreement, stops_between_renderers_and_says_so)
{
    std::atomic<bool> stop = false;
    std::vector<Contender> contenders{contender(Renderer::path, "path", 2, true),
                                      contender(Renderer::reference, "reference", 3, true)};
    contenders[0].render = [&stop, inner = contenders[0].render](const Progress& progress) {
        stop = true;
        return inner(progress);
    };
    const Report report = measure_agreement({}, contenders, {}, Progress({}, &stop));
    EXPECT_EQ(report.runs.size(), 1u);
    EXPECT_TRUE(report.interrupted);
}

TEST(Report, json_parses_back_and_says_what_was_measured_and_what_was_not)
{
    const auto json = nlohmann::json::parse(report_json(sample()));
    EXPECT_EQ(json["schema"], "etalon-report/1");
    EXPECT_EQ(json["scene"], "<script>alert(1)</script> & \"x\"");
    EXPECT_EQ(json["renderers"].size(), 3u);
    EXPECT_TRUE(json["renderers"][0]["film"]["error"].is_null());
    EXPECT_FALSE(json["renderers"][0]["film"]["error_measured"]);
    EXPECT_GT(json["renderers"][1]["film"]["error"]["relative"], 0.0);
    EXPECT_TRUE(json["comparisons"][0]["test"].is_null());
    const auto& test = json["comparisons"][1]["test"];
    EXPECT_EQ(test["false_alarm"], 1e-3);
    EXPECT_GT(test["detectable_tile"], 0.0);
    EXPECT_EQ(test["tile_p_histogram"].size(), 20u);
    for (const char* key : {"command", "passed", "interrupted", "settings", "versions", "notes", "stages"})
        EXPECT_TRUE(json.contains(key)) << key;
}

TEST(Report, json_has_its_keys_in_a_fixed_order_and_no_number_that_json_lacks)
{
    Report report = sample();
    report.runs[0].film.mean[0].x = std::numeric_limits<float>::quiet_NaN();
    report.comparisons[0].comparison = compare(report.runs[0].film, report.runs[1].film);
    report.stages = {{"load", std::numeric_limits<double>::infinity()}};
    report.notes.push_back("not UTF-8: \xff");
    const std::string text = report_json(report);
    EXPECT_TRUE(nlohmann::json::accept(text));
    EXPECT_EQ(nlohmann::json::parse(text)["comparisons"][0]["verdict"], "not finite");
    std::size_t place = 0;
    for (const char* key : {"\"schema\"", "\"scene\"", "\"command\"", "\"passed\"", "\"settings\"", "\"versions\"",
                            "\"renderers\"", "\"comparisons\""}) {
        const std::size_t next = text.find(key, place);
        ASSERT_NE(next, std::string::npos) << key;
        place = next;
    }
    EXPECT_EQ(text, report_json(report));
}

/// Every element closed in order, attributes quoted; the text of script and style is not looked into.
void expect_well_formed(const std::string& html)
{
    std::vector<std::string> open;
    std::size_t at = html.find("<html");
    while ((at = html.find('<', at)) != std::string::npos) {
        const std::size_t end = html.find('>', at);
        ASSERT_NE(end, std::string::npos);
        const std::string tag = html.substr(at + 1, end - at - 1);
        const bool closing = tag[0] == '/';
        const std::string element = tag.substr(closing, tag.find_first_of(" \n/", closing) - closing);
        ASSERT_TRUE(std::isalpha(static_cast<unsigned char>(element[0]))) << "stray '<' before " << tag;
        EXPECT_EQ(std::count(tag.begin(), tag.end(), '"') % 2, 0) << tag;
        at = end + 1;
        if (closing) {
            ASSERT_FALSE(open.empty()) << tag;
            ASSERT_EQ(open.back(), element) << "closed by </" << element << ">";
            open.pop_back();
        } else if (tag.back() != '/' && element != "meta" && element != "img" && element != "input" &&
                   element != "br") {
            open.push_back(element);
            if (element == "script" || element == "style") at = html.find("</" + element, at);
        }
    }
    EXPECT_TRUE(open.empty()) << open.back() << " is not closed";
}

TEST(Report, html_is_one_well_formed_file_with_every_name_escaped)
{
    const std::string html = report_html(sample());
    expect_well_formed(html);
    EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
    EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;x&quot;"));
    EXPECT_THAT(html, HasSubstr("error not measured"));
    EXPECT_THAT(html, Not(HasSubstr("src=\"http")));
    EXPECT_THAT(html, Not(HasSubstr("href=")));
    std::size_t pictures = 0;
    for (std::size_t at = 0; (at = html.find("<img src=\"data:image/png;base64,", at)) != std::string::npos; ++at)
        ++pictures;
    EXPECT_EQ(pictures, 3u + 2u + 1u) << "three pictures, two differences, one in standard errors";
}

TEST(Report, html_of_an_empty_and_of_an_interrupted_run_is_well_formed_too)
{
    expect_well_formed(report_html(Report{.scene = "none", .interrupted = true}));
    EXPECT_THAT(report_html(Report{.interrupted = true}), HasSubstr("interrupted"));
}

TEST(Report, table_fits_and_names_each_error)
{
    const std::string table = report_table(sample());
    EXPECT_THAT(table, HasSubstr("not measured"));
    EXPECT_THAT(table, HasSubstr("indistinguishable"));
    EXPECT_THAT(table, HasSubstr("path - reference"));
    EXPECT_THAT(table, HasSubstr("false-alarm rate 0.1%"));
    EXPECT_EQ(table.back(), '\n');
}

TEST(Report, writes_all_it_names_and_nothing_else)
{
    const auto folder = std::filesystem::temp_directory_path() / ("etalon-report-" + std::to_string(getpid()));
    std::filesystem::remove_all(folder);
    const auto written = write_report(sample(), folder / "deep");
    EXPECT_EQ(written.front(), folder / "deep" / "report.html");
    EXPECT_EQ(written.size(), 2u + 3u * 2u + 2u + 1u);
    for (const auto& path : written) EXPECT_TRUE(std::filesystem::exists(path)) << path;
    std::size_t present = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "deep")) ++present;
    EXPECT_EQ(present, written.size()) << "a temporary was left";
    const Film back = read_film(folder / "deep" / "path.exr");
    EXPECT_EQ(back.mean, sample().runs[1].film.mean);
    std::filesystem::remove_all(folder);
}

TEST(Report, a_folder_that_cannot_be_made_is_an_error_that_names_it)
{
    try {
        write_report(sample(), "/proc/none/report");
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.message(), HasSubstr("/proc/none/report"));
    }
}

}  // namespace
}  // namespace etalon
