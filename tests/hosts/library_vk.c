/* What library_vk.h declares: a device of the tests' own, images, and frames on it. */
#include "library_vk.h"

#include <stdio.h>
#include <string.h>

#include "shapes.h"

struct renderer vk;
struct buffer geometry;
struct dt_vk_scene vk_scene;
struct outside outside;
static VkDebugUtilsMessengerEXT messenger;

static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity, (void)types, (void)user;
    heard.validation++;
    snprintf(heard.hazard, sizeof heard.hazard, "%s",
             data->pMessageIdName ? data->pMessageIdName : "");
    print_message("%.900s\n", data->pMessage); /* cmocka cuts at 1,023, with the line end */
    return VK_FALSE;
}

static void open_instance(void)
{
    const char *layer = "VK_LAYER_KHRONOS_validation";
    const char *extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    const VkValidationFeatureEnableEXT synchronization =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                              .enabledValidationFeatureCount = 1,
                                              .pEnabledValidationFeatures = &synchronization};
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pNext = &features,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = 1,
                                       .ppEnabledLayerNames = &layer,
                                       .enabledExtensionCount = DT_ARRAY_COUNT(extensions),
                                       .ppEnabledExtensionNames = extensions};
    const VkDebugUtilsMessengerCreateInfoEXT hears = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message};
    assert_int_equal(vkCreateInstance(&info, NULL, &vk.instance), VK_SUCCESS);
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(vk.instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    assert_int_equal(create(vk.instance, &hears, NULL, &messenger), VK_SUCCESS);
}

static bool is_any(VkInstance instance, VkPhysicalDevice physical)
{
    return instance && physical;
}

static void open_device(void)
{
    renderer_prepare(&vk);
    dt_vk_need_features(&features_vk, &vk.core, &vk.vulkan11, &vk.vulkan12, &vk.vulkan13);
    dt_vk_need_features(&shapes_vk, &vk.core, &vk.vulkan11, &vk.vulkan12, &vk.vulkan13);
    renderer_open(&vk, is_any);
}

/* One buffer for all: a triangle, then the bytes that are read back. */
static void make_geometry(void)
{
    geometry =
        make_buffer(&vk, GEOMETRY_BYTES,
                    VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                        VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    lay_triangle(geometry.bytes);
    vk_scene = (struct dt_vk_scene){
        .vertices = {geometry.handle, 0, 3 * sizeof(struct dt_vertex)},
        .indices = {geometry.handle, INDICES, 3 * sizeof(uint32_t)},
        .index_count = 3,
        .materials = {geometry.handle, MATERIALS, DT_MAX_MATERIALS * sizeof(struct dt_material)},
        .objects = {geometry.handle, OBJECTS, sizeof(struct dt_object)},
        .numbered = true};
}

int open_vulkan(void **state)
{
    (void)state;
    open_instance();
    open_device();
    make_geometry();
    return 0;
}

int close_vulkan(void **state)
{
    (void)state;
    PFN_vkDestroyDebugUtilsMessengerEXT destroy =
        (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            vk.instance, "vkDestroyDebugUtilsMessengerEXT");
    destroy_buffer(&vk, &geometry);
    renderer_close_device(&vk);
    destroy(vk.instance, messenger, NULL);
    vkDestroyInstance(vk.instance, NULL);
    return heard.validation; /* includes objects that pipelines left behind */
}

int is_silent(void **state)
{
    (void)state;
    const int count = heard.validation;
    heard.validation = 0; /* for the next test */
    assert_int_equal(count, 0);
    return 0;
}

struct dt_vk_host vk_host(void)
{
    return (struct dt_vk_host){.log = test_log,
                               .instance = vk.instance,
                               .physical_device = vk.physical,
                               .device = vk.device,
                               .get_instance_proc_addr = vkGetInstanceProcAddr,
                               .labels = true};
}

struct dt_vk_runtime *open_vk_runtime(struct dt_vk_host host, const struct dt_shaders *shaders)
{
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_non_null(rt);
    assert_true(!shaders || (dt_vk_create(rt, shaders) && dt_vk_resize(rt, WIDTH, HEIGHT)));
    return rt;
}

VkCommandBuffer new_commands(void)
{
    const VkCommandBufferAllocateInfo info = {.sType =
                                                  VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = vk.lanes[0].pool,
                                              .commandBufferCount = 1};
    const VkCommandBufferBeginInfo start = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkCommandBuffer commands;
    assert_int_equal(vkAllocateCommandBuffers(vk.device, &info, &commands), VK_SUCCESS);
    assert_int_equal(vkBeginCommandBuffer(commands, &start), VK_SUCCESS);
    return commands;
}

void submit_commands(VkCommandBuffer commands)
{
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .commandBufferCount = 1,
                               .pCommandBuffers = &commands};
    assert_int_equal(vkEndCommandBuffer(commands), VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(vk.queue, 1, &info, VK_NULL_HANDLE), VK_SUCCESS);
}

