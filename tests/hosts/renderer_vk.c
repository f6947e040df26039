/* See renderer_vk.h. */
#include "renderer_vk.h"

#include <stdio.h>
#include <stdlib.h>

void check(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "host: %s failed\n", what);
    exit(1);
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

static void open_device(struct renderer *renderer, const VkPhysicalDeviceFeatures2 *features)
{
    uint32_t count = 1;
    VkResult result = vkEnumeratePhysicalDevices(renderer->instance, &count, &renderer->physical);
    check(result >= 0 && count == 1, "vkEnumeratePhysicalDevices");
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueCount = 1,
                                           .pQueuePriorities = &(float){1}};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = features,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue};
    CHECK(vkCreateDevice(renderer->physical, &info, NULL, &renderer->device));
    vkGetDeviceQueue(renderer->device, 0, 0, &renderer->queue);
}

static void make_commands(struct renderer *renderer)
{
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    CHECK(vkCreateCommandPool(renderer->device, &pool, NULL, &renderer->pool));
    const VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = renderer->pool,
        .commandBufferCount = IN_FLIGHT};
    CHECK(vkAllocateCommandBuffers(renderer->device, &commands, renderer->commands));
    for (int i = 0; i < IN_FLIGHT; i++)
        CHECK(vkCreateFence(renderer->device, &fence, NULL, &renderer->fences[i]));
}

void renderer_open(struct renderer *renderer, const VkPhysicalDeviceFeatures2 *features)
{
    open_instance(renderer);
    open_device(renderer, features);
    make_commands(renderer);
}

void renderer_close(struct renderer *renderer)
{
    for (int i = 0; i < IN_FLIGHT; i++)
        vkDestroyFence(renderer->device, renderer->fences[i], NULL);
    vkDestroyCommandPool(renderer->device, renderer->pool, NULL);
    vkDestroyDevice(renderer->device, NULL);
    vkDestroyInstance(renderer->instance, NULL);
}

/* ---- Buffers and pictures -------------------------------------------------------------------- */

static VkDeviceMemory allocate(const struct renderer *renderer, const VkMemoryRequirements *needs,
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
    buffer.memory =
        allocate(renderer, &needs,
                 VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    CHECK(vkBindBufferMemory(renderer->device, buffer.handle, buffer.memory, 0));
    CHECK(vkMapMemory(renderer->device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.bytes));
    return buffer;
}

void destroy_buffer(const struct renderer *renderer, const struct buffer *buffer)
{
    vkDestroyBuffer(renderer->device, buffer->handle, NULL);
    vkFreeMemory(renderer->device, buffer->memory, NULL);
}

struct picture make_picture(const struct renderer *renderer, VkImageUsageFlags usage)
{
    struct picture picture;
    VkMemoryRequirements needs;
    CHECK(vkCreateImage(renderer->device,
                        &(VkImageCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                             .imageType = VK_IMAGE_TYPE_2D,
                                             .format = VK_FORMAT_R8G8B8A8_UNORM,
                                             .extent = {renderer->width, renderer->height, 1},
                                             .mipLevels = 1,
                                             .arrayLayers = 1,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                        NULL, &picture.image));
    vkGetImageMemoryRequirements(renderer->device, picture.image, &needs);
    picture.memory = allocate(renderer, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
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

VkCommandBuffer begin_frame(struct renderer *renderer, uint32_t frame)
{
    VkFence *fence = &renderer->fences[frame % IN_FLIGHT];
    VkCommandBuffer commands = renderer->commands[frame % IN_FLIGHT];
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    CHECK(vkWaitForFences(renderer->device, 1, fence, VK_TRUE, UINT64_MAX));
    CHECK(vkResetFences(renderer->device, 1, fence));
    CHECK(vkBeginCommandBuffer(commands, &info));
    return commands;
}

void end_frame(struct renderer *renderer, uint32_t frame)
{
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .commandBufferCount = 1,
                                 .pCommandBuffers = &renderer->commands[frame % IN_FLIGHT]};
    CHECK(vkEndCommandBuffer(renderer->commands[frame % IN_FLIGHT]));
    CHECK(vkQueueSubmit(renderer->queue, 1, &submit, renderer->fences[frame % IN_FLIGHT]));
}

void wait_for_frames(const struct renderer *renderer)
{
    CHECK(vkDeviceWaitIdle(renderer->device));
}
