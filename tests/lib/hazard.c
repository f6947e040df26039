/* The hazards of a tape; see hazard.h. The model is the specification's (Vulkan 1.3, chapter 7.1
 * "Execution and Memory Dependencies", 7.6 "Pipeline Barriers", and the memory model's appendix):
 *
 * - A barrier orders its first synchronization scope before its second one, for all resources.
 *   Barriers chain when the second scope of one meets the first scope of the next. Source stages
 *   include logically earlier ones, destination stages logically later ones.
 * - A later access sees a write, or a later write is ordered after it, only with both of these: a
 *   barrier whose first access scope holds the write makes it available; that barrier or a chained
 *   one, whose second access scope holds the later access, makes it visible. Access scopes have
 *   exactly the stages that are named, and hold only memory of the barrier's resource.
 * - A read needs no more than an execution dependency before a later write.
 * - A change of layout reads and writes all of the range, after the first scope and its availability,
 *   before the second scope. Its write is available, and visible to the second access scope. The
 *   change starts from the layout that the image has, or from UNDEFINED. An access needs the image
 *   in the layout that the access names.
 *
 * The checker follows every access from barrier to barrier, with one node for each piece of memory.
 * No resource covers a piece in part. */
#include "hazard.h"

#include <stdlib.h>
#include <string.h>

/* ---- Stages and accesses --------------------------------------------------------------------- */

#define STAGE(name)  VK_PIPELINE_STAGE_2_##name##_BIT
#define ACCESS(name) VK_ACCESS_2_##name##_BIT

static const VkPipelineStageFlags2 graphics_order[] = {
    STAGE(DRAW_INDIRECT),          STAGE(INDEX_INPUT),
    STAGE(VERTEX_ATTRIBUTE_INPUT), STAGE(VERTEX_SHADER),
    STAGE(EARLY_FRAGMENT_TESTS),   STAGE(FRAGMENT_SHADER),
    STAGE(LATE_FRAGMENT_TESTS),    STAGE(COLOR_ATTACHMENT_OUTPUT),
};
static const VkPipelineStageFlags2 compute_order[] = {STAGE(DRAW_INDIRECT), STAGE(COMPUTE_SHADER)};

enum { GRAPHICS_STAGES = sizeof graphics_order / sizeof *graphics_order, COMPUTE_STAGES = 2 };
static const VkPipelineStageFlags2 transfer_stages = STAGE(COPY) | STAGE(CLEAR);

static const VkAccessFlags2 reads =
    ACCESS(INDIRECT_COMMAND_READ) | ACCESS(INDEX_READ) | ACCESS(VERTEX_ATTRIBUTE_READ) |
    ACCESS(UNIFORM_READ) | ACCESS(SHADER_SAMPLED_READ) | ACCESS(SHADER_STORAGE_READ) |
    ACCESS(COLOR_ATTACHMENT_READ) | ACCESS(DEPTH_STENCIL_ATTACHMENT_READ) | ACCESS(TRANSFER_READ);
static const VkAccessFlags2 writes = ACCESS(SHADER_STORAGE_WRITE) | ACCESS(COLOR_ATTACHMENT_WRITE) |
                                     ACCESS(DEPTH_STENCIL_ATTACHMENT_WRITE) |
                                     ACCESS(TRANSFER_WRITE);

static VkPipelineStageFlags2 all_stages(void)
{
    VkPipelineStageFlags2 all = STAGE(COMPUTE_SHADER) | transfer_stages;

    for (int i = 0; i < GRAPHICS_STAGES; i++)
        all |= graphics_order[i];
    return all;
}

/* The stages that a mask names, bits that stand for several resolved. */
static VkPipelineStageFlags2 named_stages(VkPipelineStageFlags2 mask)
{
    if (mask & STAGE(ALL_COMMANDS))
        mask |= all_stages();
    if (mask & STAGE(ALL_TRANSFER))
        mask |= transfer_stages;
    for (int i = 0; i < GRAPHICS_STAGES && mask & STAGE(ALL_GRAPHICS); i++)
        mask |= graphics_order[i];
    return mask & all_stages();
}

static VkAccessFlags2 named_accesses(VkAccessFlags2 mask)
{
    if (mask & ACCESS(MEMORY_READ))
        mask |= reads;
    if (mask & ACCESS(MEMORY_WRITE))
        mask |= writes;
    if (mask & ACCESS(SHADER_READ))
        mask |= ACCESS(SHADER_SAMPLED_READ) | ACCESS(SHADER_STORAGE_READ);
    if (mask & ACCESS(SHADER_WRITE))
        mask |= ACCESS(SHADER_STORAGE_WRITE);
    return mask & (reads | writes);
}

