/* Whether the sides agree: in some frames, all that passes write is read on every side and measured
 * under the spec's contracts, as `compare` does. */
#include "view/view.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "picture/texels.h"
#include "theirs/why.h"

/* Least milliseconds between two checks: after a change, and while only time goes on. */
enum { SOON_MS = 250, LATER_MS = 2000 };

bool view_verdict_create(struct view *view)
{
    struct view_verdict *verdict = &view->verdict;
    const struct dt_log *log = &view->console->log;
    view_verdict_free(verdict);
    if (!rows_make(&verdict->rows, view->pipeline.info, log))
        return false;
    uint32_t count = verdict->rows.outputs.count;
    verdict->kept = calloc(count + 1, sizeof *verdict->kept);
    verdict->marks = calloc(count + 1, sizeof *verdict->marks);
    verdict->first = count;
    return (verdict->kept && verdict->marks) || report_error(log, "out of memory");
}

static void forget(struct view_verdict *verdict)
{
    for (uint32_t i = 0; verdict->kept && i < verdict->rows.outputs.count; i++) {
        free(verdict->kept[i].data);
        verdict->kept[i] = (struct dt_bytes){0};
    }
}

void view_verdict_free(struct view_verdict *verdict)
{
    forget(verdict);
    free(verdict->undefined);
    free(verdict->why);
    free(verdict->kept);
    free(verdict->marks);
    rows_free(&verdict->rows);
    *verdict = (struct view_verdict){0};
}

void view_verdict_begin(struct view *view)
{
    struct view_verdict *verdict = &view->verdict;
    uint32_t last = view->options->run_frames;
    double now = milliseconds_now();
    verdict->stale |= view->step;
    bool soon = verdict->stale || !verdict->known;
    double least = soon ? SOON_MS : LATER_MS;
    double pause = verdict->cost * (soon ? 2 : 10);
    bool due = now - verdict->checked > (pause > least ? pause : least) && view->frame > 0;
    bool wanted = view->paused || (last && view->frames + 1 >= last);
    verdict->wanted = wanted;
    verdict->checking = (view->side_count > 1 || view->options->setup.sanitize) && (due || wanted);
    if (!verdict->checking)
        return;
    forget(verdict);
    memset(verdict->marks, 0, verdict->rows.outputs.count * sizeof *verdict->marks);
    verdict->first = verdict->rows.outputs.count;
    free(verdict->why);
    verdict->why = NULL;
    verdict->checked = now; /* the start, until the end is known */
}

/* What makes the copies equal or nearer. Takes seconds: only while the picture stands still. */
static bool ask_why(struct view *view, uint32_t side, const struct dt_resource *resource,
                    const struct dt_bytes copies[2])
{
    const struct why_question question = {
        .resource = resource,
        .copies = copies,
        .labels = {view->sides.list[0].label, view->sides.list[side].label}};
    struct text text = {0};
    cJSON *answer = view->verdict.wanted ? why_ask(&question, view->console) : NULL;
    const cJSON *list = cJSON_GetObjectItem(answer, "why"), *reason;
    cJSON_ArrayForEach(reason, list)
        text_add(&text, "why: %s\n", cJSON_GetStringValue(cJSON_GetObjectItem(reason, "text")));
    cJSON_Delete(answer);
    free(view->verdict.why);
    view->verdict.why = text.data;
    return !text.failed;
}

static bool measure_shown(struct view *view, uint32_t side, uint32_t index,
                          const struct dt_bytes *bytes)
{
    static const enum overlay_mark marks[] = {[VERDICT_EQUAL] = OVERLAY_EQUAL,
                                              [VERDICT_WITHIN] = OVERLAY_WITHIN,
                                              [VERDICT_NOT_FINITE] = OVERLAY_DIFFERS,
                                              [VERDICT_DIFFERS] = OVERLAY_DIFFERS};
    struct view_verdict *verdict = &view->verdict;
    const struct row *row = &verdict->rows.outputs.list[index];
    const struct dt_bytes copies[2] = {verdict->kept[index], *bytes};
    const struct dt_resource *resource = &view->pipeline.info->resources[row->resource];
    struct difference difference;
    bool good = difference_measure(&difference, resource, view->frame, copies);
    enum overlay_mark mark = marks[difference_verdict(&difference)];
    verdict->marks[index] = mark > verdict->marks[index] ? mark : verdict->marks[index];
    if (mark == OVERLAY_DIFFERS && index < verdict->first) {
        verdict->first = index;
        verdict->largest = difference;
        verdict->side = side;
        good = good && (difference.size_differs || ask_why(view, side, resource, copies));
    }
    return good || report_error(&view->console->log, "out of memory");
}

