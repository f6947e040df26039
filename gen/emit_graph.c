/* NAME.dot: the pass graph for Graphviz. Passes stand in a column in order of execution, beside each
 * a table of what it is the first to write; a line goes from rows of a table to the passes that read
 * them and ends in the barrier that a pass has to wait at, a dark bar over its name. The drawing says
 * where everything stands (graph_layout.c): left to itself, Graphviz lets lines cross boxes. Called by
 * main. */
#include <inttypes.h>
#include <string.h>

#include "dot.h"
#include "emit_c.h"
#include "graph.h"

struct drawing {
    struct graph graph;
    const struct pipeline *pipeline;
    const unsigned *gl_bits; /* by place in the order */
    int columns[3];          /* widths of a table's */
    uint32_t points;         /* written so far */
    struct text *out;
};

/* Black at the passes, grey text for what is left out. */
#define BAR_FILL     "#484848"
#define UNUSED_COLOR "#909090"

/* ---- Plain texts ----------------------------------------------------------------------------- */

static uint32_t at_reference(const struct expr *expr, uint32_t otherwise)
{
    return expr_value(expr, REFERENCE_WIDTH, REFERENCE_HEIGHT, otherwise);
}

/* 240×135: without the ones behind. */
static void product_text(struct text *out, const uint32_t size[3])
{
    text_add(out, "%" PRIu32, size[0]);
    if (size[1] > 1 || size[2] > 1) {
        text_add(out, "×%" PRIu32, size[1]);
    }
    if (size[2] > 1) {
        text_add(out, "×%" PRIu32, size[2]);
    }
}

static void workgroups(const struct pass *pass, uint32_t groups[3])
{
    const struct resource *image = pass->size == SIZE_IMAGE ? pass->size_resource : NULL;
    const struct interleave *tiles = pass->size == SIZE_INTERLEAVE ? pass->interleave : NULL;
    const uint32_t frame[2] = {REFERENCE_WIDTH, REFERENCE_HEIGHT};

    for (int axis = 0; axis < 3; axis++) {
        uint32_t local = pass->size == SIZE_GROUPS ? 1 : pass->local[axis];
        uint32_t size = at_reference(pass->dispatch[axis], 1);

        if (image) {
            const struct expr *const sides[] = {image->width, image->height, image->layers};

            size = at_reference(sides[axis], axis < 2 ? frame[axis] : 1);
        } else if (tiles && axis < 2) {
            size = frame[axis];
            local *= tiles->tile[axis];
        } else if (tiles) {
            size = tiles->tile[0] * tiles->tile[1];
            local = 1;
        }
        groups[axis] = size / local + (size % local != 0);
    }
}

static void dispatch_text(struct text *out, const struct pass *pass)
{
    if (pass->size == SIZE_INDIRECT) {
        text_add(out, "dispatch by arguments, workgroups of ");
    } else {
        uint32_t groups[3];

        workgroups(pass, groups);
        text_add(out, "dispatch ");
        product_text(out, groups);
        text_add(out, groups[0] == 1 && groups[1] == 1 && groups[2] == 1 ? " workgroup of "
                                                                         : " workgroups of ");
    }
    product_text(out, pass->local);
}

static void draw_text(struct text *out, const struct pass *pass)
{
    bool view = pass->view && !pass->layers;

    text_add(out, pass->kind == PASS_SCENE ? "draw of the scene%s%s" : "draw, fullscreen%s%s",
             pass->kind == PASS_SCENE && view ? " from the " : "",
             pass->kind == PASS_SCENE && view ? pass->view : "");
    if (pass->layers) {
        text_add(out, ", %" PRIu32 " instances", at_reference(pass->layers, 1));
    }
    text_add(out, "%s", pass->indirect_resource ? " by arguments" : "");
}

static void detail_text(struct text *out, const struct pass *pass)
{
    static const char *const builtins[BUILTIN_COUNT] = {
        [BUILTIN_VERTICES] = "scene_vertices",
        [BUILTIN_INDICES] = "scene_indices",
        [BUILTIN_MATERIALS] = "scene_materials",
        [BUILTIN_TEXTURES] = "scene_textures",
    };

    if (pass->kind == PASS_DISPATCH) {
        dispatch_text(out, pass);
    } else {
        draw_text(out, pass);
    }
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (!pass->accesses[i].resource && pass->kind == PASS_DISPATCH) {
            text_add(out, ", reads %s", builtins[pass->accesses[i].builtin]);
        }
    }
    if (pass->conditional) {
        text_add(out, at_reference(pass->when, 1) ? ", when %s" : "; SKIPPED by default: when %s",
                 pass->when_text);
    }
}

