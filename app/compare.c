/* `diptych compare`: both backends in one process, every resource compared after every pass. Each
 * backend runs in a thread of its own, since an OpenGL context belongs to one; after each pass they
 * meet, resource by resource, so that no more than one resource per backend is in memory. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "difference.h"
#include "files.h"
#include "options.h"
#include "session.h"

enum { SIDES = 2, COULD_NOT_RUN = 2 };

/* Resources without history are filled with these before the first frame, so that what no pass has
 * written differs. */
static const struct {
    const char *backend;
    int poison;
} sides[SIDES] = {{"gl", 0x5a}, {"vk", 0xa5}};
static const char *const labels[SIDES] = {"gl", "vk"};

/* Where the two threads wait for each other. A thread that fails leaves, and the other is let
 * go. */
struct rendezvous {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int waiting;
    uint64_t round;
    bool left;
};

struct row {
    uint32_t pass, resource, mip;
    char *name; /* of the resource, with the mip where there are several */
    struct difference difference;
};

struct compare;

struct side {
    struct compare *compare;
    int index;
    struct session session;
    char *device;
    struct dt_bytes bytes; /* of the resource being compared */
    uint32_t frame;
    bool good;
};

struct compare {
    struct console *console;
    const struct options *options;
    struct pipeline pipeline;
    struct scene scene;
    struct rendezvous meeting;
    struct side sides[SIDES];
    struct row *rows; /* one per pass, resource that it writes and mip that holds something */
    uint32_t row_count;
    uint32_t *first_row; /* by pass, and row_count behind the last */
    uint32_t compared;   /* rows, over all frames */
    bool broken;
    uint32_t broken_frame, broken_row; /* the first that broke its contract */
};

/* ---- The two threads ------------------------------------------------------------------------- */

static bool meet(struct rendezvous *meeting)
{
    pthread_mutex_lock(&meeting->lock);
    uint64_t round = meeting->round;
    if (!meeting->left && ++meeting->waiting == SIDES) {
        meeting->waiting = 0;
        meeting->round++;
        pthread_cond_broadcast(&meeting->changed);
    }
    while (!meeting->left && meeting->round == round)
        pthread_cond_wait(&meeting->changed, &meeting->lock);
    bool met = meeting->round != round;
    pthread_mutex_unlock(&meeting->lock);
    return met;
}

static void leave(struct rendezvous *meeting)
{
    pthread_mutex_lock(&meeting->lock);
    meeting->left = true;
    pthread_cond_broadcast(&meeting->changed);
    pthread_mutex_unlock(&meeting->lock);
}

/* Both copies are there, and the other thread waits. */
static bool compare_row(struct compare *compare, uint32_t index, uint32_t frame)
{
    struct row *row = &compare->rows[index];
    const struct dt_bytes copies[SIDES] = {compare->sides[0].bytes, compare->sides[1].bytes};
    if (!difference_add(&row->difference, &compare->pipeline.info->resources[row->resource], frame,
                        copies)) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    compare->compared++;
    if (!compare->broken && difference_verdict(&row->difference) == VERDICT_DIFFERS) {
        compare->broken = true;
        compare->broken_frame = frame;
        compare->broken_row = index;
    }
    return true;
}

static bool after_pass(void *user, uint32_t pass)
{
    struct side *side = user;
    struct compare *compare = side->compare;
    const struct dt_pass *info = &compare->pipeline.info->passes[pass];
    console_status(compare->console, "frame %u of %u, pass %s", side->frame + 1,
                   compare->options->frames, info->name);
    bool good = true;
    for (uint32_t i = compare->first_row[pass]; i < compare->first_row[pass + 1] && good; i++) {
        const struct row *row = &compare->rows[i];
        good = side->session.runtime->read(side->session.handle, row->resource, row->mip,
                                           &side->bytes);
        good = good && meet(&compare->meeting);
        if (good && side->index == 0)
            good = compare_row(compare, i, side->frame);
        good = good && meet(&compare->meeting);
        free(side->bytes.data);
        side->bytes = (struct dt_bytes){0};
    }
    return good;
}

/* One after the other: opening OpenGL may set environment variables that opening Vulkan reads. */
static bool open_in_turn(struct side *side)
{
    struct compare *compare = side->compare;
    const struct session_info info = {.backend = sides[side->index].backend,
                                      .console = compare->console,
                                      .options = compare->options,
                                      .pipeline = &compare->pipeline,
                                      .scene = &compare->scene,
                                      .poison = sides[side->index].poison,
                                      .name_in_log = true};
    if (side->index > 0 && !meet(&compare->meeting))
        return false;
    if (!session_open(&side->session, &info))
        return false;
    side->device = strdup(side->session.runtime->device_name(side->session.handle));
    return side->index > 0 || meet(&compare->meeting);
}

