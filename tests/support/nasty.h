#pragma once
// One table of extremes for every kind of test (DESIGN §6, NUMERICS §3): each value with the reason why it is here.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/math/types.h"

namespace etalon::nasty {

template <typename T>
struct Value {
    const char* why;
    T value;
};

/// Finite scalars: zeros, denormals, neighbours of one, the limits of exact integers, very small and very large.
template <typename T>
std::vector<Value<T>> finite()
{
    using Limits = std::numeric_limits<T>;
    return {
        {"zero", T(0)},
        {"negative zero", -T(0)},
        {"smallest denormal", Limits::denorm_min()},
        {"largest denormal", std::nextafter(Limits::min(), T(0))},
        {"smallest normal", Limits::min()},
        {"1e-30", T(1e-30L)},
        {"1e-18", T(1e-18L)},
        {"1e-12", T(1e-12L)},
        {"1e-6", T(1e-6L)},
        {"just below one", std::nextafter(T(1), T(0))},
        {"one", T(1)},
        {"just above one", std::nextafter(T(1), T(2))},
        {"minus one", T(-1)},
        {"1e6", T(1e6L)},
        {"first odd integer that float lacks", T(16777217)},
        {"2^31", T(2147483648.0L)},
        {"2^32", T(4294967296.0L)},
        {"1e12", T(1e12L)},
        {"1e18", T(1e18L)},
        {"1e30", T(1e30L)},
        {"largest", Limits::max()},
        {"lowest", Limits::lowest()},
    };
}

template <typename T>
std::vector<Value<T>> not_finite()
{
    using Limits = std::numeric_limits<T>;
    return {{"+Inf", Limits::infinity()},
            {"-Inf", -Limits::infinity()},
            {"NaN", Limits::quiet_NaN()},
            {"NaN of the other sign", -Limits::quiet_NaN()},
            {"signalling NaN", Limits::signaling_NaN()}};
}

template <typename T>
std::vector<Value<T>> scalars()
{
    std::vector<Value<T>> all = finite<T>();
    for (const Value<T>& value : not_finite<T>()) all.push_back(value);
    return all;
}

struct Triangle {
    const char* why;
    std::array<vec3, 3> positions;
};

/// Finite triangles at which a normal, an area or a barycentric may break.
inline std::vector<Triangle> triangles()
{
    return {
        {"needle 10^6 : 1", {vec3(0, 0, 0), vec3(1e6f, 0, 0), vec3(5e5f, 1, 0)}},
        {"cap: apex on the base but for 1e-6", {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0.5f, 1e-6f, 0)}},
        {"two equal vertices", {vec3(1, 2, 3), vec3(1, 2, 3), vec3(4, 5, 6)}},
        {"three equal vertices", {vec3(1, 2, 3), vec3(1, 2, 3), vec3(1, 2, 3)}},
        {"collinear", {vec3(0, 0, 0), vec3(1, 1, 1), vec3(2, 2, 2)}},
        {"edge on to -z", {vec3(0, 0, -1), vec3(0, 1, -1), vec3(0, 0, -2)}},
        {"area 1e-30", {vec3(0, 0, 0), vec3(1e-15f, 0, 0), vec3(0, 1e-15f, 0)}},
        {"span 1e30", {vec3(0, 0, 0), vec3(1e30f, 0, 0), vec3(0, 1e30f, 0)}},
        {"far from the origin",
         {vec3(148376, 1234, -223423), vec3(148377, 1234, -223423), vec3(148376, 1235, -223423)}},
        {"one vertex behind the eye", {vec3(-1, 0, -1), vec3(1, 0, -1), vec3(0, 0, 1)}},
        {"plane through the eye", {vec3(-1, 0, -1), vec3(1, 0, -1), vec3(0, 0, 0)}},
    };
}

}  // namespace etalon::nasty
