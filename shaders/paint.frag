#version 450 core
// Paints a layer over what is there in integers, so that no driver's blending decides a bit, and empties its mask.
// The same steps as paint_over() in src/render/coverage.hpp. Change both together. It reads what it writes, its own
// pixel alone.

uniform sampler2D frame;
uniform sampler2D ground;
uniform sampler2D masks; // capsules, halos

flat in uvec4 layer_color;

layout(location = 0) out vec4 pixel;
layout(location = 1) out vec2 emptied;

ivec3 levels(vec3 channels) {
    return ivec3(channels * 255.0 + 0.5);
}

// v / 255, rounded to the nearest integer, for 0 <= v <= 255 * 255.
ivec3 over_255(ivec3 v) {
    ivec3 t = v + 128;
    return (t + (t >> 8)) >> 8;
}

ivec3 paint_over(ivec3 below, ivec3 channels, int coverage) {
    int alpha = over_255(ivec3(coverage * int(layer_color.a))).x;
    return over_255(below * (255 - alpha) + channels * alpha);
}

void main() {
    ivec2 position = ivec2(gl_FragCoord.xy);
    ivec2 coverage = levels(texelFetch(masks, position, 0).rgb).xy;
    ivec3 below = levels(texelFetch(frame, position, 0).rgb);
    below = paint_over(below, levels(texelFetch(ground, position, 0).rgb), coverage.y);
    pixel = vec4(vec3(paint_over(below, ivec3(layer_color.rgb), coverage.x)) * (1.0 / 255.0), 1.0);
    emptied = vec2(0.0);
}
