/* Counts frames in a buffer with history: 0 + 1 + 2 + ... */
void main()
{
    int i = invocation().x;
    memory[i] = (frame.first == 1u ? 0u : memory[i]) + frame.index + uint(i);
}
