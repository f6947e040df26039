/* YAML mappings and their diagnostics; see yaml_file.h. */
#include "base/yaml_file.h"

#include "base/input.h"
#include "base/nearest.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_BYTES = 64 << 20 };

/* ---- Diagnostics ----------------------------------------------------------------------------- */

void reader_report(struct reader *reader, struct fy_node *node, const char *format, ...)
{
    char *text = NULL;
    va_list arguments;
    if (!reader)
        return;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    diag_error(reader->diag, yaml_loc(&reader->source, node), "%s%s", reader->context,
               length < 0 ? "out of memory" : text);
    reader->errors++;
    if (length >= 0)
        free(text);
}

static void report_unknown_key(struct reader *reader, struct fy_node *node, const char *name,
                               const struct key *keys, size_t count)
{
    const char *names[32];
    size_t named = 0;
    for (; named < count && named < DT_ARRAY_COUNT(names); named++)
        names[named] = keys[named].name;
    reader_report(reader, node, "unknown key `%s`%s", name,
                  name_hint('`', name, names, named, "").text);
}

/* ---- Mappings -------------------------------------------------------------------------------- */

static bool parse_number(struct fy_node *node, double *number)
{
    const char *text = node && fy_node_is_scalar(node) ? fy_node_get_scalar0(node) : NULL;
    return text && text_number(text, number);
}

static bool check_number(struct reader *reader, const struct key *key, int i, struct fy_node *place)
{
    if (key->number[i] >= key->min && key->number[i] <= key->max)
        return true;
    reader_report(reader, place, "`%s` is out of range: it lies between %g and %g", key->name,
                  key->min, key->max);
    return false;
}

static void read_numbers(struct reader *reader, struct key *key)
{
    bool plain = key->count == 1;
    if (!plain &&
        (!fy_node_is_sequence(key->node) || fy_node_sequence_item_count(key->node) != key->count)) {
        reader_report(reader, key->node, "`%s` takes a sequence of %d numbers", key->name,
                      key->count);
        return;
    }
    for (int i = 0; i < key->count; i++) {
        struct fy_node *item = plain ? key->node : fy_node_sequence_get_by_index(key->node, i);
        if (!parse_number(item, &key->number[i]))
            reader_report(reader, item, "`%s` takes a %s here", key->name, "finite number");
        else
            check_number(reader, key, i, item);
    }
}

bool reader_range(struct reader *reader, const struct key *key)
{
    for (int i = 0; i < key->count; i++)
        if (!check_number(reader, key, i, key->node))
            return false;
    return true;
}

static void read_value(struct reader *reader, struct key *key)
{
    if (key->type == KEY_NUMBERS)
        read_numbers(reader, key);
    else if (key->type == KEY_MAPPING && !fy_node_is_mapping(key->node))
        reader_report(reader, key->node, "`%s` takes a mapping", key->name);
    else if (key->type == KEY_MAPPING_OR_TEXT && !fy_node_is_mapping(key->node) &&
             (!fy_node_is_scalar(key->node) || !*fy_node_get_scalar0(key->node)))
        reader_report(reader, key->node, "`%s` takes a mapping or a name", key->name);
    else if (key->type == KEY_TEXT &&
             (!fy_node_is_scalar(key->node) || !*fy_node_get_scalar0(key->node)))
        reader_report(reader, key->node, "`%s` takes a text", key->name);
    else if (key->type == KEY_SEQUENCE && !fy_node_is_sequence(key->node))
        reader_report(reader, key->node, "`%s` takes a sequence", key->name);
}

void reader_mapping(struct reader *reader, struct fy_node *mapping, struct fy_node *place,
                    const char *owner, struct key *keys, size_t count)
{
    EACH_PAIR(pair, mapping) {
        struct fy_node *name_node = fy_node_pair_key(pair);
        const char *name =
            name_node && fy_node_is_scalar(name_node) ? fy_node_get_scalar0(name_node) : NULL;
        struct key *key = NULL;
        for (size_t i = 0; name && i < count; i++)
            if (strcmp(name, keys[i].name) == 0)
                key = &keys[i];
        if (!key) {
            report_unknown_key(reader, name_node ? name_node : mapping, name ? name : "?", keys,
                               count);
            continue;
        }
        key->name_node = name_node;
        key->node = fy_node_pair_value(pair);
        key->given = key->node;
        if (key->node)
            read_value(reader, key);
        else
            reader_report(reader, name_node, "`%s` has no value", name);
    }
    for (size_t i = 0; i < count; i++)
        if (keys[i].required && !keys[i].node)
            reader_report(reader, place, "%s lacks the key `%s`", owner, keys[i].name);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static void read_document(struct reader *reader, const struct file_kind *kind, void *user)
{
    struct fy_document *document = yaml_parse(&reader->source, reader->diag);
    struct fy_node *root = document ? fy_document_root(document) : NULL;
    if (root && fy_node_is_mapping(root))
        kind->read(reader, root, user);
    else if (document)
        reader_report(reader, root, "a %s file is a mapping with the keys %s", kind->name,
                      kind->keys);
    if (document)
        fy_document_destroy(document);
}

bool reader_file(const char *path, const struct file_kind *kind, void *user,
                 const struct dt_log *log)
{
    const char *reason = "out of memory";
    struct reader reader = {.source.path = path, .diag = diag_create()};
    char *text = reader.diag ? input_read(path, MOST_BYTES, &reader.source.length, &reason) : NULL;
    bool good = text;
    reader.source.text = text;
    if (good) {
        read_document(&reader, kind, user);
        diag_report(reader.diag, log);
        good = diag_error_count(reader.diag) == 0;
    } else {
        report_error(log, "cannot open %s file %s: %s", kind->name, path, reason);
    }
    diag_free(reader.diag);
    free(text);
    return good;
}
