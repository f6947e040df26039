/* Holes of alpha-tested textures. Included by both parts of draws of the scene that read
 * scene_vertices and scene_indices. No rasterizer interpolates texture coordinates: the first corner
 * of a triangle passes them on as planes over the target (Olano, Greer, "Triangle Scan Conversion
 * using 2D Homogeneous Coordinates", 1997). So all devices find the same texel. */
#ifdef VERTEX
#include "triangle.glsl"

layout(location = 0) flat out vec4 hole_first; /* of the first corner: pixel, texture coordinates */
/* Planes over pixels, relative to the first corner: 1, u, v. In w: alpha cutoff, texture layer, 0. */
layout(location = 1) flat out vec4 hole_one;
layout(location = 2) flat out vec4 hole_u;
layout(location = 3) flat out vec4 hole_v;

/* The triangle that begins with this vertex. */
Triangle own_triangle()
{
    Triangle t = triangle_of(vertex_triangle);
    t.a.px = vertex_position.x;
    t.a.py = vertex_position.y;
    t.a.pz = vertex_position.z;
    t.a.u = vertex_uv.x;
    t.a.v = vertex_uv.y;
    return t;
}

/* a, b, c: x, y and w of the corners in clip space; pixels: of the target. Returns w times hole_one,
 * which is the same everywhere. */
float pass_holes(Triangle t, vec3 a, vec3 b, vec3 c, vec2 pixels)
{
    /* Near the triangle products do not cancel. */
    vec2 place = clamp(a.xy / max(a.z, 1e-20), -1.0, 1.0);
    a.xy -= place * a.z;
    b.xy -= place * b.z;
    c.xy -= place * c.z;
    vec3 scale = vec3(2.0 / pixels, 1.0);
    vec3 of_a = cross(b, c);
    vec3 of_b = cross(c, a);
    vec3 of_c = cross(a, b);
    vec2 e = corner_uv(t.b) - corner_uv(t.a);
    vec2 f = corner_uv(t.c) - corner_uv(t.a);
    SceneMaterial m = scene_materials[vertex_material];
    hole_first = vec4((place * 0.5 + 0.5) * pixels, corner_uv(t.a));
    hole_one = vec4((of_a + of_b + of_c) * scale, m.alpha_cutoff);
    hole_u = vec4((of_b * e.x + of_c * f.x) * scale, float(m.texture_layer));
    hole_v = vec4((of_b * e.y + of_c * f.y) * scale, 0.0);
    return dot(a, of_a);
}
#endif

#ifdef FRAGMENT
#include "estimate.glsl"

layout(location = 0) flat in vec4 hole_first;
layout(location = 1) flat in vec4 hole_one;
layout(location = 2) flat in vec4 hole_u;
layout(location = 3) flat in vec4 hole_v;

/* 1 / hole_one at the pixel. */
float hole_scale()
{
    vec2 at = gl_FragCoord.xy - hole_first.xy;
    float one = hole_one.x * at.x + hole_one.y * at.y + hole_one.z;
    return one == 0.0 ? 0.0 : reciprocal_estimate(one);
}

/* The mip whose texels are about as large as pixels. across, down: change of uv from pixel to pixel. */
int mip_of(vec2 across, vec2 down)
{
    vec2 size = vec2(textureSize(scene_textures, 0).xy);
    across *= size;
    down *= size;
    float a = dot(across, across), b = dot(down, down);
    float square = a > b ? a : b;
    int level = (floatBitsToInt(square) - floatBitsToInt(0.5)) >> 24; /* half of the logarithm */
    return clamp(level, 0, textureQueryLevels(scene_textures) - 1);
}

/* Whether the pixel is in a hole; finest: of mip 0. The nearest texel decides: on CPUs a filtered one
 * takes as long as all the rest of such a draw. So pixels without holes read one texel, always the
 * same. */
bool is_hole(float scale, bool finest)
{
    vec2 at = gl_FragCoord.xy - hole_first.xy;
    vec2 part = vec2(hole_u.x * at.x + hole_u.y * at.y + hole_u.z,
                     hole_v.x * at.x + hole_v.y * at.y + hole_v.z) * scale;
    vec2 across = (vec2(hole_u.x, hole_v.x) - part * hole_one.x) * scale;
    vec2 down = (vec2(hole_u.y, hole_v.y) - part * hole_one.y) * scale;
    int level = finest ? 0 : mip_of(across, down);
    vec2 uv = hole_first.zw + part;
    bool tested = hole_one.w > 0.0 && hole_u.w >= 0.0;
    ivec2 size = max(textureSize(scene_textures, 0).xy >> level, 1);
    ivec2 p = min(ivec2((uv - floor(uv)) * vec2(size)), size - 1);
    ivec3 where = tested ? ivec3(p, int(hole_u.w)) : ivec3(0);
    return texelFetch(scene_textures, where, tested ? level : 0).a < hole_one.w && tested;
}
#endif
