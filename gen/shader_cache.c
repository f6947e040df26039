/* Shaders of former generations in one file, so that an edit compiles what it changes and nothing else.
 * main.c opens and writes it, shaders.c asks it. An entry is taken when the whole GLSL is the same, and the
 * program that made it; a file that is broken in any way counts as empty, and is then written anew.
 *
 * The file: struct head, then for each entry struct entry_head, the GLSL, the SPIR-V. */
#include "shader_cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What was not asked for goes once the file is larger. */
enum { MOST_BYTES = 8 << 20 };

struct head {
    char magic[8];
    uint64_t program;
};
static const char magic[8] = "dtspv 1";

struct entry_head {
    uint32_t kind; /* backend, stage, exactness */
    uint32_t glsl_length, word_count;
    uint32_t unused;
    uint64_t hash; /* of what follows */
};

struct entry {
    struct entry_head head;
    const char *glsl;     /* not terminated */
    const uint8_t *words; /* maybe not aligned */
};

struct shader_cache {
    char *bytes; /* of the file */
    struct entry *entries;
    bool *asked;
    size_t count;
};

/* FNV-1a over 64 bits at a time: of a broken file, not of an enemy's. */
static uint64_t hash_of(uint64_t hash, const void *data, size_t size)
{
    const uint8_t *bytes = data;
    for (size_t i = 0; i < size; i += sizeof(uint64_t)) {
        uint64_t piece = 0;
        memcpy(&piece, bytes + i, size - i < sizeof piece ? size - i : sizeof piece);
        hash = (hash ^ piece) * UINT64_C(0x100000001b3);
        hash ^= hash >> 29;
    }
    return hash;
}

static uint64_t entry_hash(const struct entry *entry)
{
    const struct entry_head *head = &entry->head;
    const uint32_t shape[] = {head->kind, head->glsl_length, head->word_count};
    uint64_t hash = hash_of(UINT64_C(0xcbf29ce484222325), shape, sizeof shape);
    hash = hash_of(hash, entry->glsl, head->glsl_length);
    return hash_of(hash, entry->words, (size_t)head->word_count * sizeof(uint32_t));
}

/* glslang and SPIRV-Tools are part of this program: another build may compile otherwise. */
static uint64_t program_hash(void)
{
    struct stat status;
    if (stat("/proc/self/exe", &status))
        return 0;
    const uint64_t identity[] = {(uint64_t)status.st_size, (uint64_t)status.st_ino,
                                 (uint64_t)status.st_mtim.tv_sec, (uint64_t)status.st_mtim.tv_nsec};
    return hash_of(UINT64_C(0xcbf29ce484222325), identity, sizeof identity);
}

static uint32_t kind_of(const struct model *model, enum backend backend, enum stage stage)
{
    return (uint32_t)backend << 8 | (uint32_t)stage << 1 | (uint32_t)model->pipeline.fast;
}

/* ---- Reading --------------------------------------------------------------------------------- */

static char *read_bytes(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    struct stat status;
    char *bytes = NULL;
    if (file && !fstat(fileno(file), &status) && S_ISREG(status.st_mode)) {
        *size = (size_t)status.st_size;
        bytes = malloc(*size + 1);
        if (bytes && fread(bytes, 1, *size, file) != *size) {
            free(bytes);
            bytes = NULL;
        }
    }
    if (file)
        fclose(file);
    return bytes;
}

/* The entry that begins at *at; false when it does not fit or is not what was written. */
static bool read_entry(const char *bytes, size_t size, size_t *at, struct entry *entry)
{
    if (size - *at < sizeof entry->head)
        return false;
    memcpy(&entry->head, bytes + *at, sizeof entry->head);
    size_t left = size - *at - sizeof entry->head, glsl = entry->head.glsl_length,
           words = (size_t)entry->head.word_count * sizeof(uint32_t);
    if (!words || glsl > left || words > left - glsl)
        return false;
    entry->glsl = bytes + *at + sizeof entry->head;
    entry->words = (const uint8_t *)entry->glsl + glsl;
    *at += sizeof entry->head + glsl + words;
    return entry_hash(entry) == entry->head.hash;
}

