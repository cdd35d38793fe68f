#include "engine/measure/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/math/stats.h"
#include "engine/measure/invariants.h"

namespace etalon {
namespace {

/// Radiance and variance divided by `k`, so that the picture of k times the light is compared with the unchanged one.
Film divided(Film film, double k)
{
    if (k == 1) return film;
    for (vec3& value : film.mean) value = vec3(dvec3(value) / k);
    for (vec3& value : film.variance) value = vec3(dvec3(value) / k / k);
    return film;
}

/// Left and right exchanged.
Film mirrored(Film film)
{
    const auto rows = [&](auto& list) {
        for (std::size_t y = 0; !list.empty() && y < std::size_t(film.height); ++y)
            std::reverse(list.begin() + std::ptrdiff_t(y) * film.width,
                         list.begin() + std::ptrdiff_t(y + 1) * film.width);
    };
    rows(film.mean);
    rows(film.variance);
    rows(film.alpha);
    return film;
}

/// While it lives, `to` has the images of `from`: no relation changes an image, and copies of them all for every
/// variant would cost more than drawing it.
class LentImages {
 public:
    LentImages(std::vector<Texels>& from, std::vector<Texels>& to) : from_(from), to_(to) { from_.swap(to_); }
    ~LentImages() { from_.swap(to_); }
    LentImages(const LentImages&) = delete;
    LentImages& operator=(const LentImages&) = delete;

 private:
    std::vector<Texels>& from_;
    std::vector<Texels>& to_;
};

class Trials {
 public:
    Trials(Stability& out, const PosedScene& posed, const PoseSettings& view, const StabilitySettings& settings,
           const StabilityCalls& calls, const Progress& progress)
        : out_(out),
          settings_(settings),
          calls_(calls),
          progress_(progress),
          scene_(canonical_scene(posed, view)),
          view_(canonical_view(posed, view)),
          unchanged_(pose(scene_, view_))
    {
        images_.swap(scene_.images);
    }

    void run()
    {
        // Most of the table is tried once or twice, some of it bisected: the level is that of so many tests at once.
        const double tests = double(relations().size() * settings_.renderers.size()) * (2.0 + settings_.bisections);
        comparing_ = {.false_alarm = sidak_level(settings_.false_alarm, tests), .rounding = kDeviceRounding};
        std::vector<Trial> trials;
        for (const Renderer renderer : settings_.renderers)
            for (const Relation& relation : relations())
                if (acts_on(relation, renderer)) trials.push_back({&relation, renderer});
        // Every promise before the first bisection: a short budget then leaves out precision, not rows.
        for (Trial& trial : trials) {
            if (!has_time()) break;
            trial.row = start_row(trial);
            probe(trial, trial.relation->promised);
            if (!trial.exists) continue;
            trial.row.promise = trial.row.probes.back().holds ? Holding::holds : Holding::breaks;
        }
        for (const Renderer renderer : settings_.renderers)
            if (renderer == Renderer::path && has_time()) check_path_tracer();
        for (Trial& trial : trials)
            if (has_time() && trial.exists && !trial.row.probes.empty()) look_further(trial);
        if (!has_time())
            out_.notes.push_back(
                fmt::format("{} s were not enough to look beyond every promise and to bisect every "
                            "break: a larger --budget does",
                            settings_.budget_seconds));
        std::size_t unreached = 0;
        for (Trial& trial : trials) {
            if (!trial.row.probes.empty())
                out_.rows.push_back(std::move(trial.row));
            else
                unreached += trial.exists;
        }
        if (unreached > 0)
            out_.notes.push_back(fmt::format("{} rows were not reached in {} s: a larger --budget reaches them",
                                             unreached, settings_.budget_seconds));
    }

 private:
    struct Trial {
        const Relation* relation;
        Renderer renderer;
        StabilityRow row{};
        bool exists = true;  ///< the scene has something that the relation changes
    };

    static bool acts_on(const Relation& relation, Renderer renderer)
    {
        return renderer == Renderer::path || renderer == Renderer::reference ? relation.path : relation.raster;
    }

    bool has_time() const
    {
        const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        return !progress_.stopped() && spent < settings_.budget_seconds;
    }

    static StabilityRow start_row(const Trial& trial)
    {
        const Relation& relation = *trial.relation;
        return {.id = std::string(relation.id),
                .name = std::string(relation.name),
                .unit = std::string(relation.unit),
                .renderer = trial.renderer,
                .promised = relation.promised};
    }

    RenderSettings settings_of(Renderer renderer, std::uint64_t number) const
    {
        RenderSettings settings = settings_.render;
        settings.renderer = renderer;
        settings.seed = settings_.render.seed + number;
        settings.aovs = false;
        return settings;
    }

    const Film& unchanged_film(Renderer renderer)
    {
        Film& film = films_[static_cast<std::size_t>(renderer)];
        if (film.mean.empty()) film = calls_.render(unchanged_, settings_of(renderer, 0), progress_.silent());
        return film;
    }

    Film draw(Scene& scene, const RenderSettings& settings, double later)
    {
        const LentImages lent(images_, scene.images);
        PoseSettings view = view_;
        if (view.time || view.animation) view.time = view.time.value_or(0) + later;
        return calls_.render(pose(scene, view), settings, progress_.silent());
    }

