#version 450 core
// Paints a layer over what is there in integers, so that no driver's blending decides a bit, and empties its mask.
// The same steps as paint_over() and TintSums::mean() in src/render/coverage.hpp. Change both together. It
// reads what it writes, its own pixel alone.

uniform sampler2D frame;
uniform sampler2D ground; // colours times alpha, as in the frame
uniform sampler2D masks; // capsules, halos

flat in uvec4 layer_color;

layout(location = 0) out vec4 pixel;
layout(location = 1) out vec2 emptied;
#ifdef TINTED
uniform sampler2D sums; // channels times weight, weight

layout(location = 2) out vec4 emptied_sums;

ivec3 own_color(ivec2 position) {
    uvec4 whole = uvec4(min(texelFetch(sums, position, 0), vec4(2147483520.0)));
    return ivec3(min((whole.rgb + whole.a / 2u) / max(whole.a, 1u), uvec3(255u)));
}
#else
ivec3 own_color(ivec2 position) {
    return ivec3(layer_color.rgb);
}
#endif

ivec4 levels(vec4 channels) {
    return ivec4(channels * 255.0 + 0.5);
}

// v / 255, rounded to the nearest integer, for 0 <= v <= 255 * 255.
ivec4 over_255(ivec4 v) {
    ivec4 t = v + 128;
    return (t + (t >> 8)) >> 8;
}

ivec4 paint_over(ivec4 below, ivec4 channels, int coverage) {
    int alpha = over_255(ivec4(coverage * int(layer_color.a))).x;
    return over_255(below * (255 - alpha) + channels * alpha);
}

void main() {
    ivec2 position = ivec2(gl_FragCoord.xy);
    ivec2 coverage = levels(texelFetch(masks, position, 0)).xy;
    ivec4 below = levels(texelFetch(frame, position, 0));
    below = paint_over(below, levels(texelFetch(ground, position, 0)), coverage.y);
    pixel = vec4(paint_over(below, ivec4(own_color(position), 255), coverage.x)) * (1.0 / 255.0);
    emptied = vec2(0.0);
#ifdef TINTED
    emptied_sums = vec4(0.0);
#endif
}
