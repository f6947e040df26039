/* Memory for what drivers keep of recorded commands; see arena.c. */
#ifndef DIPTYCH_RUNTIME_VK_ARENA_H
#define DIPTYCH_RUNTIME_VK_ARENA_H

#include <vulkan/vulkan.h>

struct vk_chunk;

struct vk_arena {
    struct vk_chunk *chunks, *current;
};

/* Callbacks for a command pool; the arena, zeroed at first, outlives it and stays where it is. */
VkAllocationCallbacks vk_arena_callbacks(struct vk_arena *arena);

/* Gives all of it back, when the pool is gone. */
void vk_arena_free(struct vk_arena *arena);

#endif
