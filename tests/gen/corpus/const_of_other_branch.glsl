// A constant of the branch that is left out has no value here.
// expect: 6 2 8
#if 1
const float k = 2.0;
#else
const float k = 4.0;
#endif
#if 0
const float scale = 100.0;
#define SCALED(x) (x * scale * 2.0)
#else
const float scale = 1.0;
#define SCALED(x) (x * scale)
#endif
void main()
{
    result[0] = k * 3.0 * one;
    result[1] = SCALED(two);
#ifdef NOT_HERE
    const float k = 16.0;
#endif
    result[2] = k * 4.0 * one;
}
