/* The instrumentation of --sanitize; see sanitize.c. */
#pragma once

#include "plan/sanitize.h"
#include "model/module.h"

/* The module comes from glslang with OpLine, and has the functions of templates/glsl/sanitize.glsl. Operations of the kinds
 * get calls of them; OpLine goes. `add` takes a site and returns its index. False when out of memory. */
struct sanitize_request {
    unsigned kinds; /* mask of enum sanitize_kind */
    const struct pass *pass;
    uint32_t (*add)(void *user, const struct sanitize_site *site);
    void *user;
};
bool spirv_sanitize(struct spirv *module, const struct sanitize_request *request);
