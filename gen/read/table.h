/* The table of all keys of the spec language. The reader checks documents against it; --schema and
 * --reference print it. */
#ifndef DIPTYCH_GEN_TABLE_H
#define DIPTYCH_GEN_TABLE_H

#include <stdbool.h>
#include <stddef.h>

/* A section is a map: the document, one parameter, one pass... Sections of free names have the key
 * "*". */
enum section {
    SECTION_NONE,
    SECTION_TOP,
    SECTION_PARAMS,
    SECTION_PARAM,
    SECTION_CONSTANTS,
    SECTION_CONSTANT,
    SECTION_STRUCTS,
    SECTION_STRUCT,
    SECTION_FIELD,
    SECTION_BUFFERS,
    SECTION_BUFFER,
    SECTION_IMAGES,
    SECTION_IMAGE,
    SECTION_SAMPLERS,
    SECTION_SAMPLER,
    SECTION_METRICS,
    SECTION_METRIC,
    SECTION_INTERLEAVES,
    SECTION_INTERLEAVE,
    SECTION_PASS,
    SECTION_PASS_INCLUDE,
    SECTION_GROUPS,
    SECTION_GROUP,
    SECTION_USE,
    SECTION_WITH,
    SECTION_REPEAT,
    SECTION_DRAW,
    SECTION_CULL,
    SECTION_DEPTH_BIAS,
    SECTION_ACCESS,
    SECTION_BLEND,
    SECTION_RANGES,
    SECTION_RANGE,
    SECTION_DEFINES,
    SECTION_ALLOW,
    SECTION_VALUES,
    SECTION_ASSERT,
    SECTION_CONTRACTS,
    SECTION_CONTRACT,
    SECTION_IMAGE_CONTRACT,
    SECTION_OUTPUT,
    SECTION_COUNT
};

/* The type of a key's value. With a child section, a map of that section is accepted as well
 * (KEY_MAP: only a map; KEY_LIST and KEY_NAMES: as elements of the list). */
enum key_type {
    KEY_NAME,      /* identifier */
    KEY_REFERENCE, /* a name, perhaps of an instance: second.views */
    KEY_MEMBER,    /* NAME or NAME.FIELD */
    KEY_TEXT,      /* any scalar */
    KEY_BOOL,      /* true or false */
    KEY_NUMBER,    /* real */
    KEY_AMOUNT,    /* real, as a number, a fraction A/B or a percentage */
    KEY_INTEGER,   /* 0, 1, 2... */
    KEY_EXPR,      /* integer expression */
    KEY_EXPRS,     /* integer expression, or a list of 1 to 3 */
    KEY_SIZE,      /* `frame`, or a list of 2 or 3 expressions */
    KEY_RECT,      /* list of 4 expressions */
    KEY_VALUE,     /* number, bool, or a list of 2 to 4 numbers */
    KEY_NUMBERS,   /* number, or a list of 1 to 4 */
    KEY_LENGTH,    /* `scene_radius`, or a number */
    KEY_WEIGHT,    /* number, or the name of a parameter */
    KEY_CHOICE,    /* one of the words in `choices` */
    KEY_TYPE,      /* type of a field: a word in `choices`, or TYPE[N] */
    KEY_NAMES,     /* list of identifiers */
    KEY_FILES,     /* list of file names */
    KEY_BODY,      /* file name, or a list of 1 or 2 */
    KEY_LIST,      /* list of maps */
    KEY_MAP
};

struct key {
    enum section section;
    const char *name; /* "*": any identifier, a declared name */
    enum key_type type;
    enum section child;
    const char *choices; /* words joined by `|`, in the order of the enum that they stand for */
    bool required;
    const char *fallback; /* the default, as text; NULL: none */
    const char *doc;
    const char *example; /* a value, YAML */
};

struct section_info {
    const char *title; /* "a pass": for messages */
    const char *path;  /* "passes[]": for the reference */
    const char
        *anchor;     /* for links in the reference, and the name of the definition in the schema */
    const char *doc; /* one paragraph */
    const char *example; /* YAML of the whole section, or NULL */
};

extern const struct key table_keys[];
extern const size_t table_key_count;
extern const struct section_info table_sections[SECTION_COUNT];

/* The key of this name in a section, else the section's key "*", else NULL. */
const struct key *table_find(enum section section, const char *name);
/* Index of `word` in choices joined by `|`; -1: not found. */
int table_choice(const char *choices, const char *word);
/* What a value of this key must be, for messages and the reference: "an integer expression". */
const char *table_type_text(enum key_type type);

#endif
