#include "engine/math/transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/math/robust.h"

namespace etalon {
namespace {

void require(bool valid, const std::string& what)
{
    if (!valid) throw Error(Blame::input, what, "repair the camera, or choose another one");
}

}  // namespace

dmat4 compose(const dvec3& translation, const dquat& rotation, const dvec3& scale)
{
    // glTF files drift by 1e-4 from unit length; of a quaternion of no length the only thing left is "no rotation".
    const double largest =
        std::max({std::abs(rotation.w), std::abs(rotation.x), std::abs(rotation.y), std::abs(rotation.z)});
    const dquat q = largest > 0 ? glm::normalize(rotation * (1 / largest)) : dquat(1, 0, 0, 0);
    const dmat3 turned = glm::mat3_cast(q);
    return dmat4(dvec4(turned[0] * scale.x, 0), dvec4(turned[1] * scale.y, 0), dvec4(turned[2] * scale.z, 0),
                 dvec4(translation, 1));
}

dmat3 cofactor(const dmat3& m)
{
    return dmat3(robust_cross(m[1], m[2]), robust_cross(m[2], m[0]), robust_cross(m[0], m[1]));
}

dmat4 perspective(double yfov, double aspect, double near)
{
    require(yfov > 0 && yfov < kPi, fmt::format("the camera's yfov of {} rad is not between 0 and π", yfov));
    require(aspect > 0 && std::isfinite(aspect),
            fmt::format("the camera's aspect ratio of {} is not positive", aspect));
    require(near > 0 && std::isfinite(near), fmt::format("the camera's znear of {} m is not positive", near));
    const double f = 1 / std::tan(yfov / 2);
    return dmat4(dvec4(f / aspect, 0, 0, 0), dvec4(0, -f, 0, 0), dvec4(0, 0, 0, -1), dvec4(0, 0, near, 0));
}

dmat4 orthographic(double xmag, double ymag, double near, double far)
{
    require(xmag > 0 && ymag > 0 && std::isfinite(xmag) && std::isfinite(ymag),
            fmt::format("the camera's xmag {} and ymag {} are not positive", xmag, ymag));
    require(near < far && std::isfinite(near) && std::isfinite(far),
            fmt::format("the camera's znear {} m is not before its zfar {} m", near, far));
    const double depth = far - near;
    return dmat4(dvec4(1 / xmag, 0, 0, 0), dvec4(0, -1 / ymag, 0, 0), dvec4(0, 0, 1 / depth, 0),
                 dvec4(0, 0, far / depth, 1));
}

}  // namespace etalon
