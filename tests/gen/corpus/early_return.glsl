// Returns from loops and from the middle of main.
// expect: 1 2 3 4
float find(float limit)
{
    for (int i = 1; i < 10; i++) {
        for (int j = 0; j < 4; j++) {
            if (float(i) >= limit)
                return float(i);
        }
    }
    return -1.0;
}
void main()
{
    result[0] = find(one);
    result[1] = find(two);
    result[2] = find(two + half_);
    result[3] = 4.0 * one;
    if (three > two)
        return;
    result[3] = 100.0;
}
