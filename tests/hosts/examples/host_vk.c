/* Takes diptych's pipelines into a Vulkan renderer (renderer_vk.c): device, memory, cache, threads, command
 * buffers, vertex buffers and pictures are its own. `host_vk SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm
 * [SSVP.ppm]]` runs ssvp, ssvp and rsm, or these and a second view of ssvp; each on a thread that opens
 * it, records it and closes it, two frames in flight. Built against an installed diptych by
 * tests/hosts/install_test.sh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <diptych_scene.h>
#include <diptych_vk.h>

#include "renderer_vk.h"
#include "rsm.h"
#include "ssvp.h"

enum { COPY = 128 }; /* where the renderer's copy of the exposure is, in bytes */

struct pipeline {
    const struct dt_shaders *shaders;
    uint32_t output, exposure;
    uint32_t seam, passes; /* a frame is recorded in two parts, up to the seam and from there on */
};

static const struct pipeline pipelines[LANES] = {
    {&ssvp_vk, SSVP_RESOURCE_DISPLAY, SSVP_RESOURCE_LUMINANCE_SCALE, SSVP_PASS_TONEMAP,
     SSVP_PASSES},
    {&rsm_vk, RSM_RESOURCE_DISPLAY, RSM_RESOURCE_LUMINANCE_SCALE, RSM_PASS_TONEMAP, RSM_PASSES},
    {&ssvp_vk, SSVP_RESOURCE_DISPLAY, SSVP_RESOURCE_LUMINANCE_SCALE, SSVP_PASS_TONEMAP,
     SSVP_PASSES}};

/* A pipeline in the renderer, on a lane of its own. */
struct view {
    struct dt_vk_runtime *rt;
    struct picture picture;
    struct buffer exposure; /* a float, which the pipeline writes; behind it the renderer's copy */
};

/* What its threads share. */
struct host {
    struct renderer renderer;
    struct dt_vk_scene scene;
    struct dt_frame frame;
    struct view views[LANES];
    char **paths; /* of their pictures */
};

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        fprintf(stderr, "diptych: %s\n", message);
}

static bool suits(VkInstance instance, VkPhysicalDevice physical)
{
    const struct dt_vk_host host = {.log = {.message = on_log},
                                    .instance = instance,
                                    .physical_device = physical,
                                    .get_instance_proc_addr = vkGetInstanceProcAddr};
    bool all = true;
    for (int i = 0; i < LANES; i++)
        all = all && dt_vk_suits(&host, pipelines[i].shaders);
    return all;
}

/* ---- What the renderer gives ----------------------------------------------------------------- */

