void main()
{
    tickets[invocation().x] = atomicAdd(counter[0], 1u);
}
