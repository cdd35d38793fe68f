// Camera rays (docs/equations.md TR, engine/scene/pose.h): perspective, orthographic, equirectangular, thin lens.
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

// Uniform over the aperture: the unit disk, or the regular polygon of frame.lens_blades corners in it, the first at +x (TF-8).
vec2 sample_aperture(vec2 u)
{
    if (frame.lens_blades < 3u) return sample_disk(u);
    // One of the triangles about the centre, and a point of it.
    float blades = float(frame.lens_blades);
    float scaled = u.x * blades;
    float blade = min(floor(scaled), blades - 1.0);
    vec2 b = sample_triangle(vec2(scaled - blade, u.y));
    float next = blade + 1.0 < blades ? blade + 1.0 : 0.0;
    return b.x * cos_sin_turns(blade / blades) + b.y * cos_sin_turns(next / blades);
}

// The ray through film point `film` (0 … 1, from the top left) and lens point `lens` of the unit disk.
void camera_ray(vec2 film, vec2 lens, out vec3 origin, out vec3 direction)
{
    float x = (2.0 * film.x - 1.0) * frame.film_x;
    float y = (1.0 - 2.0 * film.y) * frame.film_y;
    origin = frame.eye;
    if (kEquirectangular) {  // (TF-9)
        vec2 polar = cos_sin_turns(0.5 * film.y);
        float turn = film.x - 0.5;
        vec2 around = cos_sin_turns(turn < 0.0 ? turn + 1.0 : turn);
        direction = polar.y * (around.y * frame.right + around.x * frame.forward) + polar.x * frame.up;
    } else if (kOrthographic) {
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
