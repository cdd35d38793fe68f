#include "tools/etalon/explain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/measure/text.h"
#include "tools/etalon/json.h"

namespace etalon::cli {
namespace {

std::size_t count(const std::vector<bool>& used)
{
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

double ratio(double part, double whole)
{
    return whole > 0 ? part / whole : 1;
}

std::string megabytes(double bytes)
{
    return std::abs(bytes) < 1e5 ? fmt::format("{:.3g} kB", bytes / 1e3) : fmt::format("{:.3g} MB", bytes / 1e6);
}

/// "-" where there is none: the eye should find what costs.
std::string bytes_cell(std::int64_t bytes)
{
    return bytes == 0 ? "-" : megabytes(double(bytes));
}

std::string number_cell(std::int64_t number)
{
    return number == 0 ? "-" : fmt::format("{}", number);
}

const RequirementTime* time_of(const Explained& e, Feature feature)
{
    if (!e.measured) return nullptr;
    const auto& all = e.measured->requirements;
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.feature == feature; });
    return found == all.end() ? nullptr : &*found;
}

void add_times(const Explained& e, Feature feature, TableRow& row)
{
    const RequirementTime* time = time_of(e, feature);
    if (time == nullptr || time->needed) {
        row.insert(row.end(), {time == nullptr ? "?" : "needed", ""});
        return;
    }
    const Specialisation& m = *e.measured;
    row.push_back(fmt::format("{:.0f}", 1e3 * m.seconds(time->start)));
    row.push_back(fmt::format("{:.2f} ± {:.2f}", 1e3 * m.seconds(time->picture), 1e3 * m.seconds(time->scatter)));
}

std::string requirements_text(const Explained& e)
{
    if (!e.costs) {
        std::vector<TableRow> rows;
        for (std::size_t i = 0; i < kFeatureCount; ++i)
            if (e.required.bits[i]) rows.push_back({std::string(name(static_cast<Feature>(i))), e.required.cause[i]});
        return aligned(rows);
    }
    TableRow head{"requirement", "instructions", "vertices", "textures", "passes"};
    const bool timed = e.measured && !e.measured->requirements.empty();
    if (timed) head.insert(head.end(), {"start ms", "picture ms"});
    head.emplace_back("because of");
    std::vector<TableRow> rows{head};
    for (const RequirementCost& cost : e.each) {
        TableRow row{std::string(name(cost.feature))};
        if (cost.needed)
            row.insert(row.end(), {"needed", "", "", ""});
        else
            row.insert(row.end(), {number_cell(cost.instructions), bytes_cell(cost.attribute_bytes),
                                   bytes_cell(cost.texture_bytes), number_cell(cost.passes)});
        if (timed) add_times(e, cost.feature, row);
        row.push_back(e.required.cause[static_cast<std::size_t>(cost.feature)]);
        rows.push_back(row);
    }
    return aligned(rows) +
           "Costs are what would go if nothing needed the requirement; they do not add up, where two need the same.\n";
}

std::string shaders_text(const SceneCosts& costs)
{
    std::vector<TableRow> rows = {{"shader", "instructions, all", "for this scene", "", "variants"}};
    for (const ShaderCost& shader : costs.shaders)
        rows.push_back({shader.shader, fmt::format("{}", shader.written), fmt::format("{}", shader.special),
                        fmt::format("{:.0f}%", 100 * ratio(double(shader.special), double(shader.written))),
                        fmt::format("{}", shader.variants)});
    std::string text = "\n" + aligned(rows);
    text += fmt::format("vertices: {} of {}; textures: {} of {}", megabytes(double(costs.data.attribute_bytes)),
                        megabytes(double(costs.uber.attribute_bytes)), megabytes(double(costs.data.texture_bytes)),
                        megabytes(double(costs.uber.texture_bytes)));
    if (costs.uber.passes > 0) text += fmt::format("; passes: {} of {}", costs.data.passes, costs.uber.passes);
    return text + "\n";
}

std::string break_even_text(const Specialisation& m)
{
    std::string text =
        fmt::format("start-up {:.3g} s of {:.3g} s, a picture {:.3g} s of {:.3g} s ({} time): ", m.start(m.special),
                    m.start(m.uber), m.picture(m.special), m.picture(m.uber), m.software ? "processor" : "wall");
    const std::optional<std::uint64_t> pictures = m.break_even();
    if (!pictures)
        text += "the uber pipeline is the better one here";
    else if (*pictures == 0)
        text += "specialising pays from the first picture on";
    else
        text += fmt::format("specialising pays from picture {} on", *pictures);
    if (const auto cached = m.break_even_with_cache(); pictures && cached && *cached > 0)
        text += fmt::format(", and from picture {} on against an uber pipeline compiled before", *cached);
    return text + "\n";
}

std::string removals_text(const std::vector<Removal>& removals)
{
    if (removals.empty()) return "";
    constexpr std::size_t kMost = 12;
    std::string text = "\nleft out, as no picture shows it:\n";
    std::vector<TableRow> rows;
    for (std::size_t i = 0; i < std::min(removals.size(), kMost); ++i)
        rows.push_back({"  " + removals[i].pointer, removals[i].what});
    text += aligned(rows);
    if (removals.size() > kMost) text += fmt::format("  … and {} more (--json lists them)\n", removals.size() - kMost);
    return text;
}

std::string suggestions_text(const std::vector<Suggestion>& suggestions)
{
    if (suggestions.empty()) return "";
    constexpr std::size_t kMostPlaces = 3;
    std::string text = "\nfor the author of the scene:\n";
    for (const Suggestion& one : suggestions) {
        text += "  " + one.what;
        if (one.bytes > 0) text += fmt::format(": −{}", megabytes(double(one.bytes)));
        if (!one.code.empty()) text += fmt::format(" [{}]", one.code);
        text += '\n';
        for (std::size_t i = 0; i < std::min(one.pointers.size(), kMostPlaces); ++i)
            text += fmt::format("      {}\n", one.pointers[i]);
        if (one.pointers.size() > kMostPlaces)
            text += fmt::format("      … and {} more\n", one.pointers.size() - kMostPlaces);
    }
    return text;
}

std::string unseen_text(const Explained& e)
{
    if (!e.unseen || (e.unseen->draws == 0 && e.unseen->levels.empty())) return "";
    constexpr std::size_t kMost = 6;
    std::string text = fmt::format("\nof this view at {}x{}:\n", e.size.x, e.size.y);
    if (e.unseen->draws > 0)
        text += fmt::format("  {} of {} draws ({} triangles) lie outside and are not drawn\n", e.unseen->draws, e.draws,
                            e.unseen->triangles);
    std::vector<UnreadLevels> levels = e.unseen->levels;
    std::stable_sort(levels.begin(), levels.end(),
                     [](const UnreadLevels& a, const UnreadLevels& b) { return a.bytes > b.bytes; });
    std::uint64_t sum = 0;
    for (const UnreadLevels& one : levels) sum += one.bytes;
    if (!levels.empty())
        text +=
            fmt::format("  {} images are larger than any pixel needs: −{}\n", levels.size(), megabytes(double(sum)));
    for (std::size_t i = 0; i < std::min(levels.size(), kMost); ++i) {
        const Texels& image = e.scene->images[levels[i].image];
        text += fmt::format("      {}: {}x{} would do for {}x{}: −{}\n", levels[i].pointer,
                            std::max(image.width >> levels[i].first, 1), std::max(image.height >> levels[i].first, 1),
                            image.width, image.height, megabytes(double(levels[i].bytes)));
    }
    if (levels.size() > kMost) text += fmt::format("      … and {} more\n", levels.size() - kMost);
    return text;
}

std::string total_text(const Explained& e)
{
    std::string text = fmt::format("models {} of {} features", e.required.bits.count(), kFeatureCount);
    if (!e.costs)
        return text + fmt::format("; {} of {} textures, {} of {} materials\n", count(e.required.texture_used),
                                  e.scene->textures.size(), count(e.required.material_used), e.scene->materials.size());
    text += fmt::format(": {:.0f}% of the instructions",
                        100 * ratio(double(e.costs->special()), double(e.costs->written())));
    if (!e.measured) return text + "; --measure says time and memory, and holds the pixels against each other\n";
    const Specialisation& m = *e.measured;
    return text + fmt::format(", {:.2f}× the time, {:.2f}× the memory ({} of {}); pixels {}\n",
                              ratio(m.picture(m.special), m.picture(m.uber)),
                              ratio(double(m.special.memory), double(m.uber.memory)),
                              megabytes(double(m.special.memory)), megabytes(double(m.uber.memory)),
                              m.identical ? "identical" : "DIFFER");
}

Json spent_json(const Spent& spent)
{
    return Json::object({{"wall", spent.wall}, {"processors", spent.cpu}});
}

Json way_json(const WayCost& way)
{
    std::vector<Json> pictures;
    for (const Spent& one : way.pictures) pictures.push_back(spent_json(one));
    return Json::object(
        {{"start_seconds", spent_json(way.start)}, {"picture_seconds", pictures}, {"memory_bytes", way.memory}});
}

Json measured_json(const Specialisation& m)
{
    return Json::object({{"device", m.device},
                         {"seconds_are_of", m.software ? "processors" : "wall"},
                         {"special", way_json(m.special)},
                         {"uber", way_json(m.uber)},
                         {"time_ratio", ratio(m.picture(m.special), m.picture(m.uber))},
                         {"start_ratio", ratio(m.start(m.special), m.start(m.uber))},
                         {"memory_ratio", ratio(double(m.special.memory), double(m.uber.memory))},
                         {"break_even_pictures", m.break_even()},
                         {"break_even_pictures_cached", m.break_even_with_cache()},
                         {"unmeasured_requirements", m.unmeasured},
                         {"identical", m.identical}});
}

Json data_json(const DataCost& data)
{
    return Json::object(
        {{"vertex_bytes", data.attribute_bytes}, {"texture_bytes", data.texture_bytes}, {"passes", data.passes}});
}

Json costs_json(const Explained& e)
{
    if (!e.costs) return {};
    std::vector<Json> shaders;
    for (const ShaderCost& shader : e.costs->shaders)
        shaders.push_back(Json::object({{"shader", shader.shader},
                                        {"instructions", shader.written},
                                        {"instructions_specialised", shader.special},
                                        {"variants", shader.variants}}));
    return Json::object({{"shaders", shaders},
                         {"data", data_json(e.costs->data)},
                         {"data_uber", data_json(e.costs->uber)},
                         {"measured", e.measured ? measured_json(*e.measured) : Json()}});
}

Json requirement_json(const Explained& e, Feature feature)
{
    std::vector<std::pair<std::string, Json>> row{{"name", name(feature)},
                                                  {"cause", e.required.cause[static_cast<std::size_t>(feature)]}};
    const auto cost =
        std::find_if(e.each.begin(), e.each.end(), [&](const RequirementCost& one) { return one.feature == feature; });
    if (cost == e.each.end()) return Json::object(row);
    row.emplace_back("needed", cost->needed);
    if (!cost->needed)
        row.emplace_back("costs", Json::object({{"instructions", cost->instructions},
                                                {"vertex_bytes", cost->attribute_bytes},
                                                {"texture_bytes", cost->texture_bytes},
                                                {"passes", cost->passes}}));
    if (const RequirementTime* time = time_of(e, feature); time != nullptr && !time->needed)
        row.emplace_back("seconds", Json::object({{"start", spent_json(time->start)},
                                                  {"picture", spent_json(time->picture)},
                                                  {"picture_half_range", spent_json(time->scatter)}}));
    return Json::object(row);
}

Json unseen_json(const Explained& e)
{
    if (!e.unseen) return {};
    std::vector<Json> levels;
    for (const UnreadLevels& one : e.unseen->levels)
        levels.push_back(
            Json::object({{"pointer", one.pointer}, {"first_level_read", one.first}, {"bytes", one.bytes}}));
    return Json::object({{"width", e.size.x},
                         {"height", e.size.y},
                         {"draws_outside", e.unseen->draws},
                         {"triangles_outside", e.unseen->triangles},
                         {"unread_levels", levels}});
}

}  // namespace

