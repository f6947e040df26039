void main()
{
    vec4 baked = vec4(baked_vec2, 0.0, baked_float) + vec4(baked_vec3, 0.0) + baked_vec4;
    baked += vec4(baked_ivec4) + vec4(baked_uvec4);
    baked += vec4(vec2(baked_ivec2) + vec2(baked_uvec2), float(baked_int), float(baked_uint));
    baked += vec4(vec3(baked_ivec3) + vec3(baked_uvec3), baked_bool ? 1.0 : 0.0);
    vec4 uniforms = vec4(uniform_vec2, 0.0, uniform_float) + vec4(uniform_vec3, 0.0) + uniform_vec4;
    uniforms += vec4(uniform_ivec4) + vec4(uniform_uvec4);
    uniforms += vec4(vec2(uniform_ivec2) + vec2(uniform_uvec2), float(uniform_int), float(uniform_uint));
    uniforms += vec4(vec3(uniform_ivec3) + vec3(uniform_uvec3), uniform_bool ? 1.0 : 0.0);
    vec4 live = vec4(live_vec2, 0.0, live_float) + vec4(live_vec3, 0.0) + live_vec4;
    live += vec4(live_ivec4) + vec4(live_uvec4);
    live += vec4(vec2(live_ivec2) + vec2(live_uvec2), float(live_int), float(live_uint));
    live += vec4(vec3(live_ivec3) + vec3(live_uvec3), live_bool ? 1.0 : 0.0);
    sums[0] = baked;
    sums[1] = live;
    sums[2] = uniforms;
}