static VkPipelineStageFlags2 with_earlier(VkPipelineStageFlags2 mask,
                                          const VkPipelineStageFlags2 *order, int count)
{
    for (int i = count - 1; i > 0; i--)
        mask |= mask & order[i] ? order[i - 1] : 0;
    return mask;
}

static VkPipelineStageFlags2 with_later(VkPipelineStageFlags2 mask,
                                        const VkPipelineStageFlags2 *order, int count)
{
    for (int i = 0; i + 1 < count; i++)
        mask |= mask & order[i] ? order[i + 1] : 0;
    return mask;
}

static VkPipelineStageFlags2 first_scope(const struct tape_barrier *barrier)
{
    VkPipelineStageFlags2 named = named_stages(barrier->src_stage);

    return with_earlier(named, graphics_order, GRAPHICS_STAGES) |
           with_earlier(named, compute_order, COMPUTE_STAGES);
}

static VkPipelineStageFlags2 second_scope(const struct tape_barrier *barrier)
{
    VkPipelineStageFlags2 named = named_stages(barrier->dst_stage);

    return with_later(named, graphics_order, GRAPHICS_STAGES) |
           with_later(named, compute_order, COMPUTE_STAGES);
}

/* ---- Pieces of memory ------------------------------------------------------------------------ */

struct piece {
    uint64_t memory, begin, end;
};

/* State of one access to one piece of memory. */
struct node {
    uint32_t entry; /* UINT32_MAX: before the tape */
    uint32_t command, resource, piece, mips;
    VkPipelineStageFlags2 stage; /* 0: a change of layout, which runs in none */
    VkAccessFlags2 access;
    bool writes;
    /* so far: */
    VkPipelineStageFlags2 before; /* stages of later commands that wait for it */
    bool available;
    VkAccessFlags2 visible[64]; /* by the bit of a stage */
};

struct checker {
    const struct tape *tape;
    struct piece *pieces;
    uint32_t piece_count;
    struct node *nodes, *next; /* the state before and after one call */
    uint32_t node_count, node_capacity;
    VkImageLayout *layouts; /* of the resources, now */
    void (*found)(void *user, const struct hazard *hazard);
    void *user;
    uint32_t hazards;
};

static void *grown(void *array, size_t size)
{
    void *more = realloc(array, size ? size : 1);

    if (!more)
        abort();
    return more;
}

static int compare_numbers(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

    return (x > y) - (x < y);
}

/* Cuts one memory at every border of a resource. */
static void cut_memory(struct checker *checker, uint64_t memory)
{
    const struct tape *tape = checker->tape;
    uint64_t *borders = grown(NULL, (size_t)tape->resource_count * 2 * sizeof *borders);
    uint32_t count = 0;

    for (uint32_t i = 0; i < tape->resource_count; i++) {
        if (tape->resources[i].memory == memory) {
            borders[count++] = tape->resources[i].offset;
            borders[count++] = tape->resources[i].offset + tape->resources[i].size;
        }
    }
    qsort(borders, count, sizeof *borders, compare_numbers);
    checker->pieces =
        grown(checker->pieces, (checker->piece_count + count + 1) * sizeof *checker->pieces);
    for (uint32_t i = 1; i < count; i++) {
        if (borders[i] > borders[i - 1])
            checker->pieces[checker->piece_count++] =
                (struct piece){memory, borders[i - 1], borders[i]};
    }
    free(borders);
}

static void cut_all(struct checker *checker)
{
    const struct tape *tape = checker->tape;

    for (uint32_t i = 0; i < tape->resource_count; i++) {
        bool done = false;

        for (uint32_t j = 0; j < i && !done; j++)
            done = tape->resources[j].memory == tape->resources[i].memory;
        if (!done && tape->resources[i].memory)
            cut_memory(checker, tape->resources[i].memory);
    }
}

static bool covers(const struct tape_resource *resource, const struct piece *piece)
{
    return resource->memory == piece->memory && resource->offset <= piece->begin &&
           piece->end <= resource->offset + resource->size;
}

/* ---- Order ----------------------------------------------------------------------------------- */

static void add_hazard(struct checker *checker, uint32_t earlier, uint32_t later, const char *kind)
{
    if (checker->found)
        checker->found(checker->user, &(struct hazard){earlier, later, kind});
    checker->hazards++;
}

