#version 460
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) buffer Picture { uint pixels[]; };

void main() { pixels[gl_GlobalInvocationID.x] = pixels[gl_GlobalInvocationID.x] * 1664525u + gl_GlobalInvocationID.x; }
