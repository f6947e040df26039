/* Takes diptych's pipelines into a Vulkan renderer (renderer_vk.c): device, command buffers, vertex
 * buffers and pictures are its own. `host_vk SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]` runs ssvp, or
 * ssvp and rsm side by side in the same command buffers, two frames in flight. Built against an installed
 * diptych by tests/install_test.sh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <diptych_scene.h>
#include <diptych_vk.h>

#include "renderer_vk.h"
#include "rsm.h"
#include "ssvp.h"

enum { MAX_PIPELINES = 2 };

struct pipeline {
    const struct dt_shaders *shaders;
    uint32_t output;
    uint32_t seam, passes; /* a frame is recorded in two parts, up to the seam and from there on */
};

static const struct pipeline pipelines[MAX_PIPELINES] = {
    {&ssvp_vk, SSVP_RESOURCE_DISPLAY, SSVP_PASS_COMPOSITE, SSVP_PASSES},
    {&rsm_vk, RSM_RESOURCE_DISPLAY, RSM_PASS_COMPOSITE, RSM_PASSES}};

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        fprintf(stderr, "diptych: %s\n", message);
}

/* The renderer's device has what diptych needs; a renderer's own needs would be set here, too. */
static void open_renderer(struct renderer *renderer)
{
    VkPhysicalDeviceVulkan13Features vulkan13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features vulkan12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &vulkan13};
    VkPhysicalDeviceVulkan11Features vulkan11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &vulkan12};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                          .pNext = &vulkan11};
    for (int i = 0; i < MAX_PIPELINES; i++)
        dt_vk_need_features(pipelines[i].shaders, &features.features, &vulkan11, &vulkan12,
                            &vulkan13);
    renderer_open(renderer, &features);
}

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
                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    vertices->buffer = indices->buffer = materials->buffer = geometry.handle;
    import->index_count = scene->index_count;
    char *bytes = geometry.bytes;
    memcpy(bytes + vertices->offset, scene->vertices, vertices->size);
    memcpy(bytes + indices->offset, scene->indices, indices->size);
    memcpy(bytes + materials->offset, scene->materials,
           scene->material_count * sizeof *scene->materials);
    return geometry;
}

static struct vk_runtime *open_pipeline(const struct renderer *renderer,
                                        const struct dt_vk_scene *scene,
                                        const struct pipeline *pipeline,
                                        const struct picture *picture)
{
    struct vk_runtime *rt = dt_vk_open(&(struct dt_vk_host){
        .log = {.message = on_log},
        .instance = renderer->instance,
        .physical_device = renderer->physical,
        .device = renderer->device,
        .queue_family = 0,
        .get_instance_proc_addr = vkGetInstanceProcAddr,
        .timing = true,
        .frames = IN_FLIGHT,
    });
    const struct dt_vk_image image = {
        .image = picture->image,
        .format = VK_FORMAT_R8G8B8A8_UNORM,
        .usage = VK_IMAGE_USAGE_STORAGE_BIT,
        .width = renderer->width,
        .height = renderer->height,
        .layers = 1,
        .mips = 1,
        .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
    };
    check(rt && dt_vk_import_scene(rt, scene) && dt_vk_create(rt, pipeline->shaders) &&
              dt_vk_import_image(rt, pipeline->output, &image) &&
              dt_vk_resize(rt, renderer->width, renderer->height),
          "opening a pipeline");
    return rt;
}

/* A frame of every pipeline, the first parts of all before the second ones; each leaves its picture in
 * TRANSFER_SRC_OPTIMAL, ready for the renderer. */
static void run_frame(struct renderer *renderer, struct vk_runtime *const *runtimes, uint32_t count,
                      const struct picture *pictures, const struct dt_frame *frame)
{
    VkCommandBuffer commands = begin_frame(renderer, frame->index);
    double ms[SSVP_PASSES + RSM_PASSES]; /* room for either; begin_frame has waited */
    for (uint32_t i = 0; i < count && frame->index >= IN_FLIGHT; i++)
        check(dt_vk_timings(runtimes[i], IN_FLIGHT - 1, ms), "times");
    for (uint32_t i = 0; i < count; i++)
        check(dt_vk_record_passes(runtimes[i], commands, frame, NULL, 0, pipelines[i].seam),
              "recording a frame");
    for (uint32_t i = 0; i < count; i++)
        check(dt_vk_record_passes(runtimes[i], commands, NULL, NULL, pipelines[i].seam,
                                  pipelines[i].passes),
              "recording the rest of a frame");
    for (uint32_t i = 0; i < count; i++)
        copy_picture(renderer, commands, &pictures[i], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    end_frame(renderer, frame->index);
}

int main(int argc, char **argv)
{
    const struct dt_log log = {.message = on_log};
    check(argc == 6 || argc == 7, "usage: host_vk SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]:");
    struct renderer renderer = {.width = (uint32_t)atoi(argv[2]),
                                .height = (uint32_t)atoi(argv[3])};
    uint32_t frames = (uint32_t)atoi(argv[4]), count = (uint32_t)argc - 5;
    struct picture pictures[MAX_PIPELINES];
    struct vk_runtime *runtimes[MAX_PIPELINES];
    struct dt_vk_scene import = {0};
    struct dt_frame frame;
    struct dt_scene_file *scene = dt_scene_open(argv[1], NULL, &log);
    check(scene, argv[1]);
    dt_scene_frame(scene, renderer.width, renderer.height, &frame);
    open_renderer(&renderer);
    struct buffer geometry = make_scene(&renderer, dt_scene_data(scene), &import);
    for (uint32_t i = 0; i < count; i++) {
        pictures[i] = make_picture(&renderer, VK_IMAGE_USAGE_STORAGE_BIT);
        runtimes[i] = open_pipeline(&renderer, &import, &pipelines[i], &pictures[i]);
    }
    for (frame.index = 0; frame.index < frames; frame.index++)
        run_frame(&renderer, runtimes, count, pictures, &frame);
    wait_for_frames(&renderer);
    for (uint32_t i = 0; i < count; i++) {
        write_picture(&renderer, &pictures[i], argv[5 + i]);
        dt_vk_close(runtimes[i]);
        destroy_picture(&renderer, &pictures[i]);
    }
    destroy_buffer(&renderer, &geometry);
    renderer_close(&renderer);
    dt_scene_close(scene);
    return 0;
}
