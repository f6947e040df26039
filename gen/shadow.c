/* Shadow memory of --sanitize=content,race,flow; see templates/glsl/shadow.glsl and cells.glsl. Two kinds of internal buffers:
 *
 * - The shadow: a word for each texel, and for each word of a buffer, with the frame that wrote it last. So nothing is reset:
 *   what an earlier frame wrote is old. Each resource has words of its own, also those that share memory: the plan stays as
 *   it is, and what the former owner of memory left never counts as written.
 * - The cells: what is known of one dispatch. A pass clears those of the next pass before its own work, which needs other
 *   ones: passes take turns with two, and where the last pass meets the first one, with three. */
#include <stdio.h>
#include <string.h>

#include "glsl.h"
#include "plan.h"
#include "sanitize.h"

static const char shadow_name[] = "diptych_shadow";
static const char *const cell_names[] = {"diptych_cells_0", "diptych_cells_1", "diptych_cells_2"};

/* As cells.glsl has them. */
enum { BARRIER_WORDS = 65536, CELL_WORDS = 6, SHARED_CELLS = 1 << 18 };

/* ---- The plan -------------------------------------------------------------------------------- */

static uint32_t bank_of(const struct pipeline *pipeline, uint32_t pass)
{
    bool last = pipeline->pass_count > 1 && pass + 1 == pipeline->pass_count;
    return last && pipeline->pass_count % 2 ? 2 : pass % 2;
}

static struct resource *add_buffer(struct pipeline *pipeline, const char *name)
{
    struct resource *buffer = pipeline->resources + pipeline->resource_count;
    *buffer = (struct resource){.name = name,
                                .loc = pipeline->loc,
                                .kind = DT_BUFFER,
                                .history = true,
                                .keep = true,
                                .internal = true,
                                .share = -1,
                                .of = "uint",
                                .type = DT_TYPE_UINT,
                                .stride = sizeof(uint32_t),
                                .index = pipeline->resource_count++};
    return buffer;
}

static bool has_cells(const struct pass *pass)
{
    return pass->kind == DT_PASS_DISPATCH;
}

void shadow_plan(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    struct resource *banks[DT_ARRAY_COUNT(cell_names)];
    if (!(model->sanitize & SANITIZE_SHADOW))
        return;
    struct resource *shadow = add_buffer(pipeline, shadow_name);
    for (size_t i = 0; i < DT_ARRAY_COUNT(cell_names); i++)
        banks[i] = add_buffer(pipeline, cell_names[i]);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        struct pass *pass = pipeline->order[i];
        uint32_t next = (i + 1) % pipeline->pass_count;
        sanitize_access(pass, shadow);
        if (has_cells(pass))
            sanitize_access(pass, banks[bank_of(pipeline, i)]);
        if (has_cells(pipeline->order[next]) && bank_of(pipeline, next) != bank_of(pipeline, i)) {
            struct access *clear = sanitize_access(pass, banks[bank_of(pipeline, next)]);
            clear->mode = MODE_WRITE;
            clear->clears = true;
        }
    }
}

/* ---- Sizes ----------------------------------------------------------------------------------- */

/* A sum of products; for GLSL also the text of those that depend on the frame or on parameters. */
struct sum {
    uint32_t width, height; /* of the frame */
    uint64_t value, literal;
    struct text text;
};

/* Factors: expressions, at least 1 each; NULL: `otherwise`, which is a side of the frame if `frame`. */
struct factor {
    const struct expr *expr;
    char frame; /* 'w', 'h': a side of the frame for NULL; 0: 1 */
};

