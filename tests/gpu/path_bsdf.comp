// sample_bsdf and eval_bsdf over a table.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
const bool kMetallicRoughness = true;
const bool kLambert = true;
const bool kMirror = true;
const bool kRoughConductor = true;
const bool kDielectric = true;
const bool kRoughDielectric = true;
const bool kSpecularGlossiness = false;
const bool kSpecular = false;
const bool kClearcoat = false;
const bool kSheen = false;
const bool kTransmission = false;
const bool kVolume = false;
const bool kIridescence = false;
const bool kAnisotropy = false;
const bool kDispersion = false;
const bool kDiffuseTransmission = false;
const bool kGlassShadows = false;
vec4 albedo_cell(int index) { return vec4(1.0); }
#include "shaders/lib/bsdf.glsl"
#include "shaders/shared/rng.h"
#include "tests/gpu/path_bsdf.h"

layout(scalar, set = 0, binding = 0) readonly buffer Inputs { BsdfCall inputs[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { BsdfResult outputs[]; };

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    const BsdfCall row = inputs[i];
    const Bsdf bsdf = Bsdf(row.model, row.diffuse, row.alpha, row.eta, row.k, row.excess,
                           plain_glossy(row.diffuse, row.f0, row.alpha));
    BsdfResult result;
    if (row.sampled != 0u) {
        const uvec4 bits = random_bits(row.index, 0u, 0u, 77u);
        const BsdfSample drawn = sample_bsdf(bsdf, row.wo, vec3(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z)));
        result = BsdfResult(drawn.wi, drawn.pdf, drawn.weight);
    } else {
        result.wi = row.wi;
        result.value = eval_bsdf(bsdf, row.wo, row.wi, result.pdf);
    }
    outputs[i] = result;
}
