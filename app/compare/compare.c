/* `diptych compare`: compares the first side with each of the others, every resource after every
 * pass. All sides step through the passes together, so only one resource of each is in memory. */
#include "compare/compare.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "spec/inputs.h"
#include "compare/bisect.h"
#include "compare/unwritten.h"
#include "theirs/compare_dumps.h"
#include "theirs/why.h"

/* A dump holds only the last frame. */
static uint32_t first_frame(const struct compare *compare)
{
    return compare->options.setup.against ? compare->options.setup.frames - 1 : 0;
}

/* ---- One row --------------------------------------------------------------------------------- */

static bool is_worse(const struct difference *a, const struct difference *b)
{
    if (difference_verdict(a) != difference_verdict(b))
        return difference_verdict(a) > difference_verdict(b);
    if (a->beyond != b->beyond)
        return a->beyond > b->beyond;
    if (a->differing != b->differing)
        return a->differing > b->differing;
    return a->worst.valid && (!b->worst.valid || a->worst.error > b->worst.error);
}

/* Of what breaks its contract first, while both copies are there. */
static void ask_why(struct pair *pair, const struct dt_resource *resource,
                    const struct dt_bytes copies[2], struct console *console)
{
    const struct why_question question = {.resource = resource,
                                          .copies = copies,
                                          .labels = {pair->sides[0]->label, pair->sides[1]->label}};
    if (!pair->broken && !pair->why && !pair->found.size_differs &&
        difference_verdict(&pair->found) == VERDICT_DIFFERS)
        pair->why = why_ask(&question, console);
}

/* Compares all sides' copies of one row at this stop; each pair's result goes to pair->found. */
static bool compare_copies(struct compare *compare, const struct row *row, uint32_t frame,
                           uint64_t *hash)
{
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    struct dt_bytes copies[2];
    for (uint32_t i = 0; i < compare->sides.count; i++)
        if (!source_ask(&compare->sources[i], row))
            return false;
    if (!source_take(&compare->sources[0], row, &copies[0]))
        return false;
    bool good = fingerprint(resource, &copies[0], hash);
    for (uint32_t i = 0; i < compare->pair_count && good; i++) {
        struct pair *pair = &compare->pairs[i];
        if (!source_take(&compare->sources[i + 1], row, &copies[1]))
            return false;
        good = difference_measure(&pair->found, resource, frame, copies);
        if (good)
            ask_why(pair, resource, copies, compare->console);
    }
    return good || report_error(&compare->console->log, "out of memory");
}

/* Both copies of a pair at this stop. */
static bool take_both(struct compare *compare, uint32_t pair, const struct row *row,
                      struct dt_bytes copies[2])
{
    struct row_source *sources[2] = {&compare->sources[0], &compare->sources[pair + 1]};
    for (int i = 0; i < 2; i++)
        if (!source_ask(sources[i], row) || !source_take(sources[i], row, &copies[i]))
            return false;
    return true;
}

/* Adds the margins at which the flips found last were decided. */
static bool add_margins(struct compare *compare, uint32_t index, const struct row *row)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const struct dt_resource *resource = &info->resources[row->resource];
    const struct row margin = {.pass = row->pass, .resource = resource->contract.margin_resource};
    struct dt_bytes copies[2];
    if (!difference_needs_margins(&compare->pairs[index].found, resource))
        return true;
    if (!take_both(compare, index, &margin, copies))
        return false;
    difference_add_margins(&compare->pairs[index].found, resource,
                           &info->resources[margin.resource], copies);
    return true;
}

/* --pictures and --html: what they show of a row's result. Files are named as in a dump. */
static bool draw(struct compare *compare, uint32_t index, struct sheet_row *result,
                 const struct row *row)
{
    const struct dt_log *log = &compare->console->log;
    const struct sheet_files files = {compare->options.pictures, compare->options.html,
                                      compare->pair_count > 1};
    struct dt_bytes copies[2];
    if (!sheet_shows(&files, result))
        return true;
    char *name = row->mip ? format_string("%s.mip%u", result->resource->name, row->mip)
                          : strdup(result->resource->name);
    if (!name)
        report_error(log, "out of memory");
    bool good =
        name && take_both(compare, index, row, copies) &&
        sheet_draw(&compare->pairs[index].sheet, result, &files, row->pass, name, copies, log);
    free(name);
    return good;
}

