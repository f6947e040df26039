/* The table that `compare` prints; see compare.h. */
#include <stdio.h>
#include <stdlib.h>

#include "base/files.h"
#include "compare/compare.h"

static bool shows_blame(const struct pair *pair)
{
    return pair->blame.outcome != BLAME_NOT_RUN && !pair->on_equal_inputs;
}

/* Whether the pass's inputs differed, and its own error. */
static void write_own(char text[40], const struct pair *pair, uint32_t index, uint32_t pass)
{
    const struct difference *own = &pair->blame.own[index];
    char error[32] = "none";
    if (own->size_differs)
        snprintf(error, sizeof error, "size");
    else if (own->differing)
        snprintf(error, sizeof error, "%llu differ", (unsigned long long)own->differing);
    else if (own->not_finite)
        snprintf(error, sizeof error, "not finite");
    snprintf(text, 40, "%-6s  %-12s", pair->blame.inputs_differ[pass] ? "differ" : "equal", error);
}

static struct sheet_row row_of(const struct compare *compare, const struct row *row,
                               const struct result *result, const char *pass)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    return (struct sheet_row){.pass = pass,
                              .name = row->name,
                              .resource = &info->resources[row->resource],
                              .difference = &result->difference,
                              .shown = &result->shown};
}

bool compare_sheet(const struct compare *compare, const struct pair *pair,
                   enum sheet_history history, struct sheet *sheet)
{
    const struct rows *rows = &compare->rows;
    const struct dt_pipeline *info = compare->pipeline.info;
    uint32_t other = (uint32_t)(pair->sides[1] - compare->sides.list);
    *sheet = (struct sheet){
        .title = format_string("%s: %s against %s", info->name, pair->sides[1]->label,
                               pair->sides[0]->label),
        .labels = {pair->sides[0]->label, pair->sides[1]->label},
        .devices = {compare->devices[0], compare->devices[other]},
        .columns = shows_blame(pair) ? "inputs  own error   " : NULL,
        .rows = calloc(rows->history.count + rows->outputs.count, sizeof *sheet->rows)};
    if (!sheet->title || !sheet->rows) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < rows->history.count && history; i++)
        if (history == HISTORY_ALL ||
            difference_verdict(&pair->history[i].difference) != VERDICT_EQUAL)
            sheet->rows[sheet->count++] =
                row_of(compare, &rows->history.list[i], &pair->history[i], "before");
    for (uint32_t i = 0; i < rows->outputs.count; i++) {
        const struct row *row = &rows->outputs.list[i];
        const struct dt_pass *pass = &info->passes[row->pass];
        struct sheet_row *shown = &sheet->rows[sheet->count++];
        *shown = row_of(compare, row, &pair->results[i], pass->name);
        shown->text = pair->unwritten && row == broken_row(compare, pair) ? pair->unwritten : NULL;
        shown->body = pass->shader;
        if (shows_blame(pair))
            write_own(shown->own, pair, i, row->pass);
    }
    return true;
}

