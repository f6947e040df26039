/* `diptych list`: what a pipeline has, and `diptych cost`: also what it does in a frame, and what a GPU's compiler makes of it,
 * for Python: app/python/diptych/listing.py and cost.py. */
#include "measure/cost.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/python.h"
#include "picture/texels.h"
#include "run/session.h"
#include "spec/inputs.h"
#include "spec/list.h"

enum { MAX_GPUS = 16 };

struct costing {
    struct console *console;
    struct setup setup; /* its size is that of --input, if it was not given */
    struct pipeline pipeline;
    struct scene scene;
    cJSON *request;
};

static double bytes_of(const struct work_frame *frame, uint32_t resource, uint32_t mips)
{
    const struct dt_resource *info = &frame->pipeline->resources[resource];
    double bytes = 0;
    for (uint32_t mip = 0; mips >> mip; mip++) {
        uint32_t extent[3];
        resource_extent(frame->pipeline, resource, frame->size, mip, extent);
        if (mips >> mip & 1)
            bytes += (double)resource_elements(info, extent) * resource_stride(info);
    }
    return bytes;
}

struct work work_of(const struct work_frame *frame, uint32_t index)
{
    const struct dt_pass *pass = &frame->pipeline->passes[index];
    struct work work = {0};
    for (uint32_t i = 0; i < pass->read_count; i++)
        work.read += bytes_of(frame, pass->reads[i],
                              resource_mips_before(frame->pipeline, index, pass->reads[i]));
    for (uint32_t i = 0; i < pass->write_count; i++)
        work.written +=
            bytes_of(frame, pass->writes[i], pass->write_mips ? pass->write_mips[i] : 1);
    if (pass->kind == DT_PASS_DRAW_SCENE)
        work.read += (double)frame->vertex_count * sizeof(struct dt_vertex) +
                     (double)frame->index_count * sizeof(uint32_t);
    return work;
}

/* The pixels of a draw's first target, or of the viewport or scissor in it; 0: a dispatch. */
static double drawn_pixels(const struct costing *costing, uint32_t pass,
                           const struct plan_work *work)
{
    const struct dt_program *program = &costing->pipeline.vk->panel->programs[pass];
    const struct dt_target *target = program->color_count ? program->colors : program->depth;
    uint32_t extent[3];
    if (!target)
        return 0;
    resource_extent(costing->pipeline.info, target->resource, costing->setup.size, target->mip,
                    extent);
    double all = (double)extent[0] * extent[1];
    return work->has_area ? fmin(all, (double)work->area.width * work->area.height) : all;
}

/* Adds `work` to each pass: workgroup, pixels and bytes of one frame, by the plan. */
static void add_work(const struct costing *costing)
{
    const cJSON *list = cJSON_GetObjectItem(costing->request, "list");
    const struct setup *setup = &costing->setup;
    const struct work_frame frame = {.pipeline = costing->pipeline.info,
                                     .size = {setup->size[0], setup->size[1]},
                                     .vertex_count = costing->scene.data.vertex_count,
                                     .index_count = costing->scene.data.index_count};
    uint32_t pass = 0;
    cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(list, "passes"))
    {
        const struct plan *plan = costing->pipeline.plan;
        struct plan_work does = plan_work(plan, pass, setup->size, costing->pipeline.live);
        struct work bytes = work_of(&frame, pass);
        cJSON *work = cJSON_AddObjectToObject(item, "work");
        cJSON_AddBoolToObject(work, "runs", does.runs);
        cJSON_AddNumberToObject(work, "local", plan_group(plan, pass));
        cJSON_AddNumberToObject(work, "pixels", drawn_pixels(costing, pass, &does));
        cJSON_AddNumberToObject(work, "bytes", bytes.read + bytes.written);
        pass++;
    }
}