std::string explained_text(const Explained& e)
{
    std::string text = requirements_text(e);
    if (e.costs) text += shaders_text(*e.costs);
    text += removals_text(e.removals) + unseen_text(e) + suggestions_text(e.suggestions) + "\n";
    if (e.measured) {
        text += fmt::format("at {}x{}{} on {}: {}", e.size.x, e.size.y,
                            e.settings.renderer == Renderer::path ? fmt::format(", {} spp", e.settings.spp) : "",
                            e.measured->device, break_even_text(*e.measured));
        if (e.measured->unmeasured > 0)
            text += fmt::format("{} requirements were not timed within the --budget\n", e.measured->unmeasured);
    }
    return text + total_text(e);
}

std::string explained_json(const Explained& e)
{
    std::vector<Json> required;
    std::vector<std::string> absent;
    for (std::size_t i = 0; i < kFeatureCount; ++i) {
        const auto feature = static_cast<Feature>(i);
        if (e.required.bits[i])
            required.push_back(requirement_json(e, feature));
        else
            absent.emplace_back(name(feature));
    }
    std::vector<Json> removals, suggestions;
    for (const Removal& one : e.removals)
        removals.push_back(Json::object({{"pointer", one.pointer}, {"why", one.what}}));
    for (const Suggestion& one : e.suggestions)
        suggestions.push_back(Json::object({{"what", one.what},
                                            {"pointers", one.pointers},
                                            {"bytes", one.bytes},
                                            {"code", one.code.empty() ? Json() : Json(one.code)}}));
    const auto used = [](std::size_t n, std::size_t of) { return Json::object({{"used", n}, {"of", of}}); };
    return Json::object({{"schema", "etalon-explain/2"},
                         {"scene", e.scene->name},
                         {"renderer", name(e.settings.renderer)},
                         {"required", required},
                         {"not_required", absent},
                         {"textures", used(count(e.required.texture_used), e.scene->textures.size())},
                         {"materials", used(count(e.required.material_used), e.scene->materials.size())},
                         {"left_out", removals},
                         {"unseen", unseen_json(e)},
                         {"suggestions", suggestions},
                         {"costs", costs_json(e)}})
               .text() +
           "\n";
}

}  // namespace etalon::cli
