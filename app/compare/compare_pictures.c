/* The pictures that `compare` writes, of the frame in which an image differs most: for --pictures
 * a strip per image that differs, for --html those of every image. */
#include "compare/compare.h"

#include <stdlib.h>
#include <string.h>

#include "base/files.h"

/* "07.shade.irradiance", as in a dump; with several pairs, the second side's label stands behind it. */
static char *stem_of(const struct compare *compare, const struct pair *pair, const struct row *row)
{
    const char *pass = compare->pipeline.info->passes[row->pass].name;
    const char *resource = compare->pipeline.info->resources[row->resource].name;
    char *mip = row->mip ? format_string(".mip%u", row->mip) : strdup("");
    char *side = compare->pair_count > 1 ? sheet_word(pair->sides[1]->label) : strdup("");
    char *stem = mip && side ? format_string("%02u.%s.%s%s%s%s", row->pass, pass, resource, mip,
                                             side[0] ? "." : "", side)
                             : NULL;
    if (!stem)
        report_error(&compare->console->log, "out of memory");
    free(mip);
    free(side);
    return stem;
}

bool compare_add_picture(struct compare *compare, uint32_t pair_index, uint32_t output)
{
    struct pair *pair = &compare->pairs[pair_index];
    const struct row *row = &compare->rows.outputs.list[output];
    struct row_source *sources[2] = {&compare->sources[0], &compare->sources[pair_index + 1]};
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    struct sheet_files files = {.pictures = compare->options.pictures,
                                .html = compare->options.html};
    struct dt_bytes copies[2];
    if (!sheet_shows(&files, resource, &pair->found))
        return true;
    for (int i = 0; i < 2; i++)
        if (!source_ask(sources[i], row) || !source_take(sources[i], row, &copies[i]))
            return false;
    char *stem = stem_of(compare, pair, row);
    files.stem = stem;
    bool good = stem && sheet_draw(&pair->results[output].shown, &files, resource, &pair->found,
                                   copies, &compare->console->log);
    free(stem);
    return good;
}
