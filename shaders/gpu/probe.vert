#version 460
// A triangle with corners at pixels (0, 0), (63.5, 0) and (0, 63.5) of a 64x64 picture: no pixel centre lies on an edge.
void main()
{
    const vec2 corner = vec2((gl_VertexIndex & 1) != 0 ? 1.0 : 0.0, (gl_VertexIndex & 2) != 0 ? 1.0 : 0.0);
    gl_Position = vec4(corner * (63.5 / 32.0) - 1.0, 0.5, 1.0);
}
