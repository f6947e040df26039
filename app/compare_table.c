/* The table that `compare` prints; see compare.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compare.h"

struct widths {
    int pass, resource;
};

static void print_row(const struct compare *compare, const struct pair *pair, uint32_t index,
                      const struct widths *widths)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const struct row *row = &compare->rows.outputs.list[index];
    const struct dt_resource *resource = &info->resources[row->resource];
    const struct difference *difference = &pair->results[index].difference;
    const char *const labels[2] = {pair->sides[0]->label, pair->sides[1]->label};
    char *worst = difference_describe_worst(difference, resource, labels);
    char *flips = difference_list_flips(difference, resource, labels);
    printf("%-*s  %-*s  %10llu  %10llu  %-7s  %s\n%s", widths->pass, info->passes[row->pass].name,
           widths->resource, row->name, (unsigned long long)difference->elements,
           (unsigned long long)difference->differing, verdict_name(difference_verdict(difference)),
           worst ? worst : "", flips ? flips : "");
    free(worst);
    free(flips);
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

/* The one sentence that says how a pair ended. */
static void print_outcome(const struct compare *compare, const struct pair *pair)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    if (!pair->broken) {
        print_agreement(info);
        return;
    }
    const struct row *row = &compare->rows.outputs.list[pair->broken_row];
    printf("pass %s is the first to break: %s, in frame %u\n", info->passes[row->pass].name,
           row->name, pair->broken_frame);
}

static struct widths measure(const struct compare *compare)
{
    struct widths widths = {4, 8};
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
    const struct widths widths = measure(compare);
    if (compare->pair_count > 1)
        printf("\n%s against %s\n", pair->sides[1]->label, pair->sides[0]->label);
    printf("\n%-*s  %-*s  %10s  %10s  %-7s  %s\n", widths.pass, "pass", widths.resource, "resource",
           "elements", "differing", "verdict", "largest error");
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++)
        print_row(compare, pair, i, &widths);
}

void compare_print(const struct compare *compare)
{
    const struct pair *told = &compare->pairs[0]; /* the first that differs */
    for (uint32_t i = 0; i < compare->sides.count; i++)
        printf("%s: %s\n", compare->sides.list[i].label, compare->devices[i]);
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        const struct pair *pair = &compare->pairs[i];
        print_pair(compare, pair);
        told = pair->broken && !told->broken ? pair : told;
    }
    printf("\n");
    for (uint32_t i = 0; i < compare->pair_count && compare->pair_count > 1; i++) {
        printf("%s against %s: ", compare->pairs[i].sides[1]->label,
               compare->pairs[i].sides[0]->label);
        print_outcome(compare, &compare->pairs[i]);
    }
    print_outcome(compare, told);
}
