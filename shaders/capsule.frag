#version 450 core
// Coverage of one pixel by one capsule and by its halo, as k/255. The same steps as segment_distance_px() and
// coverage_within() in src/render/coverage.hpp: only operations that IEEE 754 fixes to the last bit. Change both
// together.

flat in vec4 capsule_axis;
flat in vec3 capsule_extent;

out vec2 mask; // capsule, halo

float coverage_within(float radius, float distance_px) {
    precise float inner = min(distance_px + 0.5, radius);
    precise float outer = max(distance_px - 0.5, -radius);
    precise float overlap = inner - outer;
    precise float coverage = min(max(overlap, 0.0), 1.0);
    precise float scaled = coverage * 255.0;
    precise float rounded = scaled + 0.5;
    return floor(rounded) * (1.0 / 255.0);
}

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
    mask = vec2(coverage_within(capsule_extent.y, distance_px), coverage_within(capsule_extent.z, distance_px));
}
