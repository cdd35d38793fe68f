#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace etalon::golden {

/// One claim about a picture: SCENE.exr, made by the reference path tracer with `made_with` samples a pixel and seed 1,
/// is what the scene looks like. It is checked by rendering `spp` samples with `seed` and comparing by Welch's test
/// (ST-1 … ST-4) at `false_alarm` for the row. There is no tolerance to choose: both sides bring their variance.
struct Row {
    std::string_view scene;  ///< builtin
    int width;
    int height;
    std::uint64_t made_with;
    std::uint64_t spp;
    std::uint64_t seed;
    double false_alarm;
    /// The row is worthless unless it would find this relative difference of the whole picture with probability 0.9.
    double finds;
    std::string_view why;  ///< what a failure would mean
};

std::span<const Row> manifest();

}  // namespace etalon::golden
