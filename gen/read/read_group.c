/* Instances: each use of a group, and each value of a repeat, becomes a document with a copy of
 * the sections and a scope of names. */
#include <string.h>

#include "reader.h"
#include "base/nearest.h"

enum { MOST_INSTANCES = 1024, MOST_CONSTANT_CHAIN = 64 };

/* An argument of a group, or the number of a repeat. */
struct binding {
    const char *name, *text;
    const struct scope *scope; /* names of `text` */
    struct loc loc;            /* of `text` */
    struct fy_node *at;        /* declares it */
};

struct scope {
    struct reader *reader;
    const struct scope *outer;   /* of a repeat: where it stands; a group: NULL */
    const char *prefix, *suffix; /* of the names that it declares */
    struct fy_node *root;        /* declares them; NULL: none that others may use */
    struct binding *bindings;
    uint32_t binding_count;
};

/* ---- Names ----------------------------------------------------------------------------------- */

const struct scope *node_scope(const struct reader *reader, struct fy_node *node)
{
    const struct fy_document *yaml = node ? fy_node_document(node) : NULL;
    for (const struct document *at = reader->spec.next; at; at = at->next)
        if (at->yaml == yaml)
            return at->scope;
    return NULL;
}

static const char *full_name(const struct scope *scope, const char *name)
{
    int first = (int)strcspn(name, ".");
    return scope ? arena_printf(scope->reader->model->arena, "%s%.*s%s%s", scope->prefix, first,
                                name, scope->suffix, name + first)
                 : name;
}

const char *declared_name(struct reader *reader, struct fy_node *node, const char *name)
{
    return name ? full_name(node_scope(reader, node), name) : NULL;
}

/* Whether one of the passes, or of those in a repeat among them, has this name. */
static bool list_declares(struct fy_node *passes, const char *word, size_t length)
{
    static const char *const keys[] = {"name", "as"};
    EACH_ITEM(item, passes) {
        for (int i = 0; i < 2; i++) {
            struct fy_node *name = map_value(item, keys[i]);
            size_t own = 0;
            const char *text = name ? fy_node_get_scalar(name, &own) : NULL;
            if (text && own == length && !strncmp(text, word, length))
                return true;
        }
        if (list_declares(map_value(item, "passes"), word, length))
            return true;
    }
    return false;
}

/* Whether the scope's sections have an entry of this name. */
static bool declares(const struct scope *scope, const char *word, size_t length)
{
    if (!scope->root)
        return false;
    static const char *const sections[] = {"constants", "buffers", "images"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(sections); i++) {
        struct fy_node *map = map_value(scope->root, sections[i]);
        if (map && fy_node_get_type(map) == FYNT_MAPPING && yaml_pair(map, word, length))
            return true;
    }
    return list_declares(map_value(scope->root, "passes"), word, length);
}

static const struct binding *find_binding(const struct scope *scope, const char *word,
                                          size_t length)
{
    for (uint32_t i = 0; i < scope->binding_count; i++)
        if (strlen(scope->bindings[i].name) == length &&
            !strncmp(scope->bindings[i].name, word, length))
            return &scope->bindings[i];
    return NULL;
}

static bool find_text(const void *user, const char *name, struct expr_text *text)
{
    size_t length = strcspn(name, ".");
    for (const struct scope *scope = user; scope; scope = scope->outer) {
        const struct binding *binding = find_binding(scope, name, length);
        if (binding) {
            text->text = name[length] ? arena_printf(scope->reader->model->arena, "%s%s",
                                                     binding->text, name + length)
                                      : binding->text;
            text->names = (struct expr_names){binding->scope ? find_text : NULL, binding->scope};
            return text->text != NULL;
        }
        if (declares(scope, name, length)) {
            text->text = full_name(scope, name);
            return text->text != NULL;
        }
    }
    return false;
}

