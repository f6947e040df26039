/* Median and spread of measurements, and of the values of pictures. */
#ifndef DIPTYCH_SPREAD_H
#define DIPTYCH_SPREAD_H

#include <stdint.h>

/* Of a sorted list: linear between neighbours in order, the quantile q, 0..1, of n values lies at
 * (n - 1) q (Hyndman and Fan 1996, type 7, as NumPy and R have it). count: 1 and up. */
double quantile(const double *sorted, uint64_t count, double q);
void sort_numbers(double *values, uint64_t count); /* none is NAN */

struct spread {
    uint32_t count;         /* of values that are not NAN */
    double p5, median, p95; /* NAN without values */
};

/* Of values[0], values[step], ..., `count` of them, leaving out NAN. */
struct spread spread_of(const double *values, uint32_t count, uint32_t step);

#endif
