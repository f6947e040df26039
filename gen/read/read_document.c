/* Nodes of the documents: their locations, and `--set`, which replaces some. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "reader.h"
#include "base/nearest.h"

/* ---- Nodes and places ------------------------------------------------------------------------ */

static const struct override *find_override(const struct reader *reader, struct fy_node *node)
{
    for (; node; node = fy_node_get_parent(node))
        for (size_t i = 0; i < reader->override_count; i++)
            if (reader->overrides[i].node == node)
                return &reader->overrides[i];
    return NULL;
}

struct loc node_loc(const struct reader *reader, struct fy_node *node)
{
    struct fy_node *of =
        node ? fy_node_get_meta(node) : NULL; /* read_cull.c made the node for it */
    if (of)
        return node_loc(reader, of);
    struct loc loc = yaml_loc(node_source(reader, node), node);
    const struct override *override = find_override(reader, node);
    if (override) {
        loc.source = override->source;
        loc.column = override->column + (loc.line ? loc.column - 1 : 0);
        loc.line = 1;
    }
    return loc;
}

struct fy_node *map_value(struct fy_node *map, const char *key)
{
    bool is_map = map && fy_node_get_type(map) == FYNT_MAPPING;
    struct fy_node_pair *pair = is_map ? yaml_pair(map, key, FY_NT) : NULL;
    return pair ? fy_node_pair_value(pair) : NULL;
}

struct fy_node *section_of(const struct document *document, const char *key)
{
    return map_value(fy_document_root(document->yaml), key);
}

int list_count(struct fy_node *list)
{
    return list ? fy_node_sequence_item_count(list) : 0;
}

const char *pair_name(struct reader *reader, struct fy_node_pair *pair)
{
    return key_text(reader, fy_node_pair_key(pair));
}

const char *key_text(struct reader *reader, struct fy_node *node)
{
    if (!node || fy_node_get_type(node) != FYNT_SCALAR)
        return NULL;
    size_t length = 0;
    const char *text = fy_node_get_scalar(node, &length);
    return arena_strndup(reader->model->arena, text ? text : "", text ? length : 0);
}

const char *node_text(struct reader *reader, struct fy_node *node)
{
    const char *text = key_text(reader, node);
    return text ? filled_text(reader, node, text) : NULL;
}

const char *element_name(struct reader *reader, struct fy_node *item)
{
    return key_text(reader, map_value(item, "name"));
}

bool is_identifier(const char *text)
{
    if (!isalpha((unsigned char)*text) && *text != '_')
        return false;
    while (isalnum((unsigned char)*text) || *text == '_')
        text++;
    return !*text;
}

bool is_path(const char *text)
{
    bool word = isalpha((unsigned char)*text) || *text == '_';
    for (; word && *text; text += *text == '.') {
        size_t length = 0;
        while (isalnum((unsigned char)text[length]) || text[length] == '_')
            length++;
        word = length && (!text[length] || (text[length] == '.' && text[length + 1]));
        text += length;
    }
    return word;
}

/* ---- Overrides ------------------------------------------------------------------------------- */

/* One `--set PATH=VALUE` while its path is followed. */
struct setting {
    struct source *source;
    const char *path; /* the rest of the path */
    const char *value;
    char segment[128];
    int column; /* of the segment */
    /* Bytes of the next segment if it contains dots, and of an instance's number behind it; else 0. */
    size_t take, skip;
};

static struct loc setting_loc(const struct setting *setting, int column, size_t length)
{
    return (struct loc){
        .source = setting->source, .line = 1, .column = column, .length = length ? (int)length : 1};
}

static struct loc segment_loc(const struct setting *setting)
{
    return setting_loc(setting, setting->column, strlen(setting->segment));
}

static bool next_segment(struct setting *setting)
{
    const char *end = setting->take ? setting->path + setting->take : strpbrk(setting->path, ".=");
    size_t length = end ? (size_t)(end - setting->path) : 0;
    if (!length || length >= sizeof setting->segment)
        return false;
    setting->column = (int)(setting->path - setting->source->text) + 1;
    memcpy(setting->segment, setting->path, length);
    setting->segment[length] = '\0';
    end += setting->skip;
    setting->take = setting->skip = 0;
    setting->path = *end == '.' ? end + 1 : end;
    return true;
}

static bool is_last(const struct setting *setting)
{
    return *setting->path == '=';
}

