/* Albedo and normal of a fragment. Included by the fragment parts of all scene draws. */

/* Albedo, 0..1; discards the holes of alpha-tested textures. */
vec3 surface_albedo(uint material, vec2 uv)
{
    SceneMaterial m = scene_materials[material];
    vec4 texel = scene_texture(uv, m.texture_layer);
    if (texel.a < m.alpha_cutoff)
        discard;
    return clamp(m.albedo * texel.rgb, 0.0, 1.0);
}

/* Normal of the triangle itself, from the derivatives of the position, which lie in its plane; not
 * unit, either side. */
vec3 triangle_normal(vec3 position)
{
    return cross(dFdx(position), dFdy(position));
}

#include "facing.glsl"
