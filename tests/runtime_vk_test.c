/* The Vulkan runtime by itself: a panel written by hand as the generator would write it, with
 * one pass of every kind, run under core and synchronization validation. The shaders are
 * tests/runtime_shaders, compiled to headers of words. */
#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <dlfcn.h>
#include <cmocka.h>

#include "runtime_vk/arena.h"
#include "runtime_vk/runtime.h"

#include "count.comp.h"
#include "display.frag.h"
#include "display.vert.h"
#include "layers.frag.h"
#include "layers.vert.h"
#include "mask.comp.h"
#include "plan.comp.h"
#include "scene.frag.h"
#include "scene.vert.h"

/* ---- Errors, logged and injected ------------------------------------------------------------- */

static struct {
    char last[1024], info[1024];
    int errors;
} heard;

static void on_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level == DT_INFO)
        snprintf(heard.info, sizeof heard.info, "%s", message);
    if (level != DT_ERROR)
        return;
    heard.errors++;
    snprintf(heard.last, sizeof heard.last, "%s", message);
    print_message("# %s\n", message);
}

static int fail_allocation; /* the n-th vkAllocateMemory from now on fails; 0: none */

/* Stands before the loader's function of that name. */
VkResult vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo *pAllocateInfo,
                          const VkAllocationCallbacks *pAllocator, VkDeviceMemory *pMemory)
{
    PFN_vkAllocateMemory real;
    *(void **)&real = dlsym(RTLD_NEXT, "vkAllocateMemory");
    if (fail_allocation && --fail_allocation == 0)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return real(device, pAllocateInfo, pAllocator, pMemory);
}

static bool lacks_geometry; /* the device tells that it has no geometry shaders */

void vkGetPhysicalDeviceFeatures2(VkPhysicalDevice physicalDevice,
                                  VkPhysicalDeviceFeatures2 *pFeatures)
{
    PFN_vkGetPhysicalDeviceFeatures2 real;
    *(void **)&real = dlsym(RTLD_NEXT, "vkGetPhysicalDeviceFeatures2");
    real(physicalDevice, pFeatures);
    if (lacks_geometry)
        pFeatures->features.geometryShader = VK_FALSE;
}

/* ---- The panel ------------------------------------------------------------------------------- */

enum { COLOR, DEPTH, LAYERS, MASK, DISPLAY, ROWS, FRAMES, DRAWS, GROUPS, SPARE, RESOURCES };
enum { PLAN_PASS, SCENE_PASS, LAYERS_PASS, COUNT_PASS, MASK_PASS, DISPLAY_PASS, PASSES };

struct live {
    uint32_t mask;
    float scale;
    float padding[2];
};
static const struct live live_defaults = {.mask = 1, .scale = 0.5f};

static uint32_t layers_wide = 16; /* texels; a test makes it too many */

static void frame_size(uint32_t width, uint32_t height, uint32_t extent[3])
{
    extent[0] = width;
    extent[1] = height;
    extent[2] = 1;
}

static void one_per_row(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width;
    extent[0] = height;
    extent[1] = extent[2] = 1;
}

static void eight(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width;
    (void)height;
    extent[0] = 8;
    extent[1] = extent[2] = 1;
}

static const struct dt_resource resources[RESOURCES] = {
    [COLOR] = {.name = "color", .kind = DT_IMAGE, .extent = frame_size},
    [DEPTH] = {.name = "depth", .kind = DT_IMAGE, .extent = frame_size},
    [LAYERS] = {.name = "layers", .kind = DT_IMAGE},
    [MASK] = {.name = "mask", .kind = DT_IMAGE, .extent = frame_size},
    [DISPLAY] = {.name = "display", .kind = DT_IMAGE, .extent = frame_size},
    [ROWS] = {.name = "rows", .kind = DT_BUFFER, .stride = 4, .extent = one_per_row},
    [FRAMES] = {.name = "frames", .kind = DT_BUFFER, .stride = 4, .extent = eight, .history = true},
    [DRAWS] = {.name = "draws", .kind = DT_BUFFER, .stride = 4, .extent = eight},
    [GROUPS] = {.name = "groups", .kind = DT_BUFFER, .stride = 4, .extent = eight},
    [SPARE] = {.name = "spare", .kind = DT_IMAGE},
};

static const struct dt_pass passes[PASSES] = {
    [PLAN_PASS] = {.name = "plan"},     [SCENE_PASS] = {.name = "scene"},
    [LAYERS_PASS] = {.name = "layers"}, [COUNT_PASS] = {.name = "count"},
    [MASK_PASS] = {.name = "mask"},     [DISPLAY_PASS] = {.name = "display"},
};

static const struct dt_pipeline pipeline = {
    .name = "probe",
    .resources = resources,
    .resource_count = RESOURCES,
    .passes = passes,
    .pass_count = PASSES,
    .live_defaults = &live_defaults,
    .live_size = sizeof live_defaults,
    .block_size = sizeof live_defaults,
};

struct state {
    struct vk_image color, depth, layers, mask, display, spare;
    struct vk_buffer rows, frames, draws, groups;
    struct vk_slot color_slot, depth_mask_slot, layers_slot, display_slot, spare_slot;
    struct vk_slot rows_slot, frames_slot, draws_slot, groups_slot;
    VkSampler nearest;
    struct vk_program programs[PASSES];
};

#define CODE(words)                                                                                \
    {                                                                                              \
        words, sizeof(words), NULL                                                                 \
    }
#define UBO     VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
#define SSBO    VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
#define STORAGE VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
#define TEXTURE VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER

static bool display_adds;          /* in the panel that is created next */
static VkPipeline created[PASSES]; /* by the last */

