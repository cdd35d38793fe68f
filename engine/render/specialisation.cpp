#include "engine/render/specialisation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "engine/base/error.h"
#include "engine/render/costs.h"
#include "engine/render/path.h"
#include "engine/render/raster.h"

namespace etalon {
namespace {

constexpr int kRounds = 5;
constexpr int kRequirementRounds = 3;
/// Of the budget for the two ways; the rest is for single requirements.
constexpr double kShareOfWays = 0.5;

class Clock {
 public:
    Spent spent() const
    {
        return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(),
                double(std::clock() - cpu_) / CLOCKS_PER_SEC};
    }

 private:
    std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
    std::clock_t cpu_ = std::clock();
};

Spent operator-(const Spent& a, const Spent& b)
{
    return {a.wall - b.wall, a.cpu - b.cpu};
}

double median(std::vector<double> values)
{
    assume(!values.empty());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Spent median(const std::vector<Spent>& values)
{
    std::vector<double> wall, cpu;
    for (const Spent& value : values) {
        wall.push_back(value.wall);
        cpu.push_back(value.cpu);
    }
    return {median(wall), median(cpu)};
}

double half_range(const std::vector<Spent>& values, double Spent::*part)
{
    const auto [low, high] = std::minmax_element(values.begin(), values.end(),
                                                 [&](const Spent& a, const Spent& b) { return a.*part < b.*part; });
    return ((*high).*part - (*low).*part) / 2;
}

/// A scene on a device by one way.
class Way {
 public:
    Way(gpu::Device& device, const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
        : settings_(settings), view_(posed.view)
    {
        const std::uint64_t before = device.memory().in_use;
        const Clock clock;
        if (settings.renderer == Renderer::raster)
            raster_.emplace(device, posed, required, settings);
        else
            tracer_.emplace(device, posed, required, settings);
        first = draw();
        started_ = clock.spent();
        cost.memory = device.memory().in_use - before;
    }

    Film draw()
    {
        if (raster_) {
            raster_->draw(view_);
            return raster_->read();
        }
        tracer_->start(view_, settings_.seed);
        while (tracer_->samples() < settings_.spp) tracer_->step(settings_.spp);
        return tracer_->film();
    }

    Spent again()
    {
        const Clock clock;
        static_cast<void>(draw());
        cost.pictures.push_back(clock.spent());
        cost.start = started_ - median(cost.pictures);
        return cost.pictures.back();
    }

    WayCost cost;
    Film first;

 private:
    const RenderSettings& settings_;
    const View& view_;
    std::optional<RasterScene> raster_;
    std::optional<PathTracer> tracer_;
    Spent started_;
};

RequirementTime measure_without(gpu::Device& device, Way& special, const PosedScene& posed,
                                const RenderSettings& settings, Feature feature)
{
    RequirementTime out{.feature = feature};
    try {
        Way without(device, posed, require_without(posed, settings, feature), settings);
        std::vector<Spent> differences;
        for (int round = 0; round < kRequirementRounds; ++round) {
            const Spent with = special.again();
            differences.push_back(with - without.again());
        }
        out.start = special.cost.start - without.cost.start;
        out.picture = median(differences);
        out.scatter = {half_range(differences, &Spent::wall), half_range(differences, &Spent::cpu)};
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const Error& error) {
        if (error.blame() != Blame::input) throw;
        out.needed = true;
    }
    return out;
}

std::optional<std::uint64_t> pictures_until(double more_at_start, double less_a_picture)
{
    if (more_at_start <= 0) return less_a_picture >= 0 ? std::optional<std::uint64_t>(0) : std::nullopt;
    if (less_a_picture <= 0) return std::nullopt;
    return static_cast<std::uint64_t>(std::ceil(std::min(more_at_start / less_a_picture, 1e18)));
}

}  // namespace

double Specialisation::picture(const WayCost& way) const
{
    return seconds(median(way.pictures));
}

std::optional<std::uint64_t> Specialisation::break_even() const
{
    return pictures_until(start(special) - start(uber), picture(uber) - picture(special));
}

std::optional<std::uint64_t> Specialisation::break_even_with_cache() const
{
    return pictures_until(start(special), picture(uber) - picture(special));
}

Specialisation measure_specialisation(const gpu::DeviceOptions& options, const PosedScene& whole,
                                      const PosedScene& posed, const RenderSettings& settings, double budget,
                                      const Progress& progress)
{
    const Requirements required = require(posed, settings);
    const Clock clock;
    {
        // The first device of a process also loads drivers and compilers, which is no cost of either way.
        progress.report({.stage = "warming up"});
        gpu::Device device(options);
        Way(device, posed, required, settings);
    }
    gpu::Device device(options), other(options);
    Specialisation out{.device = device.description(), .software = device.kind() == gpu::DeviceKind::cpu};
    progress.report({.stage = "as the scene requires it"});
    Way special(device, posed, required, settings);
    progress.report({.stage = "with everything on"});
    Way uber(other, whole, everything(require(whole, settings)), settings);
    out.identical = special.first.mean == uber.first.mean && special.first.alpha == uber.first.alpha &&
                    special.first.variance == uber.first.variance;
    for (int round = 0; round < kRounds; ++round) {
        if (round > 0 && (progress.stopped() || clock.spent().wall > kShareOfWays * budget)) break;
        // Neither way is always the first of a pair.
        if (round % 2 == 0) special.again();
        uber.again();
        if (round % 2 != 0) special.again();
    }
    out.uber = uber.cost;
    out.special = special.cost;
    for (std::size_t i = 0; i < kFeatureCount; ++i) {
        if (!required.bits[i]) continue;
        if (progress.stopped() || clock.spent().wall > budget) {
            ++out.unmeasured;
            continue;
        }
        const auto feature = static_cast<Feature>(i);
        progress.report({.stage = name(feature), .fraction = std::min(clock.spent().wall / budget, 1.0)});
        out.requirements.push_back(measure_without(device, special, posed, settings, feature));
    }
    return out;
}

}  // namespace etalon
