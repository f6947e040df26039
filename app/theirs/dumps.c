/* `diptych compare A B`: dumps of two renderers, no spec. One resource of each is in memory at a
 * time. */
#include "theirs/dumps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/options.h"
#include "theirs/compare_dumps.h"
#include "formats.h"

/* ---- Matching ---------------------------------------------------------------------------------- */

static bool same_place(const struct their_entry *a, const struct their_entry *b)
{
    return !strcmp(a->pass, b->pass) && !strcmp(a->resource, b->resource) && a->mip == b->mip;
}

static struct their_entry *find_partner(const struct theirs *theirs,
                                        const struct their_entry *entry, int frame_step)
{
    for (uint32_t i = 0; i < theirs->count; i++) {
        struct their_entry *other = &theirs->entries[i];
        if (same_place(other, entry) && other->again == entry->again &&
            other->frame == entry->frame + (uint32_t)frame_step)
            return other;
    }
    return NULL;
}

static bool match_all(struct dumps *dumps)
{
    struct theirs *first = &dumps->sides[0], *second = &dumps->sides[1];
    uint32_t matched = 0;
    dumps->count = first->count;
    dumps->matches = calloc(first->count + 1, sizeof *dumps->matches);
    for (uint32_t i = 0; dumps->matches && i < first->count; i++) {
        struct match *match = &dumps->matches[i];
        match->sides[0] = &first->entries[i];
        match->sides[1] = find_partner(second, match->sides[0], 0);
        match->place = format_string("%s.%s", match->sides[0]->pass, match->sides[0]->resource);
        matched += !!match->sides[1];
    }
    dumps->alone[0] = first->count - matched;
    dumps->alone[1] = second->count - matched;
    if (!dumps->matches)
        report_error(&dumps->console->log, "out of memory");
    else if (!matched)
        report_error(&dumps->console->log,
                     "%s, %s: no pass and resource have the same names in both; nothing to compare",
                     first->folder, second->folder);
    return matched;
}

/* ---- Judging ----------------------------------------------------------------------------------- */

static const struct dt_contract *find_contract(const struct dumps *dumps,
                                               const struct their_entry *entry)
{
    const struct dt_contract *found = NULL;
    size_t pass = strlen(entry->pass);
    int best = 0;
    for (uint32_t i = 0; i < dumps->contract_count; i++) {
        const char *name = dumps->contracts[i].name;
        int fit = !strncmp(name, entry->pass, pass) && name[pass] == '.' &&
                          !strcmp(name + pass + 1, entry->resource)
                      ? 3
                  : !strcmp(name, entry->resource) ? 2
                  : !strcmp(name, "default")       ? 1
                                                   : 0;
        if (fit > best) {
            best = fit;
            found = &dumps->contracts[i].contract;
        }
    }
    return found;
}

static bool has_floats(const struct component *component)
{
    return !number_is_integer(component->kind);
}

static bool not_finite(const struct component *component, const uint8_t *place)
{
    return has_floats(component) && !isfinite(number_value(component->kind, place));
}

/* A number that is NaN in both copies, or the same infinity, becomes 0 in both. */
static bool drop_not_finite(struct match *match, struct dt_bytes copies[2])
{
    struct component *list = NULL;
    uint32_t count = resource_components(&match->what, &list);
    uint32_t stride = resource_stride(&match->what);
    for (uint32_t c = 0; c < count; c++)
        for (size_t at = list[c].offset;
             number_is_float(list[c].kind) && at < copies[0].size && at < copies[1].size;
             at += stride) {
            uint8_t *a = copies[0].data + at, *b = copies[1].data + at;
            double x = not_finite(&list[c], a) ? number_value(list[c].kind, a) : 0;
            double y = x != 0 && not_finite(&list[c], b) ? number_value(list[c].kind, b) : 0;
            if (y == 0 || (isnan(x) != isnan(y)) || (!isnan(x) && x != y))
                continue;
            number_set_bits(list[c].kind, 0, a);
            number_set_bits(list[c].kind, 0, b);
            match->not_finite++;
        }
    free(list);
    return count;
}

