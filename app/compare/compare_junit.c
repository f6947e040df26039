/* JUnit's XML of `compare`; see compare.h. */
#include <cjson/cJSON.h>
#include <stdlib.h>

#include "base/files.h"
#include "compare/compare.h"

/* A case per resource that differs, else one. */
static bool golden_sheet(const struct compare *compare, struct sheet *sheet)
{
    int count = cJSON_GetArraySize(compare->golden.differing);
    const cJSON *item;
    *sheet = (struct sheet){.title = format_string("%s: golden", compare->pipeline.info->name),
                            .rows = calloc((size_t)count + 1, sizeof *sheet->rows)};
    if (!sheet->title || !sheet->rows) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    cJSON_ArrayForEach(item, compare->golden.differing) sheet->rows[sheet->count++] =
        (struct sheet_row){.pass = cJSON_GetStringValue(cJSON_GetObjectItem(item, "pass")),
                           .name = cJSON_GetStringValue(cJSON_GetObjectItem(item, "resource")),
                           .verdict = verdict_name(VERDICT_DIFFERS),
                           .text = cJSON_GetStringValue(cJSON_GetObjectItem(item, "is"))};
    if (!count)
        sheet->rows[sheet->count++] = (struct sheet_row){.pass = "golden",
                                                         .name = "all resources are as kept",
                                                         .verdict = verdict_name(VERDICT_EQUAL)};
    return true;
}

bool compare_write_junit(const struct compare *compare)
{
    uint32_t pairs = compare->pair_count;
    bool golden = compare->options.golden && !compare->options.update;
    struct sheet *sheets = calloc(pairs + 1, sizeof *sheets);
    bool good = sheets;
    if (!sheets)
        report_error(&compare->console->log, "out of memory");
    for (uint32_t i = 0; i < pairs && good; i++)
        good = compare_sheet(compare, &compare->pairs[i], HISTORY_ALL, &sheets[i]);
    good = good && (!golden || golden_sheet(compare, &sheets[pairs])) &&
           sheet_junit(sheets, pairs + golden, compare->options.junit, compare->console);
    for (uint32_t i = 0; sheets && i <= pairs; i++)
        compare_free_sheet(&sheets[i]);
    free(sheets);
    return good;
}
