/* --measure of dumps: several runs of each side; see dumps.h. */
#include <stdlib.h>

#include "theirs/dumps.h"

/* Adds how far an entry of one dump and its partner in another are apart. A run without it is as one of another size. */
static bool add_partners(struct errors *errors, const struct theirs *first,
                         const struct theirs *second, const struct their_entry *entry)
{
    const struct theirs *const sides[2] = {first, second};
    struct match match = {
        .sides = {dumps_partner(first, entry, 0), dumps_partner(second, entry, 0)}};
    struct dt_bytes copies[2];
    bool same = false;
    if (!match.sides[0] || !match.sides[1]) {
        errors->pairs++;
        errors->odd = true;
        return true;
    }
    bool good = dumps_load(sides, &match, copies, &same);
    if (good && same && !errors_add(errors, &match.what, copies)) {
        report_error(first->log, "out of memory");
        good = false;
    }
    if (good && !same) {
        errors->pairs++;
        errors->odd = true;
    }
    free(match.note);
    free(copies[0].data);
    free(copies[1].data);
    return good;
}

static bool measure(const struct dumps *dumps, const struct match *match, struct measured_row *row)
{
    const struct their_entry *entry = match->sides[0];
    bool good = true;
    *row = (struct measured_row){.pass = entry->pass,
                                 .name = match->name,
                                 .key = match->place,
                                 .resource = &match->what,
                                 .kept = match->kept};
    for (uint32_t i = 0; i < dumps->runs && good; i++) {
        for (uint32_t k = 0; k < i && good; k++)
            for (int side = 0; side < 2 && good; side++)
                good = add_partners(&row->noise[side], &dumps->sides[side][k],
                                    &dumps->sides[side][i], entry);
        for (uint32_t k = 0; k < dumps->runs && good; k++)
            good = add_partners(&row->between, &dumps->sides[0][i], &dumps->sides[1][k], entry);
    }
    return good;
}

bool dumps_measure(struct dumps *dumps)
{
    struct measured *measured = &dumps->measured;
    bool good = true;
    *measured = (struct measured){.labels = {dumps->sides[0]->label, dumps->sides[1]->label},
                                  .kind = dumps->kind,
                                  .runs = dumps->runs,
                                  .rows = calloc(dumps->count, sizeof *measured->rows)};
    if (!measured->rows) {
        report_error(&dumps->console->log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < dumps->count && good; i++)
        if (dumps->matches[i].compared)
            good = measure(dumps, &dumps->matches[i], &measured->rows[measured->count++]);
    return good;
}
