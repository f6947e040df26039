/* All stages from a spec to tables in one call: for main.c, which writes the tables as
 * C, and for the app, which executes them. */
#pragma once

#include "lower/lower.h"
#include "request.h"

/* The results for one spec. Zero before spec_load; call spec_free also after an error. */
struct spec {
    struct model model;
    struct pass_shaders *shaders[2]; /* by enum backend */
    struct lowered *tables;
};

/* False: the errors are in diag. `tables` false: makes no tables, for callers that only check. */
bool spec_load(struct spec *spec, const struct spec_request *request, bool tables,
               struct diag *diag);
/* The same for `target: auto`: specs[1] is planned for GPUs, and its errors, where the first has none, are in
 * diags[1], with the same warnings as the first. It stays zero for other targets, or if it is NULL. */
bool spec_load_both(struct spec *specs[2], const struct spec_request *request, bool tables,
                    struct diag *diags[2]);
void spec_free(struct spec *spec);
