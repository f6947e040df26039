/* `diptych bench`: times of every pass. Each backend runs in its own processes, and the processes
 * take turns frame by frame: other load on the machine then affects all backends alike, and ratios
 * compare times that were measured side by side. Python makes medians and tables of them:
 * app/python/diptych/bench.py. */
#include <stdlib.h>
#include <string.h>

#include "base/installed.h"
#include "console/python.h"
#include "measure/cost.h"
#include "run/session.h"
#include "run/worker.h"
#include "spec/inputs.h"

enum { DEFAULT_FRAMES = 20, DEFAULT_WARMUP = 3, COPY_BYTES = 32 << 20 };

/* A pipeline with its options; options.setup.frames counts warm-up and measured frames. */
struct programme {
    struct pipeline pipeline;
    struct options options;
};

/* A worker that runs one frame of a pipeline per turn, with the times of each measured frame. */
struct lane {
    struct worker worker;
    const struct dt_pipeline *info;
    uint32_t taken;               /* frames so far, at most bench.frames */
    double *frame_ms, *record_ms; /* one per frame; owned */
    double *pass_ms;              /* frames x passes; owned, NULL without timestamps */
};

struct bench_side {
    const struct side *side;
    struct lane whole;  /* without timestamps, which can slow a frame down */
    struct lane passes; /* with them */
    struct lane machine;
};

struct bench {
    struct console *console;
    const struct options *options;
    uint32_t frames, warmup;
    struct sides sides;
    struct bench_side *list;           /* as many as there are sides */
    struct programme subject, machine; /* to time; templates/machine.yaml */
    struct scene scene;
    double *copy_ms;   /* by memcpy on the CPU, COPY_BYTES to and fro; frames values, owned */
    uint8_t *original; /* 2 x COPY_BYTES, owned */
};

/* ---- Lanes ----------------------------------------------------------------------------------- */

static bool lane_allocate(struct lane *lane, uint32_t frames, bool timing)
{
    lane->frame_ms = calloc(frames, sizeof *lane->frame_ms);
    lane->record_ms = calloc(frames, sizeof *lane->record_ms);
    if (timing)
        lane->pass_ms = calloc((size_t)frames * lane->info->pass_count + 1, sizeof *lane->pass_ms);
    return lane->frame_ms && lane->record_ms && (!timing || lane->pass_ms);
}

/* A worker of a lane: started, run to the end of its next frame, whose times count if `taken`, and ended. programme->options.setup.frames
 * counts all its frames. Log their errors; lane_free in any case, also of a zeroed one. */
static bool lane_start(struct lane *lane, struct bench *bench, const struct side *side,
                       struct programme *programme, bool timing)
{
    const uint32_t frames = programme->options.setup.frames;
    const struct worker_info info = {.session = {.side = side,
                                                 .console = bench->console,
                                                 .setup = &programme->options.setup,
                                                 .pipeline = &programme->pipeline,
                                                 .scene = &bench->scene,
                                                 .timing = timing},
                                     .frames = frames,
                                     .first_observed = frames,
                                     .stops_after_frames = true,
                                     .quiet = timing};
    struct worker_place place;
    lane->info = programme->pipeline.info;
    if (!lane_allocate(lane, bench->frames, timing))
        return report_error(&bench->console->log, "out of memory for the times of %u frames",
                            bench->frames);
    return worker_start(&lane->worker, &info) && worker_wait(&lane->worker, &place);
}

static bool lane_take(struct lane *lane)
{
    struct worker_measure measure;
    uint32_t at = lane->taken++;
    if (!worker_measure(&lane->worker, &measure))
        return false;
    lane->frame_ms[at] = measure.frame_ms;
    lane->record_ms[at] = measure.record_ms;
    for (uint32_t i = 0; lane->pass_ms && i < lane->info->pass_count; i++)
        lane->pass_ms[(size_t)at * lane->info->pass_count + i] = measure.pass_ms[i];
    return true;
}

/* After the last frame, to WORKER_FINISHED. */
static bool lane_advance(struct lane *lane, bool taken)
{
    struct worker_place place;
    return worker_resume(&lane->worker, DT_RUN) && worker_wait(&lane->worker, &place) &&
           (!taken || lane_take(lane));
}

