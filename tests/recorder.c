/* See recorder.h. */
#include "recorder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Notes ----------------------------------------------------------------------------------- */

static void add(struct recorder *r, struct recorder_note note)
{
    if (r->count == r->capacity) {
        r->capacity = r->capacity ? 2 * r->capacity : 64;
        r->notes = realloc(r->notes, r->capacity * sizeof *r->notes);
        if (!r->notes)
            abort();
    }
    r->notes[r->count++] = note;
}

static bool note(void *runtime, enum recorder_verb verb, uint32_t pass, uint32_t a, uint32_t b,
                 uint32_t c)
{
    struct recorder *r = runtime;
    add(r, (struct recorder_note){.verb = verb, .pass = pass, .arguments = {a, b, c}});
    return ++r->calls != r->fail_at;
}

/* ---- Verbs ----------------------------------------------------------------------------------- */

static bool begin(void *runtime, uint32_t pass, bool runs)
{
    return note(runtime, RECORDER_BEGIN, pass, runs, 0, 0);
}

static bool barriers(void *runtime, uint32_t pass, const struct dt_barrier *list, uint32_t count)
{
    bool good = note(runtime, RECORDER_BARRIERS, pass, count, 0, 0);
    for (uint32_t i = 0; i < count; i++)
        add(runtime,
            (struct recorder_note){.verb = RECORDER_BARRIER, .pass = pass, .barrier = list[i]});
    return good;
}

static bool bind(void *runtime, uint32_t pass)
{
    return note(runtime, RECORDER_BIND, pass, 0, 0, 0);
}

static bool dispatch(void *runtime, uint32_t pass, uint32_t x, uint32_t y, uint32_t z)
{
    return note(runtime, RECORDER_DISPATCH, pass, x, y, z);
}

static bool dispatch_indirect(void *runtime, uint32_t pass, uint32_t arguments)
{
    return note(runtime, RECORDER_DISPATCH_INDIRECT, pass, arguments, 0, 0);
}

static bool draw_scene(void *runtime, uint32_t pass, uint32_t layers)
{
    return note(runtime, RECORDER_DRAW_SCENE, pass, layers, 0, 0);
}

static bool draw_indirect(void *runtime, uint32_t pass, uint32_t layers, uint32_t indices,
                          uint32_t arguments)
{
    return note(runtime, RECORDER_DRAW_INDIRECT, pass, layers, indices, arguments);
}

static bool draw_fullscreen(void *runtime, uint32_t pass, uint32_t layers)
{
    return note(runtime, RECORDER_DRAW_FULLSCREEN, pass, layers, 0, 0);
}

static bool draw_vertices(void *runtime, uint32_t pass, uint32_t layers, uint32_t vertices,
                          uint32_t instances)
{
    return note(runtime, RECORDER_DRAW_VERTICES, pass, layers, vertices, instances);
}

static bool draw_vertices_indirect(void *runtime, uint32_t pass, uint32_t layers,
                                   uint32_t arguments)
{
    return note(runtime, RECORDER_DRAW_VERTICES_INDIRECT, pass, layers, arguments, 0);
}

static bool note_rect(void *runtime, enum recorder_verb verb, uint32_t pass, struct dt_rect rect)
{
    struct recorder *r = runtime;
    bool good = note(runtime, verb, pass, (uint32_t)rect.x, (uint32_t)rect.y, rect.width);
    r->notes[r->count - 1].arguments[3] = rect.height;
    return good;
}

static bool viewport(void *runtime, uint32_t pass, struct dt_rect rect)
{
    return note_rect(runtime, RECORDER_VIEWPORT, pass, rect);
}

static bool scissor(void *runtime, uint32_t pass, struct dt_rect rect)
{
    return note_rect(runtime, RECORDER_SCISSOR, pass, rect);
}

static bool clear_targets(void *runtime, uint32_t pass, uint32_t layers)
{
    return note(runtime, RECORDER_CLEAR_TARGETS, pass, layers, 0, 0);
}

static bool clear_buffer(void *runtime, uint32_t pass, uint32_t resource)
{
    return note(runtime, RECORDER_CLEAR_BUFFER, pass, resource, 0, 0);
}

static bool clear_image(void *runtime, uint32_t pass, uint32_t resource, uint32_t mip)
{
    return note(runtime, RECORDER_CLEAR_IMAGE, pass, resource, mip, 0);
}

static bool end(void *runtime, uint32_t pass)
{
    return note(runtime, RECORDER_END, pass, 0, 0, 0);
}

static const struct dt_verbs verbs = {
    .begin = begin,
    .barriers = barriers,
    .bind = bind,
    .dispatch = dispatch,
    .dispatch_indirect = dispatch_indirect,
    .draw_scene = draw_scene,
    .draw_indirect = draw_indirect,
    .draw_fullscreen = draw_fullscreen,
    .draw_vertices = draw_vertices,
    .draw_vertices_indirect = draw_vertices_indirect,
    .viewport = viewport,
    .scissor = scissor,
    .clear_targets = clear_targets,
    .clear_buffer = clear_buffer,
    .clear_image = clear_image,
    .end = end,
};

