/* Compares dumps of two renderers, no spec; see dumps.h. One resource of each is in memory at a time. */
#include "theirs/dumps.h"

#include <stdlib.h>
#include <string.h>

#include "picture/edges.h"
#include "theirs/why.h"
#include "formats.h"

/* ---- Matching ---------------------------------------------------------------------------------- */

static bool same_place(const struct their_entry *a, const struct their_entry *b)
{
    return !strcmp(a->pass, b->pass) && !strcmp(a->resource, b->resource) && a->mip == b->mip;
}

/* The entry of a dump with that pass, resource, mip and place among its likes, in a frame that many later; NULL: none. */
static struct their_entry *partner_of(const struct theirs *theirs, const struct their_entry *entry,
                                      int frame_step)
{
    for (uint32_t i = 0; i < theirs->count; i++) {
        struct their_entry *other = &theirs->entries[i];
        if (same_place(other, entry) && other->again == entry->again &&
            other->frame == entry->frame + (uint32_t)frame_step)
            return other;
    }
    return NULL;
}

/* "radiance", "radiance mip 2", "radiance mip 2 frame 7". */
static char *name_of(const struct their_entry *entry)
{
    char again[24] = "", mip[24] = "", frame[24] = "";
    if (entry->again)
        snprintf(again, sizeof again, " #%u", entry->again + 1);
    if (entry->mip)
        snprintf(mip, sizeof mip, " mip %u", entry->mip);
    if (entry->frame)
        snprintf(frame, sizeof frame, " frame %u", entry->frame);
    return format_string("%s%s%s%s", entry->resource, again, mip, frame);
}

static bool is_matched(const struct dumps *dumps, const struct their_entry *entry)
{
    for (uint32_t i = 0; i < dumps->count; i++)
        if (dumps->matches[i].sides[1] == entry)
            return true;
    return false;
}

static struct sheet_row row_of(const struct their_entry *entry, const char *name)
{
    return (struct sheet_row){.pass = entry->pass,
                              .name = name,
                              .resource = &entry->what,
                              .mip = (int)entry->mip,
                              .frame = entry->frame,
                              .verdict = "alone",
                              .text = "not in the first dump"};
}

static bool make_match(struct dumps *dumps, struct their_entry *entry)
{
    struct match *match = &dumps->matches[dumps->count++];
    match->sides[0] = entry;
    match->sides[1] = partner_of(dumps->sides[1], entry, 0);
    match->place = format_string("%s.%s", entry->pass, entry->resource);
    match->name = name_of(entry);
    match->row = &dumps->sheet.rows[dumps->sheet.count++];
    *match->row = row_of(entry, match->name);
    match->row->key = match->place;
    return match->place && match->name;
}

bool dumps_match(struct dumps *dumps)
{
    struct theirs *first = dumps->sides[0], *second = dumps->sides[1];
    struct sheet *sheet = &dumps->sheet;
    bool good = true;
    dumps->matches = calloc(first->count + 1, sizeof *dumps->matches);
    if (!sheet_begin(sheet, first->count + second->count, &dumps->console->log))
        return false;
    for (uint32_t i = 0; dumps->matches && i < first->count; i++)
        good &= make_match(dumps, &first->entries[i]);
    for (uint32_t i = 0; dumps->matches && i < second->count; i++)
        if (!is_matched(dumps, &second->entries[i])) {
            sheet->rows[sheet->count++] = row_of(&second->entries[i], second->entries[i].resource);
            sheet->alone++;
        }
    if (!dumps->matches || !good)
        report_error(&dumps->console->log, "out of memory");
    else if (sheet->alone == second->count)
        report_error(&dumps->console->log,
                     "%s, %s: no pass and resource have the same names in both; nothing to compare",
                     first->folder, second->folder);
    return dumps->matches && good && sheet->alone < second->count;
}

/* ---- Loading ----------------------------------------------------------------------------------- */

/* Zeros of two signs become 0 in both: they are no difference between two renderers. */
static bool level(const struct match *match, struct dt_bytes copies[2])
{
    struct component *list = NULL;
    uint32_t count = resource_components(&match->what, &list);
    uint32_t stride = resource_stride(&match->what);
    for (uint32_t c = 0; c < count; c++)
        for (size_t at = list[c].offset;
             number_is_float(list[c].kind) && at < copies[0].size && at < copies[1].size;
             at += stride) {
            uint8_t *a = copies[0].data + at, *b = copies[1].data + at;
            if (number_value(list[c].kind, a) != 0 || number_value(list[c].kind, b) != 0)
                continue;
            number_set_bits(list[c].kind, 0, a);
            number_set_bits(list[c].kind, 0, b);
        }
    free(list);
    return count;
}