/* A name as the whole pipeline knows it. */
static const char *global_name(const struct scope *scope, const char *name)
{
    struct expr_text text = {0};
    while (scope && find_text(scope, name, &text)) {
        name = text.text;
        scope = text.names.find ? text.names.scope : NULL;
        text = (struct expr_text){0};
    }
    return name;
}

const char *referred_name(struct reader *reader, struct fy_node *node)
{
    const char *text = node_text(reader, node);
    return text ? node_word(reader, node, text) : NULL;
}

const char *node_word(struct reader *reader, struct fy_node *node, const char *word)
{
    return global_name(node_scope(reader, node), word);
}

const char *argument_text(struct reader *reader, struct fy_node *node, struct loc *loc)
{
    const char *text = node_text(reader, node);
    if (text && loc)
        *loc = node_loc(reader, node);
    for (const struct scope *scope = node_scope(reader, node); text && scope;) {
        const struct binding *binding = find_binding(scope, text, strlen(text));
        text = binding ? binding->text : text;
        if (binding && loc)
            *loc = binding->loc;
        scope = binding ? binding->scope : scope->outer;
    }
    return text;
}

struct expr_names node_names(const struct reader *reader, struct fy_node *node)
{
    const struct scope *scope = node_scope(reader, node);
    return (struct expr_names){scope ? find_text : NULL, scope};
}

void each_word(struct reader *reader, struct fy_node *node,
               void (*visit)(void *user, const char *word, struct fy_node *at), void *user)
{
    for (const struct scope *scope = node_scope(reader, node); scope; scope = scope->outer) {
        struct fy_node *constants = scope->root ? map_value(scope->root, "constants") : NULL;
        for (uint32_t i = 0; i < scope->binding_count; i++)
            visit(user, scope->bindings[i].name, scope->bindings[i].at);
        EACH_PAIR(pair, constants)
            if (pair_name(reader, pair))
                visit(user, pair_name(reader, pair), fy_node_pair_key(pair));
    }
}

/* ---- Values that are known while reading ----------------------------------------------------- */

/* Folds the constants that depend on baked parameters alone. */
static void fold_constants(struct pipeline *values, const struct pipeline *all, struct diag *diag)
{
    bool more = true;
    for (int round = 0; more && round < MOST_CONSTANT_CHAIN; round++) {
        more = false;
        CHANGE_EACH(from, all->constants, all->constant_count) {
            if (from->folds || !from->value || !expr_resolve(from->value, values, diag) ||
                expr_reach(from->value) != EXPR_BAKED ||
                expr_eval(from->value, 0, 0, &from->folded) != EXPR_OK)
                continue;
            from->folds = more = true;
            values->constants[values->constant_count++] = *from;
        }
    }
}

/* Parameters and constants of all documents so far. Errors are reported later, by read.c. */
static bool read_known_values(struct reader *reader)
{
    struct model *model = reader->model;
    struct diag *diag = reader->diag;
    struct pipeline saved = model->pipeline;
    reader->diag = diag_create();
    reader->all = reader_alloc(reader, 1, sizeof *reader->all);
    reader->values = reader_alloc(reader, 1, sizeof *reader->values);
    bool good = reader->diag && reader->all && reader->values;
    if (good) {
        const struct fields *top = documents_fields(reader);
        model->pipeline = (struct pipeline){0};
        read_params(reader, top);
        read_constants(reader, top);
        *reader->all = *reader->values = model->pipeline;
        reader->values->constants =
            reader_alloc(reader, reader->all->constant_count, sizeof *reader->values->constants);
        reader->values->constant_count = 0;
        good = reader->values->constants;
        if (good)
            fold_constants(reader->values, reader->all, reader->diag);
    }
    diag_free(reader->diag);
    reader->diag = diag;
    model->pipeline = saved;
    return good;
}

/* The place of a part of a scalar. */
static struct loc part_loc(const struct reader *reader, struct fy_node *node, size_t begin,
                           size_t length)
{
    struct loc loc = node_loc(reader, node);
    if ((size_t)loc.length < begin + length) /* in several lines */
        return loc;
    loc.column += (int)begin;
    loc.length = length ? (int)length : 1;
    return loc;
}