static bool same_place(const struct node *node, uint32_t piece, uint32_t resource, uint32_t mips)
{
    return node->piece == piece && (node->resource != resource || node->mips & mips);
}

/* Whether the barrier covers the memory of the node. */
static bool reaches(const struct checker *checker, const struct tape_barrier *barrier,
                    const struct node *node)
{
    if (barrier->resource == TAPE_ALL_MEMORY)
        return true;
    return covers(&checker->tape->resources[barrier->resource], &checker->pieces[node->piece]) &&
           (node->resource != barrier->resource || node->mips & barrier->mips);
}

static bool executed_before(const struct tape_barrier *barrier, const struct node *node)
{
    VkPipelineStageFlags2 scope = first_scope(barrier);
    bool held = node->stage && !(node->stage & ~scope);

    return held || node->before & scope || node->entry == UINT32_MAX;
}

static bool made_available(const struct checker *checker, const struct tape_barrier *barrier,
                           const struct node *node)
{
    return node->writes && node->stage && reaches(checker, barrier, node) &&
           !(node->stage & ~named_stages(barrier->src_stage)) &&
           !(node->access & ~named_accesses(barrier->src_access));
}

static void show(const struct tape_barrier *barrier, struct node *node)
{
    VkPipelineStageFlags2 stages = named_stages(barrier->dst_stage);

    for (int bit = 0; bit < 64; bit++)
        if (stages >> bit & 1)
            node->visible[bit] |= named_accesses(barrier->dst_access);
}

/* Effect of one barrier on a node, from the state before the call. */
static void pass_barrier(const struct checker *checker, const struct tape_barrier *barrier,
                         const struct node *node, struct node *after)
{
    bool held = executed_before(barrier, node);
    bool available = made_available(checker, barrier, node) || (node->available && held);

    if (held)
        after->before |= second_scope(barrier);
    if (node->writes && available && reaches(checker, barrier, node)) {
        after->available = true;
        show(barrier, after);
    }
}

static struct node *add_node(struct checker *checker)
{
    if (checker->node_count == checker->node_capacity) {
        checker->node_capacity = checker->node_capacity ? checker->node_capacity * 2 : 256;
        checker->nodes = grown(checker->nodes, checker->node_capacity * sizeof *checker->nodes);
        checker->next = grown(checker->next, checker->node_capacity * sizeof *checker->next);
    }
    struct node *node = &checker->nodes[checker->node_count++];
    memset(node, 0, sizeof *node);
    return node;
}

/* ---- The tape -------------------------------------------------------------------------------- */

static bool is_transition(const struct tape_barrier *barrier)
{
    return barrier->resource != TAPE_ALL_MEMORY && barrier->old_layout != barrier->new_layout;
}

/* Checks the layout change against everything before it. */
static void check_transition(struct checker *checker, uint32_t entry)
{
    const struct tape_barrier *barrier = &checker->tape->entries[entry].barrier;
    VkImageLayout *layout = &checker->layouts[barrier->resource];

    if (barrier->old_layout != VK_IMAGE_LAYOUT_UNDEFINED && barrier->old_layout != *layout)
        add_hazard(checker, UINT32_MAX, entry, "wrong layout");
    *layout = barrier->new_layout;
    for (uint32_t i = 0; i < checker->node_count; i++) {
        const struct node *node = &checker->nodes[i];

        if (!reaches(checker, barrier, node))
            continue;
        if (!executed_before(barrier, node))
            add_hazard(checker, node->entry, entry,
                       node->writes ? "layout change after write" : "layout change after read");
        else if (node->writes && !node->available && !made_available(checker, barrier, node))
            add_hazard(checker, node->entry, entry, "layout change after write");
    }
}

static void add_transition(struct checker *checker, uint32_t entry)
{
    const struct tape_barrier *barrier = &checker->tape->entries[entry].barrier;
    const struct tape_resource *resource = &checker->tape->resources[barrier->resource];

    for (uint32_t piece = 0; piece < checker->piece_count; piece++) {
        if (!covers(resource, &checker->pieces[piece]))
            continue;
        struct node *node = add_node(checker);
        node->entry = entry;
        node->command = UINT32_MAX;
        node->resource = barrier->resource;
        node->piece = piece;
        node->mips = barrier->mips;
        node->writes = node->available = true;
        node->before = second_scope(barrier);
        show(barrier, node);
    }
}

