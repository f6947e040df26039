/* Draws the values that may vary in a spec: those that no pass body can notice, or that every body
 * must support. Parameters vary between min and max, words among the choices of the table, images
 * among formats with the same channels. Uses only integer and plain IEEE arithmetic, so that a
 * seed gives the same draws on every machine. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "plan/plan.h"
#include "read/table.h"
#include "vary_draw.h"

/* ---- Random numbers -------------------------------------------------------------------------- */

/* splitmix64: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014. */
static uint64_t mix_state(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* 0 to count - 1; count at most 2^32. */
static uint64_t below(struct draws *draws, uint64_t count)
{
    draws->state += UINT64_C(0x9e3779b97f4a7c15);
    return (mix_state(draws->state) >> 32) * count >> 32;
}

static bool one_in(struct draws *draws, uint32_t count)
{
    return below(draws, count) == 0;
}

void draws_start(struct draws *draws, uint32_t variation, uint32_t attempt)
{
    draws->state =
        mix_state(mix_state(draws->request->seed) ^ ((uint64_t)variation << 32 | attempt));
    draws->set_count = 0;
}

/* ---- Overrides ------------------------------------------------------------------------------- */

static bool grow(struct draws *draws)
{
    size_t capacity = draws->capacity ? 2 * draws->capacity : 64;
    const char **sets = arena_alloc(draws->arena, capacity * sizeof *sets);
    if (!sets)
        return false;
    if (draws->set_count)
        memcpy(sets, draws->sets, draws->set_count * sizeof *sets);
    draws->sets = sets;
    draws->capacity = capacity;
    return true;
}

/* Whether the request sets this path; then it is not drawn. */
static bool is_fixed(const struct draws *draws, const char *path)
{
    size_t length = strlen(path);
    for (size_t i = 0; i < draws->request->set_count; i++) {
        const char *set = draws->request->sets[i];
        if (!strncmp(set, path, length) && (set[length] == '=' || set[length] == '.'))
            return true;
        if (!strncmp(set, "params.", 7) && !strncmp(set + 7, path, length) &&
            (set[7 + length] == '=' || set[7 + length] == '.'))
            return true;
    }
    return false;
}

static void add_set(struct draws *draws, const char *path, const char *value)
{
    if (!path || !value || (draws->set_count == draws->capacity && !grow(draws))) {
        draws->out_of_memory = true;
        return;
    }
    if (is_fixed(draws, path))
        return;
    const char *set = arena_printf(draws->arena, "%s=%s", path, value);
    draws->out_of_memory |= !set;
    if (set)
        draws->sets[draws->set_count++] = set;
}

static const char *path_of(struct draws *draws, const char *kind, const char *name, const char *key)
{
    return arena_printf(draws->arena, "%s.%s.%s", kind, name, key);
}

/* Draws one of the table's words for a key, the default included. */
static void set_choice(struct draws *draws, const char *path, enum section section, const char *key)
{
    const char *choices = table_find(section, key)->choices, *at = choices;
    uint32_t count = 1;
    for (const char *bar = strchr(choices, '|'); bar; bar = strchr(bar + 1, '|'))
        count++;
    for (uint64_t skip = below(draws, count); skip > 0; skip--)
        at = strchr(at, '|') + 1;
    add_set(draws, path, arena_strndup(draws->arena, at, strcspn(at, "|")));
}

/* ---- Parameters ------------------------------------------------------------------------------ */

/* All numbers of bits are equally likely, so that large ranges also give small values. */
static double draw_integer(struct draws *draws, double least, double most)
{
    uint64_t span = (uint64_t)(most - least), scale = 1;
    int bits = 0;
    while (span >> bits)
        bits++;
    scale <<= below(draws, (uint64_t)bits + 1);
    return least + (double)below(draws, scale < span + 1 ? scale : span + 1);
}

/* Uniform. A range of two decades or more: a random decade, then uniform in it. */
static double draw_real(struct draws *draws, double least, double most)
{
    double low = least;
    int decades = 0;
    if (least > 0)
        for (double end = least; end * 10 <= most; end *= 10)
            decades++;
    if (decades < 2)
        return least + (most - least) * (double)(below(draws, 999) + 1) / 1000;
    for (uint64_t skip = below(draws, (uint64_t)decades); skip > 0; skip--)
        low *= 10;
    return low * (double)(below(draws, 90) + 10) / 10;
}

/* One of four, equally likely: the minimum, the maximum, a value between, the former value. */
static double draw_component(struct draws *draws, const struct param *param, double former)
{
    bool real = param->type <= DT_TYPE_VEC4;
    double least = real ? param->min : ceil(param->min);
    double most = real ? param->max : floor(param->max);
    switch (below(draws, 4)) {
    case 0:
        return least;
    case 1:
        return most;
    case 2:
        return real ? draw_real(draws, least, most) : draw_integer(draws, least, most);
    default:
        return former;
    }
}

static const char *component_text(struct draws *draws, const struct param *param, double value)
{
    if (param->type == DT_TYPE_BOOL)
        return value != 0 ? "true" : "false";
    if (param->type > DT_TYPE_VEC4 || value == floor(value))
        return arena_printf(draws->arena, "%.0f%s", value, param->type > DT_TYPE_VEC4 ? "" : ".0");
    return arena_printf(draws->arena, "%.4g", value);
}

static void draw_param(struct draws *draws, const struct param *param)
{
    bool flag = param->type == DT_TYPE_BOOL, changed = false;
    const char *text = "";
    if (!flag && (!isfinite(param->min) || !isfinite(param->max) || param->max - param->min > 1e9))
        return; /* the spec gives no usable range */
    for (uint32_t i = 0; i < param->components; i++) {
        double former = param->value[i];
        double value = flag ? (double)below(draws, 2) : draw_component(draws, param, former);
        const char *part = component_text(draws, param, value);
        text = text && part ? arena_printf(draws->arena, "%s%s%s", text, i ? "," : "", part) : NULL;
        changed |= value != former;
    }
    if (text && param->components > 1)
        text = arena_printf(draws->arena, "[%s]", text);
    if (changed || !text)
        add_set(draws, param->name, text);
}

void draw_params(struct draws *draws, const struct pipeline *pipeline)
{
    for (uint32_t i = 0; i < pipeline->param_count; i++)
        draw_param(draws, &pipeline->params[i]);
}

/* ---- Details --------------------------------------------------------------------------------- */

/* Whether `other` can replace the image's format with only a change of precision: the same
 * channels, of floats, large enough for the clear colour, and at least half for a half or a
 * float. */
static bool may_replace(const struct resource *image, const struct format_info *other)
{
    const struct format_info *own = format_info(image->format);
    const double largest_half = 65504;
    bool half = other->kind == NUMBER_HALF, single = other->kind == NUMBER_FLOAT;
    if (own == other || number_is_integer(own->kind) || !(half || single) || !own->qualifier ||
        !other->qualifier || own->channels != other->channels)
        return false;
    for (int i = 0; half && i < 4; i++)
        if (fabs(image->clear[i]) > largest_half)
            return false;
    return other->bytes >= own->bytes || half;
}

static void draw_format(struct draws *draws, const struct pipeline *pipeline,
                        const struct resource *image)
{
    const char *others[DT_FORMAT_COUNT];
    uint32_t count = 0;
    /* the display output has 8 bits */
    if (pipeline->display_output && !strcmp(image->name, pipeline->display_output))
        return;
    for (int format = 0; format < DT_FORMAT_COUNT; format++)
        if (may_replace(image, format_info((enum dt_format)format)))
            others[count++] = format_info((enum dt_format)format)->name;
    if (count && one_in(draws, 6))
        add_set(draws, path_of(draws, "images", image->name, "format"),
                others[below(draws, count)]);
}

/* The two disk maps are interchangeable; a body for the square map does not expect a disk. */
static void draw_sampler(struct draws *draws, const struct sampler *sampler)
{
    static const char *const filter_keys[] = {"filter", "mip_filter", "wrap"};
    if (sampler->kind == SAMPLER_HAMMERSLEY && sampler->map != MAP_SQUARE && one_in(draws, 2))
        add_set(draws, path_of(draws, "samplers", sampler->name, "map"),
                sampler->map == MAP_POLAR_DISK ? "concentric_disk" : "polar_disk");
    size_t count = sampler->wrap == DT_WRAP_BORDER ? 2 : 3; /* its colour needs the wrap */
    for (size_t i = 0; sampler->kind == SAMPLER_FILTER && i < count; i++)
        if (one_in(draws, 2))
            set_choice(draws, path_of(draws, "samplers", sampler->name, filter_keys[i]),
                       SECTION_SAMPLER, filter_keys[i]);
}

static const char *draw_weight(struct draws *draws)
{
    return arena_printf(draws->arena, "%.2f", (double)below(draws, 101) / 100);
}

static void draw_metric(struct draws *draws, const struct metric *metric)
{
    const char *name = metric->name;
    if (one_in(draws, 2))
        return;
    if (!metric->position.param)
        add_set(draws, path_of(draws, "metrics", name, "position"), draw_weight(draws));
    if (!metric->normal.param)
        add_set(draws, path_of(draws, "metrics", name, "normal"), draw_weight(draws));
    set_choice(draws, path_of(draws, "metrics", name, "normal_term"), SECTION_METRIC,
               "normal_term");
    if (one_in(draws, 2))
        add_set(draws, path_of(draws, "metrics", name, "scale"),
                arena_printf(draws->arena, "%.1f", (double)(below(draws, 99) + 1) / 10));
}

/* For a dispatch of invocations, the size of the workgroups changes only their number. */
static void draw_local(struct draws *draws, const struct pass *pass)
{
    static const uint32_t widths[] = {1, 3, 8, 16, 32, 64, 128}, heights[] = {1, 2, 3, 4, 8};
    bool line = pass->size == SIZE_INVOCATIONS && !pass->dispatch[1];
    if (pass->kind != DT_PASS_DISPATCH || pass->minds_group || pass->size == SIZE_GROUPS ||
        pass->size == SIZE_INDIRECT || !one_in(draws, 3))
        return;
    uint32_t width = widths[below(draws, sizeof widths / sizeof *widths)];
    uint32_t height = heights[below(draws, sizeof heights / sizeof *heights)];
    add_set(draws, path_of(draws, "passes", pass->name, "local"),
            line ? arena_printf(draws->arena, "%u", width)
                 : arena_printf(draws->arena, "[%u,%u]", width, height));
}

static void draw_range(struct draws *draws, const struct pass *pass, const struct range *range)
{
    static const char *const keys[] = {"storage", "loop"};
    for (size_t i = 0; i < 2; i++)
        if (one_in(draws, 2))
            set_choice(draws,
                       arena_printf(draws->arena, "passes.%s.ranges.%s.%s", pass->name, range->name,
                                    keys[i]),
                       SECTION_RANGE, keys[i]);
}

void draw_details(struct draws *draws, const struct pipeline *pipeline)
{
    if (one_in(draws, 4))
        set_choice(draws, "target", SECTION_TOP, "target");
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        if (pipeline->resources[i].kind == DT_IMAGE && !pipeline->resources[i].input)
            draw_format(draws, pipeline, &pipeline->resources[i]);
    for (uint32_t i = 0; i < pipeline->sampler_count; i++)
        draw_sampler(draws, &pipeline->samplers[i]);
    for (uint32_t i = 0; i < pipeline->metric_count; i++)
        draw_metric(draws, &pipeline->metrics[i]);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        draw_local(draws, &pipeline->passes[i]);
        for (uint32_t k = 0; k < pipeline->passes[i].range_count; k++)
            draw_range(draws, &pipeline->passes[i], &pipeline->passes[i].ranges[k]);
    }
}

