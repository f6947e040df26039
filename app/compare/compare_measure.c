/* --measure of specs: several runs of each side, in lockstep; see compare.h. */
#include "compare/compare.h"

#include <stdlib.h>

static const struct dt_bytes *run_of(const struct compare *compare, const struct dt_bytes *copies,
                                     uint32_t side, uint32_t run)
{
    uint32_t more = compare->options.repeats - 1;
    return &copies[run ? compare->sides.count + side * more + run - 1 : side];
}

static bool add_copies(struct errors *errors, const struct dt_resource *resource,
                       const struct dt_bytes *a, const struct dt_bytes *b)
{
    const struct dt_bytes copies[2] = {*a, *b};
    return errors_add(errors, resource, copies);
}

static bool add_all(const struct compare *compare, const struct pair *pair,
                    const struct dt_resource *resource, const struct dt_bytes *copies,
                    struct measured_row *row)
{
    const uint32_t sides[2] = {0, (uint32_t)(pair->sides[1] - compare->sides.list)};
    uint32_t runs = compare->options.repeats;
    bool good = true;
    for (uint32_t i = 0; i < runs && good; i++) {
        for (uint32_t k = 0; k < i && good; k++)
            for (int side = 0; side < 2 && good; side++)
                good =
                    add_copies(&row->noise[side], resource, run_of(compare, copies, sides[side], k),
                               run_of(compare, copies, sides[side], i));
        for (uint32_t k = 0; k < runs && good; k++)
            good = add_copies(&row->between, resource, run_of(compare, copies, 0, i),
                              run_of(compare, copies, sides[1], k));
    }
    return good;
}

static bool begin(const struct compare *compare, struct pair *pair)
{
    const struct row_list *outputs = &compare->rows.outputs;
    pair->measured = (struct measured){.labels = {pair->sides[0]->label, pair->sides[1]->label},
                                       .kind = MEASURED_BACKENDS,
                                       .runs = compare->options.repeats,
                                       .rows = calloc(outputs->count, sizeof *pair->measured.rows),
                                       .count = outputs->count};
    for (uint32_t i = 0; pair->measured.rows && i < outputs->count; i++) {
        const struct row *row = &outputs->list[i];
        const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
        const char *pass = compare->pipeline.info->passes[row->pass].name;
        pair->measured.rows[i] =
            (struct measured_row){.pass = pass,
                                  .name = row->name,
                                  .key = resource->name,
                                  .resource = resource,
                                  .kept = contracts_find(&compare->contracts, "", resource->name)};
    }
    return pair->measured.rows;
}

bool compare_measure(struct compare *compare, uint32_t output)
{
    const struct row *row = &compare->rows.outputs.list[output];
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    struct dt_bytes *copies = calloc(compare->source_count, sizeof *copies);
    bool good = copies;
    for (uint32_t i = 0; i < compare->source_count && copies; i++)
        if (!source_ask(&compare->sources[i], row)) {
            free(copies);
            return false;
        }
    for (uint32_t i = 0; i < compare->source_count && copies; i++)
        if (!source_take(&compare->sources[i], row, &copies[i])) {
            free(copies);
            return false;
        }
    for (uint32_t i = 0; i < compare->pair_count && good; i++) {
        struct pair *pair = &compare->pairs[i];
        good = (pair->measured.rows || begin(compare, pair)) &&
               add_all(compare, pair, resource, copies, &pair->measured.rows[output]);
    }
    if (!good)
        report_error(&compare->console->log, "out of memory");
    free(copies);
    return good;
}

bool compare_write_contracts(const struct compare *compare)
{
    struct measured *pairs = calloc(compare->pair_count, sizeof *pairs);
    if (!pairs) {
        report_error(&compare->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        pairs[i] = compare->pairs[i].measured;
        for (uint32_t side = 0; compare->twins && side < compare->sides.count; side++)
            for (uint32_t k = 0; compare->twins[side].errors && k < pairs[i].count; k++)
                errors_join(&pairs[i].rows[k].exact, &compare->twins[side].errors[k]);
    }
    bool good = measured_write(pairs, compare->pair_count, compare->options.write_contracts,
                               compare->console);
    free(pairs);
    return good;
}
