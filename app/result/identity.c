/* Writes and checks what a dump was made of; see identity.h. Hashes cover content only, no paths, so that
 * they are the same on every machine. */
#include "result/identity.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "result/live.h"
#include "picture/texels.h"
#include "scenes/motion.h"

enum { HASH_TEXT = 17, MOST_UNASKED_FRAMES = 1000 };

/* ---- Hashes ---------------------------------------------------------------------------------- */

static void write_hash(char text[HASH_TEXT], uint64_t hash)
{
    snprintf(text, HASH_TEXT, "%016" PRIx64, hash);
}

void hash_scene(uint64_t *hash, const struct dt_scene *scene)
{
    hash_bytes(hash, scene->vertices, scene->vertex_count * sizeof *scene->vertices);
    hash_bytes(hash, scene->indices, scene->index_count * sizeof *scene->indices);
    hash_bytes(hash, scene->materials, scene->material_count * sizeof *scene->materials);
    hash_bytes(hash, scene->objects, scene->object_count * sizeof *scene->objects);
    hash_bytes(hash, scene->texels, scene_texel_bytes(scene));
}

/* With the motion, which has a say in what history holds. */
static bool hash_scene_file(char text[HASH_TEXT], const struct scene *scene,
                            const struct dt_log *log)
{
    uint64_t hash = FILE_HASH_START;
    const char *path = scene->path;
    bool good = !path || hash_file(&hash, path); /* no file: scene_none */
    if (good && scene->motion)
        good = hash_file(&hash, path = motion_path(scene->motion));
    if (!good)
        report_error(log, "%s: cannot be read", path);
    write_hash(text, hash);
    return good;
}

/* All that the scene hands to a pipeline, in every bit. */
static void hash_scene_data(char text[HASH_TEXT], const struct identity *identity)
{
    uint64_t hash = FILE_HASH_START;
    struct dt_frame frame;
    memset(&frame, 0, sizeof frame);
    scene_frame_at(identity->scene, identity->frame, identity->size[0], identity->size[1], &frame);
    hash_bytes(&hash, &frame, sizeof frame);
    hash_scene(&hash, &identity->scene->data);
    write_hash(text, hash);
}

/* ---- Writing --------------------------------------------------------------------------------- */

/* A number, or a list of them for a vector. */
static cJSON *values_json(const struct dt_param *param, const double *values)
{
    int count = (int)type_components(param->type);
    return count > 1 ? cJSON_CreateDoubleArray(values, count) : cJSON_CreateNumber(values[0]);
}

static cJSON *live_value(const struct dt_param *param, const void *live)
{
    double values[4];
    live_get(live, param, values);
    return values_json(param, values);
}

static cJSON *live_values(const struct identity *identity)
{
    const struct dt_pipeline *info = identity->pipeline;
    cJSON *values = cJSON_CreateObject();
    for (uint32_t i = 0; i < info->param_count; i++) {
        if (info->params[i].live)
            cJSON_AddItemToObject(values, info->params[i].name,
                                  live_value(&info->params[i], identity->live));
    }
    return values;
}

