/* What a shader declares: its text goes through glslang as gen does it. What main does not reach is left out. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum reflected_kind {
    REFLECTED_TEXTURE, /* sampled */
    REFLECTED_IMAGE,
    REFLECTED_BUFFER,
    REFLECTED_VALUE, /* a uniform, or a member of a block of them */
    REFLECTED_INPUT,
    REFLECTED_OUTPUT,
    REFLECTED_CONSTANT /* of specialization */
};

enum { MOST_TARGETS = 8 };

struct reflected {
    enum reflected_kind kind;
    char name[256]; /* what gen calls it: see gen/spirv/bind.h */
    char as[256];   /* the same, where import gives a resource another name; "": it has its own */
    char type
        [64]; /* GLSL: "vec4", "float[3]", "sampler2D"; of a buffer's elements; "": another, such as a struct */
    const char *format; /* image: a word of formats.def; NULL: none given */
    const char *
        shape; /* texture, image: "2D", "2D array", "3D", "cube", "cube array"; NULL: not in passes */
    char scalar;           /* texture, image: f, i or u */
    bool depth;            /* texture: sampled by comparison */
    bool reads, writes;    /* image, buffer */
    uint32_t location;     /* input, output; MOST_TARGETS: a second source of blending */
    uint32_t set, binding; /* image, buffer; UINT32_MAX: none */
    uint64_t bytes;        /* buffer: least size */
    uint64_t stride;       /* buffer: of the elements of an open array of structs; 0: another */
    double number;         /* constant */
    char *initial;         /* value: a constructor; NULL: none */
};

struct reflection {
    struct reflected *list;
    uint32_t count;
    uint32_t local[3]; /* of a compute shader */
    bool spread;       /* its invocations know their workgroup */
    bool subgroups;    /* it has operations of subgroups */
};

enum { REFLECT_COMPUTE, REFLECT_VERTEX, REFLECT_FRAGMENT }; /* as enum stage of gen/stages.h */

/* text: with or without #version, which is taken for 460. include: as of glslang_job, or NULL. False:
 * *why, free(), has glslang's message. Call reflect_free either way. */
struct glslang_file;
bool reflect(const char *text, int stage,
             bool (*include)(const void *user, const char *from, const char *name,
                             struct glslang_file *file),
             const void *user, struct reflection *reflection, char **why);
/* The same of a module that spirv_check took. */
bool reflect_module(const uint32_t *words, size_t count, int stage, struct reflection *reflection,
                    char **why);
/* An initial_taker of a reflection's values. */
void reflect_initial(void *user, const char *name, const char *value);
void reflect_free(struct reflection *reflection);
