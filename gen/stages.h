/* The stages of diptych-gen in their order; load.c and main.c call them. Each stage reports through
 * diag and returns false when the next one must not run. */
#ifndef DIPTYCH_GEN_STAGES_H
#define DIPTYCH_GEN_STAGES_H

#include "diag.h"
#include "base/text.h"

/* read.c: YAML -> model. sets: "PATH=VALUE" strings that override values of the document. */
bool read_spec(struct model *model, const char *path, const char *const *sets, size_t set_count,
               struct diag *diag);
/* check.c: resolves names and expressions, checks everything that needs no plan. templates_dir:
 * folder for shader bodies that are not in the spec's own folder. */
bool check_model(struct model *model, const char *templates_dir, struct diag *diag);
/* layout.c: std430 offsets of structs, std140 offsets of the live block. */
void layout_model(struct model *model);
/* plan.c: order (reports cycles, read before write, two writers without order), access kinds,
 * bindings, barriers, lifetimes, slots, ranges. */
bool plan_model(struct model *model, struct diag *diag);

enum backend { BACKEND_GL, BACKEND_VK };
enum stage { STAGE_IS_COMPUTE, STAGE_IS_VERTEX, STAGE_IS_FRAGMENT };

struct shader { /* one compiled stage of one pass for one backend */
    enum stage stage;
    struct text glsl; /* complete, readable source; OpenGL's with model->text alone */
    bool own;         /* does something else than the other backend's, not only by other names */
    struct text code; /* OpenGL's if `own`: for glslang, so in Vulkan's GLSL */
    const struct body_files *files; /* that the text may include; NULL: none */
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
/* spirv/compile.c: GLSL -> SPIR-V (glslang), the passes of gen/spirv, then
 * spirv-val (SPIRV-Tools). *log: the messages of glslang, for glsl_adapt and glsl_report; free();
 * log, and diag for other errors, may be NULL. After spirv_init has returned true, spirv_compile may
 * run on several threads, also beside emit_glsl. */
bool spirv_init(void);
const char *spirv_tools(void); /* names and versions of the compiler and its tools */
bool spirv_compile(const struct model *model, const struct pass *pass, enum backend backend,
                   struct shader *shader, char **log, struct diag *diag);
/* Makes the words of a compiled shader OpenGL's. */
bool spirv_make_opengl(const struct pass *pass, struct shader *shader);
/* The same file: reports each open operation of a compiled shader (prove.h) at its place in the
 * body. Without model->prove, only those that are wrong. */
void spirv_prove(const struct model *model, const struct pass *pass, const struct shader *shader,
                 struct diag *diag);

/* prove_fixed.c: reports what the fixed functions of a draw leave open in its targets of the contract
 * `exact`: blending, coverage, depth, the encoding of colours. `fragment`: its shader, if any. */
void prove_fixed(const struct pass *pass, const struct shader *fragment, struct diag *diag);
/* What the proof takes for granted, in one sentence. */
extern const char prove_assumptions[];

/* glsl_messages.c: takes in from the messages of a failed shader what emit_glsl can do better: see
 * struct shader. False: nothing new. */
bool glsl_adapt(struct model *model, const struct pass *pass, struct shader *shader,
                const char *log);
/* The same file: reports the messages. */
void glsl_report(struct model *model, const struct pass *pass, const char *log, struct diag *diag);

/* Shaders of one pass, by enum stage; word_count 0: none. Used as [backend][pass], passes in order
 * of execution. */
struct pass_shaders {
    struct shader stage[3];
};
/* unused.c: warns about names that passes list and their shaders, Vulkan's, do not use. */
void check_listed(const struct model *model, const struct pass_shaders *shaders, struct diag *diag);
struct shader_cache;
/* shaders.c: every stage of every pass for both backends, with emit_glsl and spirv_compile. `cache`
 * may be NULL. Call shaders_free also after a failure. */
bool shaders_compile(struct model *model, struct pass_shaders *shaders[2],
                     struct shader_cache *cache, struct diag *diag);
void shaders_free(const struct model *model, struct pass_shaders *shaders[2]);
void emit_header(const struct model *model, struct text *out); /* NAME.h */
/* lower.h: the planned model as tables. */
struct lowered;
void emit_c_panel(const struct lowered *tables, struct text *out); /* NAME.c, for all backends */
/* NAME_gl_shaders.c and NAME_vk_shaders.c. */
/* names: keep them in SPIR-V. glsl: also OpenGL's GLSL. */
void emit_c_shaders(const struct lowered *tables, enum backend backend, bool names, bool glsl,
                    struct text *out);
void emit_graph(const struct model *model, struct text *out);     /* NAME.dot */
void emit_lifetimes(const struct model *model, struct text *out); /* NAME_lifetimes.dot */
/* needs.c: --needs, Markdown. */
void emit_device_needs(const struct lowered *tables, struct text *out);
void emit_schema(struct text *out);         /* schema.c */
void emit_reference(struct text *out);      /* reference.c: Markdown */
void emit_body_reference(struct text *out); /* reference_body.c: its chapter on pass bodies */

/* vary.c: `count` valid variations of a spec, as JSON; the same for the same seed on every machine.
 * False when the spec itself is wrong (reported) or a variation cannot be found. */
struct vary_request {
    const char *spec, *templates_dir;
    const char *const *sets; /* apply to every variation; values that they set are not drawn */
    size_t set_count;
    uint32_t count;
    uint64_t seed;
    uint64_t bytes;      /* most that the resources of a variation may take together */
    const char *cache;   /* folder of compiled shaders; NULL: none */
    struct arena *arena; /* of the files that messages point into; of the caller */
};
bool vary(const struct vary_request *request, struct text *out, struct diag *diag);

/* output.c: writes a set of files; an error before the renames changes no file. */
struct output;
struct output *output_create(void);
void output_add(struct output *output, const char *dir, const char *name,
                struct text *text); /* takes the text */
/* Writes temporary files, then renames them; unchanged files keep their time stamp. Reports. */
bool output_commit(struct output *output);
void output_free(struct output *output);
/* write(2) until all is written; false: errno. */
bool write_all(int descriptor, const void *bytes, size_t length);

#endif
