#version 450 core
// One rectangle of whole pixels per run of tiles.

layout(location = 0) in ivec4 rectangle; // x0, y0, x1, y1 in pixels, y down

uniform vec2 frame_size;

void main() {
    vec2 position = vec2((gl_VertexID & 1) == 0 ? rectangle.x : rectangle.z,
                         (gl_VertexID & 2) == 0 ? rectangle.y : rectangle.w);
    gl_Position = vec4(2.0 * position / frame_size - 1.0, 0.0, 1.0);
}