/* A layout change replaces all earlier accesses: later accesses are checked only against it. */
static void forget_before(struct checker *checker, uint32_t entry)
{
    const struct tape_barrier *barrier = &checker->tape->entries[entry].barrier;
    uint32_t kept = 0;

    for (uint32_t i = 0; i < checker->node_count; i++)
        if (!reaches(checker, barrier, &checker->nodes[i]))
            checker->nodes[kept++] = checker->nodes[i];
    checker->node_count = kept;
}

/* All barriers of one call, from entry `begin` on; returns the entry after them. */
static uint32_t pass_call(struct checker *checker, uint32_t begin)
{
    const struct tape_entry *entries = checker->tape->entries;
    uint32_t end = begin;

    while (end < checker->tape->entry_count && entries[end].is_barrier &&
           entries[end].barrier.call == entries[begin].barrier.call)
        end++;
    if (checker->node_count)
        memcpy(checker->next, checker->nodes, checker->node_count * sizeof *checker->nodes);
    for (uint32_t entry = begin; entry < end; entry++) {
        if (is_transition(&entries[entry].barrier))
            check_transition(checker, entry);
        for (uint32_t i = 0; i < checker->node_count; i++)
            pass_barrier(checker, &entries[entry].barrier, &checker->nodes[i], &checker->next[i]);
    }
    struct node *nodes = checker->nodes;
    checker->nodes = checker->next;
    checker->next = nodes;
    for (uint32_t entry = begin; entry < end; entry++) {
        if (is_transition(&entries[entry].barrier)) {
            forget_before(checker, entry);
            add_transition(checker, entry);
        }
    }
    return end;
}

static void check_pair(struct checker *checker, const struct node *earlier, uint32_t entry)
{
    const struct tape_access *access = &checker->tape->entries[entry].access;
    bool ordered = !(access->stage & ~earlier->before), seen = true;

    for (int bit = 0; bit < 64; bit++)
        if (access->stage >> bit & 1 && access->access & ~earlier->visible[bit])
            seen = false;
    if (!earlier->writes) {
        if (access->writes && !ordered)
            add_hazard(checker, earlier->entry, entry, "write after read");
    } else if (!ordered || !seen) {
        add_hazard(checker, earlier->entry, entry,
                   access->writes ? "write after write" : "read after write");
    }
}

static void pass_access(struct checker *checker, uint32_t entry)
{
    const struct tape_access *access = &checker->tape->entries[entry].access;
    const struct tape_resource *resource = &checker->tape->resources[access->resource];

    if (resource->image && access->layout != checker->layouts[access->resource])
        add_hazard(checker, UINT32_MAX, entry, "wrong layout");
    for (uint32_t piece = 0; piece < checker->piece_count; piece++) {
        if (!covers(resource, &checker->pieces[piece]))
            continue;
        for (uint32_t i = 0; i < checker->node_count; i++) {
            const struct node *node = &checker->nodes[i];

            if (node->command != access->command &&
                same_place(node, piece, access->resource, access->mips))
                check_pair(checker, node, entry);
        }
        struct node *node = add_node(checker);
        node->entry = entry;
        node->command = access->command;
        node->resource = access->resource;
        node->piece = piece;
        node->mips = access->mips;
        node->stage = access->stage;
        node->access = access->access;
        node->writes = access->writes;
    }
}

/* Everything before the tape: a write of all memory, complete and available, because the host has
 * waited, but not visible. */
static void add_past(struct checker *checker)
{
    for (uint32_t piece = 0; piece < checker->piece_count; piece++) {
        struct node *node = add_node(checker);
        node->entry = node->command = node->resource = UINT32_MAX;
        node->piece = piece;
        node->before = all_stages();
        node->writes = node->available = true;
    }
}

uint32_t hazard_find(const struct tape *tape,
                     void (*found)(void *user, const struct hazard *hazard), void *user)
{
    struct checker checker = {.tape = tape, .found = found, .user = user};
    uint32_t entry = 0;

    checker.layouts = grown(NULL, tape->resource_count * sizeof *checker.layouts);
    for (uint32_t i = 0; i < tape->resource_count; i++)
        checker.layouts[i] = tape->resources[i].layout;
    cut_all(&checker);
    add_past(&checker);
    while (entry < tape->entry_count)
        if (tape->entries[entry].is_barrier)
            entry = pass_call(&checker, entry);
        else
            pass_access(&checker, entry++);
    free(checker.pieces);
    free(checker.nodes);
    free(checker.next);
    free(checker.layouts);
    return checker.hazards;
}
