/* Pieces of Graphviz source; see dot.h. */
#include "dot.h"

#include <inttypes.h>

#include "plan.h"

void dot_text(struct text *out, const char *plain)
{
    for (; *plain; plain++) {
        switch (*plain) {
        case '&':
            text_add(out, "&amp;");
            break;
        case '<':
            text_add(out, "&lt;");
            break;
        case '>':
            text_add(out, "&gt;");
            break;
        case '"':
            text_add(out, "&quot;");
            break;
        default:
            text_add(out, (unsigned char)*plain < ' ' ? " " : "%c", *plain);
        }
    }
}

void dot_bytes(struct text *out, uint64_t bytes)
{
    if (bytes >= 1 << 20) {
        text_add(out, "%.1f MiB", (double)bytes / (1 << 20));
    } else if (bytes >= 1 << 10) {
        text_add(out, "%.1f KiB", (double)bytes / (1 << 10));
    } else {
        text_add(out, "%" PRIu64 " B", bytes);
    }
}

void dot_extent(struct text *out, const struct resource *resource)
{
    if (resource->kind == DT_BUFFER) {
        text_add(out, "%s",
                 resource->structure ? resource->structure->name : type_info(resource->type)->glsl);
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
    if (resource_mips(resource) > 1) {
        text_add(out, ", %" PRIu32 " mips", resource_mips(resource));
    }
}

/* A word of several bits comes before those of one. */
void dot_words(struct text *out, const struct dot_word *words, size_t count, unsigned mask,
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

void dot_accesses(struct text *out, unsigned kinds, unsigned stages)
{
    static const struct dot_word stage_words[] = {
        {STAGE_COMPUTE, "compute"}, {STAGE_VERTEX, "vertex"}, {STAGE_FRAGMENT, "fragment"},
        {STAGE_COLOR, "colour"},    {STAGE_DEPTH, "depth"},   {STAGE_CLEAR, "clear"}};
    static const struct dot_word kind_words[] = {
        {ACCESS_STORAGE_READ | ACCESS_STORAGE_WRITE, "storage read and write"},
        {ACCESS_STORAGE_READ, "storage read"},
        {ACCESS_STORAGE_WRITE, "storage write"},
        {ACCESS_FETCH, "texel fetch"},
        {ACCESS_SAMPLED, "sampled read"},
        {ACCESS_UNIFORM, "uniform read"},
        {ACCESS_COLOR, "colour attachment"},
        {ACCESS_DEPTH, "depth attachment"},
        {ACCESS_INDIRECT, "indirect arguments"},
        {ACCESS_INDEX, "index buffer"},
        {ACCESS_CLEAR, "clear"}};
    const unsigned in_shaders =
        ACCESS_STORAGE_READ | ACCESS_STORAGE_WRITE | ACCESS_FETCH | ACCESS_SAMPLED | ACCESS_UNIFORM;

    if (!kinds || kinds & in_shaders) {
        const unsigned shader_stages = STAGE_COMPUTE | STAGE_VERTEX | STAGE_FRAGMENT;

        dot_words(out, stage_words, sizeof stage_words / sizeof *stage_words,
                  kinds ? stages & shader_stages : stages, "/");
        text_add(out, kinds ? " " : " change of layout");
    }
    dot_words(out, kind_words, sizeof kind_words / sizeof *kind_words, kinds, ", ");
}

int dot_width(const char *plain, int font_size)
{
    int characters = 0;

    for (; *plain; plain++) {
        characters += (*plain & 0xc0) != 0x80;
    }
    return characters * font_size * 58 / 100 + 6;
}

uint32_t dot_unused(const struct pipeline *pipeline, struct text *out)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        if (pipeline->resources[i].first_pass < 0) {
            text_add(out, "%s%s", count++ ? ", " : "", pipeline->resources[i].name);
        }
    }
    return count;
}

void dot_begin(struct text *out, const char *name)
{
    text_add(out,
             "digraph \"%s\" {\n"
             "  graph [layout=neato, inputscale=72, splines=line, charset=\"UTF-8\", labelloc=b,\n"
             "         fontname=\"Helvetica\", fontsize=8];\n"
             "  node [shape=plain, fontname=\"Helvetica\", fontsize=8];\n"
             "  edge [arrowsize=0.5, penwidth=0.7];\n",
             name);
}