/* Keeps what was found of a row in a frame, unless an earlier frame was worse. */
static bool keep_result(struct pair *pair, struct sheet_row *result, uint32_t frame, uint64_t hash)
{
    const struct difference *found = &pair->found;
    enum verdict verdict = difference_verdict(found);
    bool kept = !result->difference.elements || is_worse(found, &result->difference);
    result->frames_differing += verdict != VERDICT_EQUAL;
    if (kept) {
        result->difference = *found;
        result->frame = frame;
    }
    if (!pair->broken && verdict == VERDICT_DIFFERS) {
        pair->broken = result;
        pair->broken_frame = frame;
    }
    sheet_note_odd(&pair->sheet, result, frame, found);
    if (!pair->broken || pair->broken_frame == frame) { /* for blame */
        result->differs = found->differing || found->size_differs;
        result->hash = hash;
    }
    return kept;
}

static bool compare_output(struct compare *compare, uint32_t index, uint32_t frame)
{
    const struct row *row = &compare->rows.outputs.list[index];
    uint64_t hash = 0;
    if (!compare_copies(compare, row, frame, &hash) ||
        (compare->options.repeats && !compare_measure(compare, index)))
        return false;
    if (compare->options.golden && !golden_add(compare, index, frame, hash))
        return false;
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        struct pair *pair = &compare->pairs[i];
        if (!add_margins(compare, i, row) ||
            (keep_result(pair, &pair->results[index], frame, hash) &&
             !draw(compare, i, &pair->results[index], row)))
            return false;
        compare->compared += pair->found.elements;
    }
    return true;
}

/* Compares resources with history before the frame. Only the first frame's are kept: later frames start from results that
 * were compared after the frame before. */
static bool compare_history(struct compare *compare, uint32_t frame)
{
    for (uint32_t i = 0; i < compare->rows.history.count; i++) {
        uint64_t hash;
        if (!compare_copies(compare, &compare->rows.history.list[i], frame, &hash))
            return false;
        for (uint32_t k = 0; k < compare->pair_count; k++) {
            struct pair *pair = &compare->pairs[k];
            struct sheet_row *result = &pair->sheet.rows[i];
            if (frame == first_frame(compare))
                keep_result(pair, result, frame, hash);
            else if (!pair->broken || pair->broken_frame == frame)
                result->differs = pair->found.differing || pair->found.size_differs;
        }
    }
    return true;
}

/* ---- The walk -------------------------------------------------------------------------------- */

static bool advance(struct compare *compare, struct worker_place place)
{
    for (uint32_t i = 0; i < compare->source_count; i++)
        if (!source_resume(&compare->sources[i]))
            return false;
    for (uint32_t i = 0; i < compare->source_count; i++)
        if (!source_reach(&compare->sources[i], place))
            return false;
    return true;
}

static bool run_frame(struct compare *compare, uint32_t frame)
{
    const struct dt_pipeline *info = compare->pipeline.info;
    const uint32_t *first = compare->rows.outputs.first;
    if (compare->rows.history.count &&
        (!advance(compare, (struct worker_place){WORKER_BEFORE_PASS, frame, 0}) ||
         !compare_history(compare, frame)))
        return false;
    for (uint32_t pass = 0; pass < info->pass_count; pass++) {
        console_status(compare->console, "frame %u of %u, pass %s", frame + 1,
                       compare->options.setup.frames, info->passes[pass].name);
        if (!advance(compare, (struct worker_place){WORKER_AFTER_PASS, frame, pass}))
            return false;
        for (uint32_t i = first[pass]; i < first[pass + 1]; i++)
            if (!compare_output(compare, i, frame))
                return false;
    }
    return advance(compare, (struct worker_place){WORKER_FRAME_DONE, frame, 0});
}

static struct dump_reader *dump_of(struct compare *compare, uint32_t side)
{
    return compare->sides.list[side].folder ? &compare->dump : NULL;
}

