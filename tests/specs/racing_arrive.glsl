// Many tickets each, so that a thread works longer than the system lets it run at once. With one ticket each, the threads of a
// busy machine may come by one after the other.
void main()
{
    uint ticket = 0u;
    for (int i = 0; i < 16; i++)
        ticket = atomicAdd(counter[0], 1u);
    tickets[invocation().x] = ticket;
}
