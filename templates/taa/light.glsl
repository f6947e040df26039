void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, lit_size())))
        return;
    vec4 sent = direct(p);
    lit_store(p, vec4(min(sent.rgb + gbuffer_albedo(p).rgb * ambient, 60000.0), sent.a));
}
