/* NAME_gl_shaders.c and NAME_vk_shaders.c: a backend's shaders as SPIR-V words, for OpenGL also as
 * GLSL. Not in the panel's file, because most edits change only a shader. Called by main.c. */
#include "emit_c.h"

#include <string.h>

/* Without printf, which is too slow for tens of thousands of words. */
static void emit_words(struct text *out, const uint32_t *words, size_t count)
{
    static const char digits[] = "0123456789abcdef";

    for (size_t i = 0; i < count; i++) {
        char word[] = "\\x00000000";

        for (int digit = 0; digit < 8; digit++)
            word[2 + digit] = digits[words[i] >> (28 - 4 * digit) & 15];
        if (i % 8 == 0)
            text_add(out, "    DT_WORDS(\"");
        text_add_bytes(out, word, sizeof word - 1);
        if (i + 1 == count)
            text_add(out, "\");\n");
        else if (i % 8 == 7)
            text_add(out, "\")\n");
    }
}

static void emit_text(const struct c_output *c, const char *at)
{
    while (*at) {
        size_t length = strcspn(at, "\n");
        bool ended = at[length] == '\n';
        char *line = arena_strndup(c->model->arena, at, length + ended);

        text_add(c->out, "    ");
        c_string(c->out, line);
        at += length + ended;
        text_add(c->out, *at ? "\n" : ";\n");
    }
}

static const char *const stage_names[] = {"compute", "vertex", "fragment"};

static const struct dt_code *code_of(const struct dt_stages *stages, int stage)
{
    const struct dt_code *const codes[] = {&stages->compute, &stages->vertex, &stages->fragment};
    return codes[stage];
}

/* The first pass whose words for the stage equal those of `pass`; `pass` if none does. */
static uint32_t owner_of(const struct dt_shaders *shaders, uint32_t pass, int stage)
{
    const struct dt_code *code = code_of(&shaders->stages[pass], stage);
    uint32_t owner = 0;
    for (; owner < pass; owner++) {
        const struct dt_code *other = code_of(&shaders->stages[owner], stage);
        if (other->size == code->size && !memcmp(other->words, code->words, code->size))
            break;
    }
    return owner;
}

static void emit_symbol(const struct c_output *c, uint32_t pass, int stage, const char *what)
{
    text_add_word(c->out, c->pipeline->order[pass]->name);
    text_add(c->out, "_%s%s", stage_names[stage], what);
}

static void emit_code(const struct c_output *c, const struct dt_shaders *shaders, uint32_t pass,
                      int stage)
{
    const struct dt_code *code = code_of(&shaders->stages[pass], stage);
    if (code->size && owner_of(shaders, pass, stage) == pass) {
        text_add(c->out, "static const uint32_t ");
        emit_symbol(c, pass, stage, "_words");
        text_add(c->out, "[%zu] =\n", code->size / sizeof *code->words);
        emit_words(c->out, code->words, code->size / sizeof *code->words);
    }
    if (code->glsl) {
        text_add(c->out, "static const char ");
        emit_symbol(c, pass, stage, "_glsl[] =\n");
        emit_text(c, code->glsl);
    }
}

static bool emit_entry(const struct c_output *c, const struct dt_shaders *shaders, uint32_t pass,
                       int stage, bool any)
{
    const struct dt_code *code = code_of(&shaders->stages[pass], stage);
    if (!code->size)
        return false;
    text_add(c->out, "%s.%s = {", any ? ",\n        " : "", stage_names[stage]);
    emit_symbol(c, owner_of(shaders, pass, stage), stage, "_words");
    text_add(c->out, ", %zu", code->size);
    if (code->glsl) {
        text_add(c->out, ", ");
        emit_symbol(c, pass, stage, "_glsl");
    }
    text_add(c->out, "}");
    return true;
}

void emit_c_shaders(const struct lowered *tables, enum backend backend, struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    const struct dt_shaders *shaders = &tables->shaders[backend];
    struct c_output c = {tables->model, pipeline, tables, out};
    c_head(&c, backend == BACKEND_GL ? ": the shaders for OpenGL." : ": the shaders for Vulkan.");
    text_add(out, "#include \"%s.h\"\n\n", pipeline->name);
    for (uint32_t pass = 0; pass < pipeline->pass_count; pass++)
        for (int stage = 0; stage < 3; stage++)
            emit_code(&c, shaders, pass, stage);
    text_add(out, pipeline->pass_count ? "static const struct dt_stages stages[] = {\n" : "");
    for (uint32_t pass = 0; pass < pipeline->pass_count; pass++) {
        text_add(out, "    [");
        c_pass(&c, pass);
        text_add(out, "] = {");
        bool any = false;
        for (int stage = 0; stage < 3; stage++)
            any |= emit_entry(&c, shaders, pass, stage, any);
        text_add(out, "},\n");
    }
    text_add(out, pipeline->pass_count ? "};\n\n" : "");
    text_add(out, "const struct dt_shaders %s_%s = {\"%s\", &%s_panel, %s};\n", pipeline->name,
             shaders->backend, shaders->backend, pipeline->name,
             pipeline->pass_count ? "stages" : "NULL");
}
