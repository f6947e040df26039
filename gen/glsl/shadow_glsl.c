/* What the shaders of --sanitize=content,race,flow get: templates/glsl/shadow.glsl and cells.glsl, and for each access where its
 * texels and words stand in the shadow and in the cells (plan/shadow.c). */
#include "plan/shadow.h"

#include "glsl.h"
#include "plan/plan.h"
#include "plan/sanitize.h"

static void put_sum(struct shadow_sum *sum, struct text *out)
{
    text_add(out, "%lluu%s", (unsigned long long)sum->literal,
             sum->text.data ? sum->text.data : "");
    out->failed |= sum->text.failed;
    text_free(&sum->text);
    *sum = (struct shadow_sum){0};
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
        struct shadow_sum words = {0};
        text_add(out, "uint diptych_at_%d(const uint word)\n{\n    return diptych_word_at(word, ",
                 access->binding);
        shadow_add_words(&words, resource);
        put_sum(&words, out);
        text_add(out, ");\n}\n\n");
        return;
    }
    bool all = access->kind & DT_READ_TEXTURE && !access_sees_one_mip(access);
    text_add(out,
             "uint diptych_at_%d(const ivec3 p, const int mip)\n{\n    return diptych_texel_at(p + "
             "ivec3(0, 0, %u), mip + %u, %u, ivec3(",
             access->binding, access->layer ? access->layer_value : 0, all ? 0 : access->mip_value,
             mips_of(resource));
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
    EACH(access, pass->accesses, pass->access_count) {
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
    struct shadow_sum base = {0};
    struct text whole = {0};
    bool always = false;
    for (uint32_t i = 0; i < glsl->pipeline->pass_count; i++) {
        const struct pass *pass = glsl->pipeline->order[i];
        bool later = pass->index >= glsl->pass->index;
        if (!later || resource->history)
            always |= add_whole(pass, access, later, &whole);
    }
    shadow_add_all(&base, glsl->pipeline, resource);
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
    struct shadow_sum base = {0};
    text_add(out, "uint diptych_cell_%d(const uint at)\n{\n    return diptych_cell(at, ",
             access->binding);
    shadow_add_cells(&base, glsl->pipeline, glsl->pass, access->resource);
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
    const char *const shadow[] = {"@shadow@", sanitize_layout(glsl, shadow_buffer), NULL};
    if (!shadow[1] || !sanitize_library(glsl, "shadow", shadow))
        return false;
    if (!cells)
        return true;
    text_add(&glsl->parts[PART_CHECKS], "const uint diptych_shared_cells = %uu;\n\n",
             SHADOW_SHARED_CELLS);
    const char *const words[] = {
        "@cells@",
        sanitize_layout(glsl, shadow_cell_buffers[shadow_bank(pipeline, glsl->pass->index)]),
        "@single@", pipeline->pass_count == 1 ? " || diptych_now() > 1u" : "", NULL};
    return words[1] && sanitize_library(glsl, "cells", words);
}

bool shadow_glsl(struct glsl *glsl)
{
    struct text *out = &glsl->parts[PART_END];
    bool some = glsl->model->sanitize & SANITIZE_SHADOW;
    bool cells = some && shadow_has_cells(glsl->pass);
    if (some && !add_libraries(glsl, cells))
        return false;
    for (uint32_t i = 0; some && i < glsl->pass->access_count; i++) {
        const struct access *access = &glsl->pass->accesses[i];
        if (shadow_is_foreign(access->resource) || access->binding < 0)
            continue;
        add_index(access, out);
        add_content(glsl, access, out);
        if (cells && shadow_stores_to(glsl->pass, access->resource))
            add_race(glsl, access, out);
    }
    add_finish(glsl, cells, out);
    return true;
}
