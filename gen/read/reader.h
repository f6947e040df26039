/* Shared by the files of the reader: the document, locations of its nodes, and maps checked against
 * the table. Internal to this room. */
#pragma once

#include "model/expr.h"
#include "model/names.h"
#include "read.h"
#include "base/yaml.h"
#include "table.h"

/* A node that `--set` inserted; its locations are in the text of the option. */
struct override {
    struct fy_node *node; /* NULL: a later override replaced it */
    const struct source *source;
    int column; /* 1-based, of the node's text within the option */
    /* parameters: enum dt_type of the replaced value, so that `--set x=1` keeps a float a float;
     * -1: none */
    int type;
};

/* One checked map of the document: its known keys. value: NULL for a wrong value. */
enum { MOST_KEYS = 48 };
struct field_value {
    const struct key *key;
    struct fy_node *name, *value;
};
struct fields {
    enum section section;
    struct loc loc;       /* of the map, or of the name that it belongs to */
    struct fy_node *node; /* the map */
    struct field_value values[MOST_KEYS];
    size_t count;
    const struct fields *next; /* top level: of the next file */
};

struct scope; /* read_group.c: the names of an instance */

/* The spec, a file that it includes, or an instance of a group or repeat. */
struct document {
    const struct source *source;
    struct fy_document *yaml;
    struct fields fields;        /* of the top level */
    const char *real;            /* real path */
    struct document *parent;     /* includes it; NULL: the spec */
    struct fy_node *entry;       /* element of the parent's `passes` that includes it; NULL: none */
    const struct scope *scope;   /* of an instance; NULL: a file */
    const struct fy_node *group; /* of an instance: what it is a copy of */
    struct document *next;       /* in the order of reading */
};

struct reader {
    struct model *model;
    struct diag *diag;
    struct document spec; /* and, by `next`, the files that it includes, and instances */
    uint32_t instance_count;
    bool unfilled; /* filled_text reported an error */
    /* read_group.c: parameters and constants for repeats; `values`: those that fold; NULL: not read */
    struct pipeline *all, *values;
    struct override *overrides;
    size_t override_count;
    bool out_of_memory;
};

/* One entry of a section of free names. */
struct named {
    const char *name;
    struct loc loc;
    struct fy_node *value;
};
struct named_list {
    struct named *items;
    uint32_t count;
};

/* read_include.c: reports; false: a file cannot be used. Call documents_free also then. */
bool documents_load(struct reader *reader, const struct source *source);
/* Reads a file of the templates, unless it was read; false: reported. */
bool documents_add(struct reader *reader, const char *name, struct loc loc);
void documents_free(struct reader *reader);
const struct source *node_source(const struct reader *reader, struct fy_node *node);
/* The document whose section has the entry that `path` begins with, the one with the longest name;
 * else the first that has the section, or the spec. Returns its root. path[ends[0] .. ends[1]) is the
 * entry's own name, and path[ends[2]] follows; ends must be 0. */
struct fy_node *root_with(struct reader *reader, const char *section, const char *path,
                          size_t ends[3]);
/* The top level of all files, checked. */
const struct fields *documents_fields(struct reader *reader);
/* The passes of all files: those of `include` first, the others in their place. */
struct fy_node **documents_passes(struct reader *reader, uint32_t *count);
bool is_include(struct fy_node *item);

/* read_group.c: adds a document for each instance; false after an error. */
bool documents_expand(struct reader *reader);
bool is_use(struct fy_node *item);       /* of a group, or repeated, or culled */
bool has_own_name(struct fy_node *item); /* a pass, also one that is culled */
/* The name that an entry gets, such as `second.views`; `node`: any of the entry. */
const char *declared_name(struct reader *reader, struct fy_node *node, const char *name);
/* The name that a scalar means where it stands; NULL unless a scalar. */
const char *referred_name(struct reader *reader, struct fy_node *node);
/* The same of a word beside the node. */
const char *node_word(struct reader *reader, struct fy_node *node, const char *word);
/* The text of a scalar; of an argument, if it is the name of one. loc, if not NULL: its place. NULL
 * unless a scalar. */
const char *argument_text(struct reader *reader, struct fy_node *node, struct loc *loc);
struct expr_names node_names(const struct reader *reader, struct fy_node *node);
/* Visits arguments, constants and numbers of the instances around the node; at: declares one. */
void each_word(struct reader *reader, struct fy_node *node,
               void (*visit)(void *user, const char *word, struct fy_node *at), void *user);
/* In an instance: the text with `{EXPR}` replaced. NULL: out of memory. */
const char *filled_text(struct reader *reader, struct fy_node *node, const char *text);

/* An element of `passes` that stands for instances, and the document that has it. */
struct use {
    struct reader *reader;
    struct document *from;
    struct fy_node *item;
    struct fields fields;
};
/* The `exactness` of the innermost group that a node stands in, as enum exactness; -1: none says. */
int group_exactness(struct reader *reader, struct fy_node *node);
const struct scope *node_scope(const struct reader *reader, struct fy_node *node); /* or NULL */
/* Appends an instance of `of`, which owns `yaml` and its root. label: for notes at the use; NULL:
 * none. NULL: out of memory. */
