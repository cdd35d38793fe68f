#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

/// What of a scene an animation has changed at one instant, by index. What is absent is as the scene has it.
struct Motion {
    std::map<Index, Trs> nodes;
    std::map<Index, std::vector<double>> weights;       ///< by node
    std::map<Index, std::vector<double>> mesh_weights;  ///< by mesh
    std::map<Index, bool> visible;                      ///< by node
    std::map<Index, Material> materials;
    std::map<Index, Light> lights;
    std::map<Index, Camera> cameras;
};

/// Something that a channel can move.
struct AnimatedProperty {
    /// Where it is in a glTF document; {} is the object's index. The pointers of KHR_animation_pointer, and what the
    /// core's target paths mean.
    std::string pointer;
    /// Numbers of a value; 0: as many as the object has (weights).
    std::size_t width = 1;
    bool is_rotation = false;  ///< a quaternion x y z w: interpolated on the sphere
    /// What a value may be: splines overshoot, and are held to it.
    double low = 0, high = 0;
    std::function<void(const Scene& scene, Index object, std::span<const double> value, Motion& motion)> set;
};
std::span<const AnimatedProperty> animated_properties();

/// A row of the table and what its {} stands for.
struct PropertyPlace {
    Index property = 0;
    Index object = 0;
};
/// The property that a pointer names; nothing when no row does. The object need not exist.
std::optional<PropertyPlace> find_property(std::string_view pointer);

/// The sampler's value at `time` seconds, `width` numbers: before the first and after the last key their values
/// (promise G37; of equal times the last key counts). Linear rotations turn at constant speed the short way round
/// (G32); cubic ones are made unit.
std::vector<double> sample(const AnimationSampler& sampler, double time, bool is_rotation);

/// Between unit quaternions, the short way; u in [0, 1]. Ends are exact, and nothing is lost where they are (nearly)
/// equal or where the turn between them is near 180 degrees; at 180 degrees exactly it goes towards `b` as given, not
/// -b. G32, with the angle of A5.
dquat slerp(const dquat& a, const dquat& b, double u);

/// Adds everything that the animation moves, at `time` seconds, to `motion`. Error(input) where a value is beyond every
/// number.
void evaluate(const Scene& scene, const Animation& animation, double time, Motion& motion);

/// The animation of that name, else that index. Error(input) that lists what there is.
const Animation& find_animation(const Scene& scene, const std::string& name_or_index);

}  // namespace etalon
