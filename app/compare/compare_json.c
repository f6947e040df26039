/* JSON of `compare`; see compare.h. */
#include <cjson/cJSON.h>

#include "compare/compare.h"

static cJSON *picture_json(const struct dt_resource *resource, const struct shown *shown)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "file", shown->strip);
    if (resource->layered)
        cJSON_AddNumberToObject(root, "layer", shown->what.layer);
    if (shown->what.amplification > 0)
        cJSON_AddNumberToObject(root, "amplification", shown->what.amplification);
    return root;
}

static cJSON *result_json(const struct compare *compare, const struct pair *pair,
                          const struct row *row, const struct result *result, bool pass)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const struct dt_resource *resource = &info->resources[row->resource];
    const char *const labels[2] = {pair->sides[0]->label, pair->sides[1]->label};
    cJSON *root = cJSON_CreateObject();
    row_json(root, info, row, pass);
    cJSON_AddNumberToObject(root, "frame", result->frame);
    difference_json(root, &result->difference, resource, labels);
    if (!pass)
        return root;
    cJSON_AddNumberToObject(root, "frames_differing", result->frames_differing);
    if (result->shown.strip)
        cJSON_AddItemToObject(root, "picture", picture_json(resource, &result->shown));
    if (pair->blame.outcome == BLAME_NOT_RUN || pair->on_equal_inputs)
        return root;
    bool differ = pair->blame.inputs_differ[row->pass];
    cJSON_AddStringToObject(root, "inputs", differ ? "differ" : "equal");
    difference_json(cJSON_AddObjectToObject(root, "own_error"),
                    &pair->blame.own[result - pair->results], resource, labels);
    return root;
}

/* Adds pass, resource and frame of an event; null without a row. */
static cJSON *add_event(cJSON *root, const char *name, const struct compare *compare,
                        const struct row *row, bool pass, uint32_t frame)
{
    if (!row) {
        cJSON_AddNullToObject(root, name);
        return NULL;
    }
    cJSON *event = cJSON_AddObjectToObject(root, name);
    row_json(event, compare->pipeline.info, row, pass);
    cJSON_AddNumberToObject(event, "frame", frame);
    return event;
}

static void add_pair_json(cJSON *root, const struct compare *compare, const struct pair *pair)
{
    cJSON *sides = cJSON_AddArrayToObject(root, "sides");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(sides, cJSON_CreateString(pair->sides[i]->label));
    const struct rows *rows = &compare->rows;
    cJSON *history = cJSON_AddArrayToObject(root, "history");
    for (uint32_t i = 0; i < rows->history.count; i++)
        cJSON_AddItemToArray(
            history, result_json(compare, pair, &rows->history.list[i], &pair->history[i], false));
    cJSON *results = cJSON_AddArrayToObject(root, "results");
    for (uint32_t i = 0; i < rows->outputs.count; i++)
        cJSON_AddItemToArray(
            results, result_json(compare, pair, &rows->outputs.list[i], &pair->results[i], true));
}

/* Adds the region of --bisect. Axes: x, y and, in layered images, the layer; or the index of an
 * element. */
static void add_region(cJSON *event, const struct compare *compare, const struct row *guilty)
{
    const struct dt_resource *resource = &compare->pipeline.info->resources[guilty->resource];
    int axes = resource->kind == DT_BUFFER ? 1 : resource->layered ? 3 : 2;
    cJSON *item = cJSON_AddObjectToObject(event, "region");
    cJSON_AddNumberToObject(item, "failing", (double)compare->found.failing);
    region_json(item, &compare->found, axes);
    cJSON_AddStringToObject(event, "case", compare->options.bisect);
}

