/* `diptych bench`: how long every pass of a pipeline takes. Every backend runs in processes of its
 * own that take turns frame by frame, so that whatever else goes on in the machine meets all of
 * them alike, and what is divided by each other was measured side by side. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>

#include "files.h"

enum { DEFAULT_FRAMES = 20, DEFAULT_WARMUP = 3 };

/* ---- Lanes ----------------------------------------------------------------------------------- */

static bool lane_allocate(struct lane *lane, uint32_t frames, bool timing)
{
    lane->frame_ms = calloc(frames, sizeof *lane->frame_ms);
    lane->record_ms = calloc(frames, sizeof *lane->record_ms);
    lane->own_allocations = calloc(frames, sizeof *lane->own_allocations);
    lane->all_allocations = calloc(frames, sizeof *lane->all_allocations);
    if (timing)
        lane->pass_ms = calloc((size_t)frames * lane->info->pass_count + 1, sizeof *lane->pass_ms);
    return lane->frame_ms && lane->record_ms && lane->own_allocations && lane->all_allocations &&
           (!timing || lane->pass_ms);
}

static bool lane_start(struct lane *lane, struct bench *bench, const struct side *side, bool timing)
{
    const struct worker_info info = {.session = {.side = side,
                                                 .console = bench->console,
                                                 .options = &bench->options,
                                                 .pipeline = &bench->pipeline,
                                                 .scene = &bench->scene,
                                                 .timing = timing},
                                     .frames = bench->options.frames,
                                     .first_observed = bench->options.frames,
                                     .stops_after_frames = true,
                                     .quiet = timing};
    struct worker_place place;
    lane->info = bench->pipeline.info;
    if (!lane_allocate(lane, bench->frames, timing)) {
        report_error(&bench->console->log, "out of memory for the times of %u frames",
                     bench->frames);
        return false;
    }
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
    lane->own_allocations[at] = (double)measure.allocations.own;
    lane->all_allocations[at] = (double)measure.allocations.all;
    for (uint32_t i = 0; lane->pass_ms && i < lane->info->pass_count; i++)
        lane->pass_ms[(size_t)at * lane->info->pass_count + i] = measure.pass_ms[i];
    return true;
}

/* Runs to the end of the next frame, or behind the last to the end of all. */
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
    free(lane->own_allocations);
    free(lane->all_allocations);
    free(lane->pass_ms);
}

struct spread bench_pass_ms(const struct lane *lane, uint32_t pass)
{
    return spread_of(lane->pass_ms + pass, lane->taken, lane->info->pass_count);
}

/* ---- The run --------------------------------------------------------------------------------- */

static bool start_all(struct bench *bench)
{
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        struct bench_side *side = &bench->list[i];
        side->side = &bench->sides.list[i];
        if (!lane_start(&side->whole, bench, side->side, false) ||
            !lane_start(&side->passes, bench, side->side, true))
            return false;
    }
    return true;
}

static bool advance_all(struct bench *bench, bool taken)
{
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        if (!lane_advance(&bench->list[i].whole, taken) ||
            !lane_advance(&bench->list[i].passes, taken))
            return false;
    }
    return true;
}

static bool run_all(struct bench *bench)
{
    console_status(bench->console, "opening the devices and creating the programs");
    if (!start_all(bench))
        return false;
    for (uint32_t i = 0; i < bench->options.frames; i++) {
        console_status(bench->console, "frame %u of %u", i + 1, bench->options.frames);
        if (!advance_all(bench, i >= bench->warmup))
            return false;
    }
    return advance_all(bench, false);
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool prepare(struct bench *bench)
{
    const struct options *options = &bench->options;
    const struct dt_log *log = &bench->console->log;
    if (options->json && !file_can_write(options->json, log))
        return false;
    bench->list = calloc(bench->sides.count, sizeof *bench->list);
    if (!bench->list)
        report_error(log, "out of memory");
    return bench->list && pipeline_load(&bench->pipeline, bench->console, options) &&
           session_load_scene(&bench->scene, bench->console, options);
}

int verb_bench(struct console *console, const struct options *options)
{
    struct bench bench = {.console = console,
                          .options = *options,
                          .frames = options->run_frames ? options->run_frames : DEFAULT_FRAMES,
                          .warmup = options->warmup ? options->warmup : DEFAULT_WARMUP};
    bench.options.frames = bench.frames + bench.warmup;
    if (!sides_read_each(&bench.sides, options, &console->log)) {
        sides_free(&bench.sides);
        return EXIT_USAGE;
    }
    bool good = prepare(&bench) && run_all(&bench);
    if (good)
        bench_print(&bench);
    good = good && (!options->json || bench_write_json(&bench));
    for (uint32_t i = 0; bench.list && i < bench.sides.count; i++) {
        lane_free(&bench.list[i].whole);
        lane_free(&bench.list[i].passes);
    }
    free(bench.list);
    scene_free(&bench.scene);
    pipeline_unload(&bench.pipeline);
    sides_free(&bench.sides);
    return good ? EXIT_FINE : EXIT_FAILED;
}
