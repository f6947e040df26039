/* Buffers, buffer views and accessors of a glTF file; see gltf.h. */
#include "gltf.h"

#include "child.h"
#include "base/input.h"

#include <meshoptimizer.h>

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

/* ---- URIs ------------------------------------------------------------------------------------ */

static int base64(char digit)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *found = digit ? strchr(digits, digit) : NULL;
    return found ? (int)(found - digits) : digit == '-' ? 62 : digit == '_' ? 63 : -1;
}

struct gltf_bytes gltf_data_uri(struct gltf *gltf, struct gltf_item item, const char *uri)
{
    const char *comma = strchr(uri, ',');
    const struct gltf_bytes none = {NULL, 0};
    if (!comma || comma - uri < 7 || memcmp(comma - 7, ";base64", 7) != 0) {
        gltf_error(gltf, item, "uri", "this data URI is not base64");
        return none;
    }
    const char *text = comma + 1;
    uint8_t *bytes = gltf_alloc(gltf, item, strlen(text), 1);
    uint32_t bits = 0;
    int count = 0;
    size_t size = 0;
    for (; bytes && *text && *text != '='; text++) {
        int digit = base64(*text);
        if (digit < 0) {
            gltf_error(gltf, item, "uri", "the character %zu of the data is no base64",
                       (size_t)(text - comma));
            return none;
        }
        bits = bits << 6 | (uint32_t)digit;
        count += 6;
        if (count >= 8)
            bytes[size++] = (uint8_t)(bits >> (count -= 8));
    }
    return (struct gltf_bytes){bytes, size};
}

char *gltf_uri_path(struct gltf *gltf, struct gltf_item item, const char *uri)
{
    if (strstr(uri, "://") && strncmp(uri, "file://", 7) != 0) {
        gltf_error(gltf, item, "uri", "%.200s is no file beside this one; download it", uri);
        return NULL;
    }
    char *path = mesh_path_beside(gltf->path, strncmp(uri, "file://", 7) == 0 ? uri + 7 : uri);
    char *to = path;
    for (const char *from = path; from && *from; from++, to++) {
        unsigned code = (unsigned char)*from;
        if (*from == '%' && isxdigit((uint8_t)from[1]) && isxdigit((uint8_t)from[2])) {
            sscanf(from + 1, "%2x", &code);
            from += 2;
        }
        *to = (char)code;
    }
    if (to)
        *to = '\0';
    else
        gltf_out_of_memory(gltf);
    if (path && !gltf->failed && !mesh_may_name(gltf->mesh, path, gltf->log))
        gltf->failed = true;
    if (!gltf->failed)
        return path;
    free(path);
    return NULL;
}

/* ---- Buffers --------------------------------------------------------------------------------- */

static struct gltf_bytes read_buffer_file(struct gltf *gltf, struct gltf_item item, const char *uri)
{
    const char *reason;
    char *path = gltf_uri_path(gltf, item, uri), *bytes = NULL;
    size_t size = 0;
    if (path) {
        child_opens(path);
        bytes = input_read(path, MESH_MOST_BYTES - gltf->spent, &size, &reason);
        child_opens(gltf->path);
        gltf->spent += bytes ? size : 0;
        if (!bytes)
            gltf_error(gltf, item, "uri", "cannot read %s: %s", path, reason);
    }
    free(path);
    gltf_object(gltf, item)->file = bytes;
    return (struct gltf_bytes){(uint8_t *)bytes, size};
}

static struct gltf_bytes buffer(struct gltf *gltf, uint32_t index)
{
    struct gltf_item item = gltf_item(gltf, GLTF_BUFFERS, index);
    struct gltf_bytes *own = &gltf_object(gltf, item)->bytes;
    const char *uri = gltf_text(item, "uri", NULL);
    size_t length = gltf_size(gltf, item, "byteLength");
    if (own->data || gltf->failed)
        return *own;
    if (uri)
        *own = strncmp(uri, "data:", 5) == 0 ? gltf_data_uri(gltf, item, uri)
                                             : read_buffer_file(gltf, item, uri);
    else if (index == 0 && gltf->binary.data)
        *own = gltf->binary;
    else
        gltf_error(gltf, item, NULL, "has no `uri`, and there is no binary chunk for it");
    if (own->data && own->size < length)
        gltf_error(gltf, item, "byteLength", "%zu bytes are promised, and there are %zu", length,
                   own->size);
    return *own;
}

