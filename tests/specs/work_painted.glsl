void main()
{
    ivec2 p = invocation().xy;
    ivec2 size = sheet_size();
    if (p.x >= size.x || p.y >= size.y)
        return;
    vec3 a = vec3(vec2(p), 1.0);
    mat2 m = mat2(shift);
    vec2 turned = m * a.xy;                     /* 6: 4 products, 2 sums */
    sheet_store(p, vec4(turned, dot(a, a), 0.0)); /* 5 in exact mode: 3 products, 2 sums */
}