/* The fields of a buffer that are integers, or the others. Returns how many. */
static uint32_t pick_fields(const struct dt_resource *resource, bool integers,
                            struct dt_field *fields)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < resource->field_count; i++)
        if ((type_info(resource->fields[i].type)->scalar != DT_TYPE_FLOAT) == integers)
            fields[count++] = resource->fields[i];
    return count;
}

/* Integers and floats of one buffer have different contracts: integers first. */
static bool measure_fields(struct match *match, const struct dt_bytes copies[2])
{
    struct dt_resource part = match->what;
    struct dt_field *fields = calloc(part.field_count, sizeof *fields);
    bool good = fields;
    for (int integers = 1; integers >= 0 && good; integers--) {
        part.field_count = pick_fields(&match->what, integers, fields);
        part.fields = fields;
        part.contract =
            integers ? (struct dt_contract){.kind = DT_CONTRACT_EXACT} : match->what.contract;
        if (part.field_count)
            good = difference_measure(&match->difference, &part, match->sides[0]->frame, copies);
        if (difference_verdict(&match->difference) == VERDICT_DIFFERS)
            break;
    }
    free(fields);
    return good;
}

static bool measure_match(const struct dumps *dumps, struct match *match,
                          const struct dt_bytes copies[2])
{
    const struct dt_contract *contract = find_contract(dumps, match->sides[0]);
    struct dt_resource *what = &match->what;
    bool integers = what->kind == DT_IMAGE && number_is_integer(format_info(what->format)->kind);
    what->contract = contract   ? *contract
                     : integers ? (struct dt_contract){.kind = DT_CONTRACT_EXACT}
                                : (struct dt_contract){.kind = DT_CONTRACT_ULP, .tolerance = 1};
    if (what->kind == DT_BUFFER && !contract)
        return measure_fields(match, copies);
    return difference_measure(&match->difference, what, match->sides[0]->frame, copies);
}

/* Both copies in one form; free them, also on false. *same: they could be compared. */
static bool load_both(struct dumps *dumps, struct match *match, struct dt_bytes copies[2],
                      bool *same)
{
    memset(copies, 0, 2 * sizeof *copies);
    for (int i = 0; i < 2; i++)
        if (!theirs_load(&dumps->sides[i], match->sides[i], &copies[i]))
            return false;
    free(match->note);
    match->note = NULL;
    match->not_finite = 0;
    *same = dumps_convert(match, copies);
    if (!*same && match->note)
        return true;
    if (!*same || !drop_not_finite(match, copies)) {
        report_error(&dumps->console->log, "out of memory");
        return false;
    }
    return true;
}

static bool compare_match(struct dumps *dumps, struct match *match)
{
    struct dt_bytes copies[2];
    bool good = load_both(dumps, match, copies, &match->compared);
    if (good && match->compared && !measure_match(dumps, match, copies)) {
        report_error(&dumps->console->log, "out of memory");
        good = false;
    }
    free(copies[0].data);
    free(copies[1].data);
    if (good && !dumps->guilty &&
        (!match->compared || difference_verdict(&match->difference) == VERDICT_DIFFERS))
        dumps->guilty = match;
    return good;
}

/* ---- Why --------------------------------------------------------------------------------------- */

/* The first copy of the resource in another frame or mip, for why; free(bytes->data). False where there is none. */
static bool load_relative(void *user, enum why_relative relative, int side, struct dt_bytes *bytes)
{
    struct dumps *dumps = user;
    const struct match *match = dumps->asked;
    const struct theirs *theirs = &dumps->sides[side];
    struct their_entry wanted = *match->sides[side], *found;
    int step = relative == WHY_FRAME_BEFORE ? -1 : relative == WHY_FRAME_AFTER ? 1 : 0;
    if (relative == WHY_MIP_FINER || relative == WHY_MIP_COARSER) {
        if (relative == WHY_MIP_FINER && !wanted.mip)
            return false;
        wanted.mip += relative == WHY_MIP_FINER ? UINT32_MAX : 1;
    }
    found = find_partner(theirs, &wanted, step);
    if (!found || !theirs_load(theirs, found, bytes))
        return false;
    bool same =
        found->what.kind == match->what.kind && found->what.kind == DT_IMAGE
            ? found->what.format == match->what.format
            : found->what.kind == match->what.kind && found->what.stride == match->what.stride;
    if (!same)
        free(bytes->data);
    return same;
}