static void lane_free(struct lane *lane)
{
    worker_close(&lane->worker);
    free(lane->frame_ms);
    free(lane->record_ms);
    free(lane->pass_ms);
}

/* ---- What Python gets ------------------------------------------------------------------------ */

/* Bytes that a pass reads and writes. */
static struct work work_in(const struct bench *bench, const struct programme *programme,
                           uint32_t pass)
{
    const uint32_t *size = programme->options.setup.size;
    const struct work_frame frame = {.pipeline = programme->pipeline.info,
                                     .size = {size[0], size[1]},
                                     .vertex_count = bench->scene.data.vertex_count,
                                     .index_count = bench->scene.data.index_count};
    return work_of(&frame, pass);
}

static void add_lane(cJSON *side, const char *name, const struct lane *lane)
{
    uint32_t passes = lane->info->pass_count;
    cJSON *item = cJSON_AddObjectToObject(side, name);
    cJSON_AddItemToObject(item, "frame_ms",
                          cJSON_CreateDoubleArray(lane->frame_ms, (int)lane->taken));
    cJSON_AddItemToObject(item, "record_ms",
                          cJSON_CreateDoubleArray(lane->record_ms, (int)lane->taken));
    cJSON *frames = cJSON_AddArrayToObject(item, "pass_ms");
    for (uint32_t i = 0; lane->pass_ms && i < lane->taken; i++)
        cJSON_AddItemToArray(
            frames, cJSON_CreateDoubleArray(lane->pass_ms + (size_t)i * passes, (int)passes));
}

static void add_invocations(const struct bench *bench, cJSON *request)
{
    const struct dt_pipeline *info = bench->subject.pipeline.info;
    cJSON *passes = cJSON_AddArrayToObject(request, "passes");
    cJSON *machine = cJSON_AddArrayToObject(request, "machine");
    for (uint32_t i = 0; i < info->pass_count; i++) {
        struct work work = work_in(bench, &bench->subject, i);
        cJSON *pass = cJSON_CreateObject();
        cJSON_AddStringToObject(pass, "pass", info->passes[i].name);
        cJSON_AddNumberToObject(pass, "bytes_read", work.read);
        cJSON_AddNumberToObject(pass, "bytes_written", work.written);
        cJSON_AddItemToArray(passes, pass);
    }
    for (uint32_t i = 0; i < bench->machine.pipeline.info->pass_count; i++) {
        struct work work = work_in(bench, &bench->machine, i);
        cJSON_AddItemToArray(machine, cJSON_CreateNumber(work.read + work.written));
    }
}

static void add_all(const struct bench *bench, cJSON *request)
{
    cJSON_AddStringToObject(request, "pipeline", bench->subject.pipeline.info->name);
    cJSON_AddNumberToObject(request, "width", bench->options->setup.size[0]);
    cJSON_AddNumberToObject(request, "height", bench->options->setup.size[1]);
    cJSON_DeleteItemFromObject(request, "frames");
    cJSON_DeleteItemFromObject(request, "warmup");
    cJSON_AddNumberToObject(request, "frames", bench->frames);
    cJSON_AddNumberToObject(request, "warmup", bench->warmup);
    cJSON_AddNumberToObject(request, "copy_bytes", 2.0 * COPY_BYTES);
    cJSON_AddItemToObject(request, "copy_ms",
                          cJSON_CreateDoubleArray(bench->copy_ms, (int)bench->frames));
    add_invocations(bench, request);
    cJSON *sides = cJSON_AddArrayToObject(request, "sides");
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        const struct bench_side *side = &bench->list[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "side", side->side->label);
        cJSON_AddStringToObject(item, "device", side->whole.worker.device);
        cJSON_AddStringToObject(item, "driver", side->whole.worker.driver);
        add_lane(item, "whole", &side->whole);
        add_lane(item, "passes", &side->passes);
        add_lane(item, "machine", &side->machine);
        cJSON_AddItemToArray(sides, item);
    }
}

/* ---- The run --------------------------------------------------------------------------------- */

static void copy_on_cpu(struct bench *bench, uint32_t at)
{
    double start = milliseconds_now();
    memcpy(bench->original + COPY_BYTES, bench->original, COPY_BYTES);
    bench->copy_ms[at] = milliseconds_now() - start;
    bench->original[at % COPY_BYTES]++; /* so that every copy moves new data */
}

