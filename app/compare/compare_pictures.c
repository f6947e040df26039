/* The pictures that `compare` writes, of the frame in which an image differs most: for --pictures
 * a strip per image that differs, for --html those of every image. */
#include "compare/compare.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"

/* Replaces characters other than letters, digits and + by a dash: labels hold paths and device
 * names. */
static char *word_of(const char *label)
{
    char *word = strdup(label);
    for (char *at = word; at && *at; at++)
        if (!isalnum((unsigned char)*at) && *at != '+')
            *at = '-';
    return word;
}

/* "07.shade.irradiance" and an ending, as in a dump; with several pairs, the second side's label stands in
 * it. Logs its error. */
static char *file_name(const struct compare *compare, const struct pair *pair,
                       const struct row *row, const char *ending)
{
    const char *pass = compare->pipeline.info->passes[row->pass].name;
    const char *resource = compare->pipeline.info->resources[row->resource].name;
    char *mip = row->mip ? format_string(".mip%u", row->mip) : strdup("");
    char *side = compare->pair_count > 1 ? word_of(pair->sides[1]->label) : strdup("");
    char *name = mip && side ? format_string("%02u.%s.%s%s%s%s%s", row->pass, pass, resource, mip,
                                             side[0] ? "." : "", side, ending)
                             : NULL;
    if (!name)
        report_error(&compare->console->log, "out of memory");
    free(mip);
    free(side);
    return name;
}

static char *path_in(const struct compare *compare, const char *folder, const char *name)
{
    char *path = name ? format_string("%s/%s", folder, name) : NULL;
    if (name && !path)
        report_error(&compare->console->log, "out of memory");
    return path;
}

/* For --pictures. */
static bool add_strip(struct compare *compare, struct pair *pair, const struct row *row,
                      struct result *result, const struct dt_bytes copies[2])
{
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    char *name = file_name(compare, pair, row, ".png");
    free(result->picture);
    result->picture = path_in(compare, compare->options.pictures, name);
    free(name);
    return result->picture &&
           strip_write(&result->strip, result->picture, resource, copies, &compare->console->log);
}

/* For --html: a picture of equal copies, three of others; and the histogram. */
static bool add_shown(struct compare *compare, struct pair *pair, const struct row *row,
                      struct result *result, const struct dt_bytes copies[2])
{
    static const char *const endings[] = {".1.png", ".2.png", ".difference.png"};
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    const struct dt_log *log = &compare->console->log;
    bool differ = difference_verdict(&pair->found) != VERDICT_EQUAL;
    uint32_t count = resource->kind != DT_IMAGE ? 0 : differ ? SHOWN_PICTURES : 1;
    char *paths[SHOWN_PICTURES] = {0};
    bool good = true;
    for (uint32_t i = 0; i < count && good; i++) {
        free(result->shown[i]);
        result->shown[i] = file_name(compare, pair, row, endings[i]);
        paths[i] = path_in(compare, compare->options.html, result->shown[i]);
        good = paths[i];
    }
    if (good && count)
        good = strip_write_apart(&result->strip, (const char *const *)paths, resource, copies, log);
    if (good && differ && !difference_histogram(result->bins, resource, copies)) {
        report_error(log, "out of memory");
        good = false;
    }
    for (uint32_t i = 0; i < SHOWN_PICTURES; i++)
        free(paths[i]);
    return good;
}

bool compare_add_picture(struct compare *compare, uint32_t pair_index, uint32_t output)
{
    struct pair *pair = &compare->pairs[pair_index];
    const struct row *row = &compare->rows.outputs.list[output];
    struct row_source *sources[2] = {&compare->sources[0], &compare->sources[pair_index + 1]};
    struct result *result = &pair->results[output];
    bool image = compare->pipeline.info->resources[row->resource].kind == DT_IMAGE;
    bool differ = difference_verdict(&pair->found) != VERDICT_EQUAL;
    bool strip = compare->options.pictures && image && differ;
    bool shown = compare->options.html && (image || differ);
    struct dt_bytes copies[2];
    if (pair->found.size_differs || !(strip || shown))
        return true;
    for (int i = 0; i < 2; i++)
        if (!source_ask(sources[i], row) || !source_take(sources[i], row, &copies[i]))
            return false;
    return (!strip || add_strip(compare, pair, row, result, copies)) &&
           (!shown || add_shown(compare, pair, row, result, copies));
}
