/* Parts of `bench` that need no device: order statistics against values that NumPy's documentation
 * and Hyndman and Fan (1996) define. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <pthread.h>

#include <cmocka.h>

#include "app/console/spread.h"

/* ---- Order statistics ------------------------------------------------------------------------ */

static void median_lies_in_the_middle(void **unused)
{
    static const double odd[] = {5, 1, 3}, even[] = {4, 1, 3, 2};
    (void)unused;
    assert_float_equal(spread_of(odd, 3, 1).median, 3, 0);
    assert_float_equal(spread_of(even, 4, 1).median, 2.5, 0);
    assert_int_equal(spread_of(even, 4, 1).count, 4);
}

/* Type 7: of the 21 values 0, 10, ..., 200 the quantile q is 200 q; of 1, 2, 3, 4 the 5 % quantile
 * is 1.15 (numpy.quantile([1, 2, 3, 4], 0.05)) and the 95 % quantile 3.85. */
static void quantiles_are_linear_between_neighbours(void **unused)
{
    double steps[21];
    (void)unused;
    for (int i = 0; i < 21; i++)
        steps[i] = (i * 8 % 21) * 10; /* 8 and 21 share no factor: all values, out of order */
    struct spread spread = spread_of(steps, 21, 1);
    assert_float_equal(spread.p5, 10, 1e-12);
    assert_float_equal(spread.median, 100, 1e-12);
    assert_float_equal(spread.p95, 190, 1e-12);
    static const double few[] = {3, 1, 4, 2};
    spread = spread_of(few, 4, 1);
    assert_float_equal(spread.p5, 1.15, 1e-12);
    assert_float_equal(spread.p95, 3.85, 1e-12);
}

static void one_column_of_a_table_without_its_gaps(void **unused)
{
    const double table[] = {7, 100, NAN, 200, 9, 300, 8, 400};
    (void)unused;
    struct spread spread = spread_of(table, 4, 2);
    assert_int_equal(spread.count, 3);
    assert_float_equal(spread.median, 8, 0);
    assert_float_equal(spread_of(table + 1, 4, 2).median, 250, 0);
}

static void nothing_has_no_median(void **unused)
{
    const double gaps[] = {NAN, NAN};
    (void)unused;
    struct spread spread = spread_of(gaps, 2, 1);
    assert_int_equal(spread.count, 0);
    assert_true(isnan(spread.median) && isnan(spread.p5) && isnan(spread.p95));
    assert_int_equal(spread_of(gaps, 0, 1).count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_lies_in_the_middle),
        cmocka_unit_test(quantiles_are_linear_between_neighbours),
        cmocka_unit_test(one_column_of_a_table_without_its_gaps),
        cmocka_unit_test(nothing_has_no_median),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
