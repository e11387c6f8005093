#version 450 core
// Coverage of one pixel by a stamp, as k/255.

uniform usamplerBuffer coverage;

flat in ivec4 stamp;

out vec2 mask; // stamp, halo: it has none

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy) - stamp.xy;
    uint covered = stamp.w < 0 ? 255u : texelFetch(coverage, stamp.w + at.y * stamp.z + at.x).r;
    mask = vec2(float(covered) * (1.0 / 255.0), 0.0);
}
