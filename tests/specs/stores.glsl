void main()
{
    ivec2 p = invocation().xy;
    int i = min(p.x + 320 * p.y, values_count - 1);
    half_stored_store(p, vec4(values[i]));
    packed_stored_store(p, vec4(values[i]));
    unorm8_stored_store(p, vec4(fractions[i]));
    unorm10_stored_store(p, vec4(fractions[i]));
    unorm16_stored_store(p, vec4(fractions[i]));
    snorm16_stored_store(p, vec4(fractions[i]));
    bytes_stored_store(p, uvec4(floatBitsToUint(values[i])));
    shorts_stored_store(p, ivec4(floatBitsToInt(values[i])));
}
