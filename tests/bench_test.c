/* Parts of `bench` that need no device: order statistics against values that NumPy's documentation
 * and Hyndman and Fan (1996) define, and the counting of allocations. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <pthread.h>

#include <cmocka.h>

#include "app/base/spread.h"
#include "app/run/allocations.h"

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

/* ---- Allocations ----------------------------------------------------------------------------- */

/* The compiler may not leave a call out whose result it knows. */
static void *(*volatile make)(size_t) = malloc;
static void *(*volatile make_zeroed)(size_t, size_t) = calloc;
static void *(*volatile grow)(void *, size_t) = realloc;
static void *(*volatile make_aligned)(size_t, size_t) = aligned_alloc;
static char *(*volatile copy)(const char *) = strdup;

static void calls_are_counted_while_asked_for(void **unused)
{
    (void)unused;
    allocations_begin(NULL);
    struct allocations none = allocations_end();
    allocations_begin(NULL);
    void *memory = grow(make(16), 32);
    void *zeroed = make_zeroed(2, 8);
    struct allocations found = allocations_end();
    void *later = make(8);
    assert_int_equal(none.own, 0);
    assert_int_equal(none.all, 0);
    assert_int_equal(found.own, 3);
    assert_int_equal(found.all, 3);
    assert_int_equal(allocations_end().all, 3);
    free(memory);
    free(zeroed);
    free(later);
}

/* strdup lies in the C library, as a driver does in a library of its own. */
static void a_library_is_told_apart(void **unused)
{
    (void)unused;
    allocations_begin(NULL);
    char *text = copy("text");
    struct allocations found = allocations_end();
    assert_int_equal(found.own, 0);
    assert_int_equal(found.all, 1);
    /* a library that is the generated pipeline counts as our own */
    allocations_begin((const void *)strdup);
    char *again = copy("text");
    found = allocations_end();
    assert_int_equal(found.own, 1);
    free(text);
    free(again);
}

static void *allocate_in_thread(void *unused)
{
    (void)unused;
    return make(64);
}

static void other_threads_are_counted(void **unused)
{
    pthread_t thread;
    void *memory = NULL;
    (void)unused;
    allocations_begin(NULL);
    assert_int_equal(pthread_create(&thread, NULL, allocate_in_thread, NULL), 0);
    pthread_join(thread, &memory);
    assert_int_equal(allocations_end().own, 1);
    free(memory);
}

static void aligned_memory_is_aligned(void **unused)
{
    void *memory = NULL;
    (void)unused;
    allocations_begin(NULL);
    assert_int_equal(posix_memalign(&memory, 256, 100), 0);
    void *other = make_aligned(64, 128);
    assert_int_equal(allocations_end().own, 2);
    assert_int_equal((size_t)memory % 256, 0);
    assert_int_equal((size_t)other % 64, 0);
    free(memory);
    free(other);
    assert_int_not_equal(posix_memalign(&memory, 24, 100), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_lies_in_the_middle),
        cmocka_unit_test(quantiles_are_linear_between_neighbours),
        cmocka_unit_test(one_column_of_a_table_without_its_gaps),
        cmocka_unit_test(nothing_has_no_median),
        cmocka_unit_test(calls_are_counted_while_asked_for),
        cmocka_unit_test(a_library_is_told_apart),
        cmocka_unit_test(other_threads_are_counted),
        cmocka_unit_test(aligned_memory_is_aligned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
