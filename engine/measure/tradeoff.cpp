#include "engine/measure/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "engine/base/error.h"
#include "engine/scene/knobs.h"

namespace etalon {
namespace {

constexpr int kReferenceDepth = 64;
constexpr std::uint64_t kFirstReferenceSamples = 16;
constexpr std::uint64_t kMostReferenceSamples = std::uint64_t{1} << 16;

class Clock {
 public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool acts_on(const Knob& knob, Renderer renderer)
{
    if (knob.metric == KnobMetric::none) return false;
    const bool traces = renderer == Renderer::path || renderer == Renderer::reference;
    return knob.scope == (traces ? KnobScope::path : KnobScope::raster);
}

/// The values of a knob that are tried: all of a switch or a choice; of a range, the standard times powers of 4 within
/// it, 1/64 to 64 of the standard.
std::vector<std::string> tried_values(const Knob& knob, const RenderSettings& standard, std::uint64_t most)
{
    std::vector<std::string> out;
    std::vector<std::string> named;
    for (const std::string_view value : knob.tried)
        if (!value.empty()) named.emplace_back(value);
    if (!named.empty()) return named;
    if (std::holds_alternative<Switch>(knob.type)) return {"on", "off"};
    if (const auto* choice = std::get_if<NameChoice>(&knob.type))
        return {choice->values.begin(), choice->values.begin() + choice->count};
    if (const auto* choice = std::get_if<CountChoice>(&knob.type)) {
        for (std::size_t i = 0; i < choice->count; ++i) out.push_back(std::to_string(choice->values[i]));
        return out;
    }
    const CountRange range = std::get<CountRange>(knob.type);
    const double middle = std::stod(knob_value(standard, knob.name));
    for (int power = -3; power <= 3; ++power) {
        const double value = std::round(middle * std::pow(4.0, power));
        if (value < std::max(1.0, double(range.min)) || value > double(std::min(range.max, most))) continue;
        out.push_back(std::to_string(static_cast<std::uint64_t>(value)));
    }
    return out;
}

struct Turnable {
    const Knob* knob;
    std::vector<std::string> values;
};

std::vector<Turnable> turnables(Renderer renderer, const RenderSettings& standard, std::uint64_t most_spp)
{
    std::vector<Turnable> out;
    for (const Knob& knob : knobs()) {
        if (!acts_on(knob, renderer)) continue;
        // Depth beyond the reference's would be measured against a picture that lacks it.
        const std::uint64_t most = knob.name == "spp" ? most_spp : std::uint64_t{kReferenceDepth};
        out.push_back({&knob, tried_values(knob, standard, most)});
    }
    return out;
}

TradePoint point_at(const RenderSettings& settings, std::string turned, std::size_t base)
{
    return {.settings = settings, .flags = flags_of(settings), .turned = std::move(turned), .base = base};
}

/// At most `most` settings that turn several knobs, each drawn at random; those that the earlier points hold are
/// skipped.
void add_combinations(std::vector<TradePoint>& points, std::mt19937_64& random, std::size_t base,
                      const std::vector<Turnable>& turnable, std::size_t most)
{
    std::set<std::string> known;
    for (const TradePoint& point : points) known.insert(point.flags);
    std::size_t added = 0;
    // So many tries find nearly all of few combinations, and end where there are fewer than asked for.
    for (std::size_t tries = 0; tries < 16 * most && added < most; ++tries) {
        RenderSettings turned = points[base].settings;
        for (const Turnable& one : turnable)
            if (!one.values.empty()) set_knob(turned, one.knob->name, one.values[random() % one.values.size()]);
        TradePoint point = point_at(turned, "several", base);
        if (!known.insert(point.flags).second) continue;
        points.push_back(std::move(point));
        ++added;
    }
}

/// Samples of a reference for each of the standard's with which four times the standard is still resolved (its noise a
/// tenth of what is measured).
constexpr std::uint64_t kResolvesStandard = 40;

class Measuring {
 public:
    Measuring(Tradeoff& out, const TradeoffSettings& settings, const RenderCall& render, const Progress& progress)
        : out_(out), settings_(settings), render_(render), progress_(progress)
    {}

