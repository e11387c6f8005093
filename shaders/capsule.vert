#version 450 core
// One quad per capsule. It extends beyond the capsule's edge by a margin, so that the rounding of these positions
// and the driver's raster rules never decide a pixel.

layout(location = 0) in vec4 axis;   // a.x, a.y, u.x, u.y in pixels, y down
layout(location = 1) in vec4 extent; // length, radius, radius of the halo, strength
#ifdef TINTED
layout(location = 2) in uvec4 tint; // r, g, b, weight

flat out uvec4 capsule_tint;
#endif

uniform vec2 frame_size;
uniform float edge_margin;

flat out vec4 capsule_axis;
flat out vec4 capsule_extent;

void main() {
    float margin = max(extent.y, extent.z) + edge_margin;
    float along = (gl_VertexID & 1) == 0 ? -margin : extent.x + margin;
    float across = (gl_VertexID & 2) == 0 ? -margin : margin;
    vec2 u = axis.zw;
    vec2 position = axis.xy + along * u + across * vec2(-u.y, u.x);
    capsule_axis = axis;
    capsule_extent = extent;
#ifdef TINTED
    capsule_tint = tint;
#endif
    // Row 0 of the framebuffer is the top row of the picture, so y is never flipped, here or later.
    gl_Position = vec4(2.0 * position / frame_size - 1.0, 0.0, 1.0);
}
