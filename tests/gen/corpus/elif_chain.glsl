// The first true branch of a chain alone is text.
// expect: 30 7 2
#define LEVEL 3
#if LEVEL == 1
#define FACTOR 10.0
#elif LEVEL == 2
#define FACTOR 20.0
#elif LEVEL == 3
#define FACTOR 30.0
#elif LEVEL >= 3
#define FACTOR 40.0
#else
#define FACTOR 50.0
#endif
#if LEVEL == 0
const float k = 5.0;
#elif LEVEL == 4
const float k = 6.0;
#elif 1
const float k = 7.0;
#elif 1
const float k = 8.0;
#endif
#if 0
#elif 0
#else
const float q = 2.0;
#endif
void main()
{
    result[0] = FACTOR * one;
    result[1] = k * one;
    result[2] = q * one;
}
