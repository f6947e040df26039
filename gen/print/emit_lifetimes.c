/* NAME_lifetimes.dot: which resources share memory, for Graphviz. One table: a column for each
 * pass in order of execution, a row for each resource, filled during its lifetime; rows grouped by
 * slot of memory. Below it: the barriers between resources that share memory. */
#include <inttypes.h>

#include "dot.h"
#include "emit_c.h"

/* Darker than in the pass graph, for contrast with white. */
#define ALIVE_IMAGE   "#9db8d6"
#define ALIVE_BUFFER  "#e3cf8e"
#define ALIVE_HISTORY "#b8b8b8"

static bool lives(const struct resource *resource, uint32_t place)
{
    return resource->first_pass >= 0 && (int)place >= resource->first_pass &&
           (int)place <= resource->last_pass;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static void emit_cells(const struct pipeline *pipeline, const struct resource *resource,
                       struct text *out)
{
    static const char *const letters[] = {"", [DOT_READS] = "r", [DOT_WRITES] = "w",
                                          [DOT_READS | DOT_WRITES] = "u"};
    const char *fill = resource->history            ? ALIVE_HISTORY
                       : resource->kind == DT_IMAGE ? ALIVE_IMAGE
                                                    : ALIVE_BUFFER;

    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        bool first = !place || !lives(resource, place - 1);
        bool last = place + 1 == pipeline->pass_count || !lives(resource, place + 1);

        if (!lives(resource, place)) {
            text_add(out, "<td border=\"0\"></td>");
            continue;
        }
        text_add(out, "<td bgcolor=\"%s\" sides=\"TB%s%s\">%s</td>", fill, first ? "L" : "",
                 last ? "R" : "", letters[dot_uses(pipeline->order[place], resource)]);
    }
}

static void emit_resource(const struct pipeline *pipeline, const struct resource *resource,
                          struct text *out)
{
    text_add(out, "<td border=\"0\" align=\"left\" height=\"13\">&nbsp;%s%s</td>", resource->name,
             resource->first_pass < 0 ? " <i>(unused)</i>" : "");
    text_add(out, "<td border=\"0\" align=\"left\">&nbsp;");
    dot_extent(out, resource);
    dot_bytes(out, "&nbsp;</td><td border=\"0\" align=\"right\">", resource->bytes, "&nbsp;</td>");
    emit_cells(pipeline, resource, out);
    text_add(out, "</tr>\n");
}

/* Rows of the resources in one slot, sorted by first pass. */
static void emit_slot(const struct pipeline *pipeline, uint32_t slot, struct text *out)
{
    const struct resource *end = pipeline->resources + pipeline->resource_count, *largest = NULL;
    uint32_t count = 0;

    for (const struct resource *resource = pipeline->resources; resource < end; resource++) {
        if (resource->slot == slot) {
            largest = !largest || resource->bytes > largest->bytes ? resource : largest;
            count++;
        }
    }
    if (!largest)
        return;
    text_add(out, "<hr/><tr><td border=\"0\" rowspan=\"%" PRIu32 "\" align=\"left\"><b>", count);
    dot_bytes(out, "", largest->bytes, largest->history ? "</b> history" : "</b>");
    text_add(out, "&nbsp;</td>");
    const char *before = "";
    for (int first = -1; first < (int)pipeline->pass_count; first++) {
        for (const struct resource *resource = pipeline->resources; resource < end; resource++) {
            if (resource->slot == slot && resource->first_pass == first) {
                text_add(out, "%s", before);
                emit_resource(pipeline, resource, out);
                before = "<tr>";
            }
        }
    }
}

static void emit_head(const struct pipeline *pipeline, struct text *out)
{
    text_add(out, "<tr><td border=\"0\" align=\"left\"><b>memory</b></td><td border=\"0\" "
                  "colspan=\"3\" align=\"right\">pass&nbsp;</td>");
    for (uint32_t place = 0; place < pipeline->pass_count; place++)
        text_add(out, "<td border=\"0\" width=\"20\"><b>%" PRIu32 "</b></td>", place + 1);
    text_add(out, "</tr>\n");
}

