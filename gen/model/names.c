/* See names.h. */
#include "names.h"

#include <stdlib.h>
#include <string.h>

#include "formats.h"

const char *const scene_resources[SCENE_RESOURCES] = {
    "scene_vertices", "scene_indices", "scene_materials", "scene_objects", "scene_textures"};

const struct derived_word derived_words[DERIVED_WORDS] = {
    {DECLARED_BUFFER | DECLARED_SAMPLER, "_count", true},
    {DECLARED_IMAGE, "_size", true},
    {DECLARED_IMAGE, "_store", true},
    {DECLARED_IMAGE, "_sample", true},
    {DECLARED_IMAGE, "_sample_lod", true},
    {DECLARED_IMAGE, "_compare", true},
    {DECLARED_IMAGE, "_texture", true},
    {DECLARED_IMAGE, "_image", false},
    {DECLARED_IMAGE, "_atomicAdd", false},
    {DECLARED_IMAGE, "_atomicMin", false},
    {DECLARED_IMAGE, "_atomicMax", false},
    {DECLARED_IMAGE, "_atomicAnd", false},
    {DECLARED_IMAGE, "_atomicOr", false},
    {DECLARED_IMAGE, "_atomicXor", false},
    {DECLARED_IMAGE, "_atomicExchange", false},
    {DECLARED_IMAGE, "_atomicCompSwap", false},
    {DECLARED_INTERLEAVE, "_tile", true},
    {DECLARED_INTERLEAVE, "_classes", true},
    {DECLARED_INTERLEAVE, "_class", true},
    {DECLARED_INTERLEAVE, "_split", true},
    {DECLARED_INTERLEAVE, "_gather", true},
    {DECLARED_INTERLEAVE, "_class_size", true}};

/* An array of the pipeline. */
static const struct declared_list {
    enum declared_kind kind; /* of its first kind */
    size_t list, count, size;
} arrays[] = {
#define ARRAY(KIND, list, count, type)                                                             \
    {                                                                                              \
        DECLARED_##KIND, offsetof(struct pipeline, list), offsetof(struct pipeline, count),        \
            sizeof(struct type)                                                                    \
    }
    ARRAY(FLOAT, params, param_count, param),
    ARRAY(CONSTANT, constants, constant_count, constant),
    ARRAY(STRUCT, structs, struct_count, structure),
    ARRAY(BUFFER, resources, resource_count, resource),
    ARRAY(POINTS, samplers, sampler_count, sampler),
    ARRAY(METRIC, metrics, metric_count, metric),
    ARRAY(INTERLEAVE, interleaves, interleave_count, interleave),
    ARRAY(PASS, passes, pass_count, pass),
};

static enum declared_kind declared_kind_of(enum declared_kind first, const void *of)
{
    bool second = first == DECLARED_FLOAT    ? ((const struct param *)of)->type != DT_TYPE_FLOAT
                  : first == DECLARED_BUFFER ? ((const struct resource *)of)->kind == DT_IMAGE
                  : first == DECLARED_POINTS ? ((const struct sampler *)of)->kind == SAMPLER_FILTER
                                             : false;
    return second ? (enum declared_kind)(first << 1) : first;
}

struct declared *declared_at(const struct pipeline *pipeline, size_t index,
                             enum declared_kind *kind)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(arrays); i++) {
        const char *base = (const char *)pipeline;
        uint32_t count = *(const uint32_t *)(base + arrays[i].count);
        if (index < count) {
            char *list = *(char *const *)(base + arrays[i].list) + index * arrays[i].size;
            *kind = declared_kind_of(arrays[i].kind, list);
            return (struct declared *)list;
        }
        index -= count;
    }
    return NULL;
}

void *declared_find(const struct pipeline *pipeline, unsigned kinds, const char *name)
{
    enum declared_kind kind;
    struct declared *of;
    for (size_t i = 0; (of = declared_at(pipeline, i, &kind)); i++)
        if ((kind & kinds) && !strcmp(of->name, name))
            return of;
    return NULL;
}

struct name_hint declared_hint(const struct pipeline *pipeline, unsigned kinds, const char *name,
                               const char *otherwise)
{
    size_t count = 0, most = SCENE_RESOURCES + DT_TYPE_COUNT;
    enum declared_kind kind;
    struct declared *of;
    while (declared_at(pipeline, count, &kind))
        count++;
    const char **names = calloc(most + count, sizeof *names);
    count = 0;
    for (size_t i = 0; names && (of = declared_at(pipeline, i, &kind)); i++)
        if (kind & kinds)
            names[count++] = of->name;
    for (int i = 0; names && (kinds & DECLARED_SCENE) && i < SCENE_RESOURCES; i++)
        names[count++] = scene_resources[i];
    for (int i = 0; names && (kinds & DECLARED_TYPE) && i < DT_TYPE_COUNT; i++)
        if (i != DT_TYPE_BOOL)
            names[count++] = type_info((enum dt_type)i)->name;
    struct name_hint hint = name_hint('`', name, names, count, otherwise);
    free(names);
    return hint;
}

const char *declared_word(enum declared_kind kind)
{
    return (kind & DECLARED_PARAM)     ? "parameter"
           : kind == DECLARED_CONSTANT ? "constant"
           : kind == DECLARED_STRUCT   ? "struct"
           : kind == DECLARED_BUFFER   ? "buffer"
           : kind == DECLARED_IMAGE    ? "image"
           : (kind & DECLARED_SAMPLER) ? "sampler"
           : kind == DECLARED_METRIC   ? "metric"
                                       : "interleave";
}

const char *declared_ending(enum declared_kind kind, const char *name, const char *word)
{
    size_t length = strlen(name);
    if (strncmp(word, name, length) != 0)
        return NULL;
    word += length;
    EACH(derived, derived_words, DERIVED_WORDS)
        if (derived->kinds & kind && !strcmp(derived->ending, word))
            return derived->ending;
    return *word ? NULL : "";
}
