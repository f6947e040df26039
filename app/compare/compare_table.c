/* The table that `compare` prints; see compare.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "compare/compare.h"

struct widths {
    int pass, resource;
};

/* Two columns: whether the pass's inputs differed, and its own error. */
static void print_blame(const struct pair *pair, uint32_t index, uint32_t pass)
{
    const struct difference *own = &pair->blame.own[index];
    char error[32] = "none";
    if (own->size_differs)
        snprintf(error, sizeof error, "size");
    else if (own->differing)
        snprintf(error, sizeof error, "%llu differ", (unsigned long long)own->differing);
    else if (own->not_finite)
        snprintf(error, sizeof error, "not finite");
    printf("%-6s  %-12s  ", pair->blame.inputs_differ[pass] ? "differ" : "equal", error);
}

/* The strip's file, its layer and its amplification. */
static void print_picture(const struct dt_resource *resource, const struct result *result)
{
    if (!result->picture)
        return;
    printf("  picture %s: ", result->picture);
    if (resource->layered)
        printf("layer %u, ", result->strip.layer);
    if (result->strip.amplification > 0)
        printf("difference x %.10g\n", result->strip.amplification);
    else
        printf("differences are white\n");
}

static bool shows_blame(const struct pair *pair)
{
    return pair->blame.outcome != BLAME_NOT_RUN && !pair->on_equal_inputs;
}

/* One row: a resource after a pass, or before the first one. */
static void print_result(const struct compare *compare, const struct pair *pair,
                         const struct row *row, const struct result *result,
                         const struct widths *widths)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const struct dt_resource *resource = &info->resources[row->resource];
    const struct difference *difference = &result->difference;
    const char *const labels[2] = {pair->sides[0]->label, pair->sides[1]->label};
    bool before = result >= pair->history && result < pair->history + compare->rows.history.count;
    char *worst = difference_describe_worst(difference, resource, labels);
    char *flips = difference_list_flips(difference, resource, labels);
    printf("%-*s  %-*s  %10llu  %10llu  %-7s  ", widths->pass,
           before ? "before" : info->passes[row->pass].name, widths->resource, row->name,
           (unsigned long long)difference->elements, (unsigned long long)difference->differing,
           verdict_name(difference_verdict(difference)));
    if (shows_blame(pair) && before)
        printf("%-6s  %-12s  ", "", "");
    else if (shows_blame(pair))
        print_blame(pair, (uint32_t)(result - pair->results), row->pass);
    printf("%s\n%s", worst ? worst : "", flips ? flips : "");
    print_picture(resource, result);
    free(worst);
    free(flips);
}

/* The texels that `raster` forgives. */
static void print_edges(const struct compare *compare, const struct pair *pair)
{
    uint64_t texels = 0, differing = 0;
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++) {
        const struct row *row = &compare->rows.outputs.list[i];
        if (compare->pipeline.info->passes[row->pass].kind != DT_PASS_DRAW_SCENE)
            continue;
        texels += pair->results[i].difference.elements;
        differing += pair->results[i].difference.at_edges;
    }
    printf("on equal inputs %llu of %llu drawn texels differ, at edges within the contract\n",
           (unsigned long long)differing, (unsigned long long)texels);
}

static void print_agreement(const struct dt_pipeline *info)
{
    uint32_t resources = 0, passes = 0;
    for (uint32_t i = 0; i < info->pass_count; i++) {
        resources += info->passes[i].write_count;
        passes += info->passes[i].write_count > 0;
    }
    printf("all %u resources of %u passes agree\n", resources, passes);
}

static void print_verdict(const struct compare *compare, const struct pair *pair)
{
    const struct blame *blame = &pair->blame;
    bool early = blame->outcome == BLAME_EARLIER;
    const struct row_list *rows = early ? &compare->rows.history : &compare->rows.outputs;
    const struct row *row = &rows->list[blame->row];
    const struct dt_pass *pass = &compare->pipeline.info->passes[row->pass];
    switch (blame->outcome) {
    case BLAME_GUILTY:
        for (uint32_t i = 0; compare_knows_why(pair) && i < pair->why.count; i++)
            printf("%s %s: %s\n", i ? "or  " : "why:", row->name, pair->why.reasons[i].text);
        printf("guilty: pass %s", pass->name);
        if (pass->shader)
            printf(" (shader %s)", pass->shader);
        printf(": resource %s, in frame %u\n", row->name, blame->frame);
        break;
    case BLAME_INHERITED:
        printf(
            "no pass is guilty alone: the error of pass %s, resource %s, in frame %u, adds up from "
            "errors that contracts allow\n",
            pass->name, row->name, blame->frame);
        break;
    case BLAME_EARLIER:
        printf("no pass of frame %u is guilty: resource %s differed when it began\n", blame->frame,
               row->name);
        break;
    case BLAME_NOT_REPEATABLE:
        printf("%s is not repeatable: pass %s wrote another %s when it ran again, in frame %u\n",
               blame->side->label, pass->name, row->name, blame->frame);
        break;
    case BLAME_WITHIN:
    case BLAME_NOT_RUN:
        break;
    }
}

