#version 460
layout(location = 0) in vec3 shade;
layout(location = 0) out vec4 picture;
layout(location = 1) out uint id;

void main()
{
    picture = vec4(shade, 1.0);
    id = 7u;
}
