/* A JSON Schema (draft 2020-12) of the spec language, from the table that the reader uses. Editors
 * use it to complete and to check. It checks only the syntax of names, expressions and numbers. */
#include <string.h>

#include "print.h"
#include "read/table.h"

static void add_choices(struct text *out, const char *choices, const char *skip)
{
    const char *separator = "";
    text_add(out, "{\"enum\": [");
    for (const char *at = choices; *at;) {
        size_t length = strcspn(at, "|");
        if (!skip || strlen(skip) != length || strncmp(at, skip, length)) {
            text_add(out, "%s\"%.*s\"", separator, (int)length, at);
            separator = ", ";
        }
        at += length + (at[length] != '\0');
    }
    text_add(out, "]}");
}

static void add_schema_reference(struct text *out, enum section section)
{
    text_add(out, "{\"$ref\": \"#/$defs/%s\"}", table_sections[section].anchor);
}

/* A list whose elements are names, maps of the child section, or either. */
static void add_list(struct text *out, const struct key *key)
{
    text_add(out, "{\"type\": \"array\", \"items\": ");
    if (key->child == SECTION_PASS) {
        text_add(out, "{\"anyOf\": [");
        static const enum section items[] = {SECTION_PASS, SECTION_PASS_INCLUDE, SECTION_USE,
                                             SECTION_REPEAT};
        for (size_t i = 0; i < DT_ARRAY_COUNT(items); i++) {
            text_add(out, "%s", i ? ", " : "");
            add_schema_reference(out, items[i]);
        }
        text_add(out, "]}");
    } else if (key->type == KEY_LIST) {
        add_schema_reference(out, key->child);
    } else if (key->child != SECTION_NONE) {
        text_add(out, "{\"anyOf\": [{\"$ref\": \"#/$defs/REFERENCE\"}, ");
        add_schema_reference(out, key->child);
        text_add(out, "]}");
    } else {
        text_add(out, "{\"$ref\": \"#/$defs/REFERENCE\"}");
    }
    text_add(out, "}");
}

static void add_scalar_type(struct text *out, const struct key *key)
{
    const struct key_type_info *type = &key_types[key->type];
    if (key->type == KEY_CHOICE) {
        add_choices(out, key->choices, NULL);
    } else if (key->type == KEY_TYPE) {
        text_add(out, "{\"anyOf\": [");
        add_choices(out, key->choices, "bool");
        text_add(out, ", {\"type\": \"string\", \"pattern\": \"^[a-z0-9]+\\\\[[0-9]+\\\\]$\"}]}");
    } else if (!type->items) {
        text_add(out, "%s", type->scalar);
    } else {
        text_add(out, type->scalar ? "{\"anyOf\": [%s, " : "%s", type->scalar ? type->scalar : "");
        text_add(out, "{\"type\": \"array\", \"items\": %s", type->items);
        if (type->most)
            text_add(out, ", \"minItems\": %d, \"maxItems\": %d", type->least, type->most);
        text_add(out, type->scalar ? "}]}" : "}");
    }
}

static void add_type(struct text *out, const struct key *key)
{
    if (key->type == KEY_LIST || key->type == KEY_NAMES) {
        add_list(out, key);
    } else if (key->type == KEY_MAP) {
        add_schema_reference(out, key->child);
    } else if (key->child != SECTION_NONE) {
        text_add(out, "{\"anyOf\": [");
        add_scalar_type(out, key);
        text_add(out, ", ");
        add_schema_reference(out, key->child);
        text_add(out, "]}");
    } else {
        add_scalar_type(out, key);
    }
}

static void add_required(struct text *out, enum section section)
{
    const char *separator = "";
    text_add(out, "      \"required\": [");
    for (const struct key *key = table_section(section); key->name; key++)
        if (key->required) {
            text_add(out, "%s\"%s\"", separator, key->name);
            separator = ", ";
        }
    text_add(out, "],\n");
}

static void add_section(struct text *out, enum section section)
{
    const struct key *any = NULL;
    const char *separator = "";
    text_add(out, "    \"%s\": {\n      \"type\": \"object\",\n      \"description\": ",
             table_sections[section].anchor);
    text_add_json(out, table_sections[section].doc);
    text_add(out, ",\n");
    add_required(out, section);
    text_add(out, "      \"properties\": {");
    for (const struct key *key = table_section(section); key->name; key++) {
        if (!strcmp(key->name, "*")) {
            any = key;
            continue;
        }
        text_add(out, "%s\n        \"%s\": {\"description\": ", separator, key->name);
        text_add_json(out, key->doc);
        text_add(out, ", \"allOf\": [");
        add_type(out, key);
        text_add(out, "]}");
        separator = ",";
    }
    text_add(out, "\n      },\n");
    if (any) {
        text_add(out,
                 "      \"propertyNames\": {\"$ref\": \"#/$defs/%s\"},\n      "
                 "\"additionalProperties\": ",
                 section == SECTION_CONTRACTS ? "REFERENCE" : "NAME");
        add_type(out, any);
    } else {
        text_add(out, "      \"additionalProperties\": false");
    }
    text_add(out, "\n    }");
}

void emit_schema(struct text *out)
{
    text_add(
        out,
        "{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
        "  \"title\": \"diptych pipeline spec\",\n  \"$ref\": \"#/$defs/%s\",\n  \"$defs\": {\n",
        table_sections[SECTION_TOP].anchor);
    text_add(out,
             "    \"NAME\": {\"type\": \"string\", \"pattern\": \"^[A-Za-z_][A-Za-z0-9_]*$\"},\n"
             "    \"REFERENCE\": {\"type\": \"string\", \"pattern\": \"^[A-Za-z_]\"},\n"
             "    \"EXPR\": {\"type\": [\"integer\", \"string\", \"boolean\"]}");
    for (enum section section = SECTION_TOP; section < SECTION_COUNT; section++) {
        text_add(out, ",\n");
        add_section(out, section);
    }
    text_add(out, "\n  }\n}\n");
}