static bool start_all(struct bench *bench)
{
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        struct bench_side *side = &bench->list[i];
        side->side = &bench->sides.list[i];
        if (!lane_start(&side->whole, bench, side->side, &bench->subject, false) ||
            !lane_start(&side->passes, bench, side->side, &bench->subject, true) ||
            !lane_start(&side->machine, bench, side->side, &bench->machine, true))
            return false;
    }
    return true;
}

static bool advance_all(struct bench *bench, bool taken)
{
    for (uint32_t i = 0; i < bench->sides.count; i++)
        if (!lane_advance(&bench->list[i].whole, taken) ||
            !lane_advance(&bench->list[i].passes, taken) ||
            !lane_advance(&bench->list[i].machine, taken))
            return false;
    return true;
}

static bool run_all(struct bench *bench)
{
    uint32_t frames = bench->warmup + bench->frames;
    console_status(bench->console, "opening the devices and creating the programs");
    if (!start_all(bench))
        return false;
    for (uint32_t i = 0; i < frames; i++) {
        console_status(bench->console, "frame %u of %u", i + 1, frames);
        if (!advance_all(bench, i >= bench->warmup))
            return false;
        if (i >= bench->warmup)
            copy_on_cpu(bench, i - bench->warmup);
    }
    return advance_all(bench, false);
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool load_programmes(struct bench *bench)
{
    struct programme *subject = &bench->subject, *machine = &bench->machine;
    subject->options = *bench->options;
    subject->options.setup.frames = bench->warmup + bench->frames;
    machine->options = subject->options;
    char *templates = templates_folder(&bench->console->log);
    char *spec = templates ? format_string("%s/machine.yaml", templates) : NULL;
    machine->options.setup.spec = spec;
    machine->options.setup.sets = NULL;
    machine->options.setup.set_count = 0;
    bool good = spec &&
                pipeline_load(&subject->pipeline, bench->console, &subject->options.setup) &&
                inputs_load(&subject->pipeline, bench->console, &subject->options.setup);
    memcpy(machine->options.setup.size, subject->options.setup.size,
           sizeof machine->options.setup.size);
    good = good && pipeline_load(&machine->pipeline, bench->console, &machine->options.setup);
    bench->options = &subject->options; /* with the size of an input */
    free(spec);
    free(templates);
    return good;
}

static bool bench_prepare(struct bench *bench)
{
    const struct dt_log *log = &bench->console->log;
    bench->list = calloc(bench->sides.count, sizeof *bench->list);
    bench->copy_ms = calloc(bench->frames, sizeof *bench->copy_ms);
    bench->original = malloc(2 * (size_t)COPY_BYTES);
    if (!bench->list || !bench->copy_ms || !bench->original)
        return report_error(log, "out of memory");
    memset(bench->original, 1, 2 * (size_t)COPY_BYTES); /* touches all pages before timing */
    return load_programmes(bench) &&
           session_load_scene(&bench->scene, bench->console, bench->subject.pipeline.info,
                              &bench->options->setup);
}

static void bench_release(struct bench *bench)
{
    for (uint32_t i = 0; bench->list && i < bench->sides.count; i++) {
        lane_free(&bench->list[i].whole);
        lane_free(&bench->list[i].passes);
        lane_free(&bench->list[i].machine);
    }
    free(bench->list);
    free(bench->copy_ms);
    free(bench->original);
    scene_free(&bench->scene);
    pipeline_unload(&bench->subject.pipeline);
    pipeline_unload(&bench->machine.pipeline);
    sides_free(&bench->sides);
}

int verb_bench(struct console *console, const struct options *options)
{
    struct bench bench = {.console = console,
                          .options = options,
                          .frames = options->run_frames ? options->run_frames : DEFAULT_FRAMES,
                          .warmup = options->warmup ? options->warmup : DEFAULT_WARMUP};
    if (!sides_read_each(&bench.sides, &options->setup, &console->log)) {
        sides_free(&bench.sides);
        return EXIT_USAGE;
    }
    bool good = bench_prepare(&bench) && run_all(&bench);
    cJSON *request = good ? options_json(options, VERB_BENCH) : NULL;
    if (good)
        add_all(&bench, request);
    bench_release(&bench);
    return good ? python_verb(console, "bench", request) : EXIT_FAILED;
}
