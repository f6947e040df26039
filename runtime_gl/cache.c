/* Linked programs as binaries of the driver: takes those of dt_gl_host.cache, gives those of
 * dt_gl_get_cache. A cache may be damaged or of another driver: then its programs are compiled. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 8 };

struct head {
    char magic[8];
    uint64_t driver; /* hash of its names */
};

struct entry {             /* followed by the binary, up to a multiple of ALIGNMENT */
    uint64_t code, binary; /* hashes of the shaders and of the binary */
    uint32_t format, size;
};

static const char magic[8] = "dt_gl 1";

/* FNV-1a. */
static uint64_t add_hash(uint64_t hash, const void *data, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ ((const uint8_t *)data)[i]) * 0x100000001b3u;
    return hash;
}

static const uint64_t START = 0xcbf29ce484222325u;

static struct head head_of(struct dt_gl_runtime *rt)
{
    static const GLenum names[] = {GL_VENDOR, GL_RENDERER, GL_VERSION};
    struct head head = {.driver = START};
    memcpy(head.magic, magic, sizeof magic);
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++) {
        const char *name = (const char *)rt->gl.GetString(names[i]);
        head.driver = add_hash(head.driver, name ? name : "", name ? strlen(name) + 1 : 1);
    }
    return head;
}

static uint64_t hash_code(const struct dt_gl_runtime *rt, const struct dt_stages *stages)
{
    const struct dt_code *codes[] = {&stages->compute, &stages->vertex, &stages->fragment};
    uint64_t hash = START;
    for (size_t i = 0; i < DT_ARRAY_COUNT(codes); i++) {
        bool text = codes[i]->glsl && (rt->glsl || !codes[i]->size);
        uint32_t *own = NULL;
        const void *code = text             ? (const void *)codes[i]->glsl
                           : codes[i]->size ? dt_front_words(codes[i], &own)
                                            : NULL;
        size_t size = text ? strlen(codes[i]->glsl) : codes[i]->size;
        hash = add_hash(hash, &size, sizeof size);
        hash = code ? add_hash(hash, code, size) : hash;
        free(own);
    }
    return hash;
}

static size_t padded(size_t size)
{
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* ---- Taking ---------------------------------------------------------------------------------- */

bool gl_cache_take(struct dt_gl_runtime *rt, const struct dt_bytes *cache)
{
    struct head head = head_of(rt);
    if (cache->size < sizeof head || memcmp(cache->data, &head, sizeof head) != 0)
        return true;
    uint8_t *copy = malloc(cache->size);
    if (!copy)
        return dt_error(&rt->core, "out of memory for a cache of %zu bytes; free some",
                        cache->size);
    rt->cache =
        (struct dt_bytes){.data = memcpy(copy, cache->data, cache->size), .size = cache->size};
    return true;
}

/* Whether the driver takes the binary; forgets its errors. */
static bool driver_takes(struct dt_gl_runtime *rt, GLuint program, const struct entry *entry,
                         const uint8_t *binary)
{
    GLint status = GL_FALSE;
    rt->gl.ProgramBinary(program, entry->format, binary, (GLsizei)entry->size);
    while (rt->gl.GetError() != GL_NO_ERROR)
        ;
    rt->gl.GetProgramiv(program, GL_LINK_STATUS, &status);
    return status;
}

bool gl_cache_link(struct dt_gl_runtime *rt, GLuint program, const struct dt_stages *stages)
{
    if (!rt->cache.data)
        return false;
    const uint64_t code = hash_code(rt, stages);
    struct entry entry;
    for (size_t at = sizeof(struct head); at + sizeof entry <= rt->cache.size;) {
        memcpy(&entry, rt->cache.data + at, sizeof entry);
        at += sizeof entry;
        const uint8_t *binary = rt->cache.data + at;
        at += padded(entry.size);
        if (at <= rt->cache.size && entry.code == code &&
            entry.binary == add_hash(START, binary, entry.size))
            return driver_takes(rt, program, &entry, binary);
    }
    return false;
}

/* Mesa 22.3 crashes on variables without names, as those of SPIR-V are. */
static bool gives_binaries(struct dt_gl_runtime *rt)
{
    const char *version = (const char *)rt->gl.GetString(GL_VERSION);
    return rt->glsl || !version || !strstr(version, "Mesa");
}

/* ---- Giving ---------------------------------------------------------------------------------- */

/* Adds `size` bytes to the cache and zeros to them; returns where they are. NULL: no memory. */
static uint8_t *append_bytes(struct dt_bytes *cache, size_t size)
{
    uint8_t *data = realloc(cache->data, cache->size + padded(size));
    if (!data)
        return NULL;
    cache->data = data;
    data += cache->size;
    cache->size += padded(size);
    return memset(data, 0, padded(size));
}

static bool add_program(struct dt_gl_runtime *rt, struct dt_bytes *cache, uint32_t pass)
{
    GLuint program = ((struct gl_program *)dt_program(&rt->core, pass))->handle;
    struct entry entry = {.code = hash_code(rt, &rt->core.shaders.stages[pass])};
    GLint size = 0;
    GLenum format = 0;
    rt->gl.GetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &size);
    if (size <= 0)
        return true;
    size_t begin = cache->size;
    uint8_t *place = append_bytes(cache, sizeof entry + (size_t)size);
    if (!place)
        return false;
    if (!GL(rt, rt->core.pipeline->passes[pass].name,
            GetProgramBinary(program, size, &size, &format, place + sizeof entry)))
        return false;
    cache->size = begin + sizeof entry + padded((size_t)size);
    entry.format = format;
    entry.size = (uint32_t)size;
    entry.binary = add_hash(START, place + sizeof entry, entry.size);
    memcpy(place, &entry, sizeof entry);
    return true;
}

bool gl_cache_give(struct dt_gl_runtime *rt, struct dt_bytes *out)
{
    const struct head head = head_of(rt);
    uint8_t *place = append_bytes(out, sizeof head);
    bool good = place;
    if (good)
        memcpy(place, &head, sizeof head);
    uint32_t count = gives_binaries(rt) ? rt->core.pipeline->pass_count : 0;
    for (uint32_t i = 0; good && i < count; i++)
        good = add_program(rt, out, i);
    if (good)
        return true;
    free(out->data);
    *out = (struct dt_bytes){0};
    return dt_error(&rt->core, "get_cache: the programs cannot be read, or there is no memory");
}
