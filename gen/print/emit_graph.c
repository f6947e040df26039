/* NAME.dot: the pass graph for Graphviz, which does the layout. A box for each pass, in order of
 * execution: its barriers, its dispatch or draw, the resources that it writes, and their readers.
 * Arrows lead from a pass to the passes that use its results. */
#include <inttypes.h>
#include <limits.h>
#include <string.h>

#include "dot.h"
#include "emit_c.h"

/* How often each invisible arrow that keeps the order of execution is repeated. Graphviz minimizes
 * crossings, so many of them push the visible arrows to the side, away from between the boxes. */
enum { REPEATS = 20 };

struct drawing {
    const struct pipeline *pipeline;
    struct arena *arena;
    struct text *out;
};

/* ---- Uses ------------------------------------------------------------------------------------ */

/* Place of the pass that last wrote any mip of the resource before the pass at `place` uses it. A
 * result after `place`: in the previous frame. -1: unused, or first written here. */
static int find_writer(const struct pipeline *pipeline, const struct resource *resource,
                       uint32_t place)
{
    unsigned uses = dot_uses(pipeline->order[place], resource);
    bool history = resource->history && uses & DOT_READS;

    for (uint32_t back = 1; uses && back < pipeline->pass_count; back++) {
        uint32_t other = (place + pipeline->pass_count - back) % pipeline->pass_count;

        if (dot_uses(pipeline->order[other], resource) & DOT_WRITES)
            return other < place || history ? (int)other : -1;
    }
    return -1;
}

/* Whether to draw the barrier. Not for an image's first touch in a frame, which only changes the
 * layout. emit_lifetimes.c draws the barriers between resources that share memory. */
static bool waits(const struct barrier *barrier)
{
    return barrier->from_stages && !barrier->alias;
}

static bool alike(const struct barrier *a, const struct barrier *b)
{
    return waits(a) && waits(b) && a->from == b->from && a->from_stages == b->from_stages &&
           a->to == b->to && a->to_stages == b->to_stages && a->from_writes == b->from_writes;
}

static bool is_waited_for(const struct pass *pass, const struct resource *resource)
{
    bool waited = false;

    for (uint32_t i = 0; i < pass->barrier_count; i++)
        waited |= pass->barriers[i].resource == resource && waits(&pass->barriers[i]);
    return waited;
}

/* ---- Dispatches and draws -------------------------------------------------------------------- */

static uint32_t at_reference(const struct expr *expr, uint32_t otherwise)
{
    return expr_value(expr, REFERENCE_WIDTH, REFERENCE_HEIGHT, otherwise);
}

/* 240×135: without trailing ones. */
static void emit_product(const struct drawing *d, const uint32_t size[3])
{
    int shown = size[2] > 1 ? 3 : size[1] > 1 ? 2 : 1;

    for (int i = 0; i < shown; i++)
        text_add(d->out, "%s%" PRIu32, i ? "×" : "", size[i]);
}

static void emit_dispatch(const struct drawing *d, const struct pass *pass, const struct step *work)
{
    uint32_t groups[3];

    if (work->verb == DT_VERB_DISPATCH_INDIRECT) {
        text_add(d->out, "dispatch by arguments, workgroups of ");
    } else {
        for (int axis = 0; axis < 3; axis++)
            groups[axis] = (uint32_t)amount_value(&work->arguments[axis], REFERENCE_WIDTH,
                                                  REFERENCE_HEIGHT, NULL);
        text_add(d->out, "dispatch ");
        emit_product(d, groups);
        text_add(d->out, " workgroup%s of ", (groups[0] | groups[1] | groups[2]) == 1 ? "" : "s");
    }
    emit_product(d, pass->local);
}

