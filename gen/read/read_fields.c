/* Checks maps of the document against the table: known keys, required keys, valid values. Then
 * gives typed access. */
#include <math.h>
#include <string.h>

#include "reader.h"
#include "base/nearest.h"

void *reader_alloc(struct reader *reader, size_t count, size_t size)
{
    void *memory = arena_alloc(reader->model->arena, (count ? count : 1) * size);
    if (!memory)
        reader->out_of_memory = true;
    return memory;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static const char *describe_node(struct reader *reader, struct fy_node *node)
{
    if (!node)
        return "nothing";
    if (fy_node_get_type(node) == FYNT_SEQUENCE)
        return "a list";
    if (fy_node_get_type(node) == FYNT_MAPPING)
        return "a map";
    const char *text = node_text(reader, node);
    if (!text || !*text)
        return "nothing";
    const char *quoted = arena_printf(reader->model->arena, "`%s`", text);
    return quoted ? quoted : "text";
}

/* A list of as many scalars as the type takes; of numbers, if the type is one of numbers. */
static bool is_list(struct reader *reader, const struct key *key, struct fy_node *node)
{
    const struct key_type_info *type = &key_types[key->type];
    bool numbers = key->type == KEY_VALUE || key->type == KEY_NUMBERS;
    int count = list_count(node);
    for (int i = 0; i < count; i++) {
        struct fy_node *item = fy_node_sequence_get_by_index(node, i);
        const char *text = numbers ? node_text(reader, item) : NULL;
        double value;
        if (numbers ? !text || !text_number(text, &value) : fy_node_get_type(item) != FYNT_SCALAR)
            return false;
    }
    return count >= type->least && count <= type->most;
}

static bool is_natural(const char *text)
{
    double value;
    return text_number(text, &value) && value >= 0 && value <= UINT32_MAX && value == floor(value);
}

/* Whether the value has the key's type. Does not check choices, field types and expressions. */
static bool fits(struct reader *reader, const struct key *key, struct fy_node *node)
{
    const char *text = node_text(reader, node);
    bool scalar = text && *text;
    double number;
    if (key_types[key->type].most && fy_node_get_type(node) == FYNT_SEQUENCE)
        return is_list(reader, key, node);
    switch (key->type) {
    case KEY_NAME:
        return scalar && is_identifier(text);
    case KEY_REFERENCE:
    case KEY_MEMBER:
        return scalar && is_path(text);
    case KEY_TEXT:
    case KEY_EXPR:
    case KEY_EXPRS:
    case KEY_BODY:
    case KEY_CHOICE:
    case KEY_TYPE:
        return scalar;
    case KEY_BOOL:
        return scalar && (!strcmp(text, "true") || !strcmp(text, "false"));
    case KEY_NUMBER:
    case KEY_NUMBERS:
        return scalar && text_number(text, &number);
    case KEY_AMOUNT:
        return scalar && text_amount(text, &number);
    case KEY_INTEGER:
        return scalar && is_natural(text);
    case KEY_SIZE:
        return scalar && !strcmp(text, "frame");
    case KEY_VALUE:
        return scalar &&
               (!strcmp(text, "true") || !strcmp(text, "false") || text_number(text, &number));
    case KEY_LENGTH:
        return scalar &&
               (!strcmp(text, "scene_radius") || (text_number(text, &number) && number > 0));
    case KEY_WEIGHT:
        return scalar && (text_number(text, &number) || is_identifier(text));
    case KEY_NAMES:
    case KEY_FILES:
    case KEY_LIST:
        return fy_node_get_type(node) == FYNT_SEQUENCE;
    case KEY_MAP:
        return fy_node_get_type(node) == FYNT_MAPPING;
    case KEY_RECT:
        break;
    }
    return false;
}

/* 8-bit snorm is a format of GLSL, but not of the language: lists the formats of as many channels,
 * since the nearest name (rgba16_snorm) holds other values. False: text is no such format. */
static bool lacks_format(struct reader *reader, const char *text, struct loc loc,
                         const char *const *words, size_t count)
{
    size_t channels = strspn(text, "rgba");
    if (!channels || strcmp(text + channels, "8_snorm"))
        return false;
    struct text list = {0};
    for (size_t i = 0; i < count; i++)
        if (!strncmp(words[i], text, channels) && strspn(words[i], "rgba") == channels)
            text_add(&list, "%s%s", list.data ? ", " : "", words[i]);
    bool lacks = list.data;
    if (lacks)
        diag_error(reader->diag, loc,
                   "the language has no format `%s` (8-bit snorm); `%.*s` formats are %s", text,
                   (int)channels, text, list.data);
    text_free(&list);
    return lacks;
}

/* The nearest of the names, else all of them. */
static struct name_hint hint_or_all(const char *word, const char *const *names, size_t count,
                                    const char *before)
{
    struct text list = {0};
    text_add(&list, "%s", before);
    for (size_t i = 0; i < count; i++)
        text_add(&list, "%s %s", i ? "," : "", names[i]);
    struct name_hint hint = name_hint('`', word, names, count, list.data ? list.data : "");
    text_free(&list);
    return hint;
}

static bool choice_check(struct reader *reader, const struct key *key, const char *text,
                         struct loc loc)
{
    if (table_choice(key->choices, text) >= 0)
        return true;
    const char *words[48];
    char copy[512];
    size_t count = 0;
    strncpy(copy, key->choices, sizeof copy - 1);
    copy[sizeof copy - 1] = '\0';
    char *rest = copy;
    for (char *word; (word = strsep(&rest, "|")) && count < 48;)
        words[count++] = word;
    if (!strcmp(key->name, "format") && lacks_format(reader, text, loc, words, count))
        return false;
    return diag_error(reader->diag, loc, "`%s` is not a valid %s%s", text,
                      strcmp(key->name, "*") ? key->name : "value",
                      hint_or_all(text, words, count, count > 1 ? "; use one of" : "; use").text);
}

/* The first element of a list that is no number; NULL: none, or the key takes no list of numbers. */
static struct fy_node *wrong_number(struct reader *reader, const struct key *key,
                                    struct fy_node *node)
{
    bool listed = key->type == KEY_VALUE || key->type == KEY_NUMBERS;
    double number;
    EACH_ITEM(item, listed ? node : NULL) {
        const char *text = node_text(reader, item);
        if (!text || !text_number(text, &number))
            return item;
    }
    return NULL;
}

/* Whether a comma parted an expression: an element has a parenthesis that none in it closes. */
static bool is_torn(struct reader *reader, struct fy_node *node)
{
    int open = 0;
    EACH_ITEM(item, node)
        for (const char *text = open ? NULL : node_text(reader, item); text && *text; text++)
            open += (*text == '(') - (*text == ')');
    return open;
}

/* As describe_node, with the number of elements where a key takes some. */
static const char *describe_value(struct reader *reader, const struct key *key,
                                  struct fy_node *node)
{
    const char *listed =
        node && key_types[key->type].most && fy_node_get_type(node) == FYNT_SEQUENCE
            ? arena_printf(reader->model->arena, "a list of %d%s", list_count(node),
                           is_torn(reader, node) ? "; an expression that has a comma needs quotes"
                                                 : "")
            : NULL;
    return listed ? listed : describe_node(reader, node);
}

/* Whether the value is one that the key allows; reports an error if not. */
static bool value_check(struct reader *reader, const struct key *key, struct fy_node *node,
                        struct loc loc)
{
    struct loc place = node && node_loc(reader, node).line ? node_loc(reader, node) : loc;
    if (node && key->child != SECTION_NONE && key->type != KEY_LIST && key->type != KEY_NAMES &&
        fy_node_get_type(node) == FYNT_MAPPING)
        return true;
    if (!node || !fits(reader, key, node)) {
        const char *label = strcmp(key->name, "*") ? key->name
                            : key->child           ? table_sections[key->child].title
                                                   : "a value";
        bool quote = label == key->name;
        struct fy_node *item = wrong_number(reader, key, node);
        if (item)
            node_error(reader, item, "an element of %s%s%s must be a finite number, not %s",
                       quote ? "`" : "", label, quote ? "`" : "", describe_node(reader, item));
        else
            diag_error(reader->diag, place, "%s%s%s must be %s, not %s", quote ? "`" : "", label,
                       quote ? "`" : "", key_types[key->type].text,
                       describe_value(reader, key, node));
        return false;
    }
    return key->type != KEY_CHOICE || choice_check(reader, key, node_text(reader, node), place);
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static void report_unknown_key(struct reader *reader, enum section section, const char *name,
                               struct loc loc)
{
    const char *names[MOST_KEYS];
    size_t count = 0;
    for (const struct key *key = table_section(section); key->name; key++)
        names[count++] = key->name;
    diag_error(reader->diag, loc, "unknown key `%s` in %s%s", name, table_sections[section].title,
               hint_or_all(name, names, count, "; known are").text);
}

static void read_pair(struct reader *reader, struct fy_node_pair *pair, struct fields *fields)
{
    struct fy_node *name_node = fy_node_pair_key(pair), *value = fy_node_pair_value(pair);
    const char *name = key_text(reader, name_node);
    struct loc loc = node_loc(reader, name_node);
    if (!name) {
        diag_error(reader->diag, loc, "a key must be a word, not %s",
                   describe_node(reader, name_node));
        return;
    }
    const struct key *key = table_find(fields->section, name);
    if (!key || fields->count == MOST_KEYS) {
        report_unknown_key(reader, fields->section, name, loc);
        return;
    }
    struct field_value *field = &fields->values[fields->count++];
    *field =
        (struct field_value){key, name_node, value_check(reader, key, value, loc) ? value : NULL};
}

bool fields_read(struct reader *reader, struct fy_node *node, enum section section, struct loc loc,
                 struct fields *fields)
{
    *fields = (struct fields){.section = section, .loc = loc, .node = node};
    if (!node || fy_node_get_type(node) != FYNT_MAPPING)
        return diag_error(
            reader->diag, node && node_loc(reader, node).line ? node_loc(reader, node) : loc,
            "%s must be a map, not %s", table_sections[section].title, describe_node(reader, node));
    EACH_PAIR(pair, node)
        read_pair(reader, pair, fields);
    for (const struct key *key = table_section(section); key->name; key++) {
        bool there = !key->required;
        for (size_t k = 0; !there && k < fields->count; k++)
            there = fields->values[k].key == key;
        if (!there)
            diag_error(reader->diag, loc, "%s needs the key `%s`", table_sections[section].title,
                       key->name);
    }
    return true;
}

static int entry_count(const struct fields *fields, const char *key)
{
    struct fy_node *map = field_node(fields, key);
    return map && fy_node_get_type(map) == FYNT_MAPPING ? fy_node_mapping_item_count(map) : 0;
}

static void add_named(struct reader *reader, const struct key *entry, bool top, struct fy_node *map,
                      struct named_list *list)
{
    EACH_PAIR(pair, map) {
        const char *name = key_text(reader, fy_node_pair_key(pair));
        struct loc loc = node_loc(reader, fy_node_pair_key(pair));
        bool refers = entry->child == SECTION_CONTRACTS; /* to a resource, perhaps of an instance */
        if (!name || !(refers ? is_path(name) : is_identifier(name))) {
            diag_error(reader->diag, loc, "a name in %s must be letters, digits and `_`, not %s",
                       table_sections[entry->child].title,
                       describe_node(reader, fy_node_pair_key(pair)));
            continue;
        }
        const struct key *child = table_find(entry->child, name);
        if (top && !refers)
            name = declared_name(reader, map, name);
        if (child && value_check(reader, child, fy_node_pair_value(pair), loc))
            list->items[list->count++] = (struct named){name, loc, fy_node_pair_value(pair)};
    }
}

struct named_list fields_named(struct reader *reader, const struct fields *fields, const char *key)
{
    struct named_list list = {0};
    const struct key *entry = table_find(fields->section, key);
    size_t most = 0;
    for (const struct fields *at = fields; at; at = at->next)
        most += (size_t)entry_count(at, key);
    list.items = most && entry ? reader_alloc(reader, most, sizeof *list.items) : NULL;
    for (const struct fields *at = fields; list.items && at; at = at->next)
        if (entry_count(at, key))
            add_named(reader, entry, fields->section == SECTION_TOP, field_node(at, key), &list);
    return list;
}

/* ---- Typed access ---------------------------------------------------------------------------- */

static const struct field_value *field_value_of(const struct fields *fields, const char *key)
{
    for (size_t i = 0; i < fields->count; i++)
        if (!strcmp(fields->values[i].key->name, key))
            return &fields->values[i];
    return NULL;
}

struct fy_node *field_node(const struct fields *fields, const char *key)
{
    const struct field_value *value = field_value_of(fields, key);
    return value ? value->value : NULL;
}

bool field_given(const struct fields *fields, const char *key)
{
    return field_value_of(fields, key);
}

struct loc field_loc(const struct reader *reader, const struct fields *fields, const char *key)
{
    const struct field_value *value = field_value_of(fields, key);
    struct loc loc = value ? node_loc(reader, value->value) : fields->loc;
    if (!loc.line && value)
        loc = node_loc(reader, value->name);
    return loc.line ? loc : fields->loc;
}

const char *field_text(struct reader *reader, const struct fields *fields, const char *key)
{
    return node_text(reader, field_node(fields, key));
}

bool field_bool(struct reader *reader, const struct fields *fields, const char *key, bool fallback)
{
    const char *text = field_text(reader, fields, key);
    return text ? !strcmp(text, "true") : fallback;
}

double field_amount(struct reader *reader, const struct fields *fields, const char *key,
                    double fallback)
{
    const char *text = field_text(reader, fields, key);
    double value;
    return text && text_amount(text, &value) ? value : fallback;
}

int field_choice(struct reader *reader, const struct fields *fields, const char *key, int fallback)
{
    const char *text = field_text(reader, fields, key);
    return text ? table_choice(table_find(fields->section, key)->choices, text) : fallback;
}

struct expr *node_expr(struct reader *reader, struct fy_node *node)
{
    const char *text = node_text(reader, node);
    struct expr_names names = node_names(reader, node);
    return text ? expr_parse(reader->model, text, node_loc(reader, node), &names, reader->diag)
                : NULL;
}

struct expr *number_expr(struct reader *reader, uint32_t value, struct loc loc)
{
    const char *text = arena_printf(reader->model->arena, "%u", value);
    return text ? expr_parse(reader->model, text, loc, NULL, reader->diag) : NULL;
}

/* ---- Members of the model -------------------------------------------------------------------- */

int node_exprs(struct reader *reader, struct fy_node *node, struct expr **exprs)
{
    if (fy_node_get_type(node) == FYNT_SCALAR) {
        exprs[0] = node_expr(reader, node);
        return 1;
    }
    int count = fy_node_sequence_item_count(node);
    for (int i = 0; i < count; i++)
        exprs[i] = node_expr(reader, fy_node_sequence_get_by_index(node, i));
    return count;
}

/* Sets a member by its key's type. Without a value or a default it stays as it is. */
static void take_member(struct reader *reader, const struct key *key, struct fy_node *node,
                        void *member)
{
    const char *fallback = key->fallback && !strchr(key->fallback, ' ') ? key->fallback : NULL;
    const char *text = node ? node_text(reader, node) : fallback;
    double number;
    switch (key->type) {
    case KEY_NAME:
    case KEY_TEXT:
    case KEY_LENGTH:
        *(const char **)member = text;
        break;
    case KEY_REFERENCE:
        *(const char **)member = referred_name(reader, node);
        break;
    case KEY_BOOL:
        *(bool *)member = text && !strcmp(text, "true");
        break;
    case KEY_NUMBER:
        if (text && text_number(text, &number))
            *(double *)member = number;
        break;
    case KEY_INTEGER:
        if (text && text_number(text, &number))
            *(uint32_t *)member = (uint32_t)number;
        break;
    case KEY_CHOICE:
        if (text && table_choice(key->choices, text) >= 0)
            *(int *)member = table_choice(key->choices, text);
        break;
    case KEY_EXPR:
    case KEY_RECT:
        if (node)
            node_exprs(reader, node, member);
        break;
    default:
        break;
    }
}

void record_read(struct reader *reader, const struct fields *fields, unsigned of, void *record)
{
    static const char *const titles[] = {"a draw",
                                         "a fullscreen draw",
                                         "a draw of vertices",
                                         "a dispatch",
                                         "a sampler of kind hammersley",
                                         "a sampler of kind filter"};
    for (const struct key *key = table_section(fields->section); key->name; key++) {
        struct fy_node *node = field_node(fields, key->name);
        if (node && key->of && !(key->of & of))
            key_error(reader, fields, key->name, "%s has no `%s`", titles[__builtin_ctz(of)],
                      key->name);
        if (key->at)
            take_member(reader, key, node, (char *)record + key->at - 1);
        if (key->place)
            *(struct loc *)((char *)record + key->place - 1) = field_loc(reader, fields, key->name);
    }
}

bool map_read(struct reader *reader, const struct fields *fields, const char *key, void *record)
{
    struct fy_node *node = field_node(fields, key);
    struct fields map;
    bool good = node && fy_node_get_type(node) == FYNT_MAPPING &&
                fields_read(reader, node, table_find(fields->section, key)->child,
                            node_loc(reader, node), &map);
    if (good)
        record_read(reader, &map, 0, record);
    return good;
}

void *entries_read(struct reader *reader, const struct fields *fields, const struct entries *kind,
                   uint32_t *count)
{
    struct named_list list = fields_named(reader, fields, kind->key);
    const struct key *entry = table_find(table_find(fields->section, kind->key)->child, "*");
    char *records = reader_alloc(reader, list.count, kind->size);
    for (*count = 0; records && *count < list.count; ++*count) {
        const struct named *named = &list.items[*count];
        char *record = records + *count * kind->size;
        struct fields map = {.section = entry->child, .loc = named->loc, .count = 1};
        if (kind->initial)
            memcpy(record, kind->initial, kind->size);
        *(struct declared *)record = (struct declared){.name = named->name, .loc = named->loc};
        if (fy_node_get_type(named->value) == FYNT_MAPPING)
            fields_read(reader, named->value, entry->child, named->loc, &map);
        else /* short for a map with its first key */
            map.values[0] = (struct field_value){table_section(entry->child), NULL, named->value};
        if (!kind->of)
            record_read(reader, &map, 0, record);
        if (kind->finish)
            kind->finish(reader, &map, record);
    }
    return records;
}