/* Loads both copies of a match in one form; free(copies[].data), also on false. *same: they can be compared. */
static bool load_copies(struct theirs *const sides[2], struct match *match,
                        struct dt_bytes copies[2], bool *same)
{
    memset(copies, 0, 2 * sizeof *copies);
    for (int i = 0; i < 2; i++)
        if (!theirs_load(sides[i], match->sides[i], &copies[i]))
            return false;
    free(match->note);
    match->note = NULL;
    *same = dumps_convert(match, copies);
    if (!*same && match->note)
        return true;
    if (!*same || !level(match, copies))
        return report_error(sides[0]->log, "out of memory");
    return true;
}

/* Both copies of another resource of the match's pass, of which `wanted` says whether it is one; false: there is none. Free the copies. */
static bool load_beside(const struct dumps *dumps, const struct match *match,
                        bool (*wanted)(const struct match *match, const struct dt_resource *what),
                        struct dt_resource *what, struct dt_bytes copies[2])
{
    for (uint32_t i = 0; i < dumps->count; i++) {
        struct match beside = {.sides = {dumps->matches[i].sides[0], dumps->matches[i].sides[1]}};
        const struct their_entry *entry = beside.sides[0];
        bool same = false, found = false;
        if (!beside.sides[1] || strcmp(entry->pass, match->sides[0]->pass) != 0 ||
            entry->frame != match->sides[0]->frame || entry->mip != match->sides[0]->mip)
            continue;
        found = load_copies(dumps->sides, &beside, copies, &same) && same &&
                wanted(match, &beside.what);
        *what = beside.what;
        free(beside.note);
        if (found)
            return true;
        free(copies[0].data);
        free(copies[1].data);
    }
    return false;
}

/* ---- Judging ----------------------------------------------------------------------------------- */

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
static bool measure_fields(struct match *match, const struct dt_bytes copies[2],
                           struct difference *difference)
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
            good = difference_measure(difference, &part, match->sides[0]->frame, copies);
        if (difference_verdict(difference) == VERDICT_DIFFERS)
            break;
    }
    free(fields);
    return good;
}

static bool is_numbers(const struct match *match, const struct dt_resource *what)
{
    return what->kind == DT_IMAGE && number_is_integer(format_info(what->format)->kind) && match;
}

static bool is_depths(const struct match *match, const struct dt_resource *what)
{
    return what->kind == DT_IMAGE && what->format == DT_FORMAT_D32F && match;
}

/* `raster`: where a texel of the pass's triangle numbers, else of its depth, differs from one around it. NULL: nowhere. */
static bool find_edges(const struct dumps *dumps, const struct match *match,
                       const uint32_t extent[3], bool **edges)
{
    struct dt_resource what;
    struct dt_bytes found[2], depths[2];
    *edges = NULL;
    if (match->what.contract.kind != DT_CONTRACT_RASTER ||
        (!load_beside(dumps, match, is_numbers, &what, found) &&
         !load_beside(dumps, match, is_depths, &what, found)))
        return true;
    bool good = edges_find(edges, &what, found);
    if (*edges && what.format != DT_FORMAT_D32F &&
        load_beside(dumps, match, is_depths, &what, depths)) {
        if (!memcmp(depths[0].extent, found[0].extent, sizeof depths[0].extent) &&
            !memcmp(depths[1].extent, found[0].extent, sizeof depths[1].extent))
            edges_add_coincident(*edges, depths);
        free(depths[0].data);
        free(depths[1].data);
    }
    if (memcmp(found[0].extent, extent, sizeof found[0].extent) != 0) {
        free(*edges); /* of another size: no texel is at an edge */
        *edges = NULL;
    }
    free(found[0].data);
    free(found[1].data);
    return good;
}

static bool has_margin(const struct match *match, const struct dt_resource *what)
{
    return contracts_margin(match->kept, what) >= 0;
}

/* `flips` with `margin`. */
static void add_margins(const struct dumps *dumps, const struct match *match,
                        struct difference *difference)
{
    struct dt_resource margin, what = match->what;
    struct dt_bytes copies[2];
    if (!match->kept || !match->kept->margin || !difference->flip_count ||
        !load_beside(dumps, match, has_margin, &margin, copies))
        return;
    what.contract.margin_field = contracts_margin(match->kept, &margin);
    difference_add_margins(difference, &what, &margin, copies);
    free(copies[0].data);
    free(copies[1].data);
}

