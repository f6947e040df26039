// Statements in a macro, after an if without braces.
// expect: 6 1 9
#define ADD_ALL(to) do { to += one; to += two; to += three; } while (false)
#define SWAP(T, a, b) { T swap_ = a; a = b; b = swap_; }
void main()
{
    float x = 0.0;
    if (one > 0.0)
        ADD_ALL(x);
    else
        x = -1.0;
    result[0] = x;
    float a = three * three, b = one;
    SWAP(float, a, b)
    result[1] = a;
    result[2] = b;
}
