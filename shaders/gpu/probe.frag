#version 460
layout(location = 0) out uint picture;

// The pixel's own number plus one, so that a picture of the right shape at the wrong place is found out.
void main() { picture = uint(gl_FragCoord.y) * 64u + uint(gl_FragCoord.x) + 1u; }