static bool probe_create(void *runtime, void *place)
{
    struct vk_runtime *rt = runtime;
    struct state *state = place;
    static const struct vk_binding_slot plan[] = {{0, UBO}, {1, SSBO}, {2, SSBO}};
    static const struct vk_binding_slot scene[] = {{0, SSBO}, {1, TEXTURE}};
    static const struct vk_binding_slot count[] = {{0, UBO}, {1, STORAGE}, {2, SSBO}, {3, SSBO}};
    static const struct vk_binding_slot mask[] = {{0, UBO}, {1, STORAGE}};
    static const struct vk_binding_slot display[] = {{0, TEXTURE}};
    const struct vk_program_info infos[PASSES] = {
        [PLAN_PASS] = {.name = "plan", .compute = CODE(plan_comp), .slots = plan, .slot_count = 3},
        [SCENE_PASS] = {.name = "scene",
                        .vertex = CODE(scene_vert),
                        .fragment = CODE(scene_frag),
                        .slots = scene,
                        .slot_count = 2,
                        .scene_vertices = true,
                        .color_formats = {vk_format(DT_FORMAT_RGBA32F)},
                        .color_count = 1,
                        .depth_format = vk_format(DT_FORMAT_D32F),
                        .depth_test = true,
                        .depth_write = true,
                        .depth_compare = VK_COMPARE_OP_LESS,
                        .cull = VK_CULL_MODE_BACK_BIT},
        [LAYERS_PASS] = {.name = "layers",
                         .vertex = CODE(layers_vert),
                         .fragment = CODE(layers_frag),
                         .scene_vertices = true,
                         .color_formats = {vk_format(DT_FORMAT_R32UI)},
                         .color_count = 1},
        [COUNT_PASS] = {.name = "count",
                        .compute = CODE(count_comp),
                        .slots = count,
                        .slot_count = 4},
        [MASK_PASS] = {.name = "mask", .compute = CODE(mask_comp), .slots = mask, .slot_count = 2},
        [DISPLAY_PASS] = {.name = "display",
                          .vertex = CODE(display_vert),
                          .fragment = CODE(display_frag),
                          .slots = display,
                          .slot_count = 1,
                          .color_formats = {vk_format(DT_FORMAT_RGBA8)},
                          .color_count = 1,
                          .blend_add = display_adds},
    };
    const struct vk_sampler_info nearest = {
        .name = "nearest", .anisotropy = 1, .wrap = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    for (int pass = 0; pass < PASSES; pass++) {
        if (!dt_vk_program_create(rt, &state->programs[pass], &infos[pass]))
            return false;
        created[pass] = state->programs[pass].pipeline;
    }
    return dt_vk_sampler_create(rt, &state->nearest, &nearest);
}

static void free_resources(struct vk_runtime *rt, struct state *state)
{
    struct vk_image *images[] = {&state->color, &state->depth,   &state->layers,
                                 &state->mask,  &state->display, &state->spare};
    struct vk_buffer *buffers[] = {&state->rows, &state->frames, &state->draws, &state->groups};
    struct vk_slot *slots[] = {&state->color_slot,   &state->depth_mask_slot, &state->layers_slot,
                               &state->display_slot, &state->spare_slot,      &state->rows_slot,
                               &state->frames_slot,  &state->draws_slot,      &state->groups_slot};
    for (size_t i = 0; i < DT_ARRAY_COUNT(images); i++)
        dt_vk_image_destroy(rt, images[i]);
    for (size_t i = 0; i < DT_ARRAY_COUNT(buffers); i++)
        dt_vk_buffer_destroy(rt, buffers[i]);
    for (size_t i = 0; i < DT_ARRAY_COUNT(slots); i++)
        dt_vk_slot_destroy(rt, slots[i]);
}

static void probe_destroy(void *runtime, void *place)
{
    struct vk_runtime *rt = runtime;
    struct state *state = place;
    free_resources(rt, state);
    for (int pass = 0; pass < PASSES; pass++)
        dt_vk_program_destroy(rt, &state->programs[pass]);
    dt_vk_sampler_destroy(rt, &state->nearest);
}

static bool make_images(struct vk_runtime *rt, struct state *state, uint32_t width, uint32_t height)
{
    const struct {
        struct vk_image *image;
        struct vk_slot *slot;
        struct vk_image_info info;
    } images[] = {
        {&state->color,
         &state->color_slot,
         {"color", DT_FORMAT_RGBA32F,
          VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
              VK_IMAGE_USAGE_SAMPLED_BIT,
          width, height, 1, 1, false}},
        {&state->layers,
         &state->layers_slot,
         {"layers", DT_FORMAT_R32UI, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, layers_wide, 8, 4, 1,
          true}},
        {&state->display,
         &state->display_slot,
         {"display", DT_FORMAT_RGBA8, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, width, height, 1, 1,
          false}},
        {&state->spare,
         &state->spare_slot,
         {"spare", DT_FORMAT_RGBA16F, VK_IMAGE_USAGE_SAMPLED_BIT, 13, 7, 2, 3, true}},
    };
    const struct vk_image_info depth = {
        "depth", DT_FORMAT_D32F, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, width, height, 1,
        1,       false};
    const struct vk_image_info mask = {
        "mask", DT_FORMAT_R32F, VK_IMAGE_USAGE_STORAGE_BIT, width, height, 1, 1, false};
    const struct vk_slot_user shared[] = {{.image = &state->depth}, {.image = &state->mask}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(images); i++) {
        struct vk_slot_user user = {.image = images[i].image};
        if (!dt_vk_image_create(rt, images[i].image, &images[i].info) ||
            !dt_vk_slot_bind(rt, images[i].slot, &user, 1) || !dt_vk_initialise(rt, &user, false))
            return false;
    }
    return dt_vk_image_create(rt, &state->depth, &depth) &&
           dt_vk_image_create(rt, &state->mask, &mask) &&
           dt_vk_slot_bind(rt, &state->depth_mask_slot, shared, 2) &&
           dt_vk_initialise(rt, &shared[0], false) && dt_vk_initialise(rt, &shared[1], false);
}

static bool make_buffers(struct vk_runtime *rt, struct state *state, uint32_t height)
{
    const struct {
        struct vk_buffer *buffer;
        struct vk_slot *slot;
        struct vk_buffer_info info;
        bool history;
    } buffers[] = {
        {&state->rows,
         &state->rows_slot,
         {.name = "rows", .size = height * 4, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
         false},
        {&state->frames,
         &state->frames_slot,
         {.name = "frames", .size = 32, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
         true},
        {&state->draws,
         &state->draws_slot,
         {.name = "draws",
          .size = 32,
          .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT},
         false},
        {&state->groups,
         &state->groups_slot,
         {.name = "groups",
          .size = 32,
          .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT},
         false},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(buffers); i++) {
        struct vk_slot_user user = {.buffer = buffers[i].buffer};
        if (!dt_vk_buffer_create(rt, buffers[i].buffer, &buffers[i].info) ||
            !dt_vk_slot_bind(rt, buffers[i].slot, &user, 1) ||
            !dt_vk_initialise(rt, &user, buffers[i].history))
            return false;
    }
    return true;
}

static bool probe_resize(void *runtime, void *place, uint32_t width, uint32_t height)
{
    struct vk_runtime *rt = runtime;
    struct state *state = place;
    const struct vk_builtin *builtin = dt_vk_builtin(rt);
    free_resources(rt, state);
    if (!make_images(rt, state, width, height) || !make_buffers(rt, state, height))
        return false;
    const struct vk_binding plan[] = {{.binding = 0, .type = UBO, .buffer = &builtin->frame},
                                      {.binding = 1, .type = SSBO, .buffer = &state->draws},
                                      {.binding = 2, .type = SSBO, .buffer = &state->groups}};
    const struct vk_binding scene[] = {
        {.binding = 0, .type = SSBO, .buffer = &builtin->materials},
        {.binding = 1,
         .type = TEXTURE,
         .image = &builtin->textures,
         .mip = VK_ALL_MIPS,
         .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
         .sampler = builtin->texture_sampler},
    };
    const struct vk_binding count[] = {
        {.binding = 0, .type = UBO, .buffer = &builtin->frame},
        {.binding = 1, .type = STORAGE, .image = &state->color, .layout = VK_IMAGE_LAYOUT_GENERAL},
        {.binding = 2, .type = SSBO, .buffer = &state->rows},
        {.binding = 3, .type = SSBO, .buffer = &state->frames},
    };
    const struct vk_binding mask[] = {
        {.binding = 0, .type = UBO, .buffer = &builtin->live},
        {.binding = 1, .type = STORAGE, .image = &state->mask, .layout = VK_IMAGE_LAYOUT_GENERAL},
    };
    const struct vk_binding display[] = {
        {.binding = 0,
         .type = TEXTURE,
         .image = &state->color,
         .mip = VK_ALL_MIPS,
         .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
         .sampler = state->nearest},
    };
    return dt_vk_program_bind(rt, &state->programs[PLAN_PASS], plan, 3) &&
           dt_vk_program_bind(rt, &state->programs[SCENE_PASS], scene, 2) &&
           dt_vk_program_bind(rt, &state->programs[COUNT_PASS], count, 4) &&
           dt_vk_program_bind(rt, &state->programs[MASK_PASS], mask, 2) &&
           dt_vk_program_bind(rt, &state->programs[DISPLAY_PASS], display, 1);
}

#define COMPUTE       VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT
#define STORAGE_READ  VK_ACCESS_2_SHADER_STORAGE_READ_BIT
#define STORAGE_WRITE VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT
#define COLOR_OUTPUT  VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT
#define COLOR_WRITE   VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT
#define DEPTH_TESTS                                                                                \
    (VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT)
#define DEPTH_WRITE VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT

static bool record_plan_and_scene(struct vk_runtime *rt, struct state *state)
{
    const struct vk_targets targets = {
        .color = {{.image = &state->color}},
        .color_count = 1,
        .depth = {.image = &state->depth, .clear = {1}},
        .layers = 1,
    };
    if (!dt_vk_pass_begin(rt, PLAN_PASS, true))
        return false;
    dt_vk_dispatch(rt, &state->programs[PLAN_PASS], 1, 1, 1);
    if (!dt_vk_pass_end(rt, PLAN_PASS) || !dt_vk_pass_begin(rt, SCENE_PASS, true))
        return false;
    dt_vk_barriers(rt,
                   (const struct vk_barrier[]){
                       {.image = &state->color,
                        .dst_stage = COLOR_OUTPUT,
                        .dst_access = COLOR_WRITE,
                        .layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        .discard = true},
                       {.image = &state->depth,
                        .dst_stage = DEPTH_TESTS,
                        .dst_access = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | DEPTH_WRITE,
                        .layout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                        .discard = true},
                   },
                   2);
    dt_vk_draw_scene(rt, &state->programs[SCENE_PASS], &targets, 1);
    return dt_vk_pass_end(rt, SCENE_PASS);
}

static bool record_layers_and_count(struct vk_runtime *rt, struct state *state)
{
    const struct vk_targets targets = {
        .color = {{.image = &state->layers}}, .color_count = 1, .layers = 4};
    if (!dt_vk_pass_begin(rt, LAYERS_PASS, true))
        return false;
    dt_vk_barriers(rt,
                   (const struct vk_barrier[]){
                       {.buffer = &state->draws,
                        .src_stage = COMPUTE,
                        .src_access = STORAGE_WRITE,
                        .dst_stage = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                        .dst_access = VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT},
                       {.image = &state->layers,
                        .dst_stage = COLOR_OUTPUT,
                        .dst_access = COLOR_WRITE,
                        .layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        .discard = true},
                   },
                   2);
    dt_vk_draw_scene_indirect(rt, &state->programs[LAYERS_PASS], &targets, NULL, &state->draws, 1);
    if (!dt_vk_pass_end(rt, LAYERS_PASS) || !dt_vk_pass_begin(rt, COUNT_PASS, true))
        return false;
    dt_vk_barriers(rt,
                   (const struct vk_barrier[]){
                       {.image = &state->color,
                        .src_stage = COLOR_OUTPUT,
                        .src_access = COLOR_WRITE,
                        .dst_stage = COMPUTE,
                        .dst_access = STORAGE_READ,
                        .layout = VK_IMAGE_LAYOUT_GENERAL},
                   },
                   1);
    dt_vk_dispatch(rt, &state->programs[COUNT_PASS], 1, 1, 1);
    return dt_vk_pass_end(rt, COUNT_PASS);
}

static bool record_mask_and_display(struct vk_runtime *rt, struct state *state, bool mask)
{
    const struct vk_targets targets = {
        .color = {{.image = &state->display}}, .color_count = 1, .layers = 1};
    if (!dt_vk_pass_begin(rt, MASK_PASS, mask))
        return false;
    dt_vk_barriers(
        rt,
        (const struct vk_barrier[]){
            {.image = &state->mask,
             .src_stage = DEPTH_TESTS,
             .src_access = DEPTH_WRITE,
             .dst_stage = COMPUTE | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
             .dst_access = STORAGE_WRITE | VK_ACCESS_2_TRANSFER_WRITE_BIT,
             .layout = VK_IMAGE_LAYOUT_GENERAL,
             .discard = true},
            {.buffer = &state->groups,
             .src_stage = COMPUTE,
             .src_access = STORAGE_WRITE,
             .dst_stage =
                 VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
             .dst_access = VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT},
        },
        2);
    if (mask) {
        dt_vk_dispatch_indirect(rt, &state->programs[MASK_PASS], &state->groups);
    } else {
        dt_vk_clear_image(rt, &state->mask, 0, (const float[4]){7});
        dt_vk_clear_buffer(rt, &state->groups);
    }
    if (!dt_vk_pass_end(rt, MASK_PASS) || !dt_vk_pass_begin(rt, DISPLAY_PASS, true))
        return false;
    dt_vk_barriers(rt,
                   (const struct vk_barrier[]){
                       {.image = &state->color,
                        .src_stage = COMPUTE,
                        .dst_stage = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                        .dst_access = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                        .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
                       {.image = &state->display,
                        .dst_stage = COLOR_OUTPUT,
                        .dst_access = COLOR_WRITE,
                        .layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        .discard = true},
                   },
                   2);
    dt_vk_draw_fullscreen(rt, &state->programs[DISPLAY_PASS], &targets);
    return dt_vk_pass_end(rt, DISPLAY_PASS);
}

static bool probe_record(void *runtime, void *place, const void *live)
{
    const struct live *block = live;
    return record_plan_and_scene(runtime, place) && record_layers_and_count(runtime, place) &&
           record_mask_and_display(runtime, place, block->mask);
}

static void *probe_resource(void *place, uint32_t index)
{
    struct state *state = place;
    void *all[RESOURCES] = {&state->color,   &state->depth, &state->layers, &state->mask,
                            &state->display, &state->rows,  &state->frames, &state->draws,
                            &state->groups,  &state->spare};
    return all[index];
}

static const struct dt_panel panel = {
    .backend = "vk",
    .pipeline = &pipeline,
    .state_size = sizeof(struct state),
    .create = probe_create,
    .resize = probe_resize,
    .record = probe_record,
    .resource = probe_resource,
    .destroy = probe_destroy,
};

/* ---- The scene ------------------------------------------------------------------------------- */

/* Material 0 on the left half at depth 0.5, material 1 in front of it on the rows of y < 0. */
static const struct dt_vertex vertices[] = {
    {.position = {-1, -1, 0.5f}},
    {.position = {0, -1, 0.5f}},
    {.position = {0, 1, 0.5f}},
    {.position = {-1, 1, 0.5f}},
    {.position = {-1, -1, 0.25f}, .uv = {0, 0}, .material = 1},
    {.position = {1, -1, 0.25f}, .uv = {1, 0}, .material = 1},
    {.position = {1, 0, 0.25f}, .uv = {1, 1}, .material = 1},
    {.position = {-1, 0, 0.25f}, .uv = {0, 1}, .material = 1},
    {.position = {-1, -1, 0.1f}},
    {.position = {1, 1, 0.1f}},
    {.position = {1, -1, 0.1f}},
};
static const uint32_t indices[] = {
    0, 1, 2,  0, 2, 3, 4, 5, 6, 4, 6, 7, /* counterclockwise with y up: seen */
    8, 9, 10,                            /* clockwise: culled */
};
static const struct dt_material materials[] = {
    {.albedo = {0.25f, 0.5f, 0.75f}, .texture = -1},
    {.albedo = {0.5f, 0.5f, 0.5f}, .texture = 1},
};
#define WHITE 255, 255, 255, 255
#define RED   255, 0, 0, 255
static const uint8_t texels[] = {WHITE, WHITE, WHITE, WHITE, RED, RED, RED, RED, WHITE, RED};

static const struct dt_scene scene = {
    .vertices = vertices,
    .vertex_count = DT_ARRAY_COUNT(vertices),
    .indices = indices,
    .index_count = DT_ARRAY_COUNT(indices),
    .materials = materials,
    .material_count = DT_ARRAY_COUNT(materials),
    .texels = texels,
    .texture_width = 2,
    .texture_height = 2,
    .texture_layers = 2,
    .texture_mips = 2,
};

/* ---- Tests ----------------------------------------------------------------------------------- */

static void *open_runtime(bool debug, int poison)
{
    heard.errors = 0;
    return runtime_vk.open(&(struct dt_runtime_options){
        .log = {.message = on_message}, .debug = debug, .timing = true, .poison = poison});
}

static void *open_ready(bool debug, int poison)
{
    void *rt = open_runtime(debug, poison);
    assert_non_null(rt);
    assert_true(runtime_vk.set_scene(rt, &scene));
    assert_true(runtime_vk.create(rt, &panel));
    return rt;
}

static struct dt_bytes read_mip(void *rt, uint32_t resource, uint32_t mip, uint32_t width,
                                uint32_t height, uint32_t depth, size_t size)
{
    struct dt_bytes bytes;
    assert_true(runtime_vk.read(rt, resource, mip, &bytes));
    assert_int_equal(bytes.extent[0], width);
    assert_int_equal(bytes.extent[1], height);
    assert_int_equal(bytes.extent[2], depth);
    assert_int_equal(bytes.size, size);
    return bytes;
}

static struct dt_bytes read_resource(void *rt, uint32_t resource, uint32_t width, uint32_t height,
                                     uint32_t depth, size_t size)
{
    return read_mip(rt, resource, 0, width, height, depth, size);
}

static void check_color(void *rt, uint32_t width, uint32_t height)
{
    static const float back[4] = {0}, one[4] = {0.5f, 0, 0, 1}, zero[4] = {0.25f, 0.5f, 0.75f, 1};
    struct dt_bytes bytes = read_resource(rt, COLOR, width, height, 1, width * height * 16);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            assert_memory_equal(bytes.data + (y * width + x) * 16,
                                y < height / 2  ? one
                                : x < width / 2 ? zero
                                                : back,
                                16);
    free(bytes.data);
}

static void check_depth(void *rt, uint32_t width, uint32_t height)
{
    struct dt_bytes bytes = read_resource(rt, DEPTH, width, height, 1, width * height * 4);
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            float expected = y < height / 2 ? 0.25f : x < width / 2 ? 0.5f : 1;
            assert_memory_equal(bytes.data + (y * width + x) * 4, &expected, 4);
        }
    }
    free(bytes.data);
}

/* Without culling the third, front-most triangle is seen too: it covers the lower right half. */
static void check_layers(void *rt)
{
    struct dt_bytes bytes = read_resource(rt, LAYERS, 16, 8, 4, 16 * 8 * 4 * 4);
    const uint32_t *texel = (const uint32_t *)bytes.data;
    for (uint32_t layer = 0; layer < 4; layer++) {
        for (uint32_t y = 0; y < 8; y++) {
            for (uint32_t x = 0; x < 16; x++, texel++) {
                bool edge = x / 2 == y; /* on the triangle's diagonal */
                bool covered = y < 4 || x < 8 || x / 2 > y;
                if (!edge)
                    assert_int_equal(*texel, covered ? layer + 1 : 0);
            }
        }
    }
    free(bytes.data);
}

static void check_rest(void *rt, uint32_t width, uint32_t height, uint32_t frames,
                       const struct live *live)
{
    struct dt_bytes bytes = read_resource(rt, ROWS, height, 1, 1, height * 4);
    for (uint32_t y = 0; y < height; y++)
        assert_int_equal(((uint32_t *)bytes.data)[y], y < height / 2 ? 1000 * width : width / 2);
    free(bytes.data);
    bytes = read_resource(rt, FRAMES, 8, 1, 1, 32);
    assert_int_equal(((uint32_t *)bytes.data)[0], frames);
    assert_int_equal(((uint32_t *)bytes.data)[7], 0);
    free(bytes.data);
    bytes = read_resource(rt, MASK, width, height, 1, width * height * 4);
    for (uint32_t i = 0; i < width * height; i++)
        assert_float_equal(((float *)bytes.data)[i],
                           live->mask ? live->scale * (float)(i % width) : 7.0f, 0);
    free(bytes.data);
    bytes = read_resource(rt, DISPLAY, width, height, 1, width * height * 4);
    assert_memory_equal(bytes.data, ((uint8_t[]){128, 0, 0, 255}), 4);
    assert_memory_equal(bytes.data + (height - 1) * width * 4, ((uint8_t[]){64, 128, 191, 255}), 4);
    free(bytes.data);
}

static void check_spare(void *rt, int poison)
{
    static const uint32_t sizes[3][2] = {{13, 7}, {6, 3}, {3, 1}};
    for (uint32_t mip = 0; mip < 3; mip++) {
        uint32_t width = sizes[mip][0], height = sizes[mip][1];
        struct dt_bytes bytes =
            read_mip(rt, SPARE, mip, width, height, 2, (size_t)width * height * 2 * 8);
        for (size_t i = 0; i < bytes.size; i++)
            assert_int_equal(bytes.data[i], poison);
        free(bytes.data);
    }
}

static struct dt_frame frame_at(uint32_t index)
{
    return (struct dt_frame){.index = index, .triangle_count = DT_ARRAY_COUNT(indices) / 3};
}

static void frames_have_the_values_that_were_drawn(void **unused)
{
    (void)unused;
    static const uint32_t sizes[][2] = {{16, 8}, {40, 24}, {8, 8}};
    const struct live skip = {.mask = 0}, run = {.mask = 1, .scale = 0.25f};
    void *rt = open_ready(true, 0xab);
    for (size_t i = 0; i < DT_ARRAY_COUNT(sizes); i++) {
        uint32_t width = sizes[i][0], height = sizes[i][1];
        double ms[PASSES];
        assert_true(runtime_vk.resize(rt, width, height));
        struct dt_frame frame = frame_at(0);
        assert_true(runtime_vk.render(rt, &frame, &run, NULL));
        check_color(rt, width, height);
        check_layers(rt);
        check_rest(rt, width, height, 1, &run);
        assert_true(runtime_vk.timings(rt, ms));
        for (int pass = 0; pass < PASSES; pass++)
            assert_true(ms[pass] > 0 && ms[pass] < 10000);
        frame = frame_at(1);
        assert_true(runtime_vk.render(rt, &frame, &skip, NULL));
        check_rest(rt, width, height, 1 + 101, &skip);
        check_spare(rt, 0xab);
        assert_true(runtime_vk.timings(rt, ms));
        assert_true(isnan(ms[MASK_PASS]) && ms[DISPLAY_PASS] > 0);
        print_message("# ms: plan %.3f, scene %.3f, layers %.3f, count %.3f, display %.3f\n", ms[0],
                      ms[1], ms[2], ms[3], ms[5]);
    }
    assert_int_equal(runtime_vk.messages(rt), 0);
    runtime_vk.close(rt);
    assert_int_equal(heard.errors, 0);
}

struct watch {
    void *rt;
    uint32_t passes, stop_after;
};

static bool after_pass(void *user, uint32_t pass)
{
    struct watch *watch = user;
    assert_int_equal(pass, watch->passes++);
    if (pass >= SCENE_PASS)
        check_color(watch->rt, 16, 8);
    if (pass == SCENE_PASS)
        check_depth(watch->rt, 16, 8);
    return pass != watch->stop_after;
}

static void an_observer_sees_every_pass_and_may_stop(void **unused)
{
    (void)unused;
    struct watch watch = {.rt = open_ready(true, 0), .stop_after = UINT32_MAX};
    const struct dt_observer observer = {.after_pass = after_pass, .user = &watch};
    struct dt_frame frame = frame_at(0);
    assert_true(runtime_vk.resize(watch.rt, 16, 8));
    assert_true(runtime_vk.render(watch.rt, &frame, NULL, &observer));
    assert_int_equal(watch.passes, PASSES);
    check_rest(watch.rt, 16, 8, 1, &live_defaults);
    watch.passes = 0;
    watch.stop_after = SCENE_PASS;
    assert_false(runtime_vk.render(watch.rt, &frame, NULL, &observer));
    assert_int_equal(watch.passes, SCENE_PASS + 1);
    check_color(watch.rt, 16, 8);
    assert_int_equal(heard.errors, 0);
    assert_true(runtime_vk.resize(watch.rt, 16, 8));
    assert_true(runtime_vk.render(watch.rt, &frame, NULL, NULL));
    assert_int_equal(runtime_vk.messages(watch.rt), 0);
    runtime_vk.close(watch.rt);
    assert_int_equal(heard.errors, 0);
}

/* Decides about passes before they run, and may paint what the count pass reads. */
struct director {
    void *rt;
    uint32_t passes, stop_at, skips; /* skips: a bit for each pass */
    const struct dt_bytes *color;
};

static enum dt_action before_pass(void *user, uint32_t pass)
{
    struct director *director = user;
    assert_int_equal(pass, director->passes++);
    if (pass == COUNT_PASS && director->color)
        assert_true(runtime_vk.write(director->rt, COLOR, 0, director->color));
    return pass == director->stop_at               ? DT_STOP
           : director->skips >> pass & UINT32_C(1) ? DT_SKIP
                                                   : DT_RUN;
}

/* Material 1 all over, instead of what the scene pass drew: every row counts 1000 for a texel, and
 * the display shows 0.5, 0, 0, 1, at the end of the layouts that the image goes through. */
static void what_is_written_before_a_pass_is_what_it_reads(void **unused)
{
    (void)unused;
    static const float red[4] = {0.5f, 0, 0, 1};
    struct director director = {.rt = open_ready(true, 0), .stop_at = UINT32_MAX};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    struct dt_frame frame = frame_at(0);
    assert_true(runtime_vk.resize(director.rt, 16, 8));
    struct dt_bytes color = read_resource(director.rt, COLOR, 16, 8, 1, 16 * 8 * 16);
    for (uint32_t i = 0; i < 16 * 8; i++)
        memcpy(color.data + i * sizeof red, red, sizeof red);
    director.color = &color;
    assert_true(runtime_vk.render(director.rt, &frame, NULL, &observer));
    assert_int_equal(director.passes, PASSES);
    free(color.data);
    struct dt_bytes bytes = read_resource(director.rt, ROWS, 8, 1, 1, 8 * 4);
    for (uint32_t y = 0; y < 8; y++)
        assert_int_equal(((uint32_t *)bytes.data)[y], 16000);
    free(bytes.data);
    bytes = read_resource(director.rt, DISPLAY, 16, 8, 1, 16 * 8 * 4);
    for (uint32_t i = 0; i < 16 * 8; i++)
        assert_memory_equal(bytes.data + i * 4, ((uint8_t[]){128, 0, 0, 255}), 4);
    free(bytes.data);
    assert_int_equal(runtime_vk.messages(director.rt), 0);
    runtime_vk.close(director.rt);
    assert_int_equal(heard.errors, 0);
}

/* Buffers are as they were; images that the plan discards have no content that one could rely on,
 * but the layout of the plan: the next frame and validation go on as if nothing were amiss. */
static void a_skipped_pass_does_nothing_but_its_barriers(void **unused)
{
    (void)unused;
    static const uint32_t buffers[] = {ROWS, FRAMES, DRAWS, GROUPS};
    const struct live clears = {.mask = 0};
    struct director director = {
        .rt = open_ready(true, 0), .stop_at = UINT32_MAX, .skips = UINT32_MAX};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    struct dt_frame frame = frame_at(0);
    double ms[PASSES];
    assert_true(runtime_vk.resize(director.rt, 16, 8));
    for (size_t i = 0; i < DT_ARRAY_COUNT(buffers); i++) {
        struct dt_bytes bytes = read_resource(director.rt, buffers[i], 8, 1, 1, 32);
        memset(bytes.data, 0x11, bytes.size);
        assert_true(runtime_vk.write(director.rt, buffers[i], 0, &bytes));
        free(bytes.data);
    }
    assert_true(runtime_vk.render(director.rt, &frame, &clears, &observer));
    assert_int_equal(director.passes, PASSES);
    for (size_t i = 0; i < DT_ARRAY_COUNT(buffers); i++) {
        struct dt_bytes bytes = read_resource(director.rt, buffers[i], 8, 1, 1, 32);
        for (size_t k = 0; k < bytes.size; k++)
            assert_int_equal(bytes.data[k], 0x11);
        free(bytes.data);
    }
    assert_true(runtime_vk.timings(director.rt, ms));
    for (int pass = 0; pass < PASSES; pass++)
        assert_true(isnan(ms[pass]));
    assert_true(runtime_vk.write(
        director.rt, FRAMES, 0,
        &(struct dt_bytes){.data = (uint8_t[32]){0}, .size = 32, .extent = {8, 1, 1}}));
    assert_true(runtime_vk.render(director.rt, &frame, NULL, NULL));
    check_color(director.rt, 16, 8);
    check_layers(director.rt);
    check_rest(director.rt, 16, 8, 1, &live_defaults);
    assert_int_equal(runtime_vk.messages(director.rt), 0);
    runtime_vk.close(director.rt);
    assert_int_equal(heard.errors, 0);
}

/* One pass of many: the image that the mask pass, skipped, would have cleared to 7 is not. */
static void a_skipped_pass_does_not_clear(void **unused)
{
    (void)unused;
    const struct live clears = {.mask = 0}, run = {.mask = 1, .scale = 0.25f};
    struct director director = {
        .rt = open_ready(true, 0), .stop_at = UINT32_MAX, .skips = 1u << MASK_PASS};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    struct dt_frame frame = frame_at(0);
    assert_true(runtime_vk.resize(director.rt, 16, 8));
    assert_true(runtime_vk.render(director.rt, &frame, &run, NULL));
    assert_true(runtime_vk.render(director.rt, &frame, &clears, &observer));
    struct dt_bytes mask = read_resource(director.rt, MASK, 16, 8, 1, 16 * 8 * 4);
    assert_true(*(const float *)mask.data != 7.0f);
    free(mask.data);
    assert_true(runtime_vk.render(director.rt, &frame, &clears, NULL));
    check_rest(director.rt, 16, 8, 3, &clears);
    assert_int_equal(runtime_vk.messages(director.rt), 0);
    runtime_vk.close(director.rt);
    assert_int_equal(heard.errors, 0);
}

/* Whoever stops a frame has said why: the runtime adds nothing. */
static void an_observer_may_stop_before_a_pass(void **unused)
{
    (void)unused;
    struct director director = {.rt = open_ready(true, 0), .stop_at = COUNT_PASS};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    struct dt_frame frame = frame_at(0);
    assert_true(runtime_vk.resize(director.rt, 16, 8));
    assert_false(runtime_vk.render(director.rt, &frame, NULL, &observer));
    assert_int_equal(director.passes, COUNT_PASS + 1);
    struct dt_bytes bytes = read_resource(director.rt, FRAMES, 8, 1, 1, 32);
    assert_int_equal(((uint32_t *)bytes.data)[0], 0); /* the count pass did not run */
    free(bytes.data);
    assert_int_equal(heard.errors, 0);
    assert_true(runtime_vk.resize(director.rt, 40, 24));
    assert_true(runtime_vk.render(director.rt, &frame, NULL, NULL));
    check_rest(director.rt, 40, 24, 1, &live_defaults);
    assert_int_equal(runtime_vk.messages(director.rt), 0);
    runtime_vk.close(director.rt);
    assert_int_equal(heard.errors, 0);
}

/* The frame's barriers in the order of recording: 1 color and 2 depth of the scene pass, 3 draws
 * and 4 layers, 5 color of the count pass, 6 mask and 7 groups, 8 color and 9 display. */
static void drop(const struct dt_runtime_options *options, const char *message, const char *hazard)
{
    struct dt_frame frame = frame_at(0);
    heard.errors = 0;
    void *rt = runtime_vk.open(options);
    assert_true(rt && runtime_vk.set_scene(rt, &scene) && runtime_vk.create(rt, &panel) &&
                runtime_vk.resize(rt, 16, 8));
    assert_int_equal(heard.errors, 0);
    assert_true(runtime_vk.render(rt, &frame, NULL, NULL));
    assert_string_equal(heard.info, message);
    assert_true(runtime_vk.messages(rt) > 0);
    assert_non_null(strstr(heard.last, hazard));
    runtime_vk.close(rt);
}

static void a_dropped_barrier_is_named_and_missed(void **unused)
{
    struct dt_runtime_options options = {.log = {.message = on_message}, .debug = true};
    (void)unused;
    options.drop_barrier = 3;
    drop(&options, "dropped barrier 3: pass layers, resource draws, no layout change",
         "SYNC-HAZARD-READ-AFTER-WRITE");
    options.drop_barrier = 5;
    drop(&options, "dropped barrier 5: pass count, resource color, layout change",
         "VUID-VkImageMemoryBarrier2-oldLayout-01197");
    options.drop_barrier = 7;
    drop(&options, "dropped barrier 7: pass mask, resource groups, no layout change",
         "SYNC-HAZARD-READ-AFTER-WRITE");
    options.drop_barrier = 6;
    drop(&options, "dropped barrier 6: pass mask, resource mask, layout change", "ImageLayout");
    options.drop_barrier = 0;
    options.drop_dependency = 8; /* color is read by the pass before */
    drop(&options, "barrier 8 waits for nothing: pass display, resource color",
         "SYNC-HAZARD-WRITE-AFTER-READ");
}

static void a_barrier_that_is_not_there_cannot_be_dropped(void **unused)
{
    (void)unused;
    struct dt_frame frame = frame_at(0);
    heard.errors = 0;
    void *rt = runtime_vk.open(&(struct dt_runtime_options){
        .log = {.message = on_message}, .debug = true, .drop_barrier = 10});
    assert_true(rt && runtime_vk.set_scene(rt, &scene) && runtime_vk.create(rt, &panel) &&
                runtime_vk.resize(rt, 16, 8));
    assert_false(runtime_vk.render(rt, &frame, NULL, NULL));
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.last, "barrier 10: the frame has 9"));
    assert_int_equal(runtime_vk.messages(rt), 0);
    runtime_vk.close(rt);
}

