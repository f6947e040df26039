/* The page of a sweep, from the result that goes to --json: all members of its rows, whatever they are. See sweep.h. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/fill.h"
#include "measure/sweep.h"

/* A member of a row as the table shows it; a list is joined by blanks. */
static void put_value(FILE *out, const cJSON *value)
{
    const cJSON *item;
    if (cJSON_IsString(value))
        fputs(value->valuestring, out);
    else if (cJSON_IsNumber(value))
        fprintf(out, "%.6g", value->valuedouble);
    else if (cJSON_IsBool(value))
        fputs(cJSON_IsTrue(value) ? "yes" : "no", out);
    cJSON_ArrayForEach(item, value) /* of a list alone */
    {
        put_value(out, item);
        fputs(item->next ? " " : "", out);
    }
}

static void add_value_cell(cJSON *cells, const cJSON *value)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return;
    put_value(out, value);
    fclose(out);
    cJSON *cell = cJSON_CreateObject();
    cJSON_AddStringToObject(cell, "text", text);
    cJSON_AddBoolToObject(cell, "word", !cJSON_IsNumber(value));
    cJSON_AddItemToArray(cells, cell);
    free(text);
}

/* Names of members that any row has, in the order of the first that has them; a command stands below the table. */
static cJSON *heads_of(const cJSON *rows)
{
    cJSON *heads = cJSON_CreateArray();
    const cJSON *row, *member, *head;
    cJSON_ArrayForEach(row, rows) cJSON_ArrayForEach(member, row)
    {
        bool known = strcmp(member->string, "command") == 0;
        cJSON_ArrayForEach(head, heads) known |= strcmp(head->valuestring, member->string) == 0;
        if (!known)
            cJSON_AddItemToArray(heads, cJSON_CreateString(member->string));
    }
    return heads;
}

static bool is_member(const cJSON *row, const char *name, const char *text)
{
    const char *value = cJSON_GetStringValue(cJSON_GetObjectItem(row, name));
    return value && strcmp(value, text) == 0;
}

/* The table's row; a run that is not as it should be also goes to `cases`, with its command. */
static void add_page_row(cJSON *page, const cJSON *heads, const cJSON *row)
{
    bool good = is_member(row, "verdict", "agree") || is_member(row, "agree", "yes");
    bool bad = is_member(row, "verdict", "differ") || is_member(row, "verdict", "failed") ||
               is_member(row, "agree", "no");
    const cJSON *head, *command = cJSON_GetObjectItem(row, "command");
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "class", good ? "agree" : bad ? "differ" : "");
    cJSON *cells = cJSON_AddArrayToObject(item, "cells");
    cJSON_ArrayForEach(head, heads)
        add_value_cell(cells, cJSON_GetObjectItem(row, head->valuestring));
    cJSON_AddItemToArray(cJSON_GetObjectItem(page, "rows"), item);
    if (bad && cJSON_IsString(command)) {
        cJSON *shown = cJSON_CreateObject();
        cJSON_AddNumberToObject(shown, "run",
                                cJSON_GetNumberValue(cJSON_GetObjectItem(row, "run")));
        cJSON_AddStringToObject(shown, "command", command->valuestring);
        cJSON_AddItemToArray(cJSON_GetObjectItem(page, "cases"), shown);
    }
}

static uint32_t count_rows(const cJSON *rows, const char *name, const char *text)
{
    const cJSON *row;
    uint32_t count = 0;
    cJSON_ArrayForEach(row, rows) count += is_member(row, name, text);
    return count;
}

static void add_verdict(cJSON *page, bool good, uint32_t count, int of, const char *what)
{
    char text[96];
    cJSON *verdict = cJSON_CreateObject();
    snprintf(text, sizeof text, "%" PRIu32 " of %d %s", count, of, what);
    cJSON_AddStringToObject(verdict, "class", good ? "agree" : "differ");
    cJSON_AddStringToObject(verdict, "text", text);
    cJSON_AddItemToArray(cJSON_GetObjectItem(page, "verdicts"), verdict);
}

/* What counts first stands first. */
static void add_verdicts(cJSON *page, const cJSON *rows)
{
    int of = cJSON_GetArraySize(rows);
    uint32_t differ = count_rows(rows, "verdict", "differ") + count_rows(rows, "agree", "no");
    uint32_t agree = count_rows(rows, "verdict", "agree") + count_rows(rows, "agree", "yes");
    uint32_t failed = count_rows(rows, "verdict", "failed") +
                      count_rows(rows, "verdict", "not run") + count_rows(rows, "status", "failed");
    if (differ)
        add_verdict(page, false, differ, of, "differ");
    if (failed)
        add_verdict(page, false, failed, of, "could not run");
    if (!differ && !failed && !agree)
        add_verdict(page, true, count_rows(rows, "status", "done"), of, "measured");
    if (agree)
        add_verdict(page, true, agree, of, "agree");
}

bool sweep_write_page(struct console *console, const char *folder, const cJSON *rows,
                      const cJSON *plots, const char *table)
{
    const cJSON *row;
    const char *slash = strrchr(folder, '/');
    char *path = format_string("%s/index.html", folder);
    cJSON *page = cJSON_CreateObject(), *heads = heads_of(rows);
    cJSON_AddStringToObject(page, "folder", slash ? slash + 1 : folder);
    cJSON_AddStringToObject(page, "csv", table);
    cJSON_AddArrayToObject(page, "verdicts");
    cJSON_AddArrayToObject(page, "rows");
    cJSON_AddArrayToObject(page, "cases");
    cJSON_AddItemToObject(page, "plots",
                          plots ? cJSON_Duplicate(plots, true) : cJSON_CreateArray());
    add_verdicts(page, rows);
    cJSON_ArrayForEach(row, rows) add_page_row(page, heads, row);
    cJSON_AddItemToObject(page, "heads", heads);
    bool good = path && fill_page(console, "sweep.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}
