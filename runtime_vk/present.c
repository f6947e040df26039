/* Shows pictures and an overlay in a window. The swapchain is recreated whenever the window
 * changes. Textures are filled from the pipeline's images or from memory, and drawn as triangles.
 * Vertices count y from the top; nothing else flips pictures. */
#include "internal.h"

#include <GLFW/glfw3.h>
#include <stdlib.h>
#include <string.h>

#include "window.h"

/* ---- Window and surface ---------------------------------------------------------------------- */

static bool no_window(const struct dt_vk_runtime *rt, const char *what)
{
    const char *text = NULL;
    glfwGetError(&text);
    return dt_error(&rt->core, "%s: %s", what, text ? text : "GLFW does not say why");
}

/* GLFW is global to the process. The runtime that initialises GLFW also terminates it, and must be
 * closed last. */
bool vk_window_open(struct dt_vk_runtime *rt)
{
    glfwGetError(NULL);
    glfwGetTime();
    rt->present.owns_glfw = glfwGetError(NULL) == GLFW_NOT_INITIALIZED;
    if (!glfwInit())
        return no_window(rt, "there is no display to open a window on");
    if (!glfwVulkanSupported())
        return no_window(rt, "the window system cannot show what Vulkan draws");
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    rt->present.window = glfwCreateWindow(64, 64, "diptych", NULL, NULL);
    return rt->present.window || no_window(rt, "GLFW gives no window");
}

const char *const *vk_window_extensions(uint32_t *count)
{
    return glfwGetRequiredInstanceExtensions(count);
}

bool vk_window_surface(struct dt_vk_runtime *rt)
{
    struct vk_present *present = &rt->present;
    if (present->surface)
        vkDestroySurfaceKHR(rt->instance, present->surface, NULL);
    present->surface = VK_NULL_HANDLE;
    return VK(rt, glfwCreateWindowSurface(rt->instance, present->window, NULL, &present->surface),
              "window");
}

bool vk_window_can_present(const struct dt_vk_runtime *rt, VkPhysicalDevice physical,
                           uint32_t family)
{
    VkBool32 can = VK_FALSE;
    VkExtensionProperties extensions[512];
    uint32_t count = DT_ARRAY_COUNT(extensions);
    if (family == UINT32_MAX ||
        vkGetPhysicalDeviceSurfaceSupportKHR(physical, family, rt->present.surface, &can) !=
            VK_SUCCESS ||
        vkEnumerateDeviceExtensionProperties(physical, NULL, &count, extensions) < 0)
        return false;
    for (uint32_t i = 0; can && i < count; i++)
        if (strcmp(extensions[i].extensionName, VK_KHR_SWAPCHAIN_EXTENSION_NAME) == 0)
            return true;
    return false;
}

void vk_window_close(struct dt_vk_runtime *rt)
{
    struct vk_present *present = &rt->present;
    if (present->surface)
        vkDestroySurfaceKHR(rt->instance, present->surface, NULL);
    if (present->window)
        glfwDestroyWindow(present->window);
    if (present->owns_glfw)
        glfwTerminate();
    present->window = NULL;
}

/* ---- Swapchain ------------------------------------------------------------------------------- */

static void destroy_images(struct dt_vk_runtime *rt)
{
    struct vk_present *present = &rt->present;
    for (uint32_t i = 0; i < VK_MAX_WINDOW_IMAGES; i++) {
        vkDestroyImageView(rt->device, present->views[i], NULL);
        vkDestroySemaphore(rt->device, present->drawn[i], NULL);
        present->views[i] = VK_NULL_HANDLE;
        present->drawn[i] = VK_NULL_HANDLE;
    }
    present->image_count = 0;
}

static void destroy_swapchain(struct dt_vk_runtime *rt)
{
    vkDeviceWaitIdle(rt->device);
    destroy_images(rt);
    if (rt->present.swapchain)
        vkDestroySwapchainKHR(rt->device, rt->present.swapchain, NULL);
    rt->present.swapchain = VK_NULL_HANDLE;
}

