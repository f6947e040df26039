/* The model of Vulkan's synchronization that barrier_audit judges by, on tapes written by hand.
 * Each group of rows checks a sentence of the specification (1.3, chapters 7.1, 7.6 and 12.4). Also the
 * reader of SPIR-V, on shaders whose source shows the expected result. Run by ninja test. */
#include <string.h>

#include "tests/lib/unit.h"
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

/* Steps end with what they need. */
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

/* A command with one access, or a barrier. TOO: of the same command, or of the same call, as the step before. */
struct step {
    enum { END, TOUCH, TOUCH_TOO, TOUCH_MIP_1, WAIT, WAIT_TOO } kind;
    uint32_t resource;
    VkPipelineStageFlags2 stage;
    VkAccessFlags2 access;
    VkPipelineStageFlags2 to_stage; /* barriers */
    VkAccessFlags2 to_access;
    VkImageLayout from, to;
};

enum { MOST_STEPS = 6 };
static const struct row {
    const char *kind; /* of the first hazard; NULL: none */
    struct step steps[MOST_STEPS];
} rows[] = {
    /* A read needs a memory dependency. */
    {"read after write", {{TOUCH, A, COMPUTE, STORES}, {TOUCH, A, COMPUTE, LOADS}}},
    {NULL,
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, COMPUTE, LOADS},
      {TOUCH, A, COMPUTE, LOADS}}},
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, 0, COMPUTE, LOADS},
      {TOUCH, A, COMPUTE, LOADS}}}, /* not made available */
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, COMPUTE, VK_ACCESS_2_UNIFORM_READ_BIT},
      {TOUCH, A, COMPUTE, LOADS}}}, /* visible to others */
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, FRAGMENT, LOADS},
      {TOUCH, A, COMPUTE, LOADS}}}, /* in another stage */
    /* A write after a read needs an execution dependency. */
    {"write after read", {{TOUCH, A, COMPUTE, LOADS}, {TOUCH, A, COMPUTE, STORES}}},
    {NULL,
     {{TOUCH, A, COMPUTE, LOADS}, {WAIT, A, COMPUTE, 0, COMPUTE, 0}, {TOUCH, A, COMPUTE, STORES}}},
    {"write after read",
     {{TOUCH, A, COMPUTE, LOADS}, {WAIT, A, FRAGMENT, 0, COMPUTE, 0}, {TOUCH, A, COMPUTE, STORES}}},
    /* A write after a write needs a memory dependency. */
    {"write after write",
     {{TOUCH, A, COMPUTE, STORES}, {WAIT, A, COMPUTE, 0, COMPUTE, 0}, {TOUCH, A, COMPUTE, STORES}}},
    {NULL,
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, COMPUTE, STORES},
      {TOUCH, A, COMPUTE, STORES}}},
    /* Reads and other memory need nothing. */
    {NULL, {{TOUCH, A, COMPUTE, LOADS}, {TOUCH, A, FRAGMENT, LOADS}, {TOUCH, B, COMPUTE, STORES}}},
    /* Barriers chain through a common stage. */
    {NULL,
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, VERTEX, LOADS},
      {WAIT, A, VERTEX, 0, FRAGMENT, LOADS},
      {TOUCH, A, FRAGMENT, LOADS}}}, /* available already */
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, EARLY, LOADS},
      {WAIT, A, INDIRECT, 0, FRAGMENT, LOADS},
      {TOUCH, A, FRAGMENT, LOADS}}}, /* INDIRECT did not wait, so no chain */
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, 0, VERTEX, 0},
      {WAIT, A, VERTEX, STORES, FRAGMENT, LOADS},
      {TOUCH, A, FRAGMENT, LOADS}}}, /* the store was not in the vertex stage */
    /* Barriers of one call do not chain. */
    {"write after read",
     {{TOUCH, A, FRAGMENT, LOADS},
      {WAIT, A, FRAGMENT, 0, COMPUTE, 0},
      {WAIT_TOO, A, COMPUTE, 0, FRAGMENT, 0},
      {TOUCH, A, FRAGMENT, STORES}}},
    {NULL,
     {{TOUCH, A, FRAGMENT, LOADS},
      {WAIT, A, FRAGMENT, 0, COMPUTE, 0},
      {WAIT, A, COMPUTE, 0, FRAGMENT, 0},
      {TOUCH, A, FRAGMENT, STORES}}},
    /* Execution is not limited to the resource. */
    {NULL,
     {{TOUCH, A, COMPUTE, LOADS}, {WAIT, B, COMPUTE, 0, COMPUTE, 0}, {TOUCH, A, COMPUTE, STORES}}},
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, B, COMPUTE, STORES, COMPUTE, LOADS},
      {WAIT, A, COMPUTE, 0, COMPUTE, LOADS},
      {TOUCH, A, COMPUTE, LOADS}}}, /* availability is limited to B */
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, COMPUTE, 0},
      {WAIT, B, COMPUTE, 0, COMPUTE, LOADS},
      {TOUCH, A, COMPUTE, LOADS}}}, /* visibility is limited to B */
    /* Source stages include earlier ones, but not their accesses. */
    {NULL,
     {{TOUCH, A, VERTEX, LOADS}, {WAIT, A, FRAGMENT, 0, COMPUTE, 0}, {TOUCH, A, COMPUTE, STORES}}},
    {"read after write",
     {{TOUCH, A, EARLY, DEPTH},
      {WAIT, A, LATE, DEPTH, COMPUTE, SAMPLES},
      {TOUCH, A, COMPUTE, SAMPLES}}},
    {NULL,
     {{TOUCH, A, EARLY, DEPTH},
      {WAIT, A, EARLY | LATE, DEPTH, COMPUTE, SAMPLES},
      {TOUCH, A, COMPUTE, SAMPLES}}},
    /* Destination stages include later ones, but not their accesses. */
    {NULL,
     {{TOUCH, A, COMPUTE, LOADS},
      {WAIT, A, COMPUTE, 0, INDIRECT, 0},
      {TOUCH, A, FRAGMENT, STORES}}},
    {"write after read",
     {{TOUCH, A, COMPUTE, LOADS}, {WAIT, A, COMPUTE, 0, FRAGMENT, 0}, {TOUCH, A, VERTEX, STORES}}},
    {"read after write",
     {{TOUCH, A, COMPUTE, STORES},
      {WAIT, A, COMPUTE, STORES, INDIRECT, ARGUMENTS | LOADS},
      {TOUCH, A, COMPUTE, LOADS}}},
    /* A change of layout waits like a write. */
    {"layout change after read",
     {{TOUCH, IMAGE, COMPUTE, LOADS},
      {WAIT, IMAGE, NOTHING, 0, COMPUTE, LOADS, UNDEFINED, GENERAL},
      {TOUCH, IMAGE, COMPUTE, LOADS}}},
    {NULL,
     {{TOUCH, IMAGE, COMPUTE, LOADS},
      {WAIT, IMAGE, COMPUTE, 0, COMPUTE, LOADS, UNDEFINED, GENERAL},
      {TOUCH, IMAGE, COMPUTE, LOADS}}},
    {"layout change after write",
     {{TOUCH, IMAGE, COMPUTE, STORES},
      {WAIT, IMAGE, COMPUTE, 0, COMPUTE, LOADS, UNDEFINED, GENERAL}}},
    {NULL,
     {{TOUCH, IMAGE, COMPUTE, STORES},
      {WAIT, IMAGE, COMPUTE, STORES, COMPUTE, LOADS, UNDEFINED, GENERAL}}},
    {"layout change after read",
     {{TOUCH, IMAGE, COMPUTE, LOADS},
      {WAIT, A, COMPUTE, 0, COMPUTE, 0},
      {WAIT_TOO, IMAGE, NOTHING, 0, COMPUTE, LOADS, UNDEFINED,
       GENERAL}}}, /* a barrier of another resource does not order the change itself */
    /* Accesses wait for a change of layout. */
    {"read after write",
     {{WAIT, IMAGE, NOTHING, 0, COMPUTE, LOADS, UNDEFINED, GENERAL},
      {TOUCH, IMAGE, FRAGMENT, LOADS}}},
    {NULL,
     {{WAIT, IMAGE, NOTHING, 0, COMPUTE, LOADS, UNDEFINED, GENERAL},
      {WAIT, IMAGE, COMPUTE, 0, FRAGMENT, LOADS},
      {TOUCH, IMAGE, FRAGMENT, LOADS}}}, /* the change made its write available */
    /* Images are found in the layout that is named. */
    {NULL, {{TOUCH, IMAGE, COMPUTE, LOADS}}},
    {"wrong layout",
     {{WAIT, IMAGE, NOTHING, 0, COMPUTE, LOADS, GENERAL, READ_ONLY},
      {TOUCH, IMAGE, COMPUTE, LOADS}}},
    {"wrong layout", {{WAIT, IMAGE, NOTHING, 0, COMPUTE, LOADS, READ_ONLY, GENERAL}}},
    /* Mips are apart. */
    {NULL, {{TOUCH, IMAGE, COMPUTE, STORES}, {TOUCH_MIP_1, IMAGE, COMPUTE, STORES}}},
    {"write after write",
     {{TOUCH_MIP_1, IMAGE, COMPUTE, STORES}, {TOUCH_MIP_1, IMAGE, COMPUTE, STORES}}},
    /* Aliases share their bytes. */
    {NULL, {{TOUCH, SMALL, COMPUTE, STORES}, {TOUCH, BESIDE, COMPUTE, STORES}}},
    {"write after read", {{TOUCH, SMALL, COMPUTE, LOADS}, {TOUCH, LARGE, COMPUTE, STORES}}},
    {NULL,
     {{TOUCH, LARGE, COMPUTE, STORES},
      {WAIT, BESIDE, COMPUTE, STORES, COMPUTE, STORES},
      {TOUCH, BESIDE, COMPUTE, STORES}}},
    {"write after write",
     {{TOUCH, LARGE, COMPUTE, STORES},
      {WAIT, SMALL, COMPUTE, STORES, COMPUTE, STORES},
      {TOUCH, SMALL, COMPUTE, STORES},
      {WAIT, LARGE, COMPUTE, 0, COMPUTE, STORES},
      {TOUCH, BESIDE, COMPUTE, STORES}}}, /* the bytes behind SMALL are not made available */
    /* Accesses of one command are not held against each other. */
    {NULL, {{TOUCH, A, COMPUTE, LOADS}, {TOUCH_TOO, A, COMPUTE, STORES}}},
};

