void main()
{
    int i = invocation().x;
    if (i >= particles_count)
        return;
    particles[i].place = ivec2(i * 5 % 17, i * 7 % 11);
    particles[i].size = 3 + i % 5;
    particles[i].color = vec4(ivec3(i, i + 1, i / 2) & 3, 1 + i % 3) / 4.0;
    if (i == 0) {
        const uint draws[8] = uint[](6u, 3u, 0u, 0u, 3u, 1u, 0u, 5u);
        for (int k = 0; k < 8; k++)
            arguments[k] = draws[k];
    }
}
