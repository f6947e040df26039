/* What a pipeline offers the window beside what every one does: the outline, a YAML file that
 * belongs to a spec, NAME/view.yaml beside NAME.yaml; there need be none.
 *
 *   digits: NAME              live parameter that the keys 0 to 9 set
 *   points:                   elements of buffers over the picture, a list of
 *     - name: TEXT
 *       of: [{buffer: NAME, position: FIELD, color: FIELD, label: index|BUFFER, where: FIELD,
 *             radius: PIXELS}, ...]                  only buffer and position must be there */
#include "view/view.h"

#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "result/live.h"
#include "base/yaml_file.h"

/* NULL where the key is not there, or holds something else. */
static const char *key_text_of(const struct key *key)
{
    return key->node && fy_node_is_scalar(key->node) ? fy_node_get_scalar0(key->node) : NULL;
}

/* The buffer that the key names; 0 after an error. */
static uint32_t find_point_buffer(struct reader *reader, const struct view *view,
                                  const struct key *key)
{
    const struct dt_pipeline *info = view->pipeline.info;
    const char *name = key_text_of(key);
    for (uint32_t i = 0; name && i < info->resource_count; i++)
        if (info->resources[i].kind == DT_BUFFER && strcmp(info->resources[i].name, name) == 0)
            return i;
    if (name)
        reader_report(reader, key->node, "%s has no buffer `%s`", info->name, name);
    return 0;
}

/* The offset of the field of that buffer that the key names; -1: it names none. `wide`: of three
 * numbers, else of one. */
static int find_point_field(struct reader *reader, const struct view *view, uint32_t buffer,
                            const struct key *key, bool wide)
{
    const struct dt_resource *resource = &view->pipeline.info->resources[buffer];
    const char *name = key_text_of(key);
    for (uint32_t i = 0; name && i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        if (strcmp(field->name, name) != 0)
            continue;
        bool is_wide = field->type == DT_TYPE_VEC3 || field->type == DT_TYPE_VEC4;
        bool is_one = field->type == DT_TYPE_FLOAT || field->type == DT_TYPE_INT;
        if (wide ? is_wide : is_one)
            return (int)field->offset;
        reader_report(reader, key->node, "`%s` takes a field of type %s", key->name,
                      wide ? "vec3" : "int or float");
        return -1;
    }
    if (name)
        reader_report(reader, key->node, "%s has no field `%s`", resource->name, name);
    return -1;
}

static void read_label(struct reader *reader, const struct view *view, const struct key *key,
                       struct point_source *source)
{
    const char *name = key_text_of(key);
    source->label = POINT_UNLABELLED;
    if (!name)
        return;
    source->label = strcmp(name, "index") == 0 ? POINT_INDEX : POINT_BUFFER;
    if (source->label == POINT_INDEX)
        return;
    source->label_buffer = find_point_buffer(reader, view, key);
    if (view->pipeline.info->resources[source->label_buffer].stride != sizeof(int32_t))
        reader_report(reader, key->node, "`label` takes a buffer of int");
}

static void read_source(struct reader *reader, const struct view *view, struct fy_node *node,
                        struct point_source *source)
{
    enum { BUFFER, POSITION, COLOR, LABEL, WHERE, RADIUS, COUNT };
    struct key keys[COUNT] = {
        [BUFFER] = {.name = "buffer", .type = KEY_TEXT, .required = true},
        [POSITION] = {.name = "position", .type = KEY_TEXT, .required = true},
        [COLOR] = {.name = "color", .type = KEY_TEXT},
        [LABEL] = {.name = "label", .type = KEY_TEXT},
        [WHERE] = {.name = "where", .type = KEY_TEXT},
        [RADIUS] = KEY_OF_NUMBERS("radius", false, 1, 0.5, 100, 3),
    };
    struct fy_node_pair *first = fy_node_mapping_get_by_index(node, 0);
    reader_mapping(reader, node, first ? fy_node_pair_key(first) : node, "a kind of point", keys,
                   COUNT);
    reader_range(reader, &keys[RADIUS]);
    source->buffer = find_point_buffer(reader, view, &keys[BUFFER]);
    int position = find_point_field(reader, view, source->buffer, &keys[POSITION], true);
    source->position = position < 0 ? 0 : (uint32_t)position;
    source->color = find_point_field(reader, view, source->buffer, &keys[COLOR], true);
    source->where = find_point_field(reader, view, source->buffer, &keys[WHERE], false);
    source->radius = (float)keys[RADIUS].number[0];
    read_label(reader, view, &keys[LABEL], source);
}

