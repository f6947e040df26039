/* YAML documents and messages that point into them; see yaml.h. */
#include "base/yaml.h"

#include <stdlib.h>
#include <string.h>

#include "base/printable.h"

/* What a document is read from, and where its messages go. */
struct target {
    const struct source *source;
    struct diag *diag;
};

/* ---- Places ---------------------------------------------------------------------------------- */

/* Mappings and sequences have no token of their own. */
static struct fy_node *first_scalar(struct fy_node *node)
{
    while (node && fy_node_get_type(node) != FYNT_SCALAR) {
        void *iterator = NULL;
        if (fy_node_get_type(node) == FYNT_SEQUENCE)
            node = fy_node_sequence_iterate(node, &iterator);
        else
            node = fy_node_pair_key(fy_node_mapping_iterate(node, &iterator));
    }
    return node;
}

/* An empty mapping or sequence has the place of its key. */
static struct fy_node *key_of(struct fy_node *node)
{
    struct fy_node *parent = node ? fy_node_get_parent(node) : NULL;
    if (parent && fy_node_get_type(parent) == FYNT_MAPPING)
        EACH_PAIR(pair, parent)
            if (fy_node_pair_value(pair) == node)
                return fy_node_pair_key(pair);
    return NULL;
}

struct loc yaml_loc(const struct source *source, struct fy_node *node)
{
    struct loc place = {.source = source, .length = 1};
    struct fy_node *scalar = first_scalar(node);
    if (!scalar)
        node = scalar = key_of(node);
    struct fy_token *token = scalar ? fy_node_get_scalar_token(scalar) : NULL;
    const struct fy_mark *start = token ? fy_token_start_mark(token) : NULL;
    const struct fy_mark *end = token ? fy_token_end_mark(token) : NULL;
    if (!start)
        return place;
    place.line = start->line + 1;
    place.column = start->column + (fy_node_is_alias(scalar) ? 0 : 1); /* without the `*` */
    if (scalar == node && end && end->line == start->line && end->column > start->column)
        place.length = end->column - start->column;
    return place;
}

/* ---- Text ------------------------------------------------------------------------------------ */

const char *yaml_wrong_byte(const char *text, size_t length)
{
    size_t step = 1;
    for (const char *at = text; at < text + length; at += step) {
        step = *at == '\r' ? 1 : text_character(at);
        if (!step)
            return at;
    }
    return NULL;
}

/* Where a byte of the source stands. */
static struct loc loc_of(const struct source *source, const char *byte)
{
    struct loc loc = {source, 1, 1, 1};
    for (const char *at = source->text; at < byte; at++) {
        loc.column = *at == '\n' ? 1 : loc.column + ((*at & 0xc0) != 0x80);
        loc.line += *at == '\n';
    }
    return loc;
}

/* ---- Duplicate keys -------------------------------------------------------------------------- */

struct name {
    const char *text;
    size_t length;
    int index; /* of the pair in its mapping */
};

static int compare_texts(const struct name *x, const struct name *y)
{
    int order = memcmp(x->text, y->text, x->length < y->length ? x->length : y->length);
    return order ? order : (x->length > y->length) - (x->length < y->length);
}

static int compare_names(const void *a, const void *b)
{
    const struct name *x = a, *y = b;
    int order = compare_texts(x, y);
    return order ? order : (x->index > y->index) - (x->index < y->index);
}

static int compare_indices(const void *a, const void *b)
{
    const struct name *x = a, *y = b;
    return (x->index > y->index) - (x->index < y->index);
}

/* Reports the later ones of equal names, sorted by name and index; moves them to the front,
 * sorted by index. Returns their count. */
static size_t report_duplicates(struct fy_node_pair *const *pairs, struct name *names, size_t count,
                                const struct target *to)
{
    size_t found = 0, first = 0;
    for (size_t i = 1; i < count; i++) {
        if (compare_texts(&names[first], &names[i]) != 0) {
            first = i;
            continue;
        }
        diag_error(to->diag, yaml_loc(to->source, fy_node_pair_key(pairs[names[i].index])),
                   "the key `%.*s` stands twice", (int)names[i].length, names[i].text);
        diag_note(to->diag, yaml_loc(to->source, fy_node_pair_key(pairs[names[first].index])),
                  "first here");
        names[found++].index = names[i].index;
    }
    qsort(names, found, sizeof *names, compare_indices);
    return found;
}

static bool drop_duplicates(struct fy_node *node, const struct target *to);

static bool drop_in_mapping(struct fy_node *node, const struct target *to)
{
    size_t count = (size_t)fy_node_mapping_item_count(node), named = 0, all = 0;
    struct name *names = calloc(count + 1, sizeof *names);
    struct fy_node_pair **pairs = calloc(count + 1, sizeof *pairs), *pair;
    void *iterator = NULL;
    bool good = names && pairs;
    while (good && all < count && (pair = fy_node_mapping_iterate(node, &iterator))) {
        struct fy_node *key = fy_node_pair_key(pair);
        bool scalar = key && fy_node_get_type(key) == FYNT_SCALAR && !fy_node_is_alias(key);
        struct name name = {.index = (int)all};
        name.text = scalar ? fy_node_get_scalar(key, &name.length) : NULL;
        if (name.text)
            names[named++] = name;
        pairs[all++] = pair;
        good = drop_duplicates(fy_node_pair_value(pair), to);
    }
    if (good) {
        qsort(names, named, sizeof *names, compare_names);
        size_t found = report_duplicates(pairs, names, named, to);
        for (size_t i = found; i-- > 0;)
            fy_node_mapping_remove(node, pairs[names[i].index]);
    }
    free(names);
    free(pairs);
    return good;
}