/* Validation must be able to fail, or its silence means nothing: the groups of the mask pass are
 * read as arguments without a barrier after the pass that wrote them. */
static bool forgetful_record(void *runtime, void *place, const void *live)
{
    struct state *state = place;
    (void)live;
    if (!dt_vk_pass_begin(runtime, PLAN_PASS, true))
        return false;
    dt_vk_barriers(runtime,
                   (const struct vk_barrier[]){
                       {.image = &state->mask,
                        .dst_stage = COMPUTE,
                        .dst_access = STORAGE_WRITE,
                        .layout = VK_IMAGE_LAYOUT_GENERAL,
                        .discard = true},
                   },
                   1);
    dt_vk_dispatch(runtime, &state->programs[PLAN_PASS], 1, 1, 1);
    dt_vk_dispatch_indirect(runtime, &state->programs[MASK_PASS], &state->groups);
    return dt_vk_pass_end(runtime, PLAN_PASS);
}

static void a_missing_barrier_is_heard(void **unused)
{
    (void)unused;
    struct dt_panel forgetful = panel;
    struct dt_frame frame = frame_at(0);
    void *rt = open_ready(true, 0);
    forgetful.record = forgetful_record;
    assert_true(runtime_vk.create(rt, &forgetful));
    assert_true(runtime_vk.resize(rt, 16, 8));
    assert_int_equal(runtime_vk.messages(rt), 0);
    runtime_vk.render(rt, &frame, NULL, NULL);
    assert_true(runtime_vk.messages(rt) > 0);
    assert_non_null(strstr(heard.last, "SYNC-HAZARD-READ-AFTER-WRITE"));
    runtime_vk.close(rt);
}