/* Judges the copies by the contract of the match. `raster` needs an integer image or depth of the same pass, `margin` a
 * buffer: they are looked for in the matches. */
static bool judge_copies(const struct dumps *dumps, struct match *match,
                         const struct dt_bytes copies[2])
{
    struct dt_resource *what = &match->what;
    struct difference *difference = &match->row->difference;
    bool integers = what->kind == DT_IMAGE && number_is_integer(format_info(what->format)->kind);
    bool *edges = NULL, good;
    match->kept =
        contracts_find(dumps->contracts, match->sides[0]->pass, match->sides[0]->resource);
    what->contract = match->kept ? match->kept->contract
                     : integers  ? (struct dt_contract){.kind = DT_CONTRACT_EXACT}
                                 : (struct dt_contract){.kind = DT_CONTRACT_ULP, .tolerance = 1};
    if (what->kind == DT_BUFFER && !match->kept)
        good = measure_fields(match, copies, difference);
    else
        good = find_edges(dumps, match, copies[0].extent, &edges) &&
               difference_measure_draw(difference, what, match->sides[0]->frame, copies, edges);
    free(edges);
    if (good)
        add_margins(dumps, match, difference);
    else
        report_error(&dumps->console->log, "out of memory");
    return good;
}

static bool compare_match(struct dumps *dumps, struct match *match)
{
    struct dt_bytes copies[2];
    struct sheet_row *row = match->row;
    bool good = load_copies(dumps->sides, match, copies, &row->compared);
    const struct sheet_files files = {dumps->options->pictures, dumps->options->html,
                                      dumps->several};
    row->resource = row->compared ? &match->what : row->resource;
    if (good && row->compared)
        good = judge_copies(dumps, match, copies) &&
               sheet_draw(&dumps->sheet, row, &files, (uint32_t)(match - dumps->matches),
                          match->name, copies, &dumps->console->log);
    free(copies[0].data);
    free(copies[1].data);
    sheet_note_odd(&dumps->sheet, row, row->frame, &row->difference);
    if (good && !dumps->first &&
        (!row->compared || difference_verdict(&row->difference) == VERDICT_DIFFERS))
        dumps->first = match;
    return good;
}

/* ---- Why --------------------------------------------------------------------------------------- */

struct asked_match {
    struct theirs *const *sides;
    const struct match *match;
};

/* The copy of the resource in another frame or mip, for why; free(bytes->data). False where there is none. */
static bool load_relative(void *user, enum why_relative relative, int side, struct dt_bytes *bytes)
{
    const struct asked_match *asked = user;
    const struct match *match = asked->match;
    struct their_entry wanted = *match->sides[side], *found;
    int step = relative == WHY_FRAME_BEFORE ? -1 : relative == WHY_FRAME_AFTER ? 1 : 0;
    if (relative == WHY_MIP_FINER || relative == WHY_MIP_COARSER) {
        if (relative == WHY_MIP_FINER && !wanted.mip)
            return false;
        wanted.mip += relative == WHY_MIP_FINER ? UINT32_MAX : 1;
    }
    found = partner_of(asked->sides[side], &wanted, step);
    if (!found && step) { /* frames without numbers: the same pass again */
        wanted.again += (uint32_t)step;
        found = partner_of(asked->sides[side], &wanted, 0);
    }
    if (!found || !theirs_load(asked->sides[side], found, bytes))
        return false;
    bool same =
        found->what.kind == match->what.kind && found->what.kind == DT_IMAGE
            ? found->what.format == match->what.format
            : found->what.kind == match->what.kind && found->what.stride == match->what.stride;
    if (!same)
        free(bytes->data);
    return same;
}

/* False: logged. Copies that cannot be compared are left out. */
static bool add_question(const struct dumps *dumps, struct match *match, struct why_batch *batch)
{
    struct dt_bytes copies[2];
    struct asked_match asked = {dumps->sides, match};
    const struct dt_contract contract = match->what.contract; /* loading makes `what` anew */
    bool *edges = NULL, same, good = load_copies(dumps->sides, match, copies, &same);
    match->what.contract = contract;
    if (good && same && find_edges(dumps, match, copies[0].extent, &edges))
        why_add(batch,
                &(struct why_question){.resource = &match->what,
                                       .copies = copies,
                                       .labels = {dumps->sides[0]->label, dumps->sides[1]->label},
                                       .edges = edges,
                                       .relative = load_relative,
                                       .user = &asked});
    free(edges);
    free(copies[0].data);
    free(copies[1].data);
    return good;
}

