/* The road from a spec to tables (stages.h), in one call: for main.c, which writes them as C, and for the
 * app, which plays them. */
#ifndef DIPTYCH_GEN_LOAD_H
#define DIPTYCH_GEN_LOAD_H

#include "lower.h"
#include "shader_cache.h"

struct spec_request {
    const char *path;
    const char *const *sets; /* "PATH=VALUE" */
    size_t set_count;
    const char *templates;      /* folder with glsl/ */
    struct shader_cache *cache; /* NULL: every shader is compiled */
};

/* Everything of one spec. Zero before spec_load; spec_free in any case. */
struct spec {
    struct model model;
    struct pass_shaders *shaders[2]; /* by enum backend */
    struct lowered *tables;
};

/* False: the errors are in diag. `tables` false: stops before them, for those who only check. */
bool spec_load(struct spec *spec, const struct spec_request *request, bool tables,
               struct diag *diag);
void spec_free(struct spec *spec);

/* Reads the spec alone, before anything is checked: for the names of its parameters. */
bool spec_read(struct spec *spec, const struct spec_request *request, struct diag *diag);

#endif
