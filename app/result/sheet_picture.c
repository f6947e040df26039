/* Pictures of a comparison: --pictures and --html; see sheet.h. */
#include "result/sheet.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Characters other than letters, digits, ".", "-", "+" and "_" become _: for names of files. free(). */
static char *file_word(const char *text)
{
    char *word = strdup(text);
    for (char *at = word; at && *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("+._-", *at))
            *at = '_';
    return word;
}

static bool differs(const struct sheet_row *row)
{
    return difference_verdict(&row->difference) != VERDICT_EQUAL;
}

bool sheet_shows(const struct sheet_files *files, const struct sheet_row *row)
{
    bool image = row->resource->kind == DT_IMAGE, differ = differs(row);
    return !row->difference.size_differs &&
           ((files->pictures && image && differ) || (files->html && (image || differ)));
}

/* A picture of equal copies, three of others. */
static bool draw_apart(struct sheet_row *row, const struct sheet_files *files, const char *stem,
                       const struct dt_bytes copies[2], const struct dt_log *log)
{
    static const char *const endings[] = {".1.png", ".2.png", ".difference.png"};
    struct shown *shown = &row->shown;
    char *paths[SHOWN_PICTURES] = {0};
    uint32_t count = differs(row) ? SHOWN_PICTURES : 1;
    bool good = true, drawn = false;
    for (uint32_t i = 0; i < SHOWN_PICTURES; i++) {
        free(shown->files[i]);
        shown->files[i] = i < count ? format_string("%s%s", stem, endings[i]) : NULL;
        if (shown->files[i])
            paths[i] = format_string("%s/%s", files->html, shown->files[i]);
        good &= i >= count || paths[i];
    }
    if (!good)
        report_error(log, "out of memory");
    else
        drawn =
            strip_write_apart(&shown->what, (const char *const *)paths, row->resource, copies, log);
    for (uint32_t i = 0; i < SHOWN_PICTURES; i++)
        free(paths[i]);
    return drawn;
}

static bool draw_strip(struct sheet_row *row, const struct sheet_files *files, const char *stem,
                       const struct dt_bytes copies[2], const struct dt_log *log)
{
    free(row->shown.strip);
    row->shown.strip = format_string("%s/%s.png", files->pictures, stem);
    if (!row->shown.strip)
        report_error(log, "out of memory");
    return row->shown.strip &&
           strip_write(&row->shown.what, row->shown.strip, row->resource, copies, log);
}

bool sheet_draw(const struct sheet *sheet, struct sheet_row *row, const struct sheet_files *files,
                uint32_t number, const char *name, const struct dt_bytes copies[2],
                const struct dt_log *log)
{
    bool image = row->resource->kind == DT_IMAGE, differ = differs(row);
    if (!sheet_shows(files, row))
        return true;
    char *text = format_string("%02u.%s.%s%s%s", number, row->pass, name, files->several ? "." : "",
                               files->several ? sheet->labels[1] : "");
    char *stem = text ? file_word(text) : NULL;
    bool known = stem && (!files->html || !differ ||
                          difference_histogram(row->shown.bins, row->resource, copies));
    if (!known)
        report_error(log, "out of memory");
    bool good =
        known &&
        (!files->pictures || !image || !differ || draw_strip(row, files, stem, copies, log)) &&
        (!files->html || !image || draw_apart(row, files, stem, copies, log));
    free(text);
    free(stem);
    return good;
}
