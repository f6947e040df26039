/* sRGB codes from 0 to 1 and linear light (IEC 61966-2-1). */
#pragma once

#include <math.h>

static inline double srgb_light(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

static inline double srgb_code(double light)
{
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

/* The same in floats. */
static inline float srgb_decode(float code)
{
    return code <= 0.04045f ? code / 12.92f : powf((code + 0.055f) / 1.055f, 2.4f);
}

static inline float srgb_encode(float light)
{
    return light <= 0.0031308f ? light * 12.92f : 1.055f * powf(light, 1 / 2.4f) - 0.055f;
}

/* The light of every 8-bit code, rounded once: as texture units decode. */
static inline void srgb_decode_table(float light[256])
{
    for (int i = 0; i < 256; i++)
        light[i] = (float)srgb_light(i / 255.0);
}
