#version 450 core
// One rectangle of whole pixels per tile of a layer.

layout(location = 0) in vec4 rectangle; // x0, y0, x1, y1 in pixels, y down
layout(location = 1) in uvec4 color;

uniform vec2 frame_size;

flat out uvec4 layer_color;

void main() {
    vec2 position = vec2((gl_VertexID & 1) == 0 ? rectangle.x : rectangle.z,
                         (gl_VertexID & 2) == 0 ? rectangle.y : rectangle.w);
    layer_color = color;
    gl_Position = vec4(2.0 * position / frame_size - 1.0, 0.0, 1.0);
}
