/* What the emitters of C share: names, literals, expressions, scaffolds. emit_c.c defines it,
 * emit_header.c, emit_gl.c and emit_vk.c use it. Emitters read the model and never change it. */
#ifndef DIPTYCH_GEN_EMIT_C_H
#define DIPTYCH_GEN_EMIT_C_H

#include "expr.h"
#include "plan.h"
#include "stages.h"

/* ---- Scaffolds: templates/c/panel_*.c.in, carried by the generator itself (scaffold.c) ------- */

extern const char scaffold_panel_gl[], scaffold_panel_vk[];

struct c_output {
    const struct model *model;
    const struct pipeline *pipeline;
    const struct pass_shaders *shaders;
    enum backend backend;
    struct text *out;
};
struct c_slot { /* `@{name}` in a scaffold; alone on its line, emit writes whole lines or none */
    const char *name;
    void (*emit)(const struct c_output *c);
};
void c_scaffold(const struct c_output *c, const char *scaffold, const struct c_slot *slots,
                size_t slot_count);
/* Slots that every scaffold has: name, NAME, spec, doc, shaders. */
void c_slot_name(const struct c_output *c);
void c_slot_spec(const struct c_output *c);
void c_slot_doc(const struct c_output *c);
void c_slot_shaders(const struct c_output *c);   /* declares what emit_shaders.c defines */
void c_slot_resources(const struct c_output *c); /* lines of the table from index to object */
void c_slot_create(const struct c_output *c); /* calls of create_NAME for samplers and programs */
void c_slot_record(const struct c_output *c); /* calls of record_NAME */
/* A struct dt_code, as emit_shaders.c defines it; and the members of a program's info that name a
 * pass's. */
void c_code_name(const struct c_output *c, const struct pass *pass, int stage);
void c_stages(const struct c_output *c, const struct pass *pass);
bool c_pass_uses_live(
    const struct pass *pass); /* the pass's record function takes the live block */

/* ---- Pieces of C ----------------------------------------------------------------------------- */

void c_upper(struct text *out, const char *name);
void c_enumerator(const struct c_output *c, const char *group,
                  const char *name);                /* SSVP_PASS_GBUFFER */
void c_string(struct text *out, const char *text);  /* with quotes; NULL: "" */
void c_comment(struct text *out, const char *text); /* on one line, cannot end a comment */
void c_double(struct text *out, double value);      /* a double constant expression */
void c_float(struct text *out, double value);       /* a float constant */
void c_clear(struct text *out, const struct resource *resource); /* {0.0f, ...} of four */
/* An int64_t expression: a literal when it is baked. */
void c_expr(struct text *out, const struct expr *expr, int64_t otherwise);
/* Declares `width` and `height` from `from_width`, `from_height` where the text of a function body
 * names them. */
void c_size_locals(struct text *out, const char *body, const char *from_width,
                   const char *from_height);
/* The call that does a pass's work. */
void c_work(const struct c_output *c, const struct pass *pass);
/* The calls that clear what a skipped pass would have written, with `between` between them; writes
 * nothing when there is nothing to clear. */
void c_skip(const struct c_output *c, const struct pass *pass, const char *between);
/* A pass's record function. `locals` declares what `body` works with; the targets, the size of the
 * frame and whether the pass runs are declared here, where the pass has them. */
void c_pass(const struct c_output *c, const struct pass *pass, const struct text *locals,
            const struct text *body);
/* `state->buffers.vpls` or `builtin->vertices`: what an access is bound to. */
void c_object(struct text *out, const struct access *access);
const char *c_group(const struct resource *resource); /* "buffers" or "images" */
const char *c_kind(const struct resource *resource);  /* "buffer" or "image" */
/* Members of a panel's state: structs `buffers` and `images`, `samplers` of the given C type,
 * `programs`. */
void c_resource_members(const struct c_output *c);
void c_sampler_members(const struct c_output *c, const char *type);
void c_program_members(const struct c_output *c);
/* The head of a resource's create function up to its extent, and the calls of them all. No other
 * function can have these names: what is created stands before whose it is. */
void c_create_head(const struct c_output *c, const struct resource *resource);
void c_create_resources(const struct c_output *c);
void c_element(const struct c_output *c, struct text *out,
               const struct resource *buffer); /* its size in bytes */
bool pass_draws(const struct pass *pass);
bool pass_clears_targets(const struct pass *pass); /* any target without load */
bool pass_has_depth(const struct pass *pass);
void c_targets(const struct c_output *c); /* the functions targets_NAME of all draws */
bool has_fetch(const struct pipeline *pipeline);
bool access_is_image(const struct access *access);

/* emit_needs.c, for NAME_vk.c: the features that passes need of a device, and where the panel tells. */
void c_slot_needs(const struct c_output *c);
void c_slot_panel_needs(const struct c_output *c);

/* emit_work.c, for NAME.c: the functions runs_NAME, and the members of a dt_pass that tell its
 * work. */
void emit_runs_functions(const struct c_output *c);
void emit_work(const struct c_output *c, const struct pass *pass);

#endif
