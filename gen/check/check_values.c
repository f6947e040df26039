/* Numbers: parameters within their ranges, constants without cycles, sizes and counts at several
 * frame sizes, assertions. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "checks.h"

enum { LARGEST_SIDE = 16384, MOST_LAYERS = 2048, MOST_ELEMENTS = 1 << 28, MOST_POSITIONS = 1024 };

/* The smallest frame, the usual one, and one that no tile size divides. */
const int frame_sizes[FRAME_SIZES][2] = {{1, 1}, {1920, 1080}, {7, 5}};

/* ---- Expressions ----------------------------------------------------------------------------- */

static void remember(struct checker *c, const struct expr *expr)
{
    if (c->expr_count == c->expr_capacity) {
        size_t capacity = c->expr_capacity ? 2 * c->expr_capacity : 64;
        const struct expr **exprs = realloc(c->exprs, capacity * sizeof *exprs);
        if (!exprs) {
            c->out_of_memory = true;
            return;
        }
        c->exprs = exprs;
        c->expr_capacity = capacity;
    }
    c->exprs[c->expr_count++] = expr;
}

static bool check_reach(struct checker *c, const struct expr *expr, const struct limits *limits)
{
    unsigned excess = expr_reach(expr) & ~limits->reach;
    if (excess & EXPR_LIVE)
        diag_error(c->diag, expr_loc(expr), "%s of `%s` cannot depend on a live parameter",
                   limits->what, limits->of);
    else if (excess & EXPR_FRAME)
        diag_error(c->diag, expr_loc(expr), "%s of `%s` cannot depend on the size of the frame",
                   limits->what, limits->of);
    return !excess;
}

/* The frame size and live values of an evaluation, as text for the message. */
static const char *situation(struct checker *c, const struct expr *expr, const int frame[2],
                             const char *live)
{
    const char *text = "";
    unsigned reach = expr_reach(expr);
    if (reach & EXPR_FRAME)
        text = arena_printf(c->model->arena, " at a frame of %dx%d", frame[0], frame[1]);
    if ((reach & EXPR_LIVE) && *live)
        text = arena_printf(c->model->arena, "%s with live parameters at their %s",
                            text ? text : "", live);
    return text ? text : "";
}

static bool check_value(struct checker *c, const struct expr *expr, const struct limits *limits,
                        const int frame[2], const char *live)
{
    int64_t value;
    const char *where = situation(c, expr, frame, live);
    switch (expr_eval(expr, frame[0], frame[1], &value)) {
    case EXPR_DIVIDES_BY_ZERO:
        return diag_error(c->diag, expr_fault_loc(expr, frame[0], frame[1]),
                          "%s of `%s` divides by zero%s", limits->what, limits->of, where);
    case EXPR_OVERFLOWS:
        return diag_error(c->diag, expr_fault_loc(expr, frame[0], frame[1]),
                          "%s of `%s` overflows 64 bits%s", limits->what, limits->of, where);
    case EXPR_OK:
        break;
    }
    if (value < limits->least)
        diag_error(c->diag, expr_loc(expr), "%s of `%s` is %" PRId64 "%s; at least %" PRId64,
                   limits->what, limits->of, value, where, limits->least);
    else if (value > limits->most)
        diag_error(c->diag, expr_loc(expr), "%s of `%s` is %" PRId64 "%s; at most %" PRId64,
                   limits->what, limits->of, value, where, limits->most);
    return value >= limits->least && value <= limits->most;
}

/* Sets every live parameter to its min (side -1) or max (side 1), if it has one; saves the values
 * in `kept`. */
static void move_live(struct pipeline *pipeline, int side, double (*kept)[4])
{
    for (uint32_t i = 0; i < pipeline->param_count; i++) {
        struct param *param = &pipeline->params[i];
        double end = side < 0 ? param->min : param->max;
        memcpy(kept[i], param->value, sizeof param->value);
        for (uint32_t k = 0; param->live && isfinite(end) && k < 4; k++)
            param->value[k] = end;
    }
}

static void restore(struct pipeline *pipeline, double (*kept)[4])
{
    for (uint32_t i = 0; i < pipeline->param_count; i++)
        memcpy(pipeline->params[i].value, kept[i], sizeof pipeline->params[i].value);
}