static void add_product(struct sum *sum, uint64_t times, const struct factor *factors, int count)
{
    uint64_t value = times;
    struct text text = {0};
    for (int i = 0; i < count; i++) {
        const struct expr *expr = factors[i].expr;
        uint32_t side = factors[i].frame == 'w' ? sum->width : factors[i].frame ? sum->height : 1;
        uint32_t own = expr_value(expr, sum->width, sum->height, side);
        own = own ? own : 1;
        value *= own;
        if (expr ? expr_is_literal(expr) : !factors[i].frame) {
            times *= own;
        } else if (expr) {
            text_add(&text, " * uint(max(");
            expr_emit_glsl(expr, &text);
            text_add(&text, ", 1))");
        } else {
            text_add(&text, " * frame.%s", factors[i].frame == 'w' ? "width" : "height");
        }
    }
    sum->value += value;
    if (text.length)
        text_add(&sum->text, " + %lluu%s", (unsigned long long)times, text.data);
    else
        sum->literal += times;
    sum->text.failed |= text.failed;
    text_free(&text);
}

/* A texel, or a word of a buffer, has one. Mips of an image take at most as many as its first, and one for each layer of the
 * smallest. */
static void add_words(struct sum *sum, const struct resource *resource)
{
    const struct factor sides[] = {
        {resource->width, 'w'}, {resource->height, 'h'}, {resource->layers, 0}};
    if (resource->kind == DT_BUFFER) {
        add_product(sum, resource->stride / 4, &(struct factor){resource->count, 0}, 1);
        return;
    }
    uint32_t mips = mips_of(resource);
    add_product(sum, mips > 1 ? 2 : 1, sides, 3);
    if (mips > 1)
        add_product(sum, mips, sides + 2, 1);
}

/* Whether somebody else fills it, or it is the generator's. */
static bool is_foreign(const struct resource *resource)
{
    return !resource || resource->internal || resource->input;
}

static bool stores_to(const struct pass *pass, const struct resource *resource)
{
    bool stores = false;
    for (uint32_t i = 0; i < pass->access_count; i++)
        stores |= pass->accesses[i].resource == resource && !resource->internal &&
                  pass->accesses[i].kind & DT_WRITE_STORAGE;
    return stores && pass->kind == DT_PASS_DISPATCH;
}

/* Cells of all that the pass stores to, before this resource; NULL: of all. */
static void add_cells(struct sum *sum, const struct pipeline *pipeline, const struct pass *pass,
                      const struct resource *until)
{
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        if (&pipeline->resources[i] == until)
            return;
        else if (stores_to(pass, &pipeline->resources[i]))
            add_words(sum, &pipeline->resources[i]);
}

static void add_shadow(struct sum *sum, const struct pipeline *pipeline,
                       const struct resource *until)
{
    for (uint32_t i = 0; i < pipeline->resource_count && &pipeline->resources[i] != until; i++)
        if (!is_foreign(&pipeline->resources[i]))
            add_words(sum, &pipeline->resources[i]);
}

uint64_t shadow_words(const struct model *model, const struct resource *resource, uint32_t width,
                      uint32_t height)
{
    const struct pipeline *pipeline = &model->pipeline;
    struct sum sum = {.width = width, .height = height};
    uint64_t most = 0;
    if (!resource->internal || !(model->sanitize & SANITIZE_SHADOW) || resource->count)
        return 0;
    if (!strcmp(resource->name, shadow_name)) {
        add_shadow(&sum, pipeline, NULL);
        most = sum.value;
    } else {
        for (uint32_t i = 0; i < pipeline->pass_count; i++) {
            sum.value = 0;
            add_cells(&sum, pipeline, &pipeline->passes[i], NULL);
            most = sum.value > most ? sum.value : most;
        }
        most = BARRIER_WORDS + CELL_WORDS * (SHARED_CELLS + most);
    }
    text_free(&sum.text);
    return most + 1;
}

/* ---- GLSL ------------------------------------------------------------------------------------ */

static void put_sum(struct sum *sum, struct text *out)
{
    text_add(out, "%lluu%s", (unsigned long long)sum->literal,
             sum->text.data ? sum->text.data : "");
    out->failed |= sum->text.failed;
    text_free(&sum->text);
    *sum = (struct sum){0};
}

