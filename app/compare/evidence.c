/* Writes evidence folders; see evidence.h. What is in one:
 *   manifest.json               everything else by name, for programs
 *   README.txt                  for people
 *   templates/, spec/           the spec with its GLSL bodies and library, as they were
 *   generated/gl, generated/vk  what became of the pass's body
 *   inputs/                     what the pass found, the same for both sides
 *   expected/, actual/          what the first and the second side left
 *   frame.raw, live.raw         the uniform blocks
 *   scene/                      for a pass that uses the scene */
#include "compare/evidence.h"

#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "console/folder.h"
#include "result/dump.h"

#define OPTION "--bisect"

struct writing {
    const struct evidence *evidence;
    struct folder folder;
    const struct dt_log *log;
    cJSON *manifest;
    char *spec_root; /* common folder of all that the spec is made of outside the templates */
    char *spec_name; /* of the spec, in the folder */
};

static const struct row *guilty_row(const struct evidence *evidence)
{
    return &evidence->rows->outputs.list[evidence->guilty];
}

static const struct dt_pass *guilty_pass(const struct evidence *evidence)
{
    return &evidence->pipeline->info->passes[guilty_row(evidence)->pass];
}

static bool writing_out_of_memory(const struct writing *writing)
{
    return report_error(writing->log, "out of memory");
}

/* ---- The spec and what it is made of --------------------------------------------------------- */

/* What follows `folder` and its slash, or NULL when the path does not lead into it. */
static const char *within(const char *path, const char *folder)
{
    size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 && path[length] == '/' ? path + length + 1 : NULL;
}

/* Shortens the spec's root until this file lies in it. */
static bool widen_root(void *user, const char *file)
{
    struct writing *writing = user;
    char *path = folder_plain_path(file);
    if (!path)
        return writing_out_of_memory(writing);
    while (!within(path, writing->evidence->pipeline->templates) &&
           !within(path, writing->spec_root) && writing->spec_root[0])
        *strrchr(writing->spec_root, '/') = 0;
    free(path);
    return true;
}

/* Path of a spec file in the folder: templates/... or spec/.... */
static char *copied_name(const struct writing *writing, const char *file)
{
    char *path = folder_plain_path(file);
    const char *shared = path ? within(path, writing->evidence->pipeline->templates) : NULL;
    const char *own = path ? within(path, writing->spec_root) : NULL;
    char *name =
        shared ? format_string("templates/%s", shared) : format_string("spec/%s", own ? own : "");
    free(path);
    return name;
}

static bool copy_as(const struct writing *writing, const char *file, const char *name)
{
    size_t size;
    char *text = file_read(file, &size, writing->log);
    bool good = text && folder_write_at(&writing->folder, name, text, size);
    free(text);
    return good;
}

static bool copy_file(void *user, const char *file)
{
    const struct writing *writing = user;
    char *name = copied_name(writing, file);
    bool good = name ? copy_as(writing, file, name) : writing_out_of_memory(writing);
    free(name);
    return good;
}

/* Calls `take` for the spec and everything that it includes, until it returns false. */
static bool each_source(const struct writing *writing, bool (*take)(void *user, const char *file),
                        void *user)
{
    uint32_t count;
    const char *const *sources = plan_sources(writing->evidence->pipeline->plan, &count);
    bool good = true;
    for (uint32_t i = 0; i < count && good; i++)
        good = take(user, sources[i]);
    return good;
}

static bool copy_spec(struct writing *writing)
{
    const struct pipeline *pipeline = writing->evidence->pipeline;
    writing->spec_root = strdup(pipeline->spec);
    bool good = writing->spec_root;
    if (!good)
        writing_out_of_memory(writing);
    if (good)
        *strrchr(writing->spec_root, '/') = 0;
    good = good && each_source(writing, widen_root, writing) &&
           each_source(writing, copy_file, writing);
    if (good)
        writing->spec_name = copied_name(writing, pipeline->spec);
    return good && writing->spec_name;
}

static bool copy_generated(const struct writing *writing)
{
    static const char *const backends[] = {"gl", "vk"}, *const stages[] = {"comp", "vert", "frag"};
    const struct pipeline *pipeline = writing->evidence->pipeline;
    const struct dt_pass *pass = guilty_pass(writing->evidence);
    bool good = true;
    for (int i = 0; i < 6 && good; i++) {
        const char *glsl = NULL;
        char *name =
            format_string("generated/%s/%s.%s", backends[i / 3], pass->name, stages[i % 3]);
        good = name && plan_glsl(pipeline->plan, backends[i / 3],
                                 (uint32_t)(pass - pipeline->info->passes), i % 3, &glsl)
                   ? !glsl || folder_write_at(&writing->folder, name, glsl, strlen(glsl))
                   : writing_out_of_memory(writing);
        free(name);
    }
    return good;
}

