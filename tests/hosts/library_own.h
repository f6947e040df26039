/* A host with the renderer's callbacks and threads, its own allocator and pipeline cache, and with functions between the
 * runtime and Vulkan that count, and that fail or leave out what a test asks for. */
#pragma once

#include <stdatomic.h>

#include "library_vk.h"

extern struct own {
    int memory, fail_memory; /* allocations alive; the n-th from now on fails; 0: none */
    VkPipelineCache cache;
    atomic_int pipelines; /* created so far, all with the cache */
    atomic_int strangers; /* created without */
    atomic_bool fail_pipelines;
    unsigned barriers, drop; /* recorded; the one to leave out, from 1; 0: none */
} own;

/* Allocates at an offset, never from the start of the memory. */
VkResult own_allocate(void *user, const VkMemoryRequirements *needs, const char *name,
                      struct dt_vk_memory *out);

struct dt_vk_host own_host(void);