static void put_side(const struct expr *expr, const char *otherwise, struct text *out)
{
    if (!expr) {
        text_add(out, "%s", otherwise);
        return;
    }
    text_add(out, "max(");
    expr_emit_glsl(expr, out);
    text_add(out, ", 1)");
}

static void add_index(const struct access *access, struct text *out)
{
    const struct resource *resource = access->resource;
    if (resource->kind == DT_BUFFER) {
        struct sum words = {0};
        text_add(out, "uint diptych_at_%d(const uint word)\n{\n    return diptych_word_at(word, ",
                 access->binding);
        add_words(&words, resource);
        put_sum(&words, out);
        text_add(out, ");\n}\n\n");
        return;
    }
    bool all = access->kind & DT_READ_TEXTURE && !access_sees_one_mip(access);
    text_add(out,
             "uint diptych_at_%d(const ivec3 p, const int mip)\n{\n    return diptych_texel_at(p + "
             "ivec3(0, 0, %u), mip + %u, ivec3(",
             access->binding, access->layer ? access->layer_value : 0, all ? 0 : access->mip_value);
    put_side(resource->width, "int(frame.width)", out);
    text_add(out, ", ");
    put_side(resource->height, "int(frame.height)", out);
    text_add(out, ", ");
    put_side(resource->layers, "1", out);
    text_add(out, "), %s);\n}\n\n", resource->shape == DT_SHAPE_3D ? "true" : "false");
}

/* When a pass has written all that `reader` sees, though not by stores: draws clear their targets, and passes that do not run
 * all that they would write. Appends the condition; returns whether it always holds. */
static bool add_whole(const struct pass *pass, const struct access *reader, bool later,
                      struct text *out)
{
    bool always = false;
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
        bool target = access->kind & (DT_WRITE_COLOR | DT_WRITE_DEPTH);
        bool skipped = pass->conditional && access->mode == MODE_WRITE;
        bool other = access_sees_one_mip(reader) && access->mip_value != reader->mip_value;
        if (access->resource != reader->resource || other || (!target && !skipped))
            continue;
        always |= target && !later;
        text_add(out, " || ");
        if (later || target) {
            text_add(out, later ? "frame.index > 0u" : "true");
        } else {
            text_add(out, "(");
            expr_emit_glsl(pass->when, out);
            text_add(out, ") == 0");
        }
    }
    return always;
}

static void add_content(const struct glsl *glsl, const struct access *access, struct text *out)
{
    const struct resource *resource = access->resource;
    struct sum base = {0};
    struct text whole = {0};
    bool always = false;
    for (uint32_t i = 0; i < glsl->pipeline->pass_count; i++) {
        const struct pass *pass = glsl->pipeline->order[i];
        bool later = pass->index >= glsl->pass->index;
        if (!later || resource->history)
            always |= add_whole(pass, access, later, &whole);
    }
    add_shadow(&base, glsl->pipeline, resource);
    struct text words = {0};
    put_sum(&base, &words);
    if (!always)
        text_add(out,
                 "uint diptych_read_%d(const uint at, const uint number)\n{\n    return "
                 "diptych_unwritten(at, %s, false%s, %s, number);\n}\n\n",
                 access->binding, words.data, whole.data ? whole.data : "",
                 resource->history ? "true" : "false");
    if (access->mode != MODE_READ)
        text_add(out,
                 "void diptych_write_%d(const uint at)\n{\n    diptych_written(at, %s);\n}\n\n",
                 access->binding, words.data);
    out->failed |= words.failed || whole.failed;
    text_free(&words);
    text_free(&whole);
}

static void add_race(const struct glsl *glsl, const struct access *access, struct text *out)
{
    struct sum base = {0};
    text_add(out, "uint diptych_cell_%d(const uint at)\n{\n    return diptych_cell(at, ",
             access->binding);
    add_cells(&base, glsl->pipeline, glsl->pass, access->resource);
    put_sum(&base, out);
    text_add(out, ");\n}\n\n");
}

