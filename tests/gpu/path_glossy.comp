// sample_glossy and eval_glossy over a table, with every layer compiled in.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
#include "tests/gpu/path_glossy.h"
const bool kSpecularGlossiness = true;
const bool kSpecular = true;
const bool kClearcoat = true;
const bool kSheen = true;
const bool kTransmission = true;
const bool kVolume = true;
const bool kIridescence = true;
const bool kAnisotropy = true;
const bool kDispersion = true;
const bool kDiffuseTransmission = true;
const bool kGlassShadows = true;
vec4 albedo_cell(int index) { return vec4(kTestAlbedo); }
#include "shaders/lib/glossy.glsl"
#include "shaders/shared/rng.h"

layout(scalar, set = 0, binding = 0) readonly buffer Inputs { GlossyCall inputs[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { GlossyResult outputs[]; };

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    const GlossyCall row = inputs[i];
    const float seen = kTestAlbedo / row.sheen_roughness;
    const Glossy g = Glossy(row.diffuse, row.f0, row.hat0, row.f90, row.boost, row.alpha, row.alphas, row.film, row.film_ior,
                            row.film_nanometres, row.film_base, row.film_specular, row.film_metal, row.metallic,
                            row.diffuse_through, row.through, row.body != 0u, row.excess, row.inner, row.sheen,
                            row.sheen_roughness, seen, row.coat, row.coat_alpha, row.coat_n, row.ng, vec3(0.0));
    GlossyResult result;
    result.wi = row.wi;
    if (row.sampled != 0u) {
        const uvec4 bits = random_bits(row.index, 0u, 0u, 77u);
        const GlossySample drawn = sample_glossy(g, row.wo, vec3(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z)));
        result.wi = drawn.wi;
        result.value = drawn.straight;
        result.pdf = 0.0;
        if (drawn.straight == vec3(0.0) && drawn.wi != vec3(0.0)) {
            const vec3 value = eval_glossy(g, row.wo, drawn.wi, result.pdf);
            result.value = result.pdf > 0.0 ? value / result.pdf : vec3(0.0);
        }
    } else {
        result.value = eval_glossy(g, row.wo, row.wi, result.pdf);
    }
    outputs[i] = result;
}
