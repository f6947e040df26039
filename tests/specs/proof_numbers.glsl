void main()
{
    uint state = uint(invocation().x) * 747796405u + 2891336453u;
    for (int i = 0; i < 16; i++) {
        state = state * 747796405u + 2891336453u;
        uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
        numbers[invocation().x].of[i] = (word >> 22) ^ word;
    }
}