static void emit_draw(const struct drawing *d, const struct pass *pass)
{
    static const char *const topologies[] = {"triangles", "lines", "points"};
    if (pass->kind == DT_PASS_DRAW_VERTICES)
        text_add(d->out, "draw of %s", topologies[pass->topology]);
    else
        text_add(d->out,
                 pass->kind == DT_PASS_DRAW_SCENE ? "draw of the scene" : "draw, fullscreen");
    if (pass->kind == DT_PASS_DRAW_SCENE && pass->view && !pass->layers)
        text_add(d->out, " from the %s", pass->view);
    if (pass->layers)
        text_add(d->out, ", %" PRIu32 " %s", at_reference(pass->layers, 1),
                 pass->kind == DT_PASS_DRAW_SCENE ? "instances" : "layers");
    text_add(d->out, "%s", pass->indirect_resource ? " by arguments" : "");
}

/* ---- Passes ---------------------------------------------------------------------------------- */

/* Barriers with equal accesses share one bar, written at the first of them. */
static void emit_bar(const struct drawing *d, const struct pass *pass,
                     const struct barrier *barrier)
{
    int names = 0;

    for (const struct barrier *other = pass->barriers; other < barrier; other++)
        if (alike(other, barrier))
            return;
    text_add(d->out, "<tr><td colspan=\"2\" align=\"left\" border=\"1\" color=\"white\" "
                     "bgcolor=\"#484848\"><font color=\"white\">&nbsp;");
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        if (alike(&pass->barriers[i], barrier)) {
            const char *before = names % 3 ? ", " : names ? ",<br align=\"left\"/>&nbsp;" : "";

            text_add(d->out, "%s%s", before, pass->barriers[i].resource->name);
            names++;
        }
    }
    text_add(d->out, ": ");
    dot_barrier(d->out, barrier);
    text_add(d->out, "</font></td></tr>\n");
}

/* Writes text escaped for labels. */
static void emit_condition(const struct drawing *d, const char *text)
{
    for (; *text; text++) {
        text_add(d->out,
                 *text == '&'   ? "&amp;"
                 : *text == '<' ? "&lt;"
                 : *text == '>' ? "&gt;"
                                : "%c",
                 *text);
    }
}

static void emit_title(const struct drawing *d, uint32_t place)
{
    const struct pass *pass = d->pipeline->order[place];

    text_add(d->out,
             "<tr><td colspan=\"2\" align=\"left\" height=\"13\"><font "
             "point-size=\"9\"><b>&nbsp;%" PRIu32 "&nbsp;&nbsp;%s</b></font>",
             place + 1, pass->name);
    if (pass->conditional) {
        text_add(d->out, at_reference(pass->when, 1) ? "&nbsp;&nbsp;when "
                                                     : "&nbsp;&nbsp;SKIPPED by default: when ");
        emit_condition(d, pass->when_text);
    }
    text_add(d->out, "</td></tr>\n");
}

static void emit_detail(const struct drawing *d, uint32_t place)
{
    const struct pass *pass = d->pipeline->order[place];

    const struct steps steps = pass_steps(pass, d->arena);

    text_add(d->out, "<tr><td align=\"left\">&nbsp;");
    d->out->failed |= !steps.list;
    if (steps.list && pass->kind == DT_PASS_DISPATCH)
        emit_dispatch(d, pass, steps_work(&steps));
    else
        emit_draw(d, pass);
    text_add(d->out, "</td><td></td></tr>\n");
}

/* Reads without a barrier: the scene, and resources that an earlier barrier made visible. */
static void emit_reads(const struct drawing *d, const struct pass *pass)
{
    const char *before = "<tr><td colspan=\"2\" align=\"left\">&nbsp;reads ", *after = "";

    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (!pass->accesses[i].resource) {
            text_add(d->out, "%s%s", before, pass->accesses[i].name);
            before = ", ", after = "</td></tr>\n";
        }
    }
    for (uint32_t i = 0; i < d->pipeline->resource_count; i++) {
        const struct resource *resource = &d->pipeline->resources[i];

        if (dot_uses(pass, resource) == DOT_READS && !is_waited_for(pass, resource)) {
            text_add(d->out, "%s%s", before, resource->name);
            before = ", ", after = "</td></tr>\n";
        }
    }
    text_add(d->out, "%s", after);
}

