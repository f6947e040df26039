/* Parameters and constants of a spec. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "formats.h"
#include "reader.h"

static bool scalar_value(const char *text, double *value, enum dt_type *type)
{
    if (!strcmp(text, "true") || !strcmp(text, "false")) {
        *type = DT_TYPE_BOOL;
        *value = text[0] == 't';
        return true;
    }
    *type = strpbrk(text, ".eE") ? DT_TYPE_FLOAT : DT_TYPE_INT;
    return text_number(text, value);
}

/* Reads a value and infers its type; false when the node is no value. Reports nothing. */
bool param_value(struct reader *reader, struct fy_node *node, double value[4], uint32_t *components,
                 enum dt_type *type)
{
    const char *text = node_text(reader, node);
    *components = 1;
    if (text)
        return scalar_value(text, &value[0], type);
    if (!node || fy_node_get_type(node) != FYNT_SEQUENCE)
        return false;
    int count = fy_node_sequence_item_count(node);
    bool real = false;
    for (int i = 0; i < count && i < 4; i++) {
        enum dt_type part;
        text = node_text(reader, fy_node_sequence_get_by_index(node, i));
        if (!text || !scalar_value(text, &value[i], &part) || part == DT_TYPE_BOOL)
            return false;
        real |= part == DT_TYPE_FLOAT;
    }
    if (count < 2 || count > 4)
        return false;
    *components = (uint32_t)count;
    *type = (enum dt_type)((int)(real ? DT_TYPE_FLOAT : DT_TYPE_INT) + count - 1);
    return true;
}

static bool fits_type(const struct param *param, uint32_t components, enum dt_type own,
                      double value)
{
    if (components != param->components || (own == DT_TYPE_BOOL) != (param->type == DT_TYPE_BOOL))
        return false;
    if (param->type >= DT_TYPE_UINT && param->type <= DT_TYPE_UVEC4)
        return value == floor(value) && value >= 0 && value <= UINT32_MAX;
    if (param->type >= DT_TYPE_INT && param->type <= DT_TYPE_IVEC4)
        return value == floor(value) && value >= INT32_MIN && value <= INT32_MAX;
    return true;
}

static int former_type(const struct reader *reader, struct fy_node *node)
{
    for (size_t i = 0; i < reader->override_count; i++)
        if (reader->overrides[i].node == node)
            return reader->overrides[i].type;
    return -1;
}

/* A value from --set keeps the type of the value that it replaces: 1 may replace a real, and 2.0 an
 * integer. */
static enum dt_type inferred_type(const struct reader *reader, struct fy_node *node,
                                  enum dt_type own)
{
    int former = former_type(reader, node);
    return former >= 0 ? (enum dt_type)former : own;
}

/* False after an error, and without a value. */
static bool take_value(struct reader *reader, struct param *param, struct fy_node *node, int type)
{
    enum dt_type own = DT_TYPE_INT;
    uint32_t components = 1;
    param->value_loc = node ? node_loc(reader, node) : param->loc;
    param->type = type >= 0 ? (enum dt_type)type : DT_TYPE_INT;
    param->components = type_components(param->type);
    if (!node)
        return false;
    if (!param_value(reader, node, param->value, &components, &own))
        return diag_error(reader->diag, param->value_loc, "the value of `%s` must be %s",
                          param->name, key_types[KEY_VALUE].text);
    if (type < 0)
        param->type = inferred_type(reader, node, own);
    param->components = type_components(param->type);
    bool fits = true;
    for (uint32_t i = 0; i < components; i++)
        fits &= fits_type(param, components, own, param->value[i]);
    if (!fits)
        diag_error(reader->diag, param->value_loc, "`%s` has type %s; this value does not fit",
                   param->name, type_info(param->type)->name);
    return fits;
}

/* Reports a value outside of min and max, or of float, and limits it: so what depends on the parameter
 * gets no errors of its own. */
static void limit_value(struct reader *reader, struct param *param)
{
    double wrong = 0, limit = 0;
    const char *where = NULL;
    for (uint32_t i = 0; i < param->components && param->min <= param->max; i++) {
        double value = param->value[i], most = param->max < FLT_MAX ? param->max : FLT_MAX;
        param->value[i] = fmin(fmax(value, fmax(param->min, -FLT_MAX)), most);
        if (where || value == param->value[i])
            continue;
        where = value < param->min ? "below its min of" : "above its max of";
        limit = value < param->min ? param->min : param->max;
        wrong = value;
    }
    if (where && fabs(limit) <= FLT_MAX)
        diag_error(reader->diag, param->value_loc, "`%s` is %.9g, %s %.9g", param->name, wrong,
                   where, limit);
    else if (where)
        diag_error(reader->diag, param->value_loc, "`%s` is %.9g, and no float is larger than %.9g",
                   param->name, wrong, FLT_MAX);
}

static void finish_param(struct reader *reader, const struct fields *fields, void *record)
{
    struct param *param = record;
    if (param->live && param->uniform) {
        node_error(reader, field_node(fields, "uniform"),
                   "live parameters are already in the uniform block; remove `uniform`. If counts "
                   "or sizes depend on `%s`, remove `live` instead",
                   param->name);
        param->uniform = false;
    }
    if (take_value(reader, param, field_node(fields, "value"),
                   field_choice(reader, fields, "type", -1)))
        limit_value(reader, param);
}

void read_params(struct reader *reader, const struct fields *top)
{
    static const struct param initial = {.min = -INFINITY, .max = INFINITY};
    static const struct entries kind = {"params", sizeof initial, &initial, finish_param, false};
    struct pipeline *pipeline = &reader->model->pipeline;
    pipeline->params = entries_read(reader, top, &kind, &pipeline->param_count);
}

void read_constants(struct reader *reader, const struct fields *top)
{
    static const struct entries kind = {.key = "constants", .size = sizeof(struct constant)};
    struct pipeline *pipeline = &reader->model->pipeline;
    pipeline->constants = entries_read(reader, top, &kind, &pipeline->constant_count);
}
