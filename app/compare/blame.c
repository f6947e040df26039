/* Runs a frame again, each pass of the second side on the first side's inputs; see blame.h.
 *
 * In the first run differences spread: a pass that differs spoils all that read it, and a table of
 * differences shows where they are, not where they begin. Here both sides run in lockstep, pass by
 * pass. Before each pass the second side gets the first side's inputs, bit by bit (hand_over), so
 * an output that then differs is this pass's own error (`own`). The guilty pass is the first in the
 * order of execution whose own error breaks its contract. There is no search: one more frame
 * answers for all passes.
 *
 * - The second side runs this frame alone: history is among the inputs that it gets.
 * - The first side may be a dump (--against); then it is read instead of run.
 * - The first side's outputs are hashed and compared with those of the first run. Where they
 *   differ, the side does not repeat, and nothing can be said about the other: BLAME_NOT_REPEATABLE
 *   comes before all other outcomes. Likewise where the first run broke a contract, and now neither
 *   an own error nor a different input is left.
 * - No own error beyond a contract, but inputs that differ: small errors of several passes add up
 *   (BLAME_INHERITED), or came with the history of an earlier frame (BLAME_EARLIER).
 * - Where `raster` allows edges to differ, what lies behind them is judged by own errors alone
 *   (BLAME_WITHIN).
 *
 * bisect.c runs the same replay once more, with another viewer, to keep the bytes of the guilty
 * pass. */
#include "compare/blame.h"

#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "picture/edges.h"

/* ---- The second run -------------------------------------------------------------------------- */

static bool advance(struct row_source sources[2], struct worker_place place)
{
    return source_resume(&sources[0]) && source_resume(&sources[1]) &&
           source_reach(&sources[0], place) && source_reach(&sources[1], place);
}

static bool hand_over(struct row_source sources[2], const struct row *row,
                      const struct replay_viewer *viewer)
{
    struct dt_bytes bytes;
    return source_ask(&sources[0], row) && source_take(&sources[0], row, &bytes) &&
           (!viewer->input || viewer->input(viewer->user, row, &bytes)) &&
           worker_write(&sources[1].worker, row->resource, row->mip, &bytes);
}

static bool take_both(struct row_source sources[2], const struct row *row,
                      struct dt_bytes copies[2])
{
    return source_ask(&sources[0], row) && source_ask(&sources[1], row) &&
           source_take(&sources[0], row, &copies[0]) && source_take(&sources[1], row, &copies[1]);
}

static bool show_output(const struct rows *rows, struct row_source sources[2], uint32_t index,
                        const struct replay_viewer *viewer)
{
    struct dt_bytes copies[2];
    return take_both(sources, &rows->outputs.list[index], copies) &&
           (!viewer->output || viewer->output(viewer->user, index, copies));
}

static bool show_edges(const struct rows *rows, struct row_source sources[2], uint32_t pass,
                       const struct replay_viewer *viewer)
{
    const struct dt_pipeline *pipeline = rows->pipeline;
    const struct dt_pass *draw = &pipeline->passes[pass];
    const struct row numbers = {.pass = pass, .resource = edges_resource(pipeline, draw)};
    const struct row depth = {.pass = pass, .resource = edges_depth(pipeline, draw)};
    struct dt_bytes copies[2];
    if (!viewer->edges || draw->kind != DT_PASS_DRAW_SCENE)
        return true;
    if (numbers.resource == UINT16_MAX)
        return viewer->edges(viewer->user, NULL, NULL);
    return take_both(sources, &numbers, copies) &&
           viewer->edges(viewer->user, &pipeline->resources[numbers.resource], copies) &&
           (!viewer->edges_depth || depth.resource == UINT16_MAX ||
            (take_both(sources, &depth, copies) && viewer->edges_depth(viewer->user, copies)));
}

static bool replay_pass(const struct replay *replay, struct row_source sources[2], uint32_t pass,
                        const struct replay_viewer *viewer)
{
    const struct rows *rows = replay->rows;
    const uint32_t *inputs = rows->inputs.first, *outputs = rows->outputs.first;
    console_status(replay->console, "frame %u again, pass %s on equal inputs", replay->frame + 1,
                   rows->pipeline->passes[pass].name);
    if (!advance(sources, (struct worker_place){WORKER_BEFORE_PASS, replay->frame, pass}))
        return false;
    bool skips = replay->alone && pass != replay->pass;
    sources[1].skips = skips;
    for (uint32_t i = inputs[pass]; i < inputs[pass + 1] && !skips; i++)
        if (!hand_over(sources, &rows->inputs.list[i], viewer))
            return false;
    if (!advance(sources, (struct worker_place){WORKER_AFTER_PASS, replay->frame, pass}))
        return false;
    if (skips)
        return true;
    if (!show_edges(rows, sources, pass, viewer))
        return false;
    for (uint32_t i = outputs[pass]; i < outputs[pass + 1]; i++)
        if (!show_output(rows, sources, i, viewer))
            return false;
    return true;
}

