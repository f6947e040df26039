void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, path_size())))
        return;
    path_store(p, mix(path(p), newest(p), weight));
}