bool view_verdict_take(struct view *view, uint32_t side, uint32_t pass)
{
    struct view_verdict *verdict = &view->verdict;
    const struct session *session = &view->side[side].session;
    const uint32_t *first = verdict->rows.outputs.first;
    for (uint32_t i = first[pass]; i < first[pass + 1]; i++) {
        const struct row *row = &verdict->rows.outputs.list[i];
        struct dt_bytes bytes = {0};
        if (!session->runtime->read(session->handle, row->resource, row->mip, &bytes))
            return false;
        if (side == 0) {
            verdict->kept[i] = bytes;
            continue;
        }
        bool good = measure_shown(view, side, i, &bytes);
        free(bytes.data);
        if (!good)
            return false;
    }
    return true;
}

/* With commas between thousands. */
static void count_text(char text[32], uint64_t count)
{
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)count), used = 0;
    for (int i = 0; i < length; i++) {
        if (i && (length - i) % 3 == 0)
            text[used++] = ',';
        text[used++] = digits[i];
    }
    text[used] = 0;
}

static void tell_difference(struct view *view)
{
    struct view_verdict *verdict = &view->verdict;
    const struct dt_pipeline *info = view->pipeline.info;
    const struct row *row = &verdict->rows.outputs.list[verdict->first];
    const struct dt_resource *resource = &info->resources[row->resource];
    const struct difference *largest = &verdict->largest;
    bool equal = !largest->differing; /* of NaN or Inf */
    uint64_t number = equal ? largest->not_finite : largest->differing;
    const char *what = equal ? "number" : resource->kind == DT_BUFFER ? "element" : "texel";
    char count[32], who[128] = "differs";
    char *place = element_place(resource, largest->extent, largest->worst.element);
    count_text(count, number);
    if (equal)
        snprintf(who, sizeof who, "NaN or Inf");
    else if (view->side_count > 2)
        snprintf(who, sizeof who, "%s and %s differ", view->sides.list[0].label,
                 view->sides.list[verdict->side].label);
    snprintf(verdict->text, sizeof verdict->text, "%s: first pass %s, %s, %s %s%s, largest at %s",
             who, info->passes[row->pass].name, row->name, count, what, number == 1 ? "" : "s",
             place ? place : "?");
    free(place);
}

/* --sanitize: reads what the frames have found on every side. */
static bool find_undefined(struct view *view)
{
    const struct dt_log *log = &view->console->log;
    struct undefined found = {0};
    struct text text = {0};
    bool good = true;
    for (uint32_t i = 0; i < view->side_count && good; i++) {
        const struct session *session = &view->side[i].session;
        struct dt_bytes bytes = {0};
        good =
            session->runtime->read(session->handle, plan_reports(view->pipeline.plan), 0, &bytes) &&
            undefined_add(&found, &view->pipeline, i, &bytes, log);
        free(bytes.data);
    }
    if (good)
        undefined_text(&found, &text);
    undefined_free(&found);
    free(view->verdict.undefined);
    view->verdict.undefined = text.data;
    return good;
}

bool view_verdict_end(struct view *view)
{
    struct view_verdict *verdict = &view->verdict;
    uint32_t count = verdict->rows.outputs.count, equal = 0, within = 0;
    if (!verdict->checking)
        return true;
    for (uint32_t i = 0; i < count; i++) {
        equal += verdict->marks[i] == OVERLAY_EQUAL;
        within += verdict->marks[i] == OVERLAY_WITHIN;
    }
    verdict->worst = verdict->first < count ? OVERLAY_DIFFERS
                     : within               ? OVERLAY_WITHIN
                                            : OVERLAY_EQUAL;
    if (verdict->worst == OVERLAY_DIFFERS)
        tell_difference(view);
    else if (within)
        snprintf(verdict->text, sizeof verdict->text,
                 "within the contracts: %u equal, %u within, of %u", equal, within, count);
    else
        snprintf(verdict->text, sizeof verdict->text, "equal, %u of %u", equal, count);
    forget(verdict);
    verdict->known = true;
    verdict->stale = verdict->checking = false;
    verdict->cost = milliseconds_now() - verdict->checked;
    verdict->checked += verdict->cost;
    return !view->options->setup.sanitize || find_undefined(view);
}

void view_show_first(struct view *view)
{
    const struct view_verdict *verdict = &view->verdict;
    uint32_t count = verdict->rows.outputs.count, index = verdict->first;
    for (uint32_t i = 0; index >= count && i < count; i++)
        index = verdict->marks[i] == OVERLAY_WITHIN ? i : count;
    if (index >= count)
        return;
    const struct row *row = &verdict->rows.outputs.list[index];
    if (row->resource != view->shown.resource || row->mip != view->shown.mip)
        view_show(view, row->resource);
    view->shown.pass = row->pass;
    view->shown.mip = row->mip;
    view->shown.layer = -1;
    view->shown.marked = index == verdict->first && verdict->largest.worst.valid;
    view->shown.texel = verdict->largest.worst.element;
    view->step = true;
}
