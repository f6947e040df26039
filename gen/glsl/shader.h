/* One stage of one pass: its GLSL, which this room writes, and its SPIR-V, which spirv/ makes of it. */
#pragma once

#include "base/text.h"
#include "model/source.h"

enum backend { BACKEND_GL, BACKEND_VK };
enum stage { STAGE_IS_COMPUTE, STAGE_IS_VERTEX, STAGE_IS_FRAGMENT };

struct shader { /* one compiled stage of one pass for one backend */
    enum stage stage;
    struct text glsl;  /* complete, readable source; OpenGL's with model->text alone */
    struct text whole; /* a whole shader's own text: then the other texts hold what joins it */
    const struct shader *before; /* of a whole fragment shader: the vertex shader; NULL: none */
    bool fast;                   /* of a pass that is */
    uint64_t formats;            /* hash of the formats that it reads and writes: spirv_formats() */
    uint64_t hash[2];            /* of all that it is compiled from: shader_hash(); 0: none */
    bool own;         /* does something else than the other backend's, not only by other names */
    struct text code; /* OpenGL's if `own`: for glslang, so in Vulkan's GLSL */
    const struct body_files *files; /* that the text may include; NULL: none */
    uint32_t turn;                  /* from 1: its place among shaders that compile in parallel */
    uint32_t *words;                /* SPIR-V; free() */
    size_t word_count;
    /* glsl_adapt: names that the body declares although the generator or GLSL has them, and names
     * to declare that no file has as a word */
    const char *const *own_names, *const *wanted;
    uint32_t own_count, wanted_count;
};
/* What glslang compiles. */
static inline const struct text *shader_code(const struct shader *shader)
{
    return shader->code.length ? &shader->code : &shader->glsl;
}

/* emit_glsl.c: the complete GLSL of one stage: declarations, library pieces
 * (model->templates_dir/glsl), the body with #line. For Vulkan sets `own`; OpenGL's has Vulkan's, and
 * gets `glsl` with model->text alone. Adds files that the body includes to model->inputs and
 * model->glsl_sources; changes nothing else in the model. */
bool emit_glsl(struct model *model, const struct pass *pass, enum backend backend, enum stage stage,
               struct shader *shader, struct diag *diag);
/* glsl_messages.c: takes in from the messages of a failed shader what emit_glsl can do better: see
 * struct shader. False: nothing new. */
bool glsl_adapt(struct model *model, const struct pass *pass, struct shader *shader,
                const char *log);
/* The same file: reports the messages about `glsl`, what glslang got. */
void glsl_report(struct model *model, const struct pass *pass, const char *glsl, const char *log,
                 struct diag *diag);
