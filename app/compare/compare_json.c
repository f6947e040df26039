/* JSON of `compare`, and what its page and XML are made of; see compare.h. */
#include <cjson/cJSON.h>

#include "compare/compare.h"

/* ---- JSON -------------------------------------------------------------------------------------- */

static cJSON *all_undefined(const struct compare *compare)
{
    return undefined_json(&compare->undefined, compare->labels, compare->sides.count);
}

static void add_twins(cJSON *root, const struct compare *compare)
{
    cJSON *list = compare->twins ? cJSON_AddArrayToObject(root, "of_exact") : NULL;
    for (uint32_t side = 0; list && side < compare->sides.count; side++) {
        const struct sheet *sheet = &compare->twins[side].sheet;
        for (uint32_t i = 0; i < sheet->count; i++) {
            cJSON *item = cJSON_CreateObject();
            cJSON_AddStringToObject(item, "side", sheet->labels[0]);
            sheet_row_json(item, sheet, &sheet->rows[i]);
            cJSON_AddItemToArray(list, item);
        }
    }
    if (compare_far_twin(compare))
        cJSON_ReplaceItemInObject(root, "agree", cJSON_CreateFalse());
}

static void add_frame(cJSON *root, const struct compare *compare)
{
    cJSON_AddNumberToObject(root, "width", compare->options.setup.size[0]);
    cJSON_AddNumberToObject(root, "height", compare->options.setup.size[1]);
    cJSON_AddNumberToObject(root, "frames", compare->options.setup.frames);
}

cJSON *compare_json(const struct compare *compare)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", compare->pipeline.info->name);
    cJSON_AddStringToObject(root, "scene", compare->options.setup.scene);
    add_frame(root, compare);
    cJSON *devices = cJSON_AddObjectToObject(root, "devices");
    for (uint32_t i = 0; i < compare->sides.count; i++)
        cJSON_AddStringToObject(devices, compare->labels[i], compare->devices[i]);
    sheets_json(root, compare->sheets, compare->pair_count);
    add_twins(root, compare);
    if (compare->options.golden)
        cJSON_AddItemToObject(root, "golden", cJSON_Duplicate(compare->golden.differing, true));
    if (compare->elsewhere.list)
        cJSON_AddItemToObject(root, "elsewhere", cJSON_Duplicate(compare->elsewhere.list, true));
    if (compare->options.setup.sanitize)
        cJSON_AddItemToObject(root, "undefined", all_undefined(compare));
    return root;
}

/* ---- Page and JUnit's XML ---------------------------------------------------------------------- */

bool compare_write_pages(const struct compare *compare)
{
    const struct options *options = &compare->options;
    const struct setup *setup = &options->setup;
    cJSON *page = cJSON_CreateObject();
    cJSON_AddStringToObject(page, "pipeline", compare->pipeline.info->name);
    cJSON_AddStringToObject(page, "scene", setup->scene ? setup->scene : "");
    add_frame(cJSON_AddObjectToObject(page, "frame"), compare);
    cJSON *sets = cJSON_AddArrayToObject(page, "sets");
    for (uint32_t i = 0; i < setup->set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(setup->sets[i]));
    sheets_page(page, compare->sheets, compare->pair_count);
    if (options->golden && !options->update) {
        cJSON *golden = cJSON_AddObjectToObject(page, "golden");
        cJSON_AddStringToObject(golden, "folder", options->golden);
        cJSON_AddItemToObject(golden, "differing",
                              cJSON_Duplicate(compare->golden.differing, true));
    }
    cJSON_AddBoolToObject(page, "repeated", options->repeat);
    if (compare->elsewhere.list)
        cJSON_AddItemToObject(page, "elsewhere", cJSON_Duplicate(compare->elsewhere.list, true));
    if (setup->sanitize)
        cJSON_AddItemToObject(cJSON_AddObjectToObject(page, "sanitized"), "undefined",
                              all_undefined(compare));
    return sheets_write(page, options, compare->console);
}
