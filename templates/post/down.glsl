/* Half the size. Four filtered samples weigh 4x4 texels by a tent, so that small lights do not
 * flicker. */
void main()
{
    vec2 uv = gl_FragCoord.xy / vec2(ivec2(glow_x, glow_y) >> k);
    vec2 d = 1.0 / vec2(finer_size());
    vec3 sum = finer_sample(uv + vec2(-d.x, -d.y)).rgb + finer_sample(uv + vec2(d.x, -d.y)).rgb
        + finer_sample(uv + vec2(-d.x, d.y)).rgb + finer_sample(uv + d).rgb;
    glow = vec4(0.25 * sum, 1.0);
}
