void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec4 color = vec4(ivec4(5 * p.x, 3 * p.y, p.x ^ p.y, 7 * p.x + p.y) & 15) / 16.0;
    over = premultiplied = added = least = largest = multiplied = mixed = color;
    tally = uvec4(100u);
}