static bool ask_why(struct dumps *dumps, struct match *match)
{
    struct dt_bytes copies[2];
    bool same, good = load_both(dumps, match, copies, &same);
    dumps->asked = match;
    const struct why_question question = {.resource = &match->what,
                                          .copies = copies,
                                          .labels = {dumps->sides[0].label, dumps->sides[1].label},
                                          .relative = load_relative,
                                          .user = dumps};
    if (good && same && !why_find(&match->why, &question)) {
        report_error(&dumps->console->log, "out of memory");
        good = false;
    }
    free(copies[0].data);
    free(copies[1].data);
    return good;
}

static bool explain(struct dumps *dumps)
{
    for (uint32_t i = 0; i < dumps->count && dumps->guilty; i++) {
        struct match *match = &dumps->matches[i];
        if (match->compared && difference_verdict(&match->difference) == VERDICT_DIFFERS &&
            !strcmp(match->sides[0]->pass, dumps->guilty->sides[0]->pass) &&
            match->sides[0]->frame == dumps->guilty->sides[0]->frame && !ask_why(dumps, match))
            return false;
    }
    return true;
}

/* ---- The verb ---------------------------------------------------------------------------------- */

static void dumps_release(struct dumps *dumps)
{
    for (uint32_t i = 0; dumps->matches && i < dumps->count; i++) {
        free(dumps->matches[i].note);
        free(dumps->matches[i].place);
        why_free(&dumps->matches[i].why);
    }
    free(dumps->matches);
    free(dumps->contracts);
    for (int i = 0; i < 2; i++)
        theirs_close(&dumps->sides[i]);
}

/* Two folders of the same name, or two dumps of one backend, are "first" and "second". */
static bool tell_apart(struct dumps *dumps)
{
    static const char *const names[2] = {"first", "second"};
    if (strcmp(dumps->sides[0].label, dumps->sides[1].label) != 0)
        return true;
    for (int i = 0; i < 2; i++) {
        free(dumps->sides[i].label);
        dumps->sides[i].label = strdup(names[i]);
        if (!dumps->sides[i].label)
            report_error(&dumps->console->log, "out of memory");
    }
    return dumps->sides[0].label && dumps->sides[1].label;
}

int compare_dumps(struct console *console, const struct options *options)
{
    struct dumps dumps = {.console = console};
    bool good = options->dumps[0] && options->dumps[1];
    if (!good)
        report_error(&console->log, "compare: two dumps are needed: compare A B");
    else if (options->setup.spec || options->setup.scene || options->setup.against ||
             options->golden || options->bisect || options->html || options->junit ||
             options->pictures) {
        report_error(&console->log, "compare: two dumps take --json and --contracts alone");
        good = false;
    }
    for (int i = 0; i < 2 && good; i++)
        good = theirs_open(&dumps.sides[i], options->dumps[i], &console->log);
    good = good && tell_apart(&dumps) && match_all(&dumps) &&
           (!options->contracts || dumps_contracts(&dumps, options->contracts));
    for (uint32_t i = 0; i < dumps.count && good; i++)
        if (dumps.matches[i].sides[1])
            good = compare_match(&dumps, &dumps.matches[i]);
    good = good && explain(&dumps);
    if (good)
        dumps_print(&dumps);
    if (good && options->json)
        console->result = dumps_json(&dumps);
    bool differ = dumps.guilty;
    dumps_release(&dumps);
    return !good ? EXIT_USAGE : differ ? EXIT_DIFFER : EXIT_FINE;
}
