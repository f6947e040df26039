/* JSON, page and JUnit's XML of `compare`; see compare.h. */
#include <cjson/cJSON.h>
#include <stdlib.h>

#include "base/files.h"
#include "compare/compare.h"
#include "console/fill.h"

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

/* ---- The page ---------------------------------------------------------------------------------- */

bool compare_write_html(const struct compare *compare)
{
    const struct setup *setup = &compare->options.setup;
    char *path = format_string("%s/index.html", compare->options.html);
    cJSON *page = cJSON_CreateObject();
    cJSON_AddStringToObject(page, "pipeline", compare->pipeline.info->name);
    cJSON_AddStringToObject(page, "scene", setup->scene ? setup->scene : "");
    add_frame(cJSON_AddObjectToObject(page, "frame"), compare);
    cJSON *sets = cJSON_AddArrayToObject(page, "sets");
    for (uint32_t i = 0; i < setup->set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(setup->sets[i]));
    sheets_page(page, compare->sheets, compare->pair_count);
    cJSON *golden = cJSON_AddObjectToObject(page, "golden");
    if (compare->options.golden && !compare->options.update) {
        cJSON_AddStringToObject(golden, "folder", compare->options.golden);
        cJSON_AddItemToObject(golden, "differing",
                              cJSON_Duplicate(compare->golden.differing, true));
    }
    if (compare->elsewhere.list)
        cJSON_AddItemToObject(page, "elsewhere", cJSON_Duplicate(compare->elsewhere.list, true));
    if (setup->sanitize) {
        cJSON *sanitized = cJSON_AddObjectToObject(page, "sanitized");
        cJSON_AddItemToObject(sanitized, "undefined", all_undefined(compare));
    }
    bool good = path && fill_page(compare->console, "compare.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}

/* ---- JUnit ------------------------------------------------------------------------------------- */

static const char *string_of(const cJSON *item, const char *key)
{
    return cJSON_GetStringValue(cJSON_GetObjectItem(item, key));
}

/* A suite whose only case passes, if it has no other. */
static void end_suite(cJSON *suite, const char *kind, const char *fine)
{
    if (!cJSON_GetObjectItem(suite, "cases")->child)
        sheet_case(suite, kind, fine, NULL);
}

/* --sanitize: a case per finding. */
static void add_findings(cJSON *suite, const struct compare *compare)
{
    cJSON *list = all_undefined(compare), *item;
    cJSON_ArrayForEach(item, list)
    {
        char *place = format_string("%s:%d:%d", string_of(item, "file"),
                                    cJSON_GetObjectItem(item, "line")->valueint,
                                    cJSON_GetObjectItem(item, "column")->valueint);
        sheet_case(suite, string_of(item, "pass"), place, string_of(item, "message"));
        free(place);
    }
    cJSON_Delete(list);
}

bool compare_write_junit(const struct compare *compare)
{
    const struct options *options = &compare->options;
    const char *pipeline = compare->pipeline.info->name;
    cJSON *suites = cJSON_CreateArray(), *suite;
    const cJSON *item;
    if (options->golden && !options->update) { /* a case per resource that differs */
        suite = sheet_suite(suites, pipeline, "golden");
        cJSON_ArrayForEach(item, compare->golden.differing) sheet_case(
            suite, string_of(item, "pass"), string_of(item, "resource"), string_of(item, "is"));
        end_suite(suite, "golden", "all resources are as kept");
    }
    if (options->repeat) { /* a case per pass and side with several results */
        suite = sheet_suite(suites, pipeline, "repeated runs");
        cJSON_ArrayForEach(item, compare->elsewhere.list) if (cJSON_HasObjectItem(item, "distinct"))
            sheet_case(suite, "repeat", string_of(item, "pass"), string_of(item, "message"));
        end_suite(suite, "repeat", "all runs are equal");
    }
    if (options->setup.sanitize) {
        suite = sheet_suite(suites, pipeline, "undefined behaviour");
        add_findings(suite, compare);
        end_suite(suite, "sanitize", "nothing undefined");
    }
    bool good = sheets_junit(suites, compare->sheets, compare->pair_count, options->junit,
                             compare->console);
    cJSON_Delete(suites);
    return good;
}
