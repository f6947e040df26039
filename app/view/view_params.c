/* The parameters of the pipeline as the user edits them: live ones change the next frame, of others
 * the plan is made again. Edits are undone, and kept in two settings, A and B. */
#include "view/view.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "result/live.h"

static bool is_edited(const struct overlay_param *param)
{
    return memcmp(param->value, param->initial, param->count * sizeof *param->value) != 0;
}

static struct overlay_param *find(const struct view_params *params, const char *name)
{
    for (uint32_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return &params->list[i];
    return NULL;
}

static struct overlay_param describe(const struct view *view, const struct dt_param *param)
{
    struct overlay_param out = {.name = param->name,
                                .doc = param->doc ? param->doc : "",
                                .live = param->live,
                                .is_bool = type_info(param->type)->scalar == DT_TYPE_BOOL,
                                .is_whole = type_info(param->type)->scalar != DT_TYPE_FLOAT,
                                .count = type_components(param->type),
                                .min = param->min,
                                .max = param->max,
                                .step = param->step};
    memcpy(out.value, param->value, out.count * sizeof *out.value);
    if (param->live) /* as the live block rounds it */
        live_get(view->pipeline.info->live_defaults, param, out.value);
    memcpy(out.initial, out.value, sizeof out.initial);
    if (param->live)
        live_get(view->pipeline.live, param, out.value);
    return out;
}

bool view_params_create(struct view *view)
{
    const struct dt_pipeline *info = view->pipeline.info;
    struct view_params old = view->params, *params = &view->params;
    params->list = calloc(info->param_count + 1, sizeof *params->list);
    params->kept = calloc(info->param_count + 1, sizeof *params->kept);
    params->other = calloc(info->param_count + 1, sizeof *params->other);
    params->count = 0;
    params->slot = old.slot ? old.slot : 'A';
    if (!params->list || !params->kept || !params->other) {
        view_params_free(params);
        view->params = old;
        return report_error(&view->console->log, "out of memory");
    }
    for (uint32_t i = 0; i < info->param_count; i++) {
        if (type_components(info->params[i].type) > 4)
            continue;
        struct overlay_param *param = &params->list[params->count];
        *param = describe(view, &info->params[i]);
        const struct overlay_param *was = find(&old, param->name);
        bool same = was && was->count == param->count && was->is_whole == param->is_whole;
        if (same && !param->live && !was->live && is_edited(was)) {
            memcpy(param->value, was->value, sizeof param->value);
            memcpy(param->initial, was->initial, sizeof param->initial);
        }
        memcpy(params->kept[params->count], param->value, sizeof param->value);
        memcpy(params->other[params->count], same ? old.other[was - old.list] : param->initial,
               sizeof param->value);
        params->count++;
    }
    free(old.list);
    free(old.kept);
    free(old.other);
    return true;
}

void view_params_free(struct view_params *params)
{
    free(params->list);
    free(params->kept);
    free(params->other);
    params->list = NULL;
    params->kept = params->other = NULL;
    params->count = 0;
}

/* ---- What was changed ------------------------------------------------------------------------ */

static void add_shown_value(struct text *text, const struct overlay_param *param)
{
    text_add(text, "%s=%s", param->name, param->count > 1 ? "[" : "");
    for (uint32_t i = 0; i < param->count; i++) {
        text_add(text, "%s", i ? "," : "");
        if (param->is_bool)
            text_add(text, "%s", param->value[i] != 0 ? "true" : "false");
        else if (param->live && !param->is_whole)
            text_add_float(text, param->value[i]);
        else
            text_add_double(text, param->value[i]);
    }
    text_add(text, "%s", param->count > 1 ? "]" : "");
}

char *view_params_text(const struct view *view, const char *before, const char *after, bool live,
                       bool baked)
{
    struct text text = {0};
    text_add(&text, "%s", "");
    for (uint32_t i = 0; i < view->params.count; i++) {
        const struct overlay_param *param = &view->params.list[i];
        if (!is_edited(param) || !(param->live ? live : baked))
            continue;
        text_add(&text, "%s", before);
        add_shown_value(&text, param);
        text_add(&text, "%s", after);
    }
    if (!text.failed && text.data)
        return text.data;
    text_free(&text);
    return NULL;
}

/* The overrides of the command line, and after them the edits. */
static bool make_again(struct view *view)
{
    const struct setup *setup = &view->options->setup;
    uint32_t count = setup->set_count;
    char *edits = view_params_text(view, "", "\n", false, true);
    const char **sets = calloc((size_t)count + view->params.count + 1, sizeof *sets);
    bool good = edits && sets;
    if (good && count)
        memcpy(sets, setup->sets, count * sizeof *sets);
    char *line = edits;
    while (good && *line) {
        char *end = strchr(line, '\n');
        *end = 0;
        sets[count++] = line;
        line = end + 1;
    }
    good = good && reload_again(view->reload, sets, count);
    free(sets);
    free(edits);
    return good;
}

/* ---- Edits ----------------------------------------------------------------------------------- */

static void remember_value(struct view_params *params, const char *name, const double value[4])
{
    if (params->undo_count == VIEW_UNDOS)
        memmove(params->undo, params->undo + 1, --params->undo_count * sizeof *params->undo);
    struct view_edit *edit = &params->undo[params->undo_count++];
    strncpy(edit->name, name, sizeof edit->name - 1);
    edit->name[sizeof edit->name - 1] = 0;
    memcpy(edit->value, value, sizeof edit->value);
}

static void apply_live(struct view *view, struct overlay_param *param)
{
    const struct dt_param *live = live_param(view->pipeline.info, param->name);
    double now[4] = {0};
    live_get(view->pipeline.live, live, now);
    if (memcmp(now, param->value, param->count * sizeof *now) == 0)
        return;
    view_set_live(view, live, param->value);
    live_get(view->pipeline.live, live, param->value); /* as it is rounded */
    view->step |= memcmp(now, param->value, param->count * sizeof *now) != 0;
}

bool view_params_apply(struct view *view)
{
    struct view_params *params = &view->params;
    bool editing = overlay_is_editing(view->overlay), baked = false;
    for (uint32_t i = 0; i < params->count; i++) {
        struct overlay_param *param = &params->list[i];
        if (param->live)
            apply_live(view, param);
        if (editing || !memcmp(param->value, params->kept[i], sizeof param->value))
            continue;
        if (!params->quiet)
            remember_value(params, param->name, params->kept[i]);
        memcpy(params->kept[i], param->value, sizeof param->value);
        baked |= !param->live;
    }
    params->quiet = params->quiet && editing;
    return !baked || make_again(view);
}

void view_params_set(struct view *view, const char *name, double value)
{
    struct overlay_param *param = find(&view->params, name);
    if (param && param->count == 1 && value >= param->min && value <= param->max)
        param->value[0] = value;
}

void view_params_undo(struct view *view)
{
    struct view_params *params = &view->params;
    if (!params->undo_count)
        return;
    const struct view_edit *edit = &params->undo[--params->undo_count];
    struct overlay_param *param = find(params, edit->name);
    if (param)
        memcpy(param->value, edit->value, sizeof param->value);
    params->quiet = true;
}

void view_params_swap(struct view *view)
{
    struct view_params *params = &view->params;
    for (uint32_t i = 0; i < params->count; i++) {
        double value[4];
        memcpy(value, params->list[i].value, sizeof value);
        memcpy(params->list[i].value, params->other[i], sizeof value);
        memcpy(params->other[i], value, sizeof value);
    }
    params->slot = params->slot == 'A' ? 'B' : 'A';
    params->quiet = true;
}
