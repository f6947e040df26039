/* `diptych replay`: runs one pass on the inputs that compare --bisect kept, and skips all others:
 * only the barriers and layouts around it are the pipeline's. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <cjson/cJSON.h>

#include "base/limit.h"
#include "console/python.h"
#include "compare/evidence.h"
#include "compare/unwritten.h"
#include "result/sheet.h"
#include "run/undefined.h"
#include "run/worker.h"

struct lone_pass {
    struct console *console;
    const struct options *options;
    struct side side;
    struct evidence_case evidence;
    struct worker worker;
    struct undefined undefined; /* --sanitize */
    char *device;
    struct sheet sheet; /* against the expected content; no row: the pass has not run */
    /* one per row: */
    struct output {
        bool recorded;         /* equal to the other side's content in the folder */
        struct dt_bytes found; /* what the first run left; owned */
        char *unwritten;       /* what another fill of memory shows; NULL: nothing; owned */
    } * outputs;
    bool again; /* the second run, with that fill */
};

static const struct dt_pipeline *pipeline_of(const struct lone_pass *alone)
{
    return alone->evidence.pipeline.info;
}

static uint32_t row_count(const struct row_list *list, uint32_t pass)
{
    return list->first[pass + 1] - list->first[pass];
}

/* The rows that the pass writes. */
static const struct row *outputs_of(const struct lone_pass *alone)
{
    const struct row_list *outputs = &alone->evidence.rows.outputs;
    return &outputs->list[outputs->first[alone->evidence.pass]];
}

/* ---- The run --------------------------------------------------------------------------------- */

static bool write_inputs(struct lone_pass *alone)
{
    const struct row_list *inputs = &alone->evidence.rows.inputs;
    uint32_t pass = alone->evidence.pass;
    for (uint32_t i = 0; i < row_count(inputs, pass); i++) {
        const struct row *row = &inputs->list[inputs->first[pass] + i];
        if (!worker_write(&alone->worker, row->resource, row->mip, &alone->evidence.inputs[i]))
            return false;
    }
    return true;
}

/* Bit for bit means all declared numbers: padding does not count, and dumps have none. */
static bool is_as_expected(const struct dt_resource *resource, const struct dt_bytes copies[2],
                           bool *same)
{
    struct dt_resource exact = *resource;
    struct difference difference;
    exact.contract = (struct dt_contract){.kind = DT_CONTRACT_EXACT};
    bool good = difference_measure(&difference, &exact, 0, copies);
    *same = !difference.differing && !difference.size_differs;
    return good;
}

static bool keep(struct dt_bytes *kept, const struct dt_bytes *bytes)
{
    *kept = *bytes;
    kept->data = malloc(bytes->size + 1);
    if (kept->data)
        memcpy(kept->data, bytes->data, bytes->size);
    return kept->data;
}

/* What depends on the fill of memory: outputs of the second run against those of the first. */
static bool find_unwritten(struct lone_pass *alone)
{
    for (uint32_t i = 0; i < alone->sheet.count; i++) {
        const struct row *row = &outputs_of(alone)[i];
        struct output *output = &alone->outputs[i];
        struct dt_bytes copies[2] = {{0}, output->found};
        if (!worker_read(&alone->worker, row->resource, row->mip, &copies[0]))
            return false;
        bool surely;
        if (!unwritten_describe(row, alone->sheet.rows[i].resource, copies, &output->unwritten,
                                &surely))
            return report_error(&alone->console->log, "out of memory");
        if (surely) /* else perhaps a race */
            alone->sheet.rows[i].text = output->unwritten;
    }
    return true;
}

