/* The reference of the spec language as Markdown, from the table that the reader uses. */
#include <string.h>

#include "print.h"
#include "read/table.h"

/* Escapes `|`, which would end the table cell. */
static void add_cell(struct text *out, const char *text)
{
    for (; *text; text++)
        text_add(out, *text == '|' ? "\\|" : "%c", *text);
}

static void add_type(struct text *out, const struct key *key)
{
    const char *child = key->child != SECTION_NONE ? table_sections[key->child].path : NULL;
    if (key->choices && key->type == KEY_CHOICE) {
        for (const char *at = key->choices; *at;) {
            size_t length = strcspn(at, "|");
            text_add(out, "%s`%.*s`", at == key->choices ? "" : ", ", (int)length, at);
            at += length + (at[length] != '\0');
        }
        if (child)
            text_add(out, ", or a map [`%s`](#%s)", child, table_sections[key->child].anchor);
        return;
    }
    add_cell(out, key->type == KEY_MAP && child ? "a map" : key_types[key->type].text);
    if (child)
        text_add(out, "%s [`%s`](#%s)", key->type == KEY_MAP || key->type == KEY_LIST ? "" : ", or",
                 child, table_sections[key->child].anchor);
}

static void add_key_row(struct text *out, const struct key *key)
{
    text_add(out, "| `%s` | ", strcmp(key->name, "*") ? key->name : "NAME");
    add_type(out, key);
    text_add(out, " | ");
    add_cell(out, key->required ? "**required**" : key->fallback ? key->fallback : "");
    text_add(out, " | ");
    add_cell(out, key->doc);
    text_add(out, " | `");
    add_cell(out, key->example);
    text_add(out, "` |\n");
}

static void add_section(struct text *out, enum section section)
{
    const struct section_info *info = &table_sections[section];
    text_add(out, "\n<a id=\"%s\"></a>\n## %s%s%s\n\n%s\n\n", info->anchor, *info->path ? "`" : "",
             *info->path ? info->path : "The document", *info->path ? "`" : "", info->doc);
    if (info->example)
        text_add(out, "```yaml\n%s\n```\n\n", info->example);
    text_add(out, "| key | type | default | meaning | example |\n|---|---|---|---|---|\n");
    for (const struct key *key = table_section(section); key->name; key++)
        add_key_row(out, key);
}

void emit_reference(struct text *out)
{
    text_add(
        out,
        "# The spec language\n\n"
        "Written by `diptych-gen --reference` from the table that its parser uses. A spec is one "
        "YAML 1.2 document; `diptych-gen --schema` prints a JSON Schema of it for editors.\n\n"
        "Integer expressions stand wherever a count or a size does: `+ - * / %%`, `<< >>` by 0 to "
        "31, comparisons, `&& || !`, `a ? b : c`, `min(a, b)`, `max(a, b)`, `ceil_div(a, b)` with "
        "a positive divisor, parentheses, integers, `true` and `false`, names of parameters and "
        "constants, a vector's component (`tile.x`), `frame.width` and `frame.height`, and sizes "
        "of resources with a `file`: `NAME.width`, `NAME.height`, `NAME.count`. They are evaluated "
        "in 64 bits; a division by zero or an overflow is an error.\n\n"
        "`--set PATH=VALUE` overrides a value: the path is dotted "
        "(`metrics.vpl_distance.position`, elements of lists by their `name` or number: "
        "`passes.shade.local`), a bare name is a parameter.\n\n"
        "What GLSL may name is [at the end](#body). The language has no stencil, multisampling, "
        "tessellation, mesh or ray stages.\n");
    for (enum section section = SECTION_TOP; section < SECTION_COUNT; section++)
        add_section(out, section);
    emit_body_reference(out);
}
