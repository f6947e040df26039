/* Where the parts of the pass graph stand: passes in a column, in order of execution, beside each a
 * table of what it is the first to change, and between the columns a channel of tracks, in which a
 * line runs from rows of a table along the passes that read them. Called by emit_graph.c. */
#include "graph.h"

#include <string.h>

#include "plan.h"

enum { GAP = 8, TRACK = 6, MARGIN = 12, LINE = 4 };

/* ---- Links ----------------------------------------------------------------------------------- */

bool graph_waits(const struct barrier *barrier)
{
    return barrier->from_stages != 0;
}

static void find_uses(const struct pass *pass, const struct resource *resource, struct link *link)
{
    link->reads = resource == pass->indirect_resource || resource == pass->index_resource;
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (access->resource == resource) {
            link->reads |= access->mode != MODE_WRITE;
            link->changes |= access->mode != MODE_READ;
        }
    }
}

bool graph_has_line(const struct pass *pass, const struct barrier *barrier)
{
    struct link link = {0};

    find_uses(pass, barrier->resource, &link);
    return !barrier->alias && link.reads && !link.changes;
}

static bool share_bar(const struct pass *pass, const struct barrier *a, const struct barrier *b)
{
    return a == b || (graph_waits(a) && graph_has_line(pass, a) && graph_has_line(pass, b) &&
                      a->from == b->from && a->from_stages == b->from_stages && a->to == b->to &&
                      a->to_stages == b->to_stages && a->from_writes == b->from_writes);
}

int graph_bar(const struct pass *pass, uint32_t barrier)
{
    uint32_t first = 0;

    while (!share_bar(pass, &pass->barriers[first], &pass->barriers[barrier])) {
        first++;
    }
    return (int)first;
}

bool graph_link(const struct pass *pass, const struct resource *resource, struct link *link)
{
    *link = (struct link){.bar = LINE_UNWAITED};
    find_uses(pass, resource, link);
    link->bar = link->changes ? LINE_WRITE : LINE_UNWAITED;
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        const struct barrier *barrier = &pass->barriers[i];

        if (barrier->resource == resource && graph_waits(barrier) &&
            graph_has_line(pass, barrier)) {
            link->bar = graph_bar(pass, i);
        }
    }
    return link->reads || link->changes;
}

int graph_first_change(const struct pipeline *pipeline, const struct resource *resource)
{
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        struct link link;

        if (graph_link(pipeline->order[place], resource, &link) && link.changes) {
            return (int)place;
        }
    }
    return -1;
}

static bool same_links(const struct pipeline *pipeline, const struct resource *a,
                       const struct resource *b)
{
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        struct link x, y;

        graph_link(pipeline->order[place], a, &x);
        graph_link(pipeline->order[place], b, &y);
        if (x.reads != y.reads || x.changes != y.changes || x.bar != y.bar) {
            return false;
        }
    }
    return true;
}

static const struct resource *first_of_block(const struct pipeline *pipeline,
                                             const struct resource *resource)
{
    for (const struct resource *other = pipeline->resources; other < resource; other++) {
        if (same_links(pipeline, other, resource)) {
            return other;
        }
    }
    return resource;
}

static void find_blocks(struct graph *graph)
{
    const struct pipeline *pipeline = graph->pipeline;

    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];
        const struct resource *first = first_of_block(pipeline, resource);
        int table = graph_first_change(pipeline, resource);

        graph->first_of[i] = first;
        for (uint32_t b = 0; b < graph->block_count; b++) {
            graph->blocks[b].rows += graph->blocks[b].first == first;
        }
        if (first == resource && table >= 0) {
            graph->blocks[graph->block_count++] =
                (struct block){.first = resource, .rows = 1, .table = table};
        }
        if (table >= 0) {
            graph->places[table].rows++;
        }
    }
}

/* ---- Down the page --------------------------------------------------------------------------- */

/* Lines of the first `blocks` blocks that meet the pass at the bar. */
static int count_lines(const struct graph *graph, uint32_t place, int bar, uint32_t blocks)
{
    int count = 0;

    for (uint32_t b = 0; b < blocks; b++) {
        const struct block *block = &graph->blocks[b];
        struct link link;

        if (graph_link(graph->pipeline->order[place], block->first, &link) && link.bar == bar &&
            (int)place != block->table) {
            count++;
        }
    }
    return count;
}

int graph_bar_height(const struct graph *graph, uint32_t place, int bar)
{
    int lines = count_lines(graph, place, bar, graph->block_count);
    int least = bar == LINE_UNWAITED ? GRAPH_TITLE : bar == LINE_WRITE ? GRAPH_DETAIL : GRAPH_BAR;

    return (lines + 1) * LINE > least ? (lines + 1) * LINE : least;
}

int graph_line_y(const struct graph *graph, uint32_t place, int bar, uint32_t block)
{
    const struct pass *pass = graph->pipeline->order[place];
    const struct place *at = &graph->places[place];
    int top = bar == LINE_WRITE ? at->detail : bar == LINE_UNWAITED ? at->title : at->top;
    int lines = count_lines(graph, place, bar, graph->block_count);
    int before = count_lines(graph, place, bar, block);

    for (int i = 0; i < bar; i++) {
        if (graph_waits(&pass->barriers[i]) && !pass->barriers[i].alias &&
            graph_bar(pass, (uint32_t)i) == i) {
            top += graph_bar_height(graph, place, i);
        }
    }
    return top + graph_bar_height(graph, place, bar) * (before + 1) / (lines + 1);
}

