void main()
{
    int i = int(gl_FragCoord.x) + 320 * int(gl_FragCoord.y);
    half_drawn = vec4(values[i]);
    packed_drawn = vec4(values[i]);
    unorm8_drawn = vec4(fractions[i]);
    unorm10_drawn = vec4(fractions[i]);
    bytes_drawn = ivec4(floatBitsToInt(values[i]));
    shorts_drawn = uvec4(floatBitsToUint(values[i]));
    if ((i & 1) == 0)
        return; /* rounding follows all the same */
}
