// A macro does not expand itself again.
// expect: 3 8 9
#define two (two + one)
#define a b
#define b a
void main()
{
    result[0] = two;
    float a = 8.0 * one;
    result[1] = a;
    result[2] = a + one;
}
