/* NAME.dot: the pass graph for Graphviz. Passes are boxes with their place in the order and their
 * barriers, resources are notes with format, size and lifetime, filled with one colour per slot of
 * memory. Called by main. */
#include <inttypes.h>

#include "emit_c.h"

/* Twelve pale fills that Graphviz knows (scheme set312); resources of one slot share one. */
static uint32_t slot_color(const struct resource *resource)
{
    return resource->slot % 12 + 1;
}

static void emit_bytes(struct text *out, uint64_t bytes)
{
    if (bytes >= 1 << 20) {
        text_add(out, "%.1f MiB", (double)bytes / (1 << 20));
    } else if (bytes >= 1 << 10) {
        text_add(out, "%.1f KiB", (double)bytes / (1 << 10));
    } else {
        text_add(out, "%" PRIu64 " B", bytes);
    }
}

static void emit_resource(const struct pipeline *pipeline, const struct resource *resource,
                          struct text *out)
{
    text_add(out,
             "  \"r_%s\" [shape=note, style=filled, fillcolor=\"/set312/%" PRIu32
             "\", label=\"%s\\n",
             resource->name, slot_color(resource), resource->name);
    if (resource->kind == DT_IMAGE) {
        uint32_t layers = expr_value(resource->layers, REFERENCE_WIDTH, REFERENCE_HEIGHT, 0);

        text_add(out, "%s %" PRIu32 "x%" PRIu32, format_info(resource->format)->name,
                 expr_value(resource->width, REFERENCE_WIDTH, REFERENCE_HEIGHT, REFERENCE_WIDTH),
                 expr_value(resource->height, REFERENCE_WIDTH, REFERENCE_HEIGHT, REFERENCE_HEIGHT));
        text_add(out, layers ? "x%" PRIu32 : "%.0" PRIu32, layers);
    } else {
        text_add(out, "%s[%" PRIu32 "]",
                 resource->structure ? resource->structure->name : type_info(resource->type)->glsl,
                 expr_value(resource->count, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1));
    }
    text_add(out, ", ");
    emit_bytes(out, resource->bytes);
    if (resource->history) {
        text_add(out, "\\nhistory");
    } else if (resource->first_pass < 0) {
        text_add(out, "\\nunused");
    } else {
        text_add(out, "\\npasses %d to %d", resource->first_pass + 1, resource->last_pass + 1);
    }
    text_add(out, ", slot %" PRIu32, resource->slot);
    if (resource->share >= 0) {
        text_add(out, "\\nOpenGL: texture of %s", pipeline->resources[resource->share].name);
    }
    text_add(out, "\"];\n");
}

static void emit_pass(const struct pipeline *pipeline, uint32_t place, unsigned bits,
                      struct text *out)
{
    static const char *const kinds[] = {[PASS_SCENE] = "draws the scene",
                                        [PASS_FULLSCREEN] = "draws fullscreen",
                                        [PASS_DISPATCH] = "dispatch"};
    const struct pass *pass = pipeline->order[place];

    text_add(out,
             "  \"p_%s\" [shape=box, label=\"%" PRIu32 ". %s\\n%s\\n%" PRIu32 " barriers%s\"%s];\n",
             pass->name, place + 1, pass->name, kinds[pass->kind], pass->barrier_count,
             bits ? ", memory barrier" : "", pass->conditional ? ", style=dashed" : "");
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (!access->resource) {
            continue;
        }
        if (access->mode == MODE_READ) {
            text_add(out, "  \"r_%s\" -> \"p_%s\";\n", access->resource->name, pass->name);
        } else {
            text_add(out, "  \"p_%s\" -> \"r_%s\"%s;\n", pass->name, access->resource->name,
                     access->mode == MODE_UPDATE ? " [dir=both, style=bold]" : "");
        }
    }
    if (pass->indirect_resource) {
        text_add(out, "  \"r_%s\" -> \"p_%s\" [style=dotted, label=\"indirect\"];\n",
                 pass->indirect_resource->name, pass->name);
    }
    if (pass->index_resource) {
        text_add(out, "  \"r_%s\" -> \"p_%s\" [style=dotted, label=\"indices\"];\n",
                 pass->index_resource->name, pass->name);
    }
}

void emit_graph(const struct model *model, struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;
    unsigned *bits = arena_alloc(model->arena, pipeline->pass_count * sizeof *bits + 1);

    if (!bits) {
        out->failed = true;
        return;
    }
    plan_gl_bits(model, bits);
    text_add(out,
             "digraph \"%s\" {\n  rankdir=LR;\n  node [fontname=\"sans-serif\", fontsize=11];\n",
             pipeline->name);
    text_add(out, "  label=\"%s at %dx%d: ", pipeline->name, REFERENCE_WIDTH, REFERENCE_HEIGHT);
    emit_bytes(out, pipeline->transient_bytes);
    text_add(out, " of transients in ");
    emit_bytes(out, pipeline->aliased_bytes);
    text_add(out, "\";\n");
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        emit_resource(pipeline, &pipeline->resources[i], out);
    }
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        emit_pass(pipeline, i, bits[i], out);
    }
    text_add(out, "}\n");
}
