/* Difference of two copies of a resource under its contract, as text and as JSON. */
#pragma once

#include "picture/texels.h"
#include "diptych.h"

struct cJSON;

enum verdict {
    VERDICT_EQUAL,      /* bit for bit, and finite */
    VERDICT_WITHIN,     /* bits differ, within the contract's tolerance */
    VERDICT_NOT_FINITE, /* one of these, but for NaN or the same Inf, in the same places */
    VERDICT_DIFFERS,    /* beyond the contract, or NaN or Inf in one copy */
};

/* One number of one element, in both copies. */
struct number_pair {
    bool valid;
    uint32_t frame;
    uint64_t element;
    struct component component;
    uint32_t bits[2];
    double values[2];
    /* in the contract's own measure: ulp, relative (of_exact: of one code or step 0), else absolute; 1 for a flip; INFINITY where NaN or
     * Inf make it meaningless */
    double error;
};

/* An element of discrete data with another value; the first of its numbers that differs. */
struct flip {
    struct number_pair pair;
    bool has_margins;
    uint32_t margin_bits[2]; /* float */
};

enum { MOST_FLIPS = 16 }; /* kept in the list; all are counted */

/* Of one resource after one pass of one frame. Holds no memory. */
struct difference {
    struct dt_contract contract; /* that it was measured under */
    uint64_t elements;           /* or texels */
    uint64_t differing;          /* with at least one differing number */
    uint64_t beyond;     /* with at least one number beyond the tolerance; flips: all that differ */
    uint64_t not_finite; /* numbers that are NaN or Inf in either copy, */
    uint64_t not_in_both;  /* and of these, those that are neither NaN nor the same Inf in both */
    uint64_t at_edges;     /* `raster`: with a differing number, at an edge; not in `beyond` */
    uint64_t other_depths; /* of a draw: both copies show a surface; not in `differing` */
    bool size_differs;     /* the copies have different sizes: nothing else was compared */
    bool broken;           /* the copies are beyond the contract */
    uint32_t extent[3];
    struct number_pair
        worst; /* the largest error; of all, the first NaN or Inf in one copy, and the least, in both */
    struct flip flips[MOST_FLIPS];
    uint32_t flip_count;
};

/* Compares the copies of one frame. Only declared fields count, not padding. A denormal float counts as
 * a zero of its sign. No contract accepts NaN and Inf. False when out of memory. */
bool difference_measure(struct difference *difference, const struct dt_resource *resource,
                        uint32_t frame, const struct dt_bytes copies[2]);

/* The same of what a draw of triangles left, under a contract that allows differences at edges.
 * `edges`: of edges_find, per element. Of depth only coverage counts: rasterizers snap corners to
 * grids of their own, which moves the depth of steep triangles. */
bool difference_measure_draw(struct difference *difference, const struct dt_resource *resource,
                             uint32_t frame, const struct dt_bytes copies[2], const bool *edges);

/* Whether there are flips whose contract names margins: then both copies of
 * contract.margin_resource, as they are after the same pass, go to difference_add_margins. */
bool difference_needs_margins(const struct difference *difference,
                              const struct dt_resource *resource);
/* `margin` is the resource that contract.margin_resource names. A flip beyond its end stays without
 * margins. */
void difference_add_margins(struct difference *difference, const struct dt_resource *resource,
                            const struct dt_resource *margin, const struct dt_bytes margins[2]);

/* How far two numbers of one kind are apart: floats in ulp, codes of unorm and snorm in codes, integers as they are; INFINITY
 * where either is NaN or Inf, unless both have the same bits. */
double difference_distance(enum number_kind kind, const uint32_t bits[2]);

/* Numbers whose bits differ, by their distance in ulp, in codes, or of integers: none for zeros of two
 * signs, then 2^(i-1) to 2^i - 1 in bin i; NaN and Inf in the last. Copies have one size. False when out
 * of memory. */
enum { DIFFERENCE_BINS = 34 };
bool difference_histogram(uint64_t bins[DIFFERENCE_BINS], const struct dt_resource *resource,
                          const struct dt_bytes copies[2]);

/* Errors of many pairs of copies. Sizes of errors are absolute, in steps of 1, 1.5, 2, 3, 5, 7 and 10. */
enum { ERROR_STEPS = 246 };
struct errors {
    uint32_t pairs;
    uint64_t elements;  /* of a pair */
    bool odd;           /* a pair of another size, or with NaN or Inf, which no contract allows */
    bool missing;       /* in one of the runs */
    uint64_t differing; /* elements with a differing number, in the pair that has most */
    double ulp, rel, abs, of_exact; /* the largest */
    uint64_t beyond
        [ERROR_STEPS]; /* elements with an error above errors_step(i), in the pair with most */
};
double errors_step(int step); /* as the decimal number of one or two digits reads */
/* False when out of memory. */
bool errors_add(struct errors *errors, const struct dt_resource *resource,
                const struct dt_bytes copies[2]);
void errors_join(struct errors *errors, const struct errors *more);
/* No more than the share 1 - q of a pair's elements has larger errors; 0: equal. */
double errors_quantile(const struct errors *errors, double q);

enum verdict difference_verdict(const struct difference *difference);
/* How much of the contract's bound the copies use: 1 is all, more breaks it. NAN: the contract has no bound, or the
 * numbers have no distance. */
double difference_used(const struct difference *difference);
const char *verdict_name(enum verdict verdict); /* "equal", "within", "not finite", "DIFFERS" */

/* ---- What is told (difference_report.c). `labels` name the two copies, like "gl" and "vk". --- */

/* Strings are malloc'ed, NULL when out of memory. */

/* One line: how large the worst error is, where, and both values, decimal (the shortest that reads
 * back) and hexadecimal: "1 ulp at [3].flux.y, frame 0: gl 0.5 (0x3f000000), vk ...". "-" for equal
 * copies; tells of differing sizes, and of numbers that are not finite. */
char *difference_describe_worst(const struct difference *difference,
                                const struct dt_resource *resource, const char *const labels[2]);

/* One line per flip, indented by two spaces, each with its end of line: the element, both values and
 * both margins; closes with how many more there are. Empty without the contract `flips`. */
char *difference_list_flips(const struct difference *difference, const struct dt_resource *resource,
                            const char *const labels[2]);

/* The share of the bound that is used, "12 %", rounded up; "-" without one. */
void difference_write_used(const struct difference *difference, char text[16]);

/* Adds to an object: contract, tolerance, outliers. */
void contract_json(struct cJSON *root, const struct dt_contract *contract);
/* Adds to an object: those, elements, differing, beyond, not_finite, size_differs, verdict, worst,
 * and with the contract `flips` the list of them. */
void difference_json(struct cJSON *root, const struct difference *difference,
                     const struct dt_resource *resource, const char *const labels[2]);
