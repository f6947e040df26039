/* `diptych bench`: times of every pass. Each backend runs in its own processes, and the processes
 * take turns frame by frame: other load on the machine then affects all backends alike, and ratios
 * compare times that were measured side by side. */
#include "measure/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/tool.h"
#include "spec/inputs.h"

enum { DEFAULT_FRAMES = 20, DEFAULT_WARMUP = 3 };

/* ---- Lanes ----------------------------------------------------------------------------------- */

static bool lane_allocate(struct lane *lane, uint32_t frames, bool timing)
{
    lane->frame_ms = calloc(frames, sizeof *lane->frame_ms);
    lane->record_ms = calloc(frames, sizeof *lane->record_ms);
    if (timing)
        lane->pass_ms = calloc((size_t)frames * lane->info->pass_count + 1, sizeof *lane->pass_ms);
    return lane->frame_ms && lane->record_ms && (!timing || lane->pass_ms);
}

bool lane_start(struct lane *lane, struct bench *bench, const struct side *side,
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
bool lane_advance(struct lane *lane, bool taken)
{
    struct worker_place place;
    return worker_resume(&lane->worker, DT_RUN) && worker_wait(&lane->worker, &place) &&
           (!taken || lane_take(lane));
}

void lane_free(struct lane *lane)
{
    worker_close(&lane->worker);
    free(lane->frame_ms);
    free(lane->record_ms);
    free(lane->pass_ms);
}

struct spread bench_pass_ms(const struct lane *lane, uint32_t pass)
{
    return spread_of(lane->pass_ms + pass, lane->taken, lane->info->pass_count);
}

/* ---- What there is to do, and what can be done ------------------------------------------------ */

struct work bench_work(const struct bench *bench, const struct programme *programme, uint32_t pass)
{
    const struct work_frame frame = {
        .pipeline = programme->pipeline.info,
        .size = {programme->options.setup.size[0], programme->options.setup.size[1]},
        .vertex_count = bench->scene.data.vertex_count,
        .index_count = bench->scene.data.index_count};
    return work_of(&frame, pass);
}

struct ceiling bench_ceiling(const struct bench *bench, const struct bench_side *side)
{
    struct ceiling ceiling = {0};
    for (uint32_t i = 0; i < side->machine.info->pass_count; i++) {
        struct work work = bench_work(bench, &bench->machine, i);
        double ms = bench_pass_ms(&side->machine, i).median;
        ceiling.bytes_per_ms = fmax(ceiling.bytes_per_ms, (work.read + work.written) / ms);
    }
    return ceiling;
}

double bench_copy_bytes_per_ms(const struct bench *bench)
{
    return 2.0 * COPY_BYTES / spread_of(bench->copy_ms, bench->frames, 1).median;
}

double bench_floor_ms(const struct work *work, const struct ceiling *ceiling)
{
    return (work->read + work->written) / ceiling->bytes_per_ms;
}

static void copy_on_cpu(struct bench *bench, uint32_t at)
{
    double start = milliseconds_now();
    memcpy(bench->original + COPY_BYTES, bench->original, COPY_BYTES);
    bench->copy_ms[at] = milliseconds_now() - start;
    bench->original[at % COPY_BYTES]++; /* so that every copy moves new data */
}

/* ---- The run --------------------------------------------------------------------------------- */

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
    if (good) {
        bench_print(&bench);
        console->result = bench_json(&bench);
    }
    bench_release(&bench);
    return good ? EXIT_FINE : EXIT_FAILED;
}
