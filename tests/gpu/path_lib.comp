// shaders/lib over a table: which function, and up to 16 numbers.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
#include "shaders/lib/absorption.glsl"
#include "shaders/lib/fresnel.glsl"
#include "shaders/lib/ggx.glsl"
#include "shaders/lib/numeric.glsl"
#include "shaders/lib/onb.glsl"
#include "shaders/lib/sampling.glsl"
#include "shaders/lib/sphere.glsl"
#include "shaders/lib/triangle.glsl"
#include "tests/gpu/path_lib.h"

layout(scalar, set = 0, binding = 0) readonly buffer Inputs { LibCall inputs[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };

vec4 call(LibCall row)
{
    vec4 a = row.a, b = row.b, c = row.c, d = row.d;
    float extra;
    vec2 both;
    bool hit;
    TriangleHit triangle;
    Frame basis;
    switch (row.function) {
        case kAtanTurns: return vec4(atan_turns(a.x, a.y), 0.0, 0.0, 0.0);
        case kCosSinTurns: return vec4(cos_sin_turns(a.x), 0.0, 0.0);
        case kDecodeSrgb: return vec4(decode_srgb(a.x), 0.0, 0.0, 0.0);
        case kNormalize: return vec4(robust_normalize(a.xyz), robust_length(a.xyz));
        case kDielectric:
            a.z = dielectric_fresnel(a.x, a.y, extra);
            return vec4(a.z, extra, 0.0, 0.0);
        case kConductor: return vec4(conductor_fresnel(a.x, a.y, a.z), 0.0, 0.0, 0.0);
        case kSchlick: return vec4(schlick_fresnel(a.xyz, a.w), 0.0);
        case kPowerHeuristic: return vec4(power_heuristic(a.x, a.y), power_heuristic(a.y, a.x), 0.0, 0.0);
        case kConeSolidAngle: return vec4(cone_solid_angle(a.x), 0.0, 0.0, 0.0);
        case kFrameX:
            basis = make_frame(a.xyz);
            return vec4(basis.x, dot(basis.x, basis.y));
        case kFrameY:
            basis = make_frame(a.xyz);
            return vec4(basis.y, 0.0);
        case kSphere:
            hit = intersect_sphere(a.xyz, b.xyz, c.xyz, c.w, both);
            return vec4(both, hit ? 1.0 : 0.0, 0.0);
        case kTriangle:
            triangle = intersect_triangle(make_ray_frame(vec3(a.w, b.w, c.w), d.xyz), a.xyz, b.xyz, c.xyz);
            return vec4(triangle.t, triangle.u, triangle.v, (triangle.hit ? 1.0 : 0.0) + (triangle.front ? 2.0 : 0.0));
        case kGgx: return vec4(ggx_d(a.xyz, a.w), ggx_v_correlated(b.x, b.y, a.w), ggx_g1(b.x, a.w), 0.0);
        case kVndf: return vec4(sample_ggx_vndf(a.xyz, a.w, b.xy), 0.0);
        case kAbsorbed:
            // A distance that the compiler knows, and one that it does not.
            return vec4(absorbed(a.xyz, a.w > 0.0 ? a.w : kMaxFloat).xy, absorbed(a.xyz, kMaxFloat).xy);
        case kCosine: return vec4(sample_cosine_hemisphere(a.xy), 0.0);
    }
    return vec4(0.0);
}

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    outputs[i] = call(inputs[i]);
}