static VkResult allocate(void *user, const VkMemoryRequirements *needs, const char *name,
                         struct dt_vk_memory *out)
{
    (void)name;
    *out = (struct dt_vk_memory){
        .memory = renderer_allocate(user, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    return VK_SUCCESS;
}

static void release(void *user, const struct dt_vk_memory *memory)
{
    const struct renderer *renderer = user;
    vkFreeMemory(renderer->device, memory->memory, NULL);
}

static struct dt_vk_runtime *open_runtime(struct host *host)
{
    struct renderer *renderer = &host->renderer;
    return dt_vk_open(&(struct dt_vk_host){
        .log = {.message = on_log},
        .instance = renderer->instance,
        .physical_device = renderer->physical,
        .device = renderer->device,
        .queue_family = 0,
        .get_instance_proc_addr = vkGetInstanceProcAddr,
        .device_info = &renderer->device_info,
        .callbacks = &renderer->callbacks,
        .allocator = {renderer, allocate, release},
        .pipeline_cache = renderer->cache,
        .threads = {renderer, renderer_run},
        .timing = true,
        .frames = IN_FLIGHT,
    });
}

/* ---- The scene ------------------------------------------------------------------------------- */

/* The next place in the buffer, at a multiple of what any device wants. */
static struct dt_vk_range place(const struct dt_vk_range *before, VkDeviceSize size)
{
    VkDeviceSize end = before->offset + before->size;
    return (struct dt_vk_range){.offset = (end + 255) / 256 * 256, .size = size};
}

static struct buffer make_scene(const struct renderer *renderer, const struct dt_scene *scene,
                                struct dt_vk_scene *import)
{
    const struct dt_vk_range nothing = {0}; /* indices first: lavapipe wants their offset 0 */
    struct dt_vk_range *vertices = &import->vertices, *indices = &import->indices;
    struct dt_vk_range *materials = &import->materials;
    *indices = place(&nothing, scene->index_count * sizeof *scene->indices);
    *vertices = place(indices, scene->vertex_count * sizeof *scene->vertices);
    *materials = place(vertices, DT_MAX_MATERIALS * sizeof *scene->materials);
    struct buffer geometry =
        make_buffer(renderer, materials->offset + materials->size,
                    VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                        VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    vertices->buffer = indices->buffer = materials->buffer = geometry.handle;
    import->index_count = scene->index_count;
    import->numbered = true; /* as all that diptych_scene.h loads */
    char *bytes = geometry.bytes;
    memcpy(bytes + vertices->offset, scene->vertices, vertices->size);
    memcpy(bytes + indices->offset, scene->indices, indices->size);
    memcpy(bytes + materials->offset, scene->materials,
           scene->material_count * sizeof *scene->materials);
    return geometry;
}

/* ---- Views ----------------------------------------------------------------------------------- */

static void open_view(void *data, uint32_t lane)
{
    struct host *host = data;
    const struct pipeline *pipeline = &pipelines[lane];
    const struct renderer *renderer = &host->renderer;
    struct view *view = &host->views[lane];
    *view = (struct view){
        open_runtime(host),
        make_picture(renderer, VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_STORAGE_BIT),
        make_buffer(renderer, 256,
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                        VK_BUFFER_USAGE_TRANSFER_DST_BIT)};
    const struct dt_vk_range exposure = {.buffer = view->exposure.handle, .size = COPY};
    const struct dt_vk_image image = {
        .image = view->picture.image,
        .format = VK_FORMAT_R8G8B8A8_UNORM,
        .usage = VK_IMAGE_USAGE_STORAGE_BIT,
        .width = renderer->width,
        .height = renderer->height,
        .layers = 1,
        .mips = 1,
        .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
    };
    check(view->rt && dt_vk_import_scene(view->rt, &host->scene) &&
              dt_vk_create(view->rt, pipeline->shaders) &&
              dt_vk_import_image(view->rt, pipeline->output, &image) &&
              dt_vk_import_buffer(view->rt, pipeline->exposure, &exposure) &&
              dt_vk_resize(view->rt, renderer->width, renderer->height),
          "opening a pipeline");
}

/* Takes the exposure, which the pass before wrote, and gives it to the pass after. Both commands rely
 * on the pipeline's barriers; the one in between is for the renderer's own copy. */
static void take_exposure(VkCommandBuffer commands, VkBuffer exposure)
{
    const VkBufferCopy out = {.dstOffset = COPY, .size = sizeof(float)};
    const VkBufferCopy back = {.srcOffset = COPY, .size = sizeof(float)};
    const VkMemoryBarrier2 copied = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                     .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                     .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                     .dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                     .dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT};
    const VkDependencyInfo info = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                   .memoryBarrierCount = 1,
                                   .pMemoryBarriers = &copied};
    vkCmdCopyBuffer(commands, exposure, exposure, 1, &out);
    vkCmdPipelineBarrier2(commands, &info);
    vkCmdCopyBuffer(commands, exposure, exposure, 1, &back);
}

/* The frame leaves its picture in TRANSFER_SRC_OPTIMAL, ready for the renderer. */
static void record_view(void *data, uint32_t lane)
{
    struct host *host = data;
    const struct pipeline *pipeline = &pipelines[lane];
    const struct view *view = &host->views[lane];
    const struct dt_frame *frame = &host->frame;
    double ms[SSVP_PASSES + RSM_PASSES]; /* room for either; begin_frame has waited */
    VkCommandBuffer commands = begin_commands(&host->renderer, frame->index, lane);
    check(frame->index < IN_FLIGHT || dt_vk_timings(view->rt, IN_FLIGHT - 1, ms), "times");
    check(dt_vk_record_passes(view->rt, commands, frame, NULL, 0, pipeline->seam),
          "recording a frame");
    take_exposure(commands, view->exposure.handle);
    check(dt_vk_record_passes(view->rt, commands, NULL, NULL, pipeline->seam, pipeline->passes),
          "recording the rest of a frame");
    copy_picture(&host->renderer, commands, &view->picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
}

static void close_view(void *data, uint32_t lane)
{
    struct host *host = data;
    struct view *view = &host->views[lane];
    write_picture(&host->renderer, &view->picture, host->paths[lane]);
    const float *exposure = view->exposure.bytes;
    check(exposure[0] > 0 && exposure[COPY / sizeof *exposure] == exposure[0],
          "taking the exposure");
    dt_vk_close(view->rt);
    destroy_picture(&host->renderer, &view->picture);
    destroy_buffer(&host->renderer, &view->exposure);
}

static void run(struct host *host, const char *scene_path, uint32_t frames, uint32_t count)
{
    const struct dt_log log = {.message = on_log};
    struct renderer *renderer = &host->renderer;
    struct dt_scene_file *scene = dt_scene_open(scene_path, NULL, &log);
    check(scene, scene_path);
    dt_scene_frame(scene, renderer->width, renderer->height, &host->frame);
    renderer_open(renderer, suits);
    struct buffer geometry = make_scene(renderer, dt_scene_data(scene), &host->scene);
    renderer_run(renderer, count, open_view, host);
    for (host->frame.index = 0; host->frame.index < frames; host->frame.index++) {
        begin_frame(renderer, host->frame.index);
        renderer_run(renderer, count, record_view, host);
        end_frame(renderer, host->frame.index, count);
    }
    wait_for_frames(renderer);
    renderer_run(renderer, count, close_view, host);
    destroy_buffer(renderer, &geometry);
    renderer_close(renderer);
    dt_scene_close(scene);
}

/* The renderer's device has what diptych needs; a renderer's own needs would be set here, too. */
int main(int argc, char **argv)
{
    static struct host host;
    struct renderer *renderer = &host.renderer;
    renderer_prepare(renderer);
    for (int i = 0; i < LANES; i++)
        dt_vk_need_features(pipelines[i].shaders, &renderer->core, &renderer->vulkan11,
                            &renderer->vulkan12, &renderer->vulkan13);
    check(argc >= 6 && argc <= 8,
          "usage: host_vk SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm [SSVP.ppm]]:");
    renderer->width = (uint32_t)atoi(argv[2]);
    renderer->height = (uint32_t)atoi(argv[3]);
    host.paths = argv + 5;
    run(&host, argv[1], (uint32_t)atoi(argv[4]), (uint32_t)argc - 5);
    return 0;
}
