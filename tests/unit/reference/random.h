#pragma once
#include <cstdint>

#include "engine/math/types.h"
#include "shaders/shared/rng.h"

namespace etalon::test {

/// Numbers for tests: the same every time.
class Random {
 public:
    explicit Random(std::uint32_t seed) : seed_(seed) {}
    double uniform()  ///< [0, 1)
    {
        const uvec4 bits = shared::random_bits(seed_, count_++, 0, 0x7e57u);
        return static_cast<double>(((std::uint64_t{bits.x} << 32) | bits.y) >> 11) * 0x1p-53;
    }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    dvec2 square() { return {uniform(), uniform()}; }
    dvec3 box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    dvec3 direction()
    {
        const double z = uniform(-1, 1), phi = uniform(0, 2 * kPi), r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    /// On the upper half, z > 0.
    dvec3 upper_direction()
    {
        const dvec3 d = direction();
        return {d.x, d.y, std::abs(d.z)};
    }

 private:
    std::uint32_t seed_;
    std::uint32_t count_ = 0;
};

}  // namespace etalon::test
