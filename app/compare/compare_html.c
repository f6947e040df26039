/* The page of `compare --html`: what templates/report/compare.html is filled with; see compare.h. */
#include <cjson/cJSON.h>
#include <stdlib.h>

#include "base/files.h"
#include "console/fill.h"
#include "compare/compare.h"

static cJSON *pair_page(const struct compare *compare, uint32_t index)
{
    const struct pair *pair = &compare->pairs[index];
    cJSON *page = compare_pair_json(compare, pair);
    struct sheet sheet;
    cJSON_AddNumberToObject(page, "pair", index);
    cJSON_AddStringToObject(page, "first", pair->sides[0]->label);
    cJSON_AddStringToObject(page, "second", pair->sides[1]->label);
    if (compare_sheet(compare, pair, HISTORY_NONE, &sheet))
        sheet_page(&sheet, cJSON_GetObjectItem(page, "results"));
    compare_free_sheet(&sheet);
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
    bool good = fill_page(compare->console, "compare.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}