/* An edit takes over what it leaves as it was, and nothing else. */
static void programs_go_on_where_they_are_the_same(void **unused)
{
    (void)unused;
    VkPipeline before[PASSES];
    struct dt_frame frame = frame_at(0);
    void *rt = open_ready(true, 0);
    memcpy(before, created, sizeof before);
    display_adds = true;
    bool good = runtime_vk.create(rt, &panel);
    display_adds = false;
    assert_true(good);
    for (int pass = 0; pass < PASSES; pass++) {
        assert_true((created[pass] == before[pass]) == (pass != DISPLAY_PASS));
        assert_true(pass == DISPLAY_PASS || created[DISPLAY_PASS] != before[pass]);
    }
    assert_true(runtime_vk.resize(rt, 16, 8) && runtime_vk.render(rt, &frame, NULL, NULL));
    check_color(rt, 16, 8);
    check_layers(rt);
    assert_int_equal(runtime_vk.messages(rt), 0);
    runtime_vk.close(rt);
}

static bool endless_record(void *runtime, void *place, const void *live)
{
    struct state *state = place;
    (void)live;
    if (!dt_vk_pass_begin(runtime, PLAN_PASS, true))
        return false;
    dt_vk_dispatch(runtime, &state->programs[PLAN_PASS], UINT32_MAX, 1, 1);
    return dt_vk_pass_end(runtime, PLAN_PASS);
}