/* ---- Written resources ----------------------------------------------------------------------- */

static void begin_cell(const struct drawing *d, const struct resource *resource, int width,
                       const char *align)
{
    text_add(d->out, "<td width=\"%d\" align=\"%s\" bgcolor=\"%s\">&nbsp;", width, align,
             resource->kind == DT_IMAGE ? DOT_IMAGE_FILL : DOT_BUFFER_FILL);
}

static void emit_written(const struct drawing *d, uint32_t place, const struct resource *resource)
{
    const struct pipeline *pipeline = d->pipeline;
    const char *linear = pipeline->linear_output, *display = pipeline->display_output;
    const char *before = "→ ";

    text_add(d->out, "<tr>");
    begin_cell(d, resource, 125, "left");
    text_add(d->out, "%s%s%s%s%s</td>", resource->name,
             dot_uses(pipeline->order[place], resource) & DOT_READS ? " <i>updated</i>" : "",
             resource->input     ? " <i>input</i>"
             : resource->history ? " <i>history</i>"
                                 : "",
             linear && !strcmp(resource->name, linear) ? " <i>linear output</i>" : "",
             display && !strcmp(resource->name, display) ? " <i>display output</i>" : "");
    begin_cell(d, resource, 82, "left");
    dot_extent(d->out, resource);
    text_add(d->out, "</td>");
    begin_cell(d, resource, 38, "right");
    dot_bytes(d->out, "", resource->bytes, "&nbsp;</td>");
    begin_cell(d, resource, 80, "left");
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        if (dot_uses(pipeline->order[i], resource) & DOT_READS &&
            find_writer(pipeline, resource, i) == (int)place) {
            text_add(d->out, "%s%" PRIu32, before, i + 1);
            before = ", ";
        }
    }
    text_add(d->out, "</td></tr>\n");
}

/* before: also the first letter of the name. */
static void emit_node(struct text *out, const char *before, const struct pass *pass)
{
    text_add(out, "%s_", before);
    text_add_word(out, pass->name);
}

static void emit_pass_node(const struct drawing *d, uint32_t place)
{
    const struct pass *pass = d->pipeline->order[place];
    const char *before = "<td border=\"0\"><table " DOT_TABLE ">\n", *after = "";

    emit_node(d->out, "  p", pass);
    text_add(d->out,
             " [label=<<table " DOT_TABLE
             "><tr><td width=\"370\" style=\"%s\"><table border=\"0\" cellborder=\"0\" "
             "cellspacing=\"0\" cellpadding=\"0\">\n",
             pass->conditional ? "dashed" : "solid");
    for (uint32_t i = 0; i < pass->barrier_count; i++)
        if (waits(&pass->barriers[i]))
            emit_bar(d, pass, &pass->barriers[i]);
    emit_title(d, place);
    emit_detail(d, place);
    emit_reads(d, pass);
    text_add(d->out, "</table></td>");
    for (uint32_t i = 0; i < d->pipeline->resource_count; i++) {
        if (dot_uses(pass, &d->pipeline->resources[i]) & DOT_WRITES) {
            text_add(d->out, "%s", before);
            emit_written(d, place, &d->pipeline->resources[i]);
            before = "", after = "</table></td>";
        }
    }
    text_add(d->out, "%s</tr></table>>];\n", after);
}

/* ---- Order and arrows ------------------------------------------------------------------------ */

/* Draws dropped passes before the next executed pass that stands behind them in the spec. */
static void emit_dropped(const struct drawing *d, uint32_t *next, int line, struct text *column)
{
    for (; *next < d->pipeline->dropped_count; ++*next) {
        const struct pass *pass = d->pipeline->dropped[*next];

        if (pass->loc.line > line)
            return;
        emit_node(d->out, "  d", pass);
        text_add(d->out,
                 " [shape=box, style=dashed, color=\"#909090\", fontcolor=\"#505050\", "
                 "height=0.1, margin=\"0.05,0.04\", label=<<b>%s</b>&nbsp; left out: when ",
                 pass->name);
        emit_condition(d, pass->when_text);
        text_add(d->out, ">];\n");
        emit_node(column, column->length ? " -> d" : "d", pass);
    }
}

