void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, path_size())))
        return;
    path_store(p, mix(frame.first == 1u ? vec4(0.0) : path(p), newest(p), weight));
}