/* ---- Bytes ----------------------------------------------------------------------------------- */

static char *raw_name(const char *folder, const struct dt_resource *resource, uint32_t mip)
{
    return mip ? format_string("%s/%s.mip%u.raw", folder, resource->name, mip)
               : format_string("%s/%s.raw", folder, resource->name);
}

/* Writes one mip of a resource and names the file in its entry. */
static bool write_row(const struct writing *writing, const char *folder, const struct row *row,
                      const struct dt_bytes *bytes, cJSON *entry, const char *key)
{
    const struct dt_resource *resource =
        &writing->evidence->pipeline->info->resources[row->resource];
    char *name = raw_name(folder, resource, row->mip);
    bool good = name && cJSON_AddStringToObject(entry, key, name);
    good = good ? folder_write_at(&writing->folder, name, bytes->data, bytes->size)
                : writing_out_of_memory(writing);
    free(name);
    return good;
}

static cJSON *add_row(const struct writing *writing, cJSON *list, const struct row *row,
                      const struct dt_bytes *bytes)
{
    cJSON *entry = cJSON_CreateObject();
    dump_describe(entry, &writing->evidence->pipeline->info->resources[row->resource], row->mip,
                  bytes->extent);
    cJSON_AddItemToArray(list, entry);
    return entry;
}

static bool write_rows(const struct writing *writing)
{
    const struct evidence *evidence = writing->evidence;
    const struct row_list *inputs = &evidence->rows->inputs, *outputs = &evidence->rows->outputs;
    uint32_t pass = guilty_row(evidence)->pass;
    cJSON *list = cJSON_AddArrayToObject(writing->manifest, "inputs");
    bool good = true;
    for (uint32_t i = inputs->first[pass]; i < inputs->first[pass + 1] && good; i++) {
        const struct dt_bytes *bytes = &evidence->inputs[i - inputs->first[pass]];
        cJSON *entry = add_row(writing, list, &inputs->list[i], bytes);
        good = write_row(writing, "inputs", &inputs->list[i], bytes, entry, "file");
    }
    list = cJSON_AddArrayToObject(writing->manifest, "outputs");
    for (uint32_t i = outputs->first[pass]; i < outputs->first[pass + 1] && good; i++) {
        static const char *const folders[] = {"expected", "actual"};
        uint32_t place = i - outputs->first[pass];
        cJSON *entry = add_row(writing, list, &outputs->list[i], &evidence->outputs[0][place]);
        for (int side = 0; side < 2 && good; side++)
            good = write_row(writing, folders[side], &outputs->list[i],
                             &evidence->outputs[side][place], entry, folders[side]);
    }
    return good;
}

static bool write_blocks(const struct writing *writing)
{
    const struct evidence *evidence = writing->evidence;
    const uint32_t *size = evidence->setup->size;
    struct dt_frame frame;
    memset(&frame, 0, sizeof frame);
    scene_frame_at(evidence->scene, evidence->frame, size[0], size[1], &frame);
    frame.width = size[0];
    frame.height = size[1];
    cJSON_AddStringToObject(writing->manifest, "frame_block", "frame.raw");
    cJSON_AddStringToObject(writing->manifest, "live_block", "live.raw");
    return folder_write_at(&writing->folder, "frame.raw", &frame, sizeof frame) &&
           folder_write_at(&writing->folder, "live.raw", evidence->pipeline->live,
                           evidence->pipeline->info->live_size);
}

