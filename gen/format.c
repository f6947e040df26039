/* The image formats of the spec language: bytes, enumerators, and whether shaders may load and
 * store them. Called by the plan and the emitters. */
#include "plan.h"

#include <math.h>
#include <string.h>

static const struct format_info formats[DT_FORMAT_COUNT] = {
    [DT_FORMAT_R8] = {"r8", "DT_FORMAT_R8", "VK_FORMAT_R8_UNORM", 1, true, false},
    [DT_FORMAT_RG8] = {"rg8", "DT_FORMAT_RG8", "VK_FORMAT_R8G8_UNORM", 2, true, false},
    [DT_FORMAT_RGBA8] = {"rgba8", "DT_FORMAT_RGBA8", "VK_FORMAT_R8G8B8A8_UNORM", 4, true, false},
    [DT_FORMAT_RGBA8_SRGB] = {"rgba8_srgb", "DT_FORMAT_RGBA8_SRGB", "VK_FORMAT_R8G8B8A8_SRGB", 4,
                              false, false},
    [DT_FORMAT_R16F] = {"r16f", "DT_FORMAT_R16F", "VK_FORMAT_R16_SFLOAT", 2, true, false},
    [DT_FORMAT_RG16F] = {"rg16f", "DT_FORMAT_RG16F", "VK_FORMAT_R16G16_SFLOAT", 4, true, false},
    [DT_FORMAT_RGBA16F] = {"rgba16f", "DT_FORMAT_RGBA16F", "VK_FORMAT_R16G16B16A16_SFLOAT", 8, true,
                           false},
    [DT_FORMAT_R32F] = {"r32f", "DT_FORMAT_R32F", "VK_FORMAT_R32_SFLOAT", 4, true, false},
    [DT_FORMAT_RG32F] = {"rg32f", "DT_FORMAT_RG32F", "VK_FORMAT_R32G32_SFLOAT", 8, true, false},
    [DT_FORMAT_RGBA32F] = {"rgba32f", "DT_FORMAT_RGBA32F", "VK_FORMAT_R32G32B32A32_SFLOAT", 16,
                           true, false},
    [DT_FORMAT_R32UI] = {"r32ui", "DT_FORMAT_R32UI", "VK_FORMAT_R32_UINT", 4, true, true},
    [DT_FORMAT_RG32UI] = {"rg32ui", "DT_FORMAT_RG32UI", "VK_FORMAT_R32G32_UINT", 8, true, true},
    [DT_FORMAT_RGBA32UI] = {"rgba32ui", "DT_FORMAT_RGBA32UI", "VK_FORMAT_R32G32B32A32_UINT", 16,
                            true, true},
    [DT_FORMAT_R32I] = {"r32i", "DT_FORMAT_R32I", "VK_FORMAT_R32_SINT", 4, true, true},
    [DT_FORMAT_D32F] = {"d32f", "DT_FORMAT_D32F", "VK_FORMAT_D32_SFLOAT", 4, false, false},
    [DT_FORMAT_R16] = {"r16", "DT_FORMAT_R16", "VK_FORMAT_R16_UNORM", 2, true, false},
    [DT_FORMAT_RG16] = {"rg16", "DT_FORMAT_RG16", "VK_FORMAT_R16G16_UNORM", 4, true, false},
    [DT_FORMAT_RGBA16] = {"rgba16", "DT_FORMAT_RGBA16", "VK_FORMAT_R16G16B16A16_UNORM", 8, true,
                          false},
    [DT_FORMAT_R16_SNORM] = {"r16_snorm", "DT_FORMAT_R16_SNORM", "VK_FORMAT_R16_SNORM", 2, true,
                             false},
    [DT_FORMAT_RG16_SNORM] = {"rg16_snorm", "DT_FORMAT_RG16_SNORM", "VK_FORMAT_R16G16_SNORM", 4,
                              true, false},
    [DT_FORMAT_RGBA16_SNORM] = {"rgba16_snorm", "DT_FORMAT_RGBA16_SNORM",
                                "VK_FORMAT_R16G16B16A16_SNORM", 8, true, false},
    [DT_FORMAT_R8UI] = {"r8ui", "DT_FORMAT_R8UI", "VK_FORMAT_R8_UINT", 1, true, true},
    [DT_FORMAT_RG8UI] = {"rg8ui", "DT_FORMAT_RG8UI", "VK_FORMAT_R8G8_UINT", 2, true, true},
    [DT_FORMAT_RGBA8UI] = {"rgba8ui", "DT_FORMAT_RGBA8UI", "VK_FORMAT_R8G8B8A8_UINT", 4, true,
                           true},
    [DT_FORMAT_R16UI] = {"r16ui", "DT_FORMAT_R16UI", "VK_FORMAT_R16_UINT", 2, true, true},
    [DT_FORMAT_RG16UI] = {"rg16ui", "DT_FORMAT_RG16UI", "VK_FORMAT_R16G16_UINT", 4, true, true},
    [DT_FORMAT_RGBA16UI] = {"rgba16ui", "DT_FORMAT_RGBA16UI", "VK_FORMAT_R16G16B16A16_UINT", 8,
                            true, true},
    [DT_FORMAT_R8I] = {"r8i", "DT_FORMAT_R8I", "VK_FORMAT_R8_SINT", 1, true, true},
    [DT_FORMAT_RG8I] = {"rg8i", "DT_FORMAT_RG8I", "VK_FORMAT_R8G8_SINT", 2, true, true},
    [DT_FORMAT_RGBA8I] = {"rgba8i", "DT_FORMAT_RGBA8I", "VK_FORMAT_R8G8B8A8_SINT", 4, true, true},
    [DT_FORMAT_R16I] = {"r16i", "DT_FORMAT_R16I", "VK_FORMAT_R16_SINT", 2, true, true},
    [DT_FORMAT_RG16I] = {"rg16i", "DT_FORMAT_RG16I", "VK_FORMAT_R16G16_SINT", 4, true, true},
    [DT_FORMAT_RGBA16I] = {"rgba16i", "DT_FORMAT_RGBA16I", "VK_FORMAT_R16G16B16A16_SINT", 8, true,
                           true},
    [DT_FORMAT_RG32I] = {"rg32i", "DT_FORMAT_RG32I", "VK_FORMAT_R32G32_SINT", 8, true, true},
    [DT_FORMAT_RGBA32I] = {"rgba32i", "DT_FORMAT_RGBA32I", "VK_FORMAT_R32G32B32A32_SINT", 16, true,
                           true},
    [DT_FORMAT_R11G11B10F] = {"r11g11b10f", "DT_FORMAT_R11G11B10F",
                              "VK_FORMAT_B10G11R11_UFLOAT_PACK32", 4, true, false},
    [DT_FORMAT_RGB10A2] = {"rgb10a2", "DT_FORMAT_RGB10A2", "VK_FORMAT_A2B10G10R10_UNORM_PACK32", 4,
                           true, false},
};