void finish_commands(VkCommandBuffer commands)
{
    submit_commands(commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
}

void copy_image(VkCommandBuffer commands, VkImage image, VkImageLayout layout, VkDeviceSize offset)
{
    const VkBufferImageCopy region = {.bufferOffset = offset,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {WIDTH, HEIGHT, 1}};
    vkCmdCopyImageToBuffer(commands, image, layout, geometry.handle, 1, &region);
}

void run_parts(struct dt_vk_runtime *rt, uint32_t passes, uint8_t trail[TRAIL_BYTES])
{
    struct dt_vk_resource resource;
    for (uint32_t i = 0; i < 2; i++) {
        struct dt_frame frame = frame_of(i);
        VkCommandBuffer commands = new_commands();
        for (uint32_t pass = 0, end; pass < FEATURES_PASSES; pass = end) {
            end = FEATURES_PASSES - pass < passes ? FEATURES_PASSES : pass + passes;
            assert_true(dt_vk_record_passes(rt, commands, &frame, NULL, pass, end));
        }
        submit_commands(commands);
    }
    assert_true(dt_vk_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    assert_int_equal(resource.format, VK_FORMAT_R32G32B32A32_SFLOAT);
    assert_int_equal(resource.layout, VK_IMAGE_LAYOUT_GENERAL);
    assert_int_equal(resource.width, WIDTH);
    assert_int_equal(resource.height, HEIGHT);
    assert_int_equal(resource.layers, 1);
    assert_int_equal(resource.mips, 1);
    VkCommandBuffer commands = new_commands();
    copy_image(commands, resource.image, resource.layout, GEOMETRY_BYTES / 2);
    finish_commands(commands);
    memcpy(trail, (const char *)geometry.bytes + GEOMETRY_BYTES / 2, TRAIL_BYTES);
}

void run_frames(struct dt_vk_runtime *rt, uint8_t trail[TRAIL_BYTES])
{
    run_parts(rt, FEATURES_PASSES, trail);
}

struct dt_vk_runtime *open_features(void)
{
    struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), NULL);
    assert_true(dt_vk_import_scene(rt, &vk_scene));
    assert_true(dt_vk_create(rt, &features_vk));
    return rt;
}

void vulkan_draw(const struct dt_vk_scene *scene, uint8_t trail[TRAIL_BYTES])
{
    struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), NULL);
    assert_true(dt_vk_import_scene(rt, scene) && dt_vk_create(rt, &features_vk) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, trail);
    dt_vk_close(rt);
}

struct own_image create_image(const VkImageCreateInfo *info)
{
    struct own_image own = {0};
    VkMemoryRequirements needs;
    assert_int_equal(vkCreateImage(vk.device, info, NULL, &own.image), VK_SUCCESS);
    vkGetImageMemoryRequirements(vk.device, own.image, &needs);
    own.memory = renderer_allocate(&vk, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    assert_int_equal(vkBindImageMemory(vk.device, own.image, own.memory, 0), VK_SUCCESS);
    return own;
}

struct own_image make_image(VkFormat format, VkExtent3D extent, uint32_t layers,
                            VkImageUsageFlags usage)
{
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = format,
                                    .extent = extent,
                                    .mipLevels = 1,
                                    .arrayLayers = layers,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .usage = usage};
    struct own_image own = create_image(&info);
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = own.image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
        .format = format,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, layers}};
    assert_int_equal(vkCreateImageView(vk.device, &view, NULL, &own.view), VK_SUCCESS);
    return own;
}

struct dt_vk_image import_of(const struct own_image *own, VkFormat format, VkImageUsageFlags usage,
                             uint32_t width)
{
    return (struct dt_vk_image){.image = own->image,
                                .format = format,
                                .usage = usage,
                                .width = width,
                                .height = HEIGHT,
                                .layers = 1,
                                .mips = 1,
                                .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
}

void destroy_image(const struct own_image *own)
{
    vkDestroyImageView(vk.device, own->view, NULL);
    vkDestroyImage(vk.device, own->image, NULL);
    vkFreeMemory(vk.device, own->memory, NULL);
}

void move_image(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from,
        .newLayout = to,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

bool vulkan_writes(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    return dt_vk_write(outside.rt, outside.commands, resource, mip, bytes);
}

bool vulkan_records(void)
{
    struct dt_frame frame = frame_of(0);
    return dt_vk_record(outside.rt, outside.commands, &frame, NULL);
}

void record_picture(VkDeviceSize offset)
{
    struct dt_vk_resource picture = {0};
    assert_true(vulkan_records() &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture));
    copy_image(outside.commands, picture.image, picture.layout, offset);
}
