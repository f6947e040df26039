void main()
{
    bytes = halves = floats = vec4(fract(gl_FragCoord.xy * 0.37), 0.3, 0.7);
}