static struct fy_node *build_node(struct reader *reader, const struct setting *setting,
                                  struct fy_document *document, const char *text, int column,
                                  size_t length)
{
    bool sound = *text && !yaml_wrong_byte(text, length);
    struct fy_node *node = sound ? fy_node_build_from_string(document, text, length) : NULL;
    if (!node) {
        diag_error(reader->diag, setting_loc(setting, column, length),
                   "`--set %s`: `%s` is no YAML value", setting->source->text, text);
        return NULL;
    }
    size_t count = reader->override_count;
    struct override *overrides = realloc(reader->overrides, (count + 1) * sizeof *overrides);
    if (!overrides) {
        reader->out_of_memory = true;
        return NULL;
    }
    reader->overrides = overrides;
    overrides[count] = (struct override){node, setting->source, column, -1};
    reader->override_count++;
    return node;
}

/* The type of the parameter value that --set replaces, for the new value; -1: none. */
static int former_type(struct reader *reader, const struct key *key, struct fy_node *old)
{
    double value[4];
    uint32_t components;
    enum dt_type type;
    if (key->type != KEY_VALUE)
        return -1;
    for (size_t i = 0; i < reader->override_count; i++) /* --set of the same value again */
        if (reader->overrides[i].node == old)
            return reader->overrides[i].type;
    return param_value(reader, old, value, &components, &type) ? (int)type : -1;
}

/* Forgets the overrides at and below `node`, since replacing `node` frees them. */
static void forget_overrides(struct reader *reader, struct fy_node *node)
{
    for (size_t i = 0; i < reader->override_count; i++)
        if (reader->overrides[i].node == node)
            reader->overrides[i].node = NULL;
    EACH_ITEM(item, node)
        forget_overrides(reader, item);
    EACH_PAIR(pair, node) {
        forget_overrides(reader, fy_node_pair_key(pair));
        forget_overrides(reader, fy_node_pair_value(pair));
    }
}

/* Keeps the text of a replaced value, so that --set causes no warnings about unused names in it. */
static void remember_replaced(struct reader *reader, struct fy_node *old)
{
    struct model *model = reader->model;
    if (!old || fy_node_get_type(old) == FYNT_MAPPING)
        return;
    char *text = fy_emit_node_to_string(old, FYECF_MODE_FLOW_ONELINE);
    struct replaced *replaced = arena_alloc(model->arena, sizeof *replaced);
    const char *kept = text ? arena_strndup(model->arena, text, strlen(text)) : NULL;
    free(text);
    if (!replaced || !kept) {
        reader->out_of_memory = true;
        return;
    }
    *replaced = (struct replaced){.text = kept, .next = model->replaced};
    model->replaced = replaced;
}

static void replace_value(struct reader *reader, struct setting *setting, const struct key *key,
                          struct fy_node_pair *pair)
{
    struct fy_node *old = fy_node_pair_value(pair);
    struct fy_node_pair *inner = NULL;
    if (old && fy_node_get_type(old) == FYNT_MAPPING &&
        (key->child == SECTION_PARAM || key->child == SECTION_CONSTANT))
        inner = fy_node_mapping_lookup_pair_by_string(old, "value", FY_NT);
    if (inner) {
        replace_value(reader, setting, table_find(key->child, "value"), inner);
        return;
    }
    int type = former_type(reader, key, old);
    int column = (int)(setting->value - setting->source->text) + 1;
    struct fy_node *node = build_node(reader, setting, fy_node_document(fy_node_pair_key(pair)),
                                      setting->value, column, strlen(setting->value));
    if (!node)
        return;
    reader->overrides[reader->override_count - 1].type = type;
    forget_overrides(reader, old);
    remember_replaced(reader, old);
    if (fy_node_pair_set_value(pair, node))
        reader->out_of_memory = true;
}

/* Adds a key that the table has but the document lacks; returns its value, NULL after an error. */
static struct fy_node *add_value(struct reader *reader, struct setting *setting,
                                 struct fy_node *map, const char *text)
{
    size_t length = strlen(setting->segment);
    char *name = arena_strndup(reader->model->arena, setting->segment, length);
    struct fy_document *document = fy_node_document(map);
    struct fy_node *key =
        name ? build_node(reader, setting, document, name, setting->column, length) : NULL;
    int column = (int)(setting->value - setting->source->text) + 1;
    struct fy_node *value =
        key ? build_node(reader, setting, document, text, column, strlen(text)) : NULL;
    if (value && fy_node_mapping_append(map, key, value))
        reader->out_of_memory = true;
    return value;
}

enum { MOST_NAMES = 400 }; /* to suggest from */

static void report_path(struct reader *reader, const struct setting *setting, const char *where,
                        const char *const *names, size_t count)
{
    const char *nearest = nearest_name(setting->segment, names, count);
    for (const char *end = setting->path; !nearest && *end != '='; end += *end == '.') {
        end += strcspn(end, ".="); /* names of instances have dots */
        const char *longer = arena_printf(reader->model->arena, "%s.%.*s", setting->segment,
                                          (int)(end - setting->path), setting->path);
        nearest = longer ? nearest_name(longer, names, count) : NULL;
    }
    diag_error(reader->diag, segment_loc(setting), "`--set %s`: no `%s` in %s%s%s%s",
               setting->source->text, setting->segment, where, nearest ? "; did you mean `" : "",
               nearest ? nearest : "", nearest ? "`?" : "");
}

