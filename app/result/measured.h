/* --measure: how far runs of each side, and of both sides, are apart, resource by resource; contracts that are as tight
 * as that; and which of it has grown since contracts were written. */
#pragma once

#include "console/console.h"
#include "result/sheet.h"

/* Of rows with errors. */
bool measured_print(const struct sheet *sheet,
                    struct console *console); /* on stdout; false: told */
struct cJSON *measured_json(const struct sheet *sheet);

/* Fills the errors of a row from all pairs of runs of a side, and of both sides. `add` adds those of two runs, sides 0 or 1,
 * with measured_add. False: logged. */
typedef bool measured_pair(void *user, struct errors *errors, const int sides[2],
                           const uint32_t runs[2]);
bool measured_row(struct sheet_row *row, uint32_t runs, measured_pair *add, void *user,
                  const struct dt_log *log);
/* `copies` in one form, or NULL: they cannot be compared. False when out of memory. */
bool measured_add(struct errors *errors, const struct dt_resource *resource,
                  const struct dt_bytes *copies);

/* Writes contracts that all runs of all pairs of sides keep. False: logged. */
bool measured_write(const struct sheet *const *sheets, uint32_t count, const char *path,
                    struct console *console);

/* Prints a line for each error of a row that is larger than when its contract was written. */
void measured_grown(const struct sheet *sheet);

/* Whether two runs of both sides break the contract of some row's resource: of one with a single bound, or exact. */
bool measured_breaks(const struct sheet *sheet);