static void add_finish(const struct glsl *glsl, bool cells, struct text *out)
{
    unsigned kinds = glsl->model->sanitize;
    text_add(out, "void diptych_finish(const uint key)\n{\n%s%s%s}\n\n",
             kinds & SANITIZE_CONTENT ? "    diptych_finish_content(key);\n" : "",
             cells && kinds & SANITIZE_RACE ? "    diptych_finish_race();\n" : "",
             cells && kinds & SANITIZE_FLOW ? "    diptych_finish_flow();\n" : "");
}

static bool add_libraries(struct glsl *glsl, bool cells)
{
    const struct pipeline *pipeline = glsl->pipeline;
    const char *const shadow[] = {"@shadow@", sanitize_layout(glsl, shadow_name), NULL};
    if (!shadow[1] || !sanitize_library(glsl, "shadow", shadow))
        return false;
    if (!cells)
        return true;
    text_add(&glsl->parts[PART_END], "const uint diptych_shared_cells = %uu;\n\n", SHARED_CELLS);
    const char *const words[] = {
        "@cells@", sanitize_layout(glsl, cell_names[bank_of(pipeline, glsl->pass->index)]),
        "@single@", pipeline->pass_count == 1 ? " || frame.index > 0u" : "", NULL};
    return words[1] && sanitize_library(glsl, "cells", words);
}

bool shadow_glsl(struct glsl *glsl)
{
    struct text *out = &glsl->parts[PART_END];
    bool some = glsl->model->sanitize & SANITIZE_SHADOW;
    bool cells = some && has_cells(glsl->pass);
    if (some && !add_libraries(glsl, cells))
        return false;
    for (uint32_t i = 0; some && i < glsl->pass->access_count; i++) {
        const struct access *access = &glsl->pass->accesses[i];
        if (is_foreign(access->resource) || access->binding < 0)
            continue;
        add_index(access, out);
        add_content(glsl, access, out);
        if (cells && stores_to(glsl->pass, access->resource))
            add_race(glsl, access, out);
    }
    add_finish(glsl, cells, out);
    return true;
}

/* ---- Messages -------------------------------------------------------------------------------- */

static void texel_text(const struct resource *image, uint32_t at, uint32_t frame_size, char *text,
                       size_t room)
{
    uint32_t width = frame_size & 0xffff, height = frame_size >> 16, mip = 0;
    uint32_t x = expr_value(image->width, width, height, width);
    uint32_t y = expr_value(image->height, width, height, height);
    uint32_t z = expr_value(image->layers, width, height, 1), mips = mips_of(image);
    x = x ? x : 1;
    y = y ? y : 1;
    z = z ? z : 1;
    for (; mip + 1 < mips && at >= x * y * z; mip++) {
        at -= x * y * z;
        x = x > 1 ? x / 2 : 1;
        y = y > 1 ? y / 2 : 1;
        z = image->shape == DT_SHAPE_3D && z > 1 ? z / 2 : z;
    }
    int length = snprintf(text, room, "texel (%u, %u", at % x, at / x % y);
    if (image->layers)
        length += snprintf(text + length, room - (size_t)length, ", %u", at / x / y);
    length += snprintf(text + length, room - (size_t)length, ")");
    if (mips > 1)
        snprintf(text + length, room - (size_t)length, " of mip %u", mip);
}

void shadow_place(const struct sanitize_site *site, uint32_t at, uint32_t frame_size, char *text,
                  size_t room)
{
    char place[96] = "";
    if (site->resource && site->resource->kind == DT_IMAGE)
        texel_text(site->resource, at, frame_size, place, sizeof place);
    else if (site->resource || site->words)
        snprintf(place, sizeof place, "element %u",
                 (at - site->first) / (site->resource ? site->resource->stride / 4 : site->words));
    snprintf(text, room, "%s%s`%.60s`", place, *place ? " of " : "",
             site->resource ? site->resource->name : site->name);
}