static size_t add_keys(struct reader *reader, struct fy_node *map, const char **names, size_t count)
{
    EACH_PAIR(pair, map)
        if (count < MOST_NAMES)
            names[count++] = declared_name(reader, map, node_text(reader, fy_node_pair_key(pair)));
    return count;
}

/* Suggests names from the keys of the map, from those of its section in other files, and from the
 * fixed keys of its section. */
static void report_unknown_setting(struct reader *reader, const struct setting *setting,
                                   struct fy_node *map, enum section section)
{
    const char *names[MOST_NAMES + 64];
    size_t count = add_keys(reader, map, names, 0);
    const struct document *at = &reader->spec;
    do {
        struct fy_node *other = section_of(at, table_sections[section].path);
        if (other != map)
            count = add_keys(reader, other, names, count);
    } while ((at = at->next));
    for (const struct key *key = table_section(section); key->name; key++)
        if (count < DT_ARRAY_COUNT(names) && strcmp(key->name, "*"))
            names[count++] = key->name;
    report_path(reader, setting, table_sections[section].title, names, count);
}

/* The element of a list of maps with this `name` or index. Suggests passes of all files. */
static struct fy_node *find_element(struct reader *reader, const struct setting *setting,
                                    struct fy_node *list)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    char *end;
    long number = strtol(setting->segment, &end, 10);
    if (!*end && number >= 0 && number < fy_node_sequence_item_count(list)) {
        struct fy_node *item = fy_node_sequence_get_by_index(list, (int)number);
        if (!is_use(item))
            return item;
        diag_error(reader->diag, segment_loc(setting),
                   "`--set %s`: element %ld is a use or a repeat; name one of its passes",
                   setting->source->text, number);
        return NULL;
    }
    EACH_ITEM(item, list) {
        const char *text = has_own_name(item) ? element_name(reader, item) : NULL;
        if (text && !strcmp(text, setting->segment))
            return item;
    }
    const struct document *at = &reader->spec;
    do {
        struct fy_node *passes = section_of(at, "passes");
        EACH_ITEM(item, passes)
            if (count < MOST_NAMES && element_name(reader, item) && !is_use(item))
                names[count++] = declared_name(reader, item, element_name(reader, item));
    } while ((at = at->next));
    report_path(reader, setting, "the list", names, count);
    return NULL;
}

static void apply_in_map(struct reader *reader, struct setting *setting, struct fy_node *map,
                         enum section section);

static void apply_below(struct reader *reader, struct setting *setting, const struct key *key,
                        struct fy_node *value)
{
    enum section section = key->child;
    if (value && key->type == KEY_LIST && fy_node_get_type(value) == FYNT_SEQUENCE) {
        if (!next_segment(setting))
            return;
        value = find_element(reader, setting, value);
        if (!value)
            return;
        if (is_last(setting)) {
            diag_error(reader->diag, segment_loc(setting),
                       "`--set %s`: `%s` is %s; name one of its keys", setting->source->text,
                       setting->segment, table_sections[section].title);
            return;
        }
    }
    if (section != SECTION_NONE && value && fy_node_get_type(value) == FYNT_MAPPING) {
        if (next_segment(setting))
            apply_in_map(reader, setting, value, section);
        return;
    }
    diag_error(reader->diag, segment_loc(setting), "`--set %s`: `%s` has no keys below it",
               setting->source->text, setting->segment);
}

/* --set cannot declare a name. It may add a contract: its name is declared as a resource. */
static void apply_in_map(struct reader *reader, struct setting *setting, struct fy_node *map,
                         enum section section)
{
    const struct key *key = table_find(section, setting->segment);
    struct fy_node_pair *pair = yaml_pair(map, setting->segment, FY_NT);
    bool declares = key && !strcmp(key->name, "*") && section != SECTION_CONTRACTS;
    bool opens = key && key->type != KEY_LIST && key->child == SECTION_CONTRACTS;
    bool inside = !is_last(setting) && !opens; /* what is to be there */
    if (!key || (!pair && declares))
        report_unknown_setting(reader, setting, map, section);
    else if (!pair && inside)
        diag_error(reader->diag, segment_loc(setting), "`--set %s`: the spec has no `%s` here",
                   setting->source->text, setting->segment);
    else if (!is_last(setting))
        apply_below(reader, setting, key,
                    pair ? fy_node_pair_value(pair) : add_value(reader, setting, map, "{}"));
    else if (pair)
        replace_value(reader, setting, key, pair);
    else
        add_value(reader, setting, map, setting->value);
}