static void limits_are_errors_before_the_call(void **unused)
{
    (void)unused;
    struct dt_panel endless = panel;
    struct dt_frame frame = frame_at(0);
    struct dt_bytes bytes;
    void *rt = open_ready(true, 0);
    assert_false(runtime_vk.render(rt, &frame, NULL, NULL));
    assert_non_null(strstr(heard.last, "resize comes first"));
    assert_false(runtime_vk.resize(rt, 1u << 20, 8));
    assert_non_null(strstr(heard.last, "frame of 1048576x8"));
    layers_wide = 1u << 20;
    assert_false(runtime_vk.resize(rt, 16, 8));
    assert_non_null(strstr(heard.last, "image layers: 1048576x8 texels, but the device's limit"));
    layers_wide = 16;
    const VkBufferUsageFlags kinds[] = {VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
    for (int i = 0; i < 2; i++) { /* of a uniform block, what shaders declare counts */
        struct vk_buffer wide = {0};
        const struct vk_buffer_info info = {.name = "wide",
                                            .size = i ? 16 : 1ull << 50,
                                            .block = i ? 1ull << 50 : 0,
                                            .usage = kinds[i]};
        assert_false(dt_vk_buffer_create(rt, &wide, &info));
        assert_non_null(
            strstr(heard.last, "buffer wide: 1125899906842624 bytes, but the device binds"));
    }
    endless.record = endless_record;
    assert_true(runtime_vk.create(rt, &endless));
    assert_true(runtime_vk.resize(rt, 16, 8));
    assert_false(runtime_vk.read(rt, SPARE, 3, &bytes));
    assert_non_null(strstr(heard.last, "read spare: mip 3, and it has 3"));
    assert_false(runtime_vk.render(rt, &frame, NULL, NULL));
    assert_non_null(strstr(heard.last, "pass plan: 4294967295 x 1 x 1 workgroups"));
    assert_int_equal(heard.errors, 7);
    assert_int_equal(runtime_vk.messages(rt), 0);
    runtime_vk.close(rt);
    assert_int_equal(heard.errors, 7);
}

static void an_unknown_device_is_named_and_the_known_are_listed(void **unused)
{
    (void)unused;
    struct dt_runtime_options options = {.log = {.message = on_message}, .device = "voodoo"};
    heard.errors = 0;
    assert_null(runtime_vk.open(&options));
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.last, "--device voodoo: no such Vulkan device"));
    assert_non_null(strstr(heard.last, "0: "));
    options.device = "99";
    assert_null(runtime_vk.open(&options));
    options.device = "0";
    void *rt = runtime_vk.open(&options);
    assert_non_null(rt);
    char name[256];
    snprintf(name, sizeof name, "%s", runtime_vk.device_name(rt));
    runtime_vk.close(rt);
    options.device = name;
    rt = runtime_vk.open(&options);
    assert_non_null(rt);
    assert_string_equal(runtime_vk.device_name(rt), name);
    runtime_vk.close(rt);
    assert_int_equal(heard.errors, 2);
}

