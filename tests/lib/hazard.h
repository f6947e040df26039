/* The synchronization of a command buffer as a tape of accesses and barriers, and the hazards in it
 * by the memory model of the Vulkan specification. Independent of the generator: tape.c writes
 * tapes from calls to Vulkan, hazard_test.c by hand. Called by barrier_audit.c. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <vulkan/vulkan.h>

/* A buffer or an image, and its bytes of memory. Two resources of one memory that share bytes
 * alias; two mips of one image do not. */
struct tape_resource {
    uint64_t handle; /* 0: none, as everything else */
    char name[64];
    bool image;
    uint32_t mips;   /* a buffer has one */
    uint64_t memory; /* handle of the allocation; 0: none yet */
    uint64_t offset, size;
    VkImageLayout layout; /* images: of all mips, when the tape begins */
};

/* One access of a command to a resource. */
struct tape_access {
    uint32_t command; /* accesses of one command do not conflict */
    uint32_t resource;
    uint32_t mips; /* mask */
    VkPipelineStageFlags2 stage;
    VkAccessFlags2 access;
    bool writes;
    VkImageLayout layout; /* required layout of an image; UNDEFINED: a buffer */
};

enum { TAPE_ALL_MEMORY = UINT32_MAX };
struct tape_barrier {
    uint32_t call;     /* barriers of one vkCmdPipelineBarrier2 are independent */
    uint32_t resource; /* or TAPE_ALL_MEMORY: a memory barrier */
    uint32_t mips;     /* mask; a layout change covers all of them */
    VkPipelineStageFlags2 src_stage, dst_stage;
    VkAccessFlags2 src_access, dst_access;
    VkImageLayout old_layout, new_layout; /* different: a layout change of an image */
};

struct tape_entry {
    bool is_barrier;
    char pass[64];
    struct tape_access access;
    struct tape_barrier barrier;
};

struct tape {
    struct tape_resource *resources;
    uint32_t resource_count;
    struct tape_entry *entries;
    uint32_t entry_count;
};

struct hazard {
    uint32_t earlier; /* entry, or UINT32_MAX: work before the tape */
    uint32_t later;   /* entry: an access, or a barrier that changes a layout */
    const char *kind; /* "write after read" and so on; "wrong layout" has no earlier entry */
};

/* Counts unordered pairs of conflicting accesses, and accesses to images in another layout than
 * required; reports each if `found` is given. Everything before the tape counts as one write of all
 * memory: complete and available, because the host has waited, but not visible yet. Aborts when
 * memory runs out. */
uint32_t hazard_find(const struct tape *tape,
                     void (*found)(void *user, const struct hazard *hazard), void *user);
