/* What the generator prints, besides GLSL: C, graphs, tables for people and editors. */
#pragma once

#include "lower/lower.h"

void emit_header(const struct model *model, struct text *out);     /* NAME.h */
void emit_c_panel(const struct lowered *tables, struct text *out); /* NAME.c, for all backends */
/* NAME_gl_shaders.c and NAME_vk_shaders.c. names: keep them in SPIR-V. glsl: also OpenGL's GLSL.
 * Returns the bytes of packed words that are for GPUs alone. */
size_t emit_c_shaders(const struct lowered *tables, enum backend backend, bool names, bool glsl,
                      struct text *out);
/* Whether both print the same C: then the second is not needed. */
bool emit_is_same(const struct lowered *tables, const struct lowered *gpu);
/* emit_plan.c: a drawing for Graphviz, `graph` or `lifetimes`. False: reported. */
bool emit_drawing(const struct model *model, const char *drawing, struct text *out);
/* needs.c: --needs, Markdown. */
void emit_device_needs(const struct lowered *tables, struct text *out);
void emit_schema(struct text *out); /* schema.c */
/* reference.c: Markdown, in language.md of the templates. False: logged. */
bool emit_reference(const char *templates, struct text *out, const struct dt_log *log);
