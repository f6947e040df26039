/* What `compare` prints of a spec's pair: devices, table (result/sheet.c draws it), outcome and verdict; see compare.h. */
#include <cjson/cJSON.h>
#include <stdio.h>

#include "compare/compare.h"
#include "theirs/why.h"

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

static void print_verdict(const struct pair *pair)
{
    const struct blame *blame = &pair->blame;
    const struct sheet_row *row = blame->row;
    switch (blame->outcome) {
    case BLAME_GUILTY:
        why_print(row->why, row->name);
        printf("guilty: pass %s", row->pass);
        if (row->body)
            printf(" (shader %s)", row->body);
        printf(": resource %s, in frame %u\n", row->name, blame->frame);
        break;
    case BLAME_INHERITED:
        printf(
            "no pass is guilty alone: the error of pass %s, resource %s, in frame %u, adds up from "
            "errors that contracts allow\n",
            row->pass, row->name, blame->frame);
        break;
    case BLAME_EARLIER:
        printf("no pass of frame %u is guilty: resource %s differed when it began\n", blame->frame,
               row->name);
        break;
    case BLAME_NOT_REPEATABLE:
        printf("%s is not repeatable: pass %s wrote another %s when it ran again, in frame %u\n",
               blame->side->label, row->pass, row->name, blame->frame);
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
    if (pair->sheet.on_equal_inputs && !compare->twins)
        print_edges(compare, pair);
    if (sheet_print_odd(&pair->sheet))
        return;
    if (!pair->broken && !pair->sheet.agree) {
        printf("the first runs agree, but not all do\n");
        return;
    }
    if (!pair->broken) {
        if (!compare_far_twin(compare))
            print_agreement(info);
        return;
    }
    const struct sheet_row *row = pair->broken;
    if (sheet_is_early(&pair->sheet, row))
        printf("%s is the first to break: before frame %u\n", row->name, pair->broken_frame);
    else
        printf("pass %s is the first to break: %s, in frame %u\n", row->pass, row->name,
               pair->broken_frame);
    if (pair->unwritten)
        printf("%s\n", pair->unwritten);
    print_verdict(pair);
}

/* The region, the folder of --bisect, and the generated shaders of the guilty pass. */
static void print_clues(const struct compare *compare, const struct pair *pair)
{
    const struct sheet_row *row = pair->blame.row;
    if (pair->blame.outcome != BLAME_GUILTY)
        return;
    if (compare->region)
        printf("%s: %s\nkept in %s: diptych replay %s --backend %s\n", row->name, compare->region,
               compare->options.bisect, compare->options.bisect, pair->sides[1]->label);
    printf("body: %s; what each backend compiles of it: diptych-gen %s -o DIR\n", row->body,
           compare->pipeline.spec);
}

static bool print_pair(const struct compare *compare, const struct pair *pair)
{
    bool good = true;
    if (compare->pair_count > 1)
        printf("\n%s against %s\n", pair->sides[1]->label, pair->sides[0]->label);
    if (pair->sheet.on_equal_inputs)
        printf("\neach pass of frame %u on the inputs of %s\n", pair->blame.frame,
               pair->sides[0]->label);
    printf("\n");
    sheet_print(&pair->sheet);
    if (pair->sheet.runs)
        good = measured_print(&pair->sheet, compare->console);
    measured_grown(&pair->sheet);
    return good;
}

bool compare_print(const struct compare *compare)
{
    bool several = compare->pair_count > 1, good = true;
    const struct pair *told = &compare->pairs[0]; /* the first that differs, or leaves NaN */
    for (uint32_t i = 0; i < compare->sides.count; i++)
        printf("%s: %s\n", compare->sides.list[i].label, compare->devices[i]);
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        const struct pair *pair = &compare->pairs[i];
        good &= print_pair(compare, pair);
        printf("\n");
        if (several)
            print_outcome(compare, pair);
        bool odd = pair->sheet.not_finite.row && told->sheet.agree;
        told = (pair->broken && !told->broken) || odd ? pair : told;
    }
    if (several && told->broken)
        printf("\n%s against %s differ\n", told->sides[1]->label, told->sides[0]->label);
    else if (several)
        printf("\n%u pairs agree\n", compare->pair_count);
    for (uint32_t i = 0; compare->twins && i < compare->sides.count; i++) {
        const struct sheet *sheet = &compare->twins[i].sheet;
        if (!sheet->rows) /* a dump */
            continue;
        printf("\n%s against exact twins of its passes, on equal inputs\n", sheet->labels[0]);
        sheet_print(sheet);
    }
    if (compare->twins)
        printf("\n");
    elsewhere_print(&compare->elsewhere);
    print_clues(compare, told);
    print_outcome(compare, told); /* the last line is the verdict */
    const struct twin *far = compare_far_twin(compare);
    if (far)
        printf("too far from exact: pass %s (shader %s): resource %s on %s\n", far->broken->pass,
               far->broken->body, far->broken->name, far->sheet.labels[0]);
    return good;
}
