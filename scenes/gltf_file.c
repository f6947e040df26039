/* Container, lists and keys of a glTF file; see gltf.h. */
#include "gltf.h"

#include "base/log.h"
#include "base/input.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_WARNINGS = 20 };

static const char *const names[GLTF_KINDS] = {
    [GLTF_ACCESSORS] = "accessors", [GLTF_BUFFERS] = "buffers", [GLTF_VIEWS] = "bufferViews",
    [GLTF_CAMERAS] = "cameras",     [GLTF_IMAGES] = "images",   [GLTF_LIGHTS] = "lights",
    [GLTF_MATERIALS] = "materials", [GLTF_MESHES] = "meshes",   [GLTF_NODES] = "nodes",
    [GLTF_SAMPLERS] = "samplers",   [GLTF_SCENES] = "scenes",   [GLTF_TEXTURES] = "textures",
};

static const struct gltf_item the_file = {.kind = GLTF_KINDS};

/* ---- Messages -------------------------------------------------------------------------------- */

bool gltf_error(struct gltf *gltf, struct gltf_item item, const char *key, const char *format, ...)
{
    char text[512];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (!gltf->failed && item.kind == GLTF_KINDS)
        report_error(gltf->log, "%s: %s", gltf->path, text);
    else if (!gltf->failed)
        report_error(gltf->log, "%s: %s[%u]%s%s: %s", gltf->path, names[item.kind], item.index,
                     key ? "." : "", key ? key : "", text);
    gltf->failed = true;
    return false;
}

bool gltf_out_of_memory(struct gltf *gltf)
{
    return gltf_error(gltf, the_file, NULL,
                      "out of memory; the mesh is too large for this machine");
}

void gltf_warn(struct gltf *gltf, const char *format, ...)
{
    char text[512];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (gltf->failed || cJSON_GetArraySize(gltf->warned) == MOST_WARNINGS ||
        cJSON_GetObjectItemCaseSensitive(gltf->warned, text))
        return;
    cJSON_AddNullToObject(gltf->warned, text);
    report_message(gltf->log, DT_WARNING, "%s: %s", gltf->path, text);
}

void *gltf_alloc(struct gltf *gltf, struct gltf_item item, size_t count, size_t size)
{
    if (count > (MESH_MOST_BYTES - gltf->spent) / size) {
        gltf_error(gltf, item, NULL, "this and what precedes it take more than %zu MiB",
                   MESH_MOST_BYTES >> 20);
        return NULL;
    }
    void *memory = arena_alloc(gltf->arena, count * size);
    if (!memory)
        gltf_out_of_memory(gltf);
    gltf->spent += count * size;
    return memory;
}

/* ---- Keys ------------------------------------------------------------------------------------ */

static const cJSON *find_member(struct gltf_item item, const char *key)
{
    return item.json ? cJSON_GetObjectItemCaseSensitive(item.json, key) : NULL;
}

struct gltf_item gltf_item(const struct gltf *gltf, enum gltf_kind kind, uint32_t index)
{
    return (struct gltf_item){gltf->list[kind].objects[index].json, kind, index};
}

struct gltf_object *gltf_object(const struct gltf *gltf, struct gltf_item item)
{
    return &gltf->list[item.kind].objects[item.index];
}

struct gltf_item gltf_part(struct gltf *gltf, struct gltf_item item, const char *key)
{
    struct gltf_item part = {find_member(item, key), item.kind, item.index};
    if (part.json && !cJSON_IsObject(part.json)) {
        gltf_error(gltf, item, key, "is no object");
        part.json = NULL;
    }
    return part;
}

struct gltf_item gltf_extension(struct gltf *gltf, struct gltf_item item, const char *name)
{
    return gltf_part(gltf, gltf_part(gltf, item, "extensions"), name);
}

/* A whole number from 0 to `most`. */
static bool is_whole_number(const cJSON *json, double most)
{
    double value = cJSON_GetNumberValue(json);
    return cJSON_IsNumber(json) && value >= 0 && value <= most && (double)(size_t)value == value;
}

static size_t whole(struct gltf *gltf, struct gltf_item item, const char *key, double most,
                    size_t fallback)
{
    const cJSON *json = find_member(item, key);
    if (!json)
        return fallback;
    if (is_whole_number(json, most))
        return (size_t)cJSON_GetNumberValue(json);
    if (cJSON_IsNumber(json))
        gltf_error(gltf, item, key, "%.17g is no whole number from 0 to %.17g",
                   cJSON_GetNumberValue(json), most);
    else
        gltf_error(gltf, item, key, "is no number");
    return fallback;
}