bool recorder_run(struct recorder *recorder, const struct dt_panel *panel, uint32_t width,
                  uint32_t height, const void *live)
{
    const struct dt_recording recording = {.verbs = &verbs,
                                           .runtime = recorder,
                                           .width = width,
                                           .height = height,
                                           .live = live ? live : panel->pipeline->live_defaults,
                                           .panel = panel};
    recorder->panel = panel;
    recorder->count = recorder->calls = 0;
    return panel->record(&recording);
}

void recorder_free(struct recorder *recorder)
{
    free(recorder->notes);
    *recorder = (struct recorder){0};
}

/* ---- Text ------------------------------------------------------------------------------------ */

static const char *pass_name(const struct recorder *r, uint32_t pass)
{
    const struct dt_pipeline *pipeline = r->panel->pipeline;
    return pass < pipeline->pass_count ? pipeline->passes[pass].name : "?";
}

static const char *resource_name(const struct recorder *r, uint32_t resource)
{
    const struct dt_pipeline *pipeline = r->panel->pipeline;
    return resource < pipeline->resource_count ? pipeline->resources[resource].name
           : resource == DT_SCENE_INDICES      ? "scene indices"
                                               : "?";
}

static void barrier_line(const struct recorder *r, const struct recorder_note *n, char *line,
                         size_t size)
{
    const struct dt_barrier *b = &n->barrier;
    snprintf(line, size,
             "  barrier %s (%u): stages 0x%x to 0x%x, accesses 0x%x to 0x%x, layout %u, %s",
             resource_name(r, b->resource), b->resource, b->from_stages, b->to_stages, b->from,
             b->to, b->layout, b->discard ? "discard" : "keep");
}

void recorder_line(const struct recorder *recorder, uint32_t note, char *line, size_t size)
{
    static const struct {
        const char *verb, *arguments[4]; /* %: a resource */
    } forms[] = {
        [RECORDER_BEGIN] = {"begin", {"runs"}},
        [RECORDER_BARRIERS] = {"barriers", {"count"}},
        [RECORDER_BIND] = {"bind", {NULL}},
        [RECORDER_DISPATCH] = {"dispatch", {"x", "y", "z"}},
        [RECORDER_DISPATCH_INDIRECT] = {"dispatch_indirect", {"%arguments"}},
        [RECORDER_DRAW_SCENE] = {"draw_scene", {"layers"}},
        [RECORDER_DRAW_INDIRECT] = {"draw_indirect", {"layers", "%indices", "%arguments"}},
        [RECORDER_DRAW_FULLSCREEN] = {"draw_fullscreen", {"layers"}},
        [RECORDER_DRAW_VERTICES] = {"draw_vertices", {"layers", "vertices", "instances"}},
        [RECORDER_DRAW_VERTICES_INDIRECT] = {"draw_vertices_indirect", {"layers", "%arguments"}},
        [RECORDER_VIEWPORT] = {"viewport", {"x", "y", "width", "height"}},
        [RECORDER_SCISSOR] = {"scissor", {"x", "y", "width", "height"}},
        [RECORDER_CLEAR_TARGETS] = {"clear_targets", {"layers"}},
        [RECORDER_CLEAR_BUFFER] = {"clear_buffer", {"%resource"}},
        [RECORDER_CLEAR_IMAGE] = {"clear_image", {"%resource", "mip"}},
        [RECORDER_END] = {"end", {NULL}},
    };
    const struct recorder_note *n = &recorder->notes[note];
    size_t used = 0;
    if (n->verb == RECORDER_BARRIER) {
        barrier_line(recorder, n, line, size);
        return;
    }
    used += (size_t)snprintf(line, size, "%s %s (%u)", forms[n->verb].verb,
                             pass_name(recorder, n->pass), n->pass);
    for (int i = 0; i < 4 && forms[n->verb].arguments[i] && used < size; i++) {
        const char *form = forms[n->verb].arguments[i];
        uint32_t value = n->arguments[i];
        used += (size_t)(*form == '%' ? snprintf(line + used, size - used, ", %s %s (%u)", form + 1,
                                                 resource_name(recorder, value), value)
                                      : snprintf(line + used, size - used, ", %s %u", form, value));
    }
}

/* ---- Comparison ------------------------------------------------------------------------------ */

static bool same_barrier(const struct dt_barrier *a, const struct dt_barrier *b)
{
    return a->resource == b->resource && a->from_stages == b->from_stages && a->from == b->from &&
           a->to_stages == b->to_stages && a->to == b->to && a->layout == b->layout &&
           a->discard == b->discard;
}

static bool same_note(const struct recorder_note *a, const struct recorder_note *b)
{
    return a->verb == b->verb && a->pass == b->pass &&
           memcmp(a->arguments, b->arguments, sizeof a->arguments) == 0 &&
           same_barrier(&a->barrier, &b->barrier);
}

uint32_t recorder_difference(const struct recorder *a, const struct recorder *b)
{
    uint32_t least = a->count < b->count ? a->count : b->count;
    for (uint32_t i = 0; i < least; i++)
        if (!same_note(&a->notes[i], &b->notes[i]))
            return i;
    return a->count == b->count ? UINT32_MAX : least;
}
