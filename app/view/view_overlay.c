/* Content of the overlay, and the summary at the end: times of every pass, live parameters, the
 * shown image, and errors of a reload. */
#include "view/view.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/live.h"
#include "console/spread.h"
#include "console/texels.h"

/* ---- Times ----------------------------------------------------------------------------------- */

bool view_times_create(struct view *view)
{
    uint32_t passes = view->pipeline.info->pass_count;
    for (uint32_t i = 0; i < view->side_count; i++) {
        struct view_times *times = &view->side[i].times;
        view_times_free(times);
        times->passes = passes;
        times->pass_ms = calloc((size_t)passes * VIEW_TIMED_FRAMES, sizeof *times->pass_ms);
        if (!times->pass_ms) {
            report_error(&view->console->log, "out of memory for times");
            return false;
        }
    }
    return true;
}

void view_times_free(struct view_times *times)
{
    free(times->pass_ms);
    *times = (struct view_times){0};
}

bool view_times_take(struct view_side *side, double frame_ms)
{
    struct view_times *times = &side->times;
    uint32_t at = times->frames++ % VIEW_TIMED_FRAMES;
    times->frame_ms[at] = frame_ms;
    return side->session.runtime->timings(side->session.handle,
                                          times->pass_ms + (size_t)at * times->passes);
}

bool view_is_skipped(const struct view *view, const struct view_side *side, uint32_t resource)
{
    const struct view_times *times = &side->times;
    uint32_t pass = view_last_writer(view->pipeline.info, resource, 0);
    uint32_t last = (times->frames - 1) % VIEW_TIMED_FRAMES;
    return pass == times->passes ||
           (times->frames && isnan(times->pass_ms[(size_t)last * times->passes + pass]));
}

static uint32_t timed_frames(const struct view_times *times)
{
    return times->frames < VIEW_TIMED_FRAMES ? times->frames : VIEW_TIMED_FRAMES;
}

static double median_of(const struct view_times *times, uint32_t pass)
{
    return spread_of(times->pass_ms + pass, timed_frames(times), times->passes).median;
}

/* ---- The model ------------------------------------------------------------------------------- */

struct texts {
    char *title, *shown, *state, *points;
};

static char *shown_text(const struct view *view)
{
    const struct dt_resource *resource = &view->pipeline.info->resources[view->resource];
    uint32_t layers = view_layers(view);
    char layer[64] = "", mip[64] = "";
    if (layers > 1 && view->layer >= 0)
        snprintf(layer, sizeof layer, ", layer %d of %u", view->layer, layers);
    else if (layers > 1)
        snprintf(layer, sizeof layer, ", all %u layers", layers);
    if (resource->mips > 1)
        snprintf(mip, sizeof mip, ", mip %u of %u", view->mip, resource->mips);
    const char *skipped =
        view_is_skipped(view, &view->side[0], view->resource) ? "\n(its pass does not run)" : "";
    return format_string("%s  %s%s%s%s", resource->name, format_info(resource->format)->name, layer,
                         mip, skipped);
}

static char *state_text(const struct view *view)
{
    static const char *const modes[] = {"side by side", "left half | right half", "difference"};
    const char *paused = !view->paused   ? ""
                         : view->gave_up ? "the device was lost again; Space tries once more  "
                                         : "paused  ";
    const char *busy = view->reloading ? "reloading" : "";
    if (view->side_count == 1)
        return format_string("%s%s", paused, busy);
    if (view->mode == VIEW_DIFFERENCE)
        return format_string("%s x %g  %s%s", modes[view->mode], (double)view->gain, paused, busy);
    return format_string("%s  %s%s", modes[view->mode], paused, busy);
}

static char *points_text(const struct view *view)
{
    if (!view->shown_points)
        return strdup("");
    return strdup(view->points[view->shown_points - 1].name);
}

/* Live parameters of up to four numbers; returns how many. */
static uint32_t fill_params(const struct view *view, struct overlay_param *params)
{
    const struct dt_pipeline *info = view->pipeline.info;
    uint32_t count = 0;
    for (uint32_t i = 0; i < info->param_count; i++) {
        const struct dt_param *param = &info->params[i];
        if (!param->live || type_components(param->type) > 4)
            continue;
        struct overlay_param *out = &params[count++];
        *out = (struct overlay_param){.name = param->name,
                                      .doc = param->doc ? param->doc : "",
                                      .is_bool = type_info(param->type)->scalar == DT_TYPE_BOOL,
                                      .is_whole = type_info(param->type)->scalar != DT_TYPE_FLOAT,
                                      .count = type_components(param->type),
                                      .min = param->min,
                                      .max = param->max,
                                      .step = param->step};
        live_get(view->pipeline.live, param, out->value);
        for (uint32_t k = 0; k < out->count; k++) /* as the live block rounds it */
            out->initial[k] = out->is_whole ? param->value[k] : (double)(float)param->value[k];
    }
    return count;
}

static void take_params(struct view *view, const struct overlay_param *params, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!params[i].changed)
            continue;
        view_set_live(view, live_param(view->pipeline.info, params[i].name), params[i].value);
        view->step = true;
    }
}

