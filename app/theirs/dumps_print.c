/* Table, JSON, page and XML of `compare A B`; see dumps.h. */
#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/fill.h"
#include "theirs/dumps.h"

/* ---- A sheet ----------------------------------------------------------------------------------- */

static bool is_matched(const struct dumps *dumps, const struct their_entry *entry)
{
    for (uint32_t i = 0; i < dumps->count; i++)
        if (dumps->matches[i].sides[1] == entry)
            return true;
    return false;
}

static void write_own(char text[40], const struct match *match)
{
    if (match->ran && match->own.differing)
        snprintf(text, 40, "%" PRIu64 " differ", match->own.differing);
    else
        snprintf(text, 40, "%s", match->ran ? "none" : "");
}

static struct sheet_row row_of(const struct match *match)
{
    struct sheet_row row = {
        .pass = match->sides[0]->pass, .name = match->name, .note = match->note};
    if (match->compared) {
        row.resource = &match->what;
        row.difference = &match->difference;
        row.shown = &match->shown;
    } else {
        row.verdict = match->sides[1] ? verdict_name(VERDICT_DIFFERS) : "alone";
        row.text = match->sides[1] ? match->note : "not in the second dump";
        row.note = NULL;
    }
    write_own(row.own, match);
    return row;
}

static bool make_sheet(const struct dumps *dumps, bool alone, struct sheet *sheet)
{
    const struct theirs *first = dumps->sides[0], *second = dumps->sides[1];
    *sheet = (struct sheet){
        .title = format_string("%s against %s", second->label, first->label),
        .labels = {first->label, second->label},
        .devices = {first->folder, second->folder},
        .columns = dumps->request->run_second && dumps->first ? "own error   " : NULL,
        .rows = calloc((size_t)dumps->count + second->count + 1, sizeof *sheet->rows)};
    if (!sheet->title || !sheet->rows) {
        report_error(&dumps->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < dumps->count; i++)
        sheet->rows[sheet->count++] = row_of(&dumps->matches[i]);
    for (uint32_t i = 0; i < second->count && alone; i++)
        if (!is_matched(dumps, &second->entries[i]))
            sheet->rows[sheet->count++] = (struct sheet_row){.pass = second->entries[i].pass,
                                                             .name = second->entries[i].resource,
                                                             .verdict = "alone",
                                                             .text = "not in the first dump"};
    return true;
}

static void free_sheet(struct sheet *sheet)
{
    free((char *)sheet->title);
    free(sheet->rows);
}

/* ---- On stdout --------------------------------------------------------------------------------- */

static bool has_why(const struct match *match)
{
    return match->compared && match->why.count;
}

static void print_grown(const struct dumps *dumps)
{
    for (uint32_t i = 0; i < dumps->measured.count; i++)
        measured_grown(&dumps->measured, &dumps->measured.rows[i]);
    for (uint32_t i = 0; i < dumps->count && !dumps->measured.rows; i++) {
        const struct match *match = &dumps->matches[i];
        if (match->compared)
            measured_compare(match->kept, dumps->kind, "", match->place,
                             difference_error(&match->difference));
    }
}

static void print_outcome(const struct dumps *dumps)
{
    const struct match *told = dumps->guilty;
    char frame[32] = "";
    if (told && told->sides[0]->frame)
        snprintf(frame, sizeof frame, ", in frame %u", told->sides[0]->frame);
    if (!dumps->first && measured_breaks(&dumps->measured))
        printf("the first runs agree, but not all do\n");
    else if (!dumps->first)
        printf("all %u resources that both have agree\n", dumps->count - dumps->alone[0]);
    else if (!told)
        printf("no pass is guilty alone: on the resources of %s, each keeps its contracts\n",
               dumps->sides[0]->label);
    else
        printf("%s: %s, resource %s%s\n",
               told->ran ? "guilty, on the same inputs" : "first pass that differs",
               told->sides[0]->pass, told->sides[0]->resource, frame);
}

void dumps_print(const struct dumps *dumps)
{
    struct sheet sheet;
    if (dumps->several)
        printf("\n%s against %s\n", dumps->sides[1]->label, dumps->sides[0]->label);
    for (int i = 0; i < 2; i++)
        printf("%s: %s\n", dumps->sides[i]->label, dumps->sides[i]->folder);
    printf("\n");
    if (make_sheet(dumps, true, &sheet))
        sheet_print(&sheet);
    free_sheet(&sheet);
    if (dumps->request->measures)
        measured_print(&dumps->measured);
    printf("\n");
    for (uint32_t i = 0; i < dumps->count; i++) {
        const struct match *match = &dumps->matches[i];
        if (match->not_finite)
            printf("%s: %" PRIu64 " numbers are NaN or infinite in both, and count as equal\n",
                   match->place, match->not_finite);
        for (uint32_t k = 0; has_why(match) && k < match->why.count; k++)
            printf("%s %s: %s\n", k ? "or  " : "why:", match->sides[0]->resource,
                   match->why.reasons[k].text);
    }
    print_grown(dumps);
    if (dumps->alone[0] || dumps->alone[1])
        printf("without a partner: %u in the first dump, %u in the second\n", dumps->alone[0],
               dumps->alone[1]);
    print_outcome(dumps);
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static cJSON *entry_json(const struct their_entry *entry)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pass", entry->pass);
    cJSON_AddStringToObject(root, "resource", entry->resource);
    cJSON_AddNumberToObject(root, "mip", entry->mip);
    cJSON_AddNumberToObject(root, "frame", entry->frame);
    return root;
}

static cJSON *match_json(const struct dumps *dumps, const struct match *match)
{
    const char *const labels[2] = {dumps->sides[0]->label, dumps->sides[1]->label};
    cJSON *root = entry_json(match->sides[0]);
    if (match->compared)
        difference_json(root, &match->difference, &match->what, labels);
    else
        cJSON_AddStringToObject(root, "verdict",
                                match->sides[1] ? verdict_name(VERDICT_DIFFERS) : "alone");
    if (match->note)
        cJSON_AddStringToObject(root, "note", match->note);
    if (match->not_finite)
        cJSON_AddNumberToObject(root, "not_finite_in_both", (double)match->not_finite);
    if (match->shown.strip)
        cJSON_AddStringToObject(cJSON_AddObjectToObject(root, "picture"), "file",
                                match->shown.strip);
    if (match->ran)
        difference_json(cJSON_AddObjectToObject(root, "own_error"), &match->own, &match->what,
                        labels);
    if (has_why(match))
        why_json(root, &match->why);
    return root;
}

static void add_results(cJSON *root, const struct dumps *dumps)
{
    const struct theirs *second = dumps->sides[1];
    cJSON *sides = cJSON_AddArrayToObject(root, "sides");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(sides, cJSON_CreateString(dumps->sides[i]->label));
    cJSON_AddBoolToObject(root, "agree", !dumps->first && !measured_breaks(&dumps->measured));
    cJSON *guilty = dumps->guilty ? entry_json(dumps->guilty->sides[0]) : cJSON_CreateNull();
    if (dumps->guilty && dumps->guilty->ran)
        cJSON_AddBoolToObject(guilty, "ran_again", true);
    cJSON_AddItemToObject(root, "guilty", guilty);
    cJSON *results = cJSON_AddArrayToObject(root, "results");
    for (uint32_t i = 0; i < dumps->count; i++)
        cJSON_AddItemToArray(results, match_json(dumps, &dumps->matches[i]));
    cJSON *alone = cJSON_AddArrayToObject(root, "only_in_second");
    for (uint32_t i = 0; i < second->count; i++)
        if (!is_matched(dumps, &second->entries[i]))
            cJSON_AddItemToArray(alone, entry_json(&second->entries[i]));
    if (dumps->request->measures)
        cJSON_AddItemToObject(root, "measured", measured_json(&dumps->measured));
}

cJSON *dumps_json(const struct dumps *pairs, uint32_t count)
{
    cJSON *root = cJSON_CreateObject(), *list = NULL;
    bool agree = true;
    if (count == 1) {
        add_results(root, pairs);
        return root;
    }
    for (uint32_t i = 0; i < count; i++)
        agree &= !pairs[i].first && !measured_breaks(&pairs[i].measured);
    cJSON_AddBoolToObject(root, "agree", agree);
    list = cJSON_AddArrayToObject(root, "pairs");
    for (uint32_t i = 0; i < count; i++) {
        cJSON *pair = cJSON_CreateObject();
        add_results(pair, &pairs[i]);
        cJSON_AddItemToArray(list, pair);
    }
    return root;
}

/* ---- Page and XML ------------------------------------------------------------------------------ */

/* Reasons of all resources of the guilty pass. */
static void add_why(cJSON *page, const struct dumps *dumps)
{
    cJSON *list = cJSON_AddArrayToObject(page, "why");
    for (uint32_t i = 0; i < dumps->count; i++) {
        const struct match *match = &dumps->matches[i];
        for (uint32_t k = 0; has_why(match) && k < match->why.count; k++) {
            char *text = format_string("%s: %s", match->name, match->why.reasons[k].text);
            cJSON *item = cJSON_CreateObject();
            cJSON_AddStringToObject(item, "text", text ? text : "");
            cJSON_AddItemToArray(list, item);
            free(text);
        }
    }
}

static cJSON *pair_page(const struct dumps *dumps, uint32_t index)
{
    cJSON *page = cJSON_CreateObject();
    struct sheet sheet;
    add_results(page, dumps);
    cJSON_AddNumberToObject(page, "pair", index);
    cJSON_AddStringToObject(page, "first", dumps->sides[0]->label);
    cJSON_AddStringToObject(page, "second", dumps->sides[1]->label);
    add_why(page, dumps);
    if (dumps->guilty)
        cJSON_AddNumberToObject(cJSON_GetObjectItem(page, "guilty"), "row",
                                (double)(dumps->guilty - dumps->matches));
    if (make_sheet(dumps, false, &sheet))
        sheet_page(&sheet, cJSON_GetObjectItem(page, "results"));
    free_sheet(&sheet);
    return page;
}

static void add_device(cJSON *devices, const struct theirs *theirs)
{
    cJSON *device = cJSON_CreateObject();
    cJSON_AddStringToObject(device, "label", theirs->label);
    cJSON_AddStringToObject(device, "device", theirs->folder);
    cJSON_AddItemToArray(devices, device);
}

bool dumps_html(const struct dumps *pairs, uint32_t count)
{
    char *path = format_string("%s/index.html", pairs->request->html);
    cJSON *page = cJSON_CreateObject();
    cJSON_AddStringToObject(page, "pipeline", "Dumps");
    cJSON *devices = cJSON_AddArrayToObject(page, "devices");
    add_device(devices, pairs[0].sides[0]);
    cJSON *list = cJSON_AddArrayToObject(page, "pairs");
    for (uint32_t i = 0; i < count; i++) {
        add_device(devices, pairs[i].sides[1]);
        cJSON_AddItemToArray(list, pair_page(&pairs[i], i));
    }
    bool good = path && fill_page(pairs->console, "compare.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}

bool dumps_junit(const struct dumps *pairs, uint32_t count)
{
    struct sheet *sheets = calloc(count, sizeof *sheets);
    bool good = sheets;
    if (!sheets)
        report_error(&pairs->console->log, "out of memory");
    for (uint32_t i = 0; i < count && good; i++)
        good = make_sheet(&pairs[i], true, &sheets[i]);
    good = good && sheet_junit(sheets, count, pairs->request->junit, pairs->console);
    for (uint32_t i = 0; sheets && i < count; i++)
        free_sheet(&sheets[i]);
    free(sheets);
    return good;
}
