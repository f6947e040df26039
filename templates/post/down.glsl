/* Half the size. Four filtered samples weigh 4x4 texels by a tent, so that small lights do not
 * flicker. */
void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, coarser_size())))
        return;
    vec2 uv = (vec2(p) + 0.5) / vec2(coarser_size());
    vec2 d = 1.0 / vec2(finer_size());
    vec3 sum = finer_sample(uv + vec2(-d.x, -d.y)).rgb + finer_sample(uv + vec2(d.x, -d.y)).rgb
        + finer_sample(uv + vec2(-d.x, d.y)).rgb + finer_sample(uv + d).rgb;
    coarser_store(p, vec4(0.25 * sum, 1.0));
}
