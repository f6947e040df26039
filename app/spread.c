/* Order statistics; see spread.h. */
#include "spread.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static int compare_numbers(const void *a, const void *b)
{
    double left = *(const double *)a;
    double right = *(const double *)b;
    return (left > right) - (left < right);
}

static double quantile(const double *sorted, uint32_t count, double q)
{
    double place = (count - 1) * q;
    uint32_t below = (uint32_t)place;
    uint32_t above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (sorted[above] - sorted[below]) * (place - below);
}

struct spread spread_of(const double *values, uint32_t count, uint32_t step)
{
    struct spread spread = {.p5 = NAN, .median = NAN, .p95 = NAN};
    double *sorted = calloc((size_t)count + 1, sizeof *sorted);
    for (uint32_t i = 0; sorted && i < count; i++) {
        if (!isnan(values[(size_t)i * step]))
            sorted[spread.count++] = values[(size_t)i * step];
    }
    if (spread.count) {
        qsort(sorted, spread.count, sizeof *sorted, compare_numbers);
        spread.p5 = quantile(sorted, spread.count, 0.05);
        spread.median = quantile(sorted, spread.count, 0.5);
        spread.p95 = quantile(sorted, spread.count, 0.95);
    }
    free(sorted);
    return spread;
}
