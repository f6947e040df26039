/* JSON of `bench`; see bench.h. */
#include <cjson/cJSON.h>
#include <math.h>

#include "measure/bench.h"

void bench_add_number(cJSON *parent, const char *name, double value)
{
    if (isnan(value))
        cJSON_AddNullToObject(parent, name);
    else
        cJSON_AddNumberToObject(parent, name, value);
}

/* {"median", "p5", "p95", "count"}, or null without a value. */
static void add_spread(cJSON *parent, const char *name, struct spread spread)
{
    if (!spread.count) {
        cJSON_AddNullToObject(parent, name);
        return;
    }
    cJSON *item = cJSON_AddObjectToObject(parent, name);
    bench_add_number(item, "median", spread.median);
    bench_add_number(item, "p5", spread.p5);
    bench_add_number(item, "p95", spread.p95);
    cJSON_AddNumberToObject(item, "count", spread.count);
}

static cJSON *side_json(const struct bench *bench, const struct bench_side *side)
{
    const struct lane *whole = &side->whole;
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "side", side->side->label);
    cJSON_AddStringToObject(item, "device", whole->worker.device);
    cJSON_AddStringToObject(item, "driver", whole->worker.driver);
    add_spread(item, "frame_ms", spread_of(whole->frame_ms, whole->taken, 1));
    add_spread(item, "timed_frame_ms", spread_of(side->passes.frame_ms, side->passes.taken, 1));
    add_spread(item, "record_ms", spread_of(whole->record_ms, whole->taken, 1));
    const struct ceiling ceiling = bench_ceiling(bench, side);
    cJSON *machine = cJSON_AddObjectToObject(item, "machine");
    bench_add_number(machine, "gb_s", ceiling.bytes_per_ms * 1e-6);
    cJSON *passes = cJSON_AddArrayToObject(item, "passes");
    for (uint32_t i = 0; i < bench->subject.pipeline.info->pass_count; i++) {
        cJSON *pass = cJSON_CreateObject();
        cJSON_AddStringToObject(pass, "pass", bench->subject.pipeline.info->passes[i].name);
        struct spread ms = bench_pass_ms(&side->passes, i);
        struct work work = bench_work(bench, &bench->subject, i);
        add_spread(pass, "ms", ms);
        bench_add_number(pass, "gb_s", (work.read + work.written) / ms.median * 1e-6);
        bench_add_number(pass, "floor_ms", bench_floor_ms(&work, &ceiling));
        cJSON_AddItemToArray(passes, pass);
    }
    return item;
}

static void add_work(cJSON *root, const struct bench *bench)
{
    cJSON *passes = cJSON_AddArrayToObject(root, "passes");
    for (uint32_t i = 0; i < bench->subject.pipeline.info->pass_count; i++) {
        struct work work = bench_work(bench, &bench->subject, i);
        cJSON *pass = cJSON_CreateObject();
        cJSON_AddStringToObject(pass, "pass", bench->subject.pipeline.info->passes[i].name);
        cJSON_AddNumberToObject(pass, "bytes_read", work.read);
        cJSON_AddNumberToObject(pass, "bytes_written", work.written);
        cJSON_AddItemToArray(passes, pass);
    }
}

cJSON *bench_json(const struct bench *bench)
{
    const struct options *options = bench->options;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", bench->subject.pipeline.info->name);
    cJSON_AddStringToObject(root, "scene", options->setup.scene);
    cJSON *sets = cJSON_AddArrayToObject(root, "sets");
    for (uint32_t i = 0; i < options->setup.set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(options->setup.sets[i]));
    cJSON_AddNumberToObject(root, "width", options->setup.size[0]);
    cJSON_AddNumberToObject(root, "height", options->setup.size[1]);
    cJSON_AddNumberToObject(root, "frames", bench->frames);
    cJSON_AddNumberToObject(root, "warmup", bench->warmup);
    bench_add_number(root, "memcpy_gb_s", bench_copy_bytes_per_ms(bench) * 1e-6);
    add_work(root, bench);
    cJSON *sides = cJSON_AddArrayToObject(root, "sides");
    for (uint32_t i = 0; i < bench->sides.count; i++)
        cJSON_AddItemToArray(sides, side_json(bench, &bench->list[i]));
    return root;
}