/* Chooses a UNORM format, which shows sRGB codes unchanged. */
static bool choose_format(struct dt_vk_runtime *rt, VkSurfaceFormatKHR *chosen)
{
    VkSurfaceFormatKHR formats[64];
    uint32_t count = DT_ARRAY_COUNT(formats);
    VkResult result =
        vkGetPhysicalDeviceSurfaceFormatsKHR(rt->physical, rt->present.surface, &count, formats);
    if (result < 0)
        return vk_check(rt, result, "vkGetPhysicalDeviceSurfaceFormatsKHR", "window");
    for (uint32_t i = 0; i < count; i++) {
        if (formats[i].colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR &&
            (formats[i].format == VK_FORMAT_B8G8R8A8_UNORM ||
             formats[i].format == VK_FORMAT_R8G8B8A8_UNORM)) {
            *chosen = formats[i];
            return true;
        }
    }
    return dt_error(&rt->core,
                    "window: the surface supports no 8 bit RGBA format; use OpenGL, or another "
                    "device");
}

static bool make_image(struct dt_vk_runtime *rt, uint32_t index)
{
    struct vk_present *present = &rt->present;
    VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = present->images[index],
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = present->format,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    return VK(rt, vkCreateImageView(rt->device, &view, NULL, &present->views[index]), "window") &&
           VK(rt, vkCreateSemaphore(rt->device, &semaphore, NULL, &present->drawn[index]),
              "window");
}

static bool take_images(struct dt_vk_runtime *rt)
{
    struct vk_present *present = &rt->present;
    uint32_t count = 0;
    if (!VK(rt, vkGetSwapchainImagesKHR(rt->device, present->swapchain, &count, NULL), "window"))
        return false;
    if (count > VK_MAX_WINDOW_IMAGES)
        return dt_error(&rt->core,
                        "window: the swapchain has %u images, at most %d are supported; use OpenGL",
                        count, VK_MAX_WINDOW_IMAGES);
    if (!VK(rt, vkGetSwapchainImagesKHR(rt->device, present->swapchain, &count, present->images),
            "window"))
        return false;
    present->image_count = count;
    for (uint32_t i = 0; i < count; i++)
        if (!make_image(rt, i))
            return false;
    return true;
}

static uint32_t clamp(uint32_t value, uint32_t least, uint32_t most)
{
    return value < least ? least : value > most ? most : value;
}

/* Whether the result means that the window has changed. Then renew destroys the swapchain,
 * recreates a lost surface, and the next frame creates a new swapchain. */
static bool is_outdated(VkResult result)
{
    return result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR ||
           result == VK_ERROR_SURFACE_LOST_KHR;
}

static bool renew(struct dt_vk_runtime *rt, VkResult result)
{
    destroy_swapchain(rt);
    if (result != VK_ERROR_SURFACE_LOST_KHR)
        return true;
    if (!vk_window_surface(rt))
        return false;
    return vk_window_can_present(rt, rt->physical, rt->queue_family) ||
           dt_error(&rt->core,
                    "window: %s cannot present to the new surface; start again, or use another "
                    "device",
                    rt->core.device_name);
}

