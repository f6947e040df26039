/* Stripes in the colours of the labels. */
void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, stripes_size())))
        return;
    int label = labels[(p.x + p.y) % points];
    stripes_store(p, vec4(vec3(float(label) + 0.25), 1.0));
    levels_store(p, uvec4(uint(label)));
    picture_store(p, vec4(0.5 * float(label), 0.25, 0.75, 1.0));
}