uint32_t gltf_whole(struct gltf *gltf, struct gltf_item item, const char *key, uint32_t fallback)
{
    return (uint32_t)whole(gltf, item, key, UINT32_MAX, fallback);
}

size_t gltf_size(struct gltf *gltf, struct gltf_item item, const char *key)
{
    return whole(gltf, item, key, 0x1p53, 0);
}

float gltf_number(struct gltf *gltf, struct gltf_item item, const char *key, float fallback)
{
    const cJSON *json = find_member(item, key);
    if (json && !cJSON_IsNumber(json))
        gltf_error(gltf, item, key, "is no number");
    return cJSON_IsNumber(json) ? (float)cJSON_GetNumberValue(json) : fallback;
}

bool gltf_numbers(struct gltf *gltf, struct gltf_item item, const char *key, int count,
                  float *numbers)
{
    const cJSON *json = find_member(item, key), *element;
    int i = 0;
    if (!json)
        return false;
    cJSON_ArrayForEach(element, json)
    {
        if (cJSON_IsNumber(element) && i < count)
            numbers[i] = (float)cJSON_GetNumberValue(element);
        i = cJSON_IsNumber(element) ? i + 1 : count + 1;
    }
    return (cJSON_IsArray(json) && i == count) ||
           gltf_error(gltf, item, key, "is no array of %d numbers", count);
}

const char *gltf_text(const struct gltf_item item, const char *key, const char *fallback)
{
    const char *text = cJSON_GetStringValue(find_member(item, key));
    return text ? text : fallback;
}

int32_t gltf_element(struct gltf *gltf, struct gltf_item item, const char *key,
                     const cJSON *element, enum gltf_kind kind)
{
    uint32_t count = gltf->list[kind].count;
    if (is_whole_number(element, (double)count - 1))
        return (int32_t)cJSON_GetNumberValue(element);
    if (cJSON_IsNumber(element))
        gltf_error(gltf, item, key, "there is no %s[%.17g]; the file has %u", names[kind],
                   cJSON_GetNumberValue(element), count);
    else
        gltf_error(gltf, item, key, "is no index of %s", names[kind]);
    return -1;
}

int32_t gltf_index(struct gltf *gltf, struct gltf_item item, const char *key, enum gltf_kind kind)
{
    const cJSON *json = find_member(item, key);
    return json ? gltf_element(gltf, item, key, json, kind) : -1;
}

/* ---- Extensions ------------------------------------------------------------------------------ */

static const char *const supported[] = {
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
};

static bool is_supported(const char *name)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(supported); i++)
        if (strcmp(name, supported[i]) == 0)
            return true;
    return false;
}

static bool check_extensions(struct gltf *gltf)
{
    const cJSON *name;
    cJSON_ArrayForEach(name, cJSON_GetObjectItemCaseSensitive(gltf->root, "extensionsRequired"))
    {
        if (cJSON_IsString(name) && !is_supported(name->valuestring))
            return gltf_error(gltf, the_file, NULL,
                              "it requires the extension %s, which is not supported",
                              name->valuestring);
    }
    cJSON_ArrayForEach(name, cJSON_GetObjectItemCaseSensitive(gltf->root, "extensionsUsed"))
    {
        if (cJSON_IsString(name) && !is_supported(name->valuestring))
            gltf_warn(gltf, "the extension %s is not supported; the file is read without it",
                      name->valuestring);
    }
    return true;
}

/* ---- The container --------------------------------------------------------------------------- */

