#include "engine/math/transform.h"

#include <gmock/gmock.h>

#include "engine/base/error.h"

namespace etalon {
namespace {

void expect_rigid(const dmat4& m, const std::string& why)
{
    const dmat3 r(m);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(dot(r[i], r[j]), i == j ? 1 : 0, 1e-15) << why << " columns " << i << ' ' << j;
    EXPECT_NEAR(glm::determinant(r), 1, 1e-15) << why;
}

TEST(Cofactor, G28_keeps_normals_square_to_surfaces_under_any_scale)
{
    const dvec3 t(1, 0, -1), n(1, 1, 1);  // t lies in the plane of normal n
    for (const double ratio : {1.0, 10.0, 1e6})
        for (const double sign : {1.0, -1.0}) {
            const dmat3 m(dvec3(sign, 0, 0.3), dvec3(0.2, 1, 0), dvec3(0, -0.1, ratio));
            const dvec3 turned = normalize(cofactor(m) * n);
            EXPECT_NEAR(dot(turned, normalize(m * t)), 0, 1e-15) << ratio << ' ' << sign;
        }
    // A flattened axis has no inverse, yet the flat surface has a normal.
    const dmat3 flat(dvec3(2, 0, 0), dvec3(0, 0, 0), dvec3(0, 0, 2));
    EXPECT_EQ(normalize(cofactor(flat) * n), dvec3(0, 1, 0));
    const dmat3 m(dvec3(1, 2, 3), dvec3(4, 5, 6), dvec3(7, 8, 10));
    const dmat3 expected = glm::determinant(m) * glm::transpose(glm::inverse(m));
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) EXPECT_NEAR(cofactor(m)[c][r], expected[c][r], 1e-13);
}

TEST(Compose, scales_then_turns_then_moves)
{
    const dquat quarter(std::sqrt(0.5), 0, 0, std::sqrt(0.5));  // 90° about z: x to y (erratum E4)
    const dvec4 moved = compose(dvec3(10, 20, 30), quarter, dvec3(2, 3, 4)) * dvec4(1, 0, 0, 1);
    EXPECT_NEAR(moved.x, 10, 1e-14);
    EXPECT_NEAR(moved.y, 22, 1e-14);
    EXPECT_NEAR(moved.z, 30, 1e-14);
}

TEST(Compose, G31_takes_any_quaternion)
{
    const dquat q(0.5, 0.5, 0.5, 0.5);
    const dmat4 expected = compose(dvec3(0), q, dvec3(1));
    for (const double scale : {1e-200, 0.9999, -1.0, 1e200})
        expect_rigid(compose(dvec3(0), q * scale, dvec3(1)), "scaled");
    EXPECT_EQ(compose(dvec3(0), q * -1.0, dvec3(1)), expected) << "q and -q are one rotation";
    EXPECT_EQ(compose(dvec3(1, 2, 3), dquat(0, 0, 0, 0), dvec3(1))[3], dvec4(1, 2, 3, 1));
    expect_rigid(compose(dvec3(0), dquat(0, 0, 0, 0), dvec3(1)), "zero");
}

dvec3 project(const dmat4& clip, const dvec3& p)
{
    const dvec4 c = clip * dvec4(p, 1);
    return dvec3(c) / c.w;
}

TEST(Perspective, TF_4_maps_the_frustum_with_y_down_and_depth_reversed)
{
    const double yfov = 1.2, aspect = 16.0 / 9, near = 0.01;
    const dmat4 clip = perspective(yfov, aspect, near);
    const double top = std::tan(yfov / 2);  // of half the angle: erratum E5
    for (const double distance : {0.01, 1.0, 1e6}) {
        const dvec3 corner = project(clip, dvec3(top * aspect * distance, top * distance, -distance));
        EXPECT_NEAR(corner.x, 1, 1e-15);
        EXPECT_NEAR(corner.y, -1, 1e-15);
        EXPECT_NEAR(corner.z, near / distance, 1e-15);
    }
    EXPECT_EQ((clip * dvec4(0, 0, -2, 1)).w, 2);
}

TEST(Perspective, G7_planes_a_millionth_apart_never_swap_at_any_distance)
{
    const dmat4 clip = perspective(1, 1, 1);
    for (double distance = 1; distance < 1e12; distance *= 1.7) {
        const float front = float(project(clip, dvec3(0, 0, -distance)).z);
        const float behind = float(project(clip, dvec3(0, 0, -distance * (1 + 1e-6))).z);
        EXPECT_GT(front, behind) << distance;
    }
}

TEST(Perspective, G8_refuses_cameras_that_cannot_be)
{
    EXPECT_NO_THROW(perspective(1e-6, 1, 0.1));
    EXPECT_NO_THROW(perspective(179.9 * kPi / 180, 1, 0.1));
    for (const double yfov : {0.0, -1.0, kPi, 4.0, double(NAN)}) EXPECT_THROW(perspective(yfov, 1, 0.1), Error) << yfov;
    for (const double aspect : {0.0, -1.0, double(NAN), double(INFINITY)})
        EXPECT_THROW(perspective(1, aspect, 0.1), Error) << aspect;
    for (const double near : {0.0, -1.0, double(NAN), double(INFINITY)})
        EXPECT_THROW(perspective(1, 1, near), Error) << near;
}

TEST(Orthographic, TF_5_maps_its_box_with_depth_reversed)
{
    const dmat4 clip = orthographic(2, 3, 0.5, 100);
    const dvec3 near = project(clip, dvec3(2, 3, -0.5));
    EXPECT_EQ(near.x, 1);
    EXPECT_EQ(near.y, -1);
    EXPECT_NEAR(near.z, 1, 1e-15);
    const dvec3 far = project(clip, dvec3(-2, -3, -100));
    EXPECT_EQ(far.x, -1);
    EXPECT_EQ(far.y, 1);
    EXPECT_NEAR(far.z, 0, 1e-15);
    EXPECT_THROW(orthographic(0, 1, 0, 1), Error);
    EXPECT_THROW(orthographic(1, NAN, 0, 1), Error);
    EXPECT_THROW(orthographic(1, 1, 2, 1), Error);
    EXPECT_THROW(orthographic(1, 1, 0, INFINITY), Error);
}

}  // namespace
}  // namespace etalon
