/* Of fragment shaders under --sanitize=flow; see gen/spirv/quads.c, which writes diptych_quads(): it calls diptych_quad() for each
 * operation that takes a derivative. */

/* number: of how an invocation came to the operation; 0: it did not. Integers below 65,536 are exact floats. */
void diptych_quad(const uint number, const uint site, const uint what)
{
    float own = float((number ^ number >> 16) & 0xffffu);
    bool parted = any(notEqual(vec2(dFdxFine(own), dFdyFine(own)), vec2(0.0)));
    diptych_told(all(bvec2(parted, number != 0u)), 0u, 0u, site, what);
}

void diptych_quads()
{
}