/* One arrow for all resources that one pass wrote and the other uses. It is drawn downwards even to
 * the next frame; then its head is at the upper end. */
static void emit_arrow(const struct drawing *d, uint32_t from, uint32_t to)
{
    struct pass *const *order = d->pipeline->order;
    unsigned uses = 0;

    for (uint32_t i = 0; i < d->pipeline->resource_count; i++)
        if (find_writer(d->pipeline, &d->pipeline->resources[i], to) == (int)from)
            uses |= dot_uses(order[to], &d->pipeline->resources[i]);
    if (uses) {
        emit_node(d->out, "  p", order[from < to ? from : to]);
        emit_node(d->out, " -> p", order[from < to ? to : from]);
        text_add(d->out, " [penwidth=%s%s];\n", uses & DOT_WRITES ? "1.4" : "0.7",
                 from < to ? "" : ", style=dashed, dir=back");
    }
}

/* ---- The whole ------------------------------------------------------------------------------- */

static void emit_caption(const struct drawing *d)
{
    const struct pipeline *pipeline = d->pipeline;
    const char *before = "Unused here: ", *after = "";

    text_add(d->out,
             "  labelloc=t;\n  label=<<font point-size=\"9\"><b>%s</b> at %dx%d: %" PRIu32
             " passes in order of execution, %" PRIu32 " resources; ",
             pipeline->name, REFERENCE_WIDTH, REFERENCE_HEIGHT, pipeline->pass_count,
             pipeline->resource_count);
    dot_bytes(d->out, "", pipeline->transient_bytes, " of transients in ");
    dot_bytes(d->out, "", pipeline->aliased_bytes, "</font><br align=\"left\"/>");
    text_add(d->out,
             "Left: a pass; dashed: runs only when its condition holds. "
             "Right: what it writes, and which passes read that; blue: images, yellow: buffers."
             "<br align=\"left\"/>Arrow: from the pass that wrote last to one that reads; heavy: "
             "to one that writes again; dashed: to the next frame."
             "<br align=\"left\"/>Dark bar: Vulkan's barrier, earlier accesses → those that wait; "
             "what is read without one waits for nothing new. GL: bits of glMemoryBarrier."
             "<br align=\"left\"/>");
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        if (pipeline->resources[i].first_pass < 0) {
            text_add(d->out, "%s%s", before, pipeline->resources[i].name);
            before = ", ", after = "<br align=\"left\"/>";
        }
    }
    text_add(d->out, "%s>;\n", after);
}

void emit_graph(const struct model *model, struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;
    const struct drawing d = {.pipeline = pipeline, .arena = model->arena, .out = out};
    struct text column = {0};
    uint32_t dropped = 0;

    dot_begin(out, pipeline->name);
    emit_caption(&d);
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        emit_dropped(&d, &dropped, pipeline->order[place]->loc.line, &column);
        emit_pass_node(&d, place);
        emit_node(&column, column.length ? " -> p" : "p", pipeline->order[place]);
    }
    emit_dropped(&d, &dropped, INT_MAX, &column);
    out->failed |= column.failed;
    text_add(out, "  edge [style=invis, weight=100];\n");
    for (int i = 0; i < REPEATS; i++)
        text_add(out, "  %s;\n", column.data ? column.data : "");
    text_add(out, "  edge [style=solid, weight=1];\n");
    text_free(&column);
    for (uint32_t from = 0; from < pipeline->pass_count; from++)
        for (uint32_t to = 0; to < pipeline->pass_count; to++)
            emit_arrow(&d, from, to);
    text_add(out, "}\n");
}