/* A device is refused only by a pipeline with a pass that needs what it lacks. */
static void a_feature_is_asked_for_by_the_pass_that_needs_it(void **unused)
{
    (void)unused;
    static const struct dt_need needs[] = {{SCENE_PASS, "fullDrawIndexUint32"},
                                           {MASK_PASS, "geometryShader"}};
    struct dt_panel needy = panel;
    needy.needs = needs;
    needy.need_count = DT_ARRAY_COUNT(needs);
    void *rt = open_ready(true, 0);
    assert_true(runtime_vk.create(rt, &needy));
    runtime_vk.close(rt);
    lacks_geometry = true;
    rt = open_ready(true, 0);
    assert_int_equal(heard.errors, 0);
    assert_false(runtime_vk.create(rt, &needy));
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.last, "pass mask: needs geometryShader, which "));
    assert_non_null(strstr(heard.last, "; use another --device"));
    assert_true(runtime_vk.create(rt, &panel));
    runtime_vk.close(rt);
    lacks_geometry = false;
    assert_int_equal(heard.errors, 1);
}

/* Fails the first, second, ... allocation until everything works: one error each time, and
 * nothing is left behind, which the validation layers would tell when the device is destroyed. */
static void out_of_memory_is_one_error_and_a_clean_end(void **unused)
{
    (void)unused;
    bool done = false;
    int attempts = 0;
    while (!done) {
        heard.errors = 0;
        fail_allocation = ++attempts;
        struct dt_frame frame = frame_at(0);
        struct dt_bytes bytes = {0};
        void *rt = open_runtime(true, 1);
        done = rt && runtime_vk.set_scene(rt, &scene) && runtime_vk.create(rt, &panel) &&
               runtime_vk.resize(rt, 16, 8) && runtime_vk.render(rt, &frame, NULL, NULL) &&
               runtime_vk.read(rt, COLOR, 0, &bytes);
        free(bytes.data);
        runtime_vk.close(rt);
        assert_int_equal(heard.errors, done ? 0 : 1);
        if (!done)
            assert_non_null(strstr(heard.last, ": VK_ERROR_OUT_OF_DEVICE_MEMORY: use "));
    }
    assert_true(attempts > 10);
    fail_allocation = 0;
}

