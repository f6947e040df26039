// Many tickets each, that a thread needs longer than the system lets it run at once: on a busy machine threads would else come
// by one after the other.
void main()
{
    uint ticket = 0u;
    for (int i = 0; i < 16; i++)
        ticket = atomicAdd(counter[0], 1u);
    tickets[invocation().x] = ticket;
}
