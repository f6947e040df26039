/* Memory for what drivers keep of recorded commands: blocks side by side in chunks that are used anew
 * when all their blocks are gone, which is when a command buffer is reset. From malloc they would lie
 * scattered among whatever else a frame left behind, and giving back some hundred of them, none of them
 * in a cache any more, took longer than recording the next frame. context.c makes the command pool with
 * it. Nothing is locked: Vulkan calls back in the thread that called it, and one thread at a time uses a
 * command pool. */
#include "arena.h"

#include <stdalign.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 64 * 1024 }; /* bytes; lavapipe keeps 38,000 of a frame of 28 passes */

/* Lies at a multiple of CHUNK, and so do no two: where a block begins tells which one it is of. */
struct vk_chunk {
    struct vk_chunk *next;
    size_t size, used; /* bytes, this header included */
    size_t blocks;     /* not given back yet */
};

union head { /* before every block */
    size_t size;
    max_align_t align;
};

static struct vk_chunk *chunk_of(const void *block)
{
    const uintptr_t within = (uintptr_t)block % CHUNK;
    return (struct vk_chunk *)(void *)((char *)block - within);
}

static bool is_empty(const struct vk_chunk *chunk)
{
    return chunk->blocks == 0;
}

static size_t align_up(size_t at, size_t alignment)
{
    return (at + alignment - 1) / alignment * alignment;
}

/* NULL: there is no room. */
static void *take(struct vk_chunk *chunk, size_t size, size_t alignment)
{
    if (is_empty(chunk))
        chunk->used = sizeof *chunk;
    size_t at = align_up(chunk->used + sizeof(union head), alignment);
    if (at >= CHUNK || size > chunk->size - at)
        return NULL;
    char *block = (char *)chunk + at;
    ((union head *)(void *)block)[-1].size = size;
    chunk->used = at + size;
    chunk->blocks++;
    return block;
}

/* One that has room for such a block. */
static struct vk_chunk *add_chunk(struct vk_arena *arena, size_t block, size_t alignment)
{
    size_t least = sizeof(struct vk_chunk) + sizeof(union head) + alignment + block;
    size_t size = align_up(least, CHUNK);
    struct vk_chunk *chunk = aligned_alloc(CHUNK, size);
    if (!chunk)
        return NULL;
    *chunk = (struct vk_chunk){.next = arena->chunks, .size = size};
    arena->chunks = chunk;
    return chunk;
}

/* ---- Callbacks ------------------------------------------------------------------------------- */

static VKAPI_ATTR void *VKAPI_CALL allocate(void *user, size_t size, size_t alignment,
                                            VkSystemAllocationScope scope)
{
    struct vk_arena *arena = user;
    void *block = NULL;
    (void)scope;
    alignment = alignment < alignof(union head) ? alignof(union head) : alignment;
    if (alignment >= CHUNK / 2 || size > SIZE_MAX / 2)
        return NULL;
    if (arena->current)
        block = take(arena->current, size, alignment);
    for (struct vk_chunk *chunk = arena->chunks; chunk && !block; chunk = chunk->next)
        if (is_empty(chunk) && (block = take(chunk, size, alignment)))
            arena->current = chunk;
    if (block)
        return block;
    add_chunk(arena, 0, alignment); /* for the next frame, recorded while this one is kept */
    struct vk_chunk *added = add_chunk(arena, size, alignment);
    if (!added)
        return NULL;
    arena->current = added;
    return take(added, size, alignment);
}

static VKAPI_ATTR void VKAPI_CALL give_back(void *user, void *block)
{
    (void)user;
    if (block)
        chunk_of(block)->blocks--;
}

static VKAPI_ATTR void *VKAPI_CALL reallocate(void *user, void *block, size_t size,
                                              size_t alignment, VkSystemAllocationScope scope)
{
    void *moved = size ? allocate(user, size, alignment, scope) : NULL;
    if (moved && block) {
        size_t before = ((const union head *)block)[-1].size;
        memcpy(moved, block, before < size ? before : size);
    }
    if (moved || !size)
        give_back(user, block);
    return moved;
}

VkAllocationCallbacks vk_arena_callbacks(struct vk_arena *arena)
{
    return (VkAllocationCallbacks){
        .pUserData = arena,
        .pfnAllocation = allocate,
        .pfnReallocation = reallocate,
        .pfnFree = give_back,
    };
}

void vk_arena_free(struct vk_arena *arena)
{
    while (arena->chunks) {
        struct vk_chunk *next = arena->chunks->next;
        free(arena->chunks);
        arena->chunks = next;
    }
    arena->current = NULL;
}
