// The body of do runs once at least; continue goes to the condition. (With do_break's loop behind, LLVM 19's JIT crashes over
// what llvmpipe makes of OpenGL's text.)
// expect: 1 3 6
void main()
{
    int n = 0;
    do
        n++;
    while (n < 0);
    result[0] = float(n) * one;
    int i = 0;
    float sum = 0.0;
    do {
        i++;
        if (i == 2)
            continue;
        sum += float(i) + half_ * one;
    } while (i < 3);
    result[1] = float(i) * one;
    result[2] = sum + one;
}
