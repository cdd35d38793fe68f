// Camera rays (docs/equations.md TR, engine/scene/pose.h): perspective, orthographic, thin lens.
#ifndef ETALON_PATH_CAMERA_GLSL
#define ETALON_PATH_CAMERA_GLSL
#include "shaders/lib/sampling.glsl"
#include "shaders/path/scene_data.glsl"

// The distance at which a ray enters the scene's bounds, 0 from inside or where it passes them by.
float entry_distance(vec3 origin, vec3 direction)
{
    vec3 inverse = 1.0 / direction;
    vec3 a = (frame.bounds_min - origin) * inverse;
    vec3 b = (frame.bounds_max - origin) * inverse;
    vec3 low = min(a, b);
    float t = max(low.x, max(low.y, low.z));
    vec3 high = max(a, b);
    bool meets = t <= min(high.x, min(high.y, high.z));
    return meets && t > 0.0 && t < kMaxFloat ? t : 0.0;
}

// The ray through film point `film` (0 … 1, from the top left) and lens point `lens` of the unit disk.
void camera_ray(vec2 film, vec2 lens, out vec3 origin, out vec3 direction)
{
    float x = (2.0 * film.x - 1.0) * frame.film_x;
    float y = (1.0 - 2.0 * film.y) * frame.film_y;
    origin = frame.eye;
    if (kOrthographic) {
        origin += x * frame.right + y * frame.up;
        direction = frame.forward;
    } else {
        direction = x * frame.right + y * frame.up + frame.forward;
    }
    if (kThinLens) {
        // All rays of a film point meet on the plane at the focus distance.
        vec3 focus = origin + frame.focus_distance * direction;
        vec3 shift = frame.lens_radius * (lens.x * frame.right + lens.y * frame.up);
        origin += shift;
        direction = focus - origin;
    }
    direction = robust_normalize(direction);
    // From the bounds on: far away, the traversal's distances would round by more than its boxes are padded (G16).
    origin += 0.999 * entry_distance(origin, direction) * direction;
}

#endif
