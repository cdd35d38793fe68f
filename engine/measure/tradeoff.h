#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/image/develop.h"
#include "engine/measure/compare.h"
#include "engine/measure/frontier.h"
#include "engine/measure/reference_cache.h"
#include "engine/measure/report.h"
#include "engine/scene/settings.h"

namespace etalon {

/// How much measuring is done, and with what.
struct TradeoffSettings {
    std::vector<Renderer> renderers = {Renderer::raster, Renderer::path};
    RenderSettings standard;       ///< the point around which one knob at a time is turned
    double budget_seconds = 60;    ///< of rendering, the reference included; the point being measured is finished
    double reference_share = 0.4;  ///< of the budget
    int rounds = 5;                ///< times that a point is measured, at most
    int combinations = 24;         ///< points that turn several knobs at once, at most
    std::uint64_t seed = 1;
    /// Bytes that a picture of these settings is predicted to need. Empty: not said.
    std::function<std::uint64_t(const RenderSettings&)> memory{};
    const ReferenceCache* cache = nullptr;  ///< where references are kept between runs; null: nowhere
    std::string cache_key{};                ///< of the scene and of all settings but the samples
};

/// Settings that were tried, and what they cost and gave.
struct TradePoint {
    RenderSettings settings;
    std::string flags;         ///< to copy: "--renderer path --spp 16"
    std::string turned;        ///< the knob that differs from the standard; "" at the standard, "several" otherwise
    std::size_t base = 0;      ///< the standard point of the same renderer
    Film film;                 ///< of the first round
    Timing time;               ///< of a picture, scene and pipelines being there
    double first_seconds = 0;  ///< of the first call, which makes them (a sample a pixel of path tracers)
    PictureMetrics metrics{};  ///< of the first round against the reference, whose noise is in them
    std::uint64_t memory = 0;  ///< bytes, predicted
    ErrorMeasurement error;    ///< against the reference, mean over rounds, each with its own seed
    bool frontier = false;     ///< no other point is both faster and nearer to the reference
    double time_ratio = 1;     ///< median over rounds of time / the base's time in the same round
};

/// The measured frontier of one scene.
struct Tradeoff {
    std::string scene;
    std::string command;
    NamedValues settings;
    NamedValues versions;
    std::vector<std::string> notes;  ///< warnings, and what was left out for want of time
    Film reference;
    RenderSettings reference_settings;
    double reference_seconds = 0;
    bool reference_cached = false;   ///< made by an earlier run
    std::vector<TradePoint> points;  ///< standards first, then one knob at a time, then several
    DevelopSettings develop;
    bool interrupted = false;
};

/// The settings that are tried: the standard of each renderer, every other value of each of its knobs (a few of a
/// range), and at most `combinations` points that turn several, drawn without replacement. Path tracers are given at
/// most `most_spp` samples. Pure.
std::vector<TradePoint> plan_tradeoff(const TradeoffSettings& settings, std::uint64_t most_spp);

/// Renders `settings` and nothing else: what is timed. Must be callable again and again; what pictures share should be
/// kept from one call to the next.
using RenderCall = std::function<Film(const RenderSettings&, const Progress&)>;

/// Makes the reference (the Vulkan path tracer, 64 segments deep, as many samples as its share of the budget allows)
/// and measures the planned points against it in rounds, all points of a round in a random order, so that a machine
/// that gets slower hits them alike. After each round half of the combinations are given up, those furthest behind the
/// frontier first (successive halving: Karnin, Koren, Somekh 2013). Stops when the budget is spent or `progress` says
/// so, and keeps what it has.
Tradeoff measure_tradeoff(Tradeoff out, const TradeoffSettings& settings, const RenderCall& render,
                          const Progress& progress);

/// The options that make these settings on the command line, knobs at their standard values left out.
std::string flags_of(const RenderSettings& settings);

/// The table that a terminal prints.
std::string tradeoff_table(const Tradeoff& tradeoff);
/// One row a point, header first, RFC 4180.
std::string tradeoff_csv(const Tradeoff& tradeoff);
/// schema "etalon-tradeoff/1".
std::string tradeoff_json(const Tradeoff& tradeoff);
/// One page that needs no other file: the plot, whose points show their picture and error map, and the tables.
std::string tradeoff_html(const Tradeoff& tradeoff);

/// Writes tradeoff.{json,csv,html} and reference.exr into `folder`; the page last. Returns their paths, the page first.
std::vector<std::filesystem::path> write_tradeoff(const Tradeoff& tradeoff, const std::filesystem::path& folder);

}  // namespace etalon