/* Creates no swapchain if the window has no pixels. */
static bool make_swapchain(struct dt_vk_runtime *rt)
{
    struct vk_present *present = &rt->present;
    VkSurfaceCapabilitiesKHR can;
    VkSurfaceFormatKHR format = {0};
    int width, height;
    VkResult result =
        vkGetPhysicalDeviceSurfaceCapabilitiesKHR(rt->physical, present->surface, &can);
    if (is_outdated(result))
        return renew(rt, result);
    if (!vk_check(rt, result, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR", "window") ||
        !choose_format(rt, &format))
        return false;
    glfwGetFramebufferSize(present->window, &width, &height);
    bool free_size = can.currentExtent.width == UINT32_MAX;
    present->width = free_size ? (uint32_t)width : can.currentExtent.width;
    present->height = free_size ? (uint32_t)height : can.currentExtent.height;
    if (!present->width || !present->height || width < 1 || height < 1)
        return true;
    present->format = format.format;
    present->can_be_read = can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = present->surface,
        .minImageCount = clamp(can.minImageCount + 1, can.minImageCount,
                               can.maxImageCount ? can.maxImageCount : UINT32_MAX),
        .imageFormat = format.format,
        .imageColorSpace = format.colorSpace,
        .imageExtent = {present->width, present->height},
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                      (can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT),
        .preTransform = can.currentTransform,
        .compositeAlpha = can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
        .clipped = VK_TRUE,
    };
    result = vkCreateSwapchainKHR(rt->device, &info, NULL, &present->swapchain);
    if (is_outdated(result))
        return renew(rt, result);
    return vk_check(rt, result, "vkCreateSwapchainKHR", "window") && take_images(rt);
}

/* ---- Textures -------------------------------------------------------------------------------- */

/* The texture, resized if needed; a resize loses the content. */
static struct vk_image *sized_texture(struct dt_vk_runtime *rt, uint32_t texture, uint32_t width,
                                      uint32_t height)
{
    static const char *const names[DT_WINDOW_TEXTURES] = {"overlay", "picture 1", "picture 2",
                                                          "picture 3"};
    struct vk_image *image = &rt->present.textures[texture];
    if (image->handle && image->width == width && image->height == height)
        return image;
    vk_image_destroy(rt, image);
    vk_program_destroy(rt, &rt->present.programs[texture]); /* its bindings are gone */
    const struct vk_image_info info = {.name = names[texture],
                                       .format = DT_FORMAT_RGBA8,
                                       .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                       .width = width,
                                       .height = height,
                                       .layers = 1,
                                       .mips = 1};
    return vk_image_create_own(rt, image, &info) ? image : NULL;
}

