/* The page of `compare --html`: what templates/report/compare.html is filled with; see compare.h. */
#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/files.h"
#include "console/fill.h"
#include "compare/compare.h"

/* Whether the pass's inputs differed, and its own error, as the table that is printed has them. */
static void add_blame(cJSON *item, const struct pair *pair, uint32_t index)
{
    const struct difference *own = pair->blame.own ? &pair->blame.own[index] : NULL;
    char text[32] = "none";
    if (!cJSON_HasObjectItem(item, "inputs"))
        cJSON_AddStringToObject(item, "inputs", "");
    if (own && own->size_differs)
        snprintf(text, sizeof text, "size");
    else if (own && own->differing)
        snprintf(text, sizeof text, "%llu differ", (unsigned long long)own->differing);
    else if (own && own->not_finite)
        snprintf(text, sizeof text, "not finite");
    cJSON_AddStringToObject(item, "own", text);
}

static cJSON *pair_page(const struct compare *compare, uint32_t index)
{
    const struct pair *pair = &compare->pairs[index];
    cJSON *page = compare_pair_json(compare, pair), *item;
    uint32_t row = 0;
    struct sheet sheet;
    cJSON_AddNumberToObject(page, "pair", index);
    cJSON_AddStringToObject(page, "first", pair->sides[0]->label);
    cJSON_AddStringToObject(page, "second", pair->sides[1]->label);
    if (compare_sheet(compare, pair, HISTORY_NONE, &sheet))
        sheet_page(&sheet, cJSON_GetObjectItem(page, "results"));
    compare_free_sheet(&sheet);
    cJSON_AddBoolToObject(page, "blamed",
                          pair->blame.outcome != BLAME_NOT_RUN && !pair->on_equal_inputs);
    if (!cJSON_HasObjectItem(page, "why"))
        cJSON_AddArrayToObject(page, "why");
    cJSON *guilty = cJSON_GetObjectItem(page, "guilty");
    if (cJSON_IsObject(guilty))
        cJSON_AddNumberToObject(guilty, "row", pair->blame.row);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(page, "results")) add_blame(item, pair, row++);
    return page;
}

bool compare_write_html(const struct compare *compare)
{
    char *path = format_string("%s/index.html", compare->options.html);
    cJSON *page = cJSON_CreateObject();
    cJSON_AddStringToObject(page, "pipeline", compare->pipeline.info->name);
    cJSON_AddStringToObject(page, "scene",
                            compare->options.setup.scene ? compare->options.setup.scene : "");
    cJSON *frame = cJSON_AddObjectToObject(page, "frame");
    cJSON_AddNumberToObject(frame, "width", compare->options.setup.size[0]);
    cJSON_AddNumberToObject(frame, "height", compare->options.setup.size[1]);
    cJSON_AddNumberToObject(frame, "frames", compare->options.setup.frames);
    cJSON *sets = cJSON_AddArrayToObject(page, "sets");
    for (uint32_t i = 0; i < compare->options.setup.set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(compare->options.setup.sets[i]));
    cJSON *devices = cJSON_AddArrayToObject(page, "devices");
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        cJSON *device = cJSON_CreateObject();
        cJSON_AddStringToObject(device, "label", compare->sides.list[i].label);
        cJSON_AddStringToObject(device, "device", compare->devices[i]);
        cJSON_AddItemToArray(devices, device);
    }
    cJSON *pairs = cJSON_AddArrayToObject(page, "pairs");
    for (uint32_t i = 0; i < compare->pair_count; i++)
        cJSON_AddItemToArray(pairs, pair_page(compare, i));
    cJSON *golden = cJSON_AddObjectToObject(page, "golden");
    if (compare->options.golden && !compare->options.update) {
        cJSON_AddStringToObject(golden, "folder", compare->options.golden);
        cJSON_AddItemToObject(golden, "differing",
                              cJSON_Duplicate(compare->golden.differing, true));
    }
    if (compare->elsewhere.list)
        cJSON_AddItemToObject(page, "elsewhere", cJSON_Duplicate(compare->elsewhere.list, true));
    if (compare->options.setup.sanitize) {
        cJSON *sanitized = cJSON_AddObjectToObject(page, "sanitized");
        cJSON_AddItemToObject(sanitized, "undefined", compare_undefined_json(compare));
    }
    bool good = fill_page(compare->console, "compare.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}
