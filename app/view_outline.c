/* What a pipeline offers the window beside what every one does: the outline, a YAML file that
 * belongs to a spec, NAME/view.yaml beside NAME.yaml; there need be none.
 *
 *   digits: NAME              live parameter that the keys 0 to 9 set
 *   points:                   elements of buffers over the picture, a list of
 *     - name: TEXT
 *       of: [{buffer: NAME, position: FIELD, color: FIELD, label: index|BUFFER, where: FIELD,
 *             radius: PIXELS}, ...]                  only buffer and position must be there
 *
 * Called by view.c. */
#include "view.h"

#include <cjson/cJSON.h>
#include <libfyaml.h>
#include <stdlib.h>
#include <string.h>

#include "files.h"

struct reader {
    struct view *view;
    const char *path;
    const struct dt_log *log;
};

static const char *text_of(const cJSON *object, const char *name)
{
    return cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
}

static bool flaw(const struct reader *reader, const char *what, const char *name)
{
    report_error(reader->log, "%s: %s%s%s", reader->path, what, name ? " " : "", name ? name : "");
    return false;
}

/* libfyaml says on stderr, with line and column, what is no YAML. */
static cJSON *read_yaml(const char *path)
{
    struct fy_document *document = fy_document_build_from_file(NULL, path);
    char *text = document ? fy_emit_document_to_string(document, FYECF_MODE_JSON_ONELINE) : NULL;
    cJSON *root = text ? cJSON_Parse(text) : NULL;
    free(text);
    fy_document_destroy(document);
    return root;
}

static bool find_buffer(const struct reader *reader, const char *name, uint32_t *index)
{
    const struct dt_pipeline *info = reader->view->pipeline.info;
    for (*index = 0; name && *index < info->resource_count; ++*index)
        if (info->resources[*index].kind == DT_BUFFER &&
            strcmp(info->resources[*index].name, name) == 0)
            return true;
    return flaw(reader, "the pipeline has no buffer", name ? name : "without a name");
}

/* The offset of a field, -1: none is asked for; false: there is none of that name. */
static bool find_field(const struct reader *reader, uint32_t buffer, const char *name, int *offset)
{
    const struct dt_resource *resource = &reader->view->pipeline.info->resources[buffer];
    *offset = -1;
    for (uint32_t i = 0; name && i < resource->field_count; i++)
        if (strcmp(resource->fields[i].name, name) == 0)
            *offset = (int)resource->fields[i].offset;
    return !name || *offset >= 0 || flaw(reader, "the buffer has no field", name);
}

static bool find_label(const struct reader *reader, const char *name, struct point_source *source)
{
    source->label = !name                        ? POINT_UNLABELLED
                    : strcmp(name, "index") == 0 ? POINT_INDEX
                                                 : POINT_BUFFER;
    return source->label != POINT_BUFFER || find_buffer(reader, name, &source->label_buffer);
}

static bool read_source(const struct reader *reader, const cJSON *item, struct point_source *source)
{
    const cJSON *radius = cJSON_GetObjectItem(item, "radius");
    int position;
    *source = (struct point_source){.radius = radius ? (float)radius->valuedouble : 3};
    if (!find_buffer(reader, text_of(item, "buffer"), &source->buffer) ||
        !find_field(reader, source->buffer, text_of(item, "position"), &position) ||
        !find_field(reader, source->buffer, text_of(item, "color"), &source->color) ||
        !find_field(reader, source->buffer, text_of(item, "where"), &source->where) ||
        !find_label(reader, text_of(item, "label"), source))
        return false;
    source->position = (uint32_t)position;
    return position >= 0 || flaw(reader, "points take a `position`, a field of their buffer", NULL);
}

static bool read_points(const struct reader *reader, const cJSON *item, struct view_points *points)
{
    const char *name = text_of(item, "name");
    const cJSON *source;
    points->name = strdup(name ? name : "points");
    cJSON_ArrayForEach(source, cJSON_GetObjectItem(item, "of"))
    {
        if (points->count == VIEW_MAX_SOURCES)
            return flaw(reader, "too many buffers in the points", name);
        if (!read_source(reader, source, &points->sources[points->count++]))
            return false;
    }
    return points->name;
}

static bool read_outline(const struct reader *reader, const cJSON *root)
{
    struct view *view = reader->view;
    const char *digits = text_of(root, "digits");
    const struct dt_param *param = digits ? pipeline_param(view->pipeline.info, digits) : NULL;
    const cJSON *item;
    if (digits && !(param && param->live))
        return flaw(reader, "the pipeline has no live parameter", digits);
    view->digits = param;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(root, "points"))
    {
        if (view->points_count == VIEW_MAX_POINTS)
            return flaw(reader, "too many `points`", NULL);
        if (!read_points(reader, item, &view->points[view->points_count++]))
            return false;
    }
    return true;
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
    const char *spec = view->pipeline.spec;
    const char *dot = strrchr(spec, '.');
    char *path =
        format_string("%.*s/view.yaml", (int)(dot ? dot - spec : (long)strlen(spec)), spec);
    struct reader reader = {view, path, &view->console->log};
    cJSON *root = path && file_exists(path) ? read_yaml(path) : NULL;
    view_outline_forget(view);
    bool good = path && (!file_exists(path) || (root && read_outline(&reader, root)));
    if (path && file_exists(path) && !root)
        flaw(&reader, "is no YAML file", NULL);
    if (!good)
        view_outline_forget(view);
    cJSON_Delete(root);
    free(path);
    return good;
}
