/* The model of Vulkan's synchronization that barrier_audit judges by, on tapes written by hand.
 * Each test checks a sentence of the specification (1.3, chapters 7.1, 7.6 and 12.4). Also the
 * reader of SPIR-V, on shaders whose source shows the expected result. Run by ninja test. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "hazard.h"
#include "spirv_uses.h"

#include "shaders.h"

/* ---- A tape in a few words ------------------------------------------------------------------- */

#define COMPUTE   VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT
#define VERTEX    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT
#define FRAGMENT  VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT
#define EARLY     VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT
#define LATE      VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT
#define INDIRECT  VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT
#define ANYTHING  VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT
#define NOTHING   VK_PIPELINE_STAGE_2_NONE
#define LOADS     VK_ACCESS_2_SHADER_STORAGE_READ_BIT
#define STORES    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT
#define SAMPLES   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT
#define ARGUMENTS VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT
#define DEPTH     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT
#define GENERAL   VK_IMAGE_LAYOUT_GENERAL
#define READ_ONLY VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
#define UNDEFINED VK_IMAGE_LAYOUT_UNDEFINED

/* A and B are buffers in memory of their own. SMALL and LARGE begin at the same byte of one memory, LARGE
 * is twice as long; BESIDE lies behind SMALL. IMAGE has two mips, in the general layout. */
enum { A, B, SMALL, LARGE, BESIDE, IMAGE, RESOURCES };

struct fixture {
    struct tape tape;
    struct tape_resource resources[RESOURCES];
    struct tape_entry entries[16];
    uint32_t command, call;
};

static int setup(void **state)
{
    static const struct tape_resource resources[RESOURCES] = {
        [A] = {.handle = 1, .mips = 1, .memory = 1, .size = 64},
        [B] = {.handle = 2, .mips = 1, .memory = 2, .size = 64},
        [SMALL] = {.handle = 3, .mips = 1, .memory = 3, .size = 64},
        [LARGE] = {.handle = 4, .mips = 1, .memory = 3, .size = 128},
        [BESIDE] = {.handle = 5, .mips = 1, .memory = 3, .offset = 64, .size = 64},
        [IMAGE] =
            {.handle = 6, .image = true, .mips = 2, .memory = 4, .size = 64, .layout = GENERAL},
    };
    struct fixture *f = test_calloc(1, sizeof *f);

    memcpy(f->resources, resources, sizeof resources);
    f->tape.resources = f->resources;
    f->tape.resource_count = RESOURCES;
    f->tape.entries = f->entries;
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    test_free(*state);
    return 0;
}

/* A command with this one access. */
static void touch_mip(struct fixture *f, uint32_t resource, uint32_t mip,
                      VkPipelineStageFlags2 stage, VkAccessFlags2 access)
{
    bool image = f->resources[resource].image;

    f->entries[f->tape.entry_count++] =
        (struct tape_entry){.access = {.command = ++f->command,
                                       .resource = resource,
                                       .mips = 1u << mip,
                                       .stage = stage,
                                       .access = access,
                                       .writes = access & (STORES | DEPTH),
                                       .layout = image ? GENERAL : UNDEFINED}};
}

static void touch(struct fixture *f, uint32_t resource, VkPipelineStageFlags2 stage,
                  VkAccessFlags2 access)
{
    touch_mip(f, resource, 0, stage, access);
}

static struct tape_barrier *beside(struct fixture *f, uint32_t resource,
                                   VkPipelineStageFlags2 src_stage, VkAccessFlags2 src_access,
                                   VkPipelineStageFlags2 dst_stage, VkAccessFlags2 dst_access)
{
    struct tape_entry *entry = &f->entries[f->tape.entry_count++];

    *entry = (struct tape_entry){.is_barrier = true,
                                 .barrier = {.call = f->call,
                                             .resource = resource,
                                             .mips = 3,
                                             .src_stage = src_stage,
                                             .src_access = src_access,
                                             .dst_stage = dst_stage,
                                             .dst_access = dst_access}};
    return &entry->barrier;
}

/* A call of its own; `beside` adds to it. */
static struct tape_barrier *barrier(struct fixture *f, uint32_t resource,
                                    VkPipelineStageFlags2 src_stage, VkAccessFlags2 src_access,
                                    VkPipelineStageFlags2 dst_stage, VkAccessFlags2 dst_access)
{
    f->call++;
    return beside(f, resource, src_stage, src_access, dst_stage, dst_access);
}