static struct worker_info describe_worker(struct compare *compare, uint32_t index)
{
    struct worker_info info = {.session = {.side = &compare->sides.list[index],
                                           .console = compare->console,
                                           .setup = &compare->options.setup,
                                           .pipeline = &compare->pipeline,
                                           .scene = &compare->scene,
                                           .poison = index ? POISON_OTHERS : POISON_FIRST},
                               .frames = compare->options.setup.frames,
                               .first_observed = first_frame(compare),
                               .stops_before = compare->rows.history.count > 0};
    return info;
}

static bool start_all(struct compare *compare)
{
    uint32_t sides = compare->sides.count;
    console_status(compare->console, "opening the devices and creating the programs");
    for (uint32_t i = 0; i < compare->source_count; i++) {
        uint32_t side = i < sides ? i : (i - sides) / (compare->options.repeats - 1);
        struct worker_info info = describe_worker(compare, side);
        if (i >= sides) /* memory that no pass has written differs within a side as well */
            info.session.poison = side ? POISON_FIRST : POISON_OTHERS;
        if (!source_start(&compare->sources[i], &info, dump_of(compare, side)))
            return false;
    }
    for (uint32_t i = 0; i < compare->source_count; i++) {
        if (!source_reach(&compare->sources[i], (struct worker_place){.stop = WORKER_READY}))
            return false;
        if (i < sides)
            compare->devices[i] = strdup(source_device(&compare->sources[i]));
    }
    return true;
}

/* --sanitize: what the frames have found on each side. */
static bool read_undefined(struct compare *compare)
{
    const struct row row = {.resource = plan_reports(compare->pipeline.plan)};
    for (uint32_t i = 0; i < compare->sides.count && compare->options.setup.sanitize; i++) {
        struct row_source *source = &compare->sources[i];
        struct dt_bytes bytes;
        if (source->dump)
            continue;
        if (!source_ask(source, &row) || !source_take(source, &row, &bytes) ||
            !undefined_add(&compare->undefined, &compare->pipeline, i, &bytes,
                           &compare->console->log))
            return false;
    }
    if (compare->options.setup.sanitize)
        undefined_warn_idle(&compare->pipeline, compare->console);
    return true;
}

static bool run_all(struct compare *compare)
{
    uint32_t frames = compare->options.setup.frames;
    bool good = start_all(compare);
    for (uint32_t frame = first_frame(compare); frame < frames && good; frame++)
        good = run_frame(compare, frame);
    good = good && read_undefined(compare) &&
           advance(compare, (struct worker_place){.stop = WORKER_FINISHED, .frame = frames});
    for (uint32_t i = 0; i < compare->source_count; i++)
        source_close(&compare->sources[i]);
    return good;
}

/* Whether neither device's name contains the other's, as that of zink contains the one that it
 * draws with. */
static bool are_strangers(const char *a, const char *b)
{
    return a && b && !strstr(a, b) && !strstr(b, a);
}

/* The pair agrees on equal inputs: the passes' own errors are the result. */
static void take_own(struct compare *compare, struct pair *pair)
{
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++) {
        pair->results[i].difference = pair->blame.own[i];
        pair->results[i].frame = pair->blame.frame;
        pair->results[i].own = NULL;
        pair->results[i].inputs = NULL;
    }
    pair->broken = NULL;
    pair->sheet.on_equal_inputs = true;
}

/* Only pairs that differ are run again. */
static bool find_blame(struct compare *compare)
{
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        struct pair *pair = &compare->pairs[i];
        const struct replay replay = {
            .console = compare->console,
            .rows = &compare->rows,
            .workers = {describe_worker(compare, 0), describe_worker(compare, i + 1)},
            .dump = dump_of(compare, 0),
            .frame = pair->broken_frame,
            .strangers = are_strangers(compare->devices[0], compare->devices[i + 1])};
        if (pair->broken && !blame_find(&pair->blame, &replay, &pair->sheet, pair->broken))
            return false;
        if (pair->blame.outcome == BLAME_WITHIN)
            take_own(compare, pair);
    }
    return true;
}

