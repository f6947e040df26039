/* JSON, page and JUnit's XML of comparisons; see sheet.h. */
#include "result/sheet.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/printable.h"
#include "console/fill.h"
#include "result/measured.h"

/* ---- JSON -------------------------------------------------------------------------------------- */

static void add_where(cJSON *root, const struct sheet *sheet, const struct sheet_row *row)
{
    if (sheet_is_early(sheet, row))
        cJSON_AddNullToObject(root, "pass");
    else
        cJSON_AddStringToObject(root, "pass", row->pass);
    cJSON_AddStringToObject(root, "resource", row->resource->name);
    if (row->mip >= 0)
        cJSON_AddNumberToObject(root, "mip", row->mip);
}

/* Copies the members of another object, which may be NULL. */
static void add_members(cJSON *root, const cJSON *more)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, more)
        cJSON_AddItemToObject(root, item->string, cJSON_Duplicate(item, true));
}

static void add_picture(cJSON *root, const struct sheet_row *row)
{
    cJSON *picture = cJSON_AddObjectToObject(root, "picture");
    cJSON_AddStringToObject(picture, "file", row->shown.strip);
    if (row->resource->layered)
        cJSON_AddNumberToObject(picture, "layer", row->shown.what.layer);
    if (row->shown.what.amplification > 0)
        cJSON_AddNumberToObject(picture, "amplification", row->shown.what.amplification);
}

void sheet_row_json(cJSON *root, const struct sheet *sheet, const struct sheet_row *row)
{
    add_where(root, sheet, row);
    cJSON_AddNumberToObject(root, "frame", row->frame);
    if (row->compared)
        difference_json(root, &row->difference, row->resource, sheet->labels);
    else
        cJSON_AddStringToObject(root, "verdict", row->verdict);
    cJSON_AddNumberToObject(root, "frames_differing", row->frames_differing);
    if (row->note || (row->text && !row->compared))
        cJSON_AddStringToObject(root, "note", row->note ? row->note : row->text);
    if (row->not_finite)
        cJSON_AddNumberToObject(root, "not_finite_in_both", (double)row->not_finite);
    if (row->shown.strip)
        add_picture(root, row);
    if (row->inputs)
        cJSON_AddStringToObject(root, "inputs", row->inputs);
    if (row->own)
        difference_json(cJSON_AddObjectToObject(root, "own_error"), row->own, row->resource,
                        sheet->labels);
    add_members(root, row->why);
}

static void add_rows(cJSON *root, const char *name, const struct sheet *sheet, uint32_t first,
                     uint32_t count)
{
    cJSON *list = cJSON_AddArrayToObject(root, name);
    for (uint32_t i = first; i < first + count; i++) {
        cJSON *item = cJSON_CreateObject();
        sheet_row_json(item, sheet, &sheet->rows[i]);
        cJSON_AddItemToArray(list, item);
    }
}

static void add_event(cJSON *root, const char *name, const struct sheet *sheet,
                      const struct sheet_event *event)
{
    if (!event->row) {
        cJSON_AddNullToObject(root, name);
        return;
    }
    cJSON *object = cJSON_AddObjectToObject(root, name);
    add_where(object, sheet, event->row);
    cJSON_AddNumberToObject(object, "frame", event->frame);
    add_members(object, event->more);
}

static void add_results(cJSON *root, const struct sheet *sheet)
{
    uint32_t results = sheet->count - sheet->early - sheet->alone;
    cJSON *sides = cJSON_AddArrayToObject(root, "sides");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(sides, cJSON_CreateString(sheet->labels[i]));
    add_rows(root, "history", sheet, 0, sheet->early);
    add_rows(root, "results", sheet, sheet->early, results);
    if (!sheet->pipeline)
        add_rows(root, "only_in_second", sheet, sheet->early + results, sheet->alone);
}

static void add_outcome(cJSON *root, const struct sheet *sheet)
{
    cJSON_AddBoolToObject(root, "agree", sheet->agree);
    if (sheet->runs)
        cJSON_AddItemToObject(root, "measured", measured_json(sheet));
    if (sheet->on_equal_inputs)
        cJSON_AddBoolToObject(root, "on_equal_inputs", true);
    if (sheet->pipeline)
        add_event(root, "first_break", sheet, &sheet->first_break);
    add_event(root, "guilty", sheet, &sheet->guilty);
    if (sheet->guilty.row)
        add_members(root, sheet->guilty.row->why);
    if (sheet->pipeline)
        add_event(root, "not_repeatable", sheet, &sheet->not_repeatable);
}

void sheets_json(cJSON *root, const struct sheet *const *sheets, uint32_t count)
{
    if (count == 1)
        add_results(root, sheets[0]);
    cJSON *list = count > 1 ? cJSON_AddArrayToObject(root, "pairs") : NULL;
    for (uint32_t i = 0; list && i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        add_results(item, sheets[i]);
        add_outcome(item, sheets[i]);
        cJSON_AddItemToArray(list, item);
    }
    add_outcome(root, sheets_told(sheets, count));
}