/* ---- Memory of recorded commands -------------------------------------------------------------- */

enum { BLOCKS = 300, MAX_CHUNKS = 64 };

static void *take(const VkAllocationCallbacks *memory, size_t size, size_t alignment)
{
    void *block = memory->pfnAllocation(memory->pUserData, size, alignment,
                                        VK_SYSTEM_ALLOCATION_SCOPE_OBJECT);
    assert_non_null(block);
    assert_int_equal((uintptr_t)block % alignment, 0);
    return block;
}

/* Sizes from 1 to 389 bytes and alignments from 1 to 64, each filled with a byte of its own. */
static void record_blocks(const VkAllocationCallbacks *memory, uint8_t *blocks[BLOCKS], size_t turn)
{
    for (size_t i = 0; i < BLOCKS; i++) {
        size_t size = 1 + (i * 97 + turn) % 389;
        blocks[i] = take(memory, size, (size_t)1 << i % 7);
        memset(blocks[i], (int)i, size);
    }
    for (size_t i = 0; i < BLOCKS; i++) {
        size_t size = 1 + (i * 97 + turn) % 389;
        assert_int_equal(blocks[i][0], (uint8_t)i);
        assert_int_equal(blocks[i][size - 1], (uint8_t)i);
    }
}

static void reset_blocks(const VkAllocationCallbacks *memory, uint8_t *blocks[BLOCKS])
{
    for (size_t i = 0; i < BLOCKS; i++)
        memory->pfnFree(memory->pUserData, blocks[i]);
}