bool draw_fast(struct draws *draws)
{
    return one_in(draws, 8) && !is_fixed(draws, "exactness");
}

/* ---- Order ----------------------------------------------------------------------------------- */

/* Whether `later` must stay after `earlier`: one of them writes a resource that the other uses, or
 * `after` says so. */
static bool must_follow(struct arena *arena, const struct pass *earlier, const struct pass *later)
{
    struct touch *first = arena_alloc(arena, (earlier->access_count + 2) * sizeof *first);
    struct touch *second = arena_alloc(arena, (later->access_count + 2) * sizeof *second);
    if (!first || !second)
        return true;
    uint32_t first_count = pass_touches(earlier, first), second_count = pass_touches(later, second);
    for (uint32_t i = 0; i < first_count; i++)
        for (uint32_t k = 0; k < second_count; k++)
            if (first[i].resource == second[k].resource && (first[i].writes || second[k].writes))
                return true;
    for (uint32_t i = 0; i < later->after_count; i++)
        if (!strcmp(later->after[i], earlier->name))
            return true;
    return false;
}

/* Adds `before` to the `after` of the pass. */
static void set_after(struct draws *draws, const struct pass *pass, const char *before)
{
    const char *list = before;
    for (uint32_t i = 0; list && i < pass->after_count; i++)
        if (strcmp(pass->after[i], before) != 0)
            list = arena_printf(draws->arena, "%s,%s", list, pass->after[i]);
    add_set(draws, path_of(draws, "passes", pass->name, "after"),
            list ? arena_printf(draws->arena, "[%s]", list) : NULL);
}

