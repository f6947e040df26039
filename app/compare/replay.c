/* `diptych replay`: runs one pass on the inputs that compare --bisect kept, and skips all others:
 * only the barriers and layouts around it are the pipeline's. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "console/options.h"
#include "compare/evidence.h"
#include "compare/unwritten.h"
#include "result/difference.h"
#include "run/undefined.h"
#include "run/worker.h"

struct lone_pass {
    struct console *console;
    const struct options *options;
    struct side side;
    struct evidence_case evidence;
    struct fault fault;
    struct worker worker;
    struct undefined undefined; /* --sanitize */
    char *device;
    /* one per output row: */
    struct difference *differences; /* from the expected content */
    bool *recorded;                 /* equal to the other side's content in the folder */
    struct dt_bytes *found;         /* what the first run left; owned */
    char **unwritten;               /* what another fill of memory shows; NULL: nothing; owned */
    bool again;                     /* the second run, with that fill */
};

static const struct dt_pipeline *pipeline_of(const struct lone_pass *alone)
{
    return alone->evidence.pipeline.info;
}

static uint32_t row_count(const struct row_list *list, uint32_t pass)
{
    return list->first[pass + 1] - list->first[pass];
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
    const struct evidence_case *evidence = &alone->evidence;
    const struct row_list *outputs = &evidence->rows.outputs;
    for (uint32_t i = 0; i < row_count(outputs, evidence->pass); i++) {
        const struct row *row = &outputs->list[outputs->first[evidence->pass] + i];
        const struct dt_resource *resource = &pipeline_of(alone)->resources[row->resource];
        struct dt_bytes copies[2] = {{0}, alone->found[i]};
        if (!worker_read(&alone->worker, row->resource, row->mip, &copies[0]))
            return false;
        bool surely;
        if (!unwritten_describe(row, resource, copies, &alone->unwritten[i], &surely)) {
            report_error(&alone->console->log, "out of memory");
            return false;
        }
        if (!surely) { /* perhaps a race */
            free(alone->unwritten[i]);
            alone->unwritten[i] = NULL;
        }
    }
    return true;
}

static bool compare_outputs(struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    const struct row_list *outputs = &evidence->rows.outputs;
    uint32_t count = row_count(outputs, evidence->pass);
    alone->differences = calloc(count + 1, sizeof *alone->differences);
    alone->recorded = calloc(count + 1, sizeof *alone->recorded);
    alone->found = calloc(count + 1, sizeof *alone->found);
    alone->unwritten = calloc(count + 1, sizeof *alone->unwritten);
    bool good = alone->differences && alone->recorded && alone->found && alone->unwritten;
    for (uint32_t i = 0; i < count && good; i++) {
        const struct row *row = &outputs->list[outputs->first[evidence->pass] + i];
        const struct dt_resource *resource = &pipeline_of(alone)->resources[row->resource];
        struct dt_bytes found;
        if (!worker_read(&alone->worker, row->resource, row->mip, &found))
            return false;
        const struct dt_bytes expected[2] = {evidence->outputs[0][i], found};
        const struct dt_bytes actual[2] = {evidence->outputs[1][i], found};
        good =
            difference_measure(&alone->differences[i], resource, evidence->frame.index, expected) &&
            is_as_expected(resource, actual, &alone->recorded[i]) && keep(&alone->found[i], &found);
    }
    if (!good)
        report_error(&alone->console->log, "out of memory");
    return good;
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

static bool find_replay_fault(struct lone_pass *alone)
{
    uint32_t side;
    const char *label = alone->side.label;
    return !alone->options->fault ||
           fault_parse(&alone->fault, &side, alone->options->fault, pipeline_of(alone), &label, 1,
                       &alone->console->log);
}

/* The first output that differs, or count. */
static uint32_t first_difference(const struct lone_pass *alone, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && difference_verdict(&alone->differences[i]) != VERDICT_DIFFERS)
        i++;
    return i;
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
                                                 .fault = alone->fault,
                                                 .frame_block = &evidence->frame},
                                     .frames = frame + 1,
                                     .first_observed = frame,
                                     .stops_before = UINT32_MAX};
    bool good = worker_start(&alone->worker, &info) && run_pass(alone);
    worker_close(&alone->worker);
    if (good && !alone->differences)
        report_error(&alone->console->log, "%s: the runtime skipped the pass", alone->side.label);
    return good && alone->differences;
}

static bool run_replay(struct lone_pass *alone)
{
    struct console *console = alone->console;
    const struct options *options = alone->options;
    struct evidence_case *evidence = &alone->evidence;
    if (!side_read(&alone->side, options->setup.backend, &options->setup, &console->log) ||
        !sides_heed(&alone->side, 1, &options->setup, &console->log) ||
        !evidence_read(evidence, console, options->folder, &options->setup) ||
        !find_replay_fault(alone) || !run_once(alone, POISON_OTHERS))
        return false;
    uint32_t count = row_count(&evidence->rows.outputs, evidence->pass);
    alone->again = first_difference(alone, count) < count;
    return (!alone->again || run_once(alone, POISON_FIRST)) && atomic_load(&console->errors) == 0;
}

/* ---- What is told ---------------------------------------------------------------------------- */

static const char *recorded_text(const struct lone_pass *alone, const char *side, const char *key)
{
    const cJSON *entry = cJSON_GetObjectItem(alone->evidence.manifest, side);
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(entry, key));
    return text ? text : "unknown";
}

