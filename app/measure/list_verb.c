/* `diptych list`: what a pipeline has; with --gpu, what a chip's compiler makes of each pass. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/cost.h"
#include "spec/inputs.h"
#include "spec/list.h"

struct listing {
    struct pipeline pipeline;
    struct cost_gpu gpu;     /* count 0: not asked */
    struct cost_frame frame; /* the same */
};

/* "    navi21   compute: 20 waves (registers), 48 VGPRs, no spills, 27136 bytes of code" */
static void print_stages(const void *user, uint32_t pass, int width)
{
    const struct listing *listing = user;
    const struct cost_gpu *gpu = &listing->gpu;
    for (uint32_t i = 0; i < gpu->count; i++) {
        const struct cost_stage *stage = &gpu->stages[i];
        const double *n = stage->numbers;
        if (stage->pass != pass)
            continue;
        const char *limit = cost_limit(gpu->chip, &listing->frame.passes[pass], stage);
        bool large = n[COST_CODE] > gpu->chip->code_kib * 1024;
        printf("  %-*s  %s %s: %.0f waves%s%s%s, %.0f VGPRs, ", width, "", gpu->chip->name,
               stage->stage, n[COST_WAVES], *limit ? " (" : "", limit, *limit ? ")" : "",
               n[COST_VGPRS]);
        if (n[COST_SPILLS] > 0)
            printf("%.0f spills", n[COST_SPILLS]);
        else
            printf("no spills");
        printf(", %.0f bytes of code%s\n", n[COST_CODE],
               large ? ", more than the instruction cache" : "");
    }
}

static bool ask(struct listing *listing, const char *name, const struct setup *setup,
                struct console *console)
{
    const struct cost_chip *chip = cost_chip(name, strlen(name), &console->log);
    return chip && cost_has_radv(&console->log) &&
           cost_ask(&listing->gpu, chip, NULL, &listing->pipeline, console) &&
           cost_count(&listing->frame, &listing->pipeline, NULL, setup->size, &console->log);
}

/* Adds `stages` to each pass. */
static void add_stages(const struct listing *listing, cJSON *root)
{
    uint32_t pass = 0;
    cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(root, "passes")) cJSON_AddItemToObject(
        item, "stages", cost_stages_json(&listing->gpu, &listing->frame, pass++));
}

/* The spec and all files that it is made of. */
static void add_files(cJSON *root, const struct pipeline *pipeline)
{
    uint32_t count;
    const char *const *files = plan_sources(pipeline->plan, &count);
    cJSON_AddStringToObject(root, "spec", pipeline->spec);
    cJSON_AddItemToObject(root, "files", cJSON_CreateStringArray(files, (int)count));
}

int verb_list(struct console *console, const struct options *options)
{
    struct setup setup = options->setup;
    struct listing listing = {0};
    setup.for_gpu = options->gpu;
    bool good = pipeline_load(&listing.pipeline, console, &setup) &&
                inputs_find_size(&listing.pipeline, &setup, &console->log) &&
                (!options->gpu || ask(&listing, options->gpu, &setup, console));
    if (good) {
        list_print(&listing.pipeline, setup.size, options->gpu ? print_stages : NULL, &listing);
        console->result = list_json(&listing.pipeline, setup.size);
        add_files(console->result, &listing.pipeline);
        if (options->gpu)
            add_stages(&listing, console->result);
    }
    cost_gpu_free(&listing.gpu);
    free(listing.frame.passes);
    pipeline_unload(&listing.pipeline);
    return good ? EXIT_FINE : EXIT_FAILED;
}
