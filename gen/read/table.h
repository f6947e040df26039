/* The table of all keys of the spec language, from language.def. The reader checks documents against
 * it; --schema and --reference print it. */
#ifndef DIPTYCH_GEN_TABLE_H
#define DIPTYCH_GEN_TABLE_H

#include <stdbool.h>
#include <stddef.h>

/* A section is a map: the document, one parameter, one pass... Sections of free names have the key
 * "*". */
enum section {
    SECTION_NONE,
#define SECTION(ENUMERATOR, ...) SECTION_##ENUMERATOR,
#define KEY(...)
#include "language.def"
#undef SECTION
#undef KEY
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
    enum section section; /* begins there; such a row is no key, and has no name */
    const char *name;     /* "*": any identifier, a declared name */
    enum key_type type;
    const char *fallback; /* the default, as text; NULL: none */
    const char *doc;
    const char *example; /* a value, YAML */
    enum section child;
    const char *choices; /* words joined by `|`, in the order of the enum that they stand for */
    bool required;
    unsigned of;      /* mask of enum key_of: the maps that may have it; 0: all */
    size_t at, place; /* 1 + offset in the section's struct of the model; 0: not there */
};

/* Kinds of passes and samplers. */
enum key_of {
    OF_SCENE = 1 << 0,
    OF_FULLSCREEN = 1 << 1,
    OF_VERTICES = 1 << 2,
    OF_DISPATCH = 1 << 3,
    OF_POINTS = 1 << 4,
    OF_FILTER = 1 << 5,
    OF_DRAW = OF_SCENE | OF_FULLSCREEN | OF_VERTICES
};

struct section_info { /* see language.def */
    const char *title, *path, *anchor, *doc, *example;
};

extern const struct section_info table_sections[SECTION_COUNT];

/* The keys of a section; a row without name follows them. */
const struct key *table_section(enum section section);
/* The key of this name in a section, else the section's key "*", else NULL. */
const struct key *table_find(enum section section, const char *name);
/* Index of `word` in choices joined by `|`; -1: not found. */
int table_choice(const char *choices, const char *word);
/* What a value of this key must be, for messages and the reference: "an integer expression". */
const char *table_type_text(enum key_type type);

#endif
