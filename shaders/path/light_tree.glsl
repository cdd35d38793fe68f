// Which emitter next-event estimation draws, by a tree over them (Conty & Kulla 2018; engine/render/path_light_tree.h). The
// normal of the point that is lit takes no part: where its path hits an emitter, it is no longer known.
#ifndef ETALON_PATH_LIGHT_TREE_GLSL
#define ETALON_PATH_LIGHT_TREE_GLSL
#include "shaders/path/scene_data.glsl"
#include "shaders/shared/rng.h"

// Nodes come after the leaves, 3 texels each.
uvec4 load_light_node(uint node, uint texel) { return imageLoad(emitters, int(frame.emitter_count + 3u * node + texel)); }
uint left_leaves(uint node) { return load_light_node(node, 2u).w; }

// What the lights below a node may send to a point, up to a factor: power cos(theta') / distance^2, with theta' the least angle
// between a normal and the point that the bounds allow (the paper's equation 3 without the receiver's cosine).
float light_bound(uint node, vec3 from)
{
    vec4 low = uintBitsToFloat(load_light_node(node, 0u));
    vec4 high = uintBitsToFloat(load_light_node(node, 1u));
    vec3 axis = uintBitsToFloat(load_light_node(node, 2u).xyz);
    vec3 towards = 0.5 * (low.xyz + high.xyz) - from;
    vec3 extent = 0.5 * (high.xyz - low.xyz);
    float radius2 = dot(extent, extent);
    float distance2 = dot(towards, towards);

    float cos_axis = clamp(-dot(axis, towards) * inversesqrt(max(distance2, 1e-38)), -1.0, 1.0);
    float sin_axis = sqrt(1.0 - cos_axis * cos_axis);
    float cos_normals = high.w;
    float sin_normals = sqrt(max(1.0 - cos_normals * cos_normals, 0.0));
    // Less the cone of the normals, then less the angle that the bounding sphere fills; never below 0.
    bool within = cos_axis > cos_normals;
    float cos_left = within ? 1.0 : cos_axis * cos_normals + sin_axis * sin_normals;
    float sin_left = within ? 0.0 : sin_axis * cos_normals - cos_axis * sin_normals;
    float sin2_box = radius2 / max(distance2, 1e-38);
    float cos_box = sqrt(max(1.0 - sin2_box, 0.0));
    bool faces = sin2_box >= 1.0 || cos_left > cos_box;
    float cosine = faces ? 1.0 : cos_left * cos_box + sin_left * sqrt(sin2_box);
    return low.w * max(cosine, 0.0) / max(max(distance2, radius2), 1e-30);
}

// The chance of the left child; neither: negative.
float left_chance(vec3 from, uint node, uint left)
{
    float a = light_bound(node + 1u, from);
    float b = light_bound(node + 2u * left, from);
    return a + b > 0.0 ? a / (a + b) : -1.0;
}

// Turns of the loops below, for kernels that count theirs.
uint light_turns = 0u;

// Levels that one random number decides: each costs it about a bit.
const uint kLevelsPerNumber = 8u;

// A leaf and its chance; 0 where nothing below the root can light the point.
uint choose_leaf(vec3 from, uint pick, uint more, out float chance)
{
    uint node = 0u;
    uint first = 0u;
    float u = unit_float(pick);
    chance = 1.0;
    uint left = left_leaves(0u);
    for (uint level = 1u; left > 0u && chance > 0.0; ++level) {
        ++light_turns;
        float share = left_chance(from, node, left);
        bool goes_left = u < share;
        chance *= share < 0.0 ? 0.0 : (goes_left ? share : 1.0 - share);
        u = goes_left ? u / max(share, 1e-20) : (u - share) / max(1.0 - share, 1e-20);
        if (level % kLevelsPerNumber == 0u) {
            u = unit_float(more);
            more = pcg4d(uvec4(more)).x;
        }
        first += goes_left ? 0u : left;
        node += goes_left ? 1u : 2u * left;
        left = left_leaves(node);
    }
    return first;
}

// The chance with which choose_leaf draws `leaf`.
float leaf_chance(vec3 from, uint leaf)
{
    uint node = 0u;
    uint first = 0u;
    float chance = 1.0;
    uint left = left_leaves(0u);
    while (left > 0u && chance > 0.0) {
        ++light_turns;
        float share = left_chance(from, node, left);
        bool goes_left = leaf < first + left;
        chance *= share < 0.0 ? 0.0 : (goes_left ? share : 1.0 - share);
        first += goes_left ? 0u : left;
        node += goes_left ? 1u : 2u * left;
        left = left_leaves(node);
    }
    return chance;
}

// Of a point on an emitter, once that is chosen: over area; spheres are drawn by direction.
float per_area(PrimitiveData data)
{
    float twice = robust_length(cross(data.p1 - data.p0, data.p2 - data.p0));
    bool sphere = kSpheres && (data.flags & kPrimitiveSphere) != 0u;
    return sphere ? 1.0 : 2.0 / max(twice, 1e-38);
}

#endif
