/* What the overlay is told and what it answers, times of every pass, and the summary at the end. */
#include "view/view.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/spread.h"
#include "picture/texels.h"
#include "scenes/motion.h"

/* ---- Times ----------------------------------------------------------------------------------- */

bool view_times_create(struct view *view)
{
    uint32_t passes = view->pipeline.info->pass_count;
    for (uint32_t i = 0; i < view->side_count; i++) {
        struct view_times *times = &view->side[i].times;
        view_times_free(times);
        times->passes = passes;
        times->pass_ms = calloc((size_t)passes * VIEW_TIMED_FRAMES, sizeof *times->pass_ms);
        if (!times->pass_ms)
            return report_error(&view->console->log, "out of memory for times");
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

static uint32_t timed_frames(const struct view_times *times)
{
    return times->frames < VIEW_TIMED_FRAMES ? times->frames : VIEW_TIMED_FRAMES;
}

static double pass_median(const struct view_times *times, uint32_t pass)
{
    return median_of(times->pass_ms + pass, timed_frames(times), times->passes);
}

/* ---- The model ------------------------------------------------------------------------------- */

static char *state_text(const struct view *view)
{
    const char *paused = !view->paused   ? ""
                         : view->gave_up ? "the device was lost again; Space tries once more  "
                                         : "paused  ";
    return format_string("%s%s%s", paused, view->reloading ? "reloading  " : "",
                         view->bisecting ? "bisecting" : "");
}

static char *title_text(const struct view *view)
{
    const char *scene = view->options->setup.scene, *slash = scene ? strrchr(scene, '/') : NULL;
    return format_string("%s%s%s   %ux%u", view->pipeline.info->name, scene ? ", " : "",
                         slash   ? slash + 1
                         : scene ? scene
                                 : "",
                         view->size[0], view->size[1]);
}

/* The last frame that was not checked. */
static double last_frame_ms(const struct view_times *times)
{
    for (uint32_t i = 1; i <= timed_frames(times); i++) {
        double ms = times->frame_ms[(times->frames - i) % VIEW_TIMED_FRAMES];
        if (!isnan(ms))
            return ms;
    }
    return (double)NAN;
}

static void fill_side(const struct view *view, uint32_t index, struct overlay_side *side)
{
    const struct view_side *from = &view->side[index];
    const struct session *session = &from->session;
    const struct view_times *times = &from->times;
    uint32_t last = times->frames ? (times->frames - 1) % VIEW_TIMED_FRAMES : 0;
    *side = (struct overlay_side){
        .label = view->sides.list[index].label,
        .device = session->runtime->device(session->handle)->name,
        .pass_ms = times->frames ? times->pass_ms + (size_t)last * times->passes : NULL,
        .frame_ms = last_frame_ms(times),
        .bytes = &from->shown,
        .texture = gl_window_texture(view->screen, index),
        .flipped = view->direct && !view->pipeline.info->resources[view->shown.resource].top};
}

static void fill_log(struct view *view, struct overlay_model *model)
{
    struct view_log *log = &view->log;
    pthread_mutex_lock(&log->lock);
    if (log->lines != log->seen_lines) {
        free(log->seen);
        log->seen = strdup(log->text);
        log->seen_lines = log->lines;
    }
    pthread_mutex_unlock(&log->lock);
    model->log = log->seen ? log->seen : "";
    model->log_size = log->seen_lines;
}

/* The texel under the pointer is read, even where the picture stays on the device. */
static bool read_pointed(struct view *view)
{
    bool wanted = overlay_is_pointing(view->overlay) || view->shown.marked ||
                  view->pipeline.info->resources[view->shown.resource].kind == DT_BUFFER;
    for (uint32_t i = 0; wanted && view->frames && i < view->side_count; i++)
        if (!view_read(view, &view->side[i]))
            return false;
    return true;
}

/* A mip is shown after the last pass that writes it; a row of the list, after its own. */
static void heed_choice(struct view *view, const struct overlay_shown *before)
{
    struct overlay_shown *shown = &view->shown;
    uint32_t pass = view_last_writer(view->pipeline.info, shown->resource, shown->mip);
    if (shown->mip != before->mip && shown->resource == before->resource &&
        shown->pass == before->pass && pass < view->pipeline.info->pass_count)
        shown->pass = pass;
    if (shown->layer >= (int)view_layers(view)) /* mips of a 3D image have fewer */
        shown->layer = -1;
}

static bool describe(struct view *view, const char *title, const char *state, const char *changes)
{
    const struct view_verdict *verdict = &view->verdict;
    const struct overlay_shown before = view->shown;
    bool judged = verdict->known && view->side_count > 1;
    uint32_t moment = view->present_moment;
    struct overlay_model model = {
        .settings = &view->settings,
        .shown = &view->shown,
        .params = view->params.list,
        .param_count = view->params.count,
        .title = title,
        .verdict = view->side_count < 2 ? "one backend: nothing to compare with"
                   : verdict->known     ? verdict->text
                                        : "comparing ...",
        .mark = judged ? verdict->worst : OVERLAY_UNKNOWN,
        .stale = judged && verdict->stale,
        .row_mark = judged ? verdict->marks : NULL,
        .info = view->pipeline.info,
        .rows = &verdict->rows,
        .side_count = view->side_count,
        .state = state,
        .error = view->error,
        .error_title = "reload failed; what was good before runs on",
        .why = verdict->worst == OVERLAY_DIFFERS ? verdict->why : NULL,
        .undefined =
            view->options->setup.sanitize ? (verdict->undefined ? verdict->undefined : "") : NULL,
        .changes = changes,
        .slot = view->params.slot,
        .paused = view->paused,
        .moments = view->scene.motion ? motion_frames(view->scene.motion) : 0,
        .moment = &moment,
        .moving = &view->moving};
    for (uint32_t i = 0; i < view->side_count; i++)
        fill_side(view, i, &model.sides[i]);
    fill_log(view, &model);
    resource_extent(view->pipeline.info, view->shown.resource, view->size, view->shown.mip,
                    model.extent);
    overlay_build(view->overlay, &model);
    heed_choice(view, &before);
    if (moment != view->present_moment) {
        view->moment = moment;
        view->moving = true;
    }
    view->wishes |= model.wishes;
    return view_params_apply(view);
}

bool view_overlay_build(struct view *view)
{
    char *title = title_text(view), *state = state_text(view);
    char *changes = view_params_text(view, "--set ", " ", true, true);
    bool good = title && state && changes;
    if (!good)
        report_error(&view->console->log, "out of memory for the overlay");
    good = good && read_pointed(view) && describe(view, title, state, changes);
    free(title);
    free(state);
    free(changes);
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
    cJSON_AddStringToObject(item, "device", session->runtime->device(session->handle)->name);
    cJSON_AddItemToObject(item, "frame_ms",
                          number_or_null(median_of(times->frame_ms, timed_frames(times), 1)));
    for (uint32_t i = 0; i < times->passes; i++) {
        cJSON *pass = cJSON_CreateObject();
        cJSON_AddStringToObject(pass, "pass", view->pipeline.info->passes[i].name);
        cJSON_AddItemToObject(pass, "ms", number_or_null(pass_median(times, i)));
        cJSON_AddItemToArray(passes, pass);
    }
    cJSON_AddItemToObject(item, "passes", passes);
    return item;
}

void view_tell(struct view *view)
{
    cJSON *root = cJSON_CreateObject(), *sides = cJSON_CreateArray();
    cJSON_AddStringToObject(root, "pipeline", view->pipeline.info->name);
    cJSON_AddStringToObject(root, "scene", view->options->setup.scene);
    cJSON_AddNumberToObject(root, "width", view->size[0]);
    cJSON_AddNumberToObject(root, "height", view->size[1]);
    cJSON_AddNumberToObject(root, "frames", view->frames);
    cJSON_AddStringToObject(root, "shown",
                            view->pipeline.info->resources[view->shown.resource].name);
    char *changes = view_params_text(view, "", " ", true, true);
    cJSON_AddStringToObject(root, "changes", changes);
    free(changes);
    if (view->verdict.worst == OVERLAY_DIFFERS && view->verdict.why)
        cJSON_AddStringToObject(root, "why", view->verdict.why);
    cJSON_AddStringToObject(root, "undefined", view->verdict.undefined);
    if (view->verdict.known && view->side_count > 1)
        cJSON_AddStringToObject(root, "verdict", view->verdict.text);
    cJSON_AddNumberToObject(root, "reloads", view->reloads);
    cJSON_AddItemToObject(root, "reload_ms", number_or_null(view->reload_ms));
    for (uint32_t i = 0; i < view->side_count; i++)
        cJSON_AddItemToArray(sides, side_json(view, i));
    cJSON_AddItemToObject(root, "sides", sides);
    view->console->result = root;
}