static void bar_text(struct text *out, const struct pass *pass, const struct barrier *barrier)
{
    if (!graph_has_line(pass, barrier)) {
        text_add(out, "%s: ", barrier->resource->name);
    }
    dot_accesses(out, barrier->from, barrier->from_stages);
    text_add(out, " → ");
    dot_accesses(out, barrier->to, barrier->to_stages);
    text_add(out, "%s", barrier->from_writes ? "" : " (execution only)");
}

static void gl_text(struct text *out, unsigned bits)
{
    static const struct dot_word words[] = {{GLB_ELEMENT_ARRAY, "element array"},
                                            {GLB_UNIFORM, "uniform"},
                                            {GLB_TEXTURE_FETCH, "texture fetch"},
                                            {GLB_SHADER_IMAGE_ACCESS, "image access"},
                                            {GLB_COMMAND, "command"},
                                            {GLB_TEXTURE_UPDATE, "texture update"},
                                            {GLB_BUFFER_UPDATE, "buffer update"},
                                            {GLB_FRAMEBUFFER, "framebuffer"},
                                            {GLB_SHADER_STORAGE, "shader storage"}};

    text_add(out, "%s", bits ? "GL: " : "");
    dot_words(out, words, sizeof words / sizeof *words, bits, ", ");
}

static void note_text(struct text *out, const struct pipeline *pipeline,
                      const struct resource *resource)
{
    const char *linear = pipeline->linear_output, *display = pipeline->display_output;

    text_add(out, "%s", resource->history ? " history" : "");
    text_add(out, "%s", linear && !strcmp(resource->name, linear) ? " linear output" : "");
    text_add(out, "%s", display && !strcmp(resource->name, display) ? " display output" : "");
}

/* ---- Widths ---------------------------------------------------------------------------------- */

/* Widens to what the texts of up to two cells need, the second in a smaller font; empties them. */
static void widen(struct drawing *d, int *width, struct text *text, int size, struct text *beside)
{
    int needed = (text->data ? dot_width(text->data, size) : 0) +
                 (beside && beside->data ? dot_width(beside->data, 7) : 0);

    *width = needed > *width ? needed : *width;
    d->out->failed |= text->failed || (beside && beside->failed);
    text_free(text);
    if (beside) {
        text_free(beside);
    }
}

static void measure_pass(struct drawing *d, uint32_t place)
{
    const struct pass *pass = d->pipeline->order[place];
    struct text text = {0}, beside = {0};

    text_add(&text, "%" PRIu32 "  %s", place + 1, pass->name);
    gl_text(&beside, d->gl_bits[place]);
    widen(d, &d->graph.pass_width, &text, 10, &beside);
    detail_text(&text, pass);
    widen(d, &d->graph.pass_width, &text, 7, NULL);
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        if (graph_waits(&pass->barriers[i]) && !pass->barriers[i].alias) {
            bar_text(&text, pass, &pass->barriers[i]);
            widen(d, &d->graph.pass_width, &text, 7, NULL);
        }
    }
}

static void measure(struct drawing *d)
{
    const struct pipeline *pipeline = d->pipeline;

    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        measure_pass(d, place);
    }
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];
        struct text text = {0}, note = {0};

        text_add(&text, "  %s", resource->name);
        note_text(&note, pipeline, resource);
        widen(d, &d->columns[0], &text, 8, &note);
        text_add(&text, "  ");
        dot_extent(&text, resource);
        widen(d, &d->columns[1], &text, 7, NULL);
        dot_bytes(&text, resource->bytes);
        widen(d, &d->columns[2], &text, 7, NULL);
    }
}

/* ---- Boxes ----------------------------------------------------------------------------------- */

/* A node whose box has its left upper corner at (x, y); text_add goes on with the rows. */
static void begin_box(const struct drawing *d, const char *group, const char *name, int x, int y,
                      int width, int height)
{
    text_add(d->out,
             "  \"%s%s\" [pos=\"%d.%d,%d.%d!\", label=<<table border=\"0\" cellborder=\"1\" "
             "cellspacing=\"0\" cellpadding=\"0\">",
             group, name, x + width / 2, width % 2 * 5, -(y + height / 2 + height % 2),
             height % 2 * 5);
}

static void end_box(const struct drawing *d)
{
    text_add(d->out, "</table>>];\n");
}

