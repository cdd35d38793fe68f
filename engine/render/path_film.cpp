#include <bit>
#include <cstring>

#include "engine/base/error.h"
#include "engine/image/replicates.h"
#include "engine/render/path_state.h"

namespace etalon {

using gpu::Commands;
using gpu::Work;
using shared::PathPush;

/// Which pixels the pass at hand has not come to, by the order of generate.comp: columns of strips of 8 rows.
void PathTracer::State::mark_unreached()
{
    unreached.assign(std::size_t{width} * height, false);
    for (std::size_t b = band; b < bands.size(); ++b) {
        const PathBand& at = bands[b];
        const std::uint32_t rows = at.pixel_count / width;
        const std::uint32_t first = at.first_pixel - first_row * width;
        for (std::uint32_t k = b == band ? next_slot : 0; k < at.pixel_count; ++k) {
            if (scene.features.chosen_pixels) {  // in the order of their list
                unreached[first + k] = true;
                continue;
            }
            const std::uint32_t strip = k / (8 * width);
            const std::uint32_t within = k - strip * 8 * width;
            const std::uint32_t tall = std::min(8u, rows - strip * 8);
            unreached[first + (strip * 8 + within % tall) * width + within / tall] = true;
        }
    }
}

/// A film of no samples.
PathSamples PathTracer::State::nothing() const
{
    return {.sums = std::vector<FilmSum>(scene.features.replicates(), FilmSum(int(width), int(height)))};
}

/// Adds the block on the device, with its samples that were not finite and the paths cut by the depth limit.
void PathTracer::State::read_block(PathSamples& samples) const
{
    const std::size_t pixels = std::size_t{width} * height;
    const std::size_t replicates = samples.sums.size();
    std::vector<std::vector<vec4>> means, deviations;
    for (const PathBand& at : bands) {
        means.push_back(gpu::read_back<vec4>(*device, at.mean, replicates * at.pixel_count));
        deviations.push_back(gpu::read_back<vec4>(*device, at.m2, replicates * at.pixel_count));
    }
    std::vector<float> mean(3 * pixels), m2(3 * pixels), alpha(pixels);
    for (std::size_t r = 0; r < replicates; ++r) {
        const std::uint64_t taken = samples_of_replicate(in_block, r, replicates);
        for (std::size_t b = 0; b < bands.size(); ++b) {
            const PathBand& at = bands[b];
            for (std::size_t i = 0; i < at.pixel_count; ++i) {
                const std::size_t pixel = at.first_pixel - first_row * width + i;
                if (!unreached.empty() && unreached[pixel]) continue;
                const vec4& from = means[b][r * at.pixel_count + i];
                const vec4& scatter = deviations[b][r * at.pixel_count + i];
                const std::uint32_t counts = std::bit_cast<std::uint32_t>(scatter.w);
                const std::uint32_t bad = counts & 0xffffu;
                samples.nonfinite += bad;
                samples.truncated += counts >> 16;
                // A pixel that lost samples stands for as many as the others, with the spread of those it has (M13).
                const double scale = bad < taken ? double(taken) / double(taken - bad) : 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    mean[3 * pixel + c] = from[int(c)];
                    m2[3 * pixel + c] = static_cast<float>(scatter[int(c)] * scale);
                }
                alpha[pixel] = from.w;
            }
        }
        samples.sums[r].add_block(mean, m2, alpha, taken);
    }
}

