#include <fmt/format.h>

#include <cmath>

#include "engine/base/files.h"
#include "engine/measure/page.h"
#include "engine/measure/stability.h"
#include "engine/measure/text.h"

namespace etalon {
namespace {

std::string size_text(const StabilityRow& row, double size)
{
    return row.unit.empty() ? fmt::format("{:.3g}", size) : fmt::format("{:.3g} {}", size, row.unit);
}

std::string promise_text(Holding promise)
{
    return promise == Holding::holds ? "holds" : promise == Holding::breaks ? "BREAKS" : "not reached";
}

std::string break_text(const StabilityRow& row)
{
    const std::optional<double> size = row.breaks_at();
    return size ? size_text(row, *size) : "not found";
}

/// Why the smallest size that broke did; of a path tracer that holds, what its one trial found, if it said so.
std::string reason(const StabilityRow& row)
{
    const std::optional<double> size = row.breaks_at();
    for (const Probe& probe : row.probes)
        if (size && probe.size == *size && !probe.holds) return probe.why;
    return !size && row.renderer == Renderer::path && row.probes.size() == 1 ? row.probes.front().why : "";
}

}  // namespace

std::string stability_table(const Stability& stability)
{
    std::vector<TableRow> rows = {{"row", "relation", "renderer", "promised", "", "holds to", "breaks at", "in"}};
    for (const StabilityRow& row : stability.rows)
        rows.push_back({row.id, row.name, std::string(name(row.renderer)), size_text(row, row.promised),
                        promise_text(row.promise), row.holds_to() > 0 ? size_text(row, row.holds_to()) : "nothing",
                        break_text(row), reason(row)});
    std::string out = fmt::format("{}\n{}", stability.scene, aligned(rows));
    for (const std::string& note : stability.notes) out += note + "\n";
    return out + (passed(stability) ? "every promised range that was tried holds\n"
                                    : "a promised range BREAKS on this scene\n");
}

std::string stability_html(const Stability& stability)
{
    std::string out = fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width\"><title>{0}: where it holds</title><style>{1}</style></head><body>\n<h1>{0}: "
        "where it holds, where it breaks</h1>\n<p>Each row changes the scene in a way that must leave its picture as "
        "it "
        "is, by more and more. {2}</p>\n<div class=\"scroll\"><table><thead><tr><th>row</th><th>relation</th>"
        "<th>renderer</th><th>promised</th><th>promise</th><th>holds to</th><th>breaks at</th><th>in</th>"
        "<th>tried</th></tr></thead><tbody>\n",
        html_escape(stability.scene), page::kStyle,
        passed(stability) ? "<span class=\"good\">Every promised range that was tried holds.</span>"
                          : "<span class=\"bad\">A promised range breaks.</span>");
    for (const StabilityRow& row : stability.rows) {
        std::string tried;
        for (const Probe& probe : row.probes)
            tried += fmt::format("<span class=\"{}\">{:.3g}</span> ", probe.holds ? "good" : "bad", probe.size);
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td>"
            "<td>{}</td><td>{}</td><td>{}</td></tr>\n",
            row.id, row.name, name(row.renderer), html_escape(size_text(row, row.promised)),
            row.promise == Holding::breaks ? "bad" : "good", promise_text(row.promise),
            row.holds_to() > 0 ? html_escape(size_text(row, row.holds_to())) : "nothing", html_escape(break_text(row)),
            html_escape(reason(row)), tried);
    }
    out += "</tbody></table></div>\n";
    for (const std::string& note : stability.notes) out += fmt::format("<p>{}</p>\n", html_escape(note));
    out += "<details><summary>How this was made</summary><table>";
    for (const NamedValues* values : {&stability.settings, &stability.versions})
        for (const auto& [key, value] : *values)
            out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", html_escape(key), html_escape(value));
    return out +
           fmt::format("</table><p><code>{}</code></p></details></body></html>\n", html_escape(stability.command));
}

std::vector<std::filesystem::path> write_stability(const Stability& stability, const std::filesystem::path& folder)
{
    make_folder(folder);
    const std::vector<std::filesystem::path> written = {folder / "stability.html", folder / "stability.json"};
    replace_file(written[1], stability_json(stability));
    replace_file(written[0], stability_html(stability));
    return written;
}

}  // namespace etalon
