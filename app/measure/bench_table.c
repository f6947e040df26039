/* The tables that `bench` prints; see bench.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "measure/bench.h"

enum { COLUMN = 9 };

static void print_ms(double value, const char *format)
{
    char text[32] = "-";
    if (!isnan(value))
        snprintf(text, sizeof text, format, value);
    printf("  %*s", COLUMN, text);
}

/* Digits by size: 123, 1.23, 0.1234. */
static void print_spread(struct spread spread)
{
    const char *format = spread.median >= 100 ? "%.0f" : spread.median >= 1 ? "%.2f" : "%.4f";
    print_ms(spread.median, format);
    print_ms(spread.p5, format);
    print_ms(spread.p95, format);
}

static int name_width(const struct dt_pipeline *info)
{
    size_t width = strlen("copy, arithmetic");
    for (uint32_t i = 0; i < info->pass_count; i++) {
        size_t length = strlen(info->passes[i].name);
        width = length > width ? length : width;
    }
    return (int)width;
}

static double sum_of_medians(const struct lane *lane)
{
    double sum = 0;
    for (uint32_t i = 0; i < lane->info->pass_count; i++) {
        double ms = bench_pass_ms(lane, i).median;
        sum += isnan(ms) ? 0 : ms;
    }
    return sum;
}

static void print_heads(const struct bench *bench, int width)
{
    printf("%-*s", width, "milliseconds");
    for (uint32_t i = 0; i < bench->sides.count; i++)
        printf("  %*s  %*s  %*s", COLUMN, bench->sides.list[i].label, COLUMN, "p5", COLUMN, "p95");
    printf("\n");
}

static void print_times(const struct bench *bench)
{
    const struct dt_pipeline *info = bench->subject.pipeline.info;
    int width = name_width(info);
    print_heads(bench, width);
    for (uint32_t pass = 0; pass < info->pass_count; pass++) {
        printf("%-*s", width, info->passes[pass].name);
        for (uint32_t i = 0; i < bench->sides.count; i++)
            print_spread(bench_pass_ms(&bench->list[i].passes, pass));
        printf("\n");
    }
    printf("%-*s", width, "sum of passes");
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        print_ms(sum_of_medians(&bench->list[i].passes), "%.2f");
        printf("  %*s  %*s", COLUMN, "", COLUMN, "");
    }
    printf("\n%-*s", width, "frame");
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        const struct lane *lane = &bench->list[i].whole;
        print_spread(spread_of(lane->frame_ms, lane->taken, 1));
    }
    printf("\n");
}

/* Rates, with every resource counted whole and once, and the pass's time divided by its lower
 * bound. Below 1: the pass reads only parts of a resource. */
static void print_rates(const struct bench *bench, const struct bench_side *side,
                        const struct work *work, uint32_t pass)
{
    double ms = bench_pass_ms(&side->passes, pass).median;
    const struct ceiling ceiling = bench_ceiling(bench, side);
    print_ms((work->read + work->written) / ms * 1e-6, "%.2f");
    print_ms(ms / bench_floor_ms(work, &ceiling), "%.1f");
}

static void print_ceilings(const struct bench *bench, int width)
{
    printf("%-*s  %*s", width, "copy", COLUMN, "");
    for (uint32_t i = 0; i < bench->sides.count; i++) {
        const struct ceiling ceiling = bench_ceiling(bench, &bench->list[i]);
        print_ms(ceiling.bytes_per_ms * 1e-6, "%.2f");
        printf("  %*s", COLUMN, "");
    }
    printf("\n%-*s  %*s", width, "memcpy", COLUMN, "");
    print_ms(bench_copy_bytes_per_ms(bench) * 1e-6, "%.2f");
    printf("\n");
}

static void print_work(const struct bench *bench)
{
    const struct dt_pipeline *info = bench->subject.pipeline.info;
    int width = name_width(info);
    printf("%-*s  %*s", width, "resources once", COLUMN, "MB");
    for (uint32_t i = 0; i < bench->sides.count; i++)
        printf("  %*s%s  %*s", COLUMN - 5, bench->sides.list[i].label, " GB/s", COLUMN, "x floor");
    printf("\n");
    for (uint32_t pass = 0; pass < info->pass_count; pass++) {
        struct work work = bench_work(bench, &bench->subject, pass);
        printf("%-*s", width, info->passes[pass].name);
        print_ms((work.read + work.written) * 1e-6, "%.3f");
        for (uint32_t i = 0; i < bench->sides.count; i++)
            print_rates(bench, &bench->list[i], &work, pass);
        printf("\n");
    }
    print_ceilings(bench, width);
}

/* CPU time per frame. */
static void print_costs(const struct bench_side *side)
{
    const struct lane *lane = &side->whole;
    double record = spread_of(lane->record_ms, lane->taken, 1).median;
    if (!isnan(record))
        printf("%s: recording a frame takes %.1f us of CPU time\n", side->side->label,
               record * 1e3);
}

void bench_print(const struct bench *bench)
{
    const uint32_t *size = bench->options->setup.size;
    printf("%s, %s at %ux%u, %u frames after %u, in turn\n", bench->subject.pipeline.info->name,
           bench->options->setup.scene, size[0], size[1], bench->frames, bench->warmup);
    for (uint32_t i = 0; i < bench->sides.count; i++)
        printf("%s: %s\n", bench->sides.list[i].label, bench->list[i].whole.worker.device);
    printf("\n");
    print_times(bench);
    printf("\n");
    print_work(bench);
    printf("\n");
    for (uint32_t i = 0; i < bench->sides.count; i++)
        print_costs(&bench->list[i]);
}