static bool check_live_ends(struct checker *c, const struct expr *expr, const struct limits *limits)
{
    double(*kept)[4] = calloc(c->pipeline->param_count + 1, sizeof *kept);
    bool good = true;
    if (!kept) {
        c->out_of_memory = true;
        return false;
    }
    for (int side = -1; good && side <= 1; side += 2) {
        move_live(c->pipeline, side, kept);
        for (int i = 0; good && i < FRAME_SIZES; i++)
            good = check_value(c, expr, limits, frame_sizes[i], side < 0 ? "min" : "max");
        restore(c->pipeline, kept);
    }
    free(kept);
    return good;
}

static bool check_terms(struct checker *c, const struct expr *expr, const struct limits *limits)
{
    return expr_terms(expr) <= EXPR_MOST_TERMS ||
           diag_error(c->diag, expr_loc(expr),
                      "%s of `%s` has more than %d terms with those of its constants", limits->what,
                      limits->of, EXPR_MOST_TERMS);
}

bool check_expr(struct checker *c, struct expr *expr, const struct limits *limits)
{
    if (!expr)
        return false;
    remember(c, expr);
    if (!expr_resolve(expr, c->pipeline, c->diag) || !check_terms(c, expr, limits) ||
        !check_reach(c, expr, limits))
        return false;
    for (int i = 0; i < FRAME_SIZES; i++)
        if (!check_value(c, expr, limits, frame_sizes[i], ""))
            return false;
    return !(expr_reach(expr) & EXPR_LIVE) || check_live_ends(c, expr, limits);
}

bool check_baked(struct checker *c, struct expr *expr, const struct limits *limits, int64_t *value)
{
    return check_expr(c, expr, limits) && expr_eval(expr, 1, 1, value) == EXPR_OK;
}

const char *check_part(struct checker *c, const char *part, const char *whole)
{
    const char *text = arena_printf(c->model->arena, "the %s of the %s", part, whole);
    return text ? text : part;
}

/* ---- Parameters and constants ---------------------------------------------------------------- */

/* The reader checked the values. */
void check_params(struct checker *c)
{
    EACH(param, c->pipeline->params, c->pipeline->param_count)
        if (param->min > param->max)
            diag_error(c->diag, param->loc, "`%s` has min %.9g above max %.9g", param->name,
                       param->min, param->max);
        else if (param->step < 0)
            diag_error(c->diag, param->loc, "the step of `%s` is negative", param->name);
}

static void settle(struct checker *c, struct constant *constant)
{
    struct limits limits = {"the value", constant->name, EXPR_FRAME | EXPR_LIVE, INT64_MIN,
                            INT64_MAX};
    if (!check_expr(c, constant->value, &limits)) {
        constant->value = NULL;
        constant->folded = 1;
        return;
    }
    constant->terms = expr_terms(constant->value);
    constant->folds = expr_reach(constant->value) == EXPR_BAKED;
    if (constant->folds)
        expr_eval(constant->value, 1, 1, &constant->folded);
}

enum visit { VISIT_NEW, VISIT_ACTIVE, VISIT_SETTLED, VISIT_CYCLE };

/* Settles a constant after those that it mentions. Constants in a cycle, and those that depend on
 * one, stay unsettled. */
static enum visit visit(struct checker *c, uint32_t index, enum visit *visits, uint32_t depth)
{
    struct pipeline *pipeline = c->pipeline;
    struct constant *constant = &pipeline->constants[index];
    if (visits[index] == VISIT_ACTIVE)
        return VISIT_CYCLE;
    if (visits[index] != VISIT_NEW)
        return visits[index];
    visits[index] = VISIT_ACTIVE;
    enum visit result = VISIT_SETTLED;
    for (uint32_t i = 0; i < pipeline->constant_count && depth < EXPR_MOST_TERMS; i++)
        if (visits[i] != VISIT_SETTLED &&
            expr_mentions(constant->value, pipeline->constants[i].name) &&
            visit(c, i, visits, depth + 1) == VISIT_CYCLE)
            result = VISIT_CYCLE;
    if (result == VISIT_SETTLED)
        settle(c, constant);
    return visits[index] = result;
}

void check_constants(struct checker *c)
{
    struct pipeline *pipeline = c->pipeline;
    enum visit *visits = calloc(pipeline->constant_count + 1, sizeof *visits);
    c->out_of_memory |= !visits;
    for (uint32_t i = 0; visits && i < pipeline->constant_count; i++)
        visit(c, i, visits, 0);
    for (uint32_t i = 0; visits && i < pipeline->constant_count; i++) {
        struct constant *constant = &pipeline->constants[i];
        if (visits[i] != VISIT_CYCLE)
            continue;
        remember(c, constant->value);
        diag_error(c->diag, constant->loc, "the constant `%s` depends on itself", constant->name);
        constant->value = NULL;
        constant->folded = 1;
    }
    free(visits);
}

