/* JSON of `cost`, and what has changed since an earlier one; see cost.h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "measure/cost.h"

static void add_number(cJSON *parent, const char *name, double value)
{
    if (isnan(value))
        cJSON_AddNullToObject(parent, name);
    else
        cJSON_AddNumberToObject(parent, name, value);
}

static cJSON *stage_json(const struct cost_gpu *gpu, const struct cost_work *work,
                         const struct cost_stage *stage)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "stage", stage->stage);
    cJSON_AddNumberToObject(item, "subgroup", stage->subgroup);
    for (int i = 0; i < COST_NUMBERS; i++)
        add_number(item, cost_names[i], stage->numbers[i]);
    cJSON_AddStringToObject(item, "limit", cost_limit(gpu->chip, work, stage));
    add_number(item, "started", cost_waves(work, stage));
    return item;
}

cJSON *cost_stages_json(const struct cost_gpu *gpu, const struct cost_frame *frame, uint32_t pass)
{
    cJSON *stages = cJSON_CreateArray();
    for (uint32_t i = 0; i < gpu->count; i++)
        if (gpu->stages[i].pass == pass)
            cJSON_AddItemToArray(stages, stage_json(gpu, &frame->passes[pass], &gpu->stages[i]));
    return stages;
}

static cJSON *pass_json(const struct cost_gpu *gpu, const struct cost_frame *frame, uint32_t pass)
{
    cJSON *item = cJSON_CreateObject();
    struct cost_times times = cost_times(gpu, frame, pass);
    cJSON_AddStringToObject(item, "pass", frame->pipeline->info->passes[pass].name);
    cJSON_AddNumberToObject(item, "bytes", frame->passes[pass].bytes);
    add_number(item, "arithmetic_ms", times.arithmetic);
    add_number(item, "wave_ms", times.latency);
    add_number(item, "bytes_ms", times.memory);
    add_number(item, "bound_ms", times.bound);
    if (gpu->measured)
        add_number(item, "measured_ms", gpu->measured[pass]);
    cJSON_AddItemToObject(item, "stages", cost_stages_json(gpu, frame, pass));
    return item;
}

static cJSON *chip_json(const struct cost_chip *chip)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "product", chip->product);
    cJSON_AddNumberToObject(item, "simds", chip->simds);
    cJSON_AddNumberToObject(item, "ghz", chip->ghz);
    cJSON_AddNumberToObject(item, "gb_s", chip->gb_s);
    cJSON_AddNumberToObject(item, "code_kib", chip->code_kib);
    return item;
}

static cJSON *gpu_json(const struct cost_gpu *gpu, const struct cost_frame *frame)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "gpu", gpu->chip ? gpu->chip->name : gpu->device);
    cJSON_AddStringToObject(item, "device", gpu->device);
    cJSON_AddStringToObject(item, "driver", gpu->driver);
    if (gpu->chip) {
        struct cost_sums sums = cost_sums(gpu, frame);
        cJSON_AddItemToObject(item, "chip", chip_json(gpu->chip));
        cJSON_AddNumberToObject(item, "pixel_ms", sums.pixel);
        cJSON_AddNumberToObject(item, "other_wave_ms", sums.latency);
        cJSON_AddNumberToObject(item, "bound_ms", sums.bound);
        cJSON_AddNumberToObject(item, "open_passes", sums.open);
    }
    cJSON *passes = cJSON_AddArrayToObject(item, "passes");
    for (uint32_t i = 0; i < frame->pipeline->info->pass_count; i++)
        cJSON_AddItemToArray(passes, pass_json(gpu, frame, i));
    return item;
}

cJSON *cost_json(const struct cost_gpu *gpus, uint32_t count, const struct cost_frame *frame,
                 const struct setup *setup)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", frame->pipeline->info->name);
    cJSON_AddStringToObject(root, "scene", setup->scene ? setup->scene : "");
    cJSON *sets = cJSON_AddArrayToObject(root, "sets");
    for (uint32_t i = 0; i < setup->set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(setup->sets[i]));
    cJSON_AddNumberToObject(root, "width", frame->size[0]);
    cJSON_AddNumberToObject(root, "height", frame->size[1]);
    cJSON *list = cJSON_AddArrayToObject(root, "gpus");
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(list, gpu_json(&gpus[i], frame));
    return root;
}

/* ---- Against an earlier one ------------------------------------------------------------------ */

/* The item of a list whose member `key` is `name`. */
static const cJSON *find(const cJSON *list, const char *key, const char *name)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(item, key));
        if (text && strcmp(text, name) == 0)
            return item;
    }
    return NULL;
}

static const char *text_of(const cJSON *item, const char *key)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(item, key));
    return text ? text : "";
}

static double number_of(const cJSON *item, const char *key)
{
    const cJSON *number = cJSON_GetObjectItem(item, key);
    return cJSON_IsNumber(number) ? number->valuedouble : NAN;
}

/* Numbers that are worse when they grow, or (waves) when they shrink, by more than the limit. */
static const struct {
    enum cost_number number;
    bool shrinks, counts;
} compared[] = {
    {COST_CYCLES, false, true},        {COST_WAVES, true, true},     {COST_SPILLS, false, true},
    {COST_INSTRUCTIONS, false, false}, {COST_VGPRS, false, false},   {COST_CODE, false, false},
    {COST_LDS, false, false},          {COST_LATENCY, false, false},
};

