/* The documents of a spec: the spec and the files that it includes. Each is parsed once, depth
 * first. read_group.c adds instances. */
#include <stdlib.h>
#include <string.h>

#include "reader.h"

enum { MOST_DOCUMENTS = 64 };

/* ---- Lookup ---------------------------------------------------------------------------------- */

const struct source *node_source(const struct reader *reader, struct fy_node *node)
{
    const struct fy_document *yaml = node ? fy_node_document(node) : NULL;
    for (const struct document *at = reader->spec.next; at; at = at->next)
        if (at->yaml == yaml)
            return at->source;
    return reader->spec.source;
}

/* Whether the path begins with the entry's name, no shorter than that of `ends`; see root_with. */
static bool begins(struct reader *reader, struct fy_node *node, const char *name, const char *path,
                   size_t ends[3])
{
    const char *full = name ? declared_name(reader, node, name) : NULL;
    size_t length = full ? strlen(full) : 0;
    if (!length || length < ends[2] || strncmp(path, full, length) || !strchr(".=", path[length]))
        return false;
    ends[0] = (size_t)(strstr(full, name) - full);
    ends[1] = ends[0] + strlen(name);
    ends[2] = length;
    return true;
}

struct fy_node *root_with(struct reader *reader, const char *section, const char *path,
                          size_t ends[3])
{
    struct fy_node *found = NULL, *first = NULL;
    const struct document *at = &reader->spec;
    do {
        struct fy_node *root = fy_document_root(at->yaml);
        struct fy_node *value = map_value(root, section);
        if (value && !first)
            first = root;
        EACH_PAIR(pair, value)
            if (begins(reader, root, pair_name(reader, pair), path, ends))
                found = root;
        EACH_ITEM(item, value)
            if (has_own_name(item) && begins(reader, root, element_name(reader, item), path, ends))
                found = root;
    } while ((at = at->next));
    return found ? found : first ? first : fy_document_root(reader->spec.yaml);
}

/* ---- Parsing --------------------------------------------------------------------------------- */

static bool read_includes(struct reader *reader, struct document *document);

/* Parses a file and the files that it includes; false: a file cannot be used, which is reported. */
static bool read_source(struct reader *reader, const struct source *source, struct document *parent,
                        struct fy_node *entry)
{
    struct document *document = parent ? reader_alloc(reader, 1, sizeof *document) : &reader->spec;
    struct document *last = &reader->spec;
    struct fy_document *yaml = document ? yaml_parse(source, reader->diag) : NULL;
    struct fy_node *root = yaml ? fy_document_root(yaml) : NULL;
    if (!root || fy_node_get_type(root) != FYNT_MAPPING) {
        if (!yaml)
            return false;
        diag_error(reader->diag, (struct loc){.source = source},
                   parent ? "an included file is a map with sections of a spec"
                          : "a spec is a map that starts with `pipeline: NAME`");
        fy_document_destroy(yaml);
        return false;
    }
    char *real = realpath(source->path, NULL);
    *document = (struct document){.source = source, .yaml = yaml, .parent = parent, .entry = entry};
    document->real = arena_strndup(reader->model->arena, real ? real : source->path,
                                   strlen(real ? real : source->path));
    free(real);
    while (last->next)
        last = last->next;
    last->next = parent ? document : NULL;
    return read_includes(reader, document);
}

/* ---- Includes -------------------------------------------------------------------------------- */

/* The file, found beside the including one or among the templates; NULL: reported. */
static struct source *find_file(struct reader *reader, const struct document *from,
                                const char *name, struct loc loc)
{
    struct model *model = reader->model;
    const char *paths[2], *reason = "";
    for (int place = 0; place < 2; place++) {
        paths[place] = source_candidate(model, from->source->path, name, strlen(name), place);
        const struct source *found =
            paths[place] ? source_read(model, paths[place], &reason) : NULL;
        struct source *own = found ? arena_alloc(model->arena, sizeof *own) : NULL;
        if (!own)
            continue;
        *own = *found;
        own->included = loc;
        return own;
    }
    diag_error(reader->diag, loc,
               "cannot read the included file `%s`: looked for `%s` and `%s`: %s", name,
               paths[0] ? paths[0] : "?", paths[1] ? paths[1] : "?", reason);
    return NULL;
}