/* ---- The page ---------------------------------------------------------------------------------- */

/* "1 ulp", "2 to 3 ulp": of floats; other numbers have codes. */
static char *bin_name(int bin)
{
    unsigned long long low = bin ? 1ULL << (bin - 1) : 0;
    return bin == 0                     ? strdup("0 and -0")
           : bin == DIFFERENCE_BINS - 1 ? strdup("NaN or Inf")
           : bin == 1                   ? strdup("1")
                                        : format_string("%llu to %llu", low, 2 * low - 1);
}

/* Heights are logarithmic, so that one number among millions is seen. */
static void add_histogram(cJSON *item, const struct shown *shown)
{
    int first = 0, last = -1;
    uint64_t most = 0;
    for (int i = 0; i < DIFFERENCE_BINS; i++) {
        first = last < 0 ? i : first;
        last = shown->bins[i] ? i : last;
        most = shown->bins[i] > most ? shown->bins[i] : most;
    }
    cJSON *bins = cJSON_AddArrayToObject(item, "bins");
    for (int i = first; i <= last; i++) {
        cJSON *bin = cJSON_CreateObject();
        char *name = bin_name(i);
        cJSON_AddStringToObject(bin, "bin", name ? name : "");
        cJSON_AddNumberToObject(bin, "numbers", (double)shown->bins[i]);
        cJSON_AddNumberToObject(
            bin, "percent", round(100 * log2((double)shown->bins[i] + 1) / log2((double)most + 1)));
        cJSON_AddItemToArray(bins, bin);
        free(name);
    }
}

static void add_pictures(cJSON *item, const struct sheet_row *row)
{
    static const char *const keys[] = {"first_file", "second_file", "difference_file"};
    const struct shown *shown = &row->shown;
    if (!shown->files[0])
        return;
    cJSON *root = cJSON_AddObjectToObject(item, "shown");
    for (int i = 0; i < SHOWN_PICTURES; i++)
        cJSON_AddStringToObject(root, keys[i], shown->files[i] ? shown->files[i] : "");
    cJSON_AddNumberToObject(root, "across", row->difference.extent[0]);
    cJSON_AddNumberToObject(root, "down", row->difference.extent[1]);
    if (row->resource->layered)
        cJSON_AddNumberToObject(root, "layer", shown->what.layer);
    if (shown->what.amplification > 0)
        cJSON_AddNumberToObject(root, "amplification", shown->what.amplification);
}

/* Adds a text, unless the object has one of that name; nothing becomes "". */
static void add_string(cJSON *item, const char *key, const char *text)
{
    if (!cJSON_HasObjectItem(item, key))
        cJSON_AddStringToObject(item, key, text ? text : "");
}

/* What the page shows of a row beyond its JSON. */
static void add_shown(cJSON *item, const struct sheet *sheet, uint32_t index)
{
    const struct sheet_row *row = &sheet->rows[index];
    char used[16] = "-", own[32];
    char *worst = sheet_worst(sheet, row);
    if (row->compared)
        difference_write_used(&row->difference, used);
    sheet_write_own(row, own);
    add_string(item, "elements", "-");
    add_string(item, "differing", "-");
    cJSON_AddNumberToObject(item, "row", index - sheet->early);
    add_string(item, "name", row->name);
    cJSON_AddBoolToObject(item, "opens_pass",
                          index == sheet->early || strcmp(row->pass, row[-1].pass) != 0);
    add_string(item, "body", row->body);
    add_string(item, "about", row->resource->doc);
    cJSON_AddBoolToObject(item, "equal",
                          row->compared && difference_verdict(&row->difference) == VERDICT_EQUAL);
    add_string(item, "largest", worst);
    add_string(item, "used", used);
    add_string(item, "remark", row->compared ? row->note : NULL);
    add_string(item, "inputs", "");
    add_string(item, "own", own);
    if (row->compared) {
        add_pictures(item, row);
        add_histogram(item, &row->shown);
    }
    free(worst);
}

/* Reasons of all resources of the guilty pass, with their names; of a spec, of the guilty one alone. */
static void add_reasons(cJSON *page, const struct sheet *sheet)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < sheet->count; i++) {
        const cJSON *reason;
        cJSON_ArrayForEach(reason, cJSON_GetObjectItem(sheet->rows[i].why, "why"))
        {
            const char *name = sheet->pipeline ? "" : sheet->rows[i].name;
            char *text = format_string("%s%s%s", name, *name ? ": " : "",
                                       cJSON_GetStringValue(cJSON_GetObjectItem(reason, "text")));
            cJSON *item = cJSON_CreateObject();
            add_string(item, "text", text);
            cJSON_AddItemToArray(list, item);
            free(text);
        }
    }
    cJSON_DeleteItemFromObject(page, "why");
    cJSON_AddItemToObject(page, "why", list);
}