static bool compare_outputs(struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    const struct dt_log *log = &alone->console->log;
    uint32_t count = row_count(&evidence->rows.outputs, evidence->pass);
    alone->sheet = (struct sheet){.labels = {"expected", alone->side.label}, .lone = true};
    alone->outputs = calloc(count + 1, sizeof *alone->outputs);
    if (!sheet_begin(&alone->sheet, count, log))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const struct row *row = &outputs_of(alone)[i];
        struct sheet_row *shown = &alone->sheet.rows[alone->sheet.count++];
        struct dt_bytes found;
        *shown = (struct sheet_row){.pass = pipeline_of(alone)->passes[evidence->pass].name,
                                    .name = row->name,
                                    .resource = &pipeline_of(alone)->resources[row->resource],
                                    .mip = (int)row->mip,
                                    .frame = evidence->frame.index,
                                    .compared = true};
        if (!worker_read(&alone->worker, row->resource, row->mip, &found))
            return false;
        const struct dt_bytes expected[2] = {evidence->outputs[0][i], found};
        const struct dt_bytes actual[2] = {evidence->outputs[1][i], found};
        if (!alone->outputs ||
            !difference_measure(&shown->difference, shown->resource, shown->frame, expected) ||
            !is_as_expected(shown->resource, actual, &alone->outputs[i].recorded) ||
            !keep(&alone->outputs[i].found, &found))
            return report_error(log, "out of memory");
    }
    return true;
}

/* --sanitize: what the pass has done. */
static bool read_undefined(struct lone_pass *alone)
{
    const struct pipeline *pipeline = &alone->evidence.pipeline;
    struct dt_bytes bytes;
    return !alone->options->setup.sanitize ||
           (worker_read(&alone->worker, plan_reports(pipeline->plan), 0, &bytes) &&
            undefined_add(&alone->undefined, pipeline, 0, &bytes, &alone->console->log));
}

/* Steps through the frame: skips all passes but one, and writes the inputs of that one before it
 * runs. */
static bool run_pass(struct lone_pass *alone)
{
    struct worker *worker = &alone->worker;
    struct worker_place place;
    uint32_t pass = alone->evidence.pass;
    if (!worker_wait(worker, &place))
        return false;
    if (!alone->device)
        alone->device = strdup(worker->device);
    for (enum dt_action action = DT_RUN;;) {
        if (!worker_resume(worker, action) || !worker_wait(worker, &place))
            return false;
        if (place.stop == WORKER_FINISHED)
            return alone->again || read_undefined(alone);
        action = DT_RUN;
        if (place.stop == WORKER_BEFORE_PASS && place.pass != pass)
            action = DT_SKIP;
        else if (place.stop == WORKER_BEFORE_PASS && !write_inputs(alone))
            return false;
        else if (place.stop == WORKER_AFTER_PASS && place.pass == pass &&
                 !(alone->again ? find_unwritten(alone) : compare_outputs(alone)))
            return false;
    }
}

/* The first output that differs; NULL: none. */
static const struct sheet_row *first_difference(const struct lone_pass *alone)
{
    for (uint32_t i = 0; i < alone->sheet.count; i++)
        if (difference_verdict(&alone->sheet.rows[i].difference) == VERDICT_DIFFERS)
            return &alone->sheet.rows[i];
    return NULL;
}

static bool run_once(struct lone_pass *alone, int fill)
{
    struct evidence_case *evidence = &alone->evidence;
    uint32_t frame = evidence->frame.index;
    const struct worker_info info = {.session = {.side = &alone->side,
                                                 .console = alone->console,
                                                 .setup = &evidence->setup,
                                                 .pipeline = &evidence->pipeline,
                                                 .scene = &evidence->scene,
                                                 .poison = fill,
                                                 .first_frame = frame,
                                                 .frame_block = &evidence->frame},
                                     .frames = frame + 1,
                                     .first_observed = frame,
                                     .stops_before = UINT32_MAX};
    bool good = worker_start(&alone->worker, &info) && run_pass(alone);
    worker_close(&alone->worker);
    if (good && !alone->sheet.count)
        report_error(&alone->console->log, "%s: the runtime skipped the pass", alone->side.label);
    return good && alone->sheet.count;
}

static bool run_replay(struct lone_pass *alone)
{
    struct console *console = alone->console;
    const struct options *options = alone->options;
    struct evidence_case *evidence = &alone->evidence;
    if (!side_read(&alone->side, options->setup.backend, &options->setup, &console->log) ||
        !sides_heed(&alone->side, 1, &options->setup, &console->log) ||
        !evidence_read(evidence, console, options->folder, &options->setup) ||
        !run_once(alone, POISON_OTHERS))
        return false;
    alone->again = first_difference(alone);
    return (!alone->again || run_once(alone, POISON_FIRST)) && atomic_load(&console->errors) == 0;
}

