/* --measure: how far runs of each side, and of both sides, are apart, resource by resource; contracts that are as tight
 * as that; and which of it has grown since contracts were written. */
#ifndef DIPTYCH_MEASURED_H
#define DIPTYCH_MEASURED_H

#include "console/console.h"
#include "result/contracts.h"
#include "result/difference.h"

struct measured_row {
    const char *pass, *name, *key; /* key: in contracts; borrowed */
    const struct dt_resource *resource;
    const struct kept_contract *kept; /* NULL: none */
    struct errors noise[2], between;
    struct errors
        exact; /* of both sides, against exact twins on equal inputs; no pairs: not judged */
};

/* Of one pair of sides. */
struct measured {
    const char *labels[2];
    enum measured_kind kind; /* MEASURED_DRIFT: versions of one backend, else MEASURED_BACKENDS */
    uint32_t runs;           /* of each side */
    struct measured_row *rows;
    uint32_t count;
};

void measured_print(const struct measured *measured); /* on stdout */
struct cJSON *measured_json(const struct measured *measured);

/* Writes contracts that all runs of all pairs keep. False: logged. */
bool measured_write(const struct measured *pairs, uint32_t count, const char *path,
                    struct console *console);

/* Prints a line if the kind of error is larger than when the contract was written. `error` is in the contract's measure. */
void measured_compare(const struct kept_contract *kept, enum measured_kind kind, const char *side,
                      const char *name, double error);

/* The same of noise and of the difference in all runs. */
void measured_grown(const struct measured *measured, const struct measured_row *row);

/* Whether two runs of both sides break the contract of some row's resource: of one with a single bound, or exact. */
bool measured_breaks(const struct measured *measured);

/* The largest error in a contract's own measure. */
double errors_under(const struct errors *errors, const struct dt_contract *contract);
double difference_error(const struct difference *difference);

#endif
