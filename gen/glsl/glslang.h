/* glslang's C++ interface behind C functions that throw nothing. glslang's C interface reads every
 * shader twice: it cannot parse what it has not preprocessed into text before. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* False: no memory to start glslang, which it then never does. Jobs that are `whole` and those that are not have tables of
 * their own. Further calls do nothing; the first must have returned before other threads compile. */
bool glslang_start(bool whole);

/* A file that glslang includes. Its number stands for its name in messages and in OpLine. */
struct glslang_file {
    const char *number, *text;
    size_t length;
};

struct glslang_job {
    const char *code; /* Vulkan's GLSL, whose first line is #version; or HLSL */
    int stage;        /* enum stage */
    int minor;        /* of the version of SPIR-V: 1.0, 1.3 or 1.5 */
    bool lines;       /* with OpLine */
    bool marked;      /* the author's operations have RelaxedPrecision, those that glslang adds have
                         not */
    bool whole;       /* with declarations of its own, also those of OpenGL's GLSL */
    bool opengl;      /* as OpenGL reads it: uniforms keep their initializers */
    bool structs;     /* with `opengl`, to be compiled: structs of uniforms keep their textures */
    const char *hlsl; /* the entry point of HLSL; NULL: GLSL */
    const char *name; /* of the file, for OpLine of HLSL */
    const char *more; /* HLSL before it; NULL: none */
    /* #include "name" in the file of that number; "": in `code`. False: there is none. */
    bool (*include)(const void *user, const char *from, const char *name,
                    struct glslang_file *file);
    const void *user;
};

/* SPIR-V of a shader, *count words; free(). NULL: *log, free(), has the messages of glslang, or is
 * NULL, too, when memory ran out. */
uint32_t *glslang_compile(const struct glslang_job *job, size_t *count, char **log);

/* The text behind the preprocessor, with #line, and zeros up to a multiple of four; free(). NULL: *log as above. */
char *glslang_preprocess(const struct glslang_job *job, char **log);
