/* `diptych compare`: the first side against each of the others, every resource compared after every
 * pass. The sides walk through the passes side by side, and no more than one resource of each is in
 * memory. */
#include "compare.h"

#include <stdlib.h>
#include <string.h>

#include "files.h"

enum { COULD_NOT_RUN = 2 };

/* Resources without history are filled with these before the first frame, so that what no pass has
 * written differs in every pair. */
enum { POISON_FIRST = 0x5a, POISON_OTHERS = 0xa5 };

/* ---- One row --------------------------------------------------------------------------------- */

static bool is_worse(const struct difference *a, const struct difference *b)
{
    if (difference_verdict(a) != difference_verdict(b))
        return difference_verdict(a) > difference_verdict(b);
    if (a->beyond != b->beyond)
        return a->beyond > b->beyond;
    if (a->differing != b->differing)
        return a->differing > b->differing;
    return a->worst.valid && (!b->worst.valid || a->worst.error > b->worst.error);
}

static bool compare_pair(struct compare *compare, struct pair *pair, const struct row *row,
                         uint32_t frame, const struct dt_bytes copies[2])
{
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    pair->found = (struct difference){0};
    if (!difference_add(&pair->found, resource, frame, copies)) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    compare->compared += pair->found.elements;
    return true;
}

/* The margins by which the flips that were just found had been decided. */
static bool add_margins(struct compare *compare, uint32_t index, const struct row *row)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const struct dt_resource *resource = &info->resources[row->resource];
    const struct row margin = {.pass = row->pass, .resource = resource->contract.margin_resource};
    struct source *sources[2] = {&compare->sources[0], &compare->sources[index + 1]};
    struct dt_bytes copies[2];
    if (!difference_needs_margins(&compare->pairs[index].found, resource))
        return true;
    for (int i = 0; i < 2; i++) {
        if (!source_ask(sources[i], &margin) || !source_take(sources[i], &margin, &copies[i]))
            return false;
    }
    difference_add_margins(&compare->pairs[index].found, resource,
                           &info->resources[margin.resource], copies);
    return true;
}

static void keep_result(struct pair *pair, uint32_t index, uint32_t frame)
{
    struct result *result = &pair->results[index];
    enum verdict verdict = difference_verdict(&pair->found);
    result->frames_differing += verdict != VERDICT_EQUAL;
    if (!result->difference.elements || is_worse(&pair->found, &result->difference)) {
        result->difference = pair->found;
        result->frame = frame;
    }
    if (!pair->broken && verdict == VERDICT_DIFFERS) {
        pair->broken = true;
        pair->broken_frame = frame;
        pair->broken_row = index;
    }
}

static bool compare_row(struct compare *compare, uint32_t index, uint32_t frame)
{
    const struct row *row = &compare->rows.outputs.list[index];
    struct dt_bytes copies[2];
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        if (!source_ask(&compare->sources[i], row))
            return false;
    }
    if (!source_take(&compare->sources[0], row, &copies[0]))
        return false;
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        if (!source_take(&compare->sources[i + 1], row, &copies[1]) ||
            !compare_pair(compare, &compare->pairs[i], row, frame, copies))
            return false;
    }
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        if (!add_margins(compare, i, row))
            return false;
        keep_result(&compare->pairs[i], index, frame);
    }
    return true;
}

/* ---- The walk -------------------------------------------------------------------------------- */

static bool advance(struct compare *compare, struct worker_place place)
{
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        if (!source_resume(&compare->sources[i]))
            return false;
    }
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        if (!source_reach(&compare->sources[i], place))
            return false;
    }
    return true;
}

static bool run_frame(struct compare *compare, uint32_t frame)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const uint32_t *first = compare->rows.outputs.first;
    for (uint32_t pass = 0; pass < info->pass_count; pass++) {
        console_status(compare->console, "frame %u of %u, pass %s", frame + 1,
                       compare->options->frames, info->passes[pass].name);
        if (!advance(compare, (struct worker_place){WORKER_AFTER_PASS, frame, pass}))
            return false;
        for (uint32_t i = first[pass]; i < first[pass + 1]; i++) {
            if (!compare_row(compare, i, frame))
                return false;
        }
    }
    return advance(compare, (struct worker_place){WORKER_FRAME_DONE, frame, 0});
}

