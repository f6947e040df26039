// Live values as indices and limits of several loops.
// expect: 3 1 0.5
void main()
{
    float all[4] = float[4](half_, one, two, three);
    result[0] = all[int(three)];
    result[1] = all[int(two) - int(one)];
    int at = 3;
    while (all[at] > half_)
        at--;
    result[2] = all[at];
}
