/* `cull` of a scene draw, as a map: the draw becomes passes that list the triangles to keep, an
 * indirect draw of the lists, and a draw of the whole scene for layers whose list has no room. The
 * passes are a group in templates/cull/cull.yaml. */
#include <string.h>

#include "reader.h"

bool is_culled(struct fy_node *item)
{
    struct fy_node *cull = map_value(item, "cull");
    return cull && fy_node_get_type(cull) == FYNT_MAPPING;
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

/* A node that node_loc finds at `of`; NULL: out of memory. */
static struct fy_node *placed(struct fy_node *node, struct fy_node *of)
{
    return node && !fy_node_set_meta(node, of) ? node : NULL;
}

/* Appends KEY: VALUE; false: out of memory. */
static bool add_pair(struct fy_node *map, const char *key, struct fy_node *value)
{
    struct fy_document *yaml = fy_node_document(map);
    struct fy_node *name = fy_node_create_scalar_copy(yaml, key, FY_NT);
    return name && value && !fy_node_mapping_append(map, name, value);
}

static bool add_text(struct fy_node *map, const char *key, const char *text)
{
    return text && add_pair(map, key,
                            placed(fy_node_create_scalar_copy(fy_node_document(map), text, FY_NT),
                                   fy_node_get_meta(map)));
}

/* Adds a copy of the value as the argument; NULL: the fallback. */
static bool add_argument(struct fy_node *with, const char *name, struct fy_node *value,
                         const char *fallback)
{
    return value ? add_pair(with, name, fy_node_copy(fy_node_document(with), value))
                 : add_text(with, name, fallback);
}

/* ---- The documents --------------------------------------------------------------------------- */

struct culled {
    struct reader *reader;
    struct fy_node *item, *node; /* the draw and its `cull` */
    struct fields cull;
    const char *name; /* of the draw */
};

/* Whether the value of a key, or of the argument that it names, is this word. */
static bool value_is(const struct culled *c, struct fy_node *map, const char *key, const char *word)
{
    const char *text = argument_text(c->reader, map_value(map, key), NULL);
    return text && !strcmp(text, word);
}

/* The use of the group. */
static struct fy_node *make_use(const struct culled *c, struct fy_document *yaml)
{
    struct fy_node *layers = map_value(c->item, "layers");
    struct fy_node *when = map_value(c->item, "when");
    struct fy_node *use = placed(fy_node_create_mapping(yaml), c->node);
    struct fy_node *with = placed(fy_node_create_mapping(yaml), c->node);
    bool each = field_node(&c->cull, "each"), light = value_is(c, c->item, "view", "light");
    bool good =
        use && with && add_text(use, "group", each ? "cull_each" : "cull") &&
        add_text(use, "as", c->name) && add_pair(use, "with", with) &&
        (value_is(c, c->node, "keep", "frustum")
             ? add_text(with, "keep", light ? "cull/light_frustum.glsl" : "cull/frustum.glsl")
             : add_argument(with, "keep", field_node(&c->cull, "keep"), NULL)) &&
        (!each || (add_argument(with, "each", field_node(&c->cull, "each"), NULL) &&
                   add_argument(with, "cull_layers", layers, "1") &&
                   add_argument(with, "cull_again", field_node(&c->cull, "again"), "0"))) &&
        add_argument(with, "cull_room", field_node(&c->cull, "room"), "1048576") &&
        add_argument(with, "cull_most", field_node(&c->cull, "most"), "1048576") &&
        add_argument(with, "cull_when", when, "1");
    return good ? use : NULL;
}

/* The draw of the lists, or of the whole scene. */
static struct fy_node *make_draw(const struct culled *c, struct fy_document *yaml, bool whole)
{
    struct fy_node *draw = placed(fy_node_copy(yaml, c->item), c->item),
                   *faces = field_node(&c->cull, "faces");
    struct arena *arena = c->reader->model->arena;
    if (!draw)
        return NULL;
    fy_node_free(node_remove(draw, "cull"));
    bool good = !faces || add_pair(draw, "cull", fy_node_copy(yaml, faces));
    good &= add_text(draw, "indirect",
                     arena_printf(arena, "%s.%s", c->name, whole ? "whole_draws" : "draws"));
    if (!whole)
        return good && add_text(draw, "indices", arena_printf(arena, "%s.indices", c->name)) ? draw
                                                                                             : NULL;
    /* It goes on where the draw of the lists ended. */
    struct fy_node *writes = node_remove(draw, "writes"), *item;
    struct fy_node *updates = map_value(draw, "updates");
    if (!updates)
        return good && (!writes || add_pair(draw, "updates", writes)) ? draw : NULL;
    while (writes && fy_node_is_sequence(updates) &&
           (item = fy_node_sequence_get_by_index(writes, 0)))
        good &= !fy_node_sequence_append(updates, fy_node_sequence_remove(writes, item));
    fy_node_free(writes);
    return good ? draw : NULL;
}

/* Appends a document with these passes. */
static struct scope *add_kept_passes(struct use *use, struct fy_document *yaml,
                                     struct fy_node *first, struct fy_node *second)
{
    struct fy_node *list = fy_node_create_sequence(yaml), *root = fy_node_create_mapping(yaml);
    bool good = first && list && root && !fy_node_sequence_append(list, first) &&
                (!second || !fy_node_sequence_append(list, second)) &&
                add_pair(root, "passes", list);
    return add_instance(use, yaml, good ? root : NULL, use->item, NULL);
}

/* False after an error. */
static bool check_draw(const struct culled *c)
{
    struct reader *reader = c->reader;
    static const char *const excluded[] = {"indirect", "indices"};
    struct loc loc = node_loc(reader, c->node);
    bool good = c->name && value_is(c, c->item, "draw", "scene");
    if (!c->name)
        node_error(reader, c->item, "a pass needs the key `name`");
    else if (!good)
        diag_error(reader->diag, loc, "`cull` as a map needs `draw: scene`");
    if (field_node(&c->cull, "again") && !field_node(&c->cull, "each")) {
        diag_error(reader->diag, loc, "`again` needs `each`");
        good = false;
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(excluded); i++) {
        if (!map_value(c->item, excluded[i]))
            continue;
        diag_error(reader->diag, loc, "`cull` makes the draw's buffers; leave out `%s`",
                   excluded[i]);
        good = false;
    }
    return good && field_node(&c->cull, "keep");
}

bool expand_cull(struct use *use)
{
    struct reader *reader = use->reader;
    struct culled c = {.reader = reader, .item = use->item};
    c.node = map_value(use->item, "cull");
    c.name = element_name(reader, use->item);
    struct loc loc = node_loc(reader, c.node);
    if (!fields_read(reader, c.node, SECTION_CULL, loc, &c.cull) || !check_draw(&c) ||
        !documents_add(reader, "cull/cull.yaml", loc))
        return true;
    struct fy_document *lists = fy_document_create(NULL), *whole = fy_document_create(NULL);
    struct scope *scope =
        lists ? add_kept_passes(use, lists, make_use(&c, lists), make_draw(&c, lists, false))
              : NULL;
    struct scope *rest =
        scope && whole ? add_kept_passes(use, whole, make_draw(&c, whole, true), NULL) : NULL;
    if (rest)
        scope_hide(rest);
    return rest && scope_set(scope, node_scope(reader, use->item), "", "whole", "0", c.node) &&
           scope_set(rest, scope, ".whole", "whole", "1", c.node);
}
