/* The strips that `compare --pictures` writes: one per image that differs, of the frame in which it
 * differs most. Called by compare.c. */
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

/* "07.shade.irradiance.png", as in a dump; with several pairs, the second side's label stands in
 * it. */
static char *file_name(const struct compare *compare, const struct pair *pair,
                       const struct row *row)
{
    const char *pass = compare->pipeline.info->passes[row->pass].name;
    const char *resource = compare->pipeline.info->resources[row->resource].name;
    char *mip = row->mip ? format_string(".mip%u", row->mip) : strdup("");
    char *side = compare->pair_count > 1 ? word_of(pair->sides[1]->label) : strdup("");
    char *name = mip && side
                     ? format_string("%s/%02u.%s.%s%s%s%s.png", compare->options.pictures,
                                     row->pass, pass, resource, mip, side[0] ? "." : "", side)
                     : NULL;
    free(mip);
    free(side);
    return name;
}

bool compare_add_picture(struct compare *compare, uint32_t pair_index, uint32_t output)
{
    struct pair *pair = &compare->pairs[pair_index];
    const struct row *row = &compare->rows.outputs.list[output];
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    const struct dt_log *log = &compare->console->log;
    struct source *sources[2] = {&compare->sources[0], &compare->sources[pair_index + 1]};
    struct result *result = &pair->results[output];
    struct dt_bytes copies[2];
    if (!compare->options.pictures || resource->kind != DT_IMAGE || pair->found.size_differs ||
        difference_verdict(&pair->found) == VERDICT_EQUAL)
        return true;
    for (int i = 0; i < 2; i++)
        if (!source_ask(sources[i], row) || !source_take(sources[i], row, &copies[i]))
            return false;
    free(result->picture);
    result->picture = file_name(compare, pair, row);
    if (!result->picture) {
        report_error(log, "out of memory");
        return false;
    }
    return strip_write(&result->strip, result->picture, resource, copies, log);
}
