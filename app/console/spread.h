/* Medians of measurements. */
#pragma once

#include <stdint.h>

/* Of values[0], values[step], ..., `count` of them, leaving out NAN; NAN without values. */
double median_of(const double *values, uint32_t count, uint32_t step);