static bool write_scene(const struct writing *writing)
{
    const struct dt_scene *scene = &writing->evidence->scene->data;
    if (!guilty_pass(writing->evidence)->uses_scene)
        return cJSON_AddNullToObject(writing->manifest, "scene");
    cJSON *entry = cJSON_AddObjectToObject(writing->manifest, "scene");
    cJSON_AddNumberToObject(entry, "vertices", scene->vertex_count);
    cJSON_AddNumberToObject(entry, "indices", scene->index_count);
    cJSON_AddNumberToObject(entry, "materials", scene->material_count);
    cJSON_AddNumberToObject(entry, "objects", scene->object_count);
    cJSON_AddNumberToObject(entry, "texture_width", scene->texture_width);
    cJSON_AddNumberToObject(entry, "texture_height", scene->texture_height);
    cJSON_AddNumberToObject(entry, "texture_layers", scene->texture_layers);
    cJSON_AddNumberToObject(entry, "texture_mips", scene->texture_mips);
    const struct folder *folder = &writing->folder;
    return folder_write_at(folder, "scene/vertices.raw", scene->vertices,
                           scene->vertex_count * sizeof *scene->vertices) &&
           folder_write_at(folder, "scene/indices.raw", scene->indices,
                           scene->index_count * sizeof *scene->indices) &&
           folder_write_at(folder, "scene/materials.raw", scene->materials,
                           scene->material_count * sizeof *scene->materials) &&
           folder_write_at(folder, "scene/objects.raw", scene->objects,
                           scene->object_count * sizeof *scene->objects) &&
           folder_write_at(folder, "scene/texels.raw", scene->texels, scene_texel_bytes(scene));
}

/* ---- Words ----------------------------------------------------------------------------------- */

static bool write_evidence_text(const struct writing *writing, const char *name, char *text)
{
    bool good = text ? folder_write_at(&writing->folder, name, text, strlen(text))
                     : writing_out_of_memory(writing);
    free(text);
    return good;
}

/* The name of the pass's body in the folder: the file that the spec names, or NULL. */
struct body_search {
    const struct writing *writing;
    char *name;
};

static bool find_body(void *user, const char *file)
{
    struct body_search *search = user;
    const char *shader = guilty_pass(search->writing->evidence)->shader;
    size_t length = strlen(file), tail = strlen(shader);
    if (!search->name && length > tail && file[length - tail - 1] == '/' &&
        strcmp(file + length - tail, shader) == 0)
        search->name = copied_name(search->writing, file);
    return true;
}

static char *body_name(const struct writing *writing)
{
    struct body_search search = {.writing = writing};
    each_source(writing, find_body, &search);
    return search.name;
}

static bool write_readme(const struct writing *writing)
{
    const struct evidence *evidence = writing->evidence;
    const struct row *row = guilty_row(evidence);
    const struct dt_pipeline *info = evidence->pipeline->info;
    const char *pass = guilty_pass(evidence)->name;
    char *body = body_name(writing);
    char *region = region_describe(&evidence->region, &info->resources[row->resource]);
    char *text = format_string(
        "Pass %s of the pipeline %s, alone.\n\n"
        "In frame %u of %ux%u, %s and %s were given the same inputs and left different content:\n\n"
        "    %s: %s\n\n"
        "    expected/  what %s left: %s\n"
        "    actual/    what %s left: %s\n\n"
        "Where to look:\n\n"
        "    %s  the body of the pass, as it was\n"
        "    generated/gl/%s.%s.*  what OpenGL was given\n"
        "    generated/vk/%s.%s.*  what Vulkan was given\n\n"
        "To run it again, with any backend and without anything outside this folder:\n\n"
        "    diptych replay . --backend '%.*s'\n\n"
        "Bodies may be changed here: the next replay takes them.\n"
        "inputs/, expected/ and actual/ hold raw little-endian numbers, which manifest.json\n"
        "describes in the words of a dump.\n",
        pass, info->name, evidence->frame, evidence->setup->size[0], evidence->setup->size[1],
        evidence->sides[0]->label, evidence->sides[1]->label, row->name, region ? region : "",
        evidence->sides[0]->label, evidence->devices[0], evidence->sides[1]->label,
        evidence->devices[1], body ? body : writing->spec_name, info->name, pass, info->name, pass,
        (int)strcspn(evidence->sides[1]->label, "#"), /* "#2" --backend does not take */
        evidence->sides[1]->label);
    free(region);
    free(body);
    return write_evidence_text(writing, "README.txt", text);
}

static void add_region(const struct writing *writing)
{
    const struct evidence *evidence = writing->evidence;
    const struct region *region = &evidence->region;
    const struct dt_resource *resource =
        &evidence->pipeline->info->resources[guilty_row(evidence)->resource];
    int axes = resource->kind == DT_BUFFER ? 1 : 3;
    cJSON *entry = cJSON_AddObjectToObject(writing->manifest, "failing");
    cJSON_AddNumberToObject(entry, "elements", (double)region->failing);
    region_json(entry, region, axes);
}

