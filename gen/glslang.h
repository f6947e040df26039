/* glslang's C++ interface behind two C functions. Its C interface reads every shader twice: it
 * cannot parse what it has not preprocessed into text before. Called by spirv.c. */
#ifndef DIPTYCH_GEN_GLSLANG_H
#define DIPTYCH_GEN_GLSLANG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* False: glslang could not start. Once per process. */
bool glslang_start(void);

struct glslang_job {
    const char *code; /* Vulkan's GLSL */
    int stage;        /* enum stage */
    int minor;        /* of the version of SPIR-V: 1.0, 1.3 or 1.5 */
    bool lines;       /* with OpLine */
};

/* SPIR-V of a shader, *count words; free(). NULL: *log, free(), has the messages of glslang, or is
 * NULL, too, when memory ran out. */
uint32_t *glslang_compile(const struct glslang_job *job, size_t *count, char **log);

#endif
