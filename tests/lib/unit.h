/* Tests in C: `TEST(name) { ... }` is a test by being there, RUN_TESTS is the program's main. Tests run in the order of the file, by
 * cmocka, whose headers come with this one. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { MOST_UNITS = 64 };

static struct CMUnitTest units[MOST_UNITS];
static size_t unit_count;

static inline void unit_add(struct CMUnitTest test)
{
    assert_in_range(unit_count, 0, MOST_UNITS - 1);
    units[unit_count++] = test;
}

static inline int unit_run(const char *name, CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
    return _cmocka_run_group_tests(name, units, unit_count, set_up, tear_down);
}

/* A function that runs before main, those of a file in their order. */
#define BEFORE_MAIN(name) __attribute__((constructor(1000 + __COUNTER__))) static void name(void)

/* A test between functions of its own; NULL: none. */
#define TEST_WITH(name, set_up, tear_down)                                                         \
    static void name(void **state);                                                                \
    BEFORE_MAIN(add_##name)                                                                        \
    {                                                                                              \
        unit_add((struct CMUnitTest){#name, name, set_up, tear_down, NULL});                       \
    }                                                                                              \
    static void name(__attribute__((unused)) void **state)
#define TEST(name) TEST_WITH(name, NULL, NULL)

/* Of the whole group: set_up before the first test, tear_down after the last; NULL: none. */
#define RUN_TESTS(name, set_up, tear_down)                                                         \
    int main(void)                                                                                 \
    {                                                                                              \
        return unit_run(name, set_up, tear_down);                                                  \
    }
