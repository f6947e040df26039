/* Pictures of a comparison and the rows of its page, templates/report/compare.html; see sheet.h. */
#include "result/sheet.h"

#include <cjson/cJSON.h>
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"

/* ---- Pictures ---------------------------------------------------------------------------------- */

char *sheet_word(const char *text)
{
    char *word = strdup(text);
    for (char *at = word; at && *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("+._-", *at))
            *at = '_';
    return word;
}

static bool differs(const struct difference *difference)
{
    return difference_verdict(difference) != VERDICT_EQUAL;
}

bool sheet_shows(const struct sheet_files *files, const struct dt_resource *resource,
                 const struct difference *difference)
{
    bool image = resource->kind == DT_IMAGE, differ = differs(difference);
    return !difference->size_differs &&
           ((files->pictures && image && differ) || (files->html && (image || differ)));
}

/* A picture of equal copies, three of others. */
static bool draw_apart(struct shown *shown, const struct sheet_files *files, uint32_t count,
                       const struct dt_resource *resource, const struct dt_bytes copies[2],
                       const struct dt_log *log)
{
    static const char *const endings[] = {".1.png", ".2.png", ".difference.png"};
    char *paths[SHOWN_PICTURES] = {0};
    bool good = true, drawn = false;
    for (uint32_t i = 0; i < SHOWN_PICTURES; i++) {
        free(shown->files[i]);
        shown->files[i] = i < count ? format_string("%s%s", files->stem, endings[i]) : NULL;
        if (shown->files[i])
            paths[i] = format_string("%s/%s", files->html, shown->files[i]);
        good &= i >= count || paths[i];
    }
    if (!good)
        report_error(log, "out of memory");
    else
        drawn = strip_write_apart(&shown->what, (const char *const *)paths, resource, copies, log);
    for (uint32_t i = 0; i < SHOWN_PICTURES; i++)
        free(paths[i]);
    return drawn;
}

bool sheet_draw(struct shown *shown, const struct sheet_files *files,
                const struct dt_resource *resource, const struct difference *difference,
                const struct dt_bytes copies[2], const struct dt_log *log)
{
    bool image = resource->kind == DT_IMAGE, differ = differs(difference);
    if (!sheet_shows(files, resource, difference))
        return true;
    if (files->pictures && image && differ) {
        free(shown->strip);
        shown->strip = format_string("%s/%s.png", files->pictures, files->stem);
        if (!shown->strip)
            report_error(log, "out of memory");
        if (!shown->strip || !strip_write(&shown->what, shown->strip, resource, copies, log))
            return false;
    }
    if (files->html && image &&
        !draw_apart(shown, files, differ ? SHOWN_PICTURES : 1, resource, copies, log))
        return false;
    if (!files->html || !differ || difference_histogram(shown->bins, resource, copies))
        return true;
    report_error(log, "out of memory");
    return false;
}

void sheet_free_shown(struct shown *shown)
{
    free(shown->strip);
    for (int i = 0; i < SHOWN_PICTURES; i++)
        free(shown->files[i]);
    *shown = (struct shown){0};
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
    const struct shown *shown = row->shown;
    if (!shown->files[0])
        return;
    cJSON *root = cJSON_AddObjectToObject(item, "shown");
    for (int i = 0; i < SHOWN_PICTURES; i++)
        cJSON_AddStringToObject(root, keys[i], shown->files[i] ? shown->files[i] : "");
    cJSON_AddNumberToObject(root, "across", row->difference->extent[0]);
    cJSON_AddNumberToObject(root, "down", row->difference->extent[1]);
    if (row->resource->layered)
        cJSON_AddNumberToObject(root, "layer", shown->what.layer);
    if (shown->what.amplification > 0)
        cJSON_AddNumberToObject(root, "amplification", shown->what.amplification);
}

static void add_escaped(cJSON *item, const char *key, const char *text)
{
    cJSON_AddStringToObject(item, key, text ? text : "");
}

/* What JSON has of compared rows, for the others. */
static void add_missing(cJSON *item, const struct sheet_row *row)
{
    static const char *const keys[] = {"elements", "differing"};
    for (int i = 0; i < 2; i++)
        if (!cJSON_HasObjectItem(item, keys[i]))
            cJSON_AddStringToObject(item, keys[i], "-");
    if (!cJSON_HasObjectItem(item, "verdict"))
        add_escaped(item, "verdict", row->verdict);
}

static void add_row(cJSON *item, const struct sheet *sheet, uint32_t index)
{
    const struct sheet_row *row = &sheet->rows[index];
    const struct difference *difference = row->difference;
    char used[16] = "-";
    char *worst = sheet_worst(sheet, row);
    bool opens = !index || strcmp(row->pass, sheet->rows[index - 1].pass) != 0;
    if (difference)
        difference_write_used(difference, used);
    add_missing(item, row);
    cJSON_AddNumberToObject(item, "row", index);
    add_escaped(item, "name", row->name);
    cJSON_AddBoolToObject(item, "opens_pass", opens);
    add_escaped(item, "body", row->body);
    add_escaped(item, "about", row->resource ? row->resource->doc : NULL);
    cJSON_AddBoolToObject(item, "equal", difference && !differs(difference));
    add_escaped(item, "largest", worst);
    add_escaped(item, "used", used);
    add_escaped(item, "remark", row->note);
    if (difference && row->shown) {
        add_pictures(item, row);
        add_histogram(item, row->shown);
    }
    free(worst);
}

void sheet_page(const struct sheet *sheet, cJSON *results)
{
    uint32_t index = 0;
    cJSON *item;
    cJSON_ArrayForEach(item, results) add_row(item, sheet, index++);
}
