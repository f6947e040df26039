/* The GLSL of one stage becomes SPIR-V: glslang, the passes of this room, spirv-val. */
#pragma once

#include "glsl/shader.h"

/* *log: the messages of glslang, for glsl_adapt and glsl_report; free(); log, and diag for other errors,
 * may be NULL. After spirv_init has returned true for its kind of shader, spirv_compile may run on several threads, also beside
 * emit_glsl. */
bool spirv_init(bool whole);
const char *spirv_tools(void); /* names and versions of the compiler and its tools */
bool spirv_compile(const struct model *model, const struct pass *pass, enum backend backend,
                   struct shader *shader, char **log, struct diag *diag);
/* Makes the words of a compiled shader those for CPU drivers: loops.c. False: *why, free(), has the words of
 * spirv-val; NULL: out of memory. */
bool spirv_for_cpu(struct shader *shader, char **why);
/* Makes them OpenGL's. */
bool spirv_make_opengl(const struct pass *pass, struct shader *shader);
/* Reports each open operation of a compiled shader (prove.h) at its place in the body. Without
 * model->prove, only those that are wrong. */
void spirv_prove(const struct model *model, const struct pass *pass, const struct shader *shader,
                 struct diag *diag);
/* prove_fixed.c: reports what the fixed functions of a draw leave open in its targets of the contract
 * `exact`: blending, coverage, depth, the encoding of colours. `fragment`: its shader, if any. */
void prove_fixed(const struct pass *pass, const struct shader *fragment, struct diag *diag);
/* What the proof takes for granted, in one sentence. */
extern const char prove_assumptions[];
/* Text to a module, by glslang alone. lines: with OpLine, which makes no valid module of all that follows. least:
 * the version that it has at least, as the header of a module says it. */
struct spirv;
bool spirv_read_text(const struct pass *pass, const struct shader *shader, const struct text *text,
                     bool lines, uint32_t least, struct spirv *module, char **log);
