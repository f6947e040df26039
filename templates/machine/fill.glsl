/* Something to copy that is nowhere the same. */
void main()
{
    ivec2 p = invocation().xy;
    original_store(p, vec4(p, p.yx));
}
