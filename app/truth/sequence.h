/* Random numbers of the path tracer: a function of seed, pixel, sample and dimension only, so that
 * threads and order of work do not change them. */
#pragma once

#include <stdint.h>

enum sequence_kind {
    SEQUENCE_SOBOL, /* two-dimensional Sobol points, shuffled and Owen-scrambled for every pair */
    SEQUENCE_RANDOM /* independent, from a hash; its error has the textbook rate */
};

struct sequence {
    enum sequence_kind kind;
    uint32_t seed; /* of the pixel */
    uint32_t sample;
};

/* The seed of one pixel's sequence; neighbours get unrelated ones. */
uint32_t sequence_seed(uint32_t seed, uint32_t pixel);

/* Two numbers in [0, 1): dimensions 2 pair and 2 pair + 1 of the sample. */
void sequence_pair(const struct sequence *sequence, uint32_t pair, float out[2]);
