/* YAML documents and the places of their nodes: one parser setting and one set of limits for specs,
 * scenes, motions, contracts and outlines. */
#pragma once

#include <libfyaml.h>

#include "base/diag.h"

/* The limit on nodes that aliases and merge keys may add to a document. */
enum { YAML_MOST_ALIASED = 100000 };

/* Parses, removes duplicate keys, and expands aliases and merge keys. Reports every error; after
 * some of them, such as a duplicate key, the document is usable all the same. NULL: no document.
 * The source must outlive the document, and need not be valid UTF-8: that is an error, too.
 * Release with fy_document_destroy. */
struct fy_document *yaml_parse(const struct source *source, struct diag *diag);

/* The first byte that is not UTF-8 or is a control character; NULL: none. A zero stands behind the text. */
const char *yaml_wrong_byte(const char *text, size_t length);
/* The pair of a mapping whose key is this name (length FY_NT: to its end). NULL: none. libfyaml reads the name as
 * YAML, and prints what is wrong with it: a name has letters, digits, `_` and dots. */
struct fy_node_pair *yaml_pair(struct fy_node *map, const char *name, size_t length);

/* The items of a sequence and the pairs of a mapping, in order; none of NULL and of other nodes. */
#define YAML_EACH(iterate, type, at, node)                                                         \
    for (void *at##_last = NULL, *at##_open = &at##_last; at##_open; at##_open = NULL)             \
        for (type * at; (at = iterate(node, &at##_last));)
#define EACH_ITEM(item, list) YAML_EACH(fy_node_sequence_iterate, struct fy_node, item, list)
#define EACH_PAIR(pair, map)  YAML_EACH(fy_node_mapping_iterate, struct fy_node_pair, pair, map)

/* The place of a scalar; of a mapping or a sequence: the start of its first scalar. Line 0 where
 * there is none. */
struct loc yaml_loc(const struct source *source, struct fy_node *node);
