#ifndef ETALON_LIB_ONB_GLSL
#define ETALON_LIB_ONB_GLSL

// A right-handed frame (x, y, n) for a unit n, orthonormal to 4u everywhere (G34; Duff et al. 2017).
struct Frame {
    vec3 x;
    vec3 y;
    vec3 n;
};

Frame make_frame(vec3 n)
{
    float sign_z = n.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (sign_z + n.z);
    float b = n.x * n.y * a;
    return Frame(vec3(1.0 + sign_z * n.x * n.x * a, sign_z * b, -sign_z * n.x), vec3(b, sign_z + n.y * n.y * a, -n.y), n);
}

vec3 to_local(Frame frame, vec3 v) { return vec3(dot(v, frame.x), dot(v, frame.y), dot(v, frame.n)); }
vec3 to_world(Frame frame, vec3 v) { return v.x * frame.x + v.y * frame.y + v.z * frame.n; }

#endif
