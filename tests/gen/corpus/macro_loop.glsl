// A loop's head in a macro, and loops in loops by it.
// expect: 10 3 30
#define FOR(i, n) for (int i = 0; i < n; ++i)
#define EACH(i) FOR(i, 5)
void main()
{
    float sum = 0.0;
    EACH(k)
        sum += float(k) * one;
    result[0] = sum;
    int turns = 0;
    FOR(i, 3)
        FOR(j, i)
            turns++;
    result[1] = float(turns);
    sum = 0.0;
    FOR(i, 3) {
        FOR(j, 4)
            sum += float(i) * float(j);
        sum += float(i) * float(4);
    }
    result[2] = sum * one;
}
