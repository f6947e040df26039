/* See elsewhere.h. */
#include "compare/elsewhere.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/text.h"
#include "compare/blame.h"
#include "device_needs.h"

static cJSON *add_elsewhere(struct elsewhere *elsewhere, const char *kind, const char *pass,
                            char *message)
{
    cJSON *item = cJSON_CreateObject();
    if (!elsewhere->list)
        elsewhere->list = cJSON_CreateArray();
    cJSON_AddStringToObject(item, "kind", kind);
    cJSON_AddStringToObject(item, "pass", pass);
    bool good = message && cJSON_AddStringToObject(item, "message", message);
    free(message);
    if (good && cJSON_AddItemToArray(elsewhere->list, item))
        return item;
    cJSON_Delete(item);
    return NULL;
}

/* ---- Limits ---------------------------------------------------------------------------------- */

static const struct {
    const char *what;
    uint64_t promised; /* by the profile VP_KHR_roadmap_2022 */
} promises[DT_LIMITS] = {
#define ROW(name, words, vk, gl, gl_draw, index, roadmap, ...) [DT_LIMIT_##name] = {words, roadmap},
    DT_DEVICE_LIMITS(ROW)
#undef ROW
};

static bool add_limit(struct elsewhere *elsewhere, const struct dt_panel *panel, int limit)
{
    struct text passes = {0};
    uint64_t most = 0;
    for (uint32_t pass = 0; pass < panel->pipeline->pass_count; pass++) {
        uint64_t needed = dt_demand_of(panel, pass, (enum dt_device_limit)limit);
        most = needed > most ? needed : most;
        if (needed > promises[limit].promised)
            text_add(&passes, "%s%s", passes.length ? ", " : "",
                     panel->pipeline->passes[pass].name);
    }
    bool good = !passes.failed &&
                (!passes.length ||
                 add_elsewhere(
                     elsewhere, "limit", passes.data,
                     format_string("%" PRIu64 " %s, where Vulkan's Roadmap 2022 promises %" PRIu64,
                                   most, promises[limit].what, promises[limit].promised)));
    text_free(&passes);
    return good;
}

bool elsewhere_add_limits(struct elsewhere *elsewhere, const struct dt_panel *panel,
                          const struct dt_log *log)
{
    for (int limit = 0; limit < DT_LIMITS; limit++)
        if (!add_limit(elsewhere, panel, limit))
            return report_error(log, "out of memory");
    return true;
}

/* ---- Repeated runs --------------------------------------------------------------------------- */

/* Adds what the pass, after which the worker has stopped, has left. */
static bool add_outputs(struct worker *worker, const struct rows *rows, uint32_t pass,
                        uint64_t *hash)
{
    const struct row_list *outputs = &rows->outputs;
    for (uint32_t i = outputs->first[pass]; i < outputs->first[pass + 1]; i++) {
        const struct row *row = &outputs->list[i];
        struct dt_bytes bytes;
        uint64_t own;
        if (!worker_read(worker, row->resource, row->mip, &bytes))
            return false;
        if (!fingerprint(&rows->pipeline->resources[row->resource], &bytes, &own))
            return report_error(&worker->info.session.console->log, "out of memory");
        hash_bytes(hash, &own, sizeof own);
    }
    return true;
}

/* hashes: one per pass. */
static bool run_once(const struct worker_info *info, const struct rows *rows, uint64_t *hashes)
{
    struct worker worker = {0};
    struct worker_place place = {0};
    bool good = worker_start(&worker, info);
    for (uint32_t pass = 0; pass < rows->pipeline->pass_count; pass++)
        hashes[pass] = FILE_HASH_START;
    do {
        good = good && worker_wait(&worker, &place);
        if (good && place.stop == WORKER_AFTER_PASS)
            good = add_outputs(&worker, rows, place.pass, &hashes[place.pass]);
        if (good && place.stop != WORKER_FINISHED)
            good = worker_resume(&worker, DT_RUN);
    } while (good && place.stop != WORKER_FINISHED);
    worker_close(&worker);
    return good;
}

/* Of the runs' hashes of one pass. */
static uint32_t count_distinct(const uint64_t *hashes, uint32_t runs, uint32_t stride)
{
    uint32_t distinct = 0;
    for (uint32_t i = 0; i < runs; i++) {
        uint32_t k = 0;
        while (hashes[(size_t)k * stride] != hashes[(size_t)i * stride])
            k++;
        distinct += k == i;
    }
    return distinct;
}

static bool add_repeats(struct elsewhere *elsewhere, const struct worker_info *worker,
                        const struct rows *rows, const uint64_t *hashes, uint32_t runs)
{
    uint32_t passes = rows->pipeline->pass_count;
    const char *side = worker->session.side->label;
    for (uint32_t pass = 0; pass < passes; pass++) {
        uint32_t distinct = count_distinct(hashes + pass, runs, passes);
        if (distinct < 2)
            continue;
        cJSON *item = add_elsewhere(
            elsewhere, "repeat", rows->pipeline->passes[pass].name,
            format_string("%u distinct results in %u runs, on %s", distinct, runs, side));
        if (!item)
            return false;
        cJSON_AddStringToObject(item, "side", side);
        cJSON_AddNumberToObject(item, "runs", runs);
        cJSON_AddNumberToObject(item, "distinct", distinct);
        elsewhere->repeats_differ = true;
    }
    return true;
}

