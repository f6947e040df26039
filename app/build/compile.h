/* The C compiler: what the generator wrote into one shared object. Called by cache.c. */
#ifndef DIPTYCH_COMPILE_H
#define DIPTYCH_COMPILE_H

#include "build/cache.h"
#include "build/stamp.h"

struct compile_work {
    const struct build_request *request;
    struct stamp_work stamp; /* its folder holds the sources, and takes panels.so */
    const char *base;        /* of the cache, where objects are kept */
    const char *name;        /* of the pipeline */
};

/* The name of the compiler; it outlives the request. */
const char *compiler_of(const struct build_request *request);

/* Reflection, both panels and their shaders; what an edit left as it was is not compiled again.
 * `files` gets the stamp's lines for the headers. */
bool compile_pipeline(const struct compile_work *work, FILE *files, struct console *console);

#endif
