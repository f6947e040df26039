/* See renderer_vk.h. */
#include "renderer_vk.h"

#include <malloc.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void check(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "host: %s failed\n", what);
    exit(1);
}

/* ---- Host memory of the driver --------------------------------------------------------------- */

/* The count orders no memory, so that it hides no race from ThreadSanitizer. */

static void *VKAPI_PTR allocate_block(void *user, size_t size, size_t alignment,
                                      VkSystemAllocationScope scope)
{
    struct renderer *renderer = user;
    void *block = NULL;
    (void)scope;
    if (posix_memalign(&block, alignment < sizeof block ? sizeof block : alignment, size) != 0)
        return NULL;
    atomic_fetch_add_explicit(&renderer->blocks, 1, memory_order_relaxed);
    return block;
}

static void VKAPI_PTR free_block(void *user, void *block)
{
    struct renderer *renderer = user;
    atomic_fetch_sub_explicit(&renderer->blocks, block != NULL, memory_order_relaxed);
    free(block);
}

static void *VKAPI_PTR reallocate_block(void *user, void *block, size_t size, size_t alignment,
                                        VkSystemAllocationScope scope)
{
    void *more = allocate_block(user, size, alignment, scope);
    size_t old = block ? malloc_usable_size(block) : 0;
    if (more && block)
        memcpy(more, block, old < size ? old : size);
    free_block(user, block);
    return more;
}

/* ---- Device ---------------------------------------------------------------------------------- */

static void open_instance(struct renderer *renderer)
{
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application};
    CHECK(vkCreateInstance(&info, NULL, &renderer->instance));
}

void renderer_prepare(struct renderer *renderer)
{
    static const float priority = 1;
    static const VkDeviceQueueCreateInfo queue = {.sType =
                                                      VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                                  .queueCount = 1,
                                                  .pQueuePriorities = &priority};
    renderer->vulkan13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    renderer->vulkan12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    renderer->vulkan12.pNext = &renderer->vulkan13;
    renderer->vulkan11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES;
    renderer->vulkan11.pNext = &renderer->vulkan12;
    renderer->device_info = (VkDeviceCreateInfo){.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                                 .pNext = &renderer->vulkan11,
                                                 .queueCreateInfoCount = 1,
                                                 .pQueueCreateInfos = &queue,
                                                 .pEnabledFeatures = &renderer->core};
}

static void open_device(struct renderer *renderer,
                        bool (*suits)(VkInstance instance, VkPhysicalDevice physical))
{
    enum { MAX_DEVICES = 8 };
    const VkPipelineCacheCreateInfo cache = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    VkPhysicalDevice devices[MAX_DEVICES];
    uint32_t count = MAX_DEVICES, chosen = 0;
    VkResult result = vkEnumeratePhysicalDevices(renderer->instance, &count, devices);
    check(result >= 0, "vkEnumeratePhysicalDevices");
    while (chosen < count && !suits(renderer->instance, devices[chosen]))
        chosen++;
    check(chosen < count, "choosing a device");
    renderer->physical = devices[chosen];
    CHECK(vkCreateDevice(renderer->physical, &renderer->device_info, NULL, &renderer->device));
    vkGetDeviceQueue(renderer->device, 0, 0, &renderer->queue);
    CHECK(vkCreatePipelineCache(renderer->device, &cache, NULL, &renderer->cache));
}

static void make_lane(const struct renderer *renderer, struct lane *lane)
{
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    CHECK(vkCreateCommandPool(renderer->device, &pool, NULL, &lane->pool));
    const VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = lane->pool,
        .commandBufferCount = IN_FLIGHT};
    CHECK(vkAllocateCommandBuffers(renderer->device, &commands, lane->commands));
}

void renderer_open(struct renderer *renderer,
                   bool (*suits)(VkInstance instance, VkPhysicalDevice physical))
{
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    renderer->callbacks = (VkAllocationCallbacks){.pUserData = renderer,
                                                  .pfnAllocation = allocate_block,
                                                  .pfnReallocation = reallocate_block,
                                                  .pfnFree = free_block};
    if (!renderer->instance)
        open_instance(renderer);
    open_device(renderer, suits);
    for (int i = 0; i < LANES; i++)
        make_lane(renderer, &renderer->lanes[i]);
    for (int i = 0; i < IN_FLIGHT; i++)
        CHECK(vkCreateFence(renderer->device, &fence, NULL, &renderer->fences[i]));
}

void renderer_close_device(struct renderer *renderer)
{
    for (int i = 0; i < IN_FLIGHT; i++)
        vkDestroyFence(renderer->device, renderer->fences[i], NULL);
    for (int i = 0; i < LANES; i++)
        vkDestroyCommandPool(renderer->device, renderer->lanes[i].pool, NULL);
    vkDestroyPipelineCache(renderer->device, renderer->cache, NULL);
    vkDestroyDevice(renderer->device, NULL);
    check(renderer->blocks == 0, "freeing all host memory");
}

void renderer_close(struct renderer *renderer)
{
    renderer_close_device(renderer);
    vkDestroyInstance(renderer->instance, NULL);
}

/* ---- Threads --------------------------------------------------------------------------------- */

/* Nothing but start and end is shared, so that no order of the threads hides a race: each thread has
 * jobs of its own. */
struct jobs {
    void (*job)(void *data, uint32_t i);
    void *data;
    uint32_t first, count;
};

static void *work(void *argument)
{
    const struct jobs *jobs = argument;
    for (uint32_t i = jobs->first; i < jobs->count; i += LANES)
        jobs->job(jobs->data, i);
    return NULL;
}

