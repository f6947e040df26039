/* Counts what a frame runs, by recording it without a device, and computes bounds of times from that. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "picture/texels.h"
#include "measure/bench_work.h"
#include "measure/cost.h"
#include "panel.h"

/* ---- Counts ---------------------------------------------------------------------------------- */

struct counter {
    struct cost_frame *frame;
    const struct scene *scene; /* NULL: none */
    bool has_area;
    struct dt_rect area; /* viewport of the pass */
};

static struct cost_work *work_at(void *user, uint32_t pass)
{
    struct counter *counter = user;
    return &counter->frame->passes[pass];
}

static bool begin(void *user, uint32_t pass, bool runs)
{
    struct counter *counter = user;
    counter->has_area = false;
    work_at(user, pass)->runs = runs;
    return true;
}

static bool barriers(void *user, uint32_t pass, const struct dt_barrier *list, uint32_t count)
{
    (void)user, (void)pass, (void)list, (void)count;
    return true;
}

static bool nothing(void *user, uint32_t pass)
{
    (void)user, (void)pass;
    return true;
}

static bool viewport(void *user, uint32_t pass, struct dt_rect area)
{
    (void)pass;
    struct counter *counter = user;
    counter->area = area;
    counter->has_area = true;
    return true;
}

static bool scissor(void *user, uint32_t pass, struct dt_rect area)
{
    return viewport(user, pass, area);
}

static bool clear_targets(void *user, uint32_t pass, uint32_t layers)
{
    (void)user, (void)pass, (void)layers;
    return true;
}

static bool clear_buffer(void *user, uint32_t pass, uint32_t resource)
{
    (void)user, (void)pass, (void)resource;
    return true;
}

static bool clear_image(void *user, uint32_t pass, uint32_t resource, uint32_t mip)
{
    (void)user, (void)pass, (void)resource, (void)mip;
    return true;
}

static bool dispatch(void *user, uint32_t pass, uint32_t x, uint32_t y, uint32_t z)
{
    work_at(user, pass)->groups = (uint64_t)x * y * z;
    return true;
}

static bool dispatch_indirect(void *user, uint32_t pass, uint32_t arguments)
{
    (void)arguments;
    work_at(user, pass)->open = true;
    return true;
}

/* A draw of `vertices`, UINT64_MAX: not known. */
static bool draw(void *user, uint32_t pass, uint32_t layers, uint64_t vertices)
{
    struct counter *counter = user;
    struct cost_work *work = work_at(user, pass);
    const struct pipeline *pipeline = counter->frame->pipeline;
    const struct dt_program *program = &pipeline->vk->panel->programs[pass];
    const struct dt_target *target = program->color_count ? program->colors : program->depth;
    uint32_t extent[3];
    resource_extent(pipeline->info, target->resource, counter->frame->size, target->mip, extent);
    uint64_t pixels = (uint64_t)extent[0] * extent[1], area = pixels;
    if (counter->has_area)
        area = (uint64_t)counter->area.width * counter->area.height;
    work->pixels = (area < pixels ? area : pixels) * layers;
    work->open = vertices == UINT64_MAX;
    work->vertices = work->open ? 0 : vertices * layers;
    return true;
}

static bool draw_scene(void *user, uint32_t pass, uint32_t layers)
{
    const struct counter *counter = user;
    return draw(user, pass, layers, counter->scene ? counter->scene->data.index_count : UINT64_MAX);
}

static bool draw_indirect(void *user, uint32_t pass, uint32_t layers, uint32_t indices,
                          uint32_t arguments)
{
    (void)indices, (void)arguments;
    return draw(user, pass, layers, UINT64_MAX);
}

static bool draw_fullscreen(void *user, uint32_t pass, uint32_t layers)
{
    return draw(user, pass, layers, 3);
}

static bool draw_vertices(void *user, uint32_t pass, uint32_t layers, uint32_t vertices,
                          uint32_t instances)
{
    return draw(user, pass, layers, (uint64_t)vertices * instances);
}

static bool draw_vertices_indirect(void *user, uint32_t pass, uint32_t layers, uint32_t arguments)
{
    (void)arguments;
    return draw(user, pass, layers, UINT64_MAX);
}

static const struct dt_verbs counting = {
    .begin = begin,
    .barriers = barriers,
    .bind = nothing,
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
    .end = nothing,
};

