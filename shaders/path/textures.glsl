// Texture lookups at level 0 (SH-5, TX-3): the magnification filter, wrapping by integers, sRGB decoded before filtering.
#ifndef ETALON_PATH_TEXTURES_GLSL
#define ETALON_PATH_TEXTURES_GLSL
#include "shaders/path/scene_data.glsl"

struct TextureInfo {
    uint first;
    ivec2 size;
    uint flags;
};

TextureInfo load_texture_info(uint texture_index)
{
    uvec4 row = imageLoad(textures, int(texture_index));
    return TextureInfo(row.x, ivec2(row.y & 0xffffu, row.y >> 16), row.z);
}

// Both neighbours of x = coordinate * size - 1/2 along one axis, and how far x is between them.
struct Taps {
    int low;
    int high;
    float fraction;
};

Taps make_taps(float coordinate, int size, uint wrap, bool nearest)
{
    // Reduced to one period first, so that no coordinate leaves the integers; mirrored has a period of 2 (T5, T6).
    float period = wrap == 1u ? 2.0 : 1.0;
    float reduced = wrap == 2u ? clamp(coordinate, -1.0, 2.0) : coordinate - period * floor(coordinate / period);
    if (wrap == 1u && reduced > 1.0) reduced = 2.0 - reduced;
    float x = reduced * float(size) - (nearest ? 0.0 : 0.5);
    float below = floor(x);
    int low = int(below);
    int high = low + 1;
    if (wrap == 0u) {
        low = low < 0 ? size - 1 : low;
        low = low >= size ? 0 : low;
        high = high >= size ? 0 : high;
    }
    return Taps(clamp(low, 0, size - 1), clamp(high, 0, size - 1), nearest ? 0.0 : x - below);
}

vec4 load_texel(TextureInfo info, int x, int y, bool srgb)
{
    int index = int(info.first) + y * info.size.x + x;
    vec4 texel;
    if (kWideTexels && (info.flags & kTextureWide) != 0u) {
        texel = uintBitsToFloat(imageLoad(texels_wide, index));
    } else {
        texel = unpackUnorm4x8(imageLoad(texels_8, index).x);
    }
    if (srgb) texel.xyz = decode_srgb(texel.xyz);
    return texel;
}

vec4 sample_texture(uint texture_index, vec2 uv, bool srgb)
{
    TextureInfo info = load_texture_info(texture_index);
    bool nearest = (info.flags & kTextureNearest) != 0u;
    Taps u = make_taps(uv.x, info.size.x, info.flags & kTextureWrapU, nearest);
    Taps v = make_taps(uv.y, info.size.y, (info.flags >> kTextureWrapVShift) & kTextureWrapU, nearest);
    vec4 a = load_texel(info, u.low, v.low, srgb);
    vec4 b = load_texel(info, u.high, v.low, srgb);
    vec4 c = load_texel(info, u.low, v.high, srgb);
    vec4 d = load_texel(info, u.high, v.high, srgb);
    // a + f (b - a), so that a constant texture stays constant to the bit (A2, R15).
    vec4 top = a + u.fraction * (b - a);
    vec4 bottom = c + u.fraction * (d - c);
    return top + v.fraction * (bottom - top);
}

#endif