/* The next item of a list of at most `most` mappings; NULL: that was the last. */
static struct fy_node *next_item(struct reader *reader, const struct key *key, void **position,
                                 uint32_t taken, uint32_t most)
{
    struct fy_node *item = key->node && fy_node_is_sequence(key->node)
                               ? fy_node_sequence_iterate(key->node, position)
                               : NULL;
    if (item && taken == most) {
        reader_report(reader, item, "`%s` takes at most %u", key->name, most);
        return NULL;
    }
    if (item && !fy_node_is_mapping(item)) {
        reader_report(reader, item, "`%s` takes a list of mappings", key->name);
        return NULL;
    }
    return item;
}

static void read_points(struct reader *reader, const struct view *view, struct fy_node *node,
                        struct view_points *points)
{
    struct key keys[] = {{.name = "name", .type = KEY_TEXT, .required = true},
                         {.name = "of", .type = KEY_SEQUENCE, .required = true}};
    struct fy_node_pair *first = fy_node_mapping_get_by_index(node, 0);
    struct fy_node *item;
    void *position = NULL;
    reader_mapping(reader, node, first ? fy_node_pair_key(first) : node, "an item of `points`",
                   keys, DT_ARRAY_COUNT(keys));
    const char *name = key_text_of(&keys[0]);
    points->name = strdup(name ? name : "");
    while ((item = next_item(reader, &keys[1], &position, points->count, VIEW_MAX_SOURCES)))
        read_source(reader, view, item, &points->sources[points->count++]);
}

static void read_view_outline(struct reader *reader, struct fy_node *root, void *user)
{
    struct view *view = user;
    struct key keys[] = {{.name = "digits", .type = KEY_TEXT},
                         {.name = "points", .type = KEY_SEQUENCE}};
    struct fy_node_pair *first = fy_node_mapping_get_by_index(root, 0);
    struct fy_node *item;
    void *position = NULL;
    reader_mapping(reader, root, first ? fy_node_pair_key(first) : root, "the outline", keys,
                   DT_ARRAY_COUNT(keys));
    const char *digits = key_text_of(&keys[0]);
    view->digits = digits ? live_param(view->pipeline.info, digits) : NULL;
    if (digits && !(view->digits && view->digits->live))
        reader_report(reader, keys[0].node, "%s has no live parameter `%s`",
                      view->pipeline.info->name, digits);
    while ((item = next_item(reader, &keys[1], &position, view->points_count, VIEW_MAX_POINTS)))
        read_points(reader, view, item, &view->points[view->points_count++]);
}

void view_outline_forget(struct view *view)
{
    for (uint32_t i = 0; i < view->points_count; i++)
        free(view->points[i].name);
    memset(view->points, 0, sizeof view->points);
    view->points_count = 0;
    view->digits = NULL;
}

bool view_outline_read(struct view *view)
{
    static const struct file_kind outline_file = {"view outline", "`digits` or `points`",
                                                  read_view_outline};
    const struct dt_log *log = &view->console->log;
    const char *spec = view->pipeline.spec, *dot = strrchr(spec, '.');
    char *path =
        format_string("%.*s/view.yaml", (int)(dot ? dot - spec : (long)strlen(spec)), spec);
    view_outline_forget(view);
    if (!path)
        report_error(log, "out of memory");
    bool good = path && (!file_exists(path) || reader_file(path, &outline_file, view, log));
    if (!good)
        view_outline_forget(view);
    free(path);
    return good;
}
