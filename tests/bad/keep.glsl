void main()
{
    float d = near(vpls[0].flux, vec3(0), vec3(0), vec3(0)) + points(0).x;
    ivec2 p = tile_gather(invocation().xy, other_size());
    other_store(p, other(p) + d);
    extra_store(p, extra(p));
}
