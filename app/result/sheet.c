/* The record of a comparison, and its table; see sheet.h. */
#include "result/sheet.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool sheet_begin(struct sheet *sheet, uint32_t rows, const struct dt_log *log)
{
    sheet->rows = calloc((size_t)rows + 1, sizeof *sheet->rows);
    return sheet->rows || report_error(log, "out of memory");
}

void sheet_free(struct sheet *sheet)
{
    for (uint32_t i = 0; i < sheet->count; i++) {
        struct sheet_row *row = &sheet->rows[i];
        for (int k = 0; k < SHOWN_PICTURES; k++)
            free(row->shown.files[k]);
        free(row->shown.strip);
        free(row->errors);
        cJSON_Delete(row->why);
    }
    cJSON_Delete(sheet->first_break.more);
    cJSON_Delete(sheet->guilty.more);
    cJSON_Delete(sheet->not_repeatable.more);
    cJSON_Delete(sheet->not_finite.more);
    free(sheet->rows);
    *sheet = (struct sheet){0};
}

struct sheet_event sheet_event(const struct sheet_row *row, uint32_t frame)
{
    return (struct sheet_event){.row = row, .frame = frame, .more = cJSON_CreateObject()};
}

void sheet_note_odd(struct sheet *sheet, const struct sheet_row *row, uint32_t frame,
                    const struct difference *found)
{
    if (sheet->not_finite.row || difference_verdict(found) != VERDICT_NOT_FINITE ||
        sheet_is_early(sheet, row))
        return;
    sheet->not_finite = sheet_event(row, frame);
    cJSON_AddStringToObject(sheet->not_finite.more, "what",
                            isnan(found->worst.values[0]) ? "NaN" : "infinity");
}

bool sheet_agrees(struct sheet *sheet, bool differs)
{
    if (differs) {
        cJSON_Delete(sheet->not_finite.more);
        sheet->not_finite = (struct sheet_event){0};
    }
    return !differs && !sheet->not_finite.row;
}

bool sheet_print_odd(const struct sheet *sheet)
{
    const struct sheet_event *event = &sheet->not_finite;
    if (event->row)
        printf("both agree; pass %s leaves %s\n", event->row->pass,
               cJSON_GetStringValue(cJSON_GetObjectItem(event->more, "what")));
    return event->row;
}

static const char *sheet_verdict(const struct sheet_row *row)
{
    return row->compared ? verdict_name(difference_verdict(&row->difference)) : row->verdict;
}

bool sheet_is_early(const struct sheet *sheet, const struct sheet_row *row)
{
    return row < sheet->rows + sheet->early;
}

const struct sheet *sheets_told(const struct sheet *const *sheets, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && sheets[i]->agree)
        i++;
    return sheets[i < count ? i : 0];
}

/* ---- The table --------------------------------------------------------------------------------- */

struct widths {
    int pass, name, verdict, own;
    bool used; /* some contract has a bound */
};

static int wider(int width, const char *text)
{
    int length = (int)strlen(text);
    return length > width ? length : width;
}

static const char *own_heading(const struct sheet *sheet)
{
    return sheet->blames ? "inputs  own error   " : "";
}

/* Of rows before the first frame, those that differ. */
static bool is_told(const struct sheet *sheet, const struct sheet_row *row)
{
    return !sheet_is_early(sheet, row) || difference_verdict(&row->difference) != VERDICT_EQUAL;
}

static struct widths measure(const struct sheet *sheet)
{
    struct widths widths = {6, 8, 7, (int)strlen(own_heading(sheet)), false};
    for (uint32_t i = 0; i < sheet->count; i++) {
        const struct sheet_row *row = &sheet->rows[i];
        if (!is_told(sheet, row))
            continue;
        widths.pass = wider(widths.pass, row->pass);
        widths.name = wider(widths.name, row->name);
        widths.verdict = wider(widths.verdict, sheet_verdict(row));
        widths.used |= row->compared && !isnan(difference_used(&row->difference));
    }
    return widths;
}

/* The strip's file, its layer and its amplification. */
static void print_strip(const struct sheet_row *row)
{
    const struct shown *shown = &row->shown;
    if (!shown->strip)
        return;
    printf("  picture %s: ", shown->strip);
    if (row->resource->layered)
        printf("layer %u, ", shown->what.layer);
    if (shown->what.amplification > 0)
        printf("difference x %.10g\n", shown->what.amplification);
    else
        printf("differences are white\n");
}

char *sheet_worst(const struct sheet *sheet, const struct sheet_row *row)
{
    if (row->text || !row->compared)
        return strdup(row->text ? row->text : "");
    return difference_describe_worst(&row->difference, row->resource, sheet->labels);
}

void sheet_write_own(const struct sheet_row *row, char text[32])
{
    const struct difference *own = row->own;
    if (own && own->differing && !own->size_differs)
        snprintf(text, 32, "%" PRIu64 " differ", own->differing);
    else
        snprintf(text, 32, "%s",
                 !own                ? ""
                 : own->size_differs ? "size"
                 : own->not_finite   ? "not finite"
                                     : "none");
}

static void print_own(const struct sheet *sheet, const struct sheet_row *row, int width)
{
    char own[32], text[48] = "";
    sheet_write_own(row, own);
    if (sheet->blames && row->inputs)
        snprintf(text, sizeof text, "%-6s  %-12s", row->inputs, own);
    if (width)
        printf("%-*s  ", width, text);
}

static void print_row(const struct sheet *sheet, const struct sheet_row *row,
                      const struct widths *widths)
{
    const struct difference *difference = &row->difference;
    char elements[24] = "-", differing[24] = "-", used[16] = "-", *flips = NULL;
    char *worst = sheet_worst(sheet, row);
    if (row->compared) {
        difference_write_used(difference, used);
        snprintf(elements, sizeof elements, "%" PRIu64, difference->elements);
        snprintf(differing, sizeof differing, "%" PRIu64, difference->differing);
        flips = difference_list_flips(difference, row->resource, sheet->labels);
    }
    if (!sheet->lone)
        printf("%-*s  ", widths->pass, row->pass);
    printf("%-*s  %10s  %10s  %-*s  ", widths->name, row->name, elements, differing,
           widths->verdict, sheet_verdict(row));
    if (widths->used)
        printf("%8s  ", used);
    print_own(sheet, row, widths->own);
    printf("%s\n%s", worst ? worst : "", flips ? flips : "");
    if (row->note)
        printf("  %s\n", row->note);
    print_strip(row);
    free(worst);
    free(flips);
}

void sheet_print(const struct sheet *sheet)
{
    const struct widths widths = measure(sheet);
    if (!sheet->lone)
        printf("%-*s  ", widths.pass, "pass");
    printf("%-*s  %10s  %10s  %-*s  %s%s%slargest error\n", widths.name, "resource", "elements",
           "differing", widths.verdict, "verdict", widths.used ? "of bound  " : "",
           own_heading(sheet), widths.own ? "  " : "");
    for (uint32_t i = 0; i < sheet->count; i++)
        if (is_told(sheet, &sheet->rows[i]))
            print_row(sheet, &sheet->rows[i], &widths);
}
