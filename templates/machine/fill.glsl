/* Fills the image to copy; every texel differs. */
void main()
{
    ivec2 p = invocation().xy;
    original_store(p, vec4(p, p.yx));
}