/* The path below the spec's folder or below the templates, which lie elsewhere on other machines. */
static const char *source_name(const char *path, const struct identity *identity)
{
    const char *slash = strrchr(identity->spec, '/');
    const size_t spec = slash ? (size_t)(slash - identity->spec) : 0;
    const size_t templates = strlen(identity->templates);
    if (strncmp(path, identity->spec, spec) == 0 && path[spec] == '/')
        return path + spec + 1;
    if (strncmp(path, identity->templates, templates) == 0 && path[templates] == '/')
        return path + templates + 1;
    slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* {"file": …, "hash": …}, or NULL with the error logged. */
static cJSON *source_item(const char *file, const struct identity *identity,
                          const struct dt_log *log)
{
    char text[HASH_TEXT];
    uint64_t hash = FILE_HASH_START;
    char *path = realpath(file, NULL);
    cJSON *item = path && hash_file(&hash, path) ? cJSON_CreateObject() : NULL;
    if (item) {
        write_hash(text, hash);
        cJSON_AddStringToObject(item, "file", source_name(path, identity));
        cJSON_AddStringToObject(item, "hash", text);
    } else {
        report_error(log, "%s: cannot be read", file);
    }
    free(path);
    return item;
}

/* The spec and the GLSL that it includes, in the order in which they were read. */
static bool add_sources(cJSON *manifest, const struct identity *identity, const struct dt_log *log)
{
    cJSON *list = cJSON_AddArrayToObject(manifest, "sources");
    for (uint32_t i = 0; i < identity->source_count; i++) {
        cJSON *item = source_item(identity->sources[i], identity, log);
        if (!item)
            return false;
        cJSON_AddItemToArray(list, item);
    }
    return true;
}

static void add_params(cJSON *manifest, const struct dt_pipeline *info)
{
    cJSON *values = cJSON_AddObjectToObject(manifest, "params");
    for (uint32_t i = 0; i < info->param_count; i++)
        if (!info->params[i].live)
            cJSON_AddItemToObject(values, info->params[i].name,
                                  values_json(&info->params[i], info->params[i].value));
}

static int compare_strings(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Whether --set names a parameter, whose value stands among "params" or "live". */
static bool sets_param(const char *set, const struct dt_pipeline *info)
{
    size_t length = strcspn(set, "=");
    for (uint32_t i = 0; i < info->param_count; i++) {
        const char *name = info->params[i].name;
        if (strlen(name) == length && strncmp(name, set, length) == 0)
            return true;
    }
    return false;
}

/* Every --set of something else than a parameter, sorted. */
static bool add_sets(cJSON *manifest, const struct identity *identity, const struct dt_log *log)
{
    const struct setup *setup = identity->setup;
    cJSON *list = cJSON_AddArrayToObject(manifest, "set");
    const char **sets = calloc(setup->set_count + 1, sizeof *sets);
    size_t count = 0;
    for (uint32_t i = 0; sets && i < setup->set_count; i++)
        if (!sets_param(setup->sets[i], identity->pipeline))
            sets[count++] = setup->sets[i];
    if (sets)
        qsort(sets, count, sizeof *sets, compare_strings);
    else
        report_error(log, "out of memory");
    for (size_t i = 0; i < count; i++)
        cJSON_AddItemToArray(list, cJSON_CreateString(sets[i]));
    free(sets);
    return sets;
}

/* {"NAME": "HASH"} of every --input. */
static void add_inputs(cJSON *manifest, const struct identity *identity)
{
    cJSON *hashes = cJSON_AddObjectToObject(manifest, "inputs");
    for (uint32_t i = 0; i < identity->input_count; i++) {
        char text[HASH_TEXT];
        write_hash(text, identity->inputs[i].hash);
        cJSON_AddStringToObject(hashes, identity->inputs[i].name, text);
    }
}

/* What the user wrote, not what tools made of it: another glslang makes other SPIR-V. */
static bool add_pipeline(cJSON *manifest, const struct identity *identity, const struct dt_log *log)
{
    cJSON_AddStringToObject(manifest, "diptych", VERSION);
    cJSON_AddStringToObject(manifest, "pipeline", identity->pipeline->name);
    add_params(manifest, identity->pipeline);
    add_inputs(manifest, identity);
    return add_sources(manifest, identity, log) && add_sets(manifest, identity, log);
}

bool identity_add(cJSON *manifest, const struct identity *identity, const struct dt_log *log)
{
    char scene_file[HASH_TEXT], scene_data[HASH_TEXT];
    if (!add_pipeline(manifest, identity, log) ||
        !hash_scene_file(scene_file, identity->scene, log))
        return false;
    hash_scene_data(scene_data, identity);
    cJSON_AddStringToObject(manifest, "backend", identity->backend);
    cJSON_AddStringToObject(manifest, "device", identity->device);
    cJSON_AddItemToObject(manifest, "live", live_values(identity));
    cJSON_AddStringToObject(manifest, "scene",
                            identity->setup->scene ? identity->setup->scene : "");
    cJSON_AddStringToObject(manifest, "scene_file", scene_file);
    cJSON_AddStringToObject(manifest, "scene_data", scene_data);
    cJSON_AddNumberToObject(manifest, "width", identity->size[0]);
    cJSON_AddNumberToObject(manifest, "height", identity->size[1]);
    cJSON_AddNumberToObject(manifest, "frame", identity->frame);
    return true;
}

/* ---- Taking ---------------------------------------------------------------------------------- */

static void report_missing(const char *folder, const char *key, const struct dt_log *log)
{
    report_error(log, "%s/manifest.json: says no \"%s\"; make the dump again with this diptych",
                 folder, key);
}

static const char *find_text(const cJSON *manifest, const char *folder, const char *key,
                             const struct dt_log *log)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(manifest, key));
    if (!text)
        report_missing(folder, key, log);
    return text;
}

static bool find_number(const cJSON *manifest, const char *folder, const char *key, uint32_t most,
                        uint32_t *number, const struct dt_log *log)
{
    const cJSON *item = cJSON_GetObjectItem(manifest, key);
    double value = cJSON_IsNumber(item) ? cJSON_GetNumberValue(item) : -1;
    if (!(value >= 0 && value <= most) || value != (uint32_t)value)
        return report_error(
            log,
            "%s/manifest.json: \"%s\" is missing or no whole number; make the dump again "
            "with this diptych",
            folder, key);
    *number = (uint32_t)value;
    return true;
}