static void add_outcome(cJSON *root, const struct compare *compare, const struct pair *pair)
{
    const struct blame *blame = &pair->blame;
    const struct row *outputs = compare->rows.outputs.list;
    const struct row *broken = pair->broken ? broken_row(compare, pair) : NULL;
    const struct row *guilty = blame->outcome == BLAME_GUILTY ? &outputs[blame->row] : NULL;
    const struct row *strayed =
        blame->outcome == BLAME_NOT_REPEATABLE ? &outputs[blame->row] : NULL;
    cJSON_AddBoolToObject(root, "agree", compare_agrees(pair));
    if (pair->measured.rows)
        cJSON_AddItemToObject(root, "measured", measured_json(&pair->measured));
    if (pair->on_equal_inputs)
        cJSON_AddBoolToObject(root, "on_equal_inputs", true);
    cJSON *event =
        add_event(root, "first_break", compare, broken, !pair->broken_early, pair->broken_frame);
    if (pair->unwritten)
        cJSON_AddStringToObject(event, "unwritten", pair->unwritten);
    event = add_event(root, "guilty", compare, guilty, true, blame->frame);
    const char *shader = guilty ? compare->pipeline.info->passes[guilty->pass].shader : NULL;
    if (shader)
        cJSON_AddStringToObject(event, "shader", shader);
    if (guilty && compare->region && pair == compare->bisected)
        add_region(event, compare, guilty);
    if (compare_knows_why(pair))
        why_json(root, &pair->why);
    event = add_event(root, "not_repeatable", compare, strayed, true, blame->frame);
    if (strayed)
        cJSON_AddStringToObject(event, "side", blame->side->label);
}

cJSON *compare_pair_json(const struct compare *compare, const struct pair *pair)
{
    cJSON *item = cJSON_CreateObject();
    add_pair_json(item, compare, pair);
    add_outcome(item, compare, pair);
    return item;
}

cJSON *compare_undefined_json(const struct compare *compare)
{
    const char *labels[32];
    uint32_t count = compare->sides.count < 32 ? compare->sides.count : 32;
    for (uint32_t i = 0; i < count; i++)
        labels[i] = compare->sides.list[i].label;
    return undefined_json(&compare->undefined, labels, count);
}

static void add_twins(cJSON *root, const struct compare *compare)
{
    const struct twin *far;
    cJSON *list = compare->twins ? cJSON_AddArrayToObject(root, "of_exact") : NULL;
    for (uint32_t side = 0; list && side < compare->sides.count; side++) {
        const char *const labels[2] = {compare->sides.list[side].label, "exact"};
        const struct difference *found = compare->twins[side].found;
        for (uint32_t i = 0; found && i < compare->rows.outputs.count; i++) {
            const struct row *row = &compare->rows.outputs.list[i];
            if (!found[i].elements)
                continue;
            cJSON *item = cJSON_CreateObject();
            cJSON_AddStringToObject(item, "side", labels[0]);
            row_json(item, compare->pipeline.info, row, true);
            difference_json(item, &found[i], &compare->pipeline.info->resources[row->resource],
                            labels);
            cJSON_AddItemToArray(list, item);
        }
    }
    if (compare_far_side(compare, &far))
        cJSON_ReplaceItemInObject(root, "agree", cJSON_CreateFalse());
}

/* A single pair stands in the root. Of several, each stands in "pairs", and the root has the
 * outcome of the first that differs. */
cJSON *compare_json(const struct compare *compare)
{
    const struct pair *told = &compare->pairs[0];
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", compare->pipeline.info->name);
    cJSON_AddStringToObject(root, "scene", compare->options.setup.scene);
    cJSON_AddNumberToObject(root, "width", compare->options.setup.size[0]);
    cJSON_AddNumberToObject(root, "height", compare->options.setup.size[1]);
    cJSON_AddNumberToObject(root, "frames", compare->options.setup.frames);
    cJSON *devices = cJSON_AddObjectToObject(root, "devices");
    for (uint32_t i = 0; i < compare->sides.count; i++)
        cJSON_AddStringToObject(devices, compare->sides.list[i].label, compare->devices[i]);
    if (compare->pair_count == 1)
        add_pair_json(root, compare, told);
    cJSON *pairs = compare->pair_count > 1 ? cJSON_AddArrayToObject(root, "pairs") : NULL;
    for (uint32_t i = 0; pairs && i < compare->pair_count; i++) {
        const struct pair *pair = &compare->pairs[i];
        cJSON_AddItemToArray(pairs, compare_pair_json(compare, pair));
        told = pair->broken && !told->broken ? pair : told;
    }
    add_outcome(root, compare, told);
    add_twins(root, compare);
    if (compare->options.golden)
        cJSON_AddItemToObject(root, "golden", cJSON_Duplicate(compare->golden.differing, true));
    if (compare->elsewhere.list)
        cJSON_AddItemToObject(root, "elsewhere", cJSON_Duplicate(compare->elsewhere.list, true));
    if (compare->options.setup.sanitize)
        cJSON_AddItemToObject(root, "undefined", compare_undefined_json(compare));
    return root;
}
