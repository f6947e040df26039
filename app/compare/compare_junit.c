/* JUnit's XML of `compare`; see compare.h. */
#include <cjson/cJSON.h>
#include <stdlib.h>

#include "base/files.h"
#include "compare/compare.h"

/* Begins a sheet with room for `count` cases; without any, one that says `fine`. */
static bool begin_list(const struct compare *compare, const char *title, int count,
                       const char *kind, const char *fine, struct sheet *sheet)
{
    *sheet = (struct sheet){.title = format_string("%s: %s", compare->pipeline.info->name, title),
                            .rows = calloc((size_t)count + 1, sizeof *sheet->rows)};
    if (!sheet->title || !sheet->rows) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    if (!count)
        sheet->rows[sheet->count++] =
            (struct sheet_row){.pass = kind, .name = fine, .verdict = verdict_name(VERDICT_EQUAL)};
    return true;
}

static void add_failure(struct sheet *sheet, const char *pass, const char *name, const char *text)
{
    sheet->rows[sheet->count++] = (struct sheet_row){
        .pass = pass, .name = name, .verdict = verdict_name(VERDICT_DIFFERS), .text = text};
}

static const char *string_of(const cJSON *item, const char *key)
{
    return cJSON_GetStringValue(cJSON_GetObjectItem(item, key));
}

/* A case per resource that differs. */
static bool golden_sheet(const struct compare *compare, struct sheet *sheet)
{
    const cJSON *item;
    if (!begin_list(compare, "golden", cJSON_GetArraySize(compare->golden.differing), "golden",
                    "all resources are as kept", sheet))
        return false;
    cJSON_ArrayForEach(item, compare->golden.differing) add_failure(
        sheet, string_of(item, "pass"), string_of(item, "resource"), string_of(item, "is"));
    return true;
}

/* --repeat: a case per pass and side with several results. */
static bool repeats_sheet(const struct compare *compare, struct sheet *sheet)
{
    const cJSON *item;
    int count = 0;
    cJSON_ArrayForEach(item, compare->elsewhere.list) count +=
        cJSON_HasObjectItem(item, "distinct");
    if (!begin_list(compare, "repeated runs", count, "repeat", "all runs are equal", sheet))
        return false;
    cJSON_ArrayForEach(item, compare->elsewhere.list) if (cJSON_HasObjectItem(item, "distinct"))
        add_failure(sheet, "repeat", string_of(item, "pass"), string_of(item, "message"));
    return true;
}

/* --sanitize: a case per finding. The list gets the names of the cases. */
static bool undefined_sheet(const struct compare *compare, cJSON *list, struct sheet *sheet)
{
    cJSON *item;
    if (!begin_list(compare, "undefined behaviour", cJSON_GetArraySize(list), "sanitize",
                    "nothing undefined", sheet))
        return false;
    cJSON_ArrayForEach(item, list)
    {
        char *place = format_string("%s:%d:%d", string_of(item, "file"),
                                    cJSON_GetObjectItem(item, "line")->valueint,
                                    cJSON_GetObjectItem(item, "column")->valueint);
        cJSON_AddStringToObject(item, "place", place ? place : "");
        free(place);
        add_failure(sheet, string_of(item, "pass"), string_of(item, "place"),
                    string_of(item, "message"));
    }
    return true;
}

bool compare_write_junit(const struct compare *compare)
{
    enum { LISTS = 3 }; /* at most, behind the pairs */
    const struct options *options = &compare->options;
    uint32_t count = 0;
    struct sheet *sheets = calloc(compare->pair_count + LISTS, sizeof *sheets);
    cJSON *undefined = options->setup.sanitize ? compare_undefined_json(compare) : NULL;
    bool good = sheets;
    if (!sheets)
        report_error(&compare->console->log, "out of memory");
    for (uint32_t i = 0; i < compare->pair_count && good; i++)
        good = compare_sheet(compare, &compare->pairs[i], HISTORY_ALL, &sheets[count++]);
    if (good && options->golden && !options->update)
        good = golden_sheet(compare, &sheets[count++]);
    if (good && options->repeat)
        good = repeats_sheet(compare, &sheets[count++]);
    if (good && undefined)
        good = undefined_sheet(compare, undefined, &sheets[count++]);
    good = good && sheet_junit(sheets, count, options->junit, compare->console);
    for (uint32_t i = 0; sheets && i < count; i++)
        compare_free_sheet(&sheets[i]);
    free(sheets);
    cJSON_Delete(undefined);
    return good;
}
