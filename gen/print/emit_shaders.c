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

/* A row is a pass; those for GPUs follow the others. */
struct shaders_output {
    struct c_output c;
    struct code (*codes)[3]; /* by row and stage */
    uint32_t rows;
    size_t gpu_bytes; /* of packed words that only rows for GPUs have */
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

/* LEB128, see struct dt_code. A list of numbers, since MSVC limits strings to 64 KiB. Returns the
 * bytes. */
static size_t emit_packed(struct text *out, const struct code *code)
{
    struct byte_list list = {.out = out};
    size_t bytes = 0;
    for (size_t i = 0; i < code->count; i++)
        for (uint32_t rest = code->words[i], more = 1; more; rest >>= 7, bytes++) {
            more = rest > 0x7f;
            add_byte(&list, (rest & 0x7f) | (more ? 0x80 : 0));
        }
    end_line(&list);
    text_add(out, "};\n");
    return bytes;
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

static uint32_t pass_of(const struct shaders_output *o, uint32_t row)
{
    uint32_t passes = o->c.pipeline->pass_count;
    return row < passes ? row : row - passes;
}

/* The first row whose words for the stage equal those of `row`; `row` if none does. */
static uint32_t owner_of(const struct shaders_output *o, uint32_t row, int stage)
{
    const struct code *code = &o->codes[row][stage];
    uint32_t owner = 0;
    for (; owner < row; owner++) {
        const struct code *other = &o->codes[owner][stage];
        if (other->count == code->count &&
            !memcmp(other->words, code->words, code->count * sizeof *code->words))
            break;
    }
    return owner;
}

static void emit_symbol(const struct shaders_output *o, uint32_t row, int stage, const char *what)
{
    c_add(&o->c, "@w_@s@s@s", o->c.pipeline->order[pass_of(o, row)]->name, stage_names[stage],
          row < o->c.pipeline->pass_count ? "" : C_GPU, what);
}

static void emit_code(struct shaders_output *o, uint32_t row, int stage)
{
    const struct code *code = &o->codes[row][stage];
    bool gpu = row >= o->c.pipeline->pass_count;
    if (code->count && owner_of(o, row, stage) == row) {
        text_add(o->c.out, "static const uint8_t ");
        emit_symbol(o, row, stage, "_packed[] = {");
        size_t bytes = emit_packed(o->c.out, code);
        o->gpu_bytes += gpu ? bytes : 0;
    }
    if (code->glsl) {
        text_add(o->c.out, "static const uint8_t ");
        emit_symbol(o, row, stage, "_glsl[] = {");
        emit_text(o->c.out, code->glsl);
    }
}

static bool emit_entry(const struct shaders_output *o, uint32_t row, int stage, bool any)
{
    struct text *out = o->c.out;
    const struct code *code = &o->codes[row][stage];
    if (!code->count)
        return false;
    text_add(out, "%s.%s = {NULL, %zu, ", any ? ",\n        " : "", stage_names[stage],
             code->count * sizeof *code->words);
    emit_symbol(o, owner_of(o, row, stage), stage, "_packed, ");
    text_add(out, code->glsl ? "(const char *)" : "NULL}");
    if (code->glsl)
        emit_symbol(o, row, stage, "_glsl}");
    return true;
}

/* False when out of memory. */
static bool take_code(struct arena *arena, struct code *code, const struct dt_code *from,
                      bool names, bool glsl)
{
    *code = (struct code){.words = arena_alloc(arena, from->size + 1),
                          .count = from->size / sizeof *code->words,
                          .glsl = glsl ? from->glsl : NULL};
    if (!code->words)
        return false;
    if (code->count)
        memcpy(code->words, from->words, from->size);
    if (!names)
        code->count = spirv_strip(code->words, code->count);
    return true;
}

/* The same. */
static bool take_codes(struct shaders_output *o, enum backend backend, bool names, bool glsl)
{
    struct arena *arena = o->c.model->arena;
    uint32_t passes = o->c.pipeline->pass_count;
    o->codes = arena_alloc(arena, (o->rows + 1) * sizeof *o->codes);
    bool good = o->codes;
    for (uint32_t row = 0; good && row < o->rows; row++) {
        const struct lowered *tables = row < passes ? o->c.tables : o->c.tables->gpu;
        const struct dt_stages *stages = &tables->shaders[backend].stages[pass_of(o, row)];
        const struct dt_code *from[] = {&stages->compute, &stages->vertex, &stages->fragment};
        for (int stage = 0; good && stage < 3; stage++)
            good = take_code(arena, &o->codes[row][stage], from[stage], names, glsl);
    }
    return good;
}

static void emit_stages(const struct shaders_output *o)
{
    uint32_t passes = o->c.pipeline->pass_count;
    text_add(o->c.out, passes ? "static const struct dt_stages stages[] = {\n" : "");
    for (uint32_t row = 0; row < o->rows; row++) {
        c_add(&o->c, row < passes ? "    [@P] = {" : "    [@N_PASSES + @P] = {", pass_of(o, row));
        bool any = false;
        for (int stage = 0; stage < 3; stage++)
            any |= emit_entry(o, row, stage, any);
        text_add(o->c.out, "},\n");
    }
    text_add(o->c.out, passes ? "};\n\n" : "");
}

size_t emit_c_shaders(const struct lowered *tables, enum backend backend, bool names, bool glsl,
                      struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    const char *api = tables->shaders[backend].backend;
    struct shaders_output o = {.c = {tables->model, pipeline, tables, out, NULL},
                               .rows = pipeline->pass_count * (tables->gpu ? 2 : 1)};
    if (!take_codes(&o, backend, names, glsl)) {
        out->failed = true;
        return 0;
    }
    c_head(&o.c, backend == BACKEND_GL ? ": the shaders for OpenGL." : ": the shaders for Vulkan.");
    c_add(&o.c, "#include \"@n.h\"\n\n");
    for (uint32_t row = 0; row < o.rows; row++)
        for (int stage = 0; stage < 3; stage++)
            emit_code(&o, row, stage);
    emit_stages(&o);
    c_add(&o.c, "const struct dt_shaders @n_@s = {\"@s\", &@n_panel, @s};\n", api, api,
          pipeline->pass_count ? "stages" : "NULL");
    return o.gpu_bytes;
}

static bool same_code(const struct dt_code *a, const struct dt_code *b)
{
    return a->size == b->size && (!a->size || memcmp(a->words, b->words, a->size) == 0);
}

bool emit_is_same(const struct lowered *tables, const struct lowered *gpu)
{
    struct text texts[2] = {{0}, {0}};
    bool same = true;
    for (enum backend backend = BACKEND_GL; backend <= BACKEND_VK; backend++)
        for (uint32_t i = 0; i < tables->model->pipeline.pass_count; i++) {
            const struct dt_stages *a = &tables->shaders[backend].stages[i];
            const struct dt_stages *b = &gpu->shaders[backend].stages[i];
            same = same && same_code(&a->compute, &b->compute) &&
                   same_code(&a->vertex, &b->vertex) && same_code(&a->fragment, &b->fragment);
        }
    if (same) {
        emit_c_panel(tables, &texts[0]);
        emit_c_panel(gpu, &texts[1]);
        same = !texts[0].failed && !texts[1].failed && texts[0].length == texts[1].length &&
               memcmp(texts[0].data, texts[1].data, texts[0].length) == 0;
    }
    text_free(&texts[0]);
    text_free(&texts[1]);
    return same;
}
