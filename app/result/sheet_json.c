/* JSON of comparisons, and what Python makes page and JUnit's XML of; see sheet.h. */
#include "result/sheet.h"

#include <cjson/cJSON.h>
#include <stdlib.h>

#include "console/python.h"
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
    if (row->shown.strip)
        add_picture(root, row);
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
    add_event(root, "not_finite", sheet, &sheet->not_finite);
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

/* ---- Page and JUnit's XML ---------------------------------------------------------------------- */

static void add_shown_text(cJSON *item, const char *key, const char *text)
{
    cJSON_AddStringToObject(item, key, text ? text : "");
}

static void add_pictures(cJSON *item, const struct sheet_row *row)
{
    const struct shown *shown = &row->shown;
    cJSON *files = cJSON_AddArrayToObject(item, "files"),
          *bins = cJSON_AddArrayToObject(item, "bins");
    for (int i = 0; i < SHOWN_PICTURES && shown->files[i]; i++)
        cJSON_AddItemToArray(files, cJSON_CreateString(shown->files[i]));
    for (int i = 0; i < DIFFERENCE_BINS; i++)
        cJSON_AddItemToArray(bins, cJSON_CreateNumber((double)shown->bins[i]));
    cJSON_AddNumberToObject(item, "across", row->difference.extent[0]);
    cJSON_AddNumberToObject(item, "down", row->difference.extent[1]);
    if (row->resource->layered)
        cJSON_AddNumberToObject(item, "layer", shown->what.layer);
    if (shown->what.amplification > 0)
        cJSON_AddNumberToObject(item, "amplification", shown->what.amplification);
}

/* What the page and the XML say of a row beyond its JSON. */
static cJSON *row_page(const struct sheet *sheet, const struct sheet_row *row)
{
    char used[16] = "-", own[32], *worst = sheet_worst(sheet, row);
    cJSON *item = cJSON_CreateObject();
    sheet_row_json(item, sheet, row);
    cJSON *page = cJSON_AddObjectToObject(item, "page");
    if (row->compared)
        difference_write_used(&row->difference, used);
    sheet_write_own(row, own);
    add_shown_text(page, "title", row->pass);
    add_shown_text(page, "name", row->name);
    add_shown_text(page, "body", row->body);
    add_shown_text(page, "about", row->resource->doc);
    add_shown_text(page, "largest", worst);
    add_shown_text(page, "used", used);
    add_shown_text(page, "own", own);
    add_shown_text(page, "remark", row->compared ? row->note : NULL);
    if (row->compared)
        add_pictures(page, row);
    free(worst);
    return item;
}

void sheets_page(cJSON *page, const struct sheet *const *sheets, uint32_t count)
{
    cJSON *pairs = cJSON_AddArrayToObject(page, "pairs");
    for (uint32_t i = 0; i < count; i++) {
        const struct sheet *sheet = sheets[i];
        cJSON *pair = cJSON_CreateObject();
        cJSON *rows = cJSON_AddArrayToObject(pair, "rows");
        cJSON *devices = cJSON_AddArrayToObject(pair, "devices");
        add_outcome(pair, sheet);
        for (int side = 0; side < 2; side++) {
            cJSON *device = cJSON_CreateObject();
            add_shown_text(device, "label", sheet->labels[side]);
            add_shown_text(device, "device", sheet->devices[side]);
            cJSON_AddItemToArray(devices, device);
        }
        for (uint32_t k = 0; k < sheet->count; k++)
            cJSON_AddItemToArray(rows, row_page(sheet, &sheet->rows[k]));
        cJSON_AddNumberToObject(pair, "early", sheet->early);
        cJSON_AddNumberToObject(pair, "alone", sheet->alone);
        cJSON_AddBoolToObject(pair, "blamed", sheet->blames);
        if (sheet->guilty.row)
            cJSON_AddNumberToObject(cJSON_GetObjectItem(pair, "guilty"), "row",
                                    (double)(sheet->guilty.row - sheet->rows - sheet->early));
        cJSON_AddItemToArray(pairs, pair);
    }
}

bool sheets_write(cJSON *page, const struct options *options, struct console *console)
{
    cJSON_AddStringToObject(page, "html", options->html);
    cJSON_AddStringToObject(page, "junit", options->junit);
    return python_child(console, "comparison", "writing the page", page, -1);
}
