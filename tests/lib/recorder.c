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

static bool note(struct recorder *r, enum dt_verb verb, uint32_t pass, const uint32_t a[4],
                 const struct dt_barrier *list)
{
    add(r,
        (struct recorder_note){.verb = verb, .pass = pass, .arguments = {a[0], a[1], a[2], a[3]}});
    for (uint32_t i = 0; list && i < a[0]; i++)
        add(r, (struct recorder_note){.verb = RECORDER_BARRIER, .pass = pass, .barrier = list[i]});
    return ++r->calls != r->fail_at;
}

/* ---- Verbs: their parameters and the numbers in them, by form -------------------------------- */

#define PARAMETERS_0
#define PARAMETERS_1        , uint32_t a
#define PARAMETERS_2        PARAMETERS_1, uint32_t b
#define PARAMETERS_3        PARAMETERS_2, uint32_t c
#define PARAMETERS_FLAG     , bool a
#define PARAMETERS_BARRIERS , const struct dt_barrier *list, uint32_t a
#define PARAMETERS_RECT     , struct dt_rect a
#define NUMBERS_0           {0}, NULL
#define NUMBERS_1           {a}, NULL
#define NUMBERS_2           {a, b}, NULL
#define NUMBERS_3           {a, b, c}, NULL
#define NUMBERS_FLAG        {a}, NULL
#define NUMBERS_BARRIERS    {a}, list
#define NUMBERS_RECT        {(uint32_t)a.x, (uint32_t)a.y, a.width, a.height}, NULL

#define NOTE(ENUMERATOR, ...) note(r, DT_VERB_##ENUMERATOR, pass, (const uint32_t[4])__VA_ARGS__)
#define DT_VERB(ENUMERATOR, member, form, ...)                                                     \
    static bool member(void *r, uint32_t pass PARAMETERS_##form)                                   \
    {                                                                                              \
        return NOTE(ENUMERATOR, NUMBERS_##form);                                                   \
    }
#include "verbs.def"

static const struct dt_verbs verbs = {
#define DT_VERB(ENUMERATOR, member, ...) .member = member,
#include "verbs.def"
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
    const struct recorder_note *n = &recorder->notes[note];
    size_t used = 0;
    if (n->verb == RECORDER_BARRIER) {
        barrier_line(recorder, n, line, size);
        return;
    }
    const struct dt_verb_info *verb = dt_verb_info((enum dt_verb)n->verb);
    used += (size_t)snprintf(line, size, "%s %s (%u)", verb->name, pass_name(recorder, n->pass),
                             n->pass);
    for (int i = 0; i < 4 && verb->arguments[i] && used < size; i++) {
        const char *form = verb->arguments[i];
        uint32_t value = n->arguments[i];
        used += (size_t)(*form == '%' ? snprintf(line + used, size - used, ", %s %s (%u)", form + 1,
                                                 resource_name(recorder, value), value)
                                      : snprintf(line + used, size - used, ", %s %u", form, value));
    }
}

/* ---- Comparison ------------------------------------------------------------------------------ */

_Static_assert(sizeof(struct recorder_note) == 6 * sizeof(uint32_t) + sizeof(struct dt_barrier) &&
                   sizeof(struct dt_barrier) == 12,
               "no padding");

uint32_t recorder_difference(const struct recorder *a, const struct recorder *b)
{
    uint32_t least = a->count < b->count ? a->count : b->count;
    for (uint32_t i = 0; i < least; i++)
        if (memcmp(&a->notes[i], &b->notes[i], sizeof *a->notes))
            return i;
    return a->count == b->count ? UINT32_MAX : least;
}
