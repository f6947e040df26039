// Settings with defaults, as headers have them.
// expect: 2 1
#ifndef SAMPLES
#define SAMPLES 2
#endif
#ifndef SAMPLES
#define SAMPLES 200
#endif
#if SAMPLES > 1 && defined(SAMPLES) && !(SAMPLES == 200)
#define MANY
#endif
void main()
{
    float sum = 0.0;
    for (int i = 0; i < SAMPLES; i++)
        sum += one;
    result[0] = sum;
#ifdef MANY
    result[1] = one;
#else
    result[1] = two;
#endif
}