/* ---- Sizes ----------------------------------------------------------------------------------- */

bool image_extent(const struct resource *image, uint32_t mip, const int frame[2], int64_t extent[3])
{
    if (!image->width || !image->height)
        return false;
    extent[2] = 1;
    if (expr_eval(image->width, frame[0], frame[1], &extent[0]) != EXPR_OK ||
        expr_eval(image->height, frame[0], frame[1], &extent[1]) != EXPR_OK ||
        (image->layers && expr_eval(image->layers, frame[0], frame[1], &extent[2]) != EXPR_OK))
        return false;
    for (int i = 0; i < (image->shape == DT_SHAPE_3D ? 3 : 2); i++)
        extent[i] = extent[i] >> mip > 1 ? extent[i] >> mip : 1;
    return true;
}

/* Each mip halves the sides, so the smallest frame limits the number of mips. */
static void check_mips(struct checker *c, const struct resource *image)
{
    struct limits limits = {"the number of mips", image->name, EXPR_BAKED, 1, 15};
    int64_t mips, extent[3];
    if (!image->mips || !check_expr(c, image->mips, &limits))
        return;
    for (int i = 0; i < FRAME_SIZES; i++) {
        const int *frame = frame_sizes[i];
        if (expr_eval(image->mips, frame[0], frame[1], &mips) != EXPR_OK ||
            !image_extent(image, 0, frame, extent))
            return;
        int64_t side = extent[0] > extent[1] ? extent[0] : extent[1];
        if (image->shape == DT_SHAPE_3D && extent[2] > side)
            side = extent[2];
        if (side >> (mips - 1) > 0)
            continue;
        diag_error(c->diag, expr_loc(image->mips),
                   "`%s` has %d mips, more than its size of %dx%d allows at a frame of %dx%d",
                   image->name, (int)mips, (int)extent[0], (int)extent[1], frame[0], frame[1]);
        return;
    }
}

/* A cube has six square faces. */
static void check_faces(struct checker *c, const struct resource *image)
{
    int64_t extent[3];
    for (int i = 0; i < FRAME_SIZES; i++) {
        const int *frame = frame_sizes[i];
        if (!image_extent(image, 0, frame, extent))
            return;
        if (extent[0] == extent[1] && extent[2] % 6 == 0)
            continue;
        diag_error(c->diag, extent[2] % 6 ? expr_loc(image->layers) : expr_loc(image->width),
                   "the cube `%s` has %dx%d texels and %d layers at a frame of %dx%d; faces are "
                   "square, and each cube has 6",
                   image->name, (int)extent[0], (int)extent[1], (int)extent[2], frame[0], frame[1]);
        return;
    }
}

static void check_image(struct checker *c, struct resource *image)
{
    bool volume = image->shape == DT_SHAPE_3D;
    int64_t side = volume ? MOST_LAYERS : LARGEST_SIDE;
    struct limits width = {"the width", image->name, EXPR_FRAME, 1, side};
    struct limits height = {"the height", image->name, EXPR_FRAME, 1, side};
    struct limits layers = {volume ? "the depth" : "the number of layers", image->name, EXPR_FRAME,
                            1, MOST_LAYERS};
    bool good = check_expr(c, image->width, &width);
    good &= check_expr(c, image->height, &height);
    if (image->layers)
        good &= check_expr(c, image->layers, &layers);
    if (!good)
        image->width = image->height = NULL;
    else if (image->shape == DT_SHAPE_CUBE || image->shape == DT_SHAPE_CUBE_ARRAY)
        check_faces(c, image);
    if (volume && image->format == DT_FORMAT_D32F)
        diag_error(c->diag, image->loc, "`%s` is a 3D image, which cannot have the format d32f",
                   image->name);
    check_mips(c, image);
}

static void check_interleave(struct checker *c, struct interleave *interleave)
{
    struct expr *sides[2] = {interleave->x, interleave->y};
    for (int i = 0; i < 2; i++) {
        struct limits limits = {i ? "the height" : "the width", interleave->name, EXPR_BAKED, 1,
                                64};
        int64_t value = 1;
        if (check_baked(c, sides[i], &limits, &value))
            interleave->tile[i] = (uint32_t)value;
    }
}

