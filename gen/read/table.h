/* The table of all keys of the spec language, from language.def. The reader checks documents against
 * it; --schema and --reference print it. */
#pragma once

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

enum key_type {
#define KEY_TYPE(ENUMERATOR, ...) KEY_##ENUMERATOR,
#include "key_types.def"
#undef KEY_TYPE
};

struct key_type_info { /* see key_types.def */
    const char *text, *scalar, *items;
    int least, most;
};
extern const struct key_type_info key_types[];

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