void PathTracer::State::read_aovs(Film& film)
{
    const std::size_t pixels = std::size_t{width} * height;
    Aovs& out = film.aovs;
    out.depth.resize(pixels);
    out.normal.resize(pixels);
    out.albedo.resize(pixels);
    out.emission.resize(pixels);
    out.object_id.resize(pixels);
    out.material_id.resize(pixels);
    out.uv.resize(pixels);
    for (PathBand& at : bands) {
        for (std::uint32_t slot = 0; slot < at.pixel_count; slot += kWaveCapacity) {
            PathPush push{};
            push.first_slot = slot;
            push.slot_count = std::min(kWaveCapacity, at.pixel_count - slot);
            push.pixel_count = at.pixel_count;
            push.first_pixel = at.first_pixel;
            Commands commands(*device, "path AOVs");
            trace_centres(commands, at, push);
            launch(commands, at, kernels.aovs, push, groups_for(push.slot_count));
            finish(commands);
        }
        const std::vector<vec4> values = gpu::read_back<vec4>(*device, aovs, 4 * std::size_t{at.pixel_count});
        for (std::size_t i = 0; i < at.pixel_count; ++i) {
            const std::size_t pixel = at.first_pixel - first_row * width + i;
            const vec4* v = &values[4 * i];
            out.normal[pixel] = vec3(v[0]);
            out.depth[pixel] = v[0].w;
            out.albedo[pixel] = vec3(v[1]);
            out.object_id[pixel] = std::bit_cast<std::uint32_t>(v[1].w);
            out.emission[pixel] = vec3(v[2]);
            out.material_id[pixel] = std::bit_cast<std::uint32_t>(v[2].w);
            out.uv[pixel] = vec2(v[3]);
        }
    }
}

/// Of all completed passes: the blocks summed up, and the block at hand as the device has it.
FilmState PathTracer::State::save() const
{
    FilmState out{.of = {},
                  .width = static_cast<int>(width),
                  .height = static_cast<int>(height),
                  .samples = first_of_block + in_block,
                  .nonfinite = total.nonfinite,
                  .truncated = total.truncated,
                  .sums = {},
                  .block_samples = in_block,
                  .block = {}};
    for (const FilmSum& sum : total.sums) {
        const std::vector<double> numbers = sum.state();
        out.sums.insert(out.sums.end(), numbers.begin(), numbers.end());
    }
    if (in_block == 0) return out;
    for (const PathBand& at : bands)
        for (const gpu::Buffer* values : {&at.mean, &at.m2}) {
            const std::vector<float> floats = gpu::read_back<float>(*device, *values, floats_of(at));
            out.block.insert(out.block.end(), floats.begin(), floats.end());
        }
    return out;
}

void PathTracer::State::restore(const FilmState& state)
{
    std::size_t floats = 0;
    for (const PathBand& at : bands) floats += 2 * floats_of(at);
    PathSamples blank = nothing();
    const std::size_t replicates = blank.sums.size(), each = state.sums.size() / replicates;
    if (state.width != int(width) || state.height != int(height) || state.block_samples > state.samples ||
        state.block_samples > kBlockSamples || state.block.size() != (state.block_samples > 0 ? floats : 0) ||
        state.sums.size() % replicates != 0)
        throw Error(Blame::input, "this picture cannot go on from the state of another one");
    for (std::size_t r = 0; r < replicates; ++r)
        blank.sums[r].restore(std::span(state.sums).subspan(r * each, each),
                              samples_of_replicate(state.samples - state.block_samples, r, replicates));
    total = std::move(blank);
    total.nonfinite = state.nonfinite;
    total.truncated = state.truncated;
    first_of_block = state.samples - state.block_samples;
    in_block = state.block_samples;
    std::span<const float> rest(state.block);
    for (const PathBand& at : bands)
        for (const gpu::Buffer* values : {&at.mean, &at.m2}) {
            if (rest.empty()) return;
            gpu::upload(*device, *values, rest.first(floats_of(at)));
            rest = rest.subspan(floats_of(at));
        }
}

Film PathTracer::film()
{
    State& s = *state_;
    PathSamples all = s.total;
    if (s.in_block > 0) s.read_block(all);
    Film film = film_of(all.sums);
    film.nonfinite = all.nonfinite;
    film.truncated = all.truncated;
    if (s.wants_aovs) s.read_aovs(film);
    if (!s.unreached.empty())
        film.metadata["pixels.unreached"] = std::to_string(std::count(s.unreached.begin(), s.unreached.end(), true));
    return film;
}

FilmState PathTracer::state() const
{
    return state_->save();
}

void PathTracer::resume(const FilmState& state)
{
    State& s = *state_;
    resume(s.nothing());
    s.restore(state);
}

}  // namespace etalon