static bool read_entries(struct shader_cache *cache, size_t size)
{
    struct head head;
    if (size < sizeof head)
        return false;
    memcpy(&head, cache->bytes, sizeof head);
    if (memcmp(head.magic, magic, sizeof magic) != 0 || head.program != program_hash())
        return false;
    for (size_t at = sizeof head; at < size;) {
        struct entry entry;
        if (!read_entry(cache->bytes, size, &at, &entry))
            return false;
        if (!(cache->count & (cache->count - 1))) { /* full at powers of two */
            struct entry *entries =
                realloc(cache->entries, (cache->count ? 2 * cache->count : 1) * sizeof *entries);
            if (!entries)
                return false;
            cache->entries = entries;
        }
        cache->entries[cache->count++] = entry;
    }
    cache->asked = calloc(cache->count + 1, sizeof *cache->asked);
    return cache->asked;
}

struct shader_cache *shader_cache_read(const char *path)
{
    struct shader_cache *cache = calloc(1, sizeof *cache);
    size_t size = 0;
    if (cache) {
        cache->bytes = read_bytes(path, &size);
        if (!cache->bytes || !read_entries(cache, size))
            cache->count = 0;
    }
    return cache;
}

void shader_cache_free(struct shader_cache *cache)
{
    if (!cache)
        return;
    free(cache->bytes);
    free(cache->entries);
    free(cache->asked);
    free(cache);
}

bool shader_cache_find(struct shader_cache *cache, const struct model *model, enum backend backend,
                       struct shader *shader)
{
    uint32_t kind = kind_of(model, backend, shader->stage);
    for (size_t i = 0; i < cache->count; i++) {
        const struct entry *entry = &cache->entries[i];
        if (entry->head.kind != kind || entry->head.glsl_length != shader->glsl.length ||
            memcmp(entry->glsl, shader->glsl.data, shader->glsl.length) != 0)
            continue;
        size_t size = (size_t)entry->head.word_count * sizeof *shader->words;
        shader->words = malloc(size);
        if (!shader->words)
            return false;
        memcpy(shader->words, entry->words, size);
        shader->word_count = entry->head.word_count;
        cache->asked[i] = true;
        return true;
    }
    return false;
}

/* ---- Writing --------------------------------------------------------------------------------- */

static void add_entry(struct text *out, const struct entry *entry)
{
    text_add_bytes(out, (const char *)&entry->head, sizeof entry->head);
    text_add_bytes(out, entry->glsl, entry->head.glsl_length);
    text_add_bytes(out, (const char *)entry->words,
                   (size_t)entry->head.word_count * sizeof(uint32_t));
}

static void add_shader(struct text *out, uint32_t kind, const struct shader *shader)
{
    struct entry entry = {.head = {.kind = kind,
                                   .glsl_length = (uint32_t)shader->glsl.length,
                                   .word_count = (uint32_t)shader->word_count},
                          .glsl = shader->glsl.data,
                          .words = (const uint8_t *)shader->words};
    entry.head.hash = entry_hash(&entry);
    add_entry(out, &entry);
}

void shader_cache_emit(const struct shader_cache *cache, const struct model *model,
                       struct pass_shaders *const shaders[2], struct text *out)
{
    struct head head = {.program = program_hash()};
    memcpy(head.magic, magic, sizeof magic);
    text_add_bytes(out, (const char *)&head, sizeof head);
    for (enum backend backend = BACKEND_GL; backend <= BACKEND_VK; backend++)
        for (uint32_t i = 0; i < model->pipeline.pass_count; i++)
            for (enum stage stage = STAGE_IS_COMPUTE; stage <= STAGE_IS_FRAGMENT; stage++) {
                const struct shader *shader = &shaders[backend][i].stage[stage];
                if (shader->word_count)
                    add_shader(out, kind_of(model, backend, stage), shader);
            }
    for (size_t i = 0; i < cache->count && out->length < MOST_BYTES; i++)
        if (!cache->asked[i])
            add_entry(out, &cache->entries[i]);
}