/* False after an error at `loc`. */
static bool evaluate_argument(struct reader *reader, const struct scope *scope, const char *text,
                              struct loc loc, int64_t *value)
{
    struct expr_names names = {scope ? find_text : NULL, scope};
    if (!reader->values && !read_known_values(reader))
        return false;
    struct expr *expr = expr_parse(reader->model, text, loc, &names, reader->diag);
    struct diag *silent = diag_create();
    bool known = expr && silent && expr_resolve(expr, reader->values, silent);
    diag_free(silent);
    if (!expr || (!known && !expr_resolve(expr, reader->all, reader->diag)))
        return false;
    if (!known || expr_reach(expr) != EXPR_BAKED || expr_eval(expr, 0, 0, value) != EXPR_OK)
        return diag_error(reader->diag, loc,
                          "`%s` must be an integer over baked parameters and their constants",
                          text);
    return true;
}

const char *filled_text(struct reader *reader, struct fy_node *node, const char *text)
{
    const struct scope *scope = text && strchr(text, '{') ? node_scope(reader, node) : NULL;
    const char *start = text;
    struct text out = {0};
    if (!scope)
        return text;
    for (const char *end; *text; text = end) {
        size_t plain = strcspn(text, "{");
        int64_t value;
        text_add_bytes(&out, text, plain);
        end = text[plain] ? strchr(text + plain, '}') : text + plain;
        if (!text[plain])
            continue;
        size_t begin = (size_t)(text - start) + plain;
        size_t length = end ? (size_t)(end - start) - begin - 1 : 0;
        const char *inner =
            end ? arena_strndup(reader->model->arena, start + begin + 1, length) : NULL;
        if (!end)
            diag_error(reader->diag, part_loc(reader, node, begin, 1), "`{` without `}`");
        if (!inner || !evaluate_argument(reader, scope, inner,
                                         part_loc(reader, node, begin + 1, length), &value)) {
            text_free(&out);
            reader->unfilled = true;
            return "_"; /* valid as a name and as an expression, so that no other error follows */
        }
        text_add(&out, "%lld", (long long)value);
        end++;
    }
    const char *filled = arena_strndup(reader->model->arena, out.data ? out.data : "", out.length);
    text_free(&out);
    return filled;
}

/* ---- Instances ------------------------------------------------------------------------------- */

struct scope *add_instance(struct use *use, struct fy_document *yaml, struct fy_node *root,
                           struct fy_node *of, const char *label)
{
    struct reader *reader = use->reader;
    struct document *document = reader_alloc(reader, 1, sizeof *document), *last = &reader->spec;
    struct scope *scope = reader_alloc(reader, 1, sizeof *scope);
    struct source *source = reader_alloc(reader, 1, sizeof *source);
    if (!document || !scope || !source || !root || fy_document_set_root(yaml, root)) {
        reader->out_of_memory = true;
        fy_node_free(root);
        fy_document_destroy(yaml);
        return NULL;
    }
    *source = *node_source(reader, of);
    if (label) {
        source->included = node_loc(reader, use->item);
        source->use = label;
    }
    *scope = (struct scope){.reader = reader, .prefix = "", .suffix = "", .root = root};
    *document = (struct document){.source = source,
                                  .yaml = yaml,
                                  .real = "",
                                  .parent = use->from,
                                  .entry = use->item,
                                  .scope = scope,
                                  .group = of};
    while (last->next)
        last = last->next;
    last->next = document;
    reader->values = NULL;
    if (reader->instance_count++ < MOST_INSTANCES)
        return scope;
    node_error(reader, use->item, "groups and repeats make more than %d instances", MOST_INSTANCES);
    return NULL;
}