    /// The reference by as many samples as its share of the budget buys.
    void make_reference()
    {
        out_.reference_settings = settings_.standard;
        RenderSettings& how = out_.reference_settings;
        how.renderer = Renderer::path;
        how.max_depth = std::max(kReferenceDepth, how.max_depth);
        how.aovs = false;
        how.seed = settings_.seed + 1'000'000'007;
        how.spp = kFirstReferenceSamples;
        if (take_cached(how, kResolvesStandard * settings_.standard.spp)) return;
        const auto silent = quiet("the reference", 0);
        static_cast<void>(render_(how, silent));  // compiles the pipelines: the next one tells the cost of samples
        if (progress_.stopped()) return;
        const Clock pilot;
        static_cast<void>(render_(how, silent));
        const double a_sample = pilot.seconds() / double(how.spp);
        const double affordable = settings_.reference_share * settings_.budget_seconds / a_sample;
        how.spp = static_cast<std::uint64_t>(
            std::clamp(affordable, double(kFirstReferenceSamples), double(kMostReferenceSamples)));
        // What this run could do but little better by is not made anew.
        if (take_cached(how, how.spp / 2)) return;
        const Clock clock;
        if (progress_.stopped()) return;
        out_.reference = render_(how, quiet("the reference", 0));
        out_.reference_seconds = clock.seconds();
        how.spp = out_.reference.samples;
        if (settings_.cache != nullptr && !progress_.stopped())
            settings_.cache->keep(settings_.cache_key, out_.reference);
    }

    void measure_points()
    {
        std::vector<std::size_t> alive(out_.points.size());
        std::iota(alive.begin(), alive.end(), 0);
        errors_.resize(out_.points.size());
        std::mt19937_64 random(settings_.seed);
        int round = 0;
        for (; round < settings_.rounds; ++round) {
            // The first round in the planned order: the standards before what is compared with them.
            if (round > 0) std::shuffle(alive.begin(), alive.end(), random);
            if (!measure_round(alive, round)) break;
            give_up_half(alive);
        }
        finish(round);
    }

 private:
    /// True when an earlier run has left a reference of at least `enough` samples.
    bool take_cached(RenderSettings& how, std::uint64_t enough)
    {
        if (settings_.cache == nullptr) return false;
        std::optional<Film> kept = settings_.cache->find(settings_.cache_key);
        if (!kept || kept->samples < enough || kept->variance.empty()) return false;
        out_.reference = std::move(*kept);
        out_.reference_cached = true;
        how.spp = out_.reference.samples;
        return true;
    }

    /// Says where the whole stands; what a renderer says of its own picture would interrupt that.
    Progress quiet(const std::string& stage, double fraction) const
    {
        progress_.report({.stage = stage, .fraction = std::min(fraction, 1.0)});
        return progress_.silent();
    }

    /// False when the time is up or somebody said stop.
    bool measure_round(const std::vector<std::size_t>& alive, int round)
    {
        for (const std::size_t i : alive) {
            TradePoint& point = out_.points[i];
            const double expected = point.time.median();
            const bool needed = round == 0 && point.turned.empty();
            if (progress_.stopped()) return false;
            if (!needed && clock_.seconds() + expected > settings_.budget_seconds) return false;
            RenderSettings settings = point.settings;
            settings.seed = settings_.seed + std::uint64_t(round) + 1;
            const Progress silent = quiet(point.flags, clock_.seconds() / settings_.budget_seconds);
            // Scenes are uploaded and pipelines compiled at their first use: that is not the picture's cost.
            if (round == 0) {
                RenderSettings first = settings;
                first.spp = 1;
                const Clock making;
                static_cast<void>(render_(first, silent));
                point.first_seconds = making.seconds();
                if (settings_.memory) point.memory = settings_.memory(settings);
            }
            const Clock one;
            Film film = render_(settings, silent);
            const double seconds = one.seconds();
            if (progress_.stopped()) return false;
            point.time.seconds.push_back(seconds);
            errors_[i].push_back(measure_error(film, out_.reference));
            if (round == 0) {
                point.metrics = compare(film, out_.reference).metrics;
                point.film = std::move(film);
            }
        }
        return true;
    }

    void give_up_half(std::vector<std::size_t>& alive) const
    {
        std::vector<CostAndError> costs;
        for (const std::size_t i : alive)
            costs.push_back({out_.points[i].time.median(), mean_error(errors_[i]).relmse});
        const std::vector<std::size_t> beaten = times_beaten(costs);
        std::vector<std::size_t> several;
        for (std::size_t k = 0; k < alive.size(); ++k)
            if (out_.points[alive[k]].turned == "several" && beaten[k] > 0) several.push_back(k);
        std::sort(several.begin(), several.end(), [&](std::size_t a, std::size_t b) { return beaten[a] > beaten[b]; });
        several.resize(several.size() / 2);
        const std::set<std::size_t> gone(several.begin(), several.end());
        std::vector<std::size_t> kept;
        for (std::size_t k = 0; k < alive.size(); ++k)
            if (!gone.contains(k)) kept.push_back(alive[k]);
        alive = std::move(kept);
    }