static bool is_scalar_key(const char *name)
{
    const struct key *key = table_find(SECTION_TOP, name);
    return key && key->child == SECTION_NONE;
}

/* A bare name is a parameter, else a scalar of the top level such as `exactness`. */
static void apply_bare(struct reader *reader, struct setting *setting)
{
    size_t ends[3] = {0};
    struct fy_node *root = root_with(reader, "params", setting->segment, ends);
    struct fy_node *params = map_value(root, "params");
    if (params && fy_node_get_type(params) != FYNT_MAPPING)
        params = NULL;
    bool is_param = params && yaml_pair(params, setting->segment, FY_NT);
    if (!is_param && is_scalar_key(setting->segment))
        apply_in_map(reader, setting, root, SECTION_TOP);
    else if (is_param)
        apply_in_map(reader, setting, params, SECTION_PARAMS);
    else
        report_unknown_setting(reader, setting, params, SECTION_PARAMS);
}

/* The path goes on in the document that declares what its second segment names. */
static void apply_path(struct reader *reader, struct setting *setting)
{
    size_t ends[3] = {0}, of[3] = {0};
    struct fy_node *root = root_with(reader, setting->segment, setting->path, ends);
    if (!strcmp(setting->segment, "contracts") &&
        !ends[2]) /* of a resource, perhaps of an instance */
        for (int i = 0; i < 2 && !ends[2]; i++) {
            root_with(reader, i ? "images" : "buffers", setting->path, of);
            ends[1] = ends[2] = of[2];
        }
    setting->path += ends[0];
    setting->take = ends[1] - ends[0];
    setting->skip = ends[2] - ends[1];
    apply_in_map(reader, setting, root, SECTION_TOP);
}

/* Whether the path goes on below the `cull` of a pass of a file, NAME.cull. */
static bool sets_cull(struct reader *reader, const char *path)
{
    for (const struct document *at = &reader->spec; at; at = at->next) {
        struct fy_node *passes = at->scope ? NULL : section_of(at, "passes");
        EACH_ITEM(item, passes) {
            const char *name = element_name(reader, item);
            size_t length = name ? strlen(name) : 0;
            if (length && has_own_name(item) && is_culled(item) && !strncmp(path, name, length) &&
                !strncmp(path + length, ".cull", 5) && strchr(".=", path[length + 5]))
                return true;
        }
    }
    return false;
}

/* Whether it may decide which instances there are: a parameter, a constant of a file, or what a draw
 * keeps. */
static bool is_early(struct reader *reader, const struct setting *setting)
{
    size_t ends[3] = {0};
    return is_last(setting) || !strcmp(setting->segment, "params") ||
           (!strcmp(setting->segment, "passes") && sets_cull(reader, setting->path)) ||
           (!strcmp(setting->segment, "constants") &&
            root_with(reader, "constants", setting->path, ends) && ends[2] && !ends[0]);
}

enum { MOST_LEVELS = 16 };

static void apply_set(struct reader *reader, const char *text, bool early)
{
    struct source *source = reader_alloc(reader, 1, sizeof *source);
    if (!source)
        return;
    *source = (struct source){.path = "--set", .text = text, .length = strlen(text)};
    struct setting setting = {.source = source, .path = text, .column = 1};
    const char *equals = strchr(text, '=');
    bool well_formed = equals && equals > text && equals[1] && equals[-1] != '.' && *text != '.';
    unsigned levels = 0;
    for (const char *at = text; well_formed && at < equals - 1; at++) {
        well_formed = at[0] != '.' || at[1] != '.';
        levels += *at == '.';
    }
    if (!well_formed) {
        if (early)
            diag_error(reader->diag, setting_loc(&setting, 1, strlen(text)),
                       "`--set %s`: expected PATH=VALUE", text);
        return;
    }
    setting.value = equals + 1;
    bool fits = levels < MOST_LEVELS && next_segment(&setting);
    if ((!fits || is_early(reader, &setting)) != early)
        return;
    if (!fits)
        diag_error(reader->diag, setting_loc(&setting, 1, 1), "`--set %s`: the path is too long",
                   text);
    else if (!strcmp(setting.segment, "include") || !strcmp(setting.segment, "groups"))
        diag_error(reader->diag, segment_loc(&setting),
                   *setting.segment == 'i'
                       ? "`--set %s`: includes cannot be set"
                       : "`--set %s`: groups cannot be set; name an entry of an instance",
                   text);
    else if (is_last(&setting))
        apply_bare(reader, &setting);
    else
        apply_path(reader, &setting);
}

void document_set(struct reader *reader, const char *const *sets, size_t set_count, bool early)
{
    for (size_t i = 0; i < set_count; i++)
        apply_set(reader, sets[i], early);
}
