/* A preset while it becomes a spec; chain.c reads it, chain_spec.c writes it. */
#pragma once

#include "import/import.h"
#include "import/slang.h"

enum { MOST_PASSES = 128, MOST_PICTURES = 64, CHAIN_MIPS = 8, MOST_HISTORY = 64 };

struct chain_pass {
    struct slang slang;
    char *path;                  /* of the shader */
    struct reflection stages[2]; /* vertex, fragment */
    char file[160];              /* of its text in the folder */
    char alias[128];             /* "": none */
    const char *format;
    char width[160], height[160]; /* integer expressions; "": the frame's */
    uint32_t size[2];             /* their values; 0: by the frame's */
    bool linear, mipmap;          /* how it reads what the pass before left */
    const char *wrap;
    unsigned period; /* of FrameCount; 0: none */
    uint32_t mips;   /* that the next pass reads; 0: none */
};

struct chain_picture { /* a look-up picture */
    char name[128], file[160];
    const char *wrap;
    bool linear;
    uint32_t mips;
};

struct chain {
    struct import *import;
    struct preset preset;
    struct chain_pass passes[MOST_PASSES];
    uint32_t pass_count;
    struct chain_picture pictures[MOST_PICTURES];
    uint32_t picture_count;
    uint32_t size[2]; /* of the picture */
    bool stretched;   /* the last pass is not of the frame's size: a pass of ours fits it */
};

/* What a pass reads by a name. */
struct chain_read {
    char image[160];
    unsigned previous; /* frames back */
    bool linear, mips;
    const char *wrap;
};
/* False: the name means nothing. */
bool chain_find(const struct chain *chain, uint32_t pass, const char *name,
                struct chain_read *read);
/* The parameter of a shader with this name; NULL: none. */
const struct slang_param *chain_param(const struct chain *chain, const char *name);
/* GLSL for the width (axis 0) or height (1) of the texture with this name. */
bool chain_size(const struct chain *chain, uint32_t pass, const char *name, char out[2][160]);

/* The spec. False: logged. */
bool chain_write(const struct chain *chain, const char *picture, struct text *out);