static bool find_elsewhere(struct compare *compare)
{
    uint32_t runs = compare->options.repeat;
    /* The checks of --sanitize need more than the spec does. */
    bool good = compare->options.setup.sanitize ||
                elsewhere_add_limits(&compare->elsewhere, compare->pipeline.vk->panel,
                                     &compare->console->log);
    for (uint32_t i = 0; i < compare->sides.count && good; i++) {
        const struct worker_info worker = describe_worker(compare, i);
        bool vulkan = strcmp(worker.session.side->backend, "vk") == 0;
        if (dump_of(compare, i))
            continue;
        if (vulkan && compare->options.setup.debug)
            good = elsewhere_barriers(&compare->elsewhere, &worker, compare->rows.pipeline);
        if (runs && good)
            good = elsewhere_repeat(&compare->elsewhere, &worker, &compare->rows, runs);
    }
    return good;
}

/* --measure: for contracts. */
static void add_twin_errors(struct compare *compare, const struct twin *twin)
{
    for (uint32_t i = 0; i < compare->pair_count; i++)
        for (uint32_t k = 0; k < compare->rows.outputs.count; k++) {
            const struct sheet_row *row = &compare->pairs[i].results[k];
            for (uint32_t t = 0; row->errors && t < twin->sheet.count; t++)
                if (twin->sheet.rows[t].pass == row->pass && twin->sheet.rows[t].name == row->name)
                    errors_join(&row->errors->exact, &twin->sheet.rows[t].errors->exact);
        }
}

/* Each side in the last frame, if a pass is not exact. A dump runs nothing. */
static bool judge_twins(struct compare *compare)
{
    const struct setup *setup = &compare->options.setup;
    if (!twin_is_needed(&compare->pipeline))
        return true;
    compare->twins = calloc(compare->sides.count, sizeof *compare->twins);
    if (!compare->twins)
        return report_error(&compare->console->log, "out of memory");
    bool good = twin_load(&compare->exact, &compare->pipeline, compare->console, setup);
    for (uint32_t i = 0; i < compare->sides.count && good; i++) {
        const struct worker_info worker = describe_worker(compare, i);
        good = dump_of(compare, i) ||
               twin_judge(&compare->twins[i], &worker, &compare->exact, &compare->rows,
                          compare->pairs[0].results, setup->frames - 1);
        add_twin_errors(compare, &compare->twins[i]);
    }
    return good;
}

/* Whether the first row that broke depends on memory that nothing has written. */
static bool find_unwritten(struct compare *compare)
{
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        struct pair *pair = &compare->pairs[i];
        const struct worker_info worker = describe_worker(compare, i + 1);
        if (!pair->broken || sheet_is_early(&pair->sheet, pair->broken))
            continue;
        console_status(compare->console, "running %s with other fills of memory",
                       pair->sides[1]->label);
        if (!unwritten_find(&worker, &compare->rows.outputs.list[pair->broken - pair->results],
                            pair->broken_frame, &pair->unwritten))
            return false;
    }
    return true;
}

const struct twin *compare_far_twin(const struct compare *compare)
{
    for (uint32_t i = 0; compare->twins && i < compare->sides.count; i++)
        if (compare->twins[i].broken)
            return &compare->twins[i];
    return NULL;
}

/* The region of --bisect, for JSON. Axes: x, y and, in layered images, the layer; or the index of an element. */
static void add_region(const struct compare *compare, cJSON *event)
{
    const struct pair *pair = compare->bisected;
    const struct dt_resource *resource = pair->blame.row->resource;
    int axes = resource->kind == DT_BUFFER ? 1 : resource->layered ? 3 : 2;
    cJSON *item = cJSON_AddObjectToObject(event, "region");
    cJSON_AddNumberToObject(item, "failing", (double)compare->found.failing);
    region_json(item, &compare->found, axes);
    cJSON_AddStringToObject(event, "case", compare->options.bisect);
}