static void opening(struct fixture *f)
{
    barrier(f, TAPE_ALL_MEMORY, ANYTHING, VK_ACCESS_2_MEMORY_WRITE_BIT, ANYTHING,
            VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

static void keep_first(void *user, const struct hazard *hazard)
{
    struct hazard *first = user;

    if (!first->kind)
        *first = *hazard;
}

/* Judges the tape and begins it anew. kind NULL: nothing is wrong. */
static void expect(struct fixture *f, const char *kind)
{
    struct hazard first = {0};
    uint32_t count = hazard_find(&f->tape, keep_first, &first);

    if (kind) {
        assert_true(count > 0);
        assert_string_equal(first.kind, kind);
    } else if (count) {
        fail_msg("unexpected: %s", first.kind);
    }
    f->tape.entry_count = 0;
    opening(f);
}

static void begin(void **state, struct fixture **f)
{
    *f = *state;
    opening(*f);
}

/* ---- Dependencies ---------------------------------------------------------------------------- */

static void a_read_needs_a_memory_dependency(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, STORES);
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, COMPUTE, LOADS);
    touch(f, A, COMPUTE, LOADS);
    expect(f, NULL);
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, 0, COMPUTE, LOADS); /* not made available */
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, COMPUTE, VK_ACCESS_2_UNIFORM_READ_BIT); /* visible to others */
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, FRAGMENT, LOADS); /* in another stage */
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
}

static void a_write_after_a_read_needs_an_execution_dependency(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, LOADS);
    touch(f, A, COMPUTE, STORES);
    expect(f, "write after read");
    touch(f, A, COMPUTE, LOADS);
    barrier(f, A, COMPUTE, 0, COMPUTE, 0);
    touch(f, A, COMPUTE, STORES);
    expect(f, NULL);
    touch(f, A, COMPUTE, LOADS);
    barrier(f, A, FRAGMENT, 0, COMPUTE, 0);
    touch(f, A, COMPUTE, STORES);
    expect(f, "write after read");
}

static void a_write_after_a_write_needs_a_memory_dependency(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, 0, COMPUTE, 0);
    touch(f, A, COMPUTE, STORES);
    expect(f, "write after write");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, COMPUTE, STORES);
    touch(f, A, COMPUTE, STORES);
    expect(f, NULL);
}

static void reads_and_other_memory_need_nothing(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, LOADS);
    touch(f, A, FRAGMENT, LOADS);
    touch(f, B, COMPUTE, STORES);
    expect(f, NULL);
}

static void barriers_chain_through_a_common_stage(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, VERTEX, LOADS);
    barrier(f, A, VERTEX, 0, FRAGMENT, LOADS); /* available already */
    touch(f, A, FRAGMENT, LOADS);
    expect(f, NULL);
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, EARLY, LOADS);
    barrier(f, A, INDIRECT, 0, FRAGMENT, LOADS); /* INDIRECT did not wait, so no chain */
    touch(f, A, FRAGMENT, LOADS);
    expect(f, "read after write");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, 0, VERTEX, 0);
    barrier(f, A, VERTEX, STORES, FRAGMENT, LOADS); /* the store was not in the vertex stage */
    touch(f, A, FRAGMENT, LOADS);
    expect(f, "read after write");
}

static void barriers_of_one_call_do_not_chain(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, FRAGMENT, LOADS);
    barrier(f, A, FRAGMENT, 0, COMPUTE, 0);
    beside(f, A, COMPUTE, 0, FRAGMENT, 0);
    touch(f, A, FRAGMENT, STORES);
    expect(f, "write after read");
    touch(f, A, FRAGMENT, LOADS);
    barrier(f, A, FRAGMENT, 0, COMPUTE, 0);
    barrier(f, A, COMPUTE, 0, FRAGMENT, 0);
    touch(f, A, FRAGMENT, STORES);
    expect(f, NULL);
}

static void execution_is_not_limited_to_the_resource(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, LOADS);
    barrier(f, B, COMPUTE, 0, COMPUTE, 0);
    touch(f, A, COMPUTE, STORES);
    expect(f, NULL);
    touch(f, A, COMPUTE, STORES);
    barrier(f, B, COMPUTE, STORES, COMPUTE, LOADS); /* availability is limited to B */
    barrier(f, A, COMPUTE, 0, COMPUTE, LOADS);
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, COMPUTE, 0);
    barrier(f, B, COMPUTE, 0, COMPUTE, LOADS); /* visibility is limited to B */
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
}

