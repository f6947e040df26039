#ifdef FRAGMENT
void main()
{
    vec2 uv = gl_FragCoord.xy / vec2(64.0, 48.0);
    /* Around the horizon, from pole to pole, over all edges and corners of the cube. */
    vec3 toward = vec3(4.0 * uv.x - 2.0, 3.0 * uv.y - 1.5, abs(8.0 * uv.x - 4.0) - 2.0);
    vec4 color = fog_sample(vec3(2.0 * uv, uv.x)) + 0.125 * sky_sample(toward);
    color += probes_sample(vec4(toward, gl_FragCoord.y > 24.0 ? 1.0 : 0.0));
    color.x += 0.25 * depths_compare(toward, 0.5);
    color.y += 0.25 * probe_depths_compare(vec4(toward, 1.0), 0.6);
    color += 0.125 * sky_sample_lod(toward, 0.5) + 0.125 * fog_sample_lod(uv.xyx, 1.25);
    picture = 0.3 * color;
}
#endif
