/* Sixteenths, so that products of two are exact. */
vec4 ground(ivec2 p)
{
    return vec4(ivec4(p.x, p.y, p.x + p.y, 3 * p.x + p.y) & 15) / 16.0;
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    over = premultiplied = added = least = largest = multiplied = mixed = ground(p);
    tally = uvec4(p, p);
}
