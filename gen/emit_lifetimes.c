/* NAME_lifetimes.dot: which resources share memory, for Graphviz. One table: a column for each pass in
 * order of execution, a row for each resource, filled where it lives, and the rows of a slot of memory
 * together. What changes hands within a frame is told below it. Called by main. */
#include <inttypes.h>

#include "dot.h"
#include "emit_c.h"

enum { PASS_WIDTH = 20 };

#define ALIVE  "#9db8d6" /* images */
#define ALIVE2 "#e3cf8e" /* buffers */

struct lanes {
    const struct pipeline *pipeline;
    struct text *out;
};

static bool lives(const struct resource *resource, uint32_t place)
{
    return resource->first_pass >= 0 && (int)place >= resource->first_pass &&
           (int)place <= resource->last_pass;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

/* w: written, r: read, u: updated, or nothing. */
static const char *use_letter(const struct pass *pass, const struct resource *resource)
{
    bool reads = resource == pass->indirect_resource || resource == pass->index_resource;
    bool writes = false;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].resource == resource) {
            reads |= pass->accesses[i].mode != MODE_WRITE;
            writes |= pass->accesses[i].mode != MODE_READ;
        }
    }
    return reads && writes ? "u" : writes ? "w" : reads ? "r" : "";
}

static void emit_cells(const struct lanes *l, const struct resource *resource)
{
    const char *fill = resource->history            ? DOT_HISTORY_FILL
                       : resource->kind == DT_IMAGE ? ALIVE
                                                    : ALIVE2;

    for (uint32_t place = 0; place < l->pipeline->pass_count; place++) {
        bool alive = lives(resource, place);
        bool first = !place || !lives(resource, place - 1);
        bool last = place + 1 == l->pipeline->pass_count || !lives(resource, place + 1);

        if (!alive) {
            text_add(l->out, "<td border=\"0\"></td>");
            continue;
        }
        text_add(l->out, "<td bgcolor=\"%s\" sides=\"TB%s%s\">%s</td>", fill, first ? "L" : "",
                 last ? "R" : "", use_letter(l->pipeline->order[place], resource));
    }
}

static void emit_resource(const struct lanes *l, const struct resource *resource)
{
    struct text text = {0};

    text_add(l->out,
             "<td border=\"0\" align=\"left\">&nbsp;%s%s</td><td border=\"0\" "
             "align=\"left\"><font point-size=\"7\">&nbsp;",
             resource->name, resource->first_pass < 0 ? " <i>(unused)</i>" : "");
    dot_extent(&text, resource);
    l->out->failed |= text.failed;
    dot_text(l->out, text.data ? text.data : "");
    text_free(&text);
    text_add(l->out, "&nbsp;</font></td><td border=\"0\" align=\"right\"><font point-size=\"7\">");
    dot_bytes(l->out, resource->bytes);
    text_add(l->out, "&nbsp;</font></td>");
    emit_cells(l, resource);
    text_add(l->out, "</tr>\n");
}

/* ---- Slots ----------------------------------------------------------------------------------- */

static uint32_t residents(const struct lanes *l, uint32_t slot, uint64_t *bytes)
{
    uint32_t count = 0;

    *bytes = 0;
    for (uint32_t i = 0; i < l->pipeline->resource_count; i++) {
        const struct resource *resource = &l->pipeline->resources[i];

        if (resource->slot == slot) {
            count++;
            *bytes = resource->bytes > *bytes ? resource->bytes : *bytes;
        }
    }
    return count;
}

/* The resource of the slot that comes into being after `before`, by first pass, then by the spec. */
static const struct resource *next_resident(const struct lanes *l, uint32_t slot,
                                            const struct resource *before)
{
    const struct resource *next = NULL;

    for (uint32_t i = 0; i < l->pipeline->resource_count; i++) {
        const struct resource *resource = &l->pipeline->resources[i];
        bool later = !before || resource->first_pass > before->first_pass ||
                     (resource->first_pass == before->first_pass && resource > before);

        if (resource->slot == slot && later && (!next || resource->first_pass < next->first_pass)) {
            next = resource;
        }
    }
    return next;
}

static void emit_slot(const struct lanes *l, uint32_t slot)
{
    uint64_t bytes;
    uint32_t count = residents(l, slot, &bytes);
    const struct resource *resource = next_resident(l, slot, NULL);

    if (!resource) {
        return;
    }
    text_add(l->out, "<hr/><tr><td border=\"0\" rowspan=\"%" PRIu32 "\" align=\"left\"><b>", count);
    dot_bytes(l->out, bytes);
    text_add(l->out, "</b>%s&nbsp;</td>", resource->history ? "<br/>history" : "");
    for (uint32_t row = 0; resource; row++) {
        text_add(l->out, row ? "<tr>" : "");
        emit_resource(l, resource);
        resource = next_resident(l, slot, resource);
    }
}

static void emit_head(const struct lanes *l)
{
    text_add(l->out, "<tr><td border=\"0\" align=\"left\"><b>memory</b></td><td border=\"0\" "
                     "colspan=\"3\" align=\"right\">pass&nbsp;</td>");
    for (uint32_t place = 0; place < l->pipeline->pass_count; place++) {
        text_add(l->out, "<td border=\"0\" width=\"%d\"><b>%" PRIu32 "</b></td>", PASS_WIDTH,
                 place + 1);
    }
    text_add(l->out, "</tr>\n");
}