bool cost_count(struct cost_frame *frame, const struct pipeline *pipeline,
                const struct scene *scene, const uint32_t size[2], const struct dt_log *log)
{
    const struct dt_pipeline *info = pipeline->info;
    *frame = (struct cost_frame){.pipeline = pipeline,
                                 .size = {size[0], size[1]},
                                 .passes = calloc(info->pass_count + 1, sizeof *frame->passes)};
    struct counter counter = {.frame = frame, .scene = scene};
    const struct dt_recording recording = {.verbs = &counting,
                                           .runtime = &counter,
                                           .width = size[0],
                                           .height = size[1],
                                           .live = pipeline->live,
                                           .panel = pipeline->vk->panel};
    const struct work_frame bytes = {.pipeline = info,
                                     .size = {size[0], size[1]},
                                     .vertex_count = scene ? scene->data.vertex_count : 0,
                                     .index_count = scene ? scene->data.index_count : 0};
    if (!frame->passes || !recording.panel->record(&recording))
        return report_error(log, "out of memory");
    for (uint32_t i = 0; i < info->pass_count; i++) {
        struct work work = work_of(&bytes, i);
        frame->passes[i].bytes = work.read + work.written;
        frame->passes[i].local = plan_group(pipeline->plan, i);
    }
    return true;
}

/* ---- Bounds ---------------------------------------------------------------------------------- */

static double waves_of(uint64_t invocations, uint32_t subgroup)
{
    return ceil((double)invocations / subgroup);
}

double cost_waves(const struct cost_work *work, const struct cost_stage *stage)
{
    if (!work->runs)
        return 0;
    if (strcmp(stage->stage, "compute") == 0)
        return work->open ? NAN : (double)work->groups * waves_of(work->local, stage->subgroup);
    if (strcmp(stage->stage, "fragment") == 0)
        return waves_of(work->pixels, stage->subgroup);
    return work->open ? NAN : waves_of(work->vertices, stage->subgroup);
}

const char *cost_limit(const struct cost_chip *chip, const struct cost_work *work,
                       const struct cost_stage *stage)
{
    double waves = stage->numbers[COST_WAVES];
    if (!chip || isnan(waves) || isnan(stage->numbers[COST_VGPRS]))
        return "";
    /* RADV counts waves of 32 where a chip has them: twice as many */
    double unit = chip->most_waves > 10 ? 64.0 / 32 : 1;
    double narrow = stage->subgroup == 32 ? 2 : 1;
    double registers = ceil(stage->numbers[COST_VGPRS] / (chip->granularity * narrow)) *
                       chip->granularity * narrow;
    double most = floor(chip->vgprs * narrow / registers) / narrow * unit;
    if (strcmp(stage->stage, "compute") == 0) {
        double group = waves_of(work->local, stage->subgroup) / chip->group_simds / narrow * unit;
        if (group > 0 && waves >= group && floor(waves / group) * group < waves)
            return "group";
    }
    if (waves >= chip->most_waves)
        return "";
    return waves < most ? "LDS" : "registers";
}

static double pass_memory(const struct cost_gpu *gpu, const struct cost_work *work)
{
    return work->bytes / (gpu->chip->gb_s * 1e6);
}

struct cost_times cost_times(const struct cost_gpu *gpu, const struct cost_frame *frame,
                             uint32_t pass)
{
    struct cost_times times = {NAN, NAN, NAN, NAN};
    const struct cost_work *work = &frame->passes[pass];
    if (!gpu->chip)
        return times;
    double cycles_per_ms = gpu->chip->ghz * 1e6;
    times = (struct cost_times){0};
    for (uint32_t i = 0; i < gpu->count && work->runs; i++) {
        const struct cost_stage *stage = &gpu->stages[i];
        if (stage->pass != pass)
            continue;
        times.arithmetic += cost_waves(work, stage) * stage->numbers[COST_CYCLES] /
                            gpu->chip->simds / cycles_per_ms;
        times.latency += stage->numbers[COST_LATENCY] / cycles_per_ms;
    }
    times.memory = work->runs ? pass_memory(gpu, work) : 0;
    times.bound =
        isnan(times.arithmetic) ? NAN : fmax(fmax(times.arithmetic, times.latency), times.memory);
    return times;
}

/* Whether it computes or fills every pixel of the frame at least; drawn scenes do not count, which their
 * triangles cost. */
static bool covers_frame(const struct cost_frame *frame, uint32_t pass)
{
    const struct cost_work *work = &frame->passes[pass];
    enum dt_pass_kind kind = frame->pipeline->info->passes[pass].kind;
    uint64_t pixels = (uint64_t)frame->size[0] * frame->size[1];
    return work->runs && (kind == DT_PASS_DISPATCH          ? work->groups * work->local >= pixels
                          : kind == DT_PASS_DRAW_FULLSCREEN ? work->pixels >= pixels
                                                            : false);
}

struct cost_sums cost_sums(const struct cost_gpu *gpu, const struct cost_frame *frame)
{
    struct cost_sums sums = {0};
    for (uint32_t i = 0; i < frame->pipeline->info->pass_count; i++) {
        struct cost_times times = cost_times(gpu, frame, i);
        sums.open += isnan(times.bound);
        sums.bound += isnan(times.bound) ? 0 : times.bound;
        if (covers_frame(frame, i))
            sums.pixel += times.arithmetic;
        else
            sums.latency += isnan(times.latency) ? 0 : times.latency;
    }
    return sums;
}
