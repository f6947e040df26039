/* Pictures of a comparison: --pictures and --html; see sheet.h. */
#include "result/sheet.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"

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
