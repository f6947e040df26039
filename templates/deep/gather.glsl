/* Radiosity and ambient occlusion in screen space, from two layers (Mara et al. 2016). Samples lie
 * on a spiral around the pixel. Each pixel of a tile turns the spiral and shifts the samples along
 * it. */

/* Radiance that a surface sends to x, times the cosine there; w: 1 if they face each other. */
vec4 sent(vec3 x, vec3 n, vec4 y, vec3 m, vec3 light)
{
    vec3 d = y.xyz - x;
    float square = dot(d, d);
    float arriving = dot(n, d);
    bool faces = y.w > 0.0 && square > 0.0 && arriving > 0.0 && dot(m, d) < 0.0;
    return faces ? vec4(light * (arriving * approximate_inversesqrt(square)), 1.0) : vec4(0.0);
}

/* How much a surface hides of ambient light: less the farther it is, none where the square of the
 * distance exceeds `reach`. */
float obscurance(vec3 x, vec3 n, vec4 y, float reach)
{
    vec3 d = y.xyz - x;
    float square = dot(d, d);
    float height = max(dot(n, d) * approximate_inversesqrt(max(square, 1e-6 * reach)) - 0.05, 0.0);
    return y.w > 0.0 ? max(1.0 - approximate_divide(square, reach), 0.0) * height : 0.0;
}

/* The texel at a place; one beside the image where the place is outside. */
ivec2 texel_at(vec2 place, ivec2 size)
{
    return ivec2(floor(clamp(place, vec2(-1.0), vec2(size))));
}

void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = min(invocation().xy, size - 1); /* no early return: it costs registers */
    vec4 x = gbuffer_position(p);
    vec3 n = gbuffer_normal(p).xyz;
    float part = float(pattern_class(p)) / float(pattern_classes);
    float angle = 2.0 * PI * part;
    vec2 turn = vec2(cos(angle), sin(angle));
    /* Pixels of one scene radius at this depth. */
    float scale = 0.5 * float(size.y) * frame.camera.projection[1][1] * frame.scene_radius
        / max(x.w, 1e-12);
    float reach = ambient_radius * ambient_radius * frame.scene_radius * frame.scene_radius;
    vec4 sum = vec4(0.0);
    float hidden = 0.0;
    float along = part;

    for (Tap tap : pattern_taps) {
        vec2 d = vec2(turn.x * tap.direction.x - turn.y * tap.direction.y,
                      turn.y * tap.direction.x + turn.x * tap.direction.y);
        d *= scale * along * (1.0 / float(samples));
        along += 1.0;
        ivec2 q = texel_at(vec2(p) + 0.5 + radius * d, size);
        ivec2 texel = clamp(q, ivec2(0), size - 1);
        vec3 m = gbuffer_normal(texel).xyz;
        vec4 near = sent(x.xyz, n, gbuffer_position(texel), m, direct(texel).rgb);
        m = far_normal(texel).xyz;
        vec4 far = sent(x.xyz, n, far_position(texel), m, far_direct(texel).rgb);
        sum += texel == q ? near + far : vec4(0.0);
        q = texel_at(vec2(p) + 0.5 + ambient_radius * d, size);
        texel = clamp(q, ivec2(0), size - 1);
        float most = max(obscurance(x.xyz, n, gbuffer_position(texel), reach),
                         obscurance(x.xyz, n, far_position(texel), reach));
        hidden += texel == q ? most : 0.0;
    }
    /* Samples that send light stand for the hemisphere; at least a quarter of all, lest a few are
     * taken for it. */
    vec3 bounce = sum.rgb * (2.0 * PI / max(sum.w, 0.25 * float(samples)));
    float open = max(1.0 - sqrt(hidden * (PI / float(samples))), 0.0);
    vec3 irradiance = x.w > 0.0 ? bounce + ambient * (PI * open) : vec3(0.0);
    if (all(equal(p, invocation().xy))) /* invocations beside the image repeat its edge */
        irradiance_store(p, vec4(min(irradiance, 60000.0), 1.0)); /* half floats end at 65504 */
}
