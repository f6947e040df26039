void main()
{
    vec2 uv = gl_FragCoord.xy / vec2(frame.width, frame.height);
    vec3 c = half_color_sample(uv).rgb;
    blurred = vec4(c, half_depth_compare(uv, 0.5));
}
