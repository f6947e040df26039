/* `diptych sweep`, `report`, `tune` and `capture`, which Python does: app/python/diptych. What only this program knows is handed over. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/python.h"
#include "measure/cost.h"
#include "run/side.h"
#include "spec/inputs.h"

static int start_python(struct console *console, const struct options *options, const char *verb,
                        enum verb_id id)
{
    struct sides sides = {0};
    if (!sides_read_each(&sides, &options->setup, &console->log)) {
        sides_free(&sides);
        return EXIT_USAGE;
    }
    cJSON *request = options_json(options, id);
    cJSON *labels = cJSON_AddArrayToObject(request, "sides");
    for (uint32_t i = 0; i < sides.count; i++)
        cJSON_AddItemToArray(labels, cJSON_CreateString(sides.list[i].label));
    sides_free(&sides);
    return python_verb(console, verb, request);
}

int verb_sweep(struct console *console, const struct options *options)
{
    return start_python(console, options, "sweep", VERB_SWEEP);
}

int verb_report(struct console *console, const struct options *options)
{
    return start_python(console, options, "report", VERB_REPORT);
}

/* ---- The choices of a spec, for tune --------------------------------------------------------- */

struct choice_list {
    const struct options *options;
    cJSON *choices; /* [number of the pass, "PATH=VALUE"] */
};

/* A compiler counts any loop as a few turns, so estimates cannot choose between loops and copies. */
static bool take_choice(void *user, uint32_t pass, const char *path, const char *value)
{
    const struct choice_list *list = user;
    if (setup_sets(&list->options->setup, path) ||
        (list->options->gpu && strcmp(strrchr(path, '.'), ".loop") == 0))
        return true;
    char *set = format_string("%s=%s", path, value);
    cJSON *pair = cJSON_CreateArray();
    bool good = set && cJSON_AddItemToArray(pair, cJSON_CreateNumber(pass)) &&
                cJSON_AddItemToArray(pair, cJSON_CreateString(set)) &&
                cJSON_AddItemToArray(list->choices, pair);
    free(set);
    return good;
}

/* A device to time frames on; with --gpu, one to compare the bits on. */
static bool check_side(const struct options *options, const struct dt_log *log)
{
    const char *backend = options->setup.backend, *gpu = options->gpu;
    struct side side = {0};
    if (!backend && !gpu)
        report_error(log,
                     "--backend NAME is missing: what to tune for; or --gpu NAME, to estimate");
    bool good = (backend || gpu) &&
                (!gpu || (cost_chip(gpu, strlen(gpu), log) && cost_has_radv(log))) &&
                side_read(&side, backend ? backend : "vk", &options->setup, log);
    side_free(&side);
    return good;
}

static cJSON *tune_request(const struct options *options, const struct setup *setup,
                           const struct pipeline *pipeline)
{
    cJSON *request = options_json(options, VERB_TUNE);
    cJSON *passes = cJSON_AddArrayToObject(request, "passes");
    struct choice_list list = {options, cJSON_AddArrayToObject(request, "choices")};
    char size[32];
    snprintf(size, sizeof size, "%ux%u", setup->size[0], setup->size[1]); /* of an input */
    cJSON_DeleteItemFromObject(request, "size");
    cJSON_DeleteItemFromObject(request, "spec");
    cJSON_AddStringToObject(request, "size", size);
    cJSON_AddStringToObject(request, "spec", pipeline->spec);
    cJSON_AddStringToObject(request, "pipeline", pipeline->info->name);
    for (uint32_t i = 0; i < pipeline->info->pass_count; i++)
        cJSON_AddItemToArray(passes, cJSON_CreateString(pipeline->info->passes[i].name));
    if (plan_choices(pipeline->plan, take_choice, &list))
        return request;
    cJSON_Delete(request);
    return NULL;
}

int verb_tune(struct console *console, const struct options *options)
{
    struct setup setup = options->setup;
    struct pipeline pipeline = {0};
    setup.for_gpu = options->gpu;
    if (!check_side(options, &console->log))
        return EXIT_USAGE;
    bool good = file_can_write(options->output, &console->log) &&
                pipeline_load(&pipeline, console, &setup) &&
                inputs_load(&pipeline, console, &setup);
    cJSON *request = good ? tune_request(options, &setup, &pipeline) : NULL;
    if (good && !request)
        report_error(&console->log, "out of memory");
    pipeline_unload(&pipeline);
    return request ? python_verb(console, "tune", request) : EXIT_FAILED;
}

int verb_capture(struct console *console, const struct options *options)
{
    if (!options->dumps.count) {
        report_error(&console->log, "capture: a program is needed: capture -o FILE.rdc -- PROGRAM");
        return EXIT_USAGE;
    }
    return python_verb(console, "capture", options_json(options, VERB_CAPTURE));
}
