#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/reference/raster_geometry.h"
#include "engine/reference/raster_shade.h"

namespace etalon::reference {

/// Far enough for everything, metres along the viewing axis, for orthographic depth (TF-5).
double far_plane(const PosedScene& posed, const CameraRays& camera);

inline constexpr std::size_t kMostSamples = 16;
using SampleDepths = std::array<double, kMostSamples>;

/// Some rows of the picture with all their samples.
class Band {
 public:
    /// Rows y0 ≤ y < y1, with settings.msaa samples a pixel, all showing the background.
    Band(const World& world, const RasterShader& shader, int y0, int y1, const RenderSettings& settings);

    /// What transmitting pieces show from now on.
    void set_behind(const PictureBehind* behind) { behind_ = behind; }

    /// `blend`: over what is there, without depth writes.
    void draw(const Piece& piece, bool blend);

    /// Mean of the samples (SH-30): radiance and coverage.
    dvec4 resolve(int x, int y) const;
    /// The same of what has been drawn, without the background: premultiplied.
    dvec4 resolve_drawn(int x, int y) const;

 private:
    std::size_t at(int x, int y) const
    {
        return (static_cast<std::size_t>(y - y0_) * static_cast<std::size_t>(posed_->view.width) +
                static_cast<std::size_t>(x)) *
               positions_.size();
    }

    FixedPoint sample_point(int x, int y, std::size_t s) const
    {
        return {x * kSubPixels + positions_[s].x, y * kSubPixels + positions_[s].y};
    }

    void draw_triangle(const Piece& piece, int x, int y, bool blend);
    void draw_sphere(const Piece& piece, int x, int y, bool blend);
    std::optional<Fragment> triangle_fragment(const Piece& piece, int x, int y, const FixedPoint& covered) const;
    double depth_of(double distance) const;
    /// What is kept and compared of a reversed depth, greater is nearer (TF-7).
    double kept(double reversed) const;
    void write(int x, int y, const SampleDepths& depth, const Fragment& fragment, bool blend);

    const World* world_;
    const PosedScene* posed_;
    const RasterShader* shader_;
    const PictureBehind* behind_ = nullptr;
    int y0_, y1_;
    double far_;
    DepthKind kind_;
    double forward_far_;  ///< (TF-7)
    std::vector<FixedPoint> positions_;
    std::vector<dvec4> color_;
    std::vector<double> depth_;
};

}  // namespace etalon::reference