/* Prints what has changed; whether it is worse beyond the limit. */
static bool stage_against(const cJSON *before, const cJSON *now, const char *pass, double limit)
{
    bool worse = false, told = false;
    for (size_t i = 0; i < DT_ARRAY_COUNT(compared); i++) {
        const char *name = cost_names[compared[i].number];
        double old = number_of(before, name), new = number_of(now, name);
        if (isnan(old) || isnan(new) || old == new)
            continue;
        if (!told)
            printf("  %s, %s:", pass, text_of(now, "stage"));
        printf(" %s %.0f -> %.0f", name, old, new);
        if (old > 0)
            printf(" (%+.1f %%)", (new - old) / old * 100);
        told = true;
        worse |= compared[i].counts &&
                 (compared[i].shrinks ? new < old *(1 - limit) : new > old *(1 + limit));
    }
    if (told)
        printf("%s\n", worse ? "  WORSE" : "");
    return worse;
}

static bool pass_against(const cJSON *before, const cJSON *now, double limit)
{
    const cJSON *stage, *old_stages = cJSON_GetObjectItem(before, "stages");
    const char *name = text_of(now, "pass");
    bool worse = false;
    if (!before)
        printf("  %s: new\n", name);
    cJSON_ArrayForEach(stage, cJSON_GetObjectItem(now, "stages"))
    {
        const cJSON *old = find(old_stages, "stage", text_of(stage, "stage"));
        worse |= old && stage_against(old, stage, name, limit);
    }
    return worse;
}

static uint32_t gpu_against(const cJSON *before, const cJSON *now, double limit)
{
    const cJSON *pass, *old = cJSON_GetObjectItem(before, "passes"),
                       *new = cJSON_GetObjectItem(now, "passes");
    uint32_t worse = 0;
    printf("%s, against the earlier figures:\n", text_of(now, "gpu"));
    if (strcmp(text_of(before, "driver"), text_of(now, "driver")) != 0)
        printf("  another driver, whose compiler may differ: %s, now %s\n",
               text_of(before, "driver"), text_of(now, "driver"));
    cJSON_ArrayForEach(pass, new) worse +=
        pass_against(find(old, "pass", text_of(pass, "pass")), pass, limit);
    cJSON_ArrayForEach(pass, old) if (!find(new, "pass", text_of(pass, "pass")))
        printf("  %s: gone\n", text_of(pass, "pass"));
    double was = number_of(before, "pixel_ms"), is = number_of(now, "pixel_ms");
    if (!isnan(was) && !isnan(is))
        printf("  passes of every pixel: %.3f -> %.3f ms\n", was, is);
    printf("  %u passes are worse by more than %.3g %%\n", worse, limit * 100);
    return worse;
}

/* Parses a file; NULL: cannot be read, logged, or is no JSON. */
static cJSON *read_json(const char *path, const struct dt_log *log)
{
    size_t size;
    char *text = file_read(path, &size, log);
    cJSON *root = text ? cJSON_Parse(text) : NULL;
    if (text && !root)
        report_error(log, "%s: is not JSON", path);
    free(text);
    return root;
}

static bool is_comparable(const cJSON *earlier, const cJSON *now, const char *path,
                          const struct dt_log *log)
{
    const char *old = text_of(earlier, "pipeline"), *new = text_of(now, "pipeline");
    if (!cJSON_GetObjectItem(earlier, "gpus"))
        report_error(log, "%s: not a file that `cost --json` wrote", path);
    else if (strcmp(old, new) != 0)
        report_error(log, "%s: of the pipeline %s, not of %s", path, old, new);
    else
        return true;
    return false;
}

bool cost_against(const cJSON *now, const char *path, double limit, uint32_t *worse,
                  const struct dt_log *log)
{
    cJSON *earlier = read_json(path, log);
    bool good = earlier && is_comparable(earlier, now, path, log);
    const cJSON *gpu;
    *worse = 0;
    cJSON_ArrayForEach(gpu, cJSON_GetObjectItem(now, "gpus"))
    {
        const cJSON *old = find(cJSON_GetObjectItem(earlier, "gpus"), "gpu", text_of(gpu, "gpu"));
        if (good && !old) {
            report_error(log, "%s: has no figures of %s", path, text_of(gpu, "gpu"));
            good = false;
        }
        *worse += good ? gpu_against(old, gpu, limit) : 0;
    }
    cJSON_Delete(earlier);
    return good;
}

/* ---- Measured times -------------------------------------------------------------------------- */

static const cJSON *find_side(const cJSON *bench, const struct cost_gpu *gpu)
{
    const cJSON *side;
    cJSON_ArrayForEach(side, cJSON_GetObjectItem(bench, "sides"))
    {
        const char *device = text_of(side, "device");
        if (strcmp(device, gpu->device) == 0 || (gpu->chip && cost_chip_of(device) == gpu->chip))
            return side;
    }
    return NULL;
}

bool cost_measured(struct cost_gpu *gpu, const struct dt_pipeline *info, const char *path,
                   const struct dt_log *log)
{
    cJSON *bench = read_json(path, log);
    const cJSON *side = find_side(bench, gpu);
    gpu->measured = side ? calloc(info->pass_count + 1, sizeof *gpu->measured) : NULL;
    for (uint32_t i = 0; gpu->measured && i < info->pass_count; i++) {
        const cJSON *pass = find(cJSON_GetObjectItem(side, "passes"), "pass", info->passes[i].name);
        gpu->measured[i] = number_of(cJSON_GetObjectItem(pass, "ms"), "median");
    }
    if (bench && !gpu->measured)
        report_error(log, "%s: has no times of %s", path, gpu->device);
    cJSON_Delete(bench);
    return gpu->measured;
}