/* What the frame needs at each pass: no assignment of memory can do with less than the largest. */
static void emit_needed(const struct lanes *l)
{
    text_add(l->out, "<hr/><tr><td border=\"0\" colspan=\"4\" align=\"right\">transients alive, "
                     "MiB&nbsp;</td>");
    for (uint32_t place = 0; place < l->pipeline->pass_count; place++) {
        uint64_t bytes = 0;

        for (uint32_t i = 0; i < l->pipeline->resource_count; i++) {
            const struct resource *resource = &l->pipeline->resources[i];

            bytes += lives(resource, place) && !resource->history ? resource->bytes : 0;
        }
        text_add(l->out, "<td border=\"0\"><font point-size=\"7\">%.0f</font></td>",
                 (double)bytes / (1 << 20));
    }
    text_add(l->out, "</tr>\n");
}

/* ---- Below the table ------------------------------------------------------------------------- */

static void emit_title(const struct lanes *l)
{
    const struct pipeline *pipeline = l->pipeline;
    uint64_t whole = pipeline->transient_bytes, aliased = pipeline->aliased_bytes;
    uint64_t kept = 0, unused = 0;

    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];

        kept += resource->history ? resource->bytes : 0;
        unused += resource->first_pass < 0 ? resource->bytes : 0;
    }
    text_add(l->out, "<font point-size=\"9\"><b>%s</b> at %dx%d: transients of ", pipeline->name,
             REFERENCE_WIDTH, REFERENCE_HEIGHT);
    dot_bytes(l->out, whole);
    if (unused) {
        text_add(l->out, ", ");
        dot_bytes(l->out, unused);
        text_add(l->out, " of them unused,");
    }
    text_add(l->out, " in ");
    dot_bytes(l->out, aliased);
    text_add(l->out, " of memory; ");
    dot_bytes(l->out, whole - aliased);
    text_add(l->out, " (%.0f %%) saved",
             whole ? 100.0 * (double)(whole - aliased) / (double)whole : 0);
    if (kept) {
        text_add(l->out, "; kept from frame to frame: ");
        dot_bytes(l->out, kept);
    }
    text_add(l->out, "</font><br align=\"left\"/>");
}

static void emit_passes(const struct lanes *l)
{
    for (uint32_t place = 0; place < l->pipeline->pass_count; place++) {
        text_add(l->out, "%s<b>%" PRIu32 "</b> %s",
                 !place      ? ""
                 : place % 8 ? ", "
                             : ",<br align=\"left\"/>",
                 place + 1, l->pipeline->order[place]->name);
    }
    text_add(l->out, "<br align=\"left\"/>Filled: alive (blue: images, yellow: buffers, grey: "
                     "history); w: written, r: read, u: updated. Outputs live to the end of the "
                     "frame.<br align=\"left\"/>");
}

static void emit_handovers(const struct lanes *l)
{
    bool any = false;

    for (uint32_t place = 0; place < l->pipeline->pass_count; place++) {
        const struct pass *pass = l->pipeline->order[place];

        for (uint32_t i = 0; i < pass->barrier_count; i++) {
            const struct barrier *barrier = &pass->barriers[i];

            if (!barrier->alias) {
                continue;
            }
            text_add(l->out, "%s<b>%" PRIu32 "</b> %s after %s: ",
                     any ? "" : "Vulkan's barriers where memory changes hands:<br align=\"left\"/>",
                     place + 1, barrier->resource->name, barrier->alias->name);
            dot_accesses(l->out, barrier->from, barrier->from_stages);
            text_add(l->out, " → ");
            dot_accesses(l->out, barrier->to, barrier->to_stages);
            text_add(l->out, "%s<br align=\"left\"/>",
                     barrier->from_writes ? "" : " (execution only)");
            any = true;
        }
    }
}

static void emit_shares(const struct lanes *l)
{
    bool any = false;

    for (uint32_t i = 0; i < l->pipeline->resource_count; i++) {
        const struct resource *resource = &l->pipeline->resources[i];

        if (resource->share >= 0) {
            text_add(l->out, "%s%s in that of %s<br align=\"left\"/>",
                     any ? "" : "OpenGL's textures that images share:<br align=\"left\"/>",
                     resource->name, l->pipeline->resources[resource->share].name);
            any = true;
        }
    }
}

void emit_lifetimes(const struct model *model, struct text *out)
{
    const struct lanes lanes = {&model->pipeline, out};

    dot_begin(out, model->pipeline.name);
    text_add(out, "  lifetimes [label=<<table border=\"0\" cellborder=\"1\" cellspacing=\"0\" "
                  "cellpadding=\"1\">\n");
    emit_head(&lanes);
    for (uint32_t slot = 0; slot < model->pipeline.slot_count; slot++) {
        emit_slot(&lanes, slot);
    }
    emit_needed(&lanes);
    text_add(out, "</table>>];\n  label=<<font point-size=\"7\">");
    emit_title(&lanes);
    emit_passes(&lanes);
    emit_shares(&lanes);
    emit_handovers(&lanes);
    text_add(out, "</font>>;\n}\n");
}