    void finish(int rounds)
    {
        if (rounds < settings_.rounds && !progress_.stopped())
            out_.notes.push_back(
                fmt::format("the budget of {} s allowed {} whole rounds of {}: a larger --budget "
                            "narrows the intervals",
                            settings_.budget_seconds, rounds, settings_.rounds));
        std::vector<CostAndError> costs;
        for (std::size_t i = 0; i < out_.points.size(); ++i) {
            TradePoint& point = out_.points[i];
            if (point.time.seconds.empty()) continue;
            point.error = mean_error(errors_[i]);
            costs.push_back({point.time.median(), point.error.relmse});
            const std::vector<double>& base = out_.points[point.base].time.seconds;
            Timing ratios;
            for (std::size_t k = 0; k < std::min(base.size(), point.time.seconds.size()); ++k)
                ratios.seconds.push_back(point.time.seconds[k] / base[k]);
            if (!ratios.seconds.empty()) point.time_ratio = ratios.median();
        }
        const std::vector<std::size_t> beaten = times_beaten(costs);
        std::size_t measured = 0, unmeasured = 0;
        for (TradePoint& point : out_.points) {
            if (point.time.seconds.empty())
                ++unmeasured;
            else
                point.frontier = beaten[measured++] == 0;
        }
        if (unmeasured == 0) return;
        out_.notes.push_back(fmt::format("{} planned points were not reached in the time", unmeasured));
        // Bases come first and are always measured, so that indices to them stay right.
        std::erase_if(out_.points, [](const TradePoint& point) { return point.time.seconds.empty(); });
    }

    Tradeoff& out_;
    const TradeoffSettings& settings_;
    const RenderCall& render_;
    const Progress& progress_;
    Clock clock_;
    std::vector<std::vector<ErrorMeasurement>> errors_;
};

}  // namespace

std::string flags_of(const RenderSettings& settings)
{
    const RenderSettings standard;
    std::string out = fmt::format("--renderer {}", name(settings.renderer));
    for (const Knob& knob : knobs()) {
        if (!acts_on(knob, settings.renderer)) continue;
        const std::string value = knob_value(settings, knob.name);
        if (value != knob_value(standard, knob.name)) out += fmt::format(" --{} {}", knob.name, value);
    }
    return out;
}

std::vector<TradePoint> plan_tradeoff(const TradeoffSettings& settings, std::uint64_t most_spp)
{
    std::vector<TradePoint> points;
    std::vector<std::vector<Turnable>> turnable;
    for (const Renderer renderer : settings.renderers) {
        RenderSettings standard = settings.standard;
        standard.renderer = renderer;
        if (renderer == Renderer::path || renderer == Renderer::reference)
            standard.spp = std::min(standard.spp, std::max<std::uint64_t>(most_spp, 1));
        points.push_back(point_at(standard, "", points.size()));
        turnable.push_back(turnables(renderer, standard, most_spp));
    }
    const std::size_t bases = points.size();
    for (std::size_t base = 0; base < bases; ++base) {
        for (const Turnable& one : turnable[base]) {
            for (const std::string& value : one.values) {
                RenderSettings turned = points[base].settings;
                if (knob_value(turned, one.knob->name) == value) continue;
                set_knob(turned, one.knob->name, value);
                points.push_back(point_at(turned, std::string(one.knob->name), base));
            }
        }
    }
    const std::size_t each = static_cast<std::size_t>(settings.combinations) / std::max<std::size_t>(bases, 1);
    std::mt19937_64 random(settings.seed);
    for (std::size_t base = 0; base < bases; ++base) add_combinations(points, random, base, turnable[base], each);
    return points;
}

Tradeoff measure_tradeoff(Tradeoff out, const TradeoffSettings& settings, const RenderCall& render,
                          const Progress& progress)
{
    Measuring measuring(out, settings, render, progress);
    measuring.make_reference();
    if (!out.reference.mean.empty() && !progress.stopped()) {
        // A picture of n samples is measured by a reference of at least 10 n: its noise is a tenth of what is measured.
        out.points = plan_tradeoff(settings, out.reference.samples / 10);
        measuring.measure_points();
    }
    out.interrupted = progress.stopped();
    return out;
}

}  // namespace etalon