void renderer_run(void *renderer, uint32_t count, void (*job)(void *data, uint32_t i), void *data)
{
    struct jobs jobs[LANES];
    pthread_t threads[LANES];
    (void)renderer;
    for (uint32_t i = 0; i < LANES; i++) {
        jobs[i] = (struct jobs){.job = job, .data = data, .first = i, .count = count};
        check(pthread_create(&threads[i], NULL, work, &jobs[i]) == 0, "pthread_create");
    }
    for (int i = 0; i < LANES; i++)
        check(pthread_join(threads[i], NULL) == 0, "pthread_join");
}

/* ---- Buffers and pictures -------------------------------------------------------------------- */

VkDeviceMemory renderer_allocate(const struct renderer *renderer, const VkMemoryRequirements *needs,
                                 VkMemoryPropertyFlags wanted)
{
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceMemory handle = VK_NULL_HANDLE;
    uint32_t type = 0;
    vkGetPhysicalDeviceMemoryProperties(renderer->physical, &memory);
    while (type < memory.memoryTypeCount &&
           (!(needs->memoryTypeBits >> type & 1) ||
            (memory.memoryTypes[type].propertyFlags & wanted) != wanted))
        type++;
    CHECK(vkAllocateMemory(renderer->device,
                           &(VkMemoryAllocateInfo){.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                   .allocationSize = needs->size,
                                                   .memoryTypeIndex = type},
                           NULL, &handle));
    return handle;
}

struct buffer make_buffer(const struct renderer *renderer, VkDeviceSize size,
                          VkBufferUsageFlags usage)
{
    struct buffer buffer;
    VkMemoryRequirements needs;
    CHECK(vkCreateBuffer(renderer->device,
                         &(VkBufferCreateInfo){.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                               .size = size,
                                               .usage = usage},
                         NULL, &buffer.handle));
    vkGetBufferMemoryRequirements(renderer->device, buffer.handle, &needs);
    buffer.memory = renderer_allocate(renderer, &needs,
                                      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                          VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    CHECK(vkBindBufferMemory(renderer->device, buffer.handle, buffer.memory, 0));
    CHECK(vkMapMemory(renderer->device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.bytes));
    return buffer;
}

void destroy_buffer(const struct renderer *renderer, const struct buffer *buffer)
{
    vkDestroyBuffer(renderer->device, buffer->handle, NULL);
    vkFreeMemory(renderer->device, buffer->memory, NULL);
}

struct picture make_picture(const struct renderer *renderer, VkFormat format,
                            VkImageUsageFlags usage)
{
    struct picture picture;
    VkMemoryRequirements needs;
    CHECK(vkCreateImage(renderer->device,
                        &(VkImageCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                             .imageType = VK_IMAGE_TYPE_2D,
                                             .format = format,
                                             .extent = {renderer->width, renderer->height, 1},
                                             .mipLevels = 1,
                                             .arrayLayers = 1,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                        NULL, &picture.image));
    vkGetImageMemoryRequirements(renderer->device, picture.image, &needs);
    picture.memory = renderer_allocate(renderer, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    CHECK(vkBindImageMemory(renderer->device, picture.image, picture.memory, 0));
    picture.pixels = make_buffer(renderer, (VkDeviceSize)renderer->width * renderer->height * 4,
                                 VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    return picture;
}

void destroy_picture(const struct renderer *renderer, const struct picture *picture)
{
    vkDestroyImage(renderer->device, picture->image, NULL);
    vkFreeMemory(renderer->device, picture->memory, NULL);
    destroy_buffer(renderer, &picture->pixels);
}

void copy_picture(const struct renderer *renderer, VkCommandBuffer commands,
                  const struct picture *picture, VkImageLayout layout)
{
    const VkBufferImageCopy region = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {renderer->width, renderer->height, 1},
    };
    vkCmdCopyImageToBuffer(commands, picture->image, layout, picture->pixels.handle, 1, &region);
}

/* Row 0 in memory is the bottom of the picture. */
void write_picture(const struct renderer *renderer, const struct picture *picture, const char *path)
{
    FILE *file = fopen(path, "wb");
    check(file, path);
    fprintf(file, "P6\n%u %u\n255\n", renderer->width, renderer->height);
    for (uint32_t y = renderer->height; y-- > 0;)
        for (uint32_t x = 0; x < renderer->width; x++)
            fwrite((const char *)picture->pixels.bytes + ((size_t)y * renderer->width + x) * 4, 1,
                   3, file);
    check(fclose(file) == 0, path);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

void begin_frame(struct renderer *renderer, uint32_t frame)
{
    const VkFence *fence = &renderer->fences[frame % IN_FLIGHT];
    CHECK(vkWaitForFences(renderer->device, 1, fence, VK_TRUE, UINT64_MAX));
}

VkCommandBuffer begin_commands(struct renderer *renderer, uint32_t frame, uint32_t lane)
{
    VkCommandBuffer commands = renderer->lanes[lane].commands[frame % IN_FLIGHT];
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    CHECK(vkBeginCommandBuffer(commands, &info));
    return commands;
}

void end_frame(struct renderer *renderer, uint32_t frame, uint32_t lanes)
{
    VkCommandBuffer commands[LANES];
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .commandBufferCount = lanes,
                                 .pCommandBuffers = commands};
    for (uint32_t i = 0; i < lanes; i++) {
        commands[i] = renderer->lanes[i].commands[frame % IN_FLIGHT];
        CHECK(vkEndCommandBuffer(commands[i]));
    }
    CHECK(vkResetFences(renderer->device, 1, &renderer->fences[frame % IN_FLIGHT]));
    CHECK(vkQueueSubmit(renderer->queue, 1, &submit, renderer->fences[frame % IN_FLIGHT]));
}

void wait_for_frames(const struct renderer *renderer)
{
    CHECK(vkDeviceWaitIdle(renderer->device));
}
