void main()
{
    ivec2 p = invocation().xy;
    target_store(p, vec4(heap[0] + list[0]));
    seen_store(p, vec4(heap_count));
}