/* The outcome of a pair. */
static void print_outcome(const struct compare *compare, const struct pair *pair)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    if (pair->on_equal_inputs)
        print_edges(compare, pair);
    if (!pair->broken) {
        print_agreement(info);
        return;
    }
    const struct row *row = broken_row(compare, pair);
    if (pair->broken_early)
        printf("%s is the first to break: before frame %u\n", row->name, pair->broken_frame);
    else
        printf("pass %s is the first to break: %s, in frame %u\n", info->passes[row->pass].name,
               row->name, pair->broken_frame);
    print_verdict(compare, pair);
}

/* The region, the folder of --bisect, and the generated shaders of the guilty pass. */
static void print_clues(const struct compare *compare, const struct pair *pair)
{
    const struct row *row = &compare->rows.outputs.list[pair->blame.row];
    if (pair->blame.outcome != BLAME_GUILTY)
        return;
    if (compare->region)
        printf("%s: %s\nkept in %s: diptych replay %s --backend %s\n", row->name, compare->region,
               compare->options.bisect, compare->options.bisect, pair->sides[1]->label);
    printf("body: %s; what each backend compiles of it: diptych-gen %s -o DIR\n",
           compare->pipeline.info->passes[row->pass].shader, compare->pipeline.spec);
}

static struct widths measure_columns(const struct compare *compare)
{
    struct widths widths = {6, 8};
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++) {
        const struct row *row = &compare->rows.outputs.list[i];
        int pass = (int)strlen(compare->pipeline.info->passes[row->pass].name);
        int resource = (int)strlen(row->name);
        widths.pass = pass > widths.pass ? pass : widths.pass;
        widths.resource = resource > widths.resource ? resource : widths.resource;
    }
    return widths;
}

static void print_pair(const struct compare *compare, const struct pair *pair)
{
    const struct widths widths = measure_columns(compare);
    if (compare->pair_count > 1)
        printf("\n%s against %s\n", pair->sides[1]->label, pair->sides[0]->label);
    bool replayed = shows_blame(pair);
    if (pair->on_equal_inputs)
        printf("\neach pass of frame %u on the inputs of %s\n", pair->blame.frame,
               pair->sides[0]->label);
    printf("\n%-*s  %-*s  %10s  %10s  %-7s  %slargest error\n", widths.pass, "pass",
           widths.resource, "resource", "elements", "differing", "verdict",
           replayed ? "inputs  own error     " : "");
    for (uint32_t i = 0; i < compare->rows.history.count; i++)
        if (difference_verdict(&pair->history[i].difference) != VERDICT_EQUAL)
            print_result(compare, pair, &compare->rows.history.list[i], &pair->history[i], &widths);
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++)
        print_result(compare, pair, &compare->rows.outputs.list[i], &pair->results[i], &widths);
}

void compare_print(const struct compare *compare)
{
    bool several = compare->pair_count > 1;
    const struct pair *told = &compare->pairs[0]; /* the first that differs */
    for (uint32_t i = 0; i < compare->sides.count; i++)
        printf("%s: %s\n", compare->sides.list[i].label, compare->devices[i]);
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        const struct pair *pair = &compare->pairs[i];
        print_pair(compare, pair);
        printf("\n");
        if (several)
            print_outcome(compare, pair);
        told = pair->broken && !told->broken ? pair : told;
    }
    if (several && told->broken)
        printf("\n%s against %s differ\n", told->sides[1]->label, told->sides[0]->label);
    else if (several)
        printf("\n%u pairs agree\n", compare->pair_count);
    print_clues(compare, told);
    print_outcome(compare, told);
}