bool vk_window_copy(struct dt_core *core, uint32_t texture, uint32_t resource)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_image *image = &vk_resource_at(rt, resource)->image;
    struct vk_image *to = sized_texture(rt, texture, image->width, image->height);
    VkCommandBuffer commands = to ? vk_immediate_begin(rt, to->name) : NULL;
    if (!commands)
        return false;
    VkImageLayout layout = image->layout;
    VkImageCopy region = {
        .srcSubresource = {image->aspect, 0, 0, 1},
        .dstSubresource = {to->aspect, 0, 0, 1},
        .extent = {to->width, to->height, 1},
    };
    vk_transition(rt, commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vk_transition(rt, commands, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdCopyImage(commands, image->handle, image->layout, to->handle, to->layout, 1, &region);
    vk_transition(rt, commands, to, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    if (layout != VK_IMAGE_LAYOUT_UNDEFINED) /* no transition to UNDEFINED exists */
        vk_transition(rt, commands, image, layout);
    return vk_immediate_end(rt, to->name);
}

bool vk_window_upload(struct dt_core *core, uint32_t texture, uint32_t width, uint32_t height,
                      const uint8_t *pixels)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_image *to = sized_texture(rt, texture, width, height);
    void *staging = to ? vk_staging(rt, (VkDeviceSize)width * height * 4, to->name) : NULL;
    if (!staging)
        return false;
    memcpy(staging, pixels, (size_t)width * height * 4);
    VkCommandBuffer commands = vk_immediate_begin(rt, to->name);
    if (!commands)
        return false;
    const VkBufferImageCopy region = vk_mip_region(to, 0);
    vk_transition(rt, commands, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdCopyBufferToImage(commands, rt->staging.handle, to->handle, to->layout, 1, &region);
    vk_transition(rt, commands, to, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    return vk_immediate_end(rt, to->name);
}

/* ---- Programs and vertices ------------------------------------------------------------------- */

static bool make_samplers(struct dt_vk_runtime *rt)
{
    static const struct dt_sampler infos[2] = {
        {.name = "window overlay", .linear = true, .anisotropy = 1},
        {.name = "window picture", .anisotropy = 1},
    };
    VkSampler *samplers = rt->present.samplers;
    for (int i = 0; i < 2; i++)
        if (!samplers[i] && !vk_sampler_create(rt, &samplers[i], &infos[i]))
            return false;
    return true;
}

static bool make_program(struct dt_vk_runtime *rt, uint32_t texture)
{
    static const struct dt_stages stages = {.vertex = {window_vert, sizeof window_vert},
                                            .fragment = {window_frag, sizeof window_frag}};
    static const struct dt_binding bindings[] = {{.binding = 0, .kind = DT_BIND_STORAGE},
                                                 {.binding = 1, .kind = DT_BIND_TEXTURE}};
    static const struct dt_blend over = {.src = DT_FACTOR_SRC_ALPHA,
                                         .dst = DT_FACTOR_ONE_MINUS_SRC_ALPHA,
                                         .alpha_src = DT_FACTOR_ZERO};
    static const struct dt_target target = {.blend = &over};
    static const struct dt_program state = {.bindings = bindings,
                                            .binding_count = DT_ARRAY_COUNT(bindings),
                                            .colors = &target,
                                            .color_count = 1};
    struct vk_present *present = &rt->present;
    struct vk_program *program = &present->programs[texture];
    const struct vk_program_info info = {
        .name = "window", .stages = &stages, .state = &state, .color_formats = {present->format}};
    const struct vk_descriptor descriptors[] = {
        {.buffer = {present->vertices.handle, 0, present->vertices.size}},
        {.image = {present->samplers[texture != 0], present->textures[texture].view,
                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL}},
    };
    if (program->pipeline)
        return true;
    if (!vk_program_create(rt, program, &info))
        return false;
    vk_program_bind(rt, program, bindings, descriptors, DT_ARRAY_COUNT(descriptors));
    return true;
}

/* For all textures with content. */
static bool make_programs(struct dt_vk_runtime *rt)
{
    for (uint32_t i = 0; i < DT_WINDOW_TEXTURES; i++)
        if (rt->present.textures[i].handle && !make_program(rt, i))
            return false;
    return true;
}

static bool make_vertices(struct dt_vk_runtime *rt, size_t size)
{
    struct vk_present *present = &rt->present;
    const struct vk_buffer_info info = {.name = "window vertices",
                                        .size = size + size / 2,
                                        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    if (present->vertices.handle && present->vertices.size >= size)
        return true;
    vk_buffer_destroy(rt, &present->vertices);
    for (uint32_t i = 0; i < DT_WINDOW_TEXTURES; i++)
        vk_program_destroy(rt, &present->programs[i]);
    return vk_buffer_create_own(rt, &present->vertices, &info, true);
}

/* Converts pixels, y from the top, to clip space, where y = -1 is the window's top row. */
static bool upload_vertices(struct dt_vk_runtime *rt, const struct dt_window_frame *frame)
{
    if (!make_vertices(rt, frame->vertex_count * sizeof *frame->vertices))
        return false;
    struct dt_window_vertex *vertices = rt->present.vertices.bytes;
    float width = (float)rt->present.width, height = (float)rt->present.height;
    for (uint32_t i = 0; i < frame->vertex_count; i++) {
        vertices[i] = frame->vertices[i];
        vertices[i].position[0] = vertices[i].position[0] * 2 / width - 1;
        vertices[i].position[1] = vertices[i].position[1] * 2 / height - 1;
    }
    return true;
}

/* ---- Drawing --------------------------------------------------------------------------------- */

static void image_barrier(VkCommandBuffer commands, VkImage image, bool shows)
{
    const VkImageMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
        .srcAccessMask = shows ? VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT : VK_ACCESS_2_NONE,
        .dstStageMask = shows ? VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT
                              : VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
        .dstAccessMask = shows ? VK_ACCESS_2_NONE : VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
        .oldLayout = shows ? VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout =
            shows ? VK_IMAGE_LAYOUT_PRESENT_SRC_KHR : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier2(commands, &(VkDependencyInfo){
                                        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                        .imageMemoryBarrierCount = 1,
                                        .pImageMemoryBarriers = &barrier,
                                    });
}

/* The part of the clip rectangle that lies in the window. */
static VkRect2D scissor(const struct vk_present *present, const int32_t clip[4])
{
    int32_t left = clip[0] > 0 ? clip[0] : 0, top = clip[1] > 0 ? clip[1] : 0;
    int32_t right = clip[2] < (int32_t)present->width ? clip[2] : (int32_t)present->width;
    int32_t bottom = clip[3] < (int32_t)present->height ? clip[3] : (int32_t)present->height;
    return (VkRect2D){
        {left, top},
        {right > left ? (uint32_t)(right - left) : 0, bottom > top ? (uint32_t)(bottom - top) : 0}};
}

static void draw_list(VkCommandBuffer commands, const struct vk_present *present,
                      const struct dt_window_draw *draw)
{
    const struct vk_program *program = &present->programs[draw->texture];
    VkRect2D rect = scissor(present, draw->clip);
    if (!program->pipeline || !rect.extent.width || !rect.extent.height)
        return;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, program->pipeline->handle);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, program->pipeline->layout, 0,
                            1, &program->set, 0, NULL);
    vkCmdSetScissor(commands, 0, 1, &rect);
    vkCmdDraw(commands, draw->count, 1, draw->first, 0);
}

static void record(VkCommandBuffer commands, const struct vk_present *present, uint32_t index,
                   const struct dt_window_frame *frame)
{
    VkViewport viewport = {0, 0, (float)present->width, (float)present->height, 0, 1};
    VkRenderingAttachmentInfo color = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = present->views[index],
        .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
        .clearValue.color.float32 = {0, 0, 0, 1},
    };
    VkRenderingInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        .renderArea.extent = {present->width, present->height},
        .layerCount = 1,
        .colorAttachmentCount = 1,
        .pColorAttachments = &color,
    };
    image_barrier(commands, present->images[index], false);
    vkCmdBeginRendering(commands, &info);
    vkCmdSetViewport(commands, 0, 1, &viewport);
    for (uint32_t i = 0; i < frame->draw_count; i++)
        draw_list(commands, present, &frame->draws[i]);
    vkCmdEndRendering(commands);
    image_barrier(commands, present->images[index], true);
}

