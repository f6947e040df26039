/* The tables that `cost` prints; see cost.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "measure/cost.h"

static int name_width(const struct dt_pipeline *info)
{
    size_t width = strlen("pass");
    for (uint32_t i = 0; i < info->pass_count; i++)
        width = strlen(info->passes[i].name) > width ? strlen(info->passes[i].name) : width;
    return (int)width;
}

static void print_number(int width, double value, int digits)
{
    if (isnan(value))
        printf(" %*s", width, "-");
    else
        printf(" %*.*f", width, digits, value);
}

static void print_head(int width, bool measured)
{
    printf("%-*s %-8s %5s %5s %-9s %6s %7s %6s %6s %7s %8s %8s %8s %8s %8s%s\n", width, "pass",
           "stage", "VGPRs", "waves", "limit", "spills", "code", "LDS", "instr", "cycles",
           "latency", "started", "ms", "wave ms", "bytes ms", measured ? " measured" : "");
}

static void print_stage(const struct cost_gpu *gpu, const struct cost_work *work,
                        const struct cost_stage *stage)
{
    const double *n = stage->numbers;
    const char *limit = cost_limit(gpu->chip, work, stage);
    bool large = gpu->chip && n[COST_CODE] > gpu->chip->code_kib * 1024;
    printf(" %-8s", stage->stage);
    print_number(5, n[COST_VGPRS], 0);
    print_number(5, n[COST_WAVES], 0);
    printf(" %-9s", limit);
    print_number(6, n[COST_SPILLS], 0);
    print_number(6, n[COST_CODE], 0);
    printf("%c", large ? '!' : ' ');
    print_number(6, n[COST_LDS], 0);
    print_number(6, n[COST_INSTRUCTIONS], 0);
    print_number(7, n[COST_CYCLES], 0);
    print_number(8, n[COST_LATENCY], 0);
    print_number(8, cost_waves(work, stage), 0);
}

static void print_passes(const struct cost_gpu *gpu, const struct cost_frame *frame, int width)
{
    const struct dt_pipeline *info = frame->pipeline->info;
    for (uint32_t i = 0; i < gpu->count; i++) {
        const struct cost_stage *stage = &gpu->stages[i];
        bool first = i == 0 || gpu->stages[i - 1].pass != stage->pass;
        bool last = i + 1 == gpu->count || gpu->stages[i + 1].pass != stage->pass;
        printf("%-*s", width, first ? info->passes[stage->pass].name : "");
        print_stage(gpu, &frame->passes[stage->pass], stage);
        if (last && gpu->chip) {
            struct cost_times times = cost_times(gpu, frame, stage->pass);
            print_number(8, times.arithmetic, 4);
            print_number(8, times.latency, 4);
            print_number(8, times.memory, 4);
        }
        if (last && gpu->measured)
            print_number(8, gpu->measured[stage->pass], 4);
        printf("\n");
    }
}

static void print_sums(const struct cost_gpu *gpu, const struct cost_frame *frame)
{
    struct cost_sums sums = cost_sums(gpu, frame);
    printf("passes of every pixel: %.3f ms; one wave of each other pass: %.3f ms; all, by the "
           "larger bound: %.3f ms\n",
           sums.pixel, sums.latency, sums.bound);
    if (sums.open)
        printf("%u passes are not in this sum: a shader or a scene says how often they run\n",
               sums.open);
}

void cost_print(const struct cost_gpu *gpu, const struct cost_frame *frame)
{
    const struct dt_pipeline *info = frame->pipeline->info;
    int width = name_width(info);
    printf("%s, %ux%u, %s: %s; %s\n", info->name, frame->size[0], frame->size[1],
           gpu->chip ? gpu->chip->product : "unknown chip", gpu->device, gpu->driver);
    print_head(width, gpu->measured);
    print_passes(gpu, frame, width);
    if (gpu->chip)
        print_sums(gpu, frame);
    printf("\n");
}