bool elsewhere_repeat(struct elsewhere *elsewhere, const struct worker_info *worker,
                      const struct rows *rows, uint32_t runs)
{
    static const uint32_t threads[] = {1, 2, 8, 3, 16, 5};
    struct worker_info info = *worker;
    struct console *console = info.session.console;
    uint64_t *hashes = calloc((size_t)runs * rows->pipeline->pass_count + 1, sizeof *hashes);
    bool good = hashes;
    info.first_observed = 0;
    info.stops_before = 0;
    info.quiet = true;
    for (uint32_t i = 0; i < runs && good; i++) {
        console_status(console, "%s: run %u of %u", info.session.side->label, i + 1, runs);
        info.threads = threads[i % DT_ARRAY_COUNT(threads)];
        good = run_once(&info, rows, hashes + (size_t)i * rows->pipeline->pass_count);
    }
    if (good && !add_repeats(elsewhere, worker, rows, hashes, runs))
        report_error(&console->log, "out of memory");
    else if (!hashes)
        report_error(&console->log, "out of memory");
    free(hashes);
    return good && atomic_load(&console->errors) == 0;
}

/* ---- Missing barriers ------------------------------------------------------------------------ */

/* The log of a worker whose validation layer is heard. */
struct hearing {
    struct elsewhere *elsewhere;
    const struct dt_pipeline *pipeline;
    const char *side;
    struct dt_log other; /* what is no hazard */
    bool failed;
};

/* Whether a message of the layer names an object so: [name]. */
static bool names(const char *message, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = strchr(message, '['); at; at = strchr(at + 1, '['))
        if (!strncmp(at + 1, name, length) && at[1 + length] == ']')
            return true;
    return false;
}

static bool is_listed(const struct elsewhere *elsewhere, const char *message)
{
    const cJSON *item = elsewhere->list ? elsewhere->list->child : NULL;
    while (item && strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(item, "message")), message) != 0)
        item = item->next;
    return item;
}

static void add_barrier(struct hearing *hearing, const char *message)
{
    const struct dt_pipeline *pipeline = hearing->pipeline;
    const char *pass = "frame", *resource = "what it reads or writes";
    for (uint32_t i = 0; i < pipeline->pass_count; i++)
        if (names(message, pipeline->passes[i].name))
            pass = pipeline->passes[i].name;
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        if (names(message, pipeline->resources[i].name))
            resource = pipeline->resources[i].name;
    const char *kind = strstr(message, "READ_AFTER_WRITE")    ? "a read after a write"
                       : strstr(message, "WRITE_AFTER_READ")  ? "a write after a read"
                       : strstr(message, "WRITE_AFTER_WRITE") ? "a write after a write"
                                                              : "an access";
    char *text = format_string("no barrier orders %s of %s, on %s", kind, resource, hearing->side);
    hearing->elsewhere->barriers_missing = true;
    if (text && is_listed(hearing->elsewhere, text))
        free(text);
    else
        hearing->failed |= !add_elsewhere(hearing->elsewhere, "barrier", pass, text);
}

static void hear(void *user, enum dt_level level, const char *message)
{
    struct hearing *hearing = user;
    bool sum = hearing->elsewhere->barriers_missing && strstr(message, "the run failed");
    if (level == DT_ERROR &&
        (strstr(message, "SYNC-HAZARD") || strstr(message, " hazard detected"))) /* newer layers */
        add_barrier(hearing, message);
    else if (!sum && hearing->other.message)
        hearing->other.message(hearing->other.user, level, message);
}

bool elsewhere_barriers(struct elsewhere *elsewhere, const struct worker_info *worker,
                        const struct dt_pipeline *pipeline)
{
    struct console *console = worker->session.console;
    struct worker_info info = *worker;
    struct worker whole = {0};
    struct worker_place place = {0};
    struct hearing hearing = {.elsewhere = elsewhere,
                              .pipeline = pipeline,
                              .side = info.session.side->label,
                              .other = console->log};
    info.frames +=
        info.frames == info.session.first_frame + 1; /* what a frame leaves to the next */
    info.first_observed = info.frames;
    info.stops_before = 0;
    info.session.poison = 0; /* fills wait, too */
    info.quiet = true;
    console->log = (struct dt_log){.message = hear, .user = &hearing};
    bool good = worker_start(&whole, &info);
    do
        good = good && worker_wait(&whole, &place) &&
               (place.stop == WORKER_FINISHED || worker_resume(&whole, DT_RUN));
    while (good && place.stop != WORKER_FINISHED);
    worker_close(&whole);
    console->log = hearing.other;
    if (hearing.failed)
        report_error(&console->log, "out of memory");
    return (good || elsewhere->barriers_missing) && atomic_load(&console->errors) == 0;
}

/* ---- The list -------------------------------------------------------------------------------- */

void elsewhere_print(const struct elsewhere *elsewhere)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, elsewhere->list)
        printf("elsewhere: %s: %s\n", cJSON_GetStringValue(cJSON_GetObjectItem(item, "pass")),
               cJSON_GetStringValue(cJSON_GetObjectItem(item, "message")));
}

void elsewhere_free(struct elsewhere *elsewhere)
{
    cJSON_Delete(elsewhere->list);
    *elsewhere = (struct elsewhere){0};
}
