#include "engine/render/post.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <string>

#include "engine/gpu/commands.h"
#include "engine/image/post_plan.h"
#include "etalon_shaders.h"
#include "shaders/shared/post.h"

namespace etalon {
namespace {

/// What the steps of a plan work on.
class PostWork {
 public:
    PostWork(gpu::Device& device, const PostPlan& plan, const Film& film)
        : device_(device),
          table_(gpu::make_buffer(device, plan.table, "post table")),
          counts_(device, {.size = plan.counts ? shared::kPostBins * sizeof(std::uint32_t) : 0, .name = "post counts"}),
          cells_{gpu::Buffer(device, {.size = plan.cells * sizeof(vec4), .name = "post cells"}),
                 gpu::Buffer(device, {.size = plan.cells * sizeof(vec4), .name = "post cells blurred"})},
          nothing_(make_plane(1, 1, "no post plane"))
    {
        for (std::size_t i = 0; i < kPostPlanes; ++i) {
            if (!plan.planes[i]) continue;
            const auto plane = static_cast<PostPlane>(i);
            planes_[i] = make_plane(unsigned(film.width), unsigned(film.height), "post plane");
            if (plane == PostPlane::second || plane == PostPlane::third || plane == PostPlane::fourth) continue;
            const std::vector<float> texels = post_plane(film, plane);
            const gpu::ImagePart all{.texels = std::as_bytes(std::span(texels))};
            gpu::upload(device, planes_[i], std::span(&all, 1), gpu::ImageUse::storage);
        }
    }

    void record(gpu::Commands& commands, const PostPlan& plan)
    {
        for (gpu::Image& plane : planes_)
            if (plane) commands.prepare(plane, gpu::ImageUse::storage);
        commands.prepare(nothing_, gpu::ImageUse::storage);
        std::string_view pass;
        for (const PostStep& step : plan.steps) {
            // One region a pass, not a step; steps of one name in a row are one pass's or the same pass's twice.
            if (step.pass != pass && !pass.empty()) commands.end_region();
            if (step.pass != pass) commands.begin_region(std::string(step.pass));
            pass = step.pass;
            if (step.clears_counts) {
                commands.barrier(gpu::Work::compute, gpu::Work::copy);
                commands.fill(counts_, 0);
                commands.barrier(gpu::Work::copy, gpu::Work::compute);
            }
            const gpu::ComputePipeline& kernel = pipeline(step.shader);
            bindings_.push_back(bind(kernel, step));
            commands.bind(kernel, bindings_.back());
            commands.push_bytes(step.push);
            unsigned groups[3];
            for (int i = 0; i < 3; ++i) groups[i] = (step.invocations[i] + step.workgroup[i] - 1) / step.workgroup[i];
            commands.dispatch(groups[0], groups[1], groups[2]);
            commands.barrier(gpu::Work::compute, gpu::Work::compute);
        }
        if (!pass.empty()) commands.end_region();
    }

    std::vector<float> read(PostPlane plane) { return gpu::download_as<float>(device_, planes_[std::size_t(plane)]); }

 private:
    gpu::Image make_plane(unsigned width, unsigned height, const char* name)
    {
        return gpu::Image(device_, {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                    .width = width,
                                    .height = height,
                                    .usage = VK_IMAGE_USAGE_STORAGE_BIT,
                                    .name = name});
    }

    const gpu::Image& plane(PostPlane plane) const
    {
        const gpu::Image& image = planes_[std::size_t(plane)];
        return image ? image : nothing_;
    }

    const gpu::ComputePipeline& pipeline(std::string_view shader)
    {
        const auto found = pipelines_.find(shader);
        if (found != pipelines_.end()) return found->second;
        return pipelines_
            .emplace(shader, gpu::ComputePipeline(
                                 device_, {.shader = {etalon_shaders::find(shader), {}}, .name = std::string(shader)}))
            .first->second;
    }

    gpu::Bindings bind(const gpu::ComputePipeline& kernel, const PostStep& step) const
    {
        const int first = step.cells_swapped ? 1 : 0;
        return gpu::Bindings(device_, kernel.layout(),
                             {{0, plane(step.source)},
                              {1, plane(step.result)},
                              {2, plane(step.guide)},
                              {3, plane(PostPlane::albedo)},
                              {4, table_},
                              {5, counts_},
                              {6, cells_[std::size_t(first)]},
                              {7, cells_[std::size_t(1 - first)]},
                              {8, plane(step.variance_source)},
                              {9, plane(step.variance_result)}});
    }

    gpu::Device& device_;
    gpu::Buffer table_;
    gpu::Buffer counts_;
    std::array<gpu::Buffer, 2> cells_;
    gpu::Image nothing_;
    std::array<gpu::Image, kPostPlanes> planes_;
    std::map<std::string_view, gpu::ComputePipeline> pipelines_;
    std::vector<gpu::Bindings> bindings_;
};

}  // namespace

Film apply_post(gpu::Device& device, Film film, const PostChain& chain)
{
    const PostPlan plan = plan_post(chain, film);
    PostWork work(device, plan, film);
    gpu::Commands commands(device, "post");
    work.record(commands, plan);
    commands.submit();
    commands.wait(std::chrono::minutes(10));
    std::map<std::string, double> milliseconds;
    for (const gpu::RegionTime& time : commands.times()) milliseconds[time.name] += time.milliseconds;
    film = post_film(std::move(film), chain, work.read(plan.picture),
                     plan.keeps_variance ? work.read(plan.variance) : std::vector<float>{});
    for (const auto& [pass, time] : milliseconds)
        film.metadata["milliseconds.post " + pass] = fmt::format("{:.3f}", time);
    return film;
}

}  // namespace etalon