static uint32_t little(const char *at)
{
    const uint8_t *byte = (const uint8_t *)at;
    return byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

/* A .glb: 12 bytes of header, then chunks of length, kind and content; the first is JSON, the second
 * may be BIN. Leaves the JSON in *json. */
static bool open_chunks(struct gltf *gltf, size_t length, struct gltf_bytes *json)
{
    enum { HEADER = 12, CHUNK = 8 };
    uint32_t version = length >= HEADER ? little(gltf->text + 4) : 0;
    if (length >= HEADER && version != 2)
        return gltf_error(gltf, the_file, NULL, "it is glTF %u; glTF 2 is supported", version);
    for (size_t at = HEADER, chunk = 0; chunk < 2 && at < length; chunk++) {
        size_t size = length - at >= CHUNK ? little(gltf->text + at) : SIZE_MAX;
        if (size > length - at - CHUNK)
            return gltf_error(gltf, the_file, NULL,
                              "it is cut off: a chunk is longer than the file");
        const struct gltf_bytes bytes = {(const uint8_t *)gltf->text + at + CHUNK, size};
        bool is_json = memcmp(gltf->text + at + 4, "JSON", 4) == 0;
        if (is_json && chunk == 0)
            *json = bytes;
        else if (memcmp(gltf->text + at + 4, "BIN", 4) == 0 && chunk == 1)
            gltf->binary = bytes;
        at += CHUNK + size + (-size & 3);
    }
    return json->data || gltf_error(gltf, the_file, NULL, "its first chunk is no JSON");
}

static bool parse_json(struct gltf *gltf, struct gltf_bytes json)
{
    const char *start = (const char *)json.data, *end = start;
    gltf->root = cJSON_ParseWithLengthOpts(start, json.size, &end, false);
    const char *after = end;
    while (gltf->root && after < start + json.size && strchr(" \t\r\n", *after))
        after++; /* NUL, too: padding */
    if (gltf->root && cJSON_IsObject(gltf->root) && after == start + json.size)
        return true;
    int line = 1, column = 1;
    for (const char *c = start; c < after; c++) {
        column = *c == '\n' ? 1 : column + 1;
        line += *c == '\n';
    }
    report_error(gltf->log, "%s:%d:%d: this is no JSON of a glTF file", gltf->path, line, column);
    gltf->failed = true;
    return false;
}

static bool check_version(struct gltf *gltf)
{
    const cJSON *asset = cJSON_GetObjectItemCaseSensitive(gltf->root, "asset");
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(asset, "minVersion");
    if (!item)
        item = cJSON_GetObjectItemCaseSensitive(asset, "version");
    const char *version = cJSON_GetStringValue(item);
    if (!version)
        return gltf_error(gltf, the_file, NULL, "it has no `asset.version`, so it is no glTF 2");
    if (strncmp(version, "2.", 2) == 0 &&
        (strcmp(version, "2.0") == 0 || !cJSON_GetObjectItemCaseSensitive(asset, "minVersion")))
        return true;
    return gltf_error(gltf, the_file, NULL, "it is glTF %.32s; glTF 2.0 is supported", version);
}

/* cJSON's arrays are linked lists. */
static bool index_list(struct gltf *gltf, const cJSON *array, enum gltf_kind kind)
{
    struct gltf_list *list = &gltf->list[kind];
    const cJSON *item;
    if (array && !cJSON_IsArray(array))
        return gltf_error(gltf, the_file, NULL, "`%s` is no array", names[kind]);
    list->objects =
        arena_alloc(gltf->arena, (size_t)cJSON_GetArraySize(array) * sizeof *list->objects);
    if (!list->objects)
        return gltf_out_of_memory(gltf);
    cJSON_ArrayForEach(item, array)
    {
        struct gltf_item place = {item, kind, list->count};
        if (!cJSON_IsObject(item))
            return gltf_error(gltf, place, NULL, "is no object");
        list->objects[list->count++].json = item;
    }
    return true;
}

static bool index_lists(struct gltf *gltf)
{
    for (int kind = 0; kind < GLTF_KINDS; kind++) {
        const cJSON *parent = gltf->root;
        if (kind == GLTF_LIGHTS) {
            parent = cJSON_GetObjectItemCaseSensitive(parent, "extensions");
            parent = cJSON_GetObjectItemCaseSensitive(parent, "KHR_lights_punctual");
        }
        if (!index_list(gltf, cJSON_GetObjectItemCaseSensitive(parent, names[kind]), kind))
            return false;
    }
    return true;
}

bool gltf_open(struct gltf *gltf, const struct mesh *mesh, const struct dt_log *log)
{
    size_t length = 0;
    const char *reason;
    *gltf = (struct gltf){.path = mesh->path,
                          .mesh = mesh,
                          .log = log,
                          .arena = arena_create(),
                          .warned = cJSON_CreateObject()};
    if (!gltf->arena)
        return gltf_out_of_memory(gltf);
    gltf->text = input_read(gltf->path, MESH_MOST_BYTES, &length, &reason);
    if (!gltf->text)
        return gltf_error(gltf, the_file, NULL, "%s", reason);
    struct gltf_bytes json = {(const uint8_t *)gltf->text, length};
    if (length >= 4 && memcmp(gltf->text, "glTF", 4) == 0) {
        json = (struct gltf_bytes){NULL, 0};
        if (!open_chunks(gltf, length, &json))
            return false;
    }
    return parse_json(gltf, json) && check_version(gltf) && check_extensions(gltf) &&
           index_lists(gltf);
}

void gltf_close(struct gltf *gltf)
{
    for (uint32_t i = 0; i < gltf->list[GLTF_BUFFERS].count; i++)
        free(gltf->list[GLTF_BUFFERS].objects[i].file);
    arena_free(gltf->arena);
    cJSON_Delete(gltf->warned);
    cJSON_Delete(gltf->root);
    free(gltf->text);
}