static bool take_pipeline(struct costing *costing)
{
    struct console *console = costing->console;
    struct setup *setup = &costing->setup;
    if (!pipeline_load(&costing->pipeline, console, setup) ||
        !inputs_find_size(&costing->pipeline, setup, &console->log) ||
        (setup->scene &&
         !session_load_scene(&costing->scene, console, costing->pipeline.info, setup)))
        return false;
    uint32_t count;
    const char *const *files = plan_sources(costing->pipeline.plan, &count);
    cJSON *list = list_json(&costing->pipeline, setup->size);
    cJSON_AddStringToObject(list, "spec", costing->pipeline.spec);
    cJSON_AddItemToObject(list, "files", cJSON_CreateStringArray(files, (int)count));
    cJSON_AddItemToObject(costing->request, "list", list);
    if (setup->scene)
        cJSON_AddNumberToObject(costing->request, "indices", costing->scene.data.index_count);
    return true;
}

/* Adds what the device tells, or each chip of a list with commas between. */
static bool ask(struct costing *costing, const char *device, const char *names)
{
    const struct dt_log *log = &costing->console->log;
    cJSON *gpus = cJSON_AddArrayToObject(costing->request, "gpus");
    bool good = true;
    for (size_t length; good && (device || *names); device = NULL, names += length) {
        length = device ? strlen(names) : strcspn(names, ",");
        const struct cost_chip *chip = device ? NULL : cost_chip(names, length, log);
        cJSON *gpu = cost_ask(chip, device, &costing->pipeline, costing->console);
        good = gpu && cJSON_AddItemToArray(gpus, gpu);
        length += names[length] == ',';
    }
    return good;
}

static bool check_gpus(const char *names, const struct dt_log *log)
{
    uint32_t count = 0;
    for (size_t length; names && *names; names += length + (names[length] == ','), count++) {
        length = strcspn(names, ",");
        if (!cost_chip(names, length, log))
            return false;
    }
    return count <= MAX_GPUS || report_error(log, "--gpu: must name at most %d chips", MAX_GPUS);
}

/* "5%" or "5" */
static bool read_limit(cJSON *request, const char *text, const struct dt_log *log)
{
    char *end;
    double limit = strtod(text ? text : "5", &end) / 100;
    cJSON_DeleteItemFromObject(request, "limit");
    cJSON_AddNumberToObject(request, "limit", limit);
    return ((!text || end != text) && (!*end || strcmp(end, "%") == 0) && isfinite(limit) &&
            limit >= 0) ||
           report_error(log, "--limit %s: must be a percentage, like 5%%", text);
}

/* Hands over to Python, or ends with that status. */
static int finish(struct costing *costing, bool good, const char *verb, int failed)
{
    if (costing->setup.scene)
        scene_free(&costing->scene);
    pipeline_unload(&costing->pipeline);
    if (good)
        return python_verb(costing->console, verb, costing->request);
    cJSON_Delete(costing->request);
    return failed;
}

int verb_cost(struct console *console, const struct options *options)
{
    struct costing costing = {.console = console, .setup = options->setup};
    const char *device = options->setup.device, *names = options->gpu;
    costing.setup.for_gpu = true;
    costing.request = options_json(options, VERB_COST);
    bool good = read_limit(costing.request, options->limit, &console->log);
    if (good && names && device)
        good = report_error(&console->log,
                            "--gpu and --device: name a chip, or a device that is there");
    good = good && check_gpus(names, &console->log) && (device || cost_has_radv(&console->log)) &&
           take_pipeline(&costing);
    if (good) {
        add_work(&costing);
        good = ask(&costing, device, device ? "" : names ? names : "navi21");
    }
    return finish(&costing, good, "cost", EXIT_USAGE);
}

int verb_list(struct console *console, const struct options *options)
{
    struct costing costing = {.console = console, .setup = options->setup};
    costing.setup.scene = NULL;
    costing.request = options_json(options, VERB_LIST);
    return finish(&costing, take_pipeline(&costing), "list", EXIT_FAILED);
}