struct fy_node *node_remove(struct fy_node *map, const char *key)
{
    struct fy_node_pair *pair = yaml_pair(map, key, FY_NT);
    return pair ? fy_node_mapping_remove_by_key(map, fy_node_pair_key(pair)) : NULL;
}

void scope_hide(struct scope *scope)
{
    scope->root = NULL;
}

bool scope_set(struct scope *scope, const struct scope *outer, const char *suffix, const char *name,
               const char *number, struct fy_node *at)
{
    struct reader *reader = scope->reader;
    struct binding *binding = reader_alloc(reader, 1, sizeof *binding);
    scope->outer = outer;
    scope->prefix = outer ? outer->prefix : "";
    scope->suffix = arena_printf(reader->model->arena, "%s%s", outer ? outer->suffix : "", suffix);
    if (!binding || !scope->suffix || !number)
        return false;
    *binding = (struct binding){.name = name, .text = number, .at = at};
    scope->bindings = binding;
    scope->binding_count = 1;
    return true;
}

/* ---- Repeats --------------------------------------------------------------------------------- */

/* A copy of the element as a document's root: {passes: [element]}, or the passes that it lists. */
static struct fy_node *copy_repeated(struct fy_document *yaml, struct fy_node *item)
{
    struct fy_node *copy = fy_node_copy(yaml, item);
    if (!copy)
        return NULL;
    fy_node_free(node_remove(copy, "repeat"));
    if (map_value(copy, "passes"))
        return copy;
    struct fy_node *root = fy_node_create_mapping(yaml), *list = fy_node_create_sequence(yaml),
                   *key = fy_node_create_scalar(yaml, "passes", FY_NT);
    if (root && list && key && !fy_node_sequence_append(list, copy) &&
        !fy_node_mapping_append(root, key, list))
        return root;
    return NULL;
}

/* Parses `NAME in FIRST .. LAST`. */
static bool read_span(struct reader *reader, struct fy_node *item, const char **name,
                      int64_t span[2])
{
    struct arena *arena = reader->model->arena;
    const struct scope *scope = node_scope(reader, item);
    struct fy_node *node = map_value(item, "repeat");
    struct loc loc = node_loc(reader, node);
    const char *text = node_text(reader, node);
    size_t length =
        text ? strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") : 0;
    const char *dots = text ? strstr(text, "..") : NULL;
    if (text)
        *name = arena_strndup(arena, text, length);
    if (!dots || strncmp(text + length, " in ", 4) || !*name || !is_identifier(*name))
        return diag_error(reader->diag, loc, "`repeat` must be NAME in FIRST .. LAST");
    const char *begin = text + length + 4, *end = dots;
    while (end > begin && end[-1] == ' ')
        end--;
    const char *first = arena_strndup(arena, begin, (size_t)(end - begin));
    const char *last = dots + 2 + strspn(dots + 2, " ");
    struct loc first_loc = part_loc(reader, node, length + 4, (size_t)(end - begin));
    if (!first || !evaluate_argument(reader, scope, first, first_loc, &span[0]) ||
        !evaluate_argument(reader, scope, last,
                           part_loc(reader, node, (size_t)(last - text), strlen(last)), &span[1]))
        return false;
    return (span[0] >= 0 && span[0] <= INT32_MAX) ||
           diag_error(reader->diag, first_loc, "the first number is %lld; at least 0, at most %d",
                      (long long)span[0], INT32_MAX);
}

