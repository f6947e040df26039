/* What a command buffer asks of Vulkan's synchronization, as a tape of accesses and barriers, and
 * the hazards in it by the memory model of the Vulkan specification. Knows nothing of the generator:
 * tape.c writes tapes from calls to Vulkan, hazard_test.c by hand; barrier_audit.c asks. */
#ifndef DIPTYCH_TESTS_HAZARD_H
#define DIPTYCH_TESTS_HAZARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <vulkan/vulkan.h>

/* A buffer or an image, and the bytes of memory that it lies in. Two resources of one memory that
 * share bytes alias; two mips of one image do not. */
struct tape_resource {
    uint64_t handle; /* 0: none, as everything else */
    char name[64];
    bool image;
    uint32_t mips;   /* a buffer has one */
    uint64_t memory; /* handle of the allocation; 0: none yet */
    uint64_t offset, size;
    VkImageLayout layout; /* images: of all mips, when the tape begins */
};

/* One way in which one command touches one resource. */
struct tape_access {
    uint32_t command; /* accesses of one command are not held against each other */
    uint32_t resource;
    uint32_t mips; /* mask */
    VkPipelineStageFlags2 stage;
    VkAccessFlags2 access;
    bool writes;
    VkImageLayout layout; /* that an image must have; UNDEFINED: none, it is a buffer */
};

enum { TAPE_ALL_MEMORY = UINT32_MAX };
struct tape_barrier {
    uint32_t call;     /* barriers of one vkCmdPipelineBarrier2 act side by side */
    uint32_t resource; /* or TAPE_ALL_MEMORY: a memory barrier */
    uint32_t mips;     /* mask; a change of layout is for all of them */
    VkPipelineStageFlags2 src_stage, dst_stage;
    VkAccessFlags2 src_access, dst_access;
    VkImageLayout old_layout, new_layout; /* not the same: an image changes its layout */
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
    uint32_t earlier; /* entry, or UINT32_MAX: what ran before the tape */
    uint32_t later;   /* entry: an access, or a barrier that changes a layout */
    const char *kind; /* "write after read" and so on; "wrong layout" has no earlier entry */
};

/* Counts the pairs of accesses that conflict and that nothing orders, and accesses to images in another
 * layout than they ask for, and tells of each when `found` is
 * given. Everything that ran before the tape counts as a write of all memory that is complete and
 * available, but not visible yet: the host has waited for it. Aborts when memory runs out. */
uint32_t hazard_find(const struct tape *tape,
                     void (*found)(void *user, const struct hazard *hazard), void *user);

#endif
