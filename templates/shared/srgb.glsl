/* sRGB curve (IEC 61966-2-1): linear light to code, 0 to 1, within a fiftieth of a code of 8 bits. A
 * polynomial in the fourth root, since exact pipelines pay more for `pow`. */
#include "estimate.glsl"

float srgb(float x)
{
    float root = sqrt_estimate(sqrt_estimate(x));
    float code = root * (1.1226856 - root * (0.33550491 - root * 0.081330878));
    code = root * (0.19613398 + code) - 0.064611241;
    return x <= 0.0031308 ? 12.92 * x : code;
}