static void emit_text(const struct drawing *d, struct text *text)
{
    d->out->failed |= text->failed;
    dot_text(d->out, text->data ? text->data : "");
    text_free(text);
}

static void emit_bar(const struct drawing *d, uint32_t place, int bar)
{
    const struct pass *pass = d->pipeline->order[place];
    struct text text = {0};

    text_add(d->out,
             "<tr><td colspan=\"2\" align=\"left\" bgcolor=\"" BAR_FILL
             "\" height=\"%d\"><font color=\"white\" point-size=\"7\">&nbsp;",
             graph_bar_height(&d->graph, place, bar));
    bar_text(&text, pass, &pass->barriers[bar]);
    emit_text(d, &text);
    text_add(d->out, "</font></td></tr>");
}

static void emit_pass(const struct drawing *d, uint32_t place)
{
    const struct pass *pass = d->pipeline->order[place];
    const struct place *at = &d->graph.places[place];
    const char *style = pass->conditional ? " style=\"dashed\"" : "";
    struct text text = {0};

    begin_box(d, "p_", pass->name, 0, at->top, d->graph.pass_width, at->bottom - at->top);
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        const struct barrier *barrier = &pass->barriers[i];

        if (graph_waits(barrier) && !barrier->alias && graph_bar(pass, i) == (int)i) {
            emit_bar(d, place, (int)i);
        }
    }
    text_add(d->out,
             "<tr><td align=\"left\" sides=\"LT\"%s height=\"%d\"><font "
             "point-size=\"9\">&nbsp;<b>%" PRIu32 "&nbsp;&nbsp;%s</b></font></td>",
             style, at->detail - at->title, place + 1, pass->name);
    gl_text(&text, d->gl_bits[place]);
    text_add(d->out, "<td align=\"right\" sides=\"TR\"%s><font point-size=\"7\">", style);
    emit_text(d, &text);
    text_add(d->out,
             "&nbsp;</font></td></tr><tr><td colspan=\"2\" align=\"left\" sides=\"LBR\"%s "
             "height=\"%d\" width=\"%d\"><font point-size=\"7\">&nbsp;",
             style, at->bottom - at->detail, d->graph.pass_width);
    detail_text(&text, pass);
    emit_text(d, &text);
    text_add(d->out, "</font></td></tr>");
    end_box(d);
}

/* What a baked `when` leaves out, at its place in the spec. */
static void emit_dropped(const struct drawing *d)
{
    const struct pipeline *pipeline = d->pipeline;
    uint32_t next = 0;

    for (uint32_t place = 0; place <= pipeline->pass_count; place++) {
        const struct place *at = &d->graph.places[place];

        if (!at->dropped) {
            continue;
        }
        begin_box(d, "d_", pipeline->dropped[next]->name, 0, at->dropped_top, d->graph.pass_width,
                  (int)at->dropped * GRAPH_DROPPED);
        for (uint32_t i = 0; i < at->dropped; i++, next++) {
            const struct pass *pass = pipeline->dropped[next];

            text_add(
                d->out,
                "<tr><td align=\"left\" sides=\"%s%sLR\" style=\"dashed\" color=\"" UNUSED_COLOR
                "\" height=\"%d\" width=\"%d\"><font color=\"#505050\" point-size=\"7\">"
                "&nbsp;<b>%s</b>&nbsp; left out: when ",
                i ? "" : "T", i + 1 < at->dropped ? "" : "B", GRAPH_DROPPED, d->graph.pass_width,
                pass->name);
            dot_text(d->out, pass->when_text ? pass->when_text : "");
            text_add(d->out, "</font></td></tr>");
        }
        end_box(d);
    }
}

/* ---- Tables ---------------------------------------------------------------------------------- */

static void emit_cell(const struct drawing *d, const struct resource *resource, int column)
{
    text_add(d->out, "<td align=\"%s\" bgcolor=\"%s\" width=\"%d\" height=\"%d\">",
             column == 2 ? "right" : "left",
             resource->kind == DT_IMAGE ? DOT_IMAGE_FILL : DOT_BUFFER_FILL, d->columns[column],
             GRAPH_ROW);
}

