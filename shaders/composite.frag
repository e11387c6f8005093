#version 420 core
// Paints the layers over the background in integers, so that no driver's blending decides a bit. The same steps as
// paint_over() in src/render/coverage.hpp. Change both together.

uniform sampler2DArray masks; // layer l: slice l / 4, channel l % 4
uniform ivec4 background;
uniform int layer_count;
uniform ivec4 layer_color[64];

out vec4 pixel;

// v / 255, rounded to the nearest integer, for 0 <= v <= 255 * 255.
ivec3 over_255(ivec3 v) {
    ivec3 t = v + 128;
    return (t + (t >> 8)) >> 8;
}

void main() {
    ivec2 position = ivec2(gl_FragCoord.xy);
    ivec3 color = background.rgb;
    vec4 mask = vec4(0.0);
    for (int l = 0; l < layer_count; ++l) {
        if ((l & 3) == 0) mask = texelFetch(masks, ivec3(position, l >> 2), 0);
        int coverage = int(mask[l & 3] * 255.0 + 0.5);
        ivec4 source = layer_color[l];
        int alpha = over_255(ivec3(coverage * source.a)).x;
        color = over_255(color * (255 - alpha) + source.rgb * alpha);
    }
    pixel = vec4(vec3(color) * (1.0 / 255.0), 1.0);
}
