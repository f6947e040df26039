void main()
{
    ivec2 p = invocation().xy;
    bool lamp = all(lessThan(abs(p - ivec2(40, 20)), ivec2(4)));
    glow_store(p, lamp ? vec4(4.0, 2.0, 1.0, 1.0) : vec4(vec2(p) / 256.0, 0.125, 1.0));
}
