// Where the levels of a picture lie in one image: level 0 at the top, the others side by side below it.
#ifndef ETALON_SHADERS_RASTER_LEVELS_GLSL
#define ETALON_SHADERS_RASTER_LEVELS_GLSL

ivec2 level_size(ivec2 whole, int level) { return max(whole >> level, ivec2(1)); }

int level_count(ivec2 whole) { return findMSB(max(whole.x, whole.y)) + 1; }

ivec2 level_corner(ivec2 whole, int level)
{
    if (level == 0) return ivec2(0);
    int x = 0;
    for (int i = 1; i < level; ++i) x += level_size(whole, i).x;
    return ivec2(x, whole.y);
}

#endif