void check_sizes(struct checker *c)
{
    struct pipeline *pipeline = c->pipeline;
    CHANGE_EACH(resource, pipeline->resources, pipeline->resource_count) {
        struct limits count = {"the count", resource->name, EXPR_FRAME, 1, MOST_ELEMENTS};
        if (resource->kind == DT_IMAGE)
            check_image(c, resource);
        else if (!check_expr(c, resource->count, &count))
            resource->count = NULL;
    }
    CHANGE_EACH(sampler, pipeline->samplers, pipeline->sampler_count) {
        struct limits count = {"the count", sampler->name, EXPR_BAKED, 1, 1 << 24};
        if (sampler->kind == SAMPLER_HAMMERSLEY && !check_expr(c, sampler->count, &count))
            sampler->count = NULL;
    }
    CHANGE_EACH(tile, pipeline->interleaves, pipeline->interleave_count)
        check_interleave(c, tile);
}

/* ---- Assertions ------------------------------------------------------------------------------ */

static void add_param(struct text *text, const struct param *param, int component)
{
    for (uint32_t i = 0; i < param->components; i++) {
        if (component >= 0 && i != (uint32_t)component)
            continue;
        text_add(text, component < 0 && i ? ", " : "");
        if (param->type == DT_TYPE_BOOL)
            text_add(text, "%s", param->value[i] != 0 ? "true" : "false");
        else
            text_add_double(text, param->value[i]);
    }
}

/* Adds the value of {NAME} or {NAME.x}; false: unknown name. */
static bool add_placeholder(struct checker *c, const char *name, struct text *text)
{
    const char *dot = strchr(name, '.');
    size_t length = dot ? (size_t)(dot - name) : strlen(name);
    int component = -1;
    if (dot && dot[1] && strchr("xyzw", dot[1]) && !dot[2])
        component = dot[1] == 'w' ? 3 : dot[1] - 'x';
    else if (dot)
        return false;
    const char *base = arena_strndup(c->model->arena, name, length);
    const struct param *param = base ? declared_find(c->pipeline, DECLARED_PARAM, base) : NULL;
    const struct constant *constant = declared_find(c->pipeline, DECLARED_CONSTANT, name);
    int64_t value;
    if (param)
        add_param(text, param, component);
    else if (constant && expr_eval(constant->value, 1920, 1080, &value) == EXPR_OK)
        text_add(text, "%" PRId64, value);
    else
        return false;
    return true;
}

/* The message with its placeholders filled. */
static bool fill_message(struct checker *c, const struct assertion *assertion, struct text *text)
{
    bool good = true;
    for (const char *at = assertion->message; *at;) {
        const char *close = *at == '{' ? strchr(at, '}') : NULL;
        if (!close) {
            text_add_bytes(text, at++, 1);
            continue;
        }
        const char *name = arena_strndup(c->model->arena, at + 1, (size_t)(close - at - 1));
        if (name && !add_placeholder(c, name, text)) {
            report_missing(c, assertion->loc, "parameter or constant for the message's placeholder",
                           name, DECLARED_PARAM | DECLARED_CONSTANT);
            good = false;
        }
        at = close + 1;
    }
    return good;
}

static void check_assert(struct checker *c, const struct assertion *assertion)
{
    struct limits limits = {"the condition", "asserts", EXPR_FRAME | EXPR_LIVE, INT64_MIN,
                            INT64_MAX};
    struct text message = {0};
    int64_t holds = 1;
    bool good = check_expr(c, assertion->that, &limits);
    if (!assertion->message)
        return;
    if (fill_message(c, assertion, &message) && good &&
        expr_eval(assertion->that, 1920, 1080, &holds) == EXPR_OK && !holds) {
        const char *text = message.data ? message.data : "assertion failed";
        if (assertion->level == LEVEL_WARNING)
            diag_warning(c->diag, assertion->loc, "%s", text);
        else
            diag_error(c->diag, assertion->loc, "%s", text);
    }
    text_free(&message);
}

void check_jitter(struct checker *c)
{
    struct limits limits = {"the number of positions", "jitter", EXPR_LIVE, 0, MOST_POSITIONS};
    check_expr(c, c->pipeline->jitter, &limits);
}

void check_asserts(struct checker *c)
{
    for (uint32_t i = 0; i < c->pipeline->assertion_count; i++)
        check_assert(c, &c->pipeline->assertions[i]);
}