void compare_free_sheet(struct sheet *sheet)
{
    free((char *)sheet->title);
    free(sheet->rows);
    *sheet = (struct sheet){0};
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
    const struct twin *twin;
    if (pair->on_equal_inputs && !compare->twins)
        print_edges(compare, pair);
    if (!pair->broken && !compare_agrees(pair)) {
        printf("the first runs agree, but not all do\n");
        return;
    }
    if (!pair->broken) {
        if (!compare_far_side(compare, &twin))
            print_agreement(info);
        return;
    }
    const struct row *row = broken_row(compare, pair);
    if (pair->broken_early)
        printf("%s is the first to break: before frame %u\n", row->name, pair->broken_frame);
    else
        printf("pass %s is the first to break: %s, in frame %u\n", info->passes[row->pass].name,
               row->name, pair->broken_frame);
    if (pair->unwritten)
        printf("%s\n", pair->unwritten);
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

/* What is larger than when contracts were measured. */
static void print_grown(const struct compare *compare, const struct pair *pair)
{
    for (uint32_t i = 0; i < pair->measured.count; i++)
        measured_grown(&pair->measured, &pair->measured.rows[i]);
    for (uint32_t i = 0; i < compare->rows.outputs.count && !pair->measured.rows; i++) {
        const struct row *row = &compare->rows.outputs.list[i];
        const char *name = compare->pipeline.info->resources[row->resource].name;
        measured_compare(contracts_find(&compare->contracts, "", name), MEASURED_BACKENDS, "", name,
                         difference_error(&pair->results[i].difference));
    }
}

static bool print_pair(const struct compare *compare, const struct pair *pair)
{
    struct sheet sheet;
    if (compare->pair_count > 1)
        printf("\n%s against %s\n", pair->sides[1]->label, pair->sides[0]->label);
    if (pair->on_equal_inputs)
        printf("\neach pass of frame %u on the inputs of %s\n", pair->blame.frame,
               pair->sides[0]->label);
    printf("\n");
    bool good = compare_sheet(compare, pair, HISTORY_DIFFERING, &sheet);
    if (good)
        sheet_print(&sheet);
    compare_free_sheet(&sheet);
    if (pair->measured.rows)
        measured_print(&pair->measured);
    print_grown(compare, pair);
    return good;
}

/* How far a side is from exact arithmetic, pass by pass. */
static bool print_twin(const struct compare *compare, uint32_t side)
{
    const struct rows *rows = &compare->rows;
    struct sheet sheet = {.labels = {compare->sides.list[side].label, "exact"},
                          .rows = calloc(rows->outputs.count, sizeof *sheet.rows)};
    if (!sheet.rows) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < rows->outputs.count; i++) {
        const struct row *row = &rows->outputs.list[i];
        const struct difference *found = &compare->twins[side].found[i];
        if (found->elements)
            sheet.rows[sheet.count++] =
                (struct sheet_row){.pass = compare->pipeline.info->passes[row->pass].name,
                                   .name = row->name,
                                   .resource = &compare->pipeline.info->resources[row->resource],
                                   .difference = found};
    }
    printf("\n%s against exact twins of its passes, on equal inputs\n", sheet.labels[0]);
    sheet_print(&sheet);
    free(sheet.rows);
    return true;
}

static void print_far(const struct compare *compare)
{
    const struct twin *twin;
    const struct side *side = compare_far_side(compare, &twin);
    if (!side)
        return;
    const struct row *row = &compare->rows.outputs.list[twin->row];
    const struct dt_pass *pass = &compare->pipeline.info->passes[row->pass];
    printf("too far from exact: pass %s (shader %s): resource %s on %s\n", pass->name, pass->shader,
           row->name, side->label);
}

bool compare_print(const struct compare *compare)
{
    bool several = compare->pair_count > 1;
    const struct pair *told = &compare->pairs[0]; /* the first that differs */
    for (uint32_t i = 0; i < compare->sides.count; i++)
        printf("%s: %s\n", compare->sides.list[i].label, compare->devices[i]);
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        const struct pair *pair = &compare->pairs[i];
        if (!print_pair(compare, pair))
            return false;
        printf("\n");
        if (several)
            print_outcome(compare, pair);
        told = pair->broken && !told->broken ? pair : told;
    }
    if (several && told->broken)
        printf("\n%s against %s differ\n", told->sides[1]->label, told->sides[0]->label);
    else if (several)
        printf("\n%u pairs agree\n", compare->pair_count);
    bool good = true;
    for (uint32_t i = 0; compare->twins && i < compare->sides.count; i++)
        if (compare->twins[i].found)
            good &= print_twin(compare, i);
    if (compare->twins)
        printf("\n");
    elsewhere_print(&compare->elsewhere);
    print_clues(compare, told);
    print_outcome(compare, told); /* the last line is the verdict */
    print_far(compare);
    return good;
}
