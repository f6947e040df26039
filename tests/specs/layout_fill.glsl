/* Every component gets a value of its own: 100 * element + a running number in the order of declaration. */
void main()
{
    int i = invocation().x;
    if (i >= rows)
        return;
    float v = 100.0 * float(i);
    uint u = 100u * uint(i);
    int s = 100 * i;

    tight[i].a = v + 1.0;
    tight[i].b = v + 2.0;
    tight[i].c = u + 3u;

    holes[i].a = v + 1.0;
    holes[i].b = v + vec3(2.0, 3.0, 4.0);
    holes[i].c = v + 5.0;
    holes[i].d = v + vec2(6.0, 7.0);
    holes[i].e = v + 8.0;
    holes[i].f = v + vec4(9.0, 10.0, 11.0, 12.0);
    holes[i].g = s + ivec2(13, 14);
    holes[i].h = s + 15;

    for (int k = 0; k < 3; ++k) {
        arrays[i].a[k] = v + 1.0 + float(k);
        arrays[i].d[k] = v + 11.0 + 2.0 * float(k) + vec2(0.0, 1.0);
    }
    for (int k = 0; k < 2; ++k)
        arrays[i].b[k] = v + 4.0 + 3.0 * float(k) + vec3(0.0, 1.0, 2.0);
    arrays[i].c = u + 10u;
    arrays[i].e = u + uvec3(17u, 18u, 19u);
    arrays[i].f = s + 20;

    matrices[i].a = u + 1u;
    for (int c = 0; c < 4; ++c)
        matrices[i].m[c] = v + 2.0 + 4.0 * float(c) + vec4(0.0, 1.0, 2.0, 3.0);
    matrices[i].b = s + ivec3(18, 19, 20);

    scalars[i] = v + 1.0;
    vectors[i] = v + vec3(1.0, 2.0, 3.0);
}