static bool expand_repeat(struct use *use)
{
    struct reader *reader = use->reader;
    struct arena *arena = reader->model->arena;
    const struct scope *outer = node_scope(reader, use->item);
    const char *name = NULL;
    int64_t span[2];
    struct loc loc = node_loc(reader, use->item);
    if (map_value(use->item, "passes") &&
        !fields_read(reader, use->item, SECTION_REPEAT, loc, &use->fields))
        return true;
    if (!map_value(use->item, "passes") && fy_node_mapping_item_count(use->item) == 1)
        diag_error(reader->diag, loc, "a repeat needs the key `passes`");
    if (!read_span(reader, use->item, &name, span))
        return true;
    if (span[1] > span[0] && span[1] - span[0] >= MOST_INSTANCES)
        span[1] = span[0] + MOST_INSTANCES;
    for (int64_t k = span[0]; k <= span[1]; k++) {
        struct fy_document *yaml = fy_document_create(NULL);
        struct scope *scope =
            add_instance(use, yaml, yaml ? copy_repeated(yaml, use->item) : NULL, use->item,
                         arena_printf(arena, "here with %s = %lld", name, (long long)k));
        const char *suffix = arena_printf(arena, ".%lld", (long long)k);
        if (!scope || !suffix ||
            !scope_set(scope, outer, suffix, name, suffix + 1, map_value(use->item, "repeat")))
            return false;
    }
    return true;
}

/* ---- Groups ---------------------------------------------------------------------------------- */

static struct fy_node *find_group(struct use *use)
{
    struct reader *reader = use->reader;
    const char *name = field_text(reader, &use->fields, "group"), *names[64];
    size_t count = 0;
    const struct document *at = &reader->spec;
    if (!name)
        return NULL;
    do {
        struct fy_node *groups = section_of(at, "groups");
        struct fy_node *group = map_value(groups, name);
        if (group)
            return group;
        EACH_PAIR(pair, groups)
            if (count < DT_ARRAY_COUNT(names) && pair_name(reader, pair))
                names[count++] = pair_name(reader, pair);
    } while ((at = at->next));
    key_error(reader, &use->fields, "group", "unknown group `%s`%s", name,
              name_hint('`', name, names, count, "").text);
    return NULL;
}

static void report_unknown_arguments(struct use *use, const struct scope *scope,
                                     struct fy_node *with)
{
    struct reader *reader = use->reader;
    const char *names[64];
    size_t count = 0;
    while (count < DT_ARRAY_COUNT(names) && count < scope->binding_count) {
        names[count] = scope->bindings[count].name;
        count++;
    }
    EACH_PAIR(pair, with) {
        const char *name = pair_name(reader, pair);
        if (!name || find_binding(scope, name, strlen(name)))
            continue;
        node_error(reader, fy_node_pair_key(pair), "the group has no argument `%s`%s", name,
                   name_hint('`', name, names, count, "").text);
    }
}

/* Gives the group's arguments their texts. */
static void bind_arguments(struct use *use, struct scope *scope, struct fy_node *args)
{
    struct reader *reader = use->reader;
    struct fy_node *with = field_node(&use->fields, "with");
    size_t count = args ? (size_t)fy_node_sequence_item_count(args) : 0;
    scope->bindings = reader_alloc(reader, count, sizeof *scope->bindings);
    EACH_ITEM(item, scope->bindings ? args : NULL) {
        const char *name = key_text(reader, item);
        if (!name || !is_identifier(name)) {
            node_error(reader, item, "an argument must be a name");
            continue;
        }
        struct fy_node_pair *own = with ? yaml_pair(with, name, FY_NT) : NULL;
        struct fy_node *value = own ? fy_node_pair_value(own) : NULL;
        const char *text = node_text(reader, value);
        if (value && (!text || !*text))
            node_error(reader, text ? fy_node_pair_key(own) : value,
                       "the argument `%s` must be a name or an expression", name);
        else if (!value && (with || !field_given(&use->fields, "with")))
            node_error(reader, use->item, "the group needs the argument `%s`", name);
        scope->bindings[scope->binding_count++] = (struct binding){
            name, text, node_scope(reader, use->item), node_loc(reader, value), item};
    }
    if (scope->bindings)
        report_unknown_arguments(use, scope, with);
}

