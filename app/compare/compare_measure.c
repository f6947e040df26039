/* --measure of specs: several runs of each side, in lockstep; see compare.h. */
#include "compare/compare.h"

#include <stdlib.h>

/* A row of a pair, as all runs have left it. */
struct measured_runs {
    const struct compare *compare;
    const struct sheet_row *row;
    const struct dt_bytes *copies; /* one per source */
    uint32_t sides[2];             /* of the pair */
};

static const struct dt_bytes *run_of(const struct measured_runs *runs, int side, uint32_t run)
{
    uint32_t more = runs->compare->options.repeats - 1, index = runs->sides[side];
    return &runs->copies[run ? runs->compare->sides.count + index * more + run - 1 : index];
}

static bool add_runs(void *user, struct errors *errors, const int sides[2], const uint32_t runs[2])
{
    const struct measured_runs *all = user;
    const struct dt_bytes copies[2] = {*run_of(all, sides[0], runs[0]),
                                       *run_of(all, sides[1], runs[1])};
    return measured_add(errors, all->row->resource, copies) ||
           report_error(&all->compare->console->log, "out of memory");
}

static bool take_all(struct compare *compare, const struct row *row, struct dt_bytes *copies)
{
    for (uint32_t i = 0; i < compare->source_count; i++)
        if (!source_ask(&compare->sources[i], row))
            return false;
    for (uint32_t i = 0; i < compare->source_count; i++)
        if (!source_take(&compare->sources[i], row, &copies[i]))
            return false;
    return true;
}

bool compare_measure(struct compare *compare, uint32_t output)
{
    const struct dt_log *log = &compare->console->log;
    struct dt_bytes *copies = calloc(compare->source_count, sizeof *copies);
    if (!copies)
        report_error(log, "out of memory");
    bool good = copies && take_all(compare, &compare->rows.outputs.list[output], copies);
    for (uint32_t i = 0; i < compare->pair_count && good; i++) {
        struct sheet_row *row = &compare->pairs[i].results[output];
        struct measured_runs runs = {compare, row, copies, {0, i + 1}};
        good = measured_row(row, compare->options.repeats, add_runs, &runs, log);
    }
    free(copies);
    return good;
}
