/* sRGB curve (IEC 61966-2-1): linear light to code, 0 to 1. By logarithm, since exact pipelines pay more
 * for `pow`; few codes of 8 bits differ. */
float srgb(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * exp2(log2(x) * (1.0 / 2.4)) - 0.055;
}