/* `KEY.NAME.file="PATH"`: the copy of the resource's file, relative to that of the spec. */
static char *copied_file(const struct writing *writing, const struct dt_resource *resource)
{
    char *path = copied_name(writing, resource->file);
    for (const char *at = writing->spec_name; path && (at = strchr(at, '/')); at++) {
        char *longer = format_string("../%s", path);
        free(path);
        path = longer;
    }
    cJSON *text = cJSON_CreateString(path);
    char *quoted = text ? cJSON_PrintUnformatted(text) : NULL;
    char *set =
        quoted ? format_string("%s.%s.file=%s", resource->kind == DT_IMAGE ? "images" : "buffers",
                               resource->name, quoted)
               : NULL;
    cJSON_free(quoted);
    cJSON_Delete(text);
    free(path);
    return set;
}

/* Those of the command line, and one for each file with an absolute path. */
static bool add_sets(const struct writing *writing)
{
    const struct setup *setup = writing->evidence->setup;
    const struct dt_pipeline *info = writing->evidence->pipeline->info;
    cJSON *sets = cJSON_AddArrayToObject(writing->manifest, "set");
    for (uint32_t i = 0; i < setup->set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(setup->sets[i]));
    for (uint32_t i = 0; i < info->resource_count; i++) {
        const struct dt_resource *resource = &info->resources[i];
        if (!resource->file || *resource->file != '/')
            continue;
        char *set = copied_file(writing, resource);
        if (!set)
            return writing_out_of_memory(writing);
        cJSON_AddItemToArray(sets, cJSON_CreateString(set));
        free(set);
    }
    return true;
}

static bool write_manifest(const struct writing *writing)
{
    static const char *const keys[] = {"expected", "actual"};
    const struct evidence *evidence = writing->evidence;
    cJSON *manifest = writing->manifest;
    cJSON_AddStringToObject(manifest, "spec", writing->spec_name);
    cJSON_AddStringToObject(manifest, "templates", "templates");
    for (int side = 0; side < 2; side++) {
        cJSON *entry = cJSON_AddObjectToObject(manifest, keys[side]);
        cJSON_AddStringToObject(entry, "side", evidence->sides[side]->label);
        cJSON_AddStringToObject(entry, "device", evidence->devices[side]);
    }
    add_region(writing);
    return add_sets(writing) && folder_write_json(&writing->folder, "manifest.json", manifest);
}

static void begin_manifest(const struct writing *writing)
{
    const struct evidence *evidence = writing->evidence;
    const struct row *row = guilty_row(evidence);
    const struct dt_pass *pass = guilty_pass(evidence);
    cJSON *manifest = writing->manifest;
    cJSON_AddNumberToObject(manifest, EVIDENCE_MARK, EVIDENCE_VERSION);
    cJSON_AddStringToObject(manifest, "pipeline", evidence->pipeline->info->name);
    cJSON_AddStringToObject(manifest, "pass", pass->name);
    cJSON_AddStringToObject(manifest, "shader", pass->shader);
    cJSON_AddStringToObject(manifest, "resource",
                            evidence->pipeline->info->resources[row->resource].name);
    cJSON_AddNumberToObject(manifest, "mip", row->mip);
    cJSON_AddNumberToObject(manifest, "frame", evidence->frame);
    cJSON_AddNumberToObject(manifest, "width", evidence->setup->size[0]);
    cJSON_AddNumberToObject(manifest, "height", evidence->setup->size[1]);
}

bool evidence_can_write(struct console *console, const char *place)
{
    return folder_can_write(console, OPTION, place, EVIDENCE_MARK);
}

bool evidence_write(const struct evidence *evidence, const char *place)
{
    struct writing writing = {
        .evidence = evidence, .log = &evidence->console->log, .manifest = cJSON_CreateObject()};
    begin_manifest(&writing);
    bool good = folder_begin(&writing.folder, evidence->console, OPTION, place, EVIDENCE_MARK) &&
                copy_spec(&writing) && copy_generated(&writing) && write_rows(&writing) &&
                write_blocks(&writing) && write_scene(&writing) && write_readme(&writing) &&
                write_manifest(&writing);
    good = folder_end(&writing.folder, good) && good;
    cJSON_Delete(writing.manifest);
    free(writing.spec_name);
    free(writing.spec_root);
    return good;
}