bool identity_take_frame(const cJSON *manifest, const char *folder, struct setup *setup,
                         const struct dt_log *log)
{
    uint32_t width, height, frame;
    if (!find_number(manifest, folder, "width", OPTIONS_MAX_SIZE, &width, log) ||
        !find_number(manifest, folder, "height", OPTIONS_MAX_SIZE, &height, log) ||
        !find_number(manifest, folder, "frame", OPTIONS_MAX_COUNT - 1, &frame, log))
        return false;
    if (setup->size[0] && (setup->size[0] != width || setup->size[1] != height))
        return report_error(log, "--size %ux%u: %s holds a frame of %ux%u", setup->size[0],
                            setup->size[1], folder, width, height);
    if (setup->frames && setup->frames != frame + 1)
        return report_error(log, "--frames %u: %s holds the last of %u frames", setup->frames,
                            folder, frame + 1);
    if (!setup->frames && frame >= MOST_UNASKED_FRAMES)
        return report_error(log, "%s: holds the last of %u frames; ask for as many: --frames %u",
                            folder, frame + 1, frame + 1);
    setup->size[0] = width;
    setup->size[1] = height;
    setup->frames = frame + 1;
    return true;
}

/* The value that --set gives the parameter, or NULL. */
static const char *find_set(const struct setup *setup, const char *name)
{
    size_t length = strlen(name);
    const char *value = NULL;
    for (uint32_t i = 0; i < setup->set_count; i++) {
        const char *set = setup->sets[i];
        if (strncmp(set, name, length) == 0 && set[length] == '=')
            value = set + length + 1;
    }
    return value;
}

static bool take_live(const cJSON *values, const char *folder, const struct setup *setup,
                      const struct dt_pipeline *pipeline, void *live, const struct dt_param *param,
                      const struct dt_log *log)
{
    char *wanted = cJSON_PrintUnformatted(cJSON_GetObjectItem(values, param->name));
    cJSON *own = live_value(param, live);
    const char *set = find_set(setup, param->name);
    bool good = false;
    if (!wanted)
        report_error(log, "%s/manifest.json: says no value of the live parameter %s", folder,
                     param->name);
    else if (set && !cJSON_Compare(own, cJSON_GetObjectItem(values, param->name), true))
        report_error(log, "--set %s=%s: %s was made with %s", param->name, set, folder, wanted);
    else
        good = live_set(pipeline, live, param, wanted, log);
    cJSON_Delete(own);
    cJSON_free(wanted);
    return good;
}

bool identity_take_live(const cJSON *manifest, const char *folder, const struct setup *setup,
                        const struct dt_pipeline *pipeline, void *live, const struct dt_log *log)
{
    const cJSON *values = cJSON_GetObjectItem(manifest, "live");
    for (uint32_t i = 0; i < pipeline->param_count; i++) {
        const struct dt_param *param = &pipeline->params[i];
        if (param->live && !take_live(values, folder, setup, pipeline, live, param, log))
            return false;
    }
    return true;
}

/* ---- Checking -------------------------------------------------------------------------------- */

/* Reports that the dump is of another pipeline, and what differs. */
static void report_other(const char *folder, const char *name, const char *difference,
                         const struct dt_log *log)
{
    report_error(
        log,
        "--against %s: holds another %s: %s; the spec, its GLSL, --set, files, --input and "
        "the version of diptych must be the same",
        folder, name, difference);
}

static const char *file_of(const cJSON *source)
{
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(source, "file"));
    return name ? name : "a file";
}

static bool same_item(const cJSON *a, const cJSON *b, const char *key)
{
    return cJSON_Compare(cJSON_GetObjectItem(a, key), cJSON_GetObjectItem(b, key), true);
}

/* The first file of one name and two contents, or NULL; free(). */
static char *differing_content(const cJSON *there, const cJSON *here)
{
    const cJSON *own, *other;
    cJSON_ArrayForEach(own, here)
    {
        bool named = false, same = false;
        cJSON_ArrayForEach(other, there)
        {
            bool namesake = same_item(own, other, "file");
            named = named || namesake;
            same = same || (namesake && same_item(own, other, "hash"));
        }
        if (named && !same)
            return format_string("%s has other content", file_of(own));
    }
    return NULL;
}

/* The first place at which the two lists of files differ in content, or NULL; free(). File names are
 * printed but not compared: the same files may be in another folder. */
static char *differing_list(const cJSON *there, const cJSON *here)
{
    const cJSON *a = there->child, *b = here->child;
    while (a && b && same_item(a, b, "hash")) {
        a = a->next;
        b = b->next;
    }
    if (a && b)
        return format_string("it reads %s there, %s here", file_of(a), file_of(b));
    if (a || b)
        return format_string("it reads %s %s only", file_of(a ? a : b), a ? "there" : "here");
    return NULL;
}