/* ---- Views ----------------------------------------------------------------------------------- */

/* The part of a buffer that an item names by buffer, byteOffset and byteLength. */
static struct gltf_bytes slice(struct gltf *gltf, struct gltf_item item)
{
    struct gltf_bytes none = {NULL, 0}, bytes = none;
    int32_t from = gltf_index(gltf, item, "buffer", GLTF_BUFFERS);
    size_t offset = gltf_size(gltf, item, "byteOffset");
    size_t size = gltf_size(gltf, item, "byteLength");
    if (from >= 0)
        bytes = buffer(gltf, (uint32_t)from);
    else
        gltf_error(gltf, item, "buffer", "is missing");
    if (gltf->failed)
        return none;
    if (offset > bytes.size || size > bytes.size - offset) {
        gltf_error(gltf, item, NULL, "bytes %zu to %zu lie outside of buffers[%d], which has %zu",
                   offset, offset + size, from, bytes.size);
        return none;
    }
    return (struct gltf_bytes){bytes.data + offset, size};
}

/* Whether the numbers of EXT_meshopt_compression are those that the extension allows. */
static bool good_stride(const char *mode, const char *filter, size_t count, size_t stride)
{
    bool attributes = strcmp(mode, "ATTRIBUTES") == 0, triangles = strcmp(mode, "TRIANGLES") == 0;
    if (triangles || strcmp(mode, "INDICES") == 0)
        return (stride == 2 || stride == 4) && (!triangles || count % 3 == 0) &&
               strcmp(filter, "NONE") == 0;
    return attributes && stride % 4 == 0 && stride > 0 && stride <= 256 &&
           (strcmp(filter, "NONE") == 0 || strcmp(filter, "EXPONENTIAL") == 0 ||
            (strcmp(filter, "OCTAHEDRAL") == 0 && (stride == 4 || stride == 8)) ||
            (strcmp(filter, "QUATERNION") == 0 && stride == 8));
}

static bool decompress(const char *mode, const char *filter, size_t count, size_t stride,
                       struct gltf_bytes from, uint8_t *to)
{
    if (strcmp(mode, "TRIANGLES") == 0)
        return meshopt_decodeIndexBuffer(to, count, stride, from.data, from.size) == 0;
    if (strcmp(mode, "INDICES") == 0)
        return meshopt_decodeIndexSequence(to, count, stride, from.data, from.size) == 0;
    if (meshopt_decodeVertexBuffer(to, count, stride, from.data, from.size) != 0)
        return false;
    if (strcmp(filter, "OCTAHEDRAL") == 0)
        meshopt_decodeFilterOct(to, count, stride);
    else if (strcmp(filter, "QUATERNION") == 0)
        meshopt_decodeFilterQuat(to, count, stride);
    else if (strcmp(filter, "EXPONENTIAL") == 0)
        meshopt_decodeFilterExp(to, count, stride);
    return true;
}

static struct gltf_bytes decompressed(struct gltf *gltf, struct gltf_item item)
{
    const char *mode = gltf_text(item, "mode", ""), *filter = gltf_text(item, "filter", "NONE");
    size_t count = gltf_whole(gltf, item, "count", 0), stride = gltf_size(gltf, item, "byteStride");
    struct gltf_bytes none = {NULL, 0}, from = slice(gltf, item);
    if (!gltf->failed && !good_stride(mode, filter, count, stride))
        gltf_error(gltf, item, "EXT_meshopt_compression",
                   "%zu times %zu bytes of mode `%.32s` and filter `%.32s` are not possible", count,
                   stride, mode, filter);
    uint8_t *to = gltf->failed ? NULL : gltf_alloc(gltf, item, count, stride);
    if (to && decompress(mode, filter, count, stride, from, to))
        return (struct gltf_bytes){to, count * stride};
    gltf_error(gltf, item, "EXT_meshopt_compression", "cannot be decompressed; it is damaged");
    return none;
}

