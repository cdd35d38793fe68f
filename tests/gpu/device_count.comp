#version 460
// Adds one to a counter per invocation.
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) buffer Counter { uint counter; };

void main() { atomicAdd(counter, 1u); }