/* Bytes of transients alive at each pass. Their maximum is the least memory that can suffice. */
static void emit_needed(const struct pipeline *pipeline, struct text *out)
{
    text_add(out, "<hr/><tr><td border=\"0\" colspan=\"4\" align=\"right\" height=\"13\">"
                  "transients alive, MiB&nbsp;</td>");
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        uint64_t bytes = 0;

        for (uint32_t i = 0; i < pipeline->resource_count; i++) {
            const struct resource *resource = &pipeline->resources[i];

            bytes += lives(resource, place) && !resource->history ? resource->bytes : 0;
        }
        text_add(out, "<td border=\"0\">%.0f</td>", (double)bytes / (1 << 20));
    }
    text_add(out, "</tr>\n");
}

/* ---- Below the table ------------------------------------------------------------------------- */

static void emit_title(const struct pipeline *pipeline, struct text *out)
{
    uint64_t whole = pipeline->transient_bytes, saved = whole - pipeline->aliased_bytes;
    uint64_t kept = 0, unused = 0;

    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];

        kept += resource->history ? resource->bytes : 0;
        unused += resource->first_pass < 0 ? resource->bytes : 0;
    }
    text_add(out, "<font point-size=\"9\"><b>%s</b> at %dx%d: ", pipeline->name, REFERENCE_WIDTH,
             REFERENCE_HEIGHT);
    dot_bytes(out, "transients of ", whole, "");
    if (unused)
        dot_bytes(out, ", ", unused, " of them unused,");
    dot_bytes(out, " in ", pipeline->aliased_bytes, " of memory; ");
    dot_bytes(out, "", saved, "");
    text_add(out, " (%.0f %%) saved", whole ? 100.0 * (double)saved / (double)whole : 0);
    if (kept)
        dot_bytes(out, "; kept from frame to frame: ", kept, "");
    text_add(out, "</font><br align=\"left\"/>");
}

static void emit_passes(const struct pipeline *pipeline, struct text *out)
{
    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        text_add(out, "%s<b>%" PRIu32 "</b> %s",
                 place % 8 ? ", "
                 : place   ? ",<br align=\"left\"/>"
                           : "",
                 place + 1, pipeline->order[place]->name);
    }
    text_add(out, "<br align=\"left\"/>Filled: alive (blue: images, yellow: buffers, grey: "
                  "history); w: written, r: read, u: updated. Outputs live to the end of the "
                  "frame.<br align=\"left\"/>");
}

static void emit_handovers(const struct pipeline *pipeline, struct text *out)
{
    const char *before = "Vulkan's barriers where memory changes hands:<br align=\"left\"/>";

    for (uint32_t place = 0; place < pipeline->pass_count; place++) {
        const struct pass *pass = pipeline->order[place];

        for (uint32_t i = 0; i < pass->barrier_count; i++) {
            const struct barrier *barrier = &pass->barriers[i];

            if (barrier->alias) {
                text_add(out, "%s<b>%" PRIu32 "</b> %s after %s: ", before, place + 1,
                         barrier->resource->name, barrier->alias->name);
                dot_barrier(out, barrier);
                text_add(out, "<br align=\"left\"/>");
                before = "";
            }
        }
    }
}

static void emit_shares(const struct pipeline *pipeline, struct text *out)
{
    const char *before = "OpenGL's textures that images share:<br align=\"left\"/>";

    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];

        if (resource->share >= 0) {
            text_add(out, "%s%s in that of %s<br align=\"left\"/>", before, resource->name,
                     pipeline->resources[resource->share].name);
            before = "";
        }
    }
}

void emit_lifetimes(const struct model *model, struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;

    dot_begin(out, pipeline->name);
    text_add(out, "  lifetimes [label=<<table " DOT_TABLE ">\n");
    emit_head(pipeline, out);
    for (uint32_t slot = 0; slot < pipeline->slot_count; slot++)
        emit_slot(pipeline, slot, out);
    emit_needed(pipeline, out);
    text_add(out, "</table>>];\n  label=<<font point-size=\"7\">");
    emit_title(pipeline, out);
    emit_passes(pipeline, out);
    emit_shares(pipeline, out);
    emit_handovers(pipeline, out);
    text_add(out, "</font>>;\n}\n");
}
