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
    float identity = back == p && lace_split(p, normal_size()) == q && lace_class(p) == interleave_class() ? 1.0 : 0.0;
    laced_store(q, vec4(sum, vec2(p), identity));
}