/* The second side runs no earlier frames: their results are among the inputs that it gets. */
static bool start_replay(const struct replay *replay, struct row_source sources[2])
{
    for (int i = 0; i < 2; i++) {
        struct worker_info info = replay->workers[i];
        info.frames = replay->frame + 1;
        info.first_observed = replay->frame;
        info.stops_before = replay->rows->pipeline->pass_count;
        info.quiet = !replay->alone;
        if (i == 1)
            info.session.first_frame = replay->frame;
        if (!source_start(&sources[i], &info, i == 0 ? replay->dump : NULL))
            return false;
    }
    const struct worker_place ready = {.stop = WORKER_READY, .frame = 0};
    return source_reach(&sources[0], ready) && source_reach(&sources[1], ready);
}

bool replay_run(const struct replay *replay, const struct replay_viewer *viewer)
{
    struct row_source sources[2] = {0};
    bool good = start_replay(replay, sources);
    for (uint32_t pass = 0; pass < replay->rows->pipeline->pass_count && good; pass++)
        good = replay_pass(replay, sources, pass, viewer);
    good = good && advance(sources, (struct worker_place){WORKER_FRAME_DONE, replay->frame, 0}) &&
           advance(sources, (struct worker_place){WORKER_FINISHED, replay->frame + 1, 0}) &&
           (!viewer->finished || viewer->finished(viewer->user, &sources[1]));
    source_close(&sources[0]);
    source_close(&sources[1]);
    return good;
}

/* ---- Fingerprints ---------------------------------------------------------------------------- */

bool fingerprint(const struct dt_resource *resource, struct dt_bytes *bytes, uint64_t *hash)
{
    if (!resource_clear_padding(resource, bytes))
        return false;
    *hash = FILE_HASH_START;
    hash_bytes(hash, bytes->data, bytes->size);
    return true;
}

/* ---- Judging --------------------------------------------------------------------------------- */

struct judge {
    struct blame *blame;
    const struct replay *replay;
    struct sheet *sheet;      /* of the first run */
    struct sheet_row *broken, /* its first */
        *strayed; /* the first row in which the first side's second run differs from its first */
    bool *edges;  /* of the scene draw at hand; NULL: none */
    uint32_t edges_extent[3];
};

static bool keep_edges(void *user, const struct dt_resource *resource,
                       const struct dt_bytes copies[2])
{
    struct judge *judge = user;
    free(judge->edges);
    judge->edges = NULL;
    if (resource)
        memcpy(judge->edges_extent, copies[0].extent, sizeof judge->edges_extent);
    bool good = !resource || edges_find(&judge->edges, resource, copies);
    return good || report_error(&judge->replay->console->log, "out of memory");
}

static bool add_coincident(void *user, const struct dt_bytes copies[2])
{
    struct judge *judge = user;
    bool same_size = true;
    for (int i = 0; i < 2; i++)
        same_size &= !memcmp(copies[i].extent, judge->edges_extent, sizeof copies[i].extent);
    if (judge->edges && same_size)
        edges_add_coincident(judge->edges, copies);
    return true;
}

/* The contract in force: between strangers a scene draw's images need not be exact. */
static struct dt_resource in_force(const struct judge *judge, const struct row *row)
{
    static const double default_share = 0.1;
    const struct dt_pipeline *pipeline = judge->replay->rows->pipeline;
    struct dt_resource resource = pipeline->resources[row->resource];
    if (judge->replay->strangers && resource.contract.kind == DT_CONTRACT_EXACT &&
        resource.kind == DT_IMAGE && pipeline->passes[row->pass].kind == DT_PASS_DRAW_SCENE)
        resource.contract =
            (struct dt_contract){.kind = DT_CONTRACT_RASTER, .tolerance = default_share};
    return resource;
}