/* ---- Stages ---------------------------------------------------------------------------------- */

static void source_stages_include_earlier_ones_but_not_their_accesses(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, VERTEX, LOADS);
    barrier(f, A, FRAGMENT, 0, COMPUTE, 0);
    touch(f, A, COMPUTE, STORES);
    expect(f, NULL);
    touch(f, A, EARLY, DEPTH);
    barrier(f, A, LATE, DEPTH, COMPUTE, SAMPLES);
    touch(f, A, COMPUTE, SAMPLES);
    expect(f, "read after write");
    touch(f, A, EARLY, DEPTH);
    barrier(f, A, EARLY | LATE, DEPTH, COMPUTE, SAMPLES);
    touch(f, A, COMPUTE, SAMPLES);
    expect(f, NULL);
}

static void destination_stages_include_later_ones_but_not_their_accesses(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, LOADS);
    barrier(f, A, COMPUTE, 0, INDIRECT, 0);
    touch(f, A, FRAGMENT, STORES);
    expect(f, NULL);
    touch(f, A, COMPUTE, LOADS);
    barrier(f, A, COMPUTE, 0, FRAGMENT, 0);
    touch(f, A, VERTEX, STORES);
    expect(f, "write after read");
    touch(f, A, COMPUTE, STORES);
    barrier(f, A, COMPUTE, STORES, INDIRECT, ARGUMENTS | LOADS);
    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
}

/* ---- Layouts --------------------------------------------------------------------------------- */

static void to_layout(struct tape_barrier *barrier, VkImageLayout from, VkImageLayout to)
{
    barrier->old_layout = from;
    barrier->new_layout = to;
}

static void a_change_of_layout_waits_like_a_write(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, IMAGE, COMPUTE, LOADS);
    to_layout(barrier(f, IMAGE, NOTHING, 0, COMPUTE, LOADS), UNDEFINED, GENERAL);
    touch(f, IMAGE, COMPUTE, LOADS);
    expect(f, "layout change after read");
    touch(f, IMAGE, COMPUTE, LOADS);
    to_layout(barrier(f, IMAGE, COMPUTE, 0, COMPUTE, LOADS), UNDEFINED, GENERAL);
    touch(f, IMAGE, COMPUTE, LOADS);
    expect(f, NULL);
    touch(f, IMAGE, COMPUTE, STORES);
    to_layout(barrier(f, IMAGE, COMPUTE, 0, COMPUTE, LOADS), UNDEFINED, GENERAL);
    expect(f, "layout change after write");
    touch(f, IMAGE, COMPUTE, STORES);
    to_layout(barrier(f, IMAGE, COMPUTE, STORES, COMPUTE, LOADS), UNDEFINED, GENERAL);
    expect(f, NULL);
    /* the barrier of another resource does not order the change itself */
    touch(f, IMAGE, COMPUTE, LOADS);
    barrier(f, A, COMPUTE, 0, COMPUTE, 0);
    to_layout(beside(f, IMAGE, NOTHING, 0, COMPUTE, LOADS), UNDEFINED, GENERAL);
    expect(f, "layout change after read");
}

static void accesses_wait_for_a_change_of_layout(void **state)
{
    struct fixture *f;

    begin(state, &f);
    to_layout(barrier(f, IMAGE, NOTHING, 0, COMPUTE, LOADS), UNDEFINED, GENERAL);
    touch(f, IMAGE, FRAGMENT, LOADS);
    expect(f, "read after write");
    to_layout(barrier(f, IMAGE, NOTHING, 0, COMPUTE, LOADS), UNDEFINED, GENERAL);
    barrier(f, IMAGE, COMPUTE, 0, FRAGMENT, LOADS); /* the change made its write available */
    touch(f, IMAGE, FRAGMENT, LOADS);
    expect(f, NULL);
}

