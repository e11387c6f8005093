#version 450 core
// One rectangle of whole pixels per stamp.

layout(location = 0) in vec4 rectangle;     // x0, y0, x1, y1 in pixels, y down
layout(location = 2) in int coverage_start; // in the buffer of coverage; -1: all of it is covered

uniform vec2 frame_size;

flat out ivec4 stamp; // x0, y0, width, start

void main() {
    vec2 position = vec2((gl_VertexID & 1) == 0 ? rectangle.x : rectangle.z,
                         (gl_VertexID & 2) == 0 ? rectangle.y : rectangle.w);
    stamp = ivec4(ivec2(rectangle.xy), int(rectangle.z - rectangle.x), coverage_start);
    gl_Position = vec4(2.0 * position / frame_size - 1.0, 0.0, 1.0);
}
