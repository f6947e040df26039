void main()
{
    ivec2 p = invocation().xy;
    shown_store(p, vec4(functions[p.x + 8 * p.y].cos));
}