/* "WHAT is 1 there, 2 here"; free(). */
static char *there_here(const char *what, const cJSON *there, const cJSON *here)
{
    char *theirs = there ? cJSON_PrintUnformatted(there) : NULL,
         *ours = cJSON_PrintUnformatted(here);
    char *text =
        format_string("%s%s there, %s here", what, theirs ? theirs : "missing", ours ? ours : "?");
    cJSON_free(theirs);
    cJSON_free(ours);
    return text;
}

/* The first member with another value there, or NULL. */
static const cJSON *differing_member(const cJSON *there, const cJSON *here)
{
    const cJSON *own = here->child;
    while (own && cJSON_Compare(own, cJSON_GetObjectItem(there, own->string), true))
        own = own->next;
    return own;
}

/* The first parameter that differs, or NULL; free(). */
static char *differing_param(const cJSON *there, const cJSON *here)
{
    const cJSON *own = differing_member(there, here);
    char *what = own ? format_string("%s is ", own->string) : NULL;
    char *text = what ? there_here(what, cJSON_GetObjectItem(there, own->string), own) : NULL;
    free(what);
    return text;
}

/* Says how the --set of values that are not parameters differ, or NULL; free(). */
static char *differing_sets(const cJSON *there, const cJSON *here)
{
    return cJSON_Compare(there, here, true) ? NULL : there_here("--set ", there, here);
}

/* The first input of another content, or NULL; free(). */
static char *differing_input(const cJSON *there, const cJSON *here)
{
    const cJSON *own = differing_member(there, here);
    return own ? format_string("--input %s has other content", own->string) : NULL;
}

static char *differing_version(const cJSON *there, const cJSON *here)
{
    if (cJSON_Compare(there, here, true))
        return NULL;
    return format_string("diptych %s made it, this is %s", cJSON_GetStringValue(there),
                         cJSON_GetStringValue(here));
}

/* In the order of reporting, causes first: a new spec may have new parameters, and a parameter may leave
 * out passes with their files. */
static const struct {
    const char *key;
    cJSON_bool (*has_type)(const cJSON *item);
    char *(*difference)(const cJSON *there, const cJSON *here);
} compared[] = {
    {"diptych", cJSON_IsString, differing_version}, {"sources", cJSON_IsArray, differing_content},
    {"params", cJSON_IsObject, differing_param},    {"set", cJSON_IsArray, differing_sets},
    {"inputs", cJSON_IsObject, differing_input},    {"sources", cJSON_IsArray, differing_list}};

static bool check_pipeline(const cJSON *manifest, const char *folder,
                           const struct identity *identity, const struct dt_log *log)
{
    const char *own = identity->pipeline->name;
    const char *name = find_text(manifest, folder, "pipeline", log);
    if (name && strcmp(name, own) != 0)
        report_error(log, "--against %s: holds the pipeline %s, this is %s; name its --spec",
                     folder, name, own);
    if (!name || strcmp(name, own) != 0)
        return false;
    cJSON *here = cJSON_CreateObject();
    bool good = add_pipeline(here, identity, log);
    for (size_t i = 0; i < DT_ARRAY_COUNT(compared) && good; i++) {
        const char *key = compared[i].key;
        const cJSON *there = cJSON_GetObjectItem(manifest, key);
        good = compared[i].has_type(there);
        if (!good)
            report_missing(folder, key, log);
        char *text = good ? compared[i].difference(there, cJSON_GetObjectItem(here, key)) : NULL;
        if (text) {
            report_other(folder, name, text, log);
            good = false;
        }
        free(text);
    }
    cJSON_Delete(here);
    return good;
}

bool identity_check(const cJSON *manifest, const char *folder, const struct identity *identity,
                    const struct dt_log *log)
{
    char file[HASH_TEXT], data[HASH_TEXT];
    const char *name = find_text(manifest, folder, "scene", log);
    const char *wanted_file = name ? find_text(manifest, folder, "scene_file", log) : NULL;
    const char *wanted_data = wanted_file ? find_text(manifest, folder, "scene_data", log) : NULL;
    if (!wanted_data || !check_pipeline(manifest, folder, identity, log) ||
        !hash_scene_file(file, identity->scene, log))
        return false;
    hash_scene_data(data, identity);
    if (strcmp(file, wanted_file) != 0)
        return report_error(log, "--against %s: was made of %s, and %s has other content%s", folder,
                            name, identity->setup->scene ? identity->setup->scene : "no scene",
                            identity->scene->motion ? ", or its motion has" : "");
    if (strcmp(data, wanted_data) != 0)
        report_message(log, DT_WARNING,
                       "--against %s: mesh, textures or camera have other bits there, though the "
                       "scene file is the same: passes that use the scene may differ for that",
                       folder);
    return true;
}