static void emit_resource(const struct drawing *d, const struct resource *resource)
{
    struct text text = {0};

    emit_cell(d, resource, 0);
    text_add(d->out, "&nbsp;%s", resource->name);
    note_text(&text, d->pipeline, resource);
    if (text.data && text.length) {
        text_add(d->out, "<font point-size=\"7\"><i>%s</i></font>", text.data);
    }
    text_free(&text);
    text_add(d->out, "</td>");
    emit_cell(d, resource, 1);
    text_add(d->out, "<font point-size=\"7\">&nbsp;");
    dot_extent(&text, resource);
    emit_text(d, &text);
    text_add(d->out, "</font></td>");
    emit_cell(d, resource, 2);
    text_add(d->out, "<font point-size=\"7\">");
    dot_bytes(d->out, resource->bytes);
    text_add(d->out, "&nbsp;</font></td></tr>");
}

/* A block of rows with a narrow cell on the side of the passes, where its line begins. */
static void emit_block(const struct drawing *d, const struct block *block)
{
    const struct pipeline *pipeline = d->pipeline;

    text_add(d->out,
             "<tr><td rowspan=\"%" PRIu32 "\" width=\"5\" bgcolor=\"" UNUSED_COLOR "\"></td>",
             block->rows);
    for (uint32_t i = 0, row = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];

        if (d->graph.first_of[i] == block->first) {
            text_add(d->out, row++ ? "<tr>" : "");
            emit_resource(d, resource);
        }
    }
}

static void emit_table(const struct drawing *d, uint32_t place)
{
    const struct place *at = &d->graph.places[place];

    if (!at->rows) {
        return;
    }
    begin_box(d, "w_", d->pipeline->order[place]->name, d->graph.table_left, at->table,
              d->graph.table_width, at->rows * GRAPH_ROW);
    for (uint32_t b = 0; b < d->graph.block_count; b++) {
        if (d->graph.blocks[b].table == (int)place) {
            emit_block(d, &d->graph.blocks[b]);
        }
    }
    end_box(d);
}

/* ---- Lines ----------------------------------------------------------------------------------- */

/* A corner or an end of a line, to be seen where lines branch; returns its number. */
static uint32_t point(struct drawing *d, int x, int y, bool seen)
{
    text_add(d->out, "  %" PRIu32 " [pos=\"%d,%d!\", shape=point, width=%s];\n", d->points, x, -y,
             seen ? "0.035" : "0.005");
    return d->points++;
}

static void line(const struct drawing *d, uint32_t from, uint32_t to, const char *attributes)
{
    text_add(d->out, "  %" PRIu32 " -> %" PRIu32 " [%s];\n", from, to, attributes);
}

static bool is_level(const struct drawing *d, uint32_t place, const struct block *block)
{
    int into = d->graph.places[place].arrow - block->top;

    return into >= 0 && into < (int)block->rows * GRAPH_ROW;
}

/* The block of a pass's table that the arrow for all that it writes, and does not read, ends in. */
static const struct block *written_block(const struct drawing *d, uint32_t place)
{
    const struct block *written = NULL;

    for (uint32_t b = 0; b < d->graph.block_count; b++) {
        const struct block *block = &d->graph.blocks[b];
        struct link link;

        if (block->table == (int)place &&
            graph_link(d->pipeline->order[place], block->first, &link) && !link.reads &&
            (!written || is_level(d, place, block))) {
            written = block;
        }
    }
    return written;
}

/* From a pass to its table: one for what it writes, one for each block that it updates. */
static void emit_writes(struct drawing *d, uint32_t place)
{
    const struct block *written = written_block(d, place);
    int arrow = d->graph.places[place].arrow;

    for (uint32_t b = 0; b < d->graph.block_count; b++) {
        const struct block *block = &d->graph.blocks[b];
        struct link link;

        if (block->table != (int)place ||
            !graph_link(d->pipeline->order[place], block->first, &link) ||
            (!link.reads && block != written)) {
            continue;
        }
        int y = is_level(d, place, block) ? arrow : block->top + GRAPH_WRITE;
        uint32_t from = point(d, d->graph.pass_width, arrow, false);
        uint32_t to = point(d, d->graph.table_left, y, false);

        line(d, from, to, link.reads ? "dir=both, penwidth=1.4" : "penwidth=1.4");
    }
}

/* From the track to a pass, and along the track up to there from `*last`. */
static void emit_branch(struct drawing *d, uint32_t b, uint32_t place, const struct link *link,
                        uint32_t *last)
{
    const struct block *block = &d->graph.blocks[b];
    int x = graph_track_x(&d->graph, block->track),
        y = graph_line_y(&d->graph, place, link->bar, b);
    bool early = (int)place < block->table;
    uint32_t branch = point(d, x, y, y != block->upper && y != block->lower);
    uint32_t end = point(d, d->graph.pass_width, y, false);

    line(d, *last, branch, early ? "arrowhead=none, style=dashed" : "arrowhead=none");
    if (!link->changes) {
        line(d, branch, end, early ? "style=dashed" : "");
    } else {
        line(d, end, branch, link->reads ? "dir=both, penwidth=1.4" : "penwidth=1.4");
    }
    *last = branch;
}

