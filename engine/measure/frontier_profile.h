#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/types.h"
#include "engine/measure/tradeoff.h"
#include "engine/scene/settings.h"

namespace etalon {

/// What the frontier of one scene said about the rasterizer's settings: the model by which settings are chosen later.
struct FrontierProfile {
    struct Point {
        RenderSettings settings;
        double seconds = 0;        ///< of a picture of `size`, scene and pipelines being there
        double first_seconds = 0;  ///< of the first one, which makes them
        double error = 0;          ///< root mean square against the reference, relative to the mean radiance
    };
    ivec2 size{0};              ///< at which it was measured, pixels
    std::vector<Point> points;  ///< in the order of Tradeoff::points

    /// Of the first picture of another size: what is made for the scene, and pixels at their pace.
    double seconds(const Point& point, ivec2 picture) const;
    /// The fastest point whose error is at most `error`; nothing where all have more.
    const Point* within_error(double error, ivec2 picture) const;
    /// The point of the least error that takes at most `seconds`; nothing where all take more.
    const Point* within_time(double seconds, ivec2 picture) const;
    const Point* most_accurate() const;         ///< null without points
    const Point* fastest(ivec2 picture) const;  ///< likewise
};

/// The rasterizer's points of a measured frontier.
FrontierProfile profile_of(const Tradeoff& tradeoff);

/// Profiles in a folder, each by a key that says all that it depends on: the content of the scene, the device, the
/// build. A profile of another key is not found, which is how it expires; what is damaged counts as absent. When there
/// are more than `most` files, those not used for longest go.
class ProfileStore {
 public:
    explicit ProfileStore(std::filesystem::path folder, std::size_t most = 256);

    std::optional<FrontierProfile> find(const std::string& key) const;
    /// False where it could not be kept: a full disk is no failure of what it was made for.
    bool keep(const std::string& key, const FrontierProfile& profile) const;

 private:
    std::filesystem::path file_of(const std::string& key) const;
    void sweep() const;

    std::filesystem::path folder_;
    std::size_t most_;
};

}  // namespace etalon