struct gltf_bytes gltf_view(struct gltf *gltf, uint32_t index)
{
    struct gltf_item item = gltf_item(gltf, GLTF_VIEWS, index);
    struct gltf_bytes *own = &gltf_object(gltf, item)->bytes;
    if (own->data || gltf->failed)
        return *own;
    struct gltf_item compressed = gltf_extension(gltf, item, "EXT_meshopt_compression");
    *own = compressed.json ? decompressed(gltf, compressed) : slice(gltf, item);
    return *own;
}

/* ---- Accessors ------------------------------------------------------------------------------- */

/* How an accessor lies in memory. */
struct layout {
    struct gltf_bytes bytes; /* of the view; NULL: zeros */
    size_t offset, stride, count;
    uint32_t type, components;
    bool normalized;
};

static const struct number {
    uint8_t bytes;
    bool is_signed;
    float most;
} numbers[] = {
    [0] = {1, true, INT8_MAX},
    [UNSIGNED_BYTE - BYTE] = {1, false, UINT8_MAX},
    [SHORT - BYTE] = {2, true, INT16_MAX},
    [UNSIGNED_SHORT - BYTE] = {2, false, UINT16_MAX},
    [UNSIGNED_INT - BYTE] = {4, false, (float)UINT32_MAX},
    [FLOAT - BYTE] = {4, true, 1},
};

static size_t component_bytes(uint32_t type)
{
    return type >= BYTE && type <= FLOAT ? numbers[type - BYTE].bytes : 0;
}

static uint32_t components_of(const char *type)
{
    return strcmp(type, "SCALAR") == 0 ? 1
           : strncmp(type, "VEC", 3) == 0 && type[3] >= '2' && type[3] <= '4' && !type[4]
               ? (uint32_t)(type[3] - '0')
               : 0;
}

/* Fills bytes, offset and stride; false: the view has no room for `count` elements. */
static bool find_bytes(struct gltf *gltf, struct gltf_item item, struct layout *layout)
{
    size_t element = component_bytes(layout->type) * layout->components;
    int32_t view = gltf_index(gltf, item, "bufferView", GLTF_VIEWS);
    if (element == 0) {
        gltf_error(gltf, item, "componentType", "%u, with this `type`, is not supported",
                   layout->type);
        return false;
    }
    if (view < 0)
        return !gltf->failed;
    struct gltf_item from = gltf_item(gltf, GLTF_VIEWS, (uint32_t)view);
    layout->bytes = gltf_view(gltf, (uint32_t)view);
    layout->offset = gltf_size(gltf, item, "byteOffset");
    layout->stride = gltf_whole(gltf, from, "byteStride", (uint32_t)element);
    if (gltf->failed)
        return false;
    if (layout->stride < element)
        return gltf_error(gltf, from, "byteStride", "%zu is less than an element of accessors[%u]",
                          layout->stride, item.index);
    if (layout->offset > layout->bytes.size ||
        (layout->count > 0 &&
         (layout->bytes.size - layout->offset < element ||
          (layout->bytes.size - layout->offset - element) / layout->stride < layout->count - 1)))
        return gltf_error(gltf, item, "count", "%zu elements do not fit into bufferViews[%d]",
                          layout->count, view);
    return true;
}

static bool find_layout(struct gltf *gltf, struct gltf_item item, struct layout *layout)
{
    const cJSON *normalized = cJSON_GetObjectItemCaseSensitive(item.json, "normalized");
    *layout = (struct layout){.count = gltf_whole(gltf, item, "count", 0),
                              .type = gltf_whole(gltf, item, "componentType", 0),
                              .components = components_of(gltf_text(item, "type", "")),
                              .normalized = cJSON_IsTrue(normalized)};
    return !gltf->failed && find_bytes(gltf, item, layout);
}

static uint32_t bits_at(const struct layout *layout, size_t element, uint32_t component)
{
    size_t bytes = component_bytes(layout->type);
    uint32_t bits = 0; /* little-endian, as the file */
    memcpy(&bits,
           layout->bytes.data + layout->offset + element * layout->stride + component * bytes,
           bytes);
    return bits;
}

/* A component; whole numbers are those of KHR_mesh_quantization where they are not normalized. */
static float float_at(const struct layout *layout, size_t element, uint32_t component)
{
    const struct number *number = &numbers[layout->type - BYTE];
    uint32_t bits = bits_at(layout, element, component), unused = 32 - 8 * number->bytes;
    float value = number->is_signed ? (float)((int32_t)(bits << unused) >> unused) : (float)bits;
    if (layout->type == FLOAT)
        memcpy(&value, &bits, sizeof value);
    return layout->type != FLOAT && layout->normalized ? fmaxf(value / number->most, -1) : value;
}