static void fill_passes(const struct view *view, struct overlay_pass *passes)
{
    const struct dt_pipeline *info = view->pipeline.info;
    for (uint32_t i = 0; i < info->pass_count; i++) {
        passes[i] = (struct overlay_pass){.name = info->passes[i].name,
                                          .doc = info->passes[i].doc ? info->passes[i].doc : ""};
        for (uint32_t k = 0; k < view->side_count; k++) {
            const struct view_times *times = &view->side[k].times;
            uint32_t last = times->frames ? (times->frames - 1) % VIEW_TIMED_FRAMES : 0;
            passes[i].ms[k] =
                times->frames ? times->pass_ms[(size_t)last * times->passes + i] : (double)NAN;
        }
    }
}

static void describe_panel(struct view *view, const struct texts *texts,
                           struct overlay_param *params, struct overlay_pass *passes)
{
    const struct dt_pipeline *info = view->pipeline.info;
    const char *doc = info->resources[view->resource].doc;
    const char *names[OVERLAY_SIDES] = {NULL};
    struct overlay_model model = {
        .hidden = view->overlay_hidden,
        .title = texts->title,
        .shown = texts->shown,
        .doc = doc ? doc : "",
        .state = texts->state,
        .points = texts->points,
        .error = view->error,
        .error_title = view->outline_wrong ? "view.yaml is wrong; the pipeline runs"
                                           : "reload failed; what was good before runs on",
        .sides = names,
        .side_count = view->side_count,
        .passes = passes,
        .pass_count = info->pass_count,
        .params = params};
    for (uint32_t i = 0; i < view->side_count; i++) {
        const struct view_times *times = &view->side[i].times;
        names[i] = view->sides.list[i].label;
        model.frame_ms[i] =
            times->frames ? times->frame_ms[(times->frames - 1) % VIEW_TIMED_FRAMES] : (double)NAN;
    }
    model.param_count = fill_params(view, params);
    fill_passes(view, passes);
    overlay_build(view->overlay, &model);
    take_params(view, params, model.param_count);
}

bool view_overlay_build(struct view *view)
{
    const struct dt_pipeline *info = view->pipeline.info;
    struct texts texts = {format_string("diptych: %s###panel", info->name), shown_text(view),
                          state_text(view), points_text(view)};
    struct overlay_param *params = calloc(info->param_count + 1, sizeof *params);
    struct overlay_pass *passes = calloc(info->pass_count + 1, sizeof *passes);
    bool good = texts.title && texts.shown && texts.state && texts.points && params && passes;
    if (good)
        describe_panel(view, &texts, params, passes);
    else
        report_error(&view->console->log, "out of memory for the overlay");
    free(passes);
    free(params);
    free(texts.title);
    free(texts.shown);
    free(texts.state);
    free(texts.points);
    return good;
}

/* ---- At the end ------------------------------------------------------------------------------ */

static cJSON *number_or_null(double value)
{
    return isnan(value) ? cJSON_CreateNull() : cJSON_CreateNumber(value);
}

static cJSON *side_json(const struct view *view, uint32_t index)
{
    const struct view_side *side = &view->side[index];
    const struct view_times *times = &side->times;
    const struct session *session = &side->session;
    cJSON *item = cJSON_CreateObject(), *passes = cJSON_CreateArray();
    cJSON_AddStringToObject(item, "backend", view->sides.list[index].label);
    cJSON_AddStringToObject(item, "device", session->runtime->device_name(session->handle));
    cJSON_AddItemToObject(
        item, "frame_ms",
        number_or_null(spread_of(times->frame_ms, timed_frames(times), 1).median));
    for (uint32_t i = 0; i < times->passes; i++) {
        cJSON *pass = cJSON_CreateObject();
        cJSON_AddStringToObject(pass, "pass", view->pipeline.info->passes[i].name);
        cJSON_AddItemToObject(pass, "ms", number_or_null(median_of(times, i)));
        cJSON_AddItemToArray(passes, pass);
    }
    cJSON_AddItemToObject(item, "passes", passes);
    return item;
}

void view_tell(const struct view *view)
{
    cJSON *root = cJSON_CreateObject(), *sides = cJSON_CreateArray();
    cJSON_AddStringToObject(root, "pipeline", view->pipeline.info->name);
    cJSON_AddStringToObject(root, "scene", view->options->setup.scene);
    cJSON_AddNumberToObject(root, "width", view->size[0]);
    cJSON_AddNumberToObject(root, "height", view->size[1]);
    cJSON_AddNumberToObject(root, "frames", view->frames);
    cJSON_AddStringToObject(root, "shown", view->pipeline.info->resources[view->resource].name);
    cJSON_AddNumberToObject(root, "reloads", view->reloads);
    cJSON_AddItemToObject(root, "reload_ms", number_or_null(view->reload_ms));
    for (uint32_t i = 0; i < view->side_count; i++)
        cJSON_AddItemToArray(sides, side_json(view, i));
    cJSON_AddItemToObject(root, "sides", sides);
    view->console->result = root;
}