/* ---- Photographs ----------------------------------------------------------------------------- */

/* Copies the image, which is ready to be shown, to the staging buffer, and makes it ready again. */
static bool copy_to_staging(struct dt_vk_runtime *rt, uint32_t index)
{
    struct vk_present *present = &rt->present;
    VkImageMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = present->images[index],
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    const VkDependencyInfo depends = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .imageMemoryBarrierCount = 1,
                                      .pImageMemoryBarriers = &barrier};
    const VkBufferImageCopy region = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {present->width, present->height, 1},
    };
    VkCommandBuffer commands;
    if (!vk_staging(rt, (VkDeviceSize)present->width * present->height * 4, "window") ||
        !(commands = vk_immediate_begin(rt, "window")))
        return false;
    vkCmdPipelineBarrier2(commands, &depends);
    vkCmdCopyImageToBuffer(commands, barrier.image, barrier.newLayout, rt->staging.handle, 1,
                           &region);
    barrier.oldLayout = barrier.newLayout;
    barrier.newLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    vkCmdPipelineBarrier2(commands, &depends);
    return vk_immediate_end(rt, "window");
}

static bool photograph(struct dt_vk_runtime *rt, uint32_t index, struct dt_bytes *photo)
{
    struct vk_present *present = &rt->present;
    if (!present->can_be_read)
        return dt_error(&rt->core, "window: its images cannot be read; let OpenGL draw the window");
    if (!copy_to_staging(rt, index))
        return false;
    photo->size = (size_t)present->width * present->height * 4;
    photo->data = malloc(photo->size);
    if (!photo->data)
        return dt_error(&rt->core, "window: no memory for a photograph of %zu bytes; free some",
                        photo->size);
    memcpy(photo->extent, (uint32_t[3]){present->width, present->height, 1}, sizeof photo->extent);
    memcpy(photo->data, rt->staging.bytes, photo->size);
    for (size_t i = 0; present->format == VK_FORMAT_B8G8R8A8_UNORM && i < photo->size; i += 4) {
        uint8_t blue = photo->data[i];
        photo->data[i] = photo->data[i + 2];
        photo->data[i + 2] = blue;
    }
    return true;
}

