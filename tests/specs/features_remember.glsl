/* Counts frames in a buffer with history: 0 + 1 + 2 + ... */
void main()
{
    int i = invocation().x;
    memory[i] = memory[i] + frame.index + uint(i);
}
