#version 420 core
// Coverage of one pixel by one capsule, as k/255 in the layer's channel. The same steps as capsule_coverage() in
// src/render/coverage.hpp: only operations that IEEE 754 fixes to the last bit. Change both together.

flat in vec4 capsule_axis;
flat in vec2 capsule_extent;

uniform vec4 channel; // 1 in the layer's channel, 0 elsewhere

out vec4 mask;

void main() {
    precise float dx = gl_FragCoord.x - capsule_axis.x;
    precise float dy = gl_FragCoord.y - capsule_axis.y;
    precise float along_x = dx * capsule_axis.z;
    precise float along_y = dy * capsule_axis.w;
    precise float along = along_x + along_y;
    precise float across_x = dx * capsule_axis.w;
    precise float across_y = dy * capsule_axis.z;
    precise float across = across_x - across_y;
    precise float past_end = along - capsule_extent.x;
    precise float beyond = along < 0.0 ? along : (past_end > 0.0 ? past_end : 0.0);
    precise float distance_px = abs(across);
    if (beyond != 0.0) {
        precise float across_squared = across * across;
        precise float beyond_squared = beyond * beyond;
        precise float squared = across_squared + beyond_squared;
        precise float half_squared = 0.5 * squared;
        precise float inverse = uintBitsToFloat(0x5f3759dfu - (floatBitsToUint(squared) >> 1));
        for (int i = 0; i < 3; ++i) {
            precise float product = half_squared * inverse;
            precise float product_2 = product * inverse;
            precise float correction = 1.5 - product_2;
            precise float next = inverse * correction;
            inverse = next;
        }
        distance_px = squared * inverse;
    }
    precise float inner = min(distance_px + 0.5, capsule_extent.y);
    precise float outer = max(distance_px - 0.5, -capsule_extent.y);
    precise float overlap = inner - outer;
    precise float coverage = min(max(overlap, 0.0), 1.0);
    precise float scaled = coverage * 255.0;
    precise float rounded = scaled + 0.5;
    mask = channel * (floor(rounded) * (1.0 / 255.0));
}
