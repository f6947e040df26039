/* Median and spread of measurements. */
#pragma once

#include <stdint.h>

struct spread {
    uint32_t count;         /* of values that are not NAN */
    double p5, median, p95; /* NAN without values */
};

/* Of values[0], values[step], ..., `count` of them, leaving out NAN. */
struct spread spread_of(const double *values, uint32_t count, uint32_t step);
