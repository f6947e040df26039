// Side effects in a loop's condition.
// expect: 4 6
void main()
{
    int n = 4;
    float turns = 0.0;
    while (n-- > 0)
        turns += one;
    result[0] = turns;
    float s = 0.0;
    for (int i = 3; bool(i--);)
        s += float(i + 1);
    result[1] = s * one;
}