/* Two command buffers, one of which is reset in every turn: their blocks come to lie where others of
 * them lay, though one block is never given back. Counts stretches of 64 KiB. */
static void commands_are_kept_where_others_were(void **state)
{
    struct vk_arena arena = {0};
    VkAllocationCallbacks memory = vk_arena_callbacks(&arena);
    uint8_t *buffers[2][BLOCKS], *pool = take(&memory, 200, 8);
    uintptr_t chunks[MAX_CHUNKS];
    size_t chunk_count = 0;
    (void)state;
    for (size_t turn = 0; turn < 100; turn++) {
        if (turn >= 2)
            reset_blocks(&memory, buffers[turn % 2]);
        record_blocks(&memory, buffers[turn % 2], turn);
        for (size_t i = 0; i < BLOCKS; i++) {
            uintptr_t chunk = (uintptr_t)buffers[turn % 2][i] / 65536;
            size_t known = 0;
            while (known < chunk_count && chunks[known] != chunk)
                known++;
            if (known == chunk_count && chunk_count < MAX_CHUNKS)
                chunks[chunk_count++] = chunk;
        }
    }
    assert_in_range(chunk_count, 1, 6);
    reset_blocks(&memory, buffers[0]);
    reset_blocks(&memory, buffers[1]);
    memory.pfnFree(memory.pUserData, pool);
    vk_arena_free(&arena);
}

static void a_block_keeps_its_content_when_it_grows(void **state)
{
    struct vk_arena arena = {0};
    VkAllocationCallbacks memory = vk_arena_callbacks(&arena);
    uint8_t *block = NULL;
    (void)state;
    for (size_t size = 1; size < 1000000; size *= 3) {
        block = memory.pfnReallocation(memory.pUserData, block, size, 16,
                                       VK_SYSTEM_ALLOCATION_SCOPE_OBJECT);
        assert_non_null(block);
        for (size_t i = 0; i < size / 3; i++)
            assert_int_equal(block[i], (uint8_t)i);
        for (size_t i = 0; i < size; i++)
            block[i] = (uint8_t)i;
    }
    assert_null(memory.pfnReallocation(memory.pUserData, block, SIZE_MAX - 64, 16,
                                       VK_SYSTEM_ALLOCATION_SCOPE_OBJECT));
    assert_int_equal(block[100], 100);
    assert_null(
        memory.pfnReallocation(memory.pUserData, block, 0, 16, VK_SYSTEM_ALLOCATION_SCOPE_OBJECT));
    memory.pfnFree(memory.pUserData, NULL);
    vk_arena_free(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_have_the_values_that_were_drawn),
        cmocka_unit_test(an_observer_sees_every_pass_and_may_stop),
        cmocka_unit_test(what_is_written_before_a_pass_is_what_it_reads),
        cmocka_unit_test(a_skipped_pass_does_nothing_but_its_barriers),
        cmocka_unit_test(a_skipped_pass_does_not_clear),
        cmocka_unit_test(an_observer_may_stop_before_a_pass),
        cmocka_unit_test(a_dropped_barrier_is_named_and_missed),
        cmocka_unit_test(a_barrier_that_is_not_there_cannot_be_dropped),
        cmocka_unit_test(a_missing_barrier_is_heard),
        cmocka_unit_test(programs_go_on_where_they_are_the_same),
        cmocka_unit_test(limits_are_errors_before_the_call),
        cmocka_unit_test(an_unknown_device_is_named_and_the_known_are_listed),
        cmocka_unit_test(a_feature_is_asked_for_by_the_pass_that_needs_it),
        cmocka_unit_test(out_of_memory_is_one_error_and_a_clean_end),
        cmocka_unit_test(commands_are_kept_where_others_were),
        cmocka_unit_test(a_block_keeps_its_content_when_it_grows),
    };
    return cmocka_run_group_tests_name("runtime_vk", tests, NULL, NULL);
}