static void put_access(struct tape_entry *entry, const struct step *step, uint32_t command)
{
    *entry =
        (struct tape_entry){.access = {.command = command,
                                       .resource = step->resource,
                                       .mips = step->kind == TOUCH_MIP_1 ? 2 : 1,
                                       .stage = step->stage,
                                       .access = step->access,
                                       .writes = step->access & (STORES | DEPTH),
                                       .layout = step->resource == IMAGE ? GENERAL : UNDEFINED}};
}

static void put_barrier(struct tape_entry *entry, const struct step *step, uint32_t call)
{
    *entry = (struct tape_entry){.is_barrier = true,
                                 .barrier = {.call = call,
                                             .resource = step->resource,
                                             .mips = 3,
                                             .src_stage = step->stage,
                                             .src_access = step->access,
                                             .dst_stage = step->to_stage,
                                             .dst_access = step->to_access,
                                             .old_layout = step->from,
                                             .new_layout = step->to}};
}

static void keep_first(void *user, const struct hazard *hazard)
{
    struct hazard *first = user;

    if (!first->kind)
        *first = *hazard;
}

/* What is wrong first with these steps behind a barrier on all memory, if it is `opened`. */
static const char *judge(const struct step *steps, bool opened)
{
    static const struct step opening = {
        WAIT,     TAPE_ALL_MEMORY,
        ANYTHING, VK_ACCESS_2_MEMORY_WRITE_BIT,
        ANYTHING, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    struct tape_resource resources[RESOURCES] = {
        [A] = {.handle = 1, .mips = 1, .memory = 1, .size = 64},
        [B] = {.handle = 2, .mips = 1, .memory = 2, .size = 64},
        [SMALL] = {.handle = 3, .mips = 1, .memory = 3, .size = 64},
        [LARGE] = {.handle = 4, .mips = 1, .memory = 3, .size = 128},
        [BESIDE] = {.handle = 5, .mips = 1, .memory = 3, .offset = 64, .size = 64},
        [IMAGE] =
            {.handle = 6, .image = true, .mips = 2, .memory = 4, .size = 64, .layout = GENERAL},
    };
    struct tape_entry entries[MOST_STEPS + 1];
    struct tape tape = {.resources = resources, .resource_count = RESOURCES, .entries = entries};
    struct hazard first = {0};
    uint32_t command = 0, call = 0;

    if (opened)
        put_barrier(&entries[tape.entry_count++], &opening, ++call);
    for (const struct step *step = steps; step < steps + MOST_STEPS && step->kind; step++)
        if (step->kind >= WAIT)
            put_barrier(&entries[tape.entry_count++], step, call += step->kind == WAIT);
        else
            put_access(&entries[tape.entry_count++], step, command += step->kind != TOUCH_TOO);
    hazard_find(&tape, keep_first, &first);
    return first.kind;
}

TEST(tapes_have_the_hazards_that_the_specification_says)
{
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const char *found = judge(rows[i].steps, true), *kind = rows[i].kind;

        if (!found != !kind || (found && strcmp(found, kind) != 0))
            fail_msg("row %zu: %s", i, found ? found : "no hazard");
    }
}

TEST(what_ran_before_is_available_but_not_visible)
{
    static const struct step read[MOST_STEPS] = {{TOUCH, A, COMPUTE, LOADS}};

    (void)state;
    assert_string_equal(judge(read, false), "read after write");
    assert_null(judge(read, true));
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

TEST(shaders_use_what_their_source_says)
{
    expect_uses(count_comp, sizeof count_comp, SPIRV_READS, SPIRV_READS, SPIRV_WRITES,
                SPIRV_READS | SPIRV_WRITES);
    expect_uses(mask_comp, sizeof mask_comp, SPIRV_READS, SPIRV_WRITES, 0, 0);
    expect_uses(plan_comp, sizeof plan_comp, SPIRV_READS, SPIRV_WRITES, SPIRV_WRITES, 0);
    expect_uses(scene_frag, sizeof scene_frag, SPIRV_READS, SPIRV_READS, 0, 0);
}

RUN_TESTS("hazard", NULL, NULL)
