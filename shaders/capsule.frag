#version 450 core
// Coverage of one pixel by one capsule and by its halo, as k/255; with TINTED also the capsule's share of the pixel's
// colour. The steps are those of segment_distance_px(), coverage_within(), tint_weight() and TintSums in
// src/corda/render/coverage.hpp, with operations whose results IEEE 754 fixes to the last bit. Change both together.

flat in vec4 capsule_axis;
flat in vec4 capsule_extent;

layout(location = 0) out vec2 mask; // capsule, halo
#ifdef TINTED
flat in uvec4 capsule_tint;

layout(location = 1) out vec4 sums; // channels times weight, weight

// v / 255, rounded to the nearest integer, for 0 <= v <= 255 * 255.
uint over_255(uint v) {
    uint t = v + 128u;
    return (t + (t >> 8)) >> 8;
}

void add_tint(float along, uint coverage) {
    precise float before = along - 0.5;
    precise float after = along + 0.5;
    precise float overlap = min(after, capsule_extent.x) - max(before, 0.0);
    float share = capsule_extent.x == 0.0 ? 1.0 : min(max(overlap, 0.0), 1.0);
    precise float scaled = share * 255.0;
    precise float rounded = scaled + 0.5;
    uint weight = coverage == 0u ? 0u : capsule_tint.a * (1u + over_255(coverage * uint(rounded)));
    sums = vec4(float(weight)) * vec4(vec3(capsule_tint.rgb), 1.0);
}
#endif

float coverage_within(float radius, float distance_px, float strength) {
    precise float inner = min(distance_px + 0.5, radius);
    precise float outer = max(distance_px - 0.5, -radius);
    precise float overlap = inner - outer;
    precise float coverage = min(max(overlap, 0.0), 1.0);
    precise float scaled = coverage * strength;
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
    mask = vec2(coverage_within(capsule_extent.y, distance_px, capsule_extent.w),
                coverage_within(capsule_extent.z, distance_px, 255.0));
#ifdef TINTED
    add_tint(along, uint(mask.x * 255.0 + 0.5));
#endif
}
