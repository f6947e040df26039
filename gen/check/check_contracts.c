/* Contracts: each fits its resource, and the margins of `flips` are valid. */
#include <inttypes.h>
#include <string.h>

#include "checks.h"
#include "formats.h"
#include "read/table.h"
#include "base/nearest.h"

static bool is_integer(enum dt_type type)
{
    return type >= DT_TYPE_INT && type <= DT_TYPE_BOOL;
}

/* Whether the element's type is known. An unknown type has been reported. */
static bool has_element(const struct resource *buffer)
{
    return buffer->structure ||
           (buffer->of && table_choice(table_find(SECTION_STRUCT, "*")->choices, buffer->of) >= 0);
}

static void check_flips(struct checker *c, const struct resource *resource)
{
    struct loc loc = resource->contract.loc;
    if (resource->kind == DT_IMAGE) {
        if (!format_is_integer(resource->format))
            diag_error(c->diag, loc, "`flips` is for integers; the texels of `%s` are not",
                       resource->name);
        return;
    }
    if (!resource->structure && has_element(resource) && !is_integer(resource->type))
        diag_error(c->diag, loc, "`flips` is for integers; `%s` is of %s", resource->name,
                   resource->of);
    for (uint32_t i = 0; resource->structure && i < resource->structure->field_count; i++) {
        const struct field *field = &resource->structure->fields[i];
        if (is_integer(field->type))
            continue;
        diag_error(c->diag, loc, "`flips` is for integers; `%s.%s` is %s", resource->name,
                   field->name, type_info(field->type)->name);
        return;
    }
}

/* ---- Margins --------------------------------------------------------------------------------- */

static struct resource *find_margin(struct checker *c, const struct contract *contract)
{
    const struct pipeline *p = c->pipeline;
    const char *name = contract->margin, *dot = strrchr(name, '.');
    /* NAME.FIELD; an instance's name has dots, too */
    if (dot && !declared_find(p, DECLARED_RESOURCE, name))
        name = arena_strndup(c->model->arena, name, (size_t)(dot - name));
    struct resource *margin = name ? declared_find(p, DECLARED_BUFFER, name) : NULL;
    if (name && declared_find(p, DECLARED_IMAGE, name))
        diag_error(c->diag, contract->margin_loc, "`%s` is an image, not a buffer", name);
    else if (name && !margin)
        report_missing(c, contract->margin_loc, "buffer", name, DECLARED_BUFFER);
    return margin;
}

/* Index of the struct's field with that name; -1 after an error. */
static int find_contract_field(struct checker *c, const struct resource *margin, const char *name,
                               struct loc loc)
{
    const struct structure *structure = margin->structure;
    uint32_t count = structure->field_count, i = 0;
    const char **names = arena_alloc(c->model->arena, (count + 1) * sizeof *names);
    while (names && i < count && strcmp(structure->fields[i].name, name)) {
        names[i] = structure->fields[i].name;
        i++;
    }
    if (names && i < count)
        return (int)i;
    diag_error(c->diag, loc, "`%s` has no field `%s`%s", structure->name, name,
               name_hint('`', name, names, count, "").text);
    return -1;
}

/* The field that holds the margins, a single float; -1 after an error. */
static int margin_field(struct checker *c, const struct resource *margin,
                        const struct contract *contract)
{
    const char *dot = strchr(contract->margin + strlen(margin->name), '.');
    const struct structure *structure = margin->structure;
    struct loc loc = contract->margin_loc;
    if (!has_element(margin))
        return -1;
    if (!structure && dot)
        diag_error(c->diag, loc, "`%s` is of %s and has no fields", margin->name, margin->of);
    if (structure && !dot)
        diag_error(c->diag, loc, "`%s` is of `%s`: name one of its fields, `%s.FIELD`",
                   margin->name, structure->name, margin->name);
    if (!structure != !dot)
        return -1;
    int field = structure ? find_contract_field(c, margin, dot + 1, loc) : 0;
    if (field < 0)
        return -1;
    enum dt_type type = structure ? structure->fields[field].type : margin->type;
    bool array = structure && structure->fields[field].array_count;
    if (type == DT_TYPE_FLOAT && !array)
        return field;
    diag_error(c->diag, loc, "a margin is a float; `%s` is %s%s", contract->margin,
               array ? "an array of " : "", type_info(type)->name);
    return -1;
}

