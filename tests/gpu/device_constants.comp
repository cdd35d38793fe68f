#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 8, local_size_y = 4) in;
layout(constant_id = 0) const bool kFlag = false;
layout(constant_id = 1) const int kInteger = 0;
layout(constant_id = 2) const uint kUnsigned = 0u;
layout(constant_id = 7) const float kNumber = 0.0;
layout(push_constant, scalar) uniform Push {
    vec3 pushed;
    uint last;
};
layout(set = 0, binding = 3) writeonly buffer Results { uint results[]; };
layout(set = 2, binding = 0) uniform Block { vec4 block; };
layout(set = 2, binding = 1) uniform sampler2D textures[3];

void main()
{
    if (gl_GlobalInvocationID.x + gl_GlobalInvocationID.y > 0u) return;
    results[0] = kFlag ? 1u : 0u;
    results[1] = uint(kInteger);
    results[2] = kUnsigned;
    results[3] = floatBitsToUint(kNumber);
    results[4] = floatBitsToUint(pushed.z);
    results[5] = last;
    results[6] = floatBitsToUint(block.w);
    for (int i = 0; i < 3; ++i) results[7 + i] = floatBitsToUint(textureLod(textures[i], vec2(0.5), 0.0).x);
}
