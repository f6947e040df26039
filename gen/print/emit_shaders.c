/* NAME_gl_shaders.c and NAME_vk_shaders.c: a backend's shaders as packed SPIR-V, for OpenGL also
 * as GLSL if asked for. Not in the panel's file, because most edits change only a shader. */
#include "emit_c.h"
#include "spirv/passes.h"

#include <string.h>

/* The words of a stage, as they are emitted. */
struct code {
    uint32_t *words;
    size_t count;
    const char *glsl; /* NULL: without */
};

struct shaders_output {
    struct c_output c;
    struct code (*codes)[3]; /* by pass and stage */
};

/* A list of bytes, some to a line. Without printf, which is too slow for so many. */
struct byte_list {
    struct text *out;
    char line[128];
    size_t length, bytes; /* of the line */
};

static void end_line(struct byte_list *list)
{
    text_add_bytes(list->out, list->line, list->length);
    list->length = list->bytes = 0;
}

static void add_byte(struct byte_list *list, unsigned byte)
{
    enum { BYTES = 20 };
    static const char indent[] = {'\n', ' ', ' ', ' ', ' '};
    char *at = list->line + list->length;
    if (!list->bytes++) {
        memcpy(at, indent, sizeof indent);
        at += sizeof indent;
    }
    if (byte >= 100)
        *at++ = (char)('0' + byte / 100);
    if (byte >= 10)
        *at++ = (char)('0' + byte / 10 % 10);
    *at++ = (char)('0' + byte % 10);
    *at++ = ',';
    list->length = (size_t)(at - list->line);
    if (list->bytes == BYTES)
        end_line(list);
}

/* LEB128, see struct dt_code. A list of numbers, since MSVC limits strings to 64 KiB. */
static void emit_packed(struct text *out, const struct code *code)
{
    struct byte_list list = {.out = out};
    for (size_t i = 0; i < code->count; i++)
        for (uint32_t rest = code->words[i], more = 1; more; rest >>= 7) {
            more = rest > 0x7f;
            add_byte(&list, (rest & 0x7f) | (more ? 0x80 : 0));
        }
    end_line(&list);
    text_add(out, "};\n");
}

static void emit_text(struct text *out, const char *glsl)
{
    struct byte_list list = {.out = out};
    for (size_t i = 0; glsl[i]; i++)
        add_byte(&list, (unsigned char)glsl[i]);
    end_line(&list);
    text_add(out, "0};\n");
}

static const char *const stage_names[] = {"compute", "vertex", "fragment"};

/* The first pass whose words for the stage equal those of `pass`; `pass` if none does. */
static uint32_t owner_of(const struct shaders_output *o, uint32_t pass, int stage)
{
    const struct code *code = &o->codes[pass][stage];
    uint32_t owner = 0;
    for (; owner < pass; owner++) {
        const struct code *other = &o->codes[owner][stage];
        if (other->count == code->count &&
            !memcmp(other->words, code->words, code->count * sizeof *code->words))
            break;
    }
    return owner;
}

static void emit_symbol(const struct c_output *c, uint32_t pass, int stage, const char *what)
{
    text_add_word(c->out, c->pipeline->order[pass]->name);
    text_add(c->out, "_%s%s", stage_names[stage], what);
}

static void emit_code(const struct shaders_output *o, uint32_t pass, int stage)
{
    const struct c_output *c = &o->c;
    const struct code *code = &o->codes[pass][stage];
    if (code->count && owner_of(o, pass, stage) == pass) {
        text_add(c->out, "static const uint8_t ");
        emit_symbol(c, pass, stage, "_packed[] = {");
        emit_packed(c->out, code);
    }
    if (code->glsl) {
        text_add(c->out, "static const uint8_t ");
        emit_symbol(c, pass, stage, "_glsl[] = {");
        emit_text(c->out, code->glsl);
    }
}

static bool emit_entry(const struct shaders_output *o, uint32_t pass, int stage, bool any)
{
    const struct c_output *c = &o->c;
    const struct code *code = &o->codes[pass][stage];
    if (!code->count)
        return false;
    text_add(c->out, "%s.%s = {NULL, %zu, ", any ? ",\n        " : "", stage_names[stage],
             code->count * sizeof *code->words);
    emit_symbol(c, owner_of(o, pass, stage), stage, "_packed, ");
    text_add(c->out, code->glsl ? "(const char *)" : "NULL}");
    if (code->glsl)
        emit_symbol(c, pass, stage, "_glsl}");
    return true;
}

/* False when out of memory. */
static bool take_codes(struct shaders_output *o, const struct dt_shaders *shaders, bool names,
                       bool glsl)
{
    struct arena *arena = o->c.model->arena;
    uint32_t passes = o->c.pipeline->pass_count;
    o->codes = arena_alloc(arena, (passes + 1) * sizeof *o->codes);
    for (uint32_t pass = 0; o->codes && pass < passes; pass++) {
        const struct dt_stages *stages = &shaders->stages[pass];
        const struct dt_code *from[] = {&stages->compute, &stages->vertex, &stages->fragment};
        for (int stage = 0; stage < 3; stage++) {
            struct code *code = &o->codes[pass][stage];
            *code = (struct code){.words = arena_alloc(arena, from[stage]->size + 1),
                                  .count = from[stage]->size / sizeof *code->words,
                                  .glsl = glsl ? from[stage]->glsl : NULL};
            if (!code->words)
                return false;
            if (code->count)
                memcpy(code->words, from[stage]->words, from[stage]->size);
            if (!names)
                code->count = spirv_strip(code->words, code->count);
        }
    }
    return o->codes;
}

void emit_c_shaders(const struct lowered *tables, enum backend backend, bool names, bool glsl,
                    struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    const struct dt_shaders *shaders = &tables->shaders[backend];
    struct shaders_output o = {{tables->model, pipeline, tables, out}, NULL};
    if (!take_codes(&o, shaders, names, glsl)) {
        out->failed = true;
        return;
    }
    c_head(&o.c, backend == BACKEND_GL ? ": the shaders for OpenGL." : ": the shaders for Vulkan.");
    text_add(out, "#include \"%s.h\"\n\n", pipeline->name);
    for (uint32_t pass = 0; pass < pipeline->pass_count; pass++)
        for (int stage = 0; stage < 3; stage++)
            emit_code(&o, pass, stage);
    text_add(out, pipeline->pass_count ? "static const struct dt_stages stages[] = {\n" : "");
    for (uint32_t pass = 0; pass < pipeline->pass_count; pass++) {
        text_add(out, "    [");
        c_pass(&o.c, pass);
        text_add(out, "] = {");
        bool any = false;
        for (int stage = 0; stage < 3; stage++)
            any |= emit_entry(&o, pass, stage, any);
        text_add(out, "},\n");
    }
    text_add(out, pipeline->pass_count ? "};\n\n" : "");
    text_add(out, "const struct dt_shaders %s_%s = {\"%s\", &%s_panel, %s};\n", pipeline->name,
             shaders->backend, shaders->backend, pipeline->name,
             pipeline->pass_count ? "stages" : "NULL");
}
