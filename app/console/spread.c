/* Order statistics; see spread.h. */
#include "console/spread.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static int compare_numbers(const void *a, const void *b)
{
    double left = *(const double *)a;
    double right = *(const double *)b;
    return (left > right) - (left < right);
}

/* Of a sorted list: linear between neighbours in order, the quantile q, 0..1, of n values lies at
 * (n - 1) q (Hyndman and Fan 1996, type 7, as NumPy and R have it). count: 1 and up. */
static double quantile(const double *sorted, uint64_t count, double q)
{
    double place = (double)(count - 1) * q;
    uint64_t below = (uint64_t)place;
    uint64_t above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (sorted[above] - sorted[below]) * (place - (double)below);
}

struct spread spread_of(const double *values, uint32_t count, uint32_t step)
{
    struct spread spread = {.p5 = NAN, .median = NAN, .p95 = NAN};
    double *sorted = calloc((size_t)count + 1, sizeof *sorted);
    for (uint32_t i = 0; sorted && i < count; i++)
        if (!isnan(values[(size_t)i * step]))
            sorted[spread.count++] = values[(size_t)i * step];
    if (spread.count) {
        qsort(sorted, spread.count, sizeof *sorted, compare_numbers);
        spread.p5 = quantile(sorted, spread.count, 0.05);
        spread.median = quantile(sorted, spread.count, 0.5);
        spread.p95 = quantile(sorted, spread.count, 0.95);
    }
    free(sorted);
    return spread;
}
