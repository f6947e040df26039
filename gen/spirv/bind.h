/* A whole shader keeps its own declarations: this pass gives its textures, images and buffers the
 * bindings of the plan, and fills its uniforms from functions that stand beside it. */
#pragma once

#include "model/module.h"

struct bind_slot {
    const char *name; /* of the shader's variable, or of its block if that has no instance name */
    int binding;
    unsigned kind;      /* mask of enum dt_access: how the pass binds it */
    bool compare;       /* its sampler compares depths */
    char declared[32];  /* of an image: as GLSL declares it, "usampler2D" */
    const char *format; /* of a storage image, in GLSL; NULL: another */
};

struct bind_request {
    const struct bind_slot *slots;
    uint32_t slot_count;
    char targets[8];       /* of a draw: f, i or u, the numbers of each target; 0: no target */
    bool inputs;           /* the stage's inputs get values, too */
    bool exact;            /* the pass is not fast */
    uint32_t first;        /* of the generator's ids: see passes.h */
    const uint32_t *local; /* size of a workgroup; NULL: no compute stage */
};

/* The functions are TYPE diptych_value_NAME(), by the name of the uniform, member or input. Blocks and
 * inputs become private variables, and the module gets diptych_begin(), which fills them (entry.c).
 * False: *why, free(), says what is missing or does not fit; NULL: out of memory. */
bool spirv_bind(struct spirv *module, const struct bind_request *request, char **why);