static bool start(struct compare *compare, uint32_t index)
{
    struct worker_info info = {.session = {.side = &compare->sides.list[index],
                                           .console = compare->console,
                                           .options = compare->options,
                                           .pipeline = &compare->pipeline,
                                           .scene = &compare->scene,
                                           .poison = index ? POISON_OTHERS : POISON_FIRST},
                               .frames = compare->options->frames};
    if (index == compare->faulty)
        info.session.fault = compare->fault;
    return source_start(&compare->sources[index], &info);
}

static bool start_all(struct compare *compare)
{
    console_status(compare->console, "opening the devices and creating the programs");
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        if (!start(compare, i))
            return false;
    }
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        if (!source_reach(&compare->sources[i], (struct worker_place){.stop = WORKER_READY}))
            return false;
        compare->devices[i] = strdup(source_device(&compare->sources[i]));
    }
    return true;
}

static bool run_all(struct compare *compare)
{
    uint32_t frames = compare->options->frames;
    bool good = start_all(compare);
    for (uint32_t frame = 0; frame < frames && good; frame++)
        good = run_frame(compare, frame);
    good =
        good && advance(compare, (struct worker_place){.stop = WORKER_FINISHED, .frame = frames});
    for (uint32_t i = 0; i < compare->sides.count; i++)
        source_close(&compare->sources[i]);
    return good;
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool allocate(struct compare *compare)
{
    uint32_t sides = compare->sides.count;
    compare->pair_count = sides - 1;
    compare->sources = calloc(sides, sizeof *compare->sources);
    compare->devices = calloc(sides, sizeof *compare->devices);
    compare->pairs = calloc(sides, sizeof *compare->pairs);
    bool good = compare->sources && compare->devices && compare->pairs;
    for (uint32_t i = 0; i < compare->pair_count && good; i++) {
        struct pair *pair = &compare->pairs[i];
        pair->sides[0] = &compare->sides.list[0];
        pair->sides[1] = &compare->sides.list[i + 1];
        pair->results = calloc(compare->rows.outputs.count, sizeof *pair->results);
        good = pair->results;
    }
    if (!good)
        report_error(&compare->console->log, "out of memory");
    return good;
}

static void release(struct compare *compare)
{
    for (uint32_t i = 0; i < compare->pair_count; i++)
        free(compare->pairs[i].results);
    for (uint32_t i = 0; compare->devices && i < compare->sides.count; i++)
        free(compare->devices[i]);
    free(compare->pairs);
    free(compare->devices);
    free(compare->sources);
    rows_free(&compare->rows);
    scene_free(&compare->scene);
    pipeline_unload(&compare->pipeline);
    sides_free(&compare->sides);
}

static bool find_fault(struct compare *compare)
{
    const char **labels = calloc(compare->sides.count, sizeof *labels);
    if (!labels) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < compare->sides.count; i++)
        labels[i] = compare->sides.list[i].label;
    bool good =
        fault_parse(&compare->fault, &compare->faulty, compare->options->fault,
                    compare->pipeline.info, labels, compare->sides.count, &compare->console->log);
    free(labels);
    return good;
}

/* A comparison of nothing would agree, whatever is wrong. */
static bool compares_something(const struct compare *compare, uint64_t count, const char *what)
{
    if (!count)
        report_error(&compare->console->log, "%s: %s, there is nothing to compare",
                     compare->pipeline.info->name, what);
    return count;
}

static bool run(struct compare *compare)
{
    struct console *console = compare->console;
    const struct options *options = compare->options;
    if (!sides_read(&compare->sides, options, &console->log))
        return false;
    if (options->json && !file_can_write(options->json, &console->log))
        return false;
    if (!pipeline_load(&compare->pipeline, console, options) ||
        !rows_make(&compare->rows, compare->pipeline.info, &console->log))
        return false;
    if (!compares_something(compare, compare->rows.outputs.count, "no pass writes anything") ||
        (options->fault && !find_fault(compare)))
        return false;
    if (!session_load_scene(&compare->scene, console, options) || !allocate(compare))
        return false;
    return run_all(compare) &&
           compares_something(compare, compare->compared, "all resources are empty") &&
           atomic_load(&console->errors) == 0;
}

int verb_compare(struct console *console, const struct options *options)
{
    struct compare compare = {.console = console, .options = options};
    bool differ = false;
    bool good = run(&compare);
    if (good && options->json)
        good = compare_write_json(&compare);
    console_status(console, "%s", "");
    if (good)
        compare_print(&compare);
    for (uint32_t i = 0; i < compare.pair_count; i++)
        differ |= compare.pairs[i].broken;
    release(&compare);
    return !good ? COULD_NOT_RUN : differ ? EXIT_DIFFER : EXIT_FINE;
}
