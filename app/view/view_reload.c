/* Replaces the pipeline by a newly made one, between two frames. The old one stays when a driver
 * refuses the new one. */
#include "view/view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "result/live.h"
#include "spec/inputs.h"

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
    live_set(view->pipeline.info, view->pipeline.live, param, text, &view->console->log);
}

/* Keeps values that the user changed, if the new pipeline accepts them. */
static void keep_live(struct view *view, const struct pipeline *old)
{
    for (uint32_t i = 0; i < old->info->param_count; i++) {
        const struct dt_param *was = &old->info->params[i];
        const struct dt_param *is = live_param(view->pipeline.info, was->name);
        double value[4], initial[4];
        if (!was->live || type_components(was->type) > 4 || !is || !is->live ||
            is->type != was->type)
            continue;
        live_get(old->live, was, value);
        live_get(old->info->live_defaults, was, initial);
        bool fits = true;
        for (uint32_t k = 0; k < type_components(was->type); k++)
            fits = fits && value[k] >= is->min && value[k] <= is->max;
        if (fits && (setup_sets(&view->options->setup, was->name) ||
                     memcmp(value, initial, type_components(was->type) * sizeof *value) != 0))
            view_set_live(view, is, value);
    }
}

/* What was shown of the old pipeline; borrowed names. */
struct kept_shown {
    const char *resource, *pass;
    struct overlay_shown shown;
};

static struct kept_shown shown_of(const struct view *view, const struct dt_pipeline *info)
{
    return (struct kept_shown){.resource = info->resources[view->shown.resource].name,
                               .pass = info->passes[view->shown.pass].name,
                               .shown = view->shown};
}

/* The same as before, by name. */
static bool keep_shown(struct view *view, const struct kept_shown *kept)
{
    const struct dt_pipeline *info = view->pipeline.info;
    const struct overlay_shown *was = &kept->shown;
    struct overlay_shown *shown = &view->shown;
    if (!view_find_home(view))
        return false;
    for (uint32_t i = 0; i < info->resource_count; i++) {
        if (strcmp(info->resources[i].name, kept->resource) != 0 || !view_can_show(info, i))
            continue;
        view_show(view, i);
        shown->look = was->look;
        shown->mip = was->mip < view_mips(view) ? was->mip : 0;
        shown->layer = was->layer < (int)view_layers(view) ? was->layer : -1;
        shown->marked = was->marked;
        for (uint32_t k = 0; k < info->pass_count; k++)
            for (uint32_t w = 0; w < info->passes[k].write_count; w++)
                if (strcmp(info->passes[k].name, kept->pass) == 0 && info->passes[k].writes[w] == i)
                    shown->pass = k;
    }
    return true;
}

static bool create(struct view *view)
{
    for (uint32_t i = 0; i < view->side_count; i++) {
        struct session *session = &view->side[i].session;
        if (!session_create(session, &view->pipeline) || !session_resize(session, view->size))
            return false;
    }
    return true;
}

/* Takes over the text, which may be NULL. */
static void set_error(struct view *view, char *text)
{
    free(view->error);
    view->error = text;
    if (text)
        fputs(text, stderr);
}

/* Starts view->pipeline, up to its first picture. */
static bool start_pipeline(struct view *view, const struct kept_shown *shown)
{
    double begun = milliseconds_now();
    bool created =
        (view->options->setup.scene ||
         session_can_lack_scene(view->pipeline.info, view->console)) &&
        (view->pipeline.inputs || inputs_load(&view->pipeline, view->console, &view->own.setup));
    if (created && view->pipeline.frame_size[0])
        memcpy(view->size, view->pipeline.frame_size, sizeof view->size);
    created = created && create(view);
    view->device_ms = milliseconds_now() - begun;
    return created && keep_shown(view, shown) && view_times_create(view) &&
           view_params_create(view) && view_verdict_create(view) && view_render(view);
}

/* Errors of a driver or runtime for the new pipeline are shown like the generator's, and the old
 * pipeline continues. False: neither runs. */
static bool swap(struct view *view, struct pipeline *next)
{
    struct pipeline old = view->pipeline;
    const struct kept_shown shown = shown_of(view, old.info);
    console_capture();
    view->pipeline = *next;
    keep_live(view, &old);
    bool good = start_pipeline(view, &shown);
    char *text = console_captured();
    if (good) {
        if (text)
            fputs(text, stderr);
        free(text);
        pipeline_unload(&old);
        return true;
    }
    set_error(view, text ? text : strdup("the reason stands on the terminal\n"));
    struct pipeline refused = view->pipeline;
    view->pipeline = old;
    good = start_pipeline(view, &shown);
    pipeline_unload(&refused); /* its panels were in use until now */
    return good;
}

/* Prints one line about the reload. */
static void tell_times(const struct view *view, bool same, double made_ms, double taken_ms)
{
    if (same) {
        report_message(&view->console->log, DT_INFO,
                       "reloaded in %.0f ms: the pipeline is unchanged", view->reload_ms);
        return;
    }
    report_message(
        &view->console->log, DT_INFO,
        "reloaded in %.0f ms: checked and planned in %.0f, device %.0f, first frame %.0f",
        view->reload_ms, made_ms, view->device_ms, taken_ms - view->device_ms);
}

static bool take_reload(struct view *view, struct reload_result *result)
{
    double start_ms = milliseconds_now();
    if (result->text && *result->text)
        fputs(result->text, stderr); /* warnings */
    free(result->text);
    set_error(view, NULL);
    bool same = plan_hash(result->pipeline.plan) == plan_hash(view->pipeline.plan);
    if (same)
        pipeline_unload(&result->pipeline);
    else if (!swap(view, &result->pipeline))
        return false;
    view->reloads += !view->error;
    double taken_ms = milliseconds_now() - start_ms;
    view->reload_ms = result->ms + taken_ms;
    if (!view->error)
        tell_times(view, same, result->ms, taken_ms);
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
        return take_reload(view, &result);
    case RELOAD_FAILED:
        view->reloading = false;
        set_error(view, result.text ? result.text : strdup("out of memory\n"));
        return true;
    default:
        return true;
    }
}
