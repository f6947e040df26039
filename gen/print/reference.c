/* The reference of the spec language: templates/language.md, with a section for each of the table that the reader uses. */
#include <stdlib.h>
#include <string.h>

#include "base/input.h"
#include "base/log.h"
#include "print.h"
#include "read/table.h"

enum { MOST_WORDS = 1 << 20 }; /* bytes of language.md */

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

bool emit_reference(const char *templates, struct text *out, const struct dt_log *log)
{
    static const char mark[] = "<!-- sections -->\n";
    const char *reason = "the line <!-- sections --> is missing";
    char *path = format_string("%s/language.md", templates);
    size_t size;
    char *words = path ? input_read(path, MOST_WORDS, &size, &reason) : NULL;
    const char *at = words ? strstr(words, mark) : NULL;
    bool good = at;
    if (good) {
        text_add_bytes(out, words, (size_t)(at - words) - 1);
        for (enum section section = SECTION_TOP; section < SECTION_COUNT; section++)
            add_section(out, section);
        text_add(out, "%s", at + strlen(mark));
    } else {
        report_error(log, "%s: %s", path ? path : templates, reason);
    }
    free(path);
    free(words);
    return good;
}
