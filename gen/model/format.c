/* Rounds numbers as image formats do. */
#include "model.h"
#include "scenes/srgb.h"

#include <math.h>

#include "formats.h"

/* The nearest of the codes 0 to `most`, or -most to `most`, as a number from -1 to 1. */
static double nearest_code(double value, double least, double most)
{
    value = value < least ? least : value > 1 ? 1 : value;
    return rint(value * most) / most;
}

/* The nearest float with `bits` of mantissa behind the point and five of exponent; halves to even. */
static double nearest_small_float(double value, int bits, bool sign)
{
    const double most = ldexp(2 - ldexp(1, -bits), 15);
    int exponent;
    if (value < 0 && !sign)
        return 0;
    frexp(value, &exponent); /* of a number from 0.5 to 1 */
    double unit = ldexp(1, (exponent - 1 < -14 ? -14 : exponent - 1) - bits);
    value = rint(value / unit) * unit;
    return value > most ? most : value < -most ? -most : value;
}

static double nearest_srgb(double value)
{
    value = value < 0 ? 0 : value > 1 ? 1 : value;
    return srgb_light(nearest_code(srgb_code(value), 0, 255));
}

float format_round(enum dt_format format, int channel, double value)
{
    enum number_kind kind = format_info(format)->kind;
    switch (kind) {
    case NUMBER_UNORM8:
        return (float)(format == DT_FORMAT_RGBA8_SRGB && channel < 3 ? nearest_srgb(value)
                                                                     : nearest_code(value, 0, 255));
    case NUMBER_UNORM16:
        return (float)nearest_code(value, 0, 65535);
    case NUMBER_SNORM16:
        return (float)nearest_code(value, -1, 32767);
    case NUMBER_R10:
        return (float)nearest_code(value, 0, channel < 3 ? 1023 : 3);
    case NUMBER_HALF:
        return (float)nearest_small_float(value, 10, true);
    case NUMBER_R11F:
        return (float)nearest_small_float(value, channel == 2 ? 5 : 6, false);
    default:
        return (float)value;
    }
}