/* Takes a random pass that has to follow none of the passes left. */
static const struct pass *take_ready(struct draws *draws, const struct model *model, bool *taken)
{
    const struct pipeline *pipeline = &model->pipeline;
    uint32_t chosen = 0, ready_count = 0;
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        bool ready = !taken[i];
        for (uint32_t k = 0; k < i && ready; k++)
            ready = taken[k] || !must_follow(model->arena, pipeline->order[k], pipeline->order[i]);
        if (ready && below(draws, ++ready_count) == 0)
            chosen = i;
    }
    taken[chosen] = true;
    return pipeline->order[chosen];
}

void draw_order(struct draws *draws, const struct model *model)
{
    uint32_t count = model->pipeline.pass_count;
    const struct pass **order = arena_alloc(model->arena, count * sizeof *order + 1);
    bool *taken = arena_alloc(model->arena, count + 1), moved = false;
    if (!order || !taken) {
        draws->out_of_memory = true;
        return;
    }
    if (!one_in(draws, 3))
        return;
    for (uint32_t i = 0; i < count; i++) {
        order[i] = take_ready(draws, model, taken);
        moved |= order[i] != model->pipeline.order[i];
    }
    for (uint32_t i = 1; moved && i < count; i++)
        set_after(draws, order[i], order[i - 1]->name);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

void draw_frame(struct draws *draws, const struct pipeline *pipeline, uint32_t frame[2])
{
    uint64_t kind = below(draws, 8);
    for (int i = 0; i < 2; i++) {
        uint32_t tile = pipeline->interleave_count ? pipeline->interleaves[0].tile[i] : 8;
        if (kind == 0 || kind == (uint64_t)i + 1) /* one texel, a column, a row */
            frame[i] = 1;
        else if (kind == 3) /* whole tiles */
            frame[i] = tile * (uint32_t)(below(draws, 6) + 1);
        else if (kind == 4)
            frame[i] = 2 + (uint32_t)below(draws, 63);
        else if (kind == 5)
            frame[i] = 97 + (uint32_t)below(draws, 64);
        else
            frame[i] = 2 * (uint32_t)below(draws, 32) + 1;
    }
}

/* 1 to 3 with history. Without history frames are independent: 1, and sometimes 2 as a test. */
uint32_t draw_frame_count(struct draws *draws, const struct pipeline *pipeline)
{
    bool history = false;
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        history |= pipeline->resources[i].history && !pipeline->resources[i].input;
    return history ? 1 + (uint32_t)below(draws, 3) : 1 + (uint32_t)one_in(draws, 4);
}