/* Sparse accessors: elements that replace those of the view, or of the zeros. */
struct sparse {
    struct layout indices, values;
};

/* False: failed. A count of 0: none. */
static bool find_sparse(struct gltf *gltf, struct gltf_item item, const struct layout *layout,
                        struct sparse *sparse)
{
    struct gltf_item all = gltf_part(gltf, item, "sparse");
    struct gltf_item indices = gltf_part(gltf, all, "indices");
    struct gltf_item values = gltf_part(gltf, all, "values");
    uint32_t count = gltf_whole(gltf, all, "count", 0);
    *sparse = (struct sparse){.values = *layout};
    sparse->values.bytes = (struct gltf_bytes){NULL, 0};
    if (!all.json || gltf->failed)
        return !gltf->failed;
    sparse->values.count = count;
    sparse->indices = (struct layout){
        .count = count, .type = gltf_whole(gltf, indices, "componentType", 0), .components = 1};
    if (!find_bytes(gltf, indices, &sparse->indices) || !find_bytes(gltf, values, &sparse->values))
        return false;
    if (count && (!sparse->indices.bytes.data || !sparse->values.bytes.data)) {
        gltf_error(gltf, item, "sparse", "has no `bufferView`");
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t index = bits_at(&sparse->indices, i, 0);
        if (index >= layout->count || (i > 0 && index <= bits_at(&sparse->indices, i - 1, 0)))
            return gltf_error(gltf, item, "sparse",
                              "its index %u is %u; indices grow, below the count of %zu", i, index,
                              layout->count);
    }
    return true;
}

/* Copies each element to the index that `places` gives; NULL: to its own index. */
static void place(const struct gltf_array *array, const struct layout *layout,
                  const struct layout *places)
{
    uint32_t width = layout->components;
    for (size_t i = 0; layout->bytes.data && i < layout->count; i++) {
        size_t to = (places ? bits_at(places, i, 0) : i) * width;
        if (array->indices)
            array->indices[to] = bits_at(layout, i, 0);
        for (uint32_t k = 0; array->floats && k < width; k++)
            array->floats[to + k] = float_at(layout, i, k);
    }
}

/* Makes the accessor's floats or indices. NULL: failed. */
static const struct gltf_array *elements(struct gltf *gltf, uint32_t index, bool whole)
{
    struct gltf_item item = gltf_item(gltf, GLTF_ACCESSORS, index);
    struct gltf_array *array = &gltf_object(gltf, item)->array, made = {0};
    struct layout layout;
    struct sparse sparse;
    if (gltf->failed || (whole ? (void *)array->indices : array->floats))
        return gltf->failed ? NULL : array;
    if (!find_layout(gltf, item, &layout) || !find_sparse(gltf, item, &layout, &sparse))
        return NULL;
    if (whole &&
        (layout.components != 1 || layout.type == FLOAT || numbers[layout.type - BYTE].is_signed)) {
        gltf_error(gltf, item, "componentType", "indices are unsigned scalars");
        return NULL;
    }
    void *memory = gltf_alloc(gltf, item, layout.count * layout.components, sizeof(float));
    if (!memory)
        return NULL;
    made.floats = whole ? NULL : memory;
    made.indices = whole ? memory : NULL;
    place(&made, &layout, NULL);
    place(&made, &sparse.values, &sparse.indices);
    array->floats = whole ? array->floats : memory;
    array->indices = whole ? memory : array->indices;
    array->count = (uint32_t)layout.count;
    array->components = layout.components;
    return array;
}

const struct gltf_array *gltf_floats(struct gltf *gltf, uint32_t index, uint32_t components)
{
    const struct gltf_array *array = elements(gltf, index, false);
    if (!array || array->components == components)
        return array;
    gltf_error(gltf, gltf_item(gltf, GLTF_ACCESSORS, index), "type",
               "has %u components, and %u are needed", array->components, components);
    return NULL;
}

const struct gltf_array *gltf_indices(struct gltf *gltf, uint32_t index)
{
    return elements(gltf, index, true);
}
