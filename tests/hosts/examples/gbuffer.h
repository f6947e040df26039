/* What host_inputs_vk.cpp and host_inputs_gl.c hand over to lit.yaml, tile by tile of a small frame, and
 * the picture that has to come of it. A moment is the number of a frame. All fractions are of powers of
 * two, so that floats hold each result exactly, whatever the order of the operations. */
#ifndef GBUFFER_H
#define GBUFFER_H

#include <stdbool.h>
#include <stdint.h>

#include "lit.h"

enum { TILE = 16, COLUMNS = 4, ROWS = 3, LAMPS = 2, MOMENTS = 5 };
/* The host itself draws the irradiance of two tiles of this row, the second and the third: this much. */
enum { MARKED_ROW = 2, MARKS = 2 };
static const float mark[4] = {0.5F, 0, 0, 0};

enum { POSITION, NORMAL, ALBEDO, TARGETS };

struct tile {
    float targets[TARGETS][4]; /* of the G-buffer */
};

/* Codes of albedo are multiples of 32. */
static inline int albedo_code(uint32_t moment, uint32_t column, uint32_t row, uint32_t channel)
{
    return (int)((moment + column + 2 * row + 3 * channel) % 8 * 32);
}

static inline struct tile tile_at(uint32_t moment, uint32_t column, uint32_t row)
{
    struct tile tile = {{{(float)column / 4, (float)row / 4, 0, 1}, {0, 0, 0, 0}, {0, 0, 0, 1}}};
    tile.targets[NORMAL][(moment + row) % 3] = 1;
    for (uint32_t k = 0; k < 3; k++)
        tile.targets[ALBEDO][k] = (float)albedo_code(moment, column, row, k) / 255;
    return tile;
}

/* Lamps change in every second frame only. */
static inline struct lit_Lamp lamp_at(uint32_t moment, uint32_t i)
{
    struct lit_Lamp lamp = {{0.75F - (float)i / 4, 0.5F, 1}, moment / 2 % 2 == i ? 0.5F : 0.25F};
    return lamp;
}

static inline float gain_at(uint32_t moment)
{
    return moment % 2 ? 0.5F : 1;
}

static inline float irradiance_at(uint32_t moment, uint32_t column, uint32_t row)
{
    const struct tile tile = tile_at(moment, column, row);
    float sum = 0;
    if (column >= 1 && column <= MARKS && row == MARKED_ROW)
        return mark[0];
    for (uint32_t i = 0; i < LAMPS; i++) {
        const struct lit_Lamp lamp = lamp_at(moment, i);
        float cosine = 0;
        for (int k = 0; k < 3; k++)
            cosine += tile.targets[NORMAL][k] * (lamp.position[k] - tile.targets[POSITION][k]);
        sum += cosine > 0 ? lamp.power * cosine : 0;
    }
    return gain_at(moment) * sum;
}

/* `pixels`: the whole frame, RGBA8. */
static inline bool is_lit(const uint8_t *pixels, uint32_t moment)
{
    for (uint32_t y = 0; y < ROWS * TILE; y++)
        for (uint32_t x = 0; x < COLUMNS * TILE; x++, pixels += 4) {
            const uint32_t column = x / TILE, row = y / TILE;
            const float irradiance = irradiance_at(moment, column, row);
            for (uint32_t k = 0; k < 3; k++)
                if ((float)pixels[k] != irradiance * (float)albedo_code(moment, column, row, k))
                    return false;
        }
    return true;
}

#endif
