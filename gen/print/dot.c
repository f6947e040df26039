/* Pieces of Graphviz source; see dot.h. */
#include "dot.h"

#include <inttypes.h>

#include "plan/plan.h"

void dot_bytes(struct text *out, const char *before, uint64_t bytes, const char *after)
{
    if (bytes >= 1 << 20)
        text_add(out, "%s%.1f MiB%s", before, (double)bytes / (1 << 20), after);
    else if (bytes >= 1 << 10)
        text_add(out, "%s%.1f KiB%s", before, (double)bytes / (1 << 10), after);
    else
        text_add(out, "%s%" PRIu64 " B%s", before, bytes, after);
}

void dot_extent(struct text *out, const struct resource *resource)
{
    if (resource->kind == DT_BUFFER) {
        text_add(out, "%s",
                 resource->structure ? resource->structure->name : type_info(resource->type)->name);
        text_add(out, "[%" PRIu32 "]",
                 expr_value(resource->count, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1));
        return;
    }
    text_add(out, "%s %" PRIu32 "×%" PRIu32, format_info(resource->format)->name,
             expr_value(resource->width, REFERENCE_WIDTH, REFERENCE_HEIGHT, REFERENCE_WIDTH),
             expr_value(resource->height, REFERENCE_WIDTH, REFERENCE_HEIGHT, REFERENCE_HEIGHT));
    if (resource->layers) {
        text_add(out, "×%" PRIu32,
                 expr_value(resource->layers, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1));
    }
    if (mips_of(resource) > 1)
        text_add(out, ", %" PRIu32 " mips", mips_of(resource));
}

/* Words for the bits of a mask. */
struct word {
    unsigned bits;
    const char *text;
};

/* In `words`, an entry of several bits must come before those of one. */
static void add_words(struct text *out, const struct word *words, size_t count, unsigned mask,
                      const char *between)
{
    bool any = false;

    for (size_t i = 0; i < count; i++) {
        if ((mask & words[i].bits) == words[i].bits) {
            text_add(out, "%s%s", any ? between : "", words[i].text);
            mask &= ~words[i].bits;
            any = true;
        }
    }
}

static void accesses(struct text *out, unsigned kinds, unsigned stages)
{
    static const struct word stage_words[] = {
        {DT_STAGE_COMPUTE, "compute"}, {DT_STAGE_VERTEX, "vertex"}, {DT_STAGE_FRAGMENT, "fragment"},
        {DT_STAGE_COLOR, "colour"},    {DT_STAGE_DEPTH, "depth"},   {DT_STAGE_CLEAR, "clear"}};
    static const struct word kind_words[] = {
        {DT_READ_STORAGE | DT_WRITE_STORAGE, "storage read and write"},
        {DT_READ_STORAGE, "storage read"},
        {DT_WRITE_STORAGE, "storage write"},
        {DT_READ_TEXTURE, "texture read"},
        {DT_READ_UNIFORM, "uniform read"},
        {DT_READ_COLOR | DT_WRITE_COLOR, "colour attachment"},
        {DT_WRITE_COLOR, "colour attachment"},
        {DT_READ_DEPTH | DT_WRITE_DEPTH, "depth attachment"},
        {DT_WRITE_DEPTH, "depth attachment"},
        {DT_READ_INDIRECT, "indirect arguments"},
        {DT_READ_INDEX, "index buffer"},
        {DT_WRITE_CLEAR, "clear"}};
    const unsigned in_shaders =
        DT_READ_STORAGE | DT_WRITE_STORAGE | DT_READ_TEXTURE | DT_READ_UNIFORM;

    if (!kinds || kinds & in_shaders) {
        const unsigned shader_stages = DT_STAGE_COMPUTE | DT_STAGE_VERTEX | DT_STAGE_FRAGMENT;

        add_words(out, stage_words, sizeof stage_words / sizeof *stage_words,
                  kinds ? stages & shader_stages : stages, "/");
        text_add(out, kinds ? " " : " change of layout");
    }
    add_words(out, kind_words, sizeof kind_words / sizeof *kind_words, kinds, ", ");
}

void dot_barrier(struct text *out, const struct barrier *barrier)
{
    accesses(out, barrier->from, barrier->from_stages);
    text_add(out, " → ");
    accesses(out, barrier->to, barrier->to_stages);
    text_add(out, "%s", barrier->from_writes ? "" : " (execution only)");
}

unsigned dot_uses(const struct pass *pass, const struct resource *resource)
{
    bool reads = resource == pass->indirect_resource || resource == pass->index_resource;
    bool writes = false;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].resource == resource) {
            reads |= pass->accesses[i].mode != MODE_WRITE;
            writes |= pass->accesses[i].mode != MODE_READ;
        }
    }
    return (reads ? DOT_READS : 0) | (writes ? DOT_WRITES : 0);
}

void dot_begin(struct text *out, const char *name)
{
    text_add(out,
             "digraph \"%s\" {\n"
             "  graph [charset=\"UTF-8\", fontname=\"Helvetica\", labeljust=l, nodesep=0.07,\n"
             "         ranksep=0.1, fontsize=7];\n"
             "  node [shape=plain, fontname=\"Helvetica\", fontsize=7];\n"
             "  edge [arrowsize=0.5];\n",
             name);
}