static void emit_block_lines(struct drawing *d, uint32_t b)
{
    const struct pipeline *pipeline = d->pipeline;
    const struct block *block = &d->graph.blocks[b];
    struct link link;

    if (block->track < 0) {
        return;
    }
    text_add(d->out, "  //");
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        if (d->graph.first_of[i] == block->first) {
            text_add(d->out, " %s", pipeline->resources[i].name);
        }
    }
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        if ((int)place != block->table && graph_link(pipeline->order[place], block->first, &link)) {
            text_add(d->out, " %s %s", link.changes ? "<-" : "->", pipeline->order[place]->name);
        }
    }
    text_add(d->out, "\n");
    uint32_t start = point(d, d->graph.table_left, block->y, false);
    uint32_t corner = point(d, graph_track_x(&d->graph, block->track), block->y,
                            block->upper < block->y && block->y < block->lower);
    uint32_t last = corner;

    line(d, start, corner, "arrowhead=none");
    for (int place = block->table - 1; place >= 0; place--) {
        if (graph_link(pipeline->order[place], block->first, &link)) {
            emit_branch(d, b, (uint32_t)place, &link, &last);
        }
    }
    last = corner;
    for (uint32_t place = (uint32_t)block->table + 1; place < pipeline->pass_count; place++) {
        if (graph_link(pipeline->order[place], block->first, &link)) {
            emit_branch(d, b, place, &link, &last);
        }
    }
}

/* ---- The whole ------------------------------------------------------------------------------- */

static void emit_caption(const struct drawing *d)
{
    const struct pipeline *pipeline = d->pipeline;

    text_add(d->out,
             "  label=<<table border=\"0\" cellspacing=\"0\" cellpadding=\"1\"><tr><td "
             "align=\"left\"><font point-size=\"9\"><b>%s</b> at %dx%d: %" PRIu32
             " passes in order of execution, %" PRIu32 " resources; ",
             pipeline->name, REFERENCE_WIDTH, REFERENCE_HEIGHT, pipeline->pass_count,
             pipeline->resource_count);
    dot_bytes(d->out, pipeline->transient_bytes);
    text_add(d->out, " of transients in ");
    dot_bytes(d->out, pipeline->aliased_bytes);
    text_add(d->out,
             "</font></td></tr><tr><td align=\"left\"><font point-size=\"7\">Box: a pass; dashed: "
             "runs only when its condition holds. Table beside it: what it is the first to write; "
             "blue: images, yellow: buffers.<br align=\"left\"/>Heavy arrow: writes; with two "
             "heads: updates. Thin line: from rows to the passes that read them; dashed: what the "
             "last frame left.<br align=\"left\"/>Dark bar: Vulkan's barrier, earlier accesses → "
             "those that wait; lines that end at a name wait for nothing new. GL: bits of "
             "glMemoryBarrier.<br align=\"left\"/></font></td></tr>");
    struct text unused = {0};
    if (dot_unused(pipeline, &unused) && unused.data) {
        text_add(d->out,
                 "<tr><td align=\"left\"><font point-size=\"7\">Unused here: %s.<br "
                 "align=\"left\"/></font></td></tr>",
                 unused.data);
    }
    text_free(&unused);
    text_add(d->out, "</table>>;\n");
}

void emit_graph(const struct model *model, struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;
    unsigned *bits = arena_alloc(model->arena, pipeline->pass_count * sizeof *bits + 1);
    struct drawing d = {.pipeline = pipeline, .gl_bits = bits, .out = out};

    if (!bits) {
        out->failed = true;
        return;
    }
    plan_gl_bits(model, bits);
    measure(&d);
    if (!graph_layout(model, &d.graph)) {
        out->failed = true;
        return;
    }
    d.graph.table_width = 5 + d.columns[0] + d.columns[1] + d.columns[2];
    dot_begin(out, pipeline->name);
    emit_caption(&d);
    emit_dropped(&d);
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        emit_pass(&d, place);
        emit_table(&d, place);
    }
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        emit_writes(&d, place);
    }
    for (uint32_t b = 0; b < d.graph.block_count; b++) {
        emit_block_lines(&d, b);
    }
    text_add(out, "}\n");
}
