/* What is stored again are the same codes. */
void main()
{
    ivec2 p = invocation().xy;
    loaded_store(p, vec4(unorm8_stored(p).r, unorm10_stored(p).r, unorm10_stored(p).a, unorm16_stored(p).r));
    shorts_store(p, vec4(shorts(p).r, snorm16_stored(p).r, 0.0, 0.0));
    unorm8_stored_store(p, unorm8_stored(p));
    unorm10_stored_store(p, unorm10_stored(p));
    unorm16_stored_store(p, unorm16_stored(p));
    snorm16_stored_store(p, snorm16_stored(p));
}
