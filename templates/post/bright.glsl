/* Light above the threshold, at half size: the mean of four pixels. */
void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, glow_size())))
        return;
    vec3 light = photo_sample((vec2(p) + 0.5) / vec2(glow_size())).rgb;
    float most = max(light.r, max(light.g, light.b));
    glow_store(p, vec4(light * (max(most - threshold, 0.0) / max(most, 1e-4)), 1.0));
}
