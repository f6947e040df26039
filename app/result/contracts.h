/* --contracts FILE: how far resources may differ, in the words of a spec, and what --measure once found:
 *
 *   default: {ulp: 1}                 of dumps alone; a spec has its own contracts
 *   radiance: {rel: 1e-3}             a resource, after any pass
 *   tonemap.display: exact            after this pass; of dumps alone
 *   picture: {image: {max: 2/255, outliers: 0.1%}}
 *   visible: {flips: 3, margin: margins.distance}
 *   triangle: {raster: 0.2%}
 *   albedo: {of_exact: 1e-4}          of a spec, where `exactness` leaves the pass free
 *
 * --write-contracts adds `measured: RUNS`, and to contracts the largest errors that it measured, in the contract's
 * own measure: `noise` of a side, `drift` between versions of one backend, difference of `backends`. */
#pragma once

#include "diptych.h"

enum measured_kind { MEASURED_NOISE, MEASURED_DRIFT, MEASURED_BACKENDS, MEASURED_KINDS };
extern const char *const measured_names[MEASURED_KINDS]; /* "noise", ... */

struct kept_contract {
    const char *name;                /* a resource, PASS.RESOURCE, or "default"; the caller's */
    struct dt_contract contract;     /* margin_field is -1: */
    char *margin;                    /* BUFFER or BUFFER.FIELD; NULL: none; owned */
    double measured[MEASURED_KINDS]; /* NAN: not measured */
};

struct contracts {
    struct kept_contract *list;
    uint32_t count;
};

/* `names` are those that the file may have; they live as long as the contracts. False: logged. contracts_free either way. */
bool contracts_read(struct contracts *contracts, const char *path, const char *const *names,
                    uint32_t count, const struct dt_log *log);
/* The one of PASS.RESOURCE, else of the resource, else the default; NULL: none. */
const struct kept_contract *contracts_find(const struct contracts *contracts, const char *pass,
                                           const char *resource);
void contracts_free(struct contracts *contracts); /* takes a zeroed one */

/* The field of a buffer that a margin names, as contract.margin_field; -1: it is no float of it. */
int16_t contracts_margin(const struct kept_contract *kept, const struct dt_resource *buffer);