static void conclude_blame(struct compare *compare, struct pair *pair)
{
    struct sheet *sheet = &pair->sheet;
    const struct blame *blame = &pair->blame;
    struct sheet_row *row = blame->row;
    sheet->blames = blame->outcome != BLAME_NOT_RUN && !sheet->on_equal_inputs;
    if (blame->outcome == BLAME_NOT_REPEATABLE) {
        sheet->not_repeatable = sheet_event(row, blame->frame);
        cJSON_AddStringToObject(sheet->not_repeatable.more, "side", blame->side->label);
    }
    if (blame->outcome != BLAME_GUILTY)
        return;
    sheet->guilty = sheet_event(row, blame->frame);
    cJSON_AddStringToObject(sheet->guilty.more, "shader", row->body);
    if (compare->region && pair == compare->bisected)
        add_region(compare, sheet->guilty.more);
    if (!pair->unwritten && row == pair->broken && blame->frame == pair->broken_frame)
        row->why = cJSON_Duplicate(pair->why, true);
}

static void conclude(struct compare *compare)
{
    for (uint32_t i = 0; i < compare->pair_count; i++) {
        struct pair *pair = &compare->pairs[i];
        struct sheet *sheet = &pair->sheet;
        sheet->devices[0] = compare->devices[0];
        sheet->devices[1] = compare->devices[i + 1];
        sheet->agree = sheet_agrees(sheet, pair->broken) &&
                       (sheet->on_equal_inputs || !measured_breaks(sheet));
        conclude_blame(compare, pair);
        if (!pair->broken)
            continue;
        sheet->first_break = sheet_event(pair->broken, pair->broken_frame);
        pair->broken->text = pair->unwritten;
        cJSON_AddStringToObject(sheet->first_break.more, "unwritten", pair->unwritten);
    }
}

/* --bisect: of the first pair with a guilty pass. */
static bool keep_evidence(struct compare *compare)
{
    const char *folder = compare->options.bisect;
    for (uint32_t i = 0; i < compare->pair_count && folder; i++) {
        const struct blame *blame = &compare->pairs[i].blame;
        const struct replay replay = {
            .console = compare->console,
            .rows = &compare->rows,
            .workers = {describe_worker(compare, 0), describe_worker(compare, i + 1)},
            .dump = dump_of(compare, 0),
            .frame = blame->frame};
        const char *const devices[2] = {compare->devices[0], compare->devices[i + 1]};
        if (blame->outcome != BLAME_GUILTY)
            continue;
        compare->bisected = &compare->pairs[i];
        compare->region = bisect(&replay, (uint32_t)(blame->row - compare->pairs[i].results),
                                 devices, folder, &compare->found);
        return compare->region;
    }
    if (folder)
        report_message(&compare->console->log, DT_INFO,
                       "--bisect %s: no pass is guilty; nothing was written", folder);
    return true;
}

/* ---- The verb -------------------------------------------------------------------------------- */

static struct sheet_row describe_row(const struct compare *compare, const struct row *row,
                                     bool early)
{
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    const struct dt_pass *pass = &compare->pipeline.info->passes[row->pass];
    return (struct sheet_row){
        .pass = early ? "before" : pass->name,
        .name = row->name,
        .key = resource->name,
        .resource = resource,
        .kept = early ? NULL : contracts_find(&compare->contracts, "", resource->name),
        .mip = resource->mips > 1 ? (int)row->mip : -1,
        .compared = true,
        .body = early ? NULL : pass->shader};
}

static bool begin_sheet(struct compare *compare, struct pair *pair)
{
    const struct rows *rows = &compare->rows;
    struct sheet *sheet = &pair->sheet;
    *sheet = (struct sheet){.pipeline = compare->pipeline.info->name,
                            .labels = {pair->sides[0]->label, pair->sides[1]->label},
                            .early = rows->history.count,
                            .kind = MEASURED_BACKENDS,
                            .runs = compare->options.repeats};
    if (!sheet_begin(sheet, rows->history.count + rows->outputs.count, &compare->console->log))
        return false;
    for (uint32_t i = 0; i < rows->history.count; i++)
        sheet->rows[sheet->count++] = describe_row(compare, &rows->history.list[i], true);
    for (uint32_t i = 0; i < rows->outputs.count; i++)
        sheet->rows[sheet->count++] = describe_row(compare, &rows->outputs.list[i], false);
    pair->results = sheet->rows + sheet->early;
    return true;
}

