// What never runs changes nothing, and need not be sensible.
// expect: 1 2
const bool DEBUG = false;
float broken(float x)
{
    if (DEBUG) {
        int zero = 0;
        return x / float(zero);
    }
    return x;
}
float never_called(float x) { return sqrt(-x) / 0.0; }
void main()
{
    result[0] = broken(one);
    if (false)
        result[1] = never_called(one);
    else
        result[1] = two;
    return;
    result[0] = 100.0;
}