static void images_are_found_in_the_layout_that_is_named(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, IMAGE, COMPUTE, LOADS); /* needs GENERAL, the present layout */
    expect(f, NULL);
    to_layout(barrier(f, IMAGE, NOTHING, 0, COMPUTE, LOADS), GENERAL, READ_ONLY);
    touch(f, IMAGE, COMPUTE, LOADS);
    expect(f, "wrong layout");
    to_layout(barrier(f, IMAGE, NOTHING, 0, COMPUTE, LOADS), READ_ONLY, GENERAL);
    expect(f, "wrong layout");
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static void mips_are_apart(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch_mip(f, IMAGE, 0, COMPUTE, STORES);
    touch_mip(f, IMAGE, 1, COMPUTE, STORES);
    expect(f, NULL);
    touch_mip(f, IMAGE, 1, COMPUTE, STORES);
    touch_mip(f, IMAGE, 1, COMPUTE, STORES);
    expect(f, "write after write");
}

static void aliases_share_their_bytes(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, SMALL, COMPUTE, STORES);
    touch(f, BESIDE, COMPUTE, STORES);
    expect(f, NULL);
    touch(f, SMALL, COMPUTE, LOADS);
    touch(f, LARGE, COMPUTE, STORES);
    expect(f, "write after read");
    touch(f, LARGE, COMPUTE, STORES);
    barrier(f, BESIDE, COMPUTE, STORES, COMPUTE, STORES);
    touch(f, BESIDE, COMPUTE, STORES);
    expect(f, NULL);
    /* the barrier on SMALL does not make the bytes behind it available for BESIDE */
    touch(f, LARGE, COMPUTE, STORES);
    barrier(f, SMALL, COMPUTE, STORES, COMPUTE, STORES);
    touch(f, SMALL, COMPUTE, STORES);
    barrier(f, LARGE, COMPUTE, 0, COMPUTE, STORES);
    touch(f, BESIDE, COMPUTE, STORES);
    expect(f, "write after write");
}

static void what_ran_before_is_available_but_not_visible(void **state)
{
    struct fixture *f = *state;

    touch(f, A, COMPUTE, LOADS);
    expect(f, "read after write");
    touch(f, A, COMPUTE, LOADS);
    expect(f, NULL);
}

static void accesses_of_one_command_are_not_held_against_each_other(void **state)
{
    struct fixture *f;

    begin(state, &f);
    touch(f, A, COMPUTE, LOADS);
    touch(f, A, COMPUTE, STORES);
    f->entries[f->tape.entry_count - 1].access.command--;
    expect(f, NULL);
}

/* ---- SPIR-V ---------------------------------------------------------------------------------- */

static void expect_uses(const uint32_t *words, size_t size, uint8_t b0, uint8_t b1, uint8_t b2,
                        uint8_t b3)
{
    uint8_t uses[SPIRV_BINDINGS];
    const char *problem = NULL;

    assert_true(spirv_uses(words, size / sizeof *words, uses, &problem));
    assert_null(problem);
    assert_int_equal(uses[0], b0);
    assert_int_equal(uses[1], b1);
    assert_int_equal(uses[2], b2);
    assert_int_equal(uses[3], b3);
}

static void shaders_use_what_their_source_says(void **state)
{
    (void)state;
    expect_uses(count_comp, sizeof count_comp, SPIRV_READS, SPIRV_READS, SPIRV_WRITES,
                SPIRV_READS | SPIRV_WRITES);
    expect_uses(mask_comp, sizeof mask_comp, SPIRV_READS, SPIRV_WRITES, 0, 0);
    expect_uses(plan_comp, sizeof plan_comp, SPIRV_READS, SPIRV_WRITES, SPIRV_WRITES, 0);
    expect_uses(scene_frag, sizeof scene_frag, SPIRV_READS, SPIRV_READS, 0, 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_read_needs_a_memory_dependency),
        TEST(a_write_after_a_read_needs_an_execution_dependency),
        TEST(a_write_after_a_write_needs_a_memory_dependency),
        TEST(reads_and_other_memory_need_nothing),
        TEST(barriers_chain_through_a_common_stage),
        TEST(barriers_of_one_call_do_not_chain),
        TEST(execution_is_not_limited_to_the_resource),
        TEST(source_stages_include_earlier_ones_but_not_their_accesses),
        TEST(destination_stages_include_later_ones_but_not_their_accesses),
        TEST(a_change_of_layout_waits_like_a_write),
        TEST(accesses_wait_for_a_change_of_layout),
        TEST(images_are_found_in_the_layout_that_is_named),
        TEST(mips_are_apart),
        TEST(aliases_share_their_bytes),
        TEST(what_ran_before_is_available_but_not_visible),
        TEST(accesses_of_one_command_are_not_held_against_each_other),
        cmocka_unit_test(shaders_use_what_their_source_says),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