static bool allocate_pairs(struct compare *compare)
{
    uint32_t sides = compare->sides.count;
    compare->pair_count = sides - 1;
    compare->source_count = sides * (compare->options.repeats ? compare->options.repeats : 1);
    compare->sources = calloc(compare->source_count, sizeof *compare->sources);
    compare->devices = calloc(sides, sizeof *compare->devices);
    compare->pairs = calloc(compare->pair_count, sizeof *compare->pairs);
    compare->golden.hashes = calloc(compare->rows.outputs.count, sizeof *compare->golden.hashes);
    compare->sheets = calloc(compare->pair_count, sizeof *compare->sheets);
    bool good = compare->sources && compare->devices && compare->pairs && compare->golden.hashes &&
                compare->sheets;
    if (!good)
        report_error(&compare->console->log, "out of memory");
    for (uint32_t i = 0; i < compare->pair_count && good; i++) {
        struct pair *pair = &compare->pairs[i];
        pair->sides[0] = &compare->sides.list[0];
        pair->sides[1] = &compare->sides.list[i + 1];
        compare->sheets[i] = &pair->sheet;
        good = begin_sheet(compare, pair);
    }
    return good;
}

static void compare_release(struct compare *compare)
{
    for (uint32_t i = 0; compare->pairs && i < compare->pair_count; i++) {
        struct pair *pair = &compare->pairs[i];
        blame_free(&pair->blame);
        cJSON_Delete(pair->why);
        sheet_free(&pair->sheet);
        free(pair->unwritten);
    }
    for (uint32_t i = 0; compare->devices && i < compare->sides.count; i++)
        free(compare->devices[i]);
    free(compare->region);
    free(compare->pairs);
    free(compare->sheets);
    free(compare->labels);
    free(compare->devices);
    free(compare->sources);
    dump_reader_close(&compare->dump);
    golden_free(&compare->golden);
    rows_free(&compare->rows);
    for (uint32_t i = 0; compare->twins && i < compare->sides.count; i++)
        twin_free(&compare->twins[i]);
    free(compare->twins);
    pipeline_unload(&compare->exact);
    undefined_free(&compare->undefined);
    contracts_free(&compare->contracts);
    elsewhere_free(&compare->elsewhere);
    scene_free(&compare->scene);
    pipeline_unload(&compare->pipeline);
    sides_free(&compare->sides);
}

/* Comparing no element would always agree: an error. */
static bool compares_something(const struct compare *compare, uint64_t count, const char *what)
{
    return count || report_error(&compare->console->log, "%s: %s: nothing to compare",
                                 compare->pipeline.info->name, what);
}

/* Takes size and frame from the dump; before the pipeline is loaded. */
static bool open_dump(struct compare *compare)
{
    const char *folder = compare->options.setup.against;
    const struct dt_log *log = &compare->console->log;
    return dump_reader_open(&compare->dump, folder, log) &&
           identity_take_frame(compare->dump.manifest, folder, &compare->options.setup, log);
}

/* Checks that the dump is of this pipeline, scene and parameters. */
static bool check_dump(struct compare *compare)
{
    const struct options *options = &compare->options;
    const struct dt_log *log = &compare->console->log;
    const cJSON *manifest = compare->dump.manifest;
    const struct identity identity =
        pipeline_identity(&compare->pipeline, &compare->scene, &options->setup);
    compare->dump.pipeline = compare->pipeline.info;
    memcpy(compare->dump.size, options->setup.size, sizeof compare->dump.size);
    return identity_check(manifest, options->setup.against, &identity, log) &&
           identity_take_live(manifest, options->setup.against, &options->setup,
                              compare->pipeline.info, compare->pipeline.live, log);
}

static bool compare_load(struct compare *compare)
{
    struct console *console = compare->console;
    const struct options *options = &compare->options;
    if ((options->setup.against && !open_dump(compare)) ||
        (options->golden && !golden_open(compare)))
        return false;
    if (options->bisect && !evidence_can_write(console, options->bisect))
        return false;
    if (!pipeline_load(&compare->pipeline, console, &options->setup) ||
        (options->contracts && !pipeline_contracts(&compare->pipeline, options->contracts,
                                                   &compare->contracts, &console->log)) ||
        !golden_suits(compare) || !rows_make(&compare->rows, compare->pipeline.info, &console->log))
        return false;
    if (!compares_something(compare, compare->rows.outputs.count, "no pass writes anything") ||
        !inputs_load(&compare->pipeline, console, &compare->options.setup) ||
        !session_load_scene(&compare->scene, console, compare->pipeline.info, &options->setup))
        return false;
    compare->options.setup.frames = session_frames(&options->setup, &compare->scene);
    return !options->setup.against || check_dump(compare);
}

