/* sRGB curve (IEC 61966-2-1): linear light to code, 0 to 1. The power by logarithm is 1e-6 off, which
 * codes of 8 bits do not show. */
float srgb(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * exp2(log2(x) * (1.0 / 2.4)) - 0.055;
}
