/* Shadow memory of --sanitize=content,race,flow; see templates/glsl/shadow.glsl and cells.glsl. Two kinds of internal buffers:
 *
 * - The shadow: a word for each texel, and for each word of a buffer, with the frame that wrote it last. So nothing is reset:
 *   what an earlier frame wrote is old. Each resource has words of its own, also those that share memory: the plan stays as
 *   it is, and what the former owner of memory left never counts as written.
 * - The cells: what is known of one dispatch. A pass clears those of the next pass before its own work, which needs other
 *   ones: passes take turns with two, and where the last pass meets the first one, with three. */
#include <string.h>

#include "model/expr.h"
#include "plan.h"
#include "sanitize.h"
#include "shadow.h"

const char shadow_buffer[] = "diptych_shadow";
const char *const shadow_cell_buffers[SHADOW_BANKS] = {"diptych_cells_0", "diptych_cells_1",
                                                       "diptych_cells_2"};

/* As cells.glsl has them. */
enum { BARRIER_WORDS = 65536, CELL_WORDS = 6 };

/* ---- The plan -------------------------------------------------------------------------------- */

uint32_t shadow_bank(const struct pipeline *pipeline, uint32_t pass)
{
    bool last = pipeline->pass_count > 1 && pass + 1 == pipeline->pass_count;
    return last && pipeline->pass_count % 2 ? 2 : pass % 2;
}

bool shadow_has_cells(const struct pass *pass)
{
    return pass->kind == DT_PASS_DISPATCH;
}

void shadow_plan(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;
    struct resource *banks[SHADOW_BANKS];
    if (!(model->sanitize & SANITIZE_SHADOW))
        return;
    struct resource *shadow = sanitize_resource(pipeline, shadow_buffer);
    for (size_t i = 0; i < SHADOW_BANKS; i++)
        banks[i] = sanitize_resource(pipeline, shadow_cell_buffers[i]);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        struct pass *pass = pipeline->order[i];
        uint32_t next = (i + 1) % pipeline->pass_count;
        sanitize_access(pass, shadow);
        if (shadow_has_cells(pass))
            sanitize_access(pass, banks[shadow_bank(pipeline, i)]);
        if (shadow_has_cells(pipeline->order[next]) &&
            shadow_bank(pipeline, next) != shadow_bank(pipeline, i)) {
            struct access *clear = sanitize_access(pass, banks[shadow_bank(pipeline, next)]);
            clear->mode = MODE_WRITE;
            clear->clears = true;
        }
    }
}

/* ---- Sizes ----------------------------------------------------------------------------------- */

/* Factors: expressions, at least 1 each; NULL: `otherwise`, which is a side of the frame if `frame`. */
struct factor {
    const struct expr *expr;
    char frame; /* 'w', 'h': a side of the frame for NULL; 0: 1 */
};

static void add_product(struct shadow_sum *sum, uint64_t times, const struct factor *factors,
                        int count)
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
            text_add(&text, sum->c ? " * dt_size(" : " * uint(max(");
            (sum->c ? expr_emit_c : expr_emit_glsl)(expr, &text);
            text_add(&text, sum->c ? ")" : ", 1))");
        } else {
            text_add(&text, " * %s%s", sum->c ? "" : "frame.",
                     factors[i].frame == 'w' ? "width" : "height");
        }
    }
    sum->value += value;
    if (text.length)
        text_add(&sum->text, sum->c ? " + INT64_C(%llu)%s" : " + %lluu%s",
                 (unsigned long long)times, text.data);
    else
        sum->literal += times;
    sum->text.failed |= text.failed;
    text_free(&text);
}

/* A texel, or a word of a buffer, has one. Mips of an image take at most as many as its first, and one for each layer of the
 * smallest. */
void shadow_add_words(struct shadow_sum *sum, const struct resource *resource)
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
bool shadow_is_foreign(const struct resource *resource)
{
    return !resource || resource->internal || resource->input;
}

bool shadow_stores_to(const struct pass *pass, const struct resource *resource)
{
    bool stores = false;
    EACH(access, pass->accesses, pass->access_count)
        stores |=
            access->resource == resource && !resource->internal && access->kind & DT_WRITE_STORAGE;
    return stores && pass->kind == DT_PASS_DISPATCH;
}

/* Cells of all that the pass stores to, before this resource; NULL: of all. */
void shadow_add_cells(struct shadow_sum *sum, const struct pipeline *pipeline,
                      const struct pass *pass, const struct resource *until)
{
    EACH(resource, pipeline->resources, pipeline->resource_count)
        if (resource == until)
            return;
        else if (shadow_stores_to(pass, resource))
            shadow_add_words(sum, resource);
}

void shadow_add_all(struct shadow_sum *sum, const struct pipeline *pipeline,
                    const struct resource *until)
{
    for (uint32_t i = 0; i < pipeline->resource_count && &pipeline->resources[i] != until; i++)
        if (!shadow_is_foreign(&pipeline->resources[i]))
            shadow_add_words(sum, &pipeline->resources[i]);
}

uint64_t shadow_words(const struct model *model, const struct resource *resource, uint32_t width,
                      uint32_t height)
{
    const struct pipeline *pipeline = &model->pipeline;
    struct shadow_sum sum = {.width = width, .height = height};
    uint64_t most = 0;
    if (!resource->internal || !(model->sanitize & SANITIZE_SHADOW) || resource->count)
        return 0;
    if (!strcmp(resource->name, shadow_buffer)) {
        shadow_add_all(&sum, pipeline, NULL);
        most = sum.value;
    } else {
        EACH(pass, pipeline->passes, pipeline->pass_count) {
            sum.value = 0;
            shadow_add_cells(&sum, pipeline, pass, NULL);
            most = sum.value > most ? sum.value : most;
        }
        most = BARRIER_WORDS + CELL_WORDS * (SHADOW_SHARED_CELLS + most);
    }
    text_free(&sum.text);
    return most + 1;
}

bool shadow_emit_c(const struct model *model, const struct resource *resource, struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;
    struct shadow_sum sum = {.c = true};
    if (!resource->internal || !(model->sanitize & SANITIZE_SHADOW) || resource->count)
        return false;
    bool all = !strcmp(resource->name, shadow_buffer);
    if (all)
        shadow_add_all(&sum, pipeline, NULL);
    else
        sum.literal = BARRIER_WORDS + CELL_WORDS * SHADOW_SHARED_CELLS;
    text_add(out, "%llu%s", (unsigned long long)sum.literal + 1,
             sum.text.data ? sum.text.data : "");
    for (uint32_t i = 0; i < pipeline->pass_count && !all; i++) { /* more than the most of them */
        struct shadow_sum own = {.c = true};
        shadow_add_cells(&own, pipeline, &pipeline->passes[i], NULL);
        if (own.literal || own.text.data)
            text_add(out, " + %d * (%llu%s)", CELL_WORDS, (unsigned long long)own.literal,
                     own.text.data ? own.text.data : "");
        out->failed |= own.text.failed;
        text_free(&own.text);
    }
    out->failed |= sum.text.failed;
    text_free(&sum.text);
    return true;
}