static bool weigh(void *user, uint32_t index, const struct dt_bytes copies[2])
{
    struct judge *judge = user;
    const struct row *row = &judge->replay->rows->outputs.list[index];
    const struct dt_resource resource = in_force(judge, row);
    const bool *edges =
        resource.contract.kind == DT_CONTRACT_RASTER && !row->mip ? judge->edges : NULL;
    struct dt_bytes bytes = copies[0];
    uint64_t hash = 0;
    if (!difference_measure_draw(&judge->blame->own[index], &resource, judge->replay->frame, copies,
                                 edges) ||
        !fingerprint(&resource, &bytes, &hash))
        return report_error(&judge->replay->console->log, "out of memory");
    struct sheet_row *before = &judge->sheet->rows[judge->sheet->early + index];
    if (!judge->strayed && hash != before->hash)
        judge->strayed = before;
    return true;
}

/* Says of the outputs what the passes found in the first run, and their own errors. */
static void fill_outputs(const struct judge *judge)
{
    const struct rows *rows = judge->replay->rows;
    struct sheet_row *outputs = judge->sheet->rows + judge->sheet->early;
    for (uint32_t i = 0; i < rows->outputs.count; i++) {
        outputs[i].own = &judge->blame->own[i];
        outputs[i].inputs = "equal";
    }
    for (uint32_t i = 0; i < rows->inputs.count; i++) {
        const struct row *input = &rows->inputs.list[i];
        const uint32_t *first = &rows->outputs.first[input->pass];
        uint32_t index;
        bool written = rows_origin(rows, input, &index);
        bool differs = written ? outputs[index].differs
                               : index < judge->sheet->early && judge->sheet->rows[index].differs;
        for (uint32_t k = first[0]; differs && k < first[1]; k++)
            outputs[k].inputs = "differ";
    }
}

static bool has_contract(const struct replay *replay, enum dt_contract_kind kind)
{
    const struct dt_pipeline *pipeline = replay->rows->pipeline;
    bool found = false;
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        found |= pipeline->resources[i].contract.kind == kind;
    return found;
}

/* Whether differences at edges are allowed anywhere. */
static bool has_raster(const struct replay *replay)
{
    return replay->strangers || has_contract(replay, DT_CONTRACT_RASTER);
}

/* Whether passes behind others that may differ are judged on equal inputs alone. */
static bool lets_inherit(const struct replay *replay)
{
    return has_raster(replay) || has_contract(replay, DT_CONTRACT_OF_EXACT);
}

static void judge_all(const struct judge *judge)
{
    struct blame *blame = judge->blame;
    const struct replay *replay = judge->replay;
    struct sheet_row *outputs = judge->sheet->rows + judge->sheet->early, *broken = judge->broken;
    bool early = sheet_is_early(judge->sheet, broken);
    fill_outputs(judge);
    blame->row = broken;
    if (judge->strayed) {
        blame->outcome = BLAME_NOT_REPEATABLE;
        blame->side = replay->workers[0].session.side;
        blame->row = judge->strayed;
        return;
    }
    for (uint32_t i = 0; i < replay->rows->outputs.count; i++) {
        if (difference_verdict(&blame->own[i]) == VERDICT_DIFFERS) {
            blame->outcome = BLAME_GUILTY;
            blame->row = &outputs[i];
            return;
        }
    }
    bool repeats = early || broken->own->differing || broken->own->other_depths ||
                   strcmp(broken->inputs, "equal") != 0;
    blame->outcome = early ? BLAME_EARLIER : lets_inherit(replay) ? BLAME_WITHIN : BLAME_INHERITED;
    if (!repeats) {
        blame->outcome = BLAME_NOT_REPEATABLE;
        blame->side = replay->workers[1].session.side;
    }
}

bool blame_find(struct blame *blame, const struct replay *replay, struct sheet *sheet,
                struct sheet_row *broken)
{
    struct judge judge = {.blame = blame, .replay = replay, .sheet = sheet, .broken = broken};
    const struct replay_viewer viewer = {.edges = has_raster(replay) ? keep_edges : NULL,
                                         .edges_depth = add_coincident,
                                         .output = weigh,
                                         .user = &judge};
    *blame = (struct blame){.frame = replay->frame};
    blame->own = calloc(replay->rows->outputs.count, sizeof *blame->own);
    if (!blame->own)
        report_error(&replay->console->log, "out of memory");
    bool good = blame->own && replay_run(replay, &viewer);
    free(judge.edges);
    if (good)
        judge_all(&judge);
    return good;
}

void blame_free(struct blame *blame)
{
    free(blame->own);
    *blame = (struct blame){0};
}