    void probe(Trial& trial, double size)
    {
        const std::string what =
            fmt::format("{}, {} {:.3g} {}", label(trial.renderer), trial.relation->name, size, trial.relation->unit);
        const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        progress_.report({.stage = what, .fraction = std::min(1.0, spent / settings_.budget_seconds)});
        trial.row.probes.push_back({.size = size});
        Probe& probe = trial.row.probes.back();
        try {
            std::optional<Variant> variant = trial.relation->apply(scene_, size);
            // A rest pose knows no time.
            if (variant && variant->later != 0 && !view_.time && !view_.animation) variant.reset();
            if (!variant) {
                trial.exists = false;
                trial.row.probes.pop_back();
                return;
            }
            RenderSettings settings = settings_of(trial.renderer, ++drawn_);
            if (variant->settings) variant->settings(settings);
            Film film = divided(draw(variant->scene, settings, variant->later), variant->radiance);
            if (variant->mirrored) film = mirrored(std::move(film));
            const LentImages lent(images_, scene_.images);
            const Comparison comparison = trial.renderer == Renderer::raster
                                              ? calls_.judge_raster(unchanged_, settings, film)
                                              : compare(film, unchanged_film(trial.renderer), comparing_);
            probe.holds = passed(comparison.verdict) && film.nonfinite == 0;
            // Which of the reasons broke it is not said apart: all of them then.
            if (!comparison.reasons.empty())
                probe.why =
                    probe.holds ? comparison.reasons.front() : fmt::format("{}", fmt::join(comparison.reasons, "; "));
            if (film.nonfinite > 0) probe.why = fmt::format("{} samples are NaN or Inf", film.nonfinite);
        } catch (const Error& error) {
            probe.why = error.message();
        }
    }

    /// What is asked of a path tracer besides relations (engine/measure/invariants.h).
    void check_path_tracer()
    {
        const auto add = [&](const char* id, const char* what, const char* unit, double promised, const auto& check) {
            if (!has_time()) return;
            progress_.report({.stage = what});
            StabilityRow row{.id = id, .name = what, .unit = unit, .renderer = Renderer::path, .promised = promised};
            row.probes.push_back({.size = promised});
            try {
                const Invariant found = check();
                row.probes.back().holds = found.holds;
                row.probes.back().why = found.why;
            } catch (const Error& error) {
                row.probes.back().why = error.message();
            }
            row.promise = row.probes.back().holds ? Holding::holds : Holding::breaks;
            out_.rows.push_back(std::move(row));
        };
        const DrawCall draw_scene = [&](std::uint64_t samples) {
            const LentImages lent(images_, scene_.images);
            RenderSettings settings = settings_of(Renderer::path, ++drawn_);
            settings.spp = samples;
            return calls_.render(unchanged_, settings, progress_.silent());
        };
        add("R21", "error falls as N^-1/2", "samples", double(kSlopeSamples.back()),
            [&] { return error_slope(draw_scene, comparing_.false_alarm); });
        add("R22", "white furnace", "", 1, [&] {
            const Scene furnace = furnace_scene();
            RenderSettings settings = settings_of(Renderer::path, ++drawn_);
            settings.max_depth = kFurnaceDepth;
            settings.spp = kFurnaceSamples;
            const Film film = calls_.render(pose(furnace), settings, progress_.silent());
            return judge_furnace(film, comparing_.false_alarm);
        });
    }

    /// Beyond the promise while it holds, and between the last that held and the first that broke.
    void look_further(Trial& trial)
    {
        const Relation& relation = *trial.relation;
        if (trial.row.promise == Holding::holds && relation.most > relation.promised) probe(trial, relation.most);
        if (trial.row.promise == Holding::breaks && relation.start < relation.promised && has_time())
            probe(trial, relation.start);
        for (int step = 0; step < settings_.bisections && has_time(); ++step) {
            const double low = trial.row.holds_to();
            const std::optional<double> high = trial.row.breaks_at();
            if (low == 0 || !high || *high < 2 * low) return;
            // Counts and uv shifts are whole numbers; powers of two of the rest would hide rounding.
            const double middle = std::sqrt(low * *high);
            probe(trial, is_whole(relation) ? std::floor(middle) : middle);
        }
    }

    static bool is_whole(const Relation& relation) { return relation.unit.empty() || relation.unit.size() > 3; }

    Stability& out_;
    const StabilitySettings& settings_;
    const StabilityCalls& calls_;
    const Progress& progress_;
    Scene scene_;  // its images are in images_ while nothing is drawn
    std::vector<Texels> images_;
    const PoseSettings view_;
    const PosedScene unchanged_;
    CompareSettings comparing_;
    std::array<Film, 4> films_;
    std::uint64_t drawn_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

double StabilityRow::holds_to() const
{
    const double broken = breaks_at().value_or(std::numeric_limits<double>::infinity());
    double best = 0;
    for (const Probe& probe : probes)
        if (probe.holds && probe.size < broken) best = std::max(best, probe.size);
    return best;
}

std::optional<double> StabilityRow::breaks_at() const
{
    std::optional<double> least;
    for (const Probe& probe : probes)
        if (!probe.holds && (!least || probe.size < *least)) least = probe.size;
    return least;
}

bool passed(const Stability& stability)
{
    return std::none_of(stability.rows.begin(), stability.rows.end(),
                        [](const StabilityRow& row) { return row.promise == Holding::breaks; });
}

Stability measure_stability(Stability out, const PosedScene& posed, const PoseSettings& view,
                            const StabilitySettings& settings, const StabilityCalls& calls, const Progress& progress)
{
    Trials(out, posed, view, settings, calls, progress).run();
    out.interrupted = progress.stopped();
    return out;
}

}  // namespace etalon