const struct format_info *format_info(enum dt_format format)
{
    return &formats[format];
}

/* ---- Rounding -------------------------------------------------------------------------------- */

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

/* sRGB's transfer functions, IEC 61966-2-1. */
static double nearest_srgb(double value)
{
    value = value < 0 ? 0 : value > 1 ? 1 : value;
    double code = value <= 0.0031308 ? 12.92 * value : 1.055 * pow(value, 1 / 2.4) - 0.055;
    code = nearest_code(code, 0, 255);
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

float format_round(enum dt_format format, int channel, double value)
{
    const char *name = formats[format].name;
    if (formats[format].integer || strstr(name, "32f"))
        return (float)value;
    if (format == DT_FORMAT_R11G11B10F)
        return (float)nearest_small_float(value, channel == 2 ? 5 : 6, false);
    if (strstr(name, "16f"))
        return (float)nearest_small_float(value, 10, true);
    if (strstr(name, "_snorm"))
        return (float)nearest_code(value, -1, 32767);
    if (strstr(name, "srgb") && channel < 3)
        return (float)nearest_srgb(value);
    double most = format == DT_FORMAT_RGB10A2 ? (channel < 3 ? 1023 : 3)
                  : strstr(name, "16")        ? 65535
                                              : 255;
    return (float)nearest_code(value, 0, most);
}