static cJSON *pair_page(const struct sheet *sheet, uint32_t pair)
{
    cJSON *page = cJSON_CreateObject(), *item;
    uint32_t index = sheet->early;
    add_results(page, sheet);
    add_outcome(page, sheet);
    cJSON_AddNumberToObject(page, "pair", pair);
    add_string(page, "first", sheet->labels[0]);
    add_string(page, "second", sheet->labels[1]);
    cJSON_AddBoolToObject(page, "blamed", sheet->blames);
    add_reasons(page, sheet);
    if (sheet->guilty.row)
        cJSON_AddNumberToObject(cJSON_GetObjectItem(page, "guilty"), "row",
                                (double)(sheet->guilty.row - sheet->rows - sheet->early));
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(page, "results")) add_shown(item, sheet, index++);
    return page;
}

static void add_device(cJSON *devices, const struct sheet *sheet, int side)
{
    cJSON *device = cJSON_CreateObject();
    add_string(device, "label", sheet->labels[side]);
    add_string(device, "device", sheet->devices[side]);
    cJSON_AddItemToArray(devices, device);
}

void sheets_page(cJSON *page, const struct sheet *const *sheets, uint32_t count)
{
    cJSON *devices = cJSON_AddArrayToObject(page, "devices");
    cJSON *pairs = cJSON_AddArrayToObject(page, "pairs");
    add_device(devices, sheets[0], 0);
    for (uint32_t i = 0; i < count; i++) {
        add_device(devices, sheets[i], 1);
        cJSON_AddItemToArray(pairs, pair_page(sheets[i], i));
    }
}

/* ---- JUnit ------------------------------------------------------------------------------------- */

/* Control characters have no place in XML. */
static void add_printable(cJSON *item, const char *key, const char *text)
{
    char *copy = text_printable(text ? text : "");
    for (char *at = copy; at && *at; at++)
        *at = (unsigned char)*at < ' ' ? ' ' : *at;
    add_string(item, key, copy);
    free(copy);
}

/* What a failed case says. */
static char *failure(const struct sheet *sheet, const struct sheet_row *row)
{
    char *worst = sheet_worst(sheet, row);
    char *count = row->compared ? format_string("%" PRIu64 " of %" PRIu64 " differ; ",
                                                row->difference.differing, row->difference.elements)
                                : strdup("");
    char *text = worst && count ? format_string("%s%s%s%s", count, worst, row->note ? "; " : "",
                                                row->note ? row->note : "")
                                : NULL;
    free(worst);
    free(count);
    return text;
}

cJSON *sheet_suite(cJSON *suites, const char *pipeline, const char *title)
{
    cJSON *suite = cJSON_CreateObject();
    char *name = format_string("%s%s%s", pipeline ? pipeline : "", pipeline ? ": " : "", title);
    add_printable(suite, "name", name);
    cJSON_AddNumberToObject(suite, "tests", 0);
    cJSON_AddNumberToObject(suite, "failures", 0);
    cJSON_AddArrayToObject(suite, "cases");
    cJSON_AddItemToArray(suites, suite);
    free(name);
    return suite;
}

static void count_up(cJSON *suite, const char *key, int more)
{
    cJSON *item = cJSON_GetObjectItem(suite, key);
    if (item)
        cJSON_SetNumberValue(item, item->valuedouble + more);
}

void sheet_case(cJSON *suite, const char *pass, const char *name, const char *failure)
{
    cJSON *item = cJSON_CreateObject();
    add_printable(item, "pass", pass);
    add_printable(item, "name", name);
    if (failure)
        add_printable(item, "failure", failure);
    cJSON_AddItemToArray(cJSON_GetObjectItem(suite, "cases"), item);
    count_up(suite, "tests", 1);
    count_up(suite, "failures", failure != NULL);
}

static void add_sheet_suite(cJSON *suites, const struct sheet *sheet)
{
    char *title = format_string("%s against %s", sheet->labels[1], sheet->labels[0]);
    cJSON *suite = sheet_suite(suites, sheet->pipeline, title ? title : "");
    cJSON *list = cJSON_AddArrayToObject(suite, "properties");
    free(title);
    for (int side = 0; side < 2; side++) {
        cJSON *property = cJSON_CreateObject();
        add_printable(property, "label", sheet->labels[side]);
        add_printable(property, "device", sheet->devices[side]);
        cJSON_AddItemToArray(list, property);
    }
    for (uint32_t i = 0; i < sheet->count; i++) {
        const struct sheet_row *row = &sheet->rows[i];
        bool fails = !strcmp(sheet_verdict(row), verdict_name(VERDICT_DIFFERS));
        char *text = fails ? failure(sheet, row) : NULL;
        sheet_case(suite, row->pass, row->name, text);
        free(text);
    }
}

bool sheets_junit(cJSON *suites, const struct sheet *const *sheets, uint32_t count,
                  const char *path, struct console *console)
{
    cJSON *root = cJSON_CreateObject(), *all = cJSON_AddArrayToObject(root, "suites");
    for (uint32_t i = 0; i < count; i++)
        add_sheet_suite(all, sheets[i]);
    while (suites && suites->child)
        cJSON_AddItemToArray(all, cJSON_DetachItemFromArray(suites, 0));
    bool good = fill_page(console, "junit.xml", path, root);
    cJSON_Delete(root);
    return good;
}
