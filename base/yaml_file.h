/* A YAML file that is a mapping with known keys: scenes, motions, contracts, outlines. All its errors are
 * reported in one run. Specs have a table of keys of their own (gen/read/table.h). */
#pragma once

#include "base/yaml.h"

enum key_type { KEY_TEXT, KEY_NUMBERS, KEY_MAPPING, KEY_MAPPING_OR_TEXT, KEY_SEQUENCE };

/* One key of a mapping: what it takes, and after reading, where it stands (NULL: nowhere). */
struct key {
    const char *name;
    enum key_type type;
    bool required;
    int count;        /* KEY_NUMBERS: 1 is a plain number, else a sequence */
    double min, max;  /* KEY_NUMBERS: every component lies between */
    double number[3]; /* KEY_NUMBERS: the default, then the value */
    bool given;       /* the mapping has it */
    struct fy_node *name_node, *node;
};

#define KEY_OF_NUMBERS(name, required, count, min, max, ...)                                       \
    {                                                                                              \
        name, KEY_NUMBERS, required, count, min, max, {__VA_ARGS__}, false, NULL, NULL             \
    }
#define FAR 1e9 /* no coordinate, no light lies beyond */

struct reader {
    struct source source;
    struct diag *diag;
    int errors;       /* reported by reader_report */
    char context[32]; /* before every message; empty: nothing */
};

/* What a kind of file is called, and which keys it has at least. */
struct file_kind {
    const char *name, *keys;
    /* Reads the root, a mapping, and reports what is wrong in it. */
    void (*read)(struct reader *reader, struct fy_node *root, void *user);
};

/* Logs one error with all that was found wrong, and returns false, if anything was. */
bool reader_file(const char *path, const struct file_kind *kind, void *user,
                 const struct dt_log *log);

/* One more error, at the node. `reader` may be NULL for what is known to be right. */
void reader_report(struct reader *reader, struct fy_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Fills the keys from a mapping. A missing key is reported at `place`, the key that has this
 * mapping as its value: a whole mapping under a caret would be many lines. */
void reader_mapping(struct reader *reader, struct fy_node *mapping, struct fy_node *place,
                    const char *owner, struct key *keys, size_t count);

/* Reports, at the key's node, numbers that are out of the key's range. */
bool reader_range(struct reader *reader, const struct key *key);
