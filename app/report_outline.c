/* What a report shows: the outline, a YAML file that belongs to a spec, and the scenes.
 *
 *   title, source            what the pipeline is, and where it comes from
 *   scenes: [FILE, ...]      beside the outline, for when --scene names none
 *   reference: {bounces: N, title: ...}
 *   pictures: [{name: ..., title: ..., set: [PATH=VALUE, ...]}, ...]
 *   sweep: {parameter: NAME, values: [...]}       of each picture; the last value is the best
 *   stages: [{name: ..., doc: ..., passes: [...]}, ...]
 *   published: {by, device, scene, size, stages: {NAME: [ms of each value of the sweep]}, total: [...],
 *               own_error: {metric: ..., values: [...]}}
 *
 * Only pictures, sweep and reference must be there. Called by report.c. */
#include <errno.h>
#include <libfyaml.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files.h"
#include "pipeline.h"
#include "report.h"
#include "scenes/scene.h"

const char *report_text(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text ? text : "";
}

const char *report_item(const cJSON *list, int index, char buffer[32])
{
    const cJSON *item = cJSON_GetArrayItem(list, index);
    if (cJSON_IsString(item))
        return item->valuestring;
    buffer[0] = 0;
    if (cJSON_IsNumber(item))
        snprintf(buffer, 32, "%.9g", item->valuedouble);
    return buffer;
}

/* ---- The outline ----------------------------------------------------------------------------- */

/* ssvp/report.yaml for ssvp.yaml. */
static char *find_outline(const struct report *report)
{
    const char *given = report->options->outline;
    const char *dot = strrchr(report->spec, '.');
    int length = (int)(dot ? dot - report->spec : (long)strlen(report->spec));
    char *path = given ? strdup(given) : format_string("%.*s/report.yaml", length, report->spec);
    char *real = path ? realpath(path, NULL) : NULL;
    if (!real)
        report_error(&report->console->log,
                     "%s: cannot be read: %s; it says what a report of this spec shows, see "
                     "templates/ssvp/report.yaml; --outline names another",
                     path ? path : "outline", strerror(errno));
    free(path);
    return real;
}

/* libfyaml says on stderr, with line and column, what is no YAML. */
static cJSON *read_yaml(const char *path, const struct dt_log *log)
{
    struct fy_document *document = fy_document_build_from_file(NULL, path);
    char *text = document ? fy_emit_document_to_string(document, FYECF_MODE_JSON_ONELINE) : NULL;
    cJSON *root = text ? cJSON_Parse(text) : NULL;
    if (!root)
        report_error(log, "%s: is no YAML file", path);
    free(text);
    fy_document_destroy(document);
    return root;
}

/* Whether there is a list of one thing or more, with `words` of nothing but text. */
static bool is_list(const cJSON *object, const char *name, bool words)
{
    const cJSON *item, *list = cJSON_GetObjectItem(object, name);
    cJSON_ArrayForEach(item, list)
    {
        if (words && !cJSON_IsString(item))
            return false;
    }
    return cJSON_IsArray(list) && cJSON_GetArraySize(list) > 0;
}

/* A word that can be the name of a file. */
static bool is_name(const char *text)
{
    return *text && text[0] != '.' && !strpbrk(text, "/\n|");
}

static const char *picture_flaw(const cJSON *outline)
{
    const cJSON *picture;
    if (!is_list(outline, "pictures", false))
        return "`pictures` must be a list of {name, title, set}";
    cJSON_ArrayForEach(picture, cJSON_GetObjectItem(outline, "pictures"))
    {
        if (!is_name(report_text(picture, "name")) || !*report_text(picture, "title") ||
            !is_list(picture, "set", true))
            return "each of `pictures` takes a `name`, a `title` and a list `set`";
    }
    return NULL;
}

static const char *stage_flaw(const cJSON *outline)
{
    const cJSON *stage;
    if (cJSON_HasObjectItem(outline, "stages") && !is_list(outline, "stages", false))
        return "`stages` must be a list of {name, passes}";
    cJSON_ArrayForEach(stage, cJSON_GetObjectItem(outline, "stages"))
    {
        if (!*report_text(stage, "name") || !is_list(stage, "passes", true))
            return "each of `stages` takes a `name` and a list `passes`";
    }
    return NULL;
}

static bool are_numbers(const cJSON *list, int least, int most)
{
    const cJSON *item;
    int count = cJSON_GetArraySize(list);
    cJSON_ArrayForEach(item, list)
    {
        if (!cJSON_IsNumber(item))
            return false;
    }
    return !list || (cJSON_IsArray(list) && count >= least && count <= most);
}