static void check_margin_count(struct checker *c, const struct resource *resource,
                               const struct resource *margin)
{
    int64_t counts[2];
    for (int i = 0; resource->count && margin->count && i < FRAME_SIZES; i++) {
        const int *frame = frame_sizes[i];
        if (expr_eval(resource->count, frame[0], frame[1], &counts[0]) != EXPR_OK ||
            expr_eval(margin->count, frame[0], frame[1], &counts[1]) != EXPR_OK ||
            counts[0] == counts[1])
            continue;
        diag_error(c->diag, resource->contract.margin_loc,
                   "at a frame of %dx%d `%s` has %" PRId64
                   " elements, but its margin `%s` has %" PRId64 "; both need the same count",
                   frame[0], frame[1], resource->name, counts[0], margin->name, counts[1]);
        return;
    }
}

/* Each pass that writes the resource must write its margins too, or they would be out of date. */
static void check_margin_writer(struct checker *c, const struct resource *resource,
                                const struct resource *margin)
{
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count) {
        if (pass_writes(pass, resource) && !pass_writes(pass, margin))
            diag_error(c->diag, resource->contract.margin_loc,
                       "the pass `%s` writes `%s`, but not its margin `%s`; list `%s` in `writes`",
                       pass->name, resource->name, margin->name, margin->name);
    }
}

static void resolve_margin(struct checker *c, struct resource *resource)
{
    struct contract *contract = &resource->contract;
    if (resource->kind == DT_IMAGE) {
        diag_error(c->diag, contract->margin_loc,
                   "`%s` is an image; only a buffer can have a margin", resource->name);
        return;
    }
    const struct resource *margin = find_margin(c, contract);
    int field = margin ? margin_field(c, margin, contract) : -1;
    if (field < 0)
        return;
    contract->allowed.margin_resource = (uint16_t)margin->index;
    contract->allowed.margin_field = (int16_t)field;
    check_margin_count(c, resource, margin);
    check_margin_writer(c, resource, margin);
}

/* Whether a scene draw writes the image. */
static bool is_drawn(const struct checker *c, const struct resource *resource)
{
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        if (pass->kind == DT_PASS_DRAW_SCENE && pass_writes(pass, resource))
            return true;
    return false;
}

/* Whether a pass writes the resource that its `exactness` leaves free. */
static bool is_bounded(const struct checker *c, const struct resource *resource)
{
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        if (pass->bounded && pass_writes(pass, resource))
            return true;
    return false;
}

static void resolve_of_exact(struct checker *c, const struct resource *resource,
                             struct dt_contract *contract)
{
    static const double default_tolerance = 1e-3;
    bool bounded = is_bounded(c, resource);
    if (bounded && contract->kind == DT_CONTRACT_EXACT)
        *contract = (struct dt_contract){
            .kind = DT_CONTRACT_OF_EXACT, .tolerance = default_tolerance, .margin_field = -1};
    else if (!bounded && contract->kind == DT_CONTRACT_OF_EXACT)
        *contract = (struct dt_contract){.kind = DT_CONTRACT_EXACT, .margin_field = -1};
}

void check_contracts(struct checker *c)
{
    CHANGE_EACH(resource, c->pipeline->resources, c->pipeline->resource_count) {
        resolve_of_exact(c, resource, &resource->contract.allowed);
        if (resource->contract.allowed.kind == DT_CONTRACT_IMAGE && resource->kind == DT_BUFFER)
            diag_error(c->diag, resource->contract.loc,
                       "`image` is for images, and `%s` is a buffer; use `abs`", resource->name);
        if (resource->contract.allowed.kind == DT_CONTRACT_RASTER && !is_drawn(c, resource))
            diag_error(c->diag, resource->contract.loc,
                       "`raster` is for images of scene draws; none writes `%s`", resource->name);
        if (resource->contract.allowed.kind != DT_CONTRACT_FLIPS)
            continue;
        check_flips(c, resource);
        if (resource->contract.margin)
            resolve_margin(c, resource);
    }
}
