#version 460
layout(location = 0) in vec2 corner;
layout(location = 1) in vec3 color;
layout(location = 0) out vec3 shade;

void main()
{
    shade = color;
    gl_Position = vec4(corner, 0.5, 1.0);
}
