/* Reads evidence folders; see evidence.h. A mismatch with the manifest or the pipeline is an error
 * that names the file: a damaged copy must not look like a difference. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "base/foreign.h"
#include "compare/evidence.h"

static const struct dt_log *log_of(const struct evidence_case *evidence)
{
    return &evidence->console->log;
}

static bool case_out_of_memory(const struct evidence_case *evidence)
{
    return report_error(log_of(evidence), "out of memory");
}

static bool manifest_error(const struct evidence_case *evidence, const char *key)
{
    return report_error(log_of(evidence),
                        "%s/manifest.json: \"%s\" is missing or wrong: the folder is damaged",
                        evidence->folder, key);
}

/* ---- The manifest ---------------------------------------------------------------------------- */

static const char *read_string(const struct evidence_case *evidence, const cJSON *object,
                               const char *key)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, key));
    if (!text)
        manifest_error(evidence, key);
    return text;
}

static bool read_member(const struct evidence_case *evidence, const cJSON *object, const char *key,
                        uint32_t *number)
{
    const cJSON *item = cJSON_GetObjectItem(object, key);
    double value = cJSON_IsNumber(item) ? cJSON_GetNumberValue(item) : -1;
    if (!(value >= 0 && value <= UINT32_MAX))
        return manifest_error(evidence, key);
    *number = (uint32_t)value;
    return true;
}

static bool read_case_manifest(struct evidence_case *evidence)
{
    uint32_t version;
    evidence->reader.manifest = foreign_json(evidence->folder, "manifest.json", log_of(evidence));
    bool good = evidence->reader.manifest;
    if (good && !cJSON_HasObjectItem(evidence->reader.manifest, EVIDENCE_MARK)) {
        report_error(log_of(evidence), "%s/manifest.json: is no folder of compare --bisect",
                     evidence->folder);
        good = false;
    }
    good = good && read_member(evidence, evidence->reader.manifest, EVIDENCE_MARK, &version);
    if (good && version != EVIDENCE_VERSION) {
        report_error(log_of(evidence),
                     "%s/manifest.json: has version %u, and this diptych reads version %d",
                     evidence->folder, version, EVIDENCE_VERSION);
        good = false;
    }
    return good;
}

/* ---- The pipeline ---------------------------------------------------------------------------- */

/* The real path of a file in the folder. The folder may come from anyone: no name leads outside. */
static char *path_within(const struct evidence_case *evidence, const char *name)
{
    char *path = format_string("%s/%s", evidence->root, name);
    char *real = path ? realpath(path, NULL) : NULL;
    size_t length = strlen(evidence->root);
    if (!path) {
        case_out_of_memory(evidence);
    } else if (!real) {
        report_error(log_of(evidence), "%s: cannot be read: %s", path, strerror(errno));
    } else if (strncmp(real, evidence->root, length) != 0 || real[length] != '/') {
        report_error(log_of(evidence), "%s/manifest.json: names %s, which is outside the folder",
                     evidence->folder, name);
        free(real);
        real = NULL;
    }
    free(path);
    return real;
}

static bool read_setup(struct evidence_case *evidence)
{
    const cJSON *sets = cJSON_GetObjectItem(evidence->reader.manifest, "set");
    struct setup *setup = &evidence->setup;
    const char *spec = read_string(evidence, evidence->reader.manifest, "spec");
    const char *templates =
        spec ? read_string(evidence, evidence->reader.manifest, "templates") : NULL;
    if (!templates || !read_member(evidence, evidence->reader.manifest, "width", &setup->size[0]) ||
        !read_member(evidence, evidence->reader.manifest, "height", &setup->size[1]))
        return false;
    int count = cJSON_GetArraySize(sets);
    setup->sets = calloc((size_t)count + 1, sizeof *setup->sets);
    for (int i = 0; i < count && setup->sets; i++) {
        const char *set = cJSON_GetStringValue(cJSON_GetArrayItem(sets, i));
        if (!set || !strchr(set, '='))
            return manifest_error(evidence, "set");
        setup->sets[setup->set_count++] = set;
    }
    evidence->spec = path_within(evidence, spec);
    evidence->templates = path_within(evidence, templates);
    setup->spec = evidence->spec;
    setup->templates = evidence->templates;
    return setup->sets && setup->spec && setup->templates;
}

static bool find_pass(struct evidence_case *evidence)
{
    const struct dt_pipeline *info = evidence->pipeline.info;
    const char *name = read_string(evidence, evidence->reader.manifest, "pass");
    for (uint32_t i = 0; name && i < info->pass_count; i++) {
        if (strcmp(info->passes[i].name, name) == 0) {
            evidence->pass = i;
            return true;
        }
    }
    if (name)
        report_error(log_of(evidence), "%s: has no pass %s", evidence->spec, name);
    return false;
}

/* ---- Bytes ----------------------------------------------------------------------------------- */

/* A file of exactly that size. */
static void *read_exactly(const struct evidence_case *evidence, const char *name, size_t size)
{
    return foreign_read_exactly(evidence->folder, name, size, log_of(evidence));
}

static bool read_block(const struct evidence_case *evidence, const char *key, void *block,
                       size_t size)
{
    const char *name = read_string(evidence, evidence->reader.manifest, key);
    void *data = name ? read_exactly(evidence, name, size) : NULL;
    if (data)
        memcpy(block, data, size);
    free(data);
    return data;
}

bool evidence_actual(const struct evidence_case *evidence, const struct row *row,
                     struct dt_bytes *bytes)
{
    const struct dump_reader *reader = &evidence->reader;
    return dump_reader_load(reader, dump_reader_find(reader, "outputs", NULL, row), "actual", row,
                            false, bytes);
}

