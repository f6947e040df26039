/* The table of the spec language's keys, and look-ups in it. */
#include "table.h"

#include <string.h>

#include "model/model.h"

static const char param_types[] = /* no matrices */
#define COLUMNS_1(name) "|" name
#define COLUMNS_4(name)
#define DT_TYPE(ENUMERATOR, name, components, columns, ...) COLUMNS_##columns(name)
#include "types.def"
    ;
/* Bool keeps the numbering of enum dt_type; set_type rejects it. */
static const char field_types[] =
#define DT_TYPE(ENUMERATOR, name, ...) "|" name
#include "types.def"
    ;
static const char formats[] =
#define DT_FORMAT(ENUMERATOR, name, ...) "|" name
#include "formats.def"
    ;
#define BLENDS "off|add|over|premultiplied|min|max|multiply"
#define FACTORS                                                                                    \
    "one|zero|src_color|one_minus_src_color|dst_color|one_minus_dst_color|src_alpha|"              \
    "one_minus_src_alpha|dst_alpha|one_minus_dst_alpha"
#define OPERATIONS "add|subtract|reverse_subtract|min|max"

#define INPUT_DOC                                                                                  \
    "true: the content comes from outside, by `--input NAME=FILE` or from the host that runs the " \
    "pipeline, and stays from frame to frame. No pass writes it."
#define KEEP_DOC                                                                                   \
    "true: shares no memory with other resources, so a host may read the content after the frame."

#define AT(type, member)    .at = 1 + offsetof(struct type, member)
#define PLACE(type, member) .place = 1 + offsetof(struct type, member)
static const struct key table_keys[] = {
#define SECTION(ENUMERATOR, ...) {.section = SECTION_##ENUMERATOR},
#define KEY(key, key_type, default, text, value, ...)                                              \
    {.name = key,                                                                                  \
     .type = KEY_##key_type,                                                                       \
     .fallback = default,                                                                          \
     .doc = text,                                                                                  \
     .example = value,                                                                             \
     __VA_ARGS__},
#include "language.def"
#undef SECTION
#undef KEY
    {0},
};

const struct section_info table_sections[SECTION_COUNT] = {
#define SECTION(ENUMERATOR, ...) [SECTION_##ENUMERATOR] = {__VA_ARGS__},
#define KEY(...)
#include "language.def"
#undef SECTION
#undef KEY
};

const struct key *table_section(enum section section)
{
    const struct key *key = table_keys;
    while (key->section != section)
        key++;
    return key + 1;
}

const struct key *table_find(enum section section, const char *name)
{
    const struct key *any = NULL;
    for (const struct key *key = table_section(section); key->name; key++) {
        if (!strcmp(key->name, name))
            return key;
        if (!strcmp(key->name, "*"))
            any = key;
    }
    return any;
}

int table_choice(const char *choices, const char *word)
{
    size_t length = strlen(word);
    int number = 0;
    for (const char *at = choices; at; number++) {
        const char *end = strchr(at, '|');
        size_t size = end ? (size_t)(end - at) : strlen(at);
        if (size == length && !memcmp(at, word, length))
            return number;
        at = end ? end + 1 : NULL;
    }
    return -1;
}

const struct key_type_info key_types[] = {
#define KEY_TYPE(ENUMERATOR, ...) {__VA_ARGS__},
#include "key_types.def"
#undef KEY_TYPE
};
