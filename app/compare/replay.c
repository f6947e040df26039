/* `diptych replay`: runs one pass on the inputs that compare --bisect kept, and skips all others:
 * only the barriers and layouts around it are the pipeline's. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <cjson/cJSON.h>

#include "base/limit.h"
#include "console/python.h"
#include "compare/blame.h"
#include "compare/evidence.h"
#include "compare/unwritten.h"
#include "result/sheet.h"
#include "run/undefined.h"

struct lone_pass {
    struct console *console;
    const struct options *options;
    struct side side;
    struct evidence_case evidence;
    struct undefined undefined; /* --sanitize */
    char *device;
    struct sheet sheet; /* against the expected content */
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

/* ---- The run --------------------------------------------------------------------------------- */

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

static bool compare_output(void *user, uint32_t index, const struct dt_bytes copies[2])
{
    struct lone_pass *alone = user;
    const struct evidence_case *evidence = &alone->evidence;
    const struct row *row = &evidence->rows.outputs.list[index];
    struct output *output = &alone->outputs[alone->sheet.count];
    struct sheet_row *shown = &alone->sheet.rows[alone->sheet.count++];
    struct dt_bytes actual[2] = {{0}, copies[1]};
    *shown = (struct sheet_row){.pass = pipeline_of(alone)->passes[evidence->pass].name,
                                .name = row->name,
                                .resource = &pipeline_of(alone)->resources[row->resource],
                                .mip = (int)row->mip,
                                .frame = evidence->frame.index,
                                .compared = true};
    if (!evidence_actual(evidence, row, &actual[0]))
        return false;
    bool good = difference_measure(&shown->difference, shown->resource, shown->frame, copies) &&
                is_as_expected(shown->resource, actual, &output->recorded) &&
                keep(&output->found, &copies[1]);
    free(actual[0].data);
    return good || report_error(&alone->console->log, "out of memory");
}

/* What depends on the fill of memory: an output of the second run against that of the first. */
static bool find_unwritten(void *user, uint32_t index, const struct dt_bytes copies[2])
{
    struct lone_pass *alone = user;
    const struct row_list *outputs = &alone->evidence.rows.outputs;
    uint32_t place = index - outputs->first[alone->evidence.pass];
    struct output *output = &alone->outputs[place];
    struct sheet_row *shown = &alone->sheet.rows[place];
    const struct dt_bytes both[2] = {copies[1], output->found};
    bool surely;
    if (!unwritten_describe(&outputs->list[index], shown->resource, both, &output->unwritten,
                            &surely))
        return report_error(&alone->console->log, "out of memory");
    if (surely) /* else perhaps a race */
        shown->text = output->unwritten;
    return true;
}

/* Of the first run: the device; --sanitize: what the pass has done. */
static bool finish(void *user, struct row_source *source)
{
    struct lone_pass *alone = user;
    const struct pipeline *pipeline = &alone->evidence.pipeline;
    const struct row row = {.resource = plan_reports(pipeline->plan)};
    struct dt_bytes bytes;
    alone->device = strdup(source_device(source));
    return !alone->options->setup.sanitize ||
           (source_ask(source, &row) && source_take(source, &row, &bytes) &&
            undefined_add(&alone->undefined, pipeline, 0, &bytes, &alone->console->log));
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
    const struct replay replay = {.console = alone->console,
                                  .rows = &evidence->rows,
                                  .dump = &evidence->reader,
                                  .frame = evidence->frame.index,
                                  .alone = true,
                                  .pass = evidence->pass,
                                  .workers[1].session = {.side = &alone->side,
                                                         .console = alone->console,
                                                         .setup = &evidence->setup,
                                                         .pipeline = &evidence->pipeline,
                                                         .scene = &evidence->scene,
                                                         .poison = fill,
                                                         .frame_block = &evidence->frame}};
    const struct replay_viewer viewer = {.output = alone->again ? find_unwritten : compare_output,
                                         .finished = alone->again ? NULL : finish,
                                         .user = alone};
    return replay_run(&replay, &viewer);
}

static bool begin_sheet(struct lone_pass *alone)
{
    const uint32_t *first = &alone->evidence.rows.outputs.first[alone->evidence.pass];
    uint32_t count = first[1] - first[0];
    alone->sheet = (struct sheet){.labels = {"expected", alone->side.label}, .lone = true};
    alone->outputs = calloc(count + 1, sizeof *alone->outputs);
    return alone->outputs ? sheet_begin(&alone->sheet, count, &alone->console->log)
                          : report_error(&alone->console->log, "out of memory");
}

static bool run_replay(struct lone_pass *alone)
{
    struct console *console = alone->console;
    const struct options *options = alone->options;
    struct evidence_case *evidence = &alone->evidence;
    if (!side_read(&alone->side, options->setup.backend, &options->setup, &console->log) ||
        !sides_heed(&alone->side, 1, &options->setup, &console->log) ||
        !evidence_read(evidence, console, options->folder, &options->setup) ||
        !begin_sheet(alone) || !run_once(alone, POISON_OTHERS))
        return false;
    alone->again = first_difference(alone);
    return (!alone->again || run_once(alone, POISON_FIRST)) && atomic_load(&console->errors) == 0;
}

/* ---- What is told ---------------------------------------------------------------------------- */

static const char *recorded_text(const struct lone_pass *alone, const char *side, const char *key)
{
    const cJSON *entry = cJSON_GetObjectItem(alone->evidence.reader.manifest, side);
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
