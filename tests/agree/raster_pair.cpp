#include "tests/agree/raster_pair.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>

#include "engine/reference/reference.h"
#include "engine/render/render.h"

namespace etalon::agree {

RasterBudget budget_of(const PosedScene& posed, const RenderSettings& settings, const gpu::DeviceLimits& limits)
{
    return raster_budget(posed, settings, {.subtexel_bits = limits.subtexel_bits, .mip_bits = limits.mip_bits});
}

Film by_device(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings)
{
    return render_raster(device, posed, require(posed, settings), settings, {});
}

Film by_reference_raster(const PosedScene& posed, RenderSettings settings)
{
    settings.renderer = Renderer::reference_raster;
    return reference::render_raster(posed, require(posed, settings), settings, {});
}

void expect_rasters_agree(gpu::Device& device, const std::string& what, const PosedScene& posed,
                          const RenderSettings& settings)
{
    const RasterBudget budget = budget_of(posed, settings, device.limits());
    const Film a = by_device(device, posed, settings);
    const Film b = by_reference_raster(posed, settings);
    const RasterAgreement found = compare_rasters(posed, settings, a, b, budget);
    std::cout << fmt::format(
        "{:28} budget {:.1e} + {:.1e}, worst {:.3f} of it; edge pixels {}; means differ by {:.1e} of {:.1e}\n", what,
        budget.relative, budget.absolute, found.worst, found.beyond, found.mean_error, found.mean_budget);
    EXPECT_TRUE(found.holds()) << what << ": " << found.unexplained << " pixels are not explained";
    EXPECT_EQ(a.nonfinite, b.nonfinite) << what;
}

}  // namespace etalon::agree
