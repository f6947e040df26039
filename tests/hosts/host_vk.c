/* A small Vulkan renderer that takes diptych's pipelines in: device, queue, command buffers, vertex
 * buffers and pictures are its own. `host_vk SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]` runs ssvp, or
 * ssvp and rsm side by side in the same command buffers, two frames in flight. Built against an installed
 * diptych by tests/install_test.sh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <diptych_scene.h>
#include <diptych_vk.h>

#include "rsm.h"
#include "ssvp.h"

enum { IN_FLIGHT = 2, MAX_PIPELINES = 2 };

#define CHECK(call) check((call) == VK_SUCCESS, #call)
static void check(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "host: %s failed\n", what);
    exit(1);
}

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level >= DT_WARNING)
        fprintf(stderr, "diptych: %s\n", message);
}

/* ---- The renderer ---------------------------------------------------------------------------- */

struct buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    void *bytes;
};

/* What one pipeline draws into, and where its pixels arrive. */
struct picture {
    VkImage image;
    VkDeviceMemory memory;
    struct buffer pixels;
};

struct host {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands[IN_FLIGHT];
    VkFence fences[IN_FLIGHT];
    struct buffer geometry; /* all of the scene, side by side */
    struct dt_vk_scene scene;
    uint32_t width, height, pipeline_count;
    struct picture pictures[MAX_PIPELINES];
    struct vk_runtime *runtimes[MAX_PIPELINES];
};

static void open_instance(struct host *host)
{
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application};
    CHECK(vkCreateInstance(&info, NULL, &host->instance));
}

static void open_device(struct host *host)
{
    VkPhysicalDeviceVulkan13Features vulkan13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features vulkan12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &vulkan13};
    VkPhysicalDeviceVulkan11Features vulkan11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &vulkan12};
    VkPhysicalDeviceFeatures core = {0};
    uint32_t count = 1;
    VkResult result = vkEnumeratePhysicalDevices(host->instance, &count, &host->physical);
    check(result >= 0 && count == 1, "vkEnumeratePhysicalDevices");
    dt_vk_need_features(&core, &vulkan11, &vulkan12, &vulkan13);
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueCount = 1,
                                           .pQueuePriorities = &(float){1}};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = &vulkan11,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .pEnabledFeatures = &core};
    CHECK(vkCreateDevice(host->physical, &info, NULL, &host->device));
    vkGetDeviceQueue(host->device, 0, 0, &host->queue);
}

static void make_commands(struct host *host)
{
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    CHECK(vkCreateCommandPool(host->device, &pool, NULL, &host->pool));
    const VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = host->pool,
        .commandBufferCount = IN_FLIGHT};
    CHECK(vkAllocateCommandBuffers(host->device, &commands, host->commands));
    for (int i = 0; i < IN_FLIGHT; i++)
        CHECK(vkCreateFence(host->device, &fence, NULL, &host->fences[i]));
}

static VkDeviceMemory allocate(const struct host *host, const VkMemoryRequirements *needs,
                               VkMemoryPropertyFlags wanted)
{
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceMemory handle = VK_NULL_HANDLE;
    uint32_t type = 0;
    vkGetPhysicalDeviceMemoryProperties(host->physical, &memory);
    while (type < memory.memoryTypeCount &&
           (!(needs->memoryTypeBits >> type & 1) ||
            (memory.memoryTypes[type].propertyFlags & wanted) != wanted))
        type++;
    CHECK(vkAllocateMemory(host->device,
                           &(VkMemoryAllocateInfo){.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                   .allocationSize = needs->size,
                                                   .memoryTypeIndex = type},
                           NULL, &handle));
    return handle;
}

