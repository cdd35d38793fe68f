// Sheen: (SH-61), Estevez & Kulla 2017. Free of bindings.
#ifndef ETALON_LIB_SHEEN_GLSL
#define ETALON_LIB_SHEEN_GLSL

float sheen_alpha(float roughness)
{
    const float r = max(roughness, 0.07);
    return r * r;
}

// D_s from sin² of the half vector's angle to the normal.
float sheen_d(float sine2_h, float alpha)
{
    return (2.0 + 1.0 / alpha) * pow(max(sine2_h, 1e-30), 0.5 / alpha) / 6.28318530717958647692;
}

float sheen_log_lambda(float x, float alpha)
{
    const float k = (1.0 - alpha) * (1.0 - alpha);
    const float a = mix(21.5473, 25.3245, k);
    const float b = mix(3.82987, 3.32435, k);
    const float c = mix(0.19823, 0.16801, k);
    const float d = mix(-1.97760, -1.27393, k);
    const float e = mix(-4.32054, -4.85967, k);
    return a / (1.0 + b * pow(max(x, 1e-30), c)) + d * x + e;
}

float sheen_lambda(float cosine, float alpha)
{
    if (cosine < 0.5) return exp(sheen_log_lambda(cosine, alpha));
    return exp(2.0 * sheen_log_lambda(0.5, alpha) - sheen_log_lambda(1.0 - cosine, alpha));
}

// V n·wi: finite at the horizon.
float sheen_v_cos(float cos_i, float cos_o, float alpha)
{
    return 1.0 / ((1.0 + sheen_lambda(cos_i, alpha) + sheen_lambda(cos_o, alpha)) * 4.0 * cos_o);
}

#endif