static void print_output(const struct lone_pass *alone, uint32_t index, int width)
{
    const struct evidence_case *evidence = &alone->evidence;
    const struct row_list *outputs = &evidence->rows.outputs;
    const struct row *row = &outputs->list[outputs->first[evidence->pass] + index];
    const struct dt_resource *resource = &pipeline_of(alone)->resources[row->resource];
    const struct difference *difference = &alone->differences[index];
    const char *const labels[2] = {"expected", alone->side.label};
    char *worst = alone->unwritten[index] ? strdup(alone->unwritten[index])
                                          : difference_describe_worst(difference, resource, labels);
    printf("%-*s  %10llu  %10llu  %-7s  %s\n", width, row->name,
           (unsigned long long)difference->elements, (unsigned long long)difference->differing,
           verdict_name(difference_verdict(difference)), worst ? worst : "");
    free(worst);
}

static bool all_recorded(const struct lone_pass *alone, uint32_t count)
{
    bool all = true;
    for (uint32_t i = 0; i < count; i++)
        all &= alone->recorded[i];
    return all;
}

static void print_end(const struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    const struct row_list *outputs = &evidence->rows.outputs;
    const struct row *rows = &outputs->list[outputs->first[evidence->pass]];
    uint32_t count = row_count(outputs, evidence->pass);
    uint32_t differs = first_difference(alone, count);
    const char *name = pipeline_of(alone)->passes[evidence->pass].name;
    if (differs == count)
        printf("\npass %s on %s: as expected, what %s left\n", name, alone->side.label,
               recorded_text(alone, "expected", "side"));
    else if (alone->unwritten[differs])
        printf("\npass %s on %s: %s\n", name, alone->side.label, alone->unwritten[differs]);
    else
        printf("\npass %s on %s: %s is not as expected, and all is %s %s had it\n", name,
               alone->side.label, rows[differs].name,
               all_recorded(alone, count) ? "bit for bit as" : "not as",
               recorded_text(alone, "actual", "side"));
}

static void print_outputs(const struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    const struct row_list *outputs = &evidence->rows.outputs;
    uint32_t count = row_count(outputs, evidence->pass);
    int width = 8;
    for (uint32_t i = 0; i < count; i++) {
        int length = (int)strlen(outputs->list[outputs->first[evidence->pass] + i].name);
        width = length > width ? length : width;
    }
    printf("expected: %s, %s\n%s: %s\n\n", recorded_text(alone, "expected", "side"),
           recorded_text(alone, "expected", "device"), alone->side.label, alone->device);
    printf("%-*s  %10s  %10s  %-7s  %s\n", width, "resource", "elements", "differing", "verdict",
           "largest error");
    for (uint32_t i = 0; i < count; i++)
        print_output(alone, i, width);
    print_end(alone);
}

static cJSON *replay_json(const struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    const struct row_list *outputs = &evidence->rows.outputs;
    const char *const labels[2] = {"expected", alone->side.label};
    uint32_t count = row_count(outputs, evidence->pass);
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", pipeline_of(alone)->name);
    cJSON_AddStringToObject(root, "pass", pipeline_of(alone)->passes[evidence->pass].name);
    cJSON_AddNumberToObject(root, "frame", evidence->frame.index);
    cJSON_AddStringToObject(root, "side", alone->side.label);
    cJSON_AddStringToObject(root, "device", alone->device);
    cJSON *results = cJSON_AddArrayToObject(root, "results");
    for (uint32_t i = 0; i < count; i++) {
        const struct row *row = &outputs->list[outputs->first[evidence->pass] + i];
        const struct dt_resource *resource = &pipeline_of(alone)->resources[row->resource];
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddStringToObject(entry, "resource", resource->name);
        cJSON_AddNumberToObject(entry, "mip", row->mip);
        difference_json(entry, &alone->differences[i], resource, labels);
        cJSON_AddBoolToObject(entry, "as_actual", alone->recorded[i]);
        if (alone->unwritten[i])
            cJSON_AddStringToObject(entry, "unwritten", alone->unwritten[i]);
        cJSON_AddItemToArray(results, entry);
    }
    cJSON_AddBoolToObject(root, "as_expected", first_difference(alone, count) == count);
    if (alone->options->setup.sanitize)
        cJSON_AddItemToObject(
            root, "undefined",
            undefined_json(&alone->undefined, (const char *const *)&alone->side.label, 1));
    return root;
}

static void release(struct lone_pass *alone)
{
    const struct evidence_case *evidence = &alone->evidence;
    uint32_t count = alone->differences ? row_count(&evidence->rows.outputs, evidence->pass) : 0;
    for (uint32_t i = 0; i < count; i++) {
        if (alone->found)
            free(alone->found[i].data);
        if (alone->unwritten)
            free(alone->unwritten[i]);
    }
    free(alone->found);
    free(alone->unwritten);
    free(alone->differences);
    free(alone->recorded);
    free(alone->device);
    undefined_free(&alone->undefined);
    evidence_free(&alone->evidence);
    side_free(&alone->side);
}

int verb_replay(struct console *console, const struct options *options)
{
    struct lone_pass alone = {.console = console, .options = options};
    bool good = run_replay(&alone);
    int status = EXIT_USAGE;
    console_status(console, "%s", "");
    if (good) {
        uint32_t count = row_count(&alone.evidence.rows.outputs, alone.evidence.pass);
        print_outputs(&alone);
        undefined_print(&alone.undefined, (const char *const *)&alone.side.label, 1);
        console->result = replay_json(&alone);
        status = first_difference(&alone, count) == count && !alone.undefined.count ? EXIT_FINE
                                                                                    : EXIT_DIFFER;
    }
    release(&alone);
    return status;
}