static bool is_first_pass(const struct dumps *dumps, const struct match *match)
{
    return !strcmp(match->sides[0]->pass, dumps->first->sides[0]->pass) &&
           match->sides[0]->frame == dumps->first->sides[0]->frame;
}

/* Asks about matches from `next` on, as many as go in a batch: those of the first pass that differs, or others, until one has more than noise. */
static bool explain_some(struct dumps *dumps, bool first_pass, uint32_t *next)
{
    enum { MOST_CONTENT = 256 << 20 };
    struct match **asked = calloc(dumps->count, sizeof *asked);
    struct why_batch batch = {0};
    int count = 0;
    bool good = asked || report_error(&dumps->console->log, "out of memory");
    for (; *next < dumps->count && good && batch.size < MOST_CONTENT; ++*next) {
        struct match *match = &dumps->matches[*next];
        if (!match->row->compared || is_first_pass(dumps, match) != first_pass ||
            difference_verdict(&match->row->difference) != VERDICT_DIFFERS)
            continue;
        good = add_question(dumps, match, &batch);
        if (cJSON_GetArraySize(batch.questions) > count)
            asked[count++] = match;
    }
    cJSON *answers =
        batch.questions ? why_ask_all(&batch, !first_pass, dumps->console) : cJSON_CreateArray();
    bool known = answers;
    for (int i = 0; i < count && cJSON_GetArraySize(answers); i++) {
        asked[i]->row->why = cJSON_DetachItemFromArray(answers, 0);
        if (!dumps->loud && !cJSON_IsTrue(cJSON_GetObjectItem(asked[i]->row->why, "noise")))
            dumps->loud = asked[i];
    }
    *next = known ? *next : dumps->count; /* without Python there are no reasons */
    cJSON_Delete(answers);
    free(asked);
    return good;
}

/* The resources of the first pass that differs; where all of them have noise alone, those behind it, until one has more. */
static bool explain(struct dumps *dumps)
{
    bool good = true;
    for (int first_pass = 1; first_pass >= 0 && dumps->first; first_pass--)
        for (uint32_t i = 0; i < dumps->count && good && (first_pass || !dumps->loud);)
            good = explain_some(dumps, first_pass, &i);
    return good;
}

/* ---- Several runs of each side, for --measure --------------------------------------------------- */

struct measured_runs {
    const struct dumps *dumps;
    const struct their_entry *entry;
};

/* How far the entry of one run and its partner in another are apart. A run without it is as one of another size. */
static bool add_runs(void *user, struct errors *errors, const int sides[2], const uint32_t runs[2])
{
    const struct measured_runs *all = user;
    struct theirs *const dumps[2] = {&all->dumps->sides[sides[0]][runs[0]],
                                     &all->dumps->sides[sides[1]][runs[1]]};
    struct match match = {
        .sides = {partner_of(dumps[0], all->entry, 0), partner_of(dumps[1], all->entry, 0)}};
    struct dt_bytes copies[2] = {0};
    bool same = false;
    bool good = !match.sides[0] || !match.sides[1] || load_copies(dumps, &match, copies, &same);
    errors->missing |= !match.sides[0] || !match.sides[1];
    if (good && !measured_add(errors, &match.what, same ? copies : NULL)) {
        report_error(dumps[0]->log, "out of memory");
        good = false;
    }
    free(match.note);
    free(copies[0].data);
    free(copies[1].data);
    return good;
}

static bool measure_matches(struct dumps *dumps)
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

/* ---- All ---------------------------------------------------------------------------------------- */

bool dumps_compare(struct dumps *dumps)
{
    for (uint32_t i = 0; i < dumps->count; i++)
        if (dumps->matches[i].sides[1] && !compare_match(dumps, &dumps->matches[i]))
            return false;
    return explain(dumps) && (!dumps->options->repeats || measure_matches(dumps));
}

void dumps_free(struct dumps *dumps)
{
    for (uint32_t i = 0; i < dumps->count; i++) {
        struct match *match = &dumps->matches[i];
        free(match->note);
        free(match->place);
        free(match->name);
    }
    free(dumps->matches);
    sheet_free(&dumps->sheet);
    *dumps = (struct dumps){0};
}