/* Whether another use has this name, which it reports. */
static bool is_used_twice(struct use *use, const char *name)
{
    struct reader *reader = use->reader;
    size_t length = strlen(name);
    for (const struct document *at = reader->spec.next; at; at = at->next) {
        if (!at->scope || *at->scope->suffix || strncmp(at->scope->prefix, name, length) ||
            strcmp(at->scope->prefix + length, "."))
            continue;
        node_error(reader, use->item, "two uses are named `%s`; give one another name with `as`",
                   name);
        diag_note(reader->diag, at->source->included, "first here");
        return true;
    }
    return false;
}

static bool expand_group(struct use *use)
{
    struct reader *reader = use->reader;
    struct arena *arena = reader->model->arena;
    const struct scope *outer = node_scope(reader, use->item);
    struct loc loc = node_loc(reader, use->item);
    if (!fields_read(reader, use->item, SECTION_USE, loc, &use->fields))
        return true;
    struct fy_node *group = find_group(use);
    struct fields sections;
    if (!group || !fields_read(reader, group, SECTION_GROUP, loc, &sections))
        return true;
    for (const struct document *at = use->from; at; at = at->parent)
        if (at->group == group) {
            diag_error(reader->diag, loc, "the group `%s` uses itself",
                       field_text(reader, &use->fields, "group"));
            return true;
        }
    const char *as =
        field_text(reader, &use->fields, field_node(&use->fields, "as") ? "as" : "group");
    const char *name = as ? full_name(outer, as) : NULL;
    if (!name || is_used_twice(use, name))
        return name || !as;
    struct fy_document *yaml = fy_document_create(NULL);
    struct scope *scope = add_instance(use, yaml, yaml ? fy_node_copy(yaml, group) : NULL, group,
                                       arena_printf(arena, "here as `%s`", name));
    if (!scope)
        return false;
    fy_node_free(node_remove(scope->root, "args"));
    fy_node_free(node_remove(scope->root, "doc"));
    scope->prefix = arena_printf(arena, "%s.", name);
    bind_arguments(use, scope, field_node(&sections, "args"));
    return scope->prefix;
}

int group_exactness(struct reader *reader, struct fy_node *node)
{
    for (const struct scope *at = node_scope(reader, node); at; at = at->outer) {
        struct fy_node *value = at->root ? map_value(at->root, "exactness") : NULL;
        const char *text = value ? node_text(reader, value) : NULL;
        if (text)
            return table_choice(table_find(SECTION_GROUP, "exactness")->choices, text);
    }
    return -1;
}

bool is_use(struct fy_node *item)
{
    return map_value(item, "repeat") || map_value(item, "group") || is_culled(item);
}

bool has_own_name(struct fy_node *item)
{
    return !is_use(item) ||
           (is_culled(item) && !map_value(item, "repeat") && !map_value(item, "group"));
}

/* Errors in an unused group go unnoticed. Those of included files may be meant for other specs. */
static void warn_of_unused_groups(struct reader *reader)
{
    struct fy_node *groups = section_of(&reader->spec, "groups");
    EACH_PAIR(pair, groups) {
        const struct document *at = reader->spec.next;
        while (at && at->group != fy_node_pair_value(pair))
            at = at->next;
        if (!at && pair_name(reader, pair))
            diag_warning(reader->diag, node_loc(reader, fy_node_pair_key(pair)),
                         "the group `%s` is not used", pair_name(reader, pair));
    }
}

bool documents_expand(struct reader *reader)
{
    unsigned errors = diag_error_count(reader->diag);
    for (struct document *at = &reader->spec; at; at = at->next) {
        struct fy_node *passes = section_of(at, "passes");
        EACH_ITEM(item, passes) {
            struct use use = {.reader = reader, .from = at, .item = item};
            if (is_use(item) && !(map_value(item, "repeat")  ? expand_repeat(&use)
                                  : map_value(item, "group") ? expand_group(&use)
                                                             : expand_cull(&use)))
                return false;
            if (at->scope && is_include(item))
                node_error(reader, item, "`include` cannot stand in a group or repeat");
        }
    }
    if (diag_error_count(reader->diag) > errors)
        return false;
    warn_of_unused_groups(reader);
    return true;
}
