/* --measure of dumps: several runs of each side; see dumps.h. */
#include <stdlib.h>

#include "theirs/dumps.h"

struct measured_runs {
    const struct dumps *dumps;
    const struct their_entry *entry;
};

/* How far the entry of one run and its partner in another are apart. A run without it is as one of another size. */
static bool add_runs(void *user, struct errors *errors, const int sides[2], const uint32_t runs[2])
{
    const struct measured_runs *all = user;
    const struct theirs *const dumps[2] = {&all->dumps->sides[sides[0]][runs[0]],
                                           &all->dumps->sides[sides[1]][runs[1]]};
    struct match match = {
        .sides = {dumps_partner(dumps[0], all->entry, 0), dumps_partner(dumps[1], all->entry, 0)}};
    struct dt_bytes copies[2] = {0};
    bool same = false;
    bool good = !match.sides[0] || !match.sides[1] || dumps_load(dumps, &match, copies, &same);
    if (good && !measured_add(errors, &match.what, same ? copies : NULL)) {
        report_error(dumps[0]->log, "out of memory");
        good = false;
    }
    free(match.note);
    free(copies[0].data);
    free(copies[1].data);
    return good;
}

bool dumps_measure(struct dumps *dumps)
{
    bool good = true;
    for (uint32_t i = 0; i < dumps->count && good; i++) {
        const struct match *match = &dumps->matches[i];
        struct measured_runs runs = {dumps, match->sides[0]};
        if (match->row->compared)
            good = measured_row(match->row, dumps->runs, add_runs, &runs, &dumps->console->log);
    }
    return good;
}