/* ---- What is told ---------------------------------------------------------------------------- */

static const char *recorded_text(const struct lone_pass *alone, const char *side, const char *key)
{
    const cJSON *entry = cJSON_GetObjectItem(alone->evidence.manifest, side);
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(entry, key));
    return text ? text : "unknown";
}

static bool all_recorded(const struct lone_pass *alone)
{
    bool all = true;
    for (uint32_t i = 0; i < alone->sheet.count; i++)
        all &= alone->outputs[i].recorded;
    return all;
}

static void print_outputs(const struct lone_pass *alone)
{
    const struct sheet_row *differs = first_difference(alone);
    const char *name = alone->sheet.rows[0].pass;
    printf("expected: %s, %s\n%s: %s\n\n", recorded_text(alone, "expected", "side"),
           recorded_text(alone, "expected", "device"), alone->side.label, alone->device);
    sheet_print(&alone->sheet);
    printf("\npass %s on %s: ", name, alone->side.label);
    if (!differs)
        printf("as expected, what %s left\n", recorded_text(alone, "expected", "side"));
    else if (differs->text)
        printf("%s\n", differs->text);
    else
        printf("%s is not as expected, and all is %s %s had it\n", differs->name,
               all_recorded(alone) ? "bit for bit as" : "not as",
               recorded_text(alone, "actual", "side"));
}

static cJSON *replay_json(const struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", pipeline_of(alone)->name);
    cJSON_AddStringToObject(root, "pass", pipeline_of(alone)->passes[evidence->pass].name);
    cJSON_AddNumberToObject(root, "frame", evidence->frame.index);
    cJSON_AddStringToObject(root, "side", alone->side.label);
    cJSON_AddStringToObject(root, "device", alone->device);
    cJSON *results = cJSON_AddArrayToObject(root, "results");
    for (uint32_t i = 0; i < alone->sheet.count; i++) {
        cJSON *entry = cJSON_CreateObject();
        sheet_row_json(entry, &alone->sheet, &alone->sheet.rows[i]);
        cJSON_AddBoolToObject(entry, "as_actual", alone->outputs[i].recorded);
        cJSON_AddStringToObject(entry, "unwritten", alone->sheet.rows[i].text);
        cJSON_AddItemToArray(results, entry);
    }
    cJSON_AddBoolToObject(root, "as_expected", !first_difference(alone));
    if (alone->options->setup.sanitize)
        cJSON_AddItemToObject(
            root, "undefined",
            undefined_json(&alone->undefined, (const char *const *)&alone->side.label, 1));
    return root;
}

static void release(struct lone_pass *alone)
{
    for (uint32_t i = 0; alone->outputs && i < alone->sheet.count; i++) {
        free(alone->outputs[i].found.data);
        free(alone->outputs[i].unwritten);
    }
    free(alone->outputs);
    sheet_free(&alone->sheet);
    free(alone->device);
    undefined_free(&alone->undefined);
    evidence_free(&alone->evidence);
    side_free(&alone->side);
}

/* Of a folder that may come from anyone: memory, and processor time of all threads together. */
static void limit_replay(void)
{
    enum { GIBIBYTES = 16, SECONDS = 1800 };
    struct rlimit limit;
    limit_memory(GIBIBYTES);
    if (getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_cur > SECONDS) {
        limit.rlim_cur = SECONDS;
        setrlimit(RLIMIT_CPU, &limit);
    }
}

/* Without --trust, Python starts it again in a sandbox: app/python/diptych/sandbox.py. */
int verb_replay(struct console *console, const struct options *options)
{
    struct lone_pass alone = {.console = console, .options = options};
    if (!options->trust)
        return python_verb(console, "replay", options_json(options, VERB_REPLAY));
    limit_replay();
    bool good = run_replay(&alone);
    int status = EXIT_USAGE;
    console_status(console, "%s", "");
    if (good) {
        print_outputs(&alone);
        undefined_print(&alone.undefined, (const char *const *)&alone.side.label, 1);
        console->result = replay_json(&alone);
        status = first_difference(&alone) || alone.undefined.count ? EXIT_DIFFER : EXIT_FINE;
    }
    release(&alone);
    return status;
}