static bool run_frames(struct side *side)
{
    const struct dt_observer observer = {.after_pass = after_pass, .user = side};
    for (side->frame = 0; side->frame < side->compare->options->frames; side->frame++) {
        if (!session_frame(&side->session, &observer))
            return false;
    }
    return session_is_silent(&side->session);
}

static void *run_side(void *user)
{
    struct side *side = user;
    side->good = open_in_turn(side) && session_prepare(&side->session) && run_frames(side);
    if (!side->good)
        leave(&side->compare->meeting);
    session_close(&side->session);
    return NULL;
}

static bool run_both(struct compare *compare)
{
    pthread_t threads[SIDES];
    int started = 0;
    pthread_mutex_init(&compare->meeting.lock, NULL);
    pthread_cond_init(&compare->meeting.changed, NULL);
    for (; started < SIDES; started++) {
        compare->sides[started] = (struct side){.compare = compare, .index = started};
        int error = pthread_create(&threads[started], NULL, run_side, &compare->sides[started]);
        if (error) {
            report_error(&compare->console->log, "cannot start a thread: %s", strerror(error));
            leave(&compare->meeting);
            break;
        }
    }
    bool good = started == SIDES;
    for (int i = 0; i < started; i++) {
        pthread_join(threads[i], NULL);
        good = good && compare->sides[i].good;
    }
    pthread_cond_destroy(&compare->meeting.changed);
    pthread_mutex_destroy(&compare->meeting.lock);
    return good;
}

/* ---- The table ------------------------------------------------------------------------------- */

static bool add_row(struct compare *compare, uint32_t pass, uint32_t resource, uint32_t mip)
{
    const struct dt_resource *what = &compare->pipeline.info->resources[resource];
    char *name = what->mips > 1 ? format_string("%s mip %u", what->name, mip) : strdup(what->name);
    struct row *rows = realloc(compare->rows, (compare->row_count + 1) * sizeof *rows);
    if (rows)
        compare->rows = rows;
    if (!rows || !name) {
        free(name);
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    rows[compare->row_count++] =
        (struct row){.pass = pass, .resource = resource, .mip = mip, .name = name};
    return true;
}

static bool add_rows(struct compare *compare, uint32_t pass)
{
    const struct dt_pass *info = &compare->pipeline.info->passes[pass];
    for (uint32_t i = 0; i < info->write_count; i++) {
        uint32_t mips = resource_mips(compare->pipeline.info, pass, info->writes[i]);
        for (uint32_t mip = 0; mips >> mip; mip++)
            if ((mips >> mip & 1) && !add_row(compare, pass, info->writes[i], mip))
                return false;
    }
    return true;
}

static bool make_rows(struct compare *compare)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    compare->first_row = calloc(info->pass_count + 1, sizeof *compare->first_row);
    if (!compare->first_row) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < info->pass_count; i++) {
        if (!add_rows(compare, i))
            return false;
        compare->first_row[i + 1] = compare->row_count;
    }
    if (compare->row_count)
        return true;
    report_error(&compare->console->log, "%s: no pass writes anything, there is nothing to compare",
                 info->name);
    return false;
}

static void print_row(const struct compare *compare, const struct row *row, const int widths[2])
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const struct dt_resource *resource = &info->resources[row->resource];
    const struct difference *difference = &row->difference;
    char *worst = difference_describe_worst(difference, resource, labels);
    char *flips = difference_list_flips(difference, resource, labels);
    printf("%-*s  %-*s  %10llu  %10llu  %-7s  %s\n%s", widths[0], info->passes[row->pass].name,
           widths[1], row->name, (unsigned long long)difference->elements,
           (unsigned long long)difference->differing, verdict_name(difference_verdict(difference)),
           worst ? worst : "", flips ? flips : "");
    free(worst);
    free(flips);
}

static void print_agreement(const struct compare *compare)
{
    uint32_t resources = 0, passes = 0;
    for (uint32_t i = 0; i < compare->pipeline.info->pass_count; i++) {
        uint32_t written = compare->pipeline.info->passes[i].write_count;
        resources += written;
        passes += written > 0;
    }
    printf("\nall %u resources of %u passes agree\n", resources, passes);
}

