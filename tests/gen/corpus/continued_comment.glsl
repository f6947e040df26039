// A comment that a backslash continues hides the next line.
// expect: 1 2 5
void main()
{
    float x = one;
    // everything here is a comment \
    x = 100.0;
    result[0] = x;
    x = two; // \
    x = 200.0; \
    x = 300.0;
    result[1] = x;
    result[2] = x + /* a \
    */ three;
}