struct scope *add_instance(struct use *use, struct fy_document *yaml, struct fy_node *root,
                           struct fy_node *of, const char *label);
/* Names end in `suffix`; `name`, declared at `at`, stands for the number. False: out of memory. */
bool scope_set(struct scope *scope, const struct scope *outer, const char *suffix, const char *name,
               const char *number, struct fy_node *at);
void scope_hide(struct scope *scope); /* others cannot refer to the names that it declares */
struct fy_node *node_remove(struct fy_node *map, const char *key); /* its value; NULL: none */
/* read_cull.c: false: out of memory. */
bool is_culled(struct fy_node *item);
bool expand_cull(struct use *use);

/* read_document.c: `early`: those of parameters and constants, before instances are made; else
 * the others. */
void document_set(struct reader *reader, const char *const *sets, size_t set_count, bool early);
struct loc node_loc(const struct reader *reader, struct fy_node *node); /* line 0 for NULL */
#define node_error(reader, node, ...)                                                              \
    diag_error((reader)->diag, node_loc(reader, node), __VA_ARGS__)
#define key_error(reader, fields, key, ...)                                                        \
    diag_error((reader)->diag, field_loc(reader, fields, key), __VA_ARGS__)
/* NULL where there is no such value, or no map or list. */
struct fy_node *map_value(struct fy_node *map, const char *key);
struct fy_node *section_of(const struct document *document, const char *key);
int list_count(struct fy_node *list);
const char *pair_name(struct reader *reader, struct fy_node_pair *pair);
/* NULL unless a scalar. key_text: as written; node_text: with `{EXPR}` replaced. */
const char *key_text(struct reader *reader, struct fy_node *node);
const char *node_text(struct reader *reader, struct fy_node *node);
const char *element_name(struct reader *reader, struct fy_node *item); /* its `name`; or NULL */
bool is_path(const char *text); /* names and numbers joined by dots */
bool is_identifier(const char *text);

/* read_fields.c: false when the node is no map; `loc`: location for errors about missing keys. */
bool fields_read(struct reader *reader, struct fy_node *node, enum section section, struct loc loc,
                 struct fields *fields);
/* Entries of a section, of all files at the top level. */
struct named_list fields_named(struct reader *reader, const struct fields *fields, const char *key);
struct fy_node *field_node(const struct fields *fields, const char *key);
bool field_given(const struct fields *fields, const char *key); /* also with a wrong value */
struct loc field_loc(const struct reader *reader, const struct fields *fields, const char *key);
const char *field_text(struct reader *reader, const struct fields *fields, const char *key);
bool field_bool(struct reader *reader, const struct fields *fields, const char *key, bool fallback);
double field_amount(struct reader *reader, const struct fields *fields, const char *key,
                    double fallback);
int field_choice(struct reader *reader, const struct fields *fields, const char *key, int fallback);
struct expr *number_expr(struct reader *reader, uint32_t value, struct loc loc);
struct expr *node_expr(struct reader *reader, struct fy_node *node);
/* One to four expressions; returns their number. */
int node_exprs(struct reader *reader, struct fy_node *node, struct expr **exprs);
/* Sets the members of the section's struct by the table. of: kind of map, one of enum key_of; reports keys
 * that it cannot have. */
void record_read(struct reader *reader, const struct fields *fields, unsigned of, void *record);
/* The same of a map below the key; false: there is none. */
bool map_read(struct reader *reader, const struct fields *fields, const char *key, void *record);

/* The entries of a section of free names, as structs that begin with struct declared. */
struct entries {
    const char *key;
    size_t size;
    const void *initial; /* before reading; NULL: zeros */
    /* After record_read, which it calls itself where `of` is set. */
    void (*finish)(struct reader *reader, const struct fields *fields, void *record);
    bool of;
};
void *entries_read(struct reader *reader, const struct fields *fields, const struct entries *kind,
                   uint32_t *count);
void *reader_alloc(struct reader *reader, size_t count, size_t size); /* at least one element */

/* read_params.c */
bool param_value(struct reader *reader, struct fy_node *node, double value[4], uint32_t *components,
                 enum dt_type *type);
void read_params(struct reader *reader, const struct fields *top);
void read_constants(struct reader *reader, const struct fields *top);
/* read_resources.c */
void read_structs(struct reader *reader, const struct fields *top);
void read_resources(struct reader *reader, const struct fields *top);
/* What a pass may list in `uses`. */
void read_functions(struct reader *reader, const struct fields *top);
void read_contracts(struct reader *reader, const struct fields *top);
/* read_content.c: with `file` it finds the file and sets the resource's size from its header. */
void read_content(struct reader *reader, const struct fields *fields, struct resource *resource);
/* read_passes.c */
uint32_t read_shader_values(struct reader *reader, const struct fields *fields,
                            struct value **values);
void read_copies(struct reader *reader); /* read_copies.c */
void read_passes(struct reader *reader, const struct fields *top);
