// The author's own precise and invariant marks.
// expect: 0.5 9.313226e-10 3
precise float total;
float add(precise float a, float b) { precise float c = a + b; return c; }
void main()
{
    precise float a = 0.1 * three;
    precise float b = a + 0.2;
    result[0] = b;
    total = 0.1 * one;
    float c;
    precise c;
    c = total * total - 0.01;
    result[1] = c;
    result[2] = add(one, two);
}