static void print_table(const struct compare *compare)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    int widths[2] = {4, 8};
    for (uint32_t i = 0; i < compare->row_count; i++) {
        int pass = (int)strlen(info->passes[compare->rows[i].pass].name);
        int resource = (int)strlen(compare->rows[i].name);
        widths[0] = pass > widths[0] ? pass : widths[0];
        widths[1] = resource > widths[1] ? resource : widths[1];
    }
    printf("gl: %s\nvk: %s\n\n", compare->sides[0].device, compare->sides[1].device);
    printf("%-*s  %-*s  %10s  %10s  %-7s  %s\n", widths[0], "pass", widths[1], "resource",
           "elements", "differing", "verdict", "worst error");
    for (uint32_t i = 0; i < compare->row_count; i++)
        print_row(compare, &compare->rows[i], widths);
    if (compare->broken) {
        const struct row *row = &compare->rows[compare->broken_row];
        printf("\npass %s is the first to break: %s, in frame %u\n", info->passes[row->pass].name,
               row->name, compare->broken_frame);
    } else {
        print_agreement(compare);
    }
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static void add_place(cJSON *root, const struct dt_pipeline *info, const struct row *row)
{
    const struct dt_resource *resource = &info->resources[row->resource];
    cJSON_AddStringToObject(root, "pass", info->passes[row->pass].name);
    cJSON_AddStringToObject(root, "resource", resource->name);
    if (resource->mips > 1)
        cJSON_AddNumberToObject(root, "mip", row->mip);
}

static cJSON *row_json(const struct compare *compare, const struct row *row)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    cJSON *root = cJSON_CreateObject();
    add_place(root, info, row);
    difference_json(root, &row->difference, &info->resources[row->resource], labels);
    return root;
}

static cJSON *compare_json(const struct compare *compare)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", info->name);
    cJSON_AddStringToObject(root, "scene", compare->options->scene);
    cJSON_AddNumberToObject(root, "width", compare->options->size[0]);
    cJSON_AddNumberToObject(root, "height", compare->options->size[1]);
    cJSON_AddNumberToObject(root, "frames", compare->options->frames);
    cJSON *devices = cJSON_AddObjectToObject(root, "devices");
    for (int i = 0; i < SIDES; i++)
        cJSON_AddStringToObject(devices, sides[i].backend, compare->sides[i].device);
    cJSON *results = cJSON_AddArrayToObject(root, "results");
    for (uint32_t i = 0; i < compare->row_count; i++)
        cJSON_AddItemToArray(results, row_json(compare, &compare->rows[i]));
    cJSON_AddBoolToObject(root, "agree", !compare->broken);
    if (!compare->broken) {
        cJSON_AddNullToObject(root, "first_break");
        return root;
    }
    cJSON *first = cJSON_AddObjectToObject(root, "first_break");
    add_place(first, info, &compare->rows[compare->broken_row]);
    cJSON_AddNumberToObject(first, "frame", compare->broken_frame);
    return root;
}

static bool write_json(const struct compare *compare)
{
    const char *path = compare->options->json;
    cJSON *root = compare_json(compare);
    char *text = cJSON_Print(root);
    bool good = false;
    if (text) {
        console_hold(compare->console);
        good = file_write(path, text, strlen(text), &compare->console->log);
        console_release(compare->console);
    } else {
        report_error(&compare->console->log, "%s: out of memory", path);
    }
    cJSON_free(text);
    cJSON_Delete(root);
    return good;
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool run(struct compare *compare)
{
    struct console *console = compare->console;
    if (compare->options->json && !file_can_write(compare->options->json, &console->log))
        return false;
    if (!pipeline_load(&compare->pipeline, console, compare->options) || !make_rows(compare))
        return false;
    if (!session_load_scene(&compare->scene, console, compare->options) || !run_both(compare))
        return false;
    if (compare->compared == compare->row_count * compare->options->frames)
        return atomic_load(&console->errors) == 0;
    report_error(&console->log,
                 "%u results were compared where %u were due: a runtime left out passes",
                 compare->compared, compare->row_count * compare->options->frames);
    return false;
}

int verb_compare(struct console *console, const struct options *options)
{
    struct compare compare = {.console = console, .options = options};
    bool good = run(&compare);
    if (good && options->json)
        good = write_json(&compare);
    console_status(console, "%s", "");
    if (good)
        print_table(&compare);
    for (int i = 0; i < SIDES; i++)
        free(compare.sides[i].device);
    for (uint32_t i = 0; i < compare.row_count; i++)
        free(compare.rows[i].name);
    free(compare.rows);
    free(compare.first_row);
    scene_free(&compare.scene);
    pipeline_unload(&compare.pipeline);
    return !good ? COULD_NOT_RUN : compare.broken ? EXIT_DIFFER : EXIT_FINE;
}
