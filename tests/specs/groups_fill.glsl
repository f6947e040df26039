void main()
{
    uint i = uint(invocation().x);
    keys_0[i] = i << 8 | (i * 73u + second_items[i % uint(second_items_count)].weight) % 256u;
    keys_1[i] = 0u;
    places[i] = 0u;
}
