/* Takes a pipeline that was made anew in place of the present one, between two frames; the present
 * one stays when a driver refuses the new one. Called by view.c. */
#include "view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "texels.h"
#include "timings.h"

const struct dt_panel *view_panel_of(const struct view_side *side, const struct pipeline *pipeline)
{
    return strcmp(side->session.runtime->name, "gl") == 0 ? pipeline->gl : pipeline->vk;
}

void view_set_live(struct view *view, const struct dt_param *param, const double values[4])
{
    char text[160] = "[";
    size_t used = 1;
    uint32_t count = type_components(param->type);
    for (uint32_t i = 0; i < count && used < sizeof text; i++)
        used +=
            (size_t)snprintf(text + used, sizeof text - used, "%s%.17g", i ? ", " : "", values[i]);
    if (used + 2 > sizeof text)
        return;
    memcpy(text + used, "]", 2);
    pipeline_set_live(&view->pipeline, param, text, &view->console->log);
}

/* What the user has changed stays so, where the new pipeline takes it. */
static void keep_live(struct view *view, const struct pipeline *old)
{
    for (uint32_t i = 0; i < old->info->param_count; i++) {
        const struct dt_param *was = &old->info->params[i];
        const struct dt_param *is = pipeline_param(view->pipeline.info, was->name);
        double value[4], initial[4];
        struct pipeline untouched = *old;
        untouched.live = (void *)old->info->live_defaults;
        if (!was->live || type_components(was->type) > 4 || !is || !is->live ||
            is->type != was->type)
            continue;
        pipeline_get_live(old, was, value);
        pipeline_get_live(&untouched, was, initial);
        bool fits = true;
        for (uint32_t k = 0; k < type_components(was->type); k++)
            fits = fits && value[k] >= is->min && value[k] <= is->max;
        if (fits && memcmp(value, initial, type_components(was->type) * sizeof *value) != 0)
            view_set_live(view, is, value);
    }
}

/* The same image as before, by name. */
static bool keep_shown(struct view *view, const char *name)
{
    const struct dt_pipeline *info = view->pipeline.info;
    int layer = view->layer;
    uint32_t mip = view->mip;
    if (!view_find_home(view))
        return false;
    for (uint32_t i = 0; i < info->resource_count; i++) {
        if (strcmp(info->resources[i].name, name) != 0 || !view_can_show(info, i))
            continue;
        view_show(view, i);
        view->layer = layer < (int)view_layers(view) ? layer : -1;
        view->mip = mip < view_mips(view) ? mip : 0;
    }
    return true;
}

static bool create(const struct view *view, const struct pipeline *pipeline)
{
    for (uint32_t i = 0; i < view->side_count; i++) {
        const struct view_side *side = &view->side[i];
        const struct session *session = &side->session;
        if (!session->runtime->create(session->handle, view_panel_of(side, pipeline)) ||
            !session->runtime->resize(session->handle, view->size[0], view->size[1]))
            return false;
    }
    return true;
}

static void set_error(struct view *view, char *text)
{
    free(view->error);
    view->error = text;
    if (text)
        fputs(text, stderr);
}

/* False: neither the new one nor the old one runs. */
static bool swap(struct view *view, struct pipeline *next)
{
    const char *name = view->pipeline.info->resources[view->resource].name;
    bool capture = console_capture(view->console);
    bool good = create(view, next);
    char *text = capture ? console_captured(view->console) : NULL;
    if (!good) {
        set_error(view, text);
        pipeline_unload(next);
        return create(view, &view->pipeline);
    }
    if (text)
        fputs(text, stderr);
    free(text);
    struct pipeline old = view->pipeline;
    view->pipeline = *next;
    view->frame = 0; /* history starts anew */
    view->digits = NULL;
    good = keep_shown(view, name) && view_times_create(view);
    keep_live(view, &old);
    pipeline_unload(&old);
    return good;
}

/* Its errors are shown like those of the pipeline, which is taken all the same. */
static void read_outline(struct view *view)
{
    uint32_t points = view->shown_points;
    bool capture = console_capture(view->console);
    bool good = view_outline_read(view);
    char *text = capture ? console_captured(view->console) : NULL;
    if (!good)
        set_error(view, text);
    else
        free(text);
    view->shown_points = points <= view->points_count ? points : 0;
}

static bool take(struct view *view, struct reload_result *result)
{
    double start = milliseconds_now();
    if (result->text && *result->text)
        fputs(result->text, stderr); /* warnings */
    free(result->text);
    set_error(view, NULL);
    if (result->pipeline.info == view->pipeline.info)
        pipeline_unload(&result->pipeline); /* saved, but not changed; or only its outline */
    else if (!swap(view, &result->pipeline))
        return false;
    read_outline(view);
    view->step = true;
    view->reloads++;
    view->reload_ms = result->ms + milliseconds_now() - start;
    if (!view->error)
        report_message(&view->console->log, DT_INFO,
                       "reloaded in %.0f ms, %.0f of them on the device", view->reload_ms,
                       view->reload_ms - result->ms);
    return true;
}

bool view_reload(struct view *view)
{
    struct reload_result result;
    switch (reload_poll(view->reload, &result)) {
    case RELOAD_BEGUN:
        view->reloading = true;
        return true;
    case RELOAD_DONE:
        view->reloading = false;
        return take(view, &result);
    case RELOAD_FAILED:
        view->reloading = false;
        set_error(view, result.text ? result.text : strdup("out of memory\n"));
        return true;
    default:
        return true;
    }
}
