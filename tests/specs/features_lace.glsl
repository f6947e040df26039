void main()
{
    ivec2 p = interleave_pixel();
    vec3 n = normal(p).xyz;
    float sum = 0.0;
    for (vec4 v : some) {
        sum += v.x * max(0.0, dot(n, vec3(v.yz, 0.5))) + v.w;
    }
    ivec2 q = interleave_split();
    ivec2 back = lace_gather(q, normal_size());
    bool same = back == p && lace_split(p, normal_size()) == q && lace_class(p) == interleave_class();
    ivec3 at = invocation();
    ivec2 placed = min(at.xy, lace_class_size(at.z, normal_size()) - 1) * lace_tile + tile_offset(at.z, lace_tile);
    float identity = same && placed == p ? 1.0 : 0.0;
    if (all(equal(p / lace_tile, invocation().xy))) /* others repeat the last pixel */
        laced_store(q, vec4(sum, vec2(p), identity));
}
