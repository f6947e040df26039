#include "shared/estimate.glsl"

const float THIRD = 1.0 / 3.0;
#define RATIO(a, b) ((a) / (b))
#define PARTS 6
#define HALF  (PARTS / 2) /* stays a constant expression */

void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    Arguments a = arguments[i];
    Functions f;
    f.quotient = RATIO(a.x, a.y);
    f.quotient_whole = a.x / -100.0;
    f.quotient_part = a.x / 0.375;
    f.sqrt = sqrt(a.x);
    f.inversesqrt = inversesqrt(a.x);
    f.sin = sin(a.angle);
    f.cos = cos(a.angle);
    f.tan = tan(a.angle);
    f.asin = asin(a.unit);
    f.acos = acos(a.unit);
    f.atan = atan(a.x);
    f.atan2 = atan(a.angle, a.unit);
    f.exp = exp(a.exponent);
    f.exp2 = exp2(a.exponent);
    f.log = log(a.x);
    f.log2 = log2(a.x);
    f.pow = pow(abs(a.x), a.unit);
    f.sinh = sinh(a.exponent);
    f.cosh = cosh(a.exponent);
    f.tanh = tanh(a.exponent);
    f.asinh = asinh(a.x);
    f.acosh = acosh(a.above_one);
    f.atanh = atanh(a.unit);
    f.reciprocal = reciprocal_estimate(a.above_one);
    f.close = -reciprocal_close(-a.above_one);
    f.root = sqrt_estimate(a.above_one);
    f.mod = mod(a.angle, 0.375);
    f.halved = unpackHalf2x16(packHalf2x16(vec2(a.angle, a.unit))).x;
    float parts[HALF] = float[HALF](0.1, a.unit, 0.3);
    f.literals = parts[HALF - 2] + 0.1 * 0.2 * 0.3 + THIRD * 0.7 - 1.1 / 1.3 / 0.9;
    functions[i] = f;
}