/* ---- Showing --------------------------------------------------------------------------------- */

/* Waits on the CPU until the image may be drawn to. */
static VkResult acquire(struct dt_vk_runtime *rt, uint32_t *index)
{
    struct vk_present *present = &rt->present;
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkResult result = present->acquired
                          ? VK_SUCCESS
                          : vkCreateFence(rt->device, &fence, NULL, &present->acquired);
    if (result == VK_SUCCESS)
        result = vkAcquireNextImageKHR(rt->device, present->swapchain, UINT64_MAX, VK_NULL_HANDLE,
                                       present->acquired, index);
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR)
        return result;
    VkResult waited = vkWaitForFences(rt->device, 1, &present->acquired, VK_TRUE, UINT64_MAX);
    return waited == VK_SUCCESS ? vkResetFences(rt->device, 1, &present->acquired) : waited;
}

static VkResult show(struct dt_vk_runtime *rt, uint32_t index)
{
    struct vk_present *present = &rt->present;
    VkPresentInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
        .waitSemaphoreCount = 1,
        .pWaitSemaphores = &present->drawn[index],
        .swapchainCount = 1,
        .pSwapchains = &present->swapchain,
        .pImageIndices = &index,
    };
    return vkQueuePresentKHR(rt->queue, &info);
}

static bool shape_changed(const struct vk_present *present)
{
    int width, height;
    glfwGetFramebufferSize(present->window, &width, &height);
    return (uint32_t)width != present->width || (uint32_t)height != present->height;
}

bool vk_present(struct dt_core *core, const struct dt_window_frame *frame)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_present *present = &rt->present;
    uint32_t index = 0;
    if (present->swapchain && shape_changed(present))
        destroy_swapchain(rt);
    if (!present->swapchain && !make_swapchain(rt))
        return false;
    if (!present->swapchain)
        return true;
    if (!make_samplers(rt) || !upload_vertices(rt, frame) || !make_programs(rt))
        return false;
    VkResult result = acquire(rt, &index);
    if (is_outdated(result))
        return renew(rt, result);
    if (!vk_check(rt, result, "vkAcquireNextImageKHR", "window"))
        return false;
    VkCommandBuffer commands = vk_immediate_begin(rt, "window");
    if (!commands)
        return false;
    record(commands, present, index, frame);
    if (!vk_immediate_end_signal(rt, "window", present->drawn[index]) ||
        (frame->photo && !photograph(rt, index, frame->photo)))
        return false;
    result = show(rt, index);
    if (is_outdated(result))
        return renew(rt, result);
    return vk_check(rt, result, "vkQueuePresentKHR", "window");
}

void vk_present_destroy(struct dt_vk_runtime *rt)
{
    struct vk_present *present = &rt->present;
    if (present->swapchain)
        destroy_swapchain(rt);
    for (int i = 0; i < DT_WINDOW_TEXTURES; i++) {
        vk_program_destroy(rt, &present->programs[i]);
        vk_image_destroy(rt, &present->textures[i]);
    }
    vk_buffer_destroy(rt, &present->vertices);
    for (int i = 0; i < 2; i++)
        vk_sampler_destroy(rt, &present->samplers[i]);
    vkDestroyFence(rt->device, present->acquired, NULL);
    present->acquired = VK_NULL_HANDLE;
}
