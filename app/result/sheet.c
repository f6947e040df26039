/* The table of a comparison and JUnit's XML of it; see sheet.h. */
#include "result/sheet.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/printable.h"

static const char *verdict_of(const struct sheet_row *row)
{
    return row->difference ? verdict_name(difference_verdict(row->difference)) : row->verdict;
}

static bool fails(const struct sheet_row *row)
{
    return !strcmp(verdict_of(row), verdict_name(VERDICT_DIFFERS));
}

/* ---- The table --------------------------------------------------------------------------------- */

struct widths {
    int pass, name, own;
    bool used; /* some contract has a bound */
};

static int wider(int width, const char *text)
{
    int length = (int)strlen(text);
    return length > width ? length : width;
}

static struct widths measure(const struct sheet *sheet)
{
    struct widths widths = {6, 8, 0, false};
    if (sheet->columns)
        widths.own = (int)strlen(sheet->columns);
    for (uint32_t i = 0; i < sheet->count; i++) {
        const struct sheet_row *row = &sheet->rows[i];
        widths.pass = wider(widths.pass, row->pass);
        widths.name = wider(widths.name, row->name);
        widths.used |= row->difference && !isnan(difference_used(row->difference));
    }
    return widths;
}

/* The strip's file, its layer and its amplification. */
static void print_strip(const struct sheet_row *row)
{
    const struct shown *shown = row->shown;
    if (!shown || !shown->strip)
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
    if (row->text || !row->difference)
        return strdup(row->text ? row->text : "");
    return difference_describe_worst(row->difference, row->resource, sheet->labels);
}

static void print_row(const struct sheet *sheet, const struct sheet_row *row,
                      const struct widths *widths)
{
    const struct difference *difference = row->difference;
    char elements[24] = "-", differing[24] = "-", used[16] = "-", *flips = NULL;
    char *worst = sheet_worst(sheet, row);
    if (difference) {
        difference_write_used(difference, used);
        snprintf(elements, sizeof elements, "%" PRIu64, difference->elements);
        snprintf(differing, sizeof differing, "%" PRIu64, difference->differing);
        flips = difference_list_flips(difference, row->resource, sheet->labels);
    }
    printf("%-*s  %-*s  %10s  %10s  %-7s  ", widths->pass, row->pass, widths->name, row->name,
           elements, differing, verdict_of(row));
    if (widths->used)
        printf("%8s  ", used);
    printf("%-*s%s%s\n%s", widths->own, row->own, widths->own ? "  " : "", worst ? worst : "",
           flips ? flips : "");
    if (row->note)
        printf("  %s\n", row->note);
    print_strip(row);
    free(worst);
    free(flips);
}

void sheet_print(const struct sheet *sheet)
{
    const struct widths widths = measure(sheet);
    printf("%-*s  %-*s  %10s  %10s  %-7s  %s%s%slargest error\n", widths.pass, "pass", widths.name,
           "resource", "elements", "differing", "verdict", widths.used ? "of bound  " : "",
           sheet->columns ? sheet->columns : "", sheet->columns ? "  " : "");
    for (uint32_t i = 0; i < sheet->count; i++)
        print_row(sheet, &sheet->rows[i], &widths);
}

/* ---- JUnit ------------------------------------------------------------------------------------- */

/* Control characters have no place in XML. */
static void put_escaped(FILE *out, const char *of)
{
    char *copy = text_printable(of);
    for (const char *text = copy ? copy : ""; *text; text++)
        if (strchr("&<>\"", *text))
            fprintf(out, "&#%d;", *text);
        else
            fputc((unsigned char)*text < ' ' ? ' ' : *text, out);
    free(copy);
}

static void put_attribute(FILE *out, const char *name, const char *text)
{
    fprintf(out, " %s=\"", name);
    put_escaped(out, text);
    fputc('"', out);
}

static void put_case(FILE *out, const struct sheet *sheet, const struct sheet_row *row)
{
    const struct difference *difference = row->difference;
    fputs("<testcase", out);
    put_attribute(out, "classname", row->pass);
    put_attribute(out, "name", row->name);
    if (!fails(row)) {
        fputs("/>\n", out);
        return;
    }
    char *worst = sheet_worst(sheet, row);
    fputs("><failure message=\"", out);
    if (difference)
        fprintf(out, "%" PRIu64 " of %" PRIu64 " differ; ", difference->differing,
                difference->elements);
    put_escaped(out, worst ? worst : "");
    if (row->note) {
        fputs("; ", out);
        put_escaped(out, row->note);
    }
    fputs("\"/></testcase>\n", out);
    free(worst);
}

static void put_suite(FILE *out, const struct sheet *sheet)
{
    uint32_t failures = 0;
    for (uint32_t i = 0; i < sheet->count; i++)
        failures += fails(&sheet->rows[i]);
    fputs("<testsuite", out);
    put_attribute(out, "name", sheet->title);
    fprintf(out, " tests=\"%u\" failures=\"%u\">\n", sheet->count, failures);
    if (sheet->devices[0])
        fputs("<properties>\n", out);
    for (int i = 0; i < 2 && sheet->devices[0]; i++) {
        fputs("<property", out);
        put_attribute(out, "name", sheet->labels[i]);
        put_attribute(out, "value", sheet->devices[i]);
        fputs("/>\n", out);
    }
    if (sheet->devices[0])
        fputs("</properties>\n", out);
    for (uint32_t i = 0; i < sheet->count; i++)
        put_case(out, sheet, &sheet->rows[i]);
    fputs("</testsuite>\n", out);
}

bool sheet_junit(const struct sheet *sheets, uint32_t count, const char *path,
                 struct console *console)
{
    struct file_draft draft;
    if (!file_draft_begin(&draft, &console->log)) {
        file_draft_discard(&draft);
        return false;
    }
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n", draft.out);
    for (uint32_t i = 0; i < count; i++)
        put_suite(draft.out, &sheets[i]);
    fputs("</testsuites>\n", draft.out);
    console_hold(console);
    bool good = file_draft_end(&draft, path, &console->log);
    console_release(console);
    return good;
}