static const char *published_flaw(const cJSON *outline, int values)
{
    const cJSON *item, *published = cJSON_GetObjectItem(outline, "published");
    const cJSON *stages = cJSON_GetObjectItem(published, "stages");
    const cJSON *error = cJSON_GetObjectItem(published, "own_error");
    bool good = are_numbers(cJSON_GetObjectItem(published, "total"), values, values);
    cJSON_ArrayForEach(item, stages) good = good && are_numbers(item, values, values);
    if (!good)
        return "`total` and each of `stages` in `published` take as many numbers as the sweep has "
               "values";
    if (!are_numbers(cJSON_GetObjectItem(error, "values"), 1, values))
        return "`own_error` in `published` takes no more `values` than the sweep has";
    return NULL;
}

/* What is wrong with an outline, or NULL. */
static const char *outline_flaw(const cJSON *outline)
{
    const cJSON *sweep = cJSON_GetObjectItem(outline, "sweep");
    const cJSON *reference = cJSON_GetObjectItem(outline, "reference");
    const char *flaw = picture_flaw(outline);
    if (!cJSON_IsObject(outline))
        return "must be a mapping with `pictures`, `sweep` and `reference`";
    if (flaw)
        return flaw;
    if (!*report_text(sweep, "parameter") || !is_list(sweep, "values", false))
        return "`sweep` takes a `parameter` and a list `values`";
    if (!cJSON_IsNumber(cJSON_GetObjectItem(reference, "bounces")))
        return "`reference` takes a number of `bounces`";
    if (cJSON_HasObjectItem(outline, "scenes") && !is_list(outline, "scenes", true))
        return "`scenes` must be a list of files";
    flaw = stage_flaw(outline);
    return flaw ? flaw
                : published_flaw(outline, cJSON_GetArraySize(cJSON_GetObjectItem(sweep, "values")));
}

bool report_read_outline(struct report *report)
{
    const struct dt_log *log = &report->console->log;
    report->outline_path = find_outline(report);
    report->outline = report->outline_path ? read_yaml(report->outline_path, log) : NULL;
    const char *flaw = report->outline ? outline_flaw(report->outline) : NULL;
    if (flaw)
        report_error(log, "%s: %s", report->outline_path, flaw);
    return report->outline && !flaw;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

static bool is_taken(const struct report *report, const char *name)
{
    for (uint32_t i = 0; i < report->scene_count; i++) {
        if (strcmp(report->scenes[i].name, name) == 0)
            return true;
    }
    return false;
}

static bool add_scene(struct report *report, const char *path)
{
    const struct dt_log *log = &report->console->log;
    struct report_scene *scene = &report->scenes[report->scene_count];
    scene->path = realpath(path, NULL);
    const char *slash = scene->path ? strrchr(scene->path, '/') : NULL;
    if (!slash) {
        report_error(log, "%s: cannot be read: %s", path, strerror(errno));
        return false;
    }
    const char *dot = strrchr(slash, '.');
    scene->name =
        dot > slash + 1 ? strndup(slash + 1, (size_t)(dot - slash) - 1) : strdup(slash + 1);
    if (!scene->name || !is_name(scene->name) || strcmp(scene->name, "plots") == 0 ||
        is_taken(report, scene->name)) {
        report_error(log, "%s: the report cannot have a folder \"%s\" for it; rename the file",
                     scene->path, scene->name ? scene->name : "");
        free(scene->name);
        free(scene->path);
        return false;
    }
    report->scene_count++;
    if (!scene_find_mesh(scene->path, report->scenes_folder, &scene->mesh, log))
        return false;
    if (!scene->mesh)
        report_message(log, DT_WARNING,
                       "%s is left out, its mesh is not here; --scenes or DIPTYCH_SCENES names the "
                       "folder that holds it",
                       scene->path);
    return true;
}

static bool add_outline_scenes(struct report *report)
{
    const char *slash = strrchr(report->outline_path, '/');
    const cJSON *item, *list = cJSON_GetObjectItem(report->outline, "scenes");
    bool good = true;
    cJSON_ArrayForEach(item, list)
    {
        const char *name = cJSON_GetStringValue(item) ? item->valuestring : "";
        char *path = name[0] == '/' ? strdup(name)
                                    : format_string("%.*s/%s", (int)(slash - report->outline_path),
                                                    report->outline_path, name);
        good = good && path && add_scene(report, path);
        free(path);
    }
    return good;
}

bool report_find_scenes(struct report *report)
{
    const struct text_list *given = &report->options->scene_list;
    const struct dt_log *log = &report->console->log;
    const cJSON *list = cJSON_GetObjectItem(report->outline, "scenes");
    uint32_t most = given->count ? given->count : (uint32_t)cJSON_GetArraySize(list), here = 0;
    bool good = true;
    report->scenes = calloc(most + 1, sizeof *report->scenes);
    if (!report->scenes) {
        report_error(log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < given->count && good; i++)
        good = add_scene(report, given->items[i]);
    if (!given->count)
        good = add_outline_scenes(report);
    for (uint32_t i = 0; i < report->scene_count; i++)
        here += report->scenes[i].mesh != NULL;
    if (good && !here)
        report_error(log, "no scene is left for the report; name one by --scene FILE");
    return good && here;
}