/* false: out of memory. The parser limits the depth. */
static bool drop_duplicates(struct fy_node *node, const struct target *to)
{
    if (!node || fy_node_get_type(node) == FYNT_SCALAR)
        return true;
    if (fy_node_get_type(node) == FYNT_MAPPING)
        return drop_in_mapping(node, to);
    EACH_ITEM(item, node)
        if (!drop_duplicates(item, to))
            return false;
    return true;
}

/* ---- Syntax ---------------------------------------------------------------------------------- */

static void report_syntax(struct fy_diag *messages, const struct target *to)
{
    void *iterator = NULL;
    struct fy_diag_error *error;
    bool any = false;
    while ((error = fy_diag_errors_iterate(messages, &iterator))) {
        diag_error(to->diag, (struct loc){to->source, error->line, error->column, 1}, "YAML: %s",
                   error->msg);
        any = true;
    }
    if (!any)
        diag_error(to->diag, (struct loc){.source = to->source}, "YAML: the file has no content");
}

/* ---- Aliases --------------------------------------------------------------------------------- */

enum { MOST_DEPTH = 256 };

struct expansion {
    long count;            /* nodes that aliases add */
    struct fy_node *alias; /* the one that is followed */
    bool needed;           /* the document has an alias or a merge key */
};

static bool count_aliased(struct fy_node *node, int depth, bool aliased, struct expansion *e);

static bool follow(struct fy_node *alias, int depth, bool aliased, struct expansion *e)
{
    struct fy_node *target = fy_node_resolve_alias(alias); /* NULL: libfyaml reports it */
    e->needed = true;
    if (!aliased)
        e->alias = alias;
    return !target || target == alias ||
           (depth < MOST_DEPTH && count_aliased(target, depth + 1, true, e));
}

static bool is_merge(struct fy_node *key)
{
    size_t length = 0;
    bool scalar = key && fy_node_get_type(key) == FYNT_SCALAR && !fy_node_is_alias(key);
    const char *text = scalar ? fy_node_get_scalar(key, &length) : NULL;
    return text && length == 2 && !memcmp(text, "<<", 2);
}

/* False: a limit is passed. */
static bool count_aliased(struct fy_node *node, int depth, bool aliased, struct expansion *e)
{
    if (!node)
        return true;
    if (fy_node_is_alias(node))
        return follow(node, depth, aliased, e);
    e->count += aliased;
    if (e->count > YAML_MOST_ALIASED || depth > MOST_DEPTH)
        return false;
    if (fy_node_get_type(node) == FYNT_SEQUENCE)
        EACH_ITEM(item, node)
            if (!count_aliased(item, depth + 1, aliased, e))
                return false;
    if (fy_node_get_type(node) == FYNT_MAPPING)
        EACH_PAIR(pair, node) {
            e->needed |= is_merge(fy_node_pair_key(pair));
            if (!count_aliased(fy_node_pair_key(pair), depth + 1, aliased, e) ||
                !count_aliased(fy_node_pair_value(pair), depth + 1, aliased, e))
                return false;
        }
    return true;
}

/* fy_document_resolve takes time quadratic in the keys of a mapping: only where it is needed. */
static bool expand(struct fy_document *document, struct fy_diag *messages, const struct target *to)
{
    struct fy_node *root = fy_document_root(document);
    struct expansion e = {0};
    if (!count_aliased(root, 0, false, &e))
        return diag_error(to->diag, yaml_loc(to->source, e.alias ? e.alias : root),
                          "aliases add more than %d nodes, or nest more than %d deep",
                          YAML_MOST_ALIASED, MOST_DEPTH);
    if (!e.needed || !fy_document_resolve(document))
        return true;
    report_syntax(messages, to);
    return false;
}

/* ---- Parsing --------------------------------------------------------------------------------- */

static struct fy_document *parse_document(const struct source *source, struct fy_diag *messages,
                                          const struct target *to)
{
    struct fy_parse_cfg config = {.search_path = "",
                                  .flags =
                                      FYPCF_QUIET | FYPCF_COLLECT_DIAG | FYPCF_ALLOW_DUPLICATE_KEYS,
                                  .diag = messages};
    struct fy_document *document =
        fy_document_build_from_string(&config, source->text, source->length);
    bool good = document && drop_duplicates(fy_document_root(document), to);
    if (!document)
        report_syntax(messages, to);
    else if (!good)
        diag_error(to->diag, (struct loc){.source = to->source}, "out of memory");
    if (good && expand(document, messages, to))
        return document;
    fy_document_destroy(document);
    return NULL;
}

struct fy_node_pair *yaml_pair(struct fy_node *map, const char *name, size_t length)
{
    static const char letters[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.";
    size_t all = length == FY_NT ? strlen(name) : length;
    return strspn(name, letters) < all ? NULL
                                       : fy_node_mapping_lookup_pair_by_string(map, name, length);
}

struct fy_document *yaml_parse(const struct source *source, struct diag *diag)
{
    const struct target to = {source, diag};
    const char *wrong = yaml_wrong_byte(source->text, source->length);
    /* libfyaml 0.7.12 does not return from a directive with a byte that is no UTF-8. */
    if (wrong) {
        diag_error(diag, loc_of(source, wrong), "the byte 0x%02x is no UTF-8 text",
                   (unsigned char)*wrong);
        return NULL;
    }
    struct fy_diag_cfg config;
    fy_diag_cfg_default(&config);
    config.fp = NULL;
    struct fy_diag *messages = fy_diag_create(&config);
    if (!messages) {
        diag_error(diag, (struct loc){.source = source}, "out of memory");
        return NULL;
    }
    fy_diag_set_collect_errors(messages, true);
    struct fy_document *document = parse_document(source, messages, &to);
    fy_diag_unref(messages);
    return document;
}
