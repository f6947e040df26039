/* A whole shader until it is as a body: its module, of glslang or of others, with what the pass and the other stage say
 * of it. */
#pragma once

#include "glsl/shader.h"
#include "model/module.h"

/* The stage's module: its entry point is main, specialization constants have the values of baked parameters, and variables
 * between stages have locations. lines: with OpLine. False: *log as of spirv_compile. */
bool whole_read(const struct model *model, const struct pass *pass, const struct shader *shader,
                bool lines, struct spirv *module, char **log);
/* Specialization constants get the values of baked parameters, else their defaults, and are constants then. False: *log says why, NULL: out of memory. */
bool whole_specialize(const struct pipeline *pipeline, struct spirv *module, char **log);
/* `more`, the generator's module, joins it; resources and uniforms are the plan's. */
bool whole_bind(const struct pass *pass, const struct shader *shader, const struct spirv *more,
                struct spirv *module, char **log);
