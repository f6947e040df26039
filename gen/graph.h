/* The pass graph as it is drawn: who is linked to whom, and where everything stands. Laid out by
 * graph_layout.c, written by emit_graph.c; points of 1/72 inch, y downwards. */
#ifndef DIPTYCH_GEN_GRAPH_H
#define DIPTYCH_GEN_GRAPH_H

#include "model.h"

/* How one pass uses one resource. */
struct link {
    bool reads, changes;
    int bar; /* at which of the pass's barriers it waits (bar_of), or LINE_ */
};
enum { LINE_UNWAITED = -1, LINE_WRITE = -2 };

/* Resources of one table that all passes use alike: they share one line of the drawing. */
struct block {
    const struct resource *first;
    uint32_t rows;
    int table;        /* place in the order of the first pass that changes them */
    int top, y;       /* of its rows, of its line where it leaves the table */
    int track;        /* of the channel between passes and tables, from the passes' side */
    int upper, lower; /* between which y its line runs along the track */
};

/* A pass with the table of what it is the first to change. */
struct place {
    int top, title, detail, bottom; /* tops of its box and of that box's rows; its end */
    int arrow;                      /* y of the one to the table */
    int table, rows;                /* top of the table; 0 rows: none */
    uint32_t dropped;               /* passes left out that stand above it in the spec */
    int dropped_top;
};

struct graph {
    const struct pipeline *pipeline;
    struct place *places; /* one more than passes: what is dropped behind the last */
    struct block *blocks;
    uint32_t block_count;
    const struct resource **first_of; /* by resource: the first of its block */
    int track_count;
    int pass_width, table_left, table_width;
};

enum {
    GRAPH_BAR = 11,
    GRAPH_TITLE = 14,
    GRAPH_DETAIL = 11,
    GRAPH_ROW = 12,
    GRAPH_DROPPED = 11,
    GRAPH_WRITE = 3 /* from the top of a row: where the arrow of a write ends */
};

/* False when out of memory. */
bool graph_layout(const struct model *model, struct graph *graph);

/* Whether the barrier waits at all: the first touch of an image in a frame changes its layout alone.
 */
bool graph_waits(const struct barrier *barrier);
/* Barriers that wait for the same are one bar of the pass, called by the first of them. */
int graph_bar(const struct pass *pass, uint32_t barrier);
/* Whether a line of the drawing ends in the barrier; else the bar has to name its resource. */
bool graph_has_line(const struct pass *pass, const struct barrier *barrier);
bool graph_link(const struct pass *pass, const struct resource *resource, struct link *link);
int graph_first_change(const struct pipeline *pipeline, const struct resource *resource);

/* Where a block's line meets a pass, and the height of a bar or of the title (LINE_UNWAITED). */
int graph_line_y(const struct graph *graph, uint32_t place, int bar, uint32_t block);
int graph_bar_height(const struct graph *graph, uint32_t place, int bar);
int graph_track_x(const struct graph *graph, int track);

#endif
