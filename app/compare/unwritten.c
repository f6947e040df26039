/* Finds content that depends on the fill of memory; see unwritten.h. */
#include "compare/unwritten.h"

#include <stdlib.h>
#include <string.h>

#include "picture/texels.h"

static bool has_fill(const uint8_t *bytes, uint32_t size, int fill)
{
    uint32_t at = 0;
    while (at < size && bytes[at] == fill)
        at++;
    return at == size;
}

/* ---- The sentence ---------------------------------------------------------------------------- */

/* What differs: the first element and number, and how many elements. */
struct fill_differences {
    uint64_t element, elements;
    const struct component *component;
    bool written; /* the number is not the fill itself */
};

static struct fill_differences find_fill_differences(const struct component *list, uint32_t count,
                                                     uint32_t stride,
                                                     const struct dt_bytes copies[2])
{
    struct fill_differences found = {0};
    for (size_t at = 0; at < copies[0].size && at < copies[1].size; at += stride) {
        bool differs = false;
        for (uint32_t c = 0; c < count && !differs; c++) {
            const uint8_t *a = copies[0].data + at + list[c].offset,
                          *b = copies[1].data + at + list[c].offset;
            differs = number_bits(list[c].kind, a) != number_bits(list[c].kind, b);
            if (!differs || found.elements)
                continue;
            uint32_t size = number_size(list[c].kind);
            found.element = at / stride;
            found.component = &list[c];
            found.written = !has_fill(a, size, POISON_FIRST) || !has_fill(b, size, POISON_OTHERS);
        }
        found.elements += differs;
    }
    return found;
}

static char *sentence(const struct row *row, const struct dt_resource *resource,
                      const uint32_t extent[3], const struct fill_differences *found)
{
    const char *part = found->component->name;
    char *place = element_place(resource, extent, found->element);
    char *thing = !place ? NULL
                  : resource->kind == DT_IMAGE
                      ? format_string("texel %s of `%s`", place, row->name)
                      : format_string("`%s%s%s%s`", row->name, place, *part ? "." : "", part);
    char *others = found->elements > 1 ? format_string(", like %llu others",
                                                       (unsigned long long)(found->elements - 1))
                                       : strdup("");
    char *text = thing && others
                     ? format_string("%s %s in this frame%s", thing,
                                     found->written ? "depends on memory that was never written"
                                                    : "was never written",
                                     others)
                     : NULL;
    free(place);
    free(thing);
    free(others);
    return text;
}

bool unwritten_describe(const struct row *row, const struct dt_resource *resource,
                        const struct dt_bytes copies[2], char **text, bool *surely)
{
    struct component *list;
    uint32_t count = resource_components(resource, &list);
    *text = NULL;
    if (!count)
        return false;
    struct fill_differences found =
        find_fill_differences(list, count, resource_stride(resource), copies);
    if (found.elements)
        *text = sentence(row, resource, copies[0].extent, &found);
    *surely = !found.written;
    free(list);
    return *text || !found.elements;
}

/* ---- Two runs -------------------------------------------------------------------------------- */

static bool run_to(struct worker *worker, const struct row *row)
{
    struct worker_place place;
    do {
        if (!worker_wait(worker, &place))
            return false;
        if (place.stop == WORKER_AFTER_PASS && place.pass == row->pass)
            return true;
    } while (place.stop != WORKER_FINISHED && worker_resume(worker, DT_RUN));
    return false;
}

/* The runs: with either fill, and with the first one again. */
struct runs {
    const struct worker_info *info;
    const struct row *row;
    const struct dt_resource *resource;
    uint32_t frame;
    struct worker workers[3];
    struct dt_bytes copies[3];
};

static bool run(struct runs *runs, int index, int fill)
{
    struct worker_info info = *runs->info;
    struct worker *worker = &runs->workers[index];
    info.session.poison = fill;
    info.frames = runs->frame + 1;
    info.first_observed = runs->frame;
    info.quiet = true;
    return worker_start(worker, &info) && run_to(worker, runs->row) &&
           worker_read(worker, runs->row->resource, runs->row->mip, &runs->copies[index]);
}

/* Whether a second run with the first fill gives the same bytes; if not, a race causes the difference. */
static bool repeats(struct runs *runs, bool *same)
{
    const struct dt_bytes copies[2] = {runs->copies[0], runs->copies[2]};
    char *text = NULL;
    bool surely, good = unwritten_describe(runs->row, runs->resource, copies, &text, &surely);
    *same = good && !text;
    free(text);
    return good;
}

static bool compare_runs(struct runs *runs, char **text)
{
    bool surely = false, same = true;
    if (!run(runs, 0, POISON_FIRST) || !run(runs, 1, POISON_OTHERS))
        return false;
    bool good = unwritten_describe(runs->row, runs->resource, runs->copies, text, &surely);
    if (*text && !surely) {
        if (!run(runs, 2, POISON_FIRST))
            return false;
        good = repeats(runs, &same);
    }
    if (!same) {
        free(*text);
        *text = NULL;
    }
    return good || report_error(&runs->info->session.console->log, "out of memory");
}

bool unwritten_find(const struct worker_info *worker, const struct row *row, uint32_t frame,
                    char **text)
{
    struct runs runs = {.info = worker,
                        .row = row,
                        .resource = &worker->session.pipeline->info->resources[row->resource],
                        .frame = frame};
    *text = NULL;
    bool good = compare_runs(&runs, text);
    for (int i = 0; i < 3; i++)
        worker_close(&runs.workers[i]);
    return good;
}
