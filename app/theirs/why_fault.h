/* The faults of why.c: what one renderer does and the other does not. Each predicts one copy, `to`, from
 * the other, `from`. */
#pragma once

#include "theirs/why.h"

enum { FAULT_NUMBERS = 4 };

/* A copy, or a relative of one. */
struct copy {
    uint8_t *data;
    size_t size;
    uint32_t extent[3];
};

/* Both copies and what faults may look at. */
struct asked {
    const struct dt_resource *resource;
    const struct component *components;
    const uint32_t *transposed; /* of each component: that of the transposed matrix, or itself */
    uint32_t count; /* components that are compared; a fourth channel that is 1 is not */
    uint32_t stride;
    bool image;
    const struct copy *from, *to;
    struct copy copies[2], relatives[2][WHY_RELATIVES];
    int side;                        /* index of `from` in copies */
    double p[FAULT_NUMBERS];         /* of the fault in question, and what its `fit` has found */
    const uint64_t *differing, *all; /* samples: elements that differ; elements of any kind */
    uint32_t differing_count, all_count;
    double range; /* mean magnitude of the numbers */
};

/* A place in a copy, and one of its numbers. */
struct place {
    uint64_t element;
    int64_t x, y, z; /* of a buffer: x is the element */
    uint32_t component;
};

struct fault {
    const char *name;
    /* Follows "equal" or "nearer". {from} and {to} are the copies' names, {0} to {3} numbers of `fit` or
     * of p. */
    const char *text;
    /* One of these: a number of `to` by the same number of `from`; by anything of `from`, NAN: not known;
     * whether the element is where the fault shows; the share of differing elements that it leaves
     * unexplained, above 1: it does not apply. */
    double (*map)(const double *p, double value);
    double (*at)(const struct asked *asked, struct place place);
    bool (*where)(const struct asked *asked, struct place place);
    double (*share)(const struct asked *asked);
    bool (*applies)(const struct asked *asked); /* NULL: always */
    bool (*fit)(struct asked *asked);           /* fills asked->p; false: it does not apply */
    double p[FAULT_NUMBERS];
    bool channels;  /* p is the channel of `from` that each of `to` has */
    bool symmetric; /* the same from either copy */
    double doubt;   /* 0 to 0.5: added to its cost, for faults that fit much */
};

enum { SIDED, SAME }; /* for `symmetric` */

/* why_at.c, why_map.c, why_where.c. Of two that explain as much the first is named. */
struct fault_list {
    const struct fault *list;
    uint32_t count;
};
extern const struct fault_list faults_at, faults_map, faults_where;

/* A number of the copy; NAN outside. */
double copy_number(const struct asked *asked, const struct copy *copy, struct place place);
struct place place_of(const struct asked *asked, uint64_t element, uint32_t component);
/* The same number of `from` or of `to`, or one of another place or component of `from`. */
double same_from(const struct asked *asked, struct place place, uint32_t component);
double to_number(const struct asked *asked, struct place place);
double from_at(const struct asked *asked, struct place place, int64_t x, int64_t y, int64_t z,
               uint32_t component);
