/* Holes of alpha-tested textures. Included by the fragment parts of draws of the scene. The nearest
 * texel decides: on CPUs a filtered one takes as long as all the rest of such a draw. So fragments
 * without holes read one texel, always the same. */
bool is_hole(vec2 uv, int layer, float alpha_cutoff, int level)
{
    bool tested = alpha_cutoff > 0.0 && layer >= 0;
    ivec2 size = max(textureSize(scene_textures, 0).xy >> level, 1);
    ivec2 texel = min(ivec2((uv - floor(uv)) * vec2(size)), size - 1);
    ivec3 at = tested ? ivec3(texel, layer) : ivec3(0);
    return texelFetch(scene_textures, at, tested ? level : 0).a < alpha_cutoff && tested;
}

/* The mip whose texels are about as large as pixels. */
int mip_of(vec2 uv)
{
    vec2 size = vec2(textureSize(scene_textures, 0).xy);
    vec2 across = dFdx(uv) * size;
    vec2 down = dFdy(uv) * size;
    float square = max(dot(across, across), dot(down, down));
    int level = (floatBitsToInt(square) - floatBitsToInt(0.5)) >> 24; /* half of the logarithm */
    return clamp(level, 0, textureQueryLevels(scene_textures) - 1);
}
