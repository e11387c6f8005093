#version 450 core
// Clears the masks, and the sums of a tinted layer.

layout(location = 0) out vec2 mask;
layout(location = 1) out vec4 sums;

void main() {
    mask = vec2(0.0);
    sums = vec4(0.0);
}