/* entry: the element of `passes` that includes the file; NULL: `include` does. */
static bool include(struct reader *reader, struct document *from, const char *name, struct loc loc,
                    struct fy_node *entry)
{
    uint32_t count = 0;
    if (!name || !*name)
        return diag_error(reader->diag, loc, "expected a file name");
    struct source *source = find_file(reader, from, name, loc);
    char *real = source ? realpath(source->path, NULL) : NULL;
    const struct document *same = NULL;
    for (const struct document *at = &reader->spec; real && at; at = at->next, count++)
        if (!strcmp(at->real, real))
            same = at;
    free(real);
    if (!source)
        return false;
    for (const struct document *at = from; same && at; at = at->parent)
        if (at == same)
            return diag_error(reader->diag, loc, "`%s` includes itself", same->source->path);
    if (same && entry) {
        diag_error(reader->diag, loc, "`%s` is already included; its passes cannot run twice",
                   source->path);
        diag_note(reader->diag, same->source->included, "first here");
    }
    if (same)
        return !entry;
    if (count < MOST_DOCUMENTS)
        return read_source(reader, source, from, entry);
    return diag_error(reader->diag, loc, "a spec has at most %d files", MOST_DOCUMENTS);
}

bool is_include(struct fy_node *item)
{
    return fy_node_get_type(item) == FYNT_MAPPING && yaml_pair(item, "include", FY_NT);
}

static bool read_includes(struct reader *reader, struct document *document)
{
    struct fy_node *files = section_of(document, "include");
    struct fy_node *passes = section_of(document, "passes");
    bool good = true;
    EACH_ITEM(item, files)
        good &= include(reader, document, node_text(reader, item), node_loc(reader, item), NULL);
    EACH_ITEM(item, passes) {
        struct fields fields;
        if (!is_include(item))
            continue;
        good &= fields_read(reader, item, SECTION_PASS_INCLUDE, node_loc(reader, item), &fields) &&
                field_node(&fields, "include") &&
                include(reader, document, field_text(reader, &fields, "include"),
                        field_loc(reader, &fields, "include"), item);
    }
    return good;
}

bool documents_load(struct reader *reader, const struct source *source)
{
    return read_source(reader, source, NULL, NULL);
}

bool documents_add(struct reader *reader, const char *name, struct loc loc)
{
    return include(reader, &reader->spec, name, loc, NULL);
}

/* ---- Sections -------------------------------------------------------------------------------- */

/* Keys that say something of the pipeline as a whole. */
static void refuse_spec_keys(struct reader *reader, const struct document *document)
{
    static const char *const keys[] = {"pipeline", "exactness", "target"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(keys); i++)
        if (field_node(&document->fields, keys[i]))
            key_error(reader, &document->fields, keys[i],
                      "`%s` belongs into the spec, not into an included file", keys[i]);
}

const struct fields *documents_fields(struct reader *reader)
{
    struct document *spec = &reader->spec;
    bool has_passes = false;
    struct document *at = spec;
    do {
        struct loc start = {.source = at->source, .line = 1, .column = 1, .length = 1};
        fields_read(reader, fy_document_root(at->yaml), SECTION_TOP, start, &at->fields);
        at->fields.next = at->next ? &at->next->fields : NULL;
        has_passes |= field_given(&at->fields, "passes");
        if (at != spec && !at->scope)
            refuse_spec_keys(reader, at);
    } while ((at = at->next));
    if (!field_given(&spec->fields, "pipeline"))
        diag_error(reader->diag, spec->fields.loc, "the spec needs the key `pipeline`");
    if (!has_passes)
        diag_error(reader->diag, spec->fields.loc, "the spec needs the key `passes`");
    return &spec->fields;
}

static void add_document_passes(const struct reader *reader, const struct document *document,
                                struct fy_node **items, uint32_t *count)
{
    struct fy_node *list = field_node(&document->fields, "passes");
    for (const struct document *at = document->next; at; at = at->next)
        if (at->parent == document && !at->entry)
            add_document_passes(reader, at, items, count);
    EACH_ITEM(item, list) {
        bool stands = !is_include(item) && !is_use(item);
        for (const struct document *at = document->next; !stands && at; at = at->next)
            if (at->entry == item)
                add_document_passes(reader, at, items, count);
        if (stands && items)
            items[*count] = item;
        *count += stands;
    }
}

struct fy_node **documents_passes(struct reader *reader, uint32_t *count)
{
    struct fy_node **items;
    *count = 0;
    add_document_passes(reader, &reader->spec, NULL, count);
    items = reader_alloc(reader, *count, sizeof *items);
    *count = 0;
    if (items)
        add_document_passes(reader, &reader->spec, items, count);
    return items;
}

void documents_free(struct reader *reader)
{
    for (struct document *at = &reader->spec; at; at = at->next)
        if (at->yaml)
            fy_document_destroy(at->yaml);
}
