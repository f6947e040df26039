void main()
{
    ivec2 p = invocation().xy;
    if (p == ivec2(0))
        told[0] = Told(frame.jitter, frame.time, frame.index, frame.first);
    if (all(lessThan(p, seen_size())))
        before_store(p, seen(p));
}