static struct buffer make_buffer(const struct host *host, VkDeviceSize size,
                                 VkBufferUsageFlags usage)
{
    struct buffer buffer;
    VkMemoryRequirements needs;
    CHECK(vkCreateBuffer(host->device,
                         &(VkBufferCreateInfo){.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                               .size = size,
                                               .usage = usage},
                         NULL, &buffer.handle));
    vkGetBufferMemoryRequirements(host->device, buffer.handle, &needs);
    buffer.memory = allocate(
        host, &needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    CHECK(vkBindBufferMemory(host->device, buffer.handle, buffer.memory, 0));
    CHECK(vkMapMemory(host->device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.bytes));
    return buffer;
}

static void make_picture(const struct host *host, struct picture *picture)
{
    VkMemoryRequirements needs;
    CHECK(vkCreateImage(host->device,
                        &(VkImageCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                             .imageType = VK_IMAGE_TYPE_2D,
                                             .format = VK_FORMAT_R8G8B8A8_UNORM,
                                             .extent = {host->width, host->height, 1},
                                             .mipLevels = 1,
                                             .arrayLayers = 1,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .usage = VK_IMAGE_USAGE_STORAGE_BIT |
                                                      VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                      VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                        NULL, &picture->image));
    vkGetImageMemoryRequirements(host->device, picture->image, &needs);
    picture->memory = allocate(host, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    CHECK(vkBindImageMemory(host->device, picture->image, picture->memory, 0));
    picture->pixels = make_buffer(host, (VkDeviceSize)host->width * host->height * 4,
                                  VK_BUFFER_USAGE_TRANSFER_DST_BIT);
}

/* ---- Diptych in it --------------------------------------------------------------------------- */

/* The next place in the buffer, at a multiple of what any device wants. */
static struct dt_vk_range place(const struct dt_vk_range *before, VkDeviceSize size)
{
    VkDeviceSize end = before->offset + before->size;
    return (struct dt_vk_range){.offset = (end + 255) / 256 * 256, .size = size};
}

static void make_scene(struct host *host, const struct dt_scene *scene)
{
    const struct dt_vk_range own = {.size = 1}; /* something of the host's comes first */
    struct dt_vk_range *vertices = &host->scene.vertices, *indices = &host->scene.indices;
    struct dt_vk_range *materials = &host->scene.materials;
    *vertices = place(&own, scene->vertex_count * sizeof *scene->vertices);
    *indices = place(vertices, scene->index_count * sizeof *scene->indices);
    *materials = place(indices, DT_MAX_MATERIALS * sizeof *scene->materials);
    host->geometry =
        make_buffer(host, materials->offset + materials->size,
                    VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    vertices->buffer = indices->buffer = materials->buffer = host->geometry.handle;
    host->scene.index_count = scene->index_count;
    char *bytes = host->geometry.bytes;
    memcpy(bytes + vertices->offset, scene->vertices, vertices->size);
    memcpy(bytes + indices->offset, scene->indices, indices->size);
    memcpy(bytes + materials->offset, scene->materials,
           scene->material_count * sizeof *scene->materials);
}

static struct vk_runtime *open_pipeline(const struct host *host, const struct dt_panel *panel,
                                        uint32_t output, const struct picture *picture)
{
    struct vk_runtime *rt = dt_vk_open(&(struct dt_vk_host){
        .log = {.message = on_log},
        .instance = host->instance,
        .physical_device = host->physical,
        .device = host->device,
        .queue_family = 0,
        .get_instance_proc_addr = vkGetInstanceProcAddr,
    });
    const struct dt_vk_image image = {
        .image = picture->image,
        .format = VK_FORMAT_R8G8B8A8_UNORM,
        .usage = VK_IMAGE_USAGE_STORAGE_BIT,
        .width = host->width,
        .height = host->height,
        .layers = 1,
        .mips = 1,
        .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
    };
    check(rt && dt_vk_import_scene(rt, &host->scene) && dt_vk_create(rt, panel) &&
              dt_vk_import_image(rt, output, &image) && dt_vk_resize(rt, host->width, host->height),
          "opening a pipeline");
    return rt;
}

/* The host's own work around the pipelines: it copies each picture, already in TRANSFER_SRC_OPTIMAL. */
static void draw_frame(struct host *host, VkCommandBuffer commands, const struct dt_frame *frame)
{
    const VkBufferImageCopy region = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {host->width, host->height, 1},
    };
    CHECK(vkBeginCommandBuffer(
        commands,
        &(VkCommandBufferBeginInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO}));
    for (uint32_t i = 0; i < host->pipeline_count; i++)
        check(dt_vk_record(host->runtimes[i], commands, frame, NULL), "recording a frame");
    for (uint32_t i = 0; i < host->pipeline_count; i++)
        vkCmdCopyImageToBuffer(commands, host->pictures[i].image,
                               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               host->pictures[i].pixels.handle, 1, &region);
    CHECK(vkEndCommandBuffer(commands));
}

static void run_frames(struct host *host, struct dt_frame *frame, uint32_t frames)
{
    for (frame->index = 0; frame->index < frames; frame->index++) {
        VkFence *fence = &host->fences[frame->index % IN_FLIGHT];
        VkCommandBuffer commands = host->commands[frame->index % IN_FLIGHT];
        CHECK(vkWaitForFences(host->device, 1, fence, VK_TRUE, UINT64_MAX));
        CHECK(vkResetFences(host->device, 1, fence));
        draw_frame(host, commands, frame);
        CHECK(vkQueueSubmit(host->queue, 1,
                            &(VkSubmitInfo){.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                            .commandBufferCount = 1,
                                            .pCommandBuffers = &commands},
                            *fence));
    }
    CHECK(vkDeviceWaitIdle(host->device));
}

/* Row 0 in memory is the bottom of the picture. */
static void write_picture(const struct host *host, const struct picture *picture, const char *path)
{
    FILE *file = fopen(path, "wb");
    check(file, path);
    fprintf(file, "P6\n%u %u\n255\n", host->width, host->height);
    for (uint32_t y = host->height; y-- > 0;)
        for (uint32_t x = 0; x < host->width; x++)
            fwrite((const char *)picture->pixels.bytes + ((size_t)y * host->width + x) * 4, 1, 3,
                   file);
    check(fclose(file) == 0, path);
}

static void close_host(struct host *host)
{
    struct buffer buffers[1 + MAX_PIPELINES] = {host->geometry};
    for (uint32_t i = 0; i < host->pipeline_count; i++) {
        dt_vk_close(host->runtimes[i]);
        vkDestroyImage(host->device, host->pictures[i].image, NULL);
        vkFreeMemory(host->device, host->pictures[i].memory, NULL);
        buffers[1 + i] = host->pictures[i].pixels;
    }
    for (int i = 0; i < 1 + MAX_PIPELINES; i++) {
        vkDestroyBuffer(host->device, buffers[i].handle, NULL);
        vkFreeMemory(host->device, buffers[i].memory, NULL);
    }
    for (int i = 0; i < IN_FLIGHT; i++)
        vkDestroyFence(host->device, host->fences[i], NULL);
    vkDestroyCommandPool(host->device, host->pool, NULL);
    vkDestroyDevice(host->device, NULL);
    vkDestroyInstance(host->instance, NULL);
}

int main(int argc, char **argv)
{
    static const struct {
        const struct dt_panel *panel;
        uint32_t output;
    } pipelines[MAX_PIPELINES] = {{&ssvp_vk, SSVP_RESOURCE_DISPLAY},
                                  {&rsm_vk, RSM_RESOURCE_DISPLAY}};
    const struct dt_log log = {.message = on_log};
    check(argc == 6 || argc == 7, "usage: host_vk SCENE WIDTH HEIGHT FRAMES SSVP.ppm [RSM.ppm]:");
    struct host host = {.width = (uint32_t)atoi(argv[2]),
                        .height = (uint32_t)atoi(argv[3]),
                        .pipeline_count = (uint32_t)argc - 5};
    struct dt_frame frame;
    struct dt_scene_file *scene = dt_scene_open(argv[1], NULL, &log);
    check(scene, argv[1]);
    dt_scene_frame(scene, host.width, host.height, &frame);
    open_instance(&host);
    open_device(&host);
    make_commands(&host);
    make_scene(&host, dt_scene_data(scene));
    for (uint32_t i = 0; i < host.pipeline_count; i++) {
        make_picture(&host, &host.pictures[i]);
        host.runtimes[i] =
            open_pipeline(&host, pipelines[i].panel, pipelines[i].output, &host.pictures[i]);
    }
    run_frames(&host, &frame, (uint32_t)atoi(argv[4]));
    for (uint32_t i = 0; i < host.pipeline_count; i++)
        write_picture(&host, &host.pictures[i], argv[5 + i]);
    close_host(&host);
    dt_scene_close(scene);
    return 0;
}