/* ---- The scene ------------------------------------------------------------------------------- */

/* Sizes and indices with which no shader reads outside the arrays. */
static bool check_scene(const struct evidence_case *evidence)
{
    const struct dt_scene *scene = &evidence->scene.data;
    bool good = scene->index_count % 3 == 0;
    for (uint32_t i = 0; good && i < scene->index_count; i++)
        good = scene->indices[i] < scene->vertex_count;
    for (uint32_t i = 0; good && i < scene->vertex_count; i++)
        good = scene->vertices[i].material < scene->material_count &&
               scene->vertices[i].triangle < scene->index_count / 3;
    for (uint32_t i = 0; good && i < scene->object_count; i++)
        good = scene->objects[i].material < scene->material_count &&
               (uint64_t)scene->objects[i].first_index + scene->objects[i].index_count <=
                   scene->index_count;
    for (uint32_t i = 0; good && i < scene->material_count; i++)
        good = scene->materials[i].texture < (int32_t)scene->texture_layers;
    return good || report_error(log_of(evidence),
                                "%s: its scene names vertices, materials, objects or textures that "
                                "it does not have: the folder is damaged",
                                evidence->folder);
}

static bool check_texture(const struct evidence_case *evidence)
{
    enum { MOST_SIZE = 16384, MOST_LAYERS = 4096, MOST_MIPS = 15 };
    const struct dt_scene *scene = &evidence->scene.data;
    return (scene->texture_width >= 1 && scene->texture_width <= MOST_SIZE &&
            scene->texture_height >= 1 && scene->texture_height <= MOST_SIZE &&
            scene->texture_layers >= 1 && scene->texture_layers <= MOST_LAYERS &&
            scene->texture_mips >= 1 && scene->texture_mips <= MOST_MIPS) ||
           manifest_error(evidence, "scene");
}

static bool read_scene(struct evidence_case *evidence)
{
    const cJSON *entry = cJSON_GetObjectItem(evidence->reader.manifest, "scene");
    struct dt_scene *scene = &evidence->scene.data;
    if (!evidence->pipeline.info->passes[evidence->pass].uses_scene)
        return scene_none(&evidence->scene, log_of(evidence));
    if (!read_member(evidence, entry, "vertices", &scene->vertex_count) ||
        !read_member(evidence, entry, "indices", &scene->index_count) ||
        !read_member(evidence, entry, "materials", &scene->material_count) ||
        !read_member(evidence, entry, "objects", &scene->object_count) ||
        !read_member(evidence, entry, "texture_width", &scene->texture_width) ||
        !read_member(evidence, entry, "texture_height", &scene->texture_height) ||
        !read_member(evidence, entry, "texture_layers", &scene->texture_layers) ||
        !read_member(evidence, entry, "texture_mips", &scene->texture_mips) ||
        !check_texture(evidence))
        return false;
    scene->vertices =
        read_exactly(evidence, "scene/vertices.raw", scene->vertex_count * sizeof *scene->vertices);
    scene->indices = scene->vertices ? read_exactly(evidence, "scene/indices.raw",
                                                    scene->index_count * sizeof *scene->indices)
                                     : NULL;
    scene->materials = scene->indices
                           ? read_exactly(evidence, "scene/materials.raw",
                                          scene->material_count * sizeof *scene->materials)
                           : NULL;
    scene->objects = scene->materials ? read_exactly(evidence, "scene/objects.raw",
                                                     scene->object_count * sizeof *scene->objects)
                                      : NULL;
    scene->texels = scene->objects
                        ? read_exactly(evidence, "scene/texels.raw", scene_texel_bytes(scene))
                        : NULL;
    return scene->texels && check_scene(evidence);
}

/* ---- All of it ------------------------------------------------------------------------------- */

bool evidence_read(struct evidence_case *evidence, struct console *console, const char *folder,
                   const struct setup *setup)
{
    *evidence = (struct evidence_case){.console = console, .folder = folder, .setup = *setup};
    evidence->reader =
        (struct dump_reader){.folder = folder, .log = &console->log, .evidence = true};
    evidence->setup.sets = NULL;
    evidence->setup.set_count = 0;
    evidence->root = realpath(folder, NULL);
    evidence->setup.root = evidence->root;
    if (!evidence->root)
        return report_error(log_of(evidence), "%s/manifest.json: cannot be read: %s", folder,
                            strerror(errno));
    if (!read_case_manifest(evidence) || !read_setup(evidence))
        return false;
    struct pipeline *pipeline = &evidence->pipeline;
    memcpy(evidence->reader.size, evidence->setup.size, sizeof evidence->reader.size);
    if (!pipeline_load(pipeline, console, &evidence->setup))
        return false;
    evidence->reader.pipeline = pipeline->info;
    return find_pass(evidence) && rows_make(&evidence->rows, pipeline->info, log_of(evidence)) &&
           read_block(evidence, "live_block", pipeline->live, pipeline->info->live_size) &&
           read_block(evidence, "frame_block", &evidence->frame, sizeof evidence->frame) &&
           read_scene(evidence);
}

void evidence_free(struct evidence_case *evidence)
{
    scene_free(&evidence->scene);
    rows_free(&evidence->rows);
    pipeline_unload(&evidence->pipeline);
    free(evidence->setup.sets);
    free(evidence->templates);
    free(evidence->spec);
    free(evidence->root);
    dump_reader_close(&evidence->reader);
    *evidence = (struct evidence_case){0};
}