static bool check_options(const struct options *options, const struct dt_log *log)
{
    const char *wrong = NULL;
    if (options->update && !options->golden)
        wrong = "--update: needs --golden DIR, the folder that it writes";
    else if (options->write_contracts && !options->repeats)
        wrong = "--write-contracts: needs --measure N";
    else if (options->repeats && options->setup.against)
        wrong = "--measure: --against is a single run; compare dumps of several runs: compare A B";
    if (wrong)
        report_error(log, "%s", wrong);
    return !wrong;
}

static bool list_labels(struct compare *compare)
{
    compare->labels = calloc(compare->sides.count, sizeof *compare->labels);
    if (!compare->labels)
        report_error(&compare->console->log, "out of memory");
    for (uint32_t i = 0; compare->labels && i < compare->sides.count; i++)
        compare->labels[i] = compare->sides.list[i].label;
    return compare->labels;
}

static bool run_comparison(struct compare *compare)
{
    struct console *console = compare->console;
    const struct options *options = &compare->options;
    if (!check_options(options, &console->log) ||
        !sides_read(&compare->sides, &options->setup, &console->log) || !list_labels(compare))
        return false;
    if (options->repeats && compare->sides.count * options->repeats > CONSOLE_CHILDREN)
        return report_error(&console->log,
                            "--measure: %u sides run %u times are more than %d processes",
                            compare->sides.count, options->repeats, CONSOLE_CHILDREN);
    if ((options->pictures && !file_make_folders(options->pictures, &console->log)) ||
        (options->html && !file_make_folders(options->html, &console->log)) ||
        (options->junit && !file_can_write(options->junit, &console->log)) ||
        (options->write_contracts && !file_can_write(options->write_contracts, &console->log)))
        return false;
    if (!compare_load(compare) || !allocate_pairs(compare))
        return false;
    compare->complete = run_all(compare) && atomic_load(&console->errors) == 0 &&
                        compares_something(compare, compare->compared, "all resources are empty");
    bool good = compare->complete && find_unwritten(compare) && find_blame(compare) &&
                judge_twins(compare) && keep_evidence(compare) && find_elsewhere(compare) &&
                atomic_load(&console->errors) == 0;
    if (compare->complete)
        conclude(compare);
    return good && (!options->golden || golden_end(compare)) &&
           ((!options->html && !options->junit) || compare_write_pages(compare)) &&
           (!options->write_contracts || measured_write(compare->sheets, compare->pair_count,
                                                        options->write_contracts, console));
}

static void print_undefined(const struct compare *compare)
{
    if (compare->undefined.count)
        printf("\n");
    undefined_print(&compare->undefined, compare->labels, compare->sides.count);
}

int verb_compare(struct console *console, const struct options *options)
{
    struct compare compare = {.console = console, .options = *options};
    if (options->dumps.count)
        return compare_dumps(console, options);
    bool differ = false;
    bool good = run_comparison(&compare);
    /* print partial results after an error, too */
    if (compare.complete && options->json)
        console->result = compare_json(&compare);
    console_status(console, "%s", "");
    if (compare.complete) {
        good &= compare_print(&compare);
        golden_print(&compare);
        print_undefined(&compare);
        differ = golden_differs(&compare) || compare.undefined.count ||
                 compare.elsewhere.repeats_differ || compare.elsewhere.barriers_missing ||
                 compare_far_twin(&compare);
    }
    for (uint32_t i = 0; compare.pairs && i < compare.pair_count; i++)
        differ |= !compare.pairs[i].sheet.agree;
    compare_release(&compare);
    return !good ? EXIT_USAGE : differ ? EXIT_DIFFER : EXIT_FINE;
}
