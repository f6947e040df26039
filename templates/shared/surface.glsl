/* What a fragment of the scene is made of. Included by the fragment parts of all scene draws. */

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

/* Winding and modelled normals are not to be trusted: the unit normal is turned to the side of the
 * triangle that is seen from the direction `to_eye`. The triangle decides, not the interpolated
 * normal, which may face away at silhouettes. */
vec3 facing_normal(vec3 normal, vec3 geometric, vec3 to_eye)
{
    geometric = dot(geometric, to_eye) < 0.0 ? -geometric : geometric;
    vec3 n = unit_or(normal, unit_or(geometric, to_eye));
    float side = dot(n, geometric);
    if (side == 0.0)
        side = dot(n, to_eye);
    return side < 0.0 ? -n : n;
}
