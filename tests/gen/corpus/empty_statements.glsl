// Empty statements and blocks.
// expect: 1 5
;
void nothing() {}
void main()
{
    ;;
    {}
    { ; { } }
    nothing();
    if (one > two) ; else { }
    for (;;) break;
    result[0] = one;
    float x = 0.0;
    for (int i = 0; i < 5; x += one, i++);
    result[1] = x;
};
