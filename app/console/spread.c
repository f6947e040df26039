/* Order statistics; see spread.h. */
#include "console/spread.h"

#include <math.h>
#include <stdlib.h>

static int compare_numbers(const void *a, const void *b)
{
    double left = *(const double *)a;
    double right = *(const double *)b;
    return (left > right) - (left < right);
}

double median_of(const double *values, uint32_t count, uint32_t step)
{
    uint32_t known = 0;
    double *sorted = calloc((size_t)count + 1, sizeof *sorted), median = NAN;
    for (uint32_t i = 0; sorted && i < count; i++)
        if (!isnan(values[(size_t)i * step]))
            sorted[known++] = values[(size_t)i * step];
    if (known) {
        qsort(sorted, known, sizeof *sorted, compare_numbers);
        median = (sorted[(known - 1) / 2] + sorted[known / 2]) / 2;
    }
    free(sorted);
    return median;
}
