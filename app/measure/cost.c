/* `diptych cost`: what a frame costs on a GPU, without one: the figures of its compiler and arithmetic. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/cost.h"
#include "run/session.h"
#include "spec/inputs.h"

enum { MAX_GPUS = 16 };

static const char unknown[] = "Bounds by arithmetic. Not known: rasterization, caches, hidden "
                              "latency, how passes overlap; loops "
                              "count as if they turned a few times.\n"
                              "waves: most on a SIMD, and what keeps them from being more. "
                              "started: waves of a frame. ms: they "
                              "keep all SIMDs busy;\nwave ms: one of each stage; bytes ms: all "
                              "that is read and written, once, at the "
                              "memory's rate. !: more than the instruction cache.\n";

struct costing {
    struct console *console;
    struct options *options;
    struct pipeline pipeline;
    struct scene scene;
    struct cost_frame frame;
    struct cost_gpu gpus[MAX_GPUS];
    uint32_t count;
};

/* "5%" or "5" */
static bool read_limit(const char *text, double *limit, const struct dt_log *log)
{
    char *end;
    *limit = strtod(text ? text : "5", &end) / 100;
    return ((!text || end != text) && (!*end || strcmp(end, "%") == 0) && isfinite(*limit) &&
            *limit >= 0) ||
           report_error(log, "--limit %s: must be a percentage, like 5%%", text);
}

/* The next name of a list with commas, or NULL at its end. */
static const char *next_name(const char **at, size_t *length)
{
    const char *name = *at;
    *length = strcspn(name, ",");
    *at = name + *length + (name[*length] == ',');
    return *name ? name : NULL;
}

static bool check_gpus(const struct options *options, const struct dt_log *log)
{
    const char *at = options->gpu ? options->gpu : "", *name;
    size_t length;
    uint32_t count = 0;
    if (options->gpu && options->setup.device)
        return report_error(log, "--gpu and --device: name a chip, or a device that is there");
    while ((name = next_name(&at, &length))) {
        if (!cost_chip(name, length, log))
            return false;
        count++;
    }
    if (count > MAX_GPUS)
        return report_error(log, "--gpu: must name at most %d chips", MAX_GPUS);
    return options->setup.device || cost_has_radv(log);
}

static bool ask_gpus(struct costing *costing)
{
    const struct options *options = costing->options;
    const char *at = options->gpu ? options->gpu : "navi21", *name;
    size_t length;
    if (options->setup.device)
        return cost_ask(&costing->gpus[costing->count++], NULL, options->setup.device,
                        &costing->pipeline, costing->console);
    while ((name = next_name(&at, &length))) {
        const struct cost_chip *chip = cost_chip(name, length, &costing->console->log);
        if (!cost_ask(&costing->gpus[costing->count++], chip, NULL, &costing->pipeline,
                      costing->console))
            return false;
    }
    return true;
}

static bool add_times(struct costing *costing)
{
    const char *path = costing->options->bench;
    bool good = true;
    for (uint32_t i = 0; path && good && i < costing->count; i++)
        good =
            cost_measured(&costing->gpus[i], costing->pipeline.info, path, &costing->console->log);
    return good;
}

static bool prepare(struct costing *costing)
{
    struct console *console = costing->console;
    struct setup *setup = &costing->options->setup;
    setup->for_gpu = true;
    if (!pipeline_load(&costing->pipeline, console, setup) ||
        !inputs_find_size(&costing->pipeline, setup, &console->log) ||
        (setup->scene &&
         !session_load_scene(&costing->scene, console, costing->pipeline.info, setup)))
        return false;
    return cost_count(&costing->frame, &costing->pipeline, setup->scene ? &costing->scene : NULL,
                      setup->size, &console->log);
}

static int report_cost(struct costing *costing, double limit)
{
    struct console *console = costing->console;
    uint32_t worse = 0;
    for (uint32_t i = 0; i < costing->count; i++)
        cost_print(&costing->gpus[i], &costing->frame);
    fputs(unknown, stdout);
    console->result =
        cost_json(costing->gpus, costing->count, &costing->frame, &costing->options->setup);
    if (costing->options->earlier &&
        !cost_against(console->result, costing->options->earlier, limit, &worse, &console->log))
        return EXIT_USAGE;
    return worse ? EXIT_DIFFER : EXIT_FINE;
}

int verb_cost(struct console *console, const struct options *options)
{
    struct options own = *options;
    struct costing costing = {.console = console, .options = &own};
    double limit;
    bool good = read_limit(options->limit, &limit, &console->log) &&
                check_gpus(options, &console->log) && prepare(&costing) && ask_gpus(&costing) &&
                add_times(&costing);
    int status = good ? report_cost(&costing, limit) : EXIT_USAGE;
    for (uint32_t i = 0; i < costing.count; i++)
        cost_gpu_free(&costing.gpus[i]);
    free(costing.frame.passes);
    if (options->setup.scene)
        scene_free(&costing.scene);
    pipeline_unload(&costing.pipeline);
    return status;
}