static int bars_height(const struct graph *graph, uint32_t place)
{
    const struct pass *pass = graph->pipeline->order[place];
    int height = 0;

    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        if (graph_waits(&pass->barriers[i]) && !pass->barriers[i].alias &&
            graph_bar(pass, i) == (int)i) {
            height += graph_bar_height(graph, place, (int)i);
        }
    }
    return height;
}

static void count_dropped(struct graph *graph)
{
    const struct pipeline *pipeline = graph->pipeline;

    for (uint32_t i = 0; i < pipeline->dropped_count; i++) {
        uint32_t place = 0;

        while (place < pipeline->pass_count &&
               pipeline->order[place]->loc.line < pipeline->dropped[i]->loc.line) {
            place++;
        }
        graph->places[place].dropped++;
    }
}

static void place_pass(struct graph *graph, uint32_t place, int top)
{
    struct place *at = &graph->places[place];

    at->top = top;
    at->title = top + bars_height(graph, place);
    at->detail = at->title + graph_bar_height(graph, place, LINE_UNWAITED);
    at->bottom = at->detail + graph_bar_height(graph, place, LINE_WRITE);
    at->arrow = at->detail + GRAPH_DETAIL / 2;
}

/* As high as it goes below y: the arrow from the pass then ends in one of its later rows. */
static void place_table(struct place *at, int y)
{
    int rows = (at->arrow - GRAPH_WRITE - (y > at->top ? y : at->top)) / GRAPH_ROW;

    rows = rows >= at->rows ? at->rows - 1 : rows;
    at->table = at->arrow - GRAPH_WRITE - rows * GRAPH_ROW;
}

static void place_down(struct graph *graph)
{
    uint32_t count = graph->pipeline->pass_count;
    int y = 0, tables = 0;

    for (uint32_t place = 0; place <= count; place++) {
        struct place *at = &graph->places[place];

        at->dropped_top = y;
        y += at->dropped ? (int)at->dropped * GRAPH_DROPPED + GAP : 0;
        if (place == count) {
            break;
        }
        place_pass(graph, place, y);
        if (at->rows && at->arrow - GRAPH_WRITE < tables) {
            place_pass(graph, place, y + tables - at->arrow + GRAPH_WRITE);
        }
        y = at->bottom + GAP;
        if (at->rows) {
            place_table(at, tables);
            tables = at->table + at->rows * GRAPH_ROW + GAP;
        }
    }
}

/* ---- Tracks ---------------------------------------------------------------------------------- */

static void place_blocks(struct graph *graph)
{
    for (uint32_t b = 0; b < graph->block_count; b++) {
        struct block *block = &graph->blocks[b];

        block->top = graph->places[block->table].table;
        for (uint32_t other = 0; other < b; other++) {
            if (graph->blocks[other].table == block->table) {
                block->top += (int)graph->blocks[other].rows * GRAPH_ROW;
            }
        }
        block->y = block->top + (int)block->rows * GRAPH_ROW / 2 + (block->rows == 1 ? 3 : 0);
        block->upper = block->lower = block->y;
        block->track = -1;
        for (uint32_t place = 0; place < graph->pipeline->pass_count; place++) {
            struct link link;

            if ((int)place == block->table ||
                !graph_link(graph->pipeline->order[place], block->first, &link)) {
                continue;
            }
            int y = graph_line_y(graph, place, link.bar, b);

            block->upper = y < block->upper ? y : block->upper;
            block->lower = y > block->lower ? y : block->lower;
        }
    }
}

static bool is_free(const struct graph *graph, int track, const struct block *block)
{
    for (uint32_t b = 0; b < graph->block_count; b++) {
        const struct block *other = &graph->blocks[b];

        if (other->track == track && other->upper <= block->lower + 1 &&
            block->upper <= other->lower + 1) {
            return false;
        }
    }
    return true;
}

/* Short lines stand next to the passes: the long ones then have to cross nothing but them. */
static void choose_tracks(struct graph *graph)
{
    for (;;) {
        struct block *shortest = NULL;

        for (uint32_t b = 0; b < graph->block_count; b++) {
            struct block *block = &graph->blocks[b];

            if (block->track < 0 && block->lower > block->upper &&
                (!shortest || block->lower - block->upper < shortest->lower - shortest->upper)) {
                shortest = block;
            }
        }
        if (!shortest) {
            return;
        }
        int track = 0;

        while (!is_free(graph, track, shortest)) {
            track++;
        }
        shortest->track = track;
        graph->track_count = track >= graph->track_count ? track + 1 : graph->track_count;
    }
}

int graph_track_x(const struct graph *graph, int track)
{
    return graph->pass_width + MARGIN + track * TRACK;
}

bool graph_layout(const struct model *model, struct graph *graph)
{
    const struct pipeline *pipeline = &model->pipeline;

    graph->pipeline = pipeline;
    graph->places = arena_alloc(model->arena, (pipeline->pass_count + 1) * sizeof *graph->places);
    graph->blocks = arena_alloc(model->arena, pipeline->resource_count * sizeof *graph->blocks + 1);
    graph->first_of =
        arena_alloc(model->arena, pipeline->resource_count * sizeof *graph->first_of + 1);
    if (!graph->places || !graph->blocks || !graph->first_of) {
        return false;
    }
    find_blocks(graph);
    count_dropped(graph);
    place_down(graph);
    place_blocks(graph);
    choose_tracks(graph);
    graph->table_left = graph_track_x(graph, graph->track_count) + MARGIN;
    return true;
}
