/* The libraries for other programs, as a program sees them: linked statically, on a device and in a
 * context of the test's own. A wrong call gives one message that names the thing, and a right call
 * after it succeeds. A frame that is never submitted leaves no trace. Validation, with
 * synchronization checking, stays silent. install_test.sh compares the pictures with those of the
 * command. */
#include <malloc.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include "features.h"
#include "layouts.h"
#include "outside.h"
#include "panel.h"
#include "shapes.h"
#include "runtime_gl/diptych_gl.h"
#include "runtime_vk/diptych_vk.h"
#include "scenes/diptych_scene.h"

enum { WIDTH = 24, HEIGHT = 16, TRAIL_BYTES = WIDTH * HEIGHT * 16, GEOMETRY_BYTES = 1 << 20 };

/* ---- Log ------------------------------------------------------------------------------------- */

static struct {
    int errors, warnings, validation;
    char text[2048]; /* of the last error or warning */
    char hazard[64]; /* kind of the last message of validation */
} heard;

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    heard.errors += level == DT_ERROR;
    heard.warnings += level == DT_WARNING;
    if (level >= DT_WARNING)
        snprintf(heard.text, sizeof heard.text, "%s", message);
}
static const struct dt_log test_log = {.message = on_log};

static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity, (void)types, (void)user;
    heard.validation++;
    snprintf(heard.hazard, sizeof heard.hazard, "%s",
             data->pMessageIdName ? data->pMessageIdName : "");
    print_message("%s\n", data->pMessage);
    return VK_FALSE;
}

/* The call must fail with exactly one error, which contains these words. */
#define REFUSED(call, words)                                                                       \
    do {                                                                                           \
        heard.errors = 0;                                                                          \
        assert_false(call);                                                                        \
        assert_int_equal(heard.errors, 1);                                                         \
        if (!strstr(heard.text, words))                                                            \
            fail_msg("\"%s\" lacks \"%s\"", heard.text, words);                                    \
    } while (0)

/* ---- A device of the test's own -------------------------------------------------------------- */

static struct {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceMemoryProperties memory;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkBuffer geometry;
    VkDeviceMemory geometry_memory;
    void *bytes;
    struct dt_vk_scene scene;
} vk;

static VkDeviceMemory allocate(VkMemoryRequirements needs, VkMemoryPropertyFlags wanted)
{
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .allocationSize = needs.size};
    VkDeviceMemory memory;
    while (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1) ||
           (vk.memory.memoryTypes[info.memoryTypeIndex].propertyFlags & wanted) != wanted)
        info.memoryTypeIndex++;
    assert_int_equal(vkAllocateMemory(vk.device, &info, NULL, &memory), VK_SUCCESS);
    return memory;
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
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message};
    assert_int_equal(vkCreateInstance(&info, NULL, &vk.instance), VK_SUCCESS);
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(vk.instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    assert_int_equal(create(vk.instance, &messenger, NULL, &vk.messenger), VK_SUCCESS);
}

static void open_device(void)
{
    VkPhysicalDeviceVulkan13Features vulkan13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features vulkan12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &vulkan13};
    VkPhysicalDeviceVulkan11Features vulkan11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &vulkan12};
    VkPhysicalDeviceFeatures core = {0};
    uint32_t count = 1;
    assert_true(vkEnumeratePhysicalDevices(vk.instance, &count, &vk.physical) >= 0 && count);
    vkGetPhysicalDeviceMemoryProperties(vk.physical, &vk.memory);
    dt_vk_need_features(&features_vk, &core, &vulkan11, &vulkan12, &vulkan13);
    dt_vk_need_features(&shapes_vk, &core, &vulkan11, &vulkan12, &vulkan13);
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueCount = 1,
                                           .pQueuePriorities = &(float){1}};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = &vulkan11,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .pEnabledFeatures = &core};
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    assert_int_equal(vkCreateDevice(vk.physical, &info, NULL, &vk.device), VK_SUCCESS);
    vkGetDeviceQueue(vk.device, 0, 0, &vk.queue);
    assert_int_equal(vkCreateCommandPool(vk.device, &pool, NULL, &vk.pool), VK_SUCCESS);
}

/* One buffer for all: a triangle, then the bytes that are read back. */
static void make_geometry(void)
{
    static const float corners[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = GEOMETRY_BYTES,
        .usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkMemoryRequirements needs;
    assert_int_equal(vkCreateBuffer(vk.device, &info, NULL, &vk.geometry), VK_SUCCESS);
    vkGetBufferMemoryRequirements(vk.device, vk.geometry, &needs);
    vk.geometry_memory =
        allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    assert_int_equal(vkBindBufferMemory(vk.device, vk.geometry, vk.geometry_memory, 0), VK_SUCCESS);
    assert_int_equal(vkMapMemory(vk.device, vk.geometry_memory, 0, VK_WHOLE_SIZE, 0, &vk.bytes),
                     VK_SUCCESS);
    struct dt_vertex *vertices = vk.bytes;
    uint32_t *indices = (uint32_t *)((char *)vk.bytes + 4096);
    memset(vk.bytes, 0, GEOMETRY_BYTES);
    for (uint32_t i = 0; i < 3; i++) {
        vertices[i] =
            (struct dt_vertex){.position = {corners[i][0], corners[i][1], 0}, .normal = {0, 0, 1}};
        indices[i] = i;
    }
    vk.scene = (struct dt_vk_scene){
        .vertices = {vk.geometry, 0, 3 * sizeof *vertices},
        .indices = {vk.geometry, 4096, 3 * sizeof *indices},
        .index_count = 3,
        .materials = {vk.geometry, 8192, DT_MAX_MATERIALS * sizeof(struct dt_material)},
        .objects = {vk.geometry, 81920, sizeof(struct dt_object)},
        .numbered = true};
}

static int open_vulkan(void **state)
{
    (void)state;
    open_instance();
    open_device();
    make_geometry();
    return 0;
}

/* Like open_vulkan, but validation checks for hazards between command buffers, too. */
static int open_vulkan_for_flight(void **state)
{
    setenv("VK_LAYER_ENABLES",
           "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
           "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
           1);
    return open_vulkan(state);
}

static int close_vulkan(void **state)
{
    (void)state;
    PFN_vkDestroyDebugUtilsMessengerEXT destroy =
        (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            vk.instance, "vkDestroyDebugUtilsMessengerEXT");
    vkDestroyBuffer(vk.device, vk.geometry, NULL);
    vkFreeMemory(vk.device, vk.geometry_memory, NULL);
    vkDestroyCommandPool(vk.device, vk.pool, NULL);
    vkDestroyDevice(vk.device, NULL);
    destroy(vk.instance, vk.messenger, NULL);
    vkDestroyInstance(vk.instance, NULL);
    return heard.validation; /* includes objects that pipelines left behind */
}

static struct dt_vk_host vk_host(void)
{
    return (struct dt_vk_host){.log = test_log,
                               .instance = vk.instance,
                               .physical_device = vk.physical,
                               .device = vk.device,
                               .get_instance_proc_addr = vkGetInstanceProcAddr,
                               .labels = true};
}

static VkCommandBuffer begin(void)
{
    const VkCommandBufferAllocateInfo info = {.sType =
                                                  VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = vk.pool,
                                              .commandBufferCount = 1};
    const VkCommandBufferBeginInfo start = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkCommandBuffer commands;
    assert_int_equal(vkAllocateCommandBuffers(vk.device, &info, &commands), VK_SUCCESS);
    assert_int_equal(vkBeginCommandBuffer(commands, &start), VK_SUCCESS);
    return commands;
}

static void submit(VkCommandBuffer commands)
{
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .commandBufferCount = 1,
                               .pCommandBuffers = &commands};
    assert_int_equal(vkEndCommandBuffer(commands), VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(vk.queue, 1, &info, VK_NULL_HANDLE), VK_SUCCESS);
}

static struct dt_frame frame_of(uint32_t index)
{
    struct dt_frame frame = {.scene_radius = 1, .index = index, .triangle_count = 1};
    for (int i = 0; i < 4; i++)
        frame.camera.view[i][i] = frame.camera.projection[i][i] =
            frame.camera.view_projection[i][i] = frame.camera.inverse_view_projection[i][i] =
                frame.light_view.view[i][i] = frame.light_view.projection[i][i] =
                    frame.light_view.view_projection[i][i] =
                        frame.light_view.inverse_view_projection[i][i] = 1;
    return frame;
}

/* Validation reports a view whose usage the image lacks. */
static void assert_can_sample_images(struct dt_vk_runtime *rt)
{
    const VkImageViewUsageCreateInfo usage = {.sType =
                                                  VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO,
                                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT};
    for (uint32_t i = 0; i < FEATURES_RESOURCES; i++) {
        struct dt_vk_resource resource;
        VkImageView view;
        const struct dt_resource *what = &features_pipeline.resources[i];
        if (!what->history && !what->keep && (int)i != features_pipeline.linear_output &&
            (int)i != features_pipeline.display_output) {
            REFUSED(dt_vk_get_resource(rt, i, &resource), "give it `keep: true` in the spec");
            continue;
        }
        assert_true(dt_vk_get_resource(rt, i, &resource));
        const VkImageViewCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
            .pNext = &usage,
            .image = resource.image,
            .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
            .format = resource.format,
            .subresourceRange = {resource.format == VK_FORMAT_D32_SFLOAT
                                     ? VK_IMAGE_ASPECT_DEPTH_BIT
                                     : VK_IMAGE_ASPECT_COLOR_BIT,
                                 0, resource.mips, 0, resource.layers}};
        if (!resource.image)
            continue;
        assert_true(resource.usage & VK_IMAGE_USAGE_SAMPLED_BIT);
        assert_int_equal(vkCreateImageView(vk.device, &info, NULL, &view), VK_SUCCESS);
        vkDestroyImageView(vk.device, view, NULL);
    }
}

/* Records two frames in flight, in parts of `passes` passes each. `trail`: the trail after both. */
static void run_parts(struct dt_vk_runtime *rt, uint32_t passes, uint8_t trail[TRAIL_BYTES])
{
    struct dt_vk_resource resource;
    for (uint32_t i = 0; i < 2; i++) {
        struct dt_frame frame = frame_of(i);
        VkCommandBuffer commands = begin();
        for (uint32_t pass = 0, end; pass < FEATURES_PASSES; pass = end) {
            end = FEATURES_PASSES - pass < passes ? FEATURES_PASSES : pass + passes;
            assert_true(dt_vk_record_passes(rt, commands, &frame, NULL, pass, end));
        }
        submit(commands);
    }
    assert_true(dt_vk_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    assert_int_equal(resource.format, VK_FORMAT_R32G32B32A32_SFLOAT);
    assert_int_equal(resource.layout, VK_IMAGE_LAYOUT_GENERAL);
    assert_int_equal(resource.width, WIDTH);
    assert_int_equal(resource.height, HEIGHT);
    assert_int_equal(resource.layers, 1);
    assert_int_equal(resource.mips, 1);
    const VkBufferImageCopy region = {.bufferOffset = GEOMETRY_BYTES / 2,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {WIDTH, HEIGHT, 1}};
    VkCommandBuffer commands = begin();
    vkCmdCopyImageToBuffer(commands, resource.image, resource.layout, vk.geometry, 1, &region);
    submit(commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    memcpy(trail, (const char *)vk.bytes + GEOMETRY_BYTES / 2, TRAIL_BYTES);
}

static void run_frames(struct dt_vk_runtime *rt, uint8_t trail[TRAIL_BYTES])
{
    run_parts(rt, FEATURES_PASSES, trail);
}

static struct dt_vk_runtime *open_features(void)
{
    struct dt_vk_host host = vk_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_non_null(rt);
    assert_true(dt_vk_import_scene(rt, &vk.scene));
    assert_true(dt_vk_create(rt, &features_vk));
    return rt;
}

/* ---- Inputs ---------------------------------------------------------------------------------- */

typedef bool write_content(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);

static struct dt_bytes bytes_of(uint32_t resource, uint32_t mip)
{
    const struct dt_resource *input = &outside_pipeline.resources[resource];
    struct dt_bytes bytes = {0};
    size_t texel = input->kind == DT_BUFFER             ? input->stride
                   : input->format == DT_FORMAT_RGBA16F ? 8
                                                        : 4;
    outside_pipeline.extent(&outside_pipeline, resource, WIDTH, HEIGHT, bytes.extent);
    for (int i = 0; i < 2 && input->kind == DT_IMAGE; i++)
        bytes.extent[i] >>= mip;
    bytes.size = texel * bytes.extent[0] * bytes.extent[1] * bytes.extent[2];
    bytes.data = calloc(1, bytes.size);
    assert_non_null(bytes.data);
    return bytes;
}

/* Fills the table of colours with one colour. */
static void write_grade(write_content *write, const uint8_t color[4])
{
    struct dt_bytes grade = bytes_of(OUTSIDE_RESOURCE_GRADE, 0);
    for (size_t i = 0; i < grade.size; i++)
        grade.data[i] = color[i % 4];
    assert_true(write(OUTSIDE_RESOURCE_GRADE, 0, &grade));
    free(grade.data);
}

static const float graded_alone[8] = {1, 1, 1}, nothing[8]; /* weights; a vec3 has four */

/* Writes content for all inputs but the table and the `imported` one. The `imported` input refuses
 * content. */
static void write_inputs(write_content *write, uint32_t imported)
{
    for (uint32_t i = 0; i < OUTSIDE_RESOURCES; i++) {
        const struct dt_resource *input = &outside_pipeline.resources[i];
        for (uint32_t mip = 0; mip < (input->kind == DT_IMAGE ? input->mips : 1); mip++) {
            struct dt_bytes bytes = bytes_of(i, mip);
            if (i == OUTSIDE_RESOURCE_WEIGHTS)
                memcpy(bytes.data, graded_alone, sizeof graded_alone);
            if (!input->input)
                REFUSED(write(i, mip, &bytes), "a host writes inputs only");
            else if (i == imported)
                REFUSED(write(i, mip, &bytes), "it is imported; write the host's own object");
            else if (i != OUTSIDE_RESOURCE_GRADE)
                assert_true(write(i, mip, &bytes));
            free(bytes.data);
        }
    }
}

/* Writes content for all inputs, the table last. The picture then has the table's colour. `reads`,
 * a frame, must fail before. */
static void hand_in(write_content *write, bool (*reads)(void), const uint8_t color[4])
{
    write_inputs(write, OUTSIDE_RESOURCES);
    REFUSED(reads(), "mip 0 of the input grade has no content; write it after resize");
    struct dt_bytes wrong = bytes_of(OUTSIDE_RESOURCE_WEIGHTS, 0);
    wrong.size -= 4;
    REFUSED(write(OUTSIDE_RESOURCE_WEIGHTS, 0, &wrong), "write weights: 28 bytes of 2x1x1 given");
    REFUSED(write(OUTSIDE_RESOURCE_SOFT, 3, &wrong), "write soft: mip 3, and it has 3");
    free(wrong.data);
    write_grade(write, color);
}

/* Without the blurred picture the frame is black; with a blurred picture of ones it is white. */
static void write_for_blurred(write_content *write)
{
    const float blurred_alone[8] = {0, 0, 0, 0, 1, 1, 1};
    struct dt_bytes weights = bytes_of(OUTSIDE_RESOURCE_WEIGHTS, 0);
    struct dt_bytes soft = bytes_of(OUTSIDE_RESOURCE_SOFT, 2);
    write_inputs(write, OUTSIDE_RESOURCES);
    write_grade(write, (const uint8_t[]){0, 0, 0, 0});
    for (size_t i = 1; i < soft.size; i += 2)
        soft.data[i] = 0x3c; /* 0x3c00: 1 */
    memcpy(weights.data, blurred_alone, sizeof blurred_alone);
    assert_true(write(OUTSIDE_RESOURCE_WEIGHTS, 0, &weights) &&
                write(OUTSIDE_RESOURCE_SOFT, 2, &soft));
    free(weights.data);
    free(soft.data);
}

static void is_painted(const uint8_t *texels, const uint8_t color[4])
{
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
        if (texels[i] != color[i % 4])
            fail_msg("texel %d.%d is %d, not %d", i / 4, i % 4, texels[i], color[i % 4]);
}

static const uint8_t first_color[4] = {10, 200, 30, 255}, second_color[4] = {77, 0, 255, 255},
                     black[4] = {0, 0, 0, 255}, white[4] = {255, 255, 255, 255};

/* ---- Vulkan ---------------------------------------------------------------------------------- */

static void vulkan_tells_wrong_hosts(void **state)
{
    (void)state;
    struct dt_vk_host host = vk_host();
    host.device = VK_NULL_HANDLE;
    REFUSED(dt_vk_open(&host), "device");
    host = vk_host();
    host.queue_family = 99;
    REFUSED(dt_vk_open(&host), "queue family 99");
    host.log.message = NULL;
    assert_null(dt_vk_open(&host)); /* in silence */
    dt_vk_close(NULL);
}

/* dt_vk_suits works without a VkDevice. */
static void vulkan_tells_which_device_suits(void **state)
{
    (void)state;
    struct dt_vk_host host = {.log = test_log,
                              .instance = vk.instance,
                              .physical_device = vk.physical,
                              .get_instance_proc_addr = vkGetInstanceProcAddr};
    const struct dt_need need = {FEATURES_PASS_SLICE, "shaderClairvoyance"};
    struct dt_panel panel = features_panel;
    const struct dt_shaders needy = {"vk", &panel, features_vk.stages};
    assert_true(dt_vk_suits(&host, &features_vk) && dt_vk_suits(&host, &shapes_vk));
    panel.needs = &need;
    panel.need_count = 1;
    REFUSED(dt_vk_suits(&host, &needy),
            "pipeline features: missing shaderClairvoyance (pass slice); use another device");
    panel.version += 1000000;
    REFUSED(dt_vk_suits(&host, &needy), "generate the pipeline again");
    host.physical_device = NULL;
    REFUSED(dt_vk_suits(&host, &features_vk), "must be given");
}

/* Only the host knows the features that its device was created with. Here the host describes them
 * wrongly. */
static void vulkan_checks_enabled_features(void **state)
{
    (void)state;
    struct dt_vk_host host = vk_host();
    VkPhysicalDeviceDynamicRenderingFeatures rendering = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES};
    VkPhysicalDeviceVulkan13Features vulkan13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, .pNext = &rendering};
    VkPhysicalDeviceVulkan12Features vulkan12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &vulkan13};
    VkPhysicalDeviceVulkan11Features vulkan11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &vulkan12};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                          .pNext = &vulkan11};
    const struct dt_need need = {FEATURES_PASS_SLICE, "samplerAnisotropy"};
    struct dt_panel panel = features_panel;
    const struct dt_shaders needy = {"vk", &panel, features_vk.stages};
    panel.needs = &need;
    panel.need_count = 1;
    dt_vk_need_features(&needy, &features.features, &vulkan11, &vulkan12, &vulkan13);
    vulkan13.dynamicRendering = VK_FALSE;
    host.device_info = &(const VkDeviceCreateInfo){.pNext = &features};
    REFUSED(dt_vk_open(&host), "created without dynamicRendering; enable all");
    rendering.dynamicRendering = VK_TRUE;
    features.features.samplerAnisotropy = VK_FALSE;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_non_null(rt);
    REFUSED(dt_vk_create(rt, &needy), "pass slice: needs samplerAnisotropy, which ");
    assert_non_null(strstr(heard.text, " has, but was created without; enable all"));
    dt_vk_close(rt);
    features.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO; /* only pEnabledFeatures counts */
    host.device_info = &(const VkDeviceCreateInfo){
        .pNext = &features,
        .pEnabledFeatures = &(VkPhysicalDeviceFeatures){.samplerAnisotropy = 1}};
    rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_create(rt, &needy));
    dt_vk_close(rt);
}

static const struct dt_frame empty;

/* As if the pass `keep` read vertex_triangle. */
static struct dt_panel features_with_numbers(struct dt_program programs[FEATURES_PASSES])
{
    struct dt_panel panel = features_panel;
    memcpy(programs, panel.programs, FEATURES_PASSES * sizeof *programs);
    programs[FEATURES_PASS_KEEP].attributes |= 1 << DT_TRIANGLE;
    panel.programs = programs;
    return panel;
}

static void vulkan_tells_wrong_calls(void **state)
{
    (void)state;
    struct dt_vk_host host = vk_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    struct dt_frame frame = frame_of(0);
    struct dt_vk_scene scene = vk.scene;
    struct dt_vk_image image = {.image = (VkImage)&heard /* no image, and never used as one */,
                                .width = 5};
    struct dt_vk_resource resource;
    double ms[FEATURES_PASSES];
    assert_non_null(rt);
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "import_scene");
    REFUSED(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image), "create comes first");
    REFUSED(dt_vk_create(rt, &features_gl), "the shaders are for gl; give features_vk");
    const struct dt_need future = {FEATURES_PASS_SLICE, "rayTracing"};
    struct dt_panel panel = features_panel;
    const struct dt_shaders needy = {"vk", &panel, features_vk.stages};
    struct dt_program programs[FEATURES_PASSES];
    panel.needs = &future;
    panel.need_count = 1;
    REFUSED(dt_vk_create(rt, &needy), "pass slice: needs rayTracing, which ");
    const struct dt_demand much = {FEATURES_PASS_SLICE, DT_LIMIT_SHARED_BYTES, 1 << 30};
    panel = features_panel;
    panel.demands = &much;
    panel.demand_count = 1;
    REFUSED(dt_vk_create(rt, &needy),
            "pass slice needs 1,073,741,824 bytes of shared memory; the device ");
    scene.index_count = 4;
    REFUSED(dt_vk_import_scene(rt, &scene), "4 indices");
    scene = vk.scene;
    scene.vertices.offset = 1;
    REFUSED(dt_vk_import_scene(rt, &scene), "scene_vertices");
    scene = vk.scene;
    scene.materials.size = 32;
    REFUSED(dt_vk_import_scene(rt, &scene), "scene_materials");
    scene = vk.scene;
    scene.objects.buffer = VK_NULL_HANDLE;
    assert_true(dt_vk_import_scene(rt, &scene));
    assert_true(dt_vk_create(rt, &features_vk));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "the pass keep reads scene_objects");
    scene = vk.scene;
    scene.numbered = false;
    panel = features_with_numbers(programs);
    assert_true(dt_vk_create(rt, &needy) && dt_vk_import_scene(rt, &scene));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "reads vertex_triangle; number the triangles");
    assert_true(dt_vk_create(rt, &features_vk));
    assert_true(dt_vk_import_scene(rt, &vk.scene));
    REFUSED(dt_vk_record(rt, VK_NULL_HANDLE, &frame, NULL), "call resize first");
    REFUSED(dt_vk_get_resource(rt, 0, &resource), "resize comes first");
    REFUSED(dt_vk_resize(rt, 0, HEIGHT), "frame of 0x16");
    REFUSED(dt_vk_import_image(rt, FEATURES_RESOURCE_MEMORY, &image), "no image");
    REFUSED(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image), "which the layout_before");
    image.layout_before = VK_IMAGE_LAYOUT_GENERAL;
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "image trail: imported with VkFormat");
    image = (struct dt_vk_image){.image = image.image,
                                 .layout_before = VK_IMAGE_LAYOUT_GENERAL,
                                 .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                 .width = WIDTH,
                                 .height = HEIGHT,
                                 .layers = 1,
                                 .mips = 1};
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "usage 0x0");
    image.image = VK_NULL_HANDLE; /* cancels the import */
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &image));
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    REFUSED(dt_vk_timings(rt, 0, ms), "timing");
    REFUSED(dt_vk_record(rt, VK_NULL_HANDLE, &empty, NULL),
            "`camera` of the struct dt_frame is zero");
    uint8_t trail[TRAIL_BYTES];
    run_frames(rt, trail);
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

static void vulkan_forgets_what_was_not_submitted(void **state)
{
    (void)state;
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES], zero[TRAIL_BYTES];
    struct dt_vk_runtime *rt = open_features();
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, wanted);
    assert_can_sample_images(rt);
    assert_memory_not_equal(wanted, zero, TRAIL_BYTES);
    run_frames(rt, found); /* the trail continues */
    assert_memory_not_equal(wanted, found, TRAIL_BYTES);
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    struct dt_frame frame = frame_of(7);
    assert_true(dt_vk_record(rt, begin(), &frame, NULL)); /* never submitted */
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

/* ---- Vertices of another layout -------------------------------------------------------------- */

enum { OWN_POSITIONS = 98304, OWN_REST = OWN_POSITIONS + 256, OWN_BYTES = 24 };
static const uint32_t own_places[] = {[DT_NORMAL] = 0, [DT_UV] = 12, [DT_MATERIAL] = 20};

/* The triangle once more: positions 16 bytes apart; normal, uv and material in 24 bytes. */
static void lay_out(float normal_x)
{
    const struct dt_vertex *vertices = vk.bytes;
    char *bytes = vk.bytes;
    for (uint32_t i = 0; i < 3; i++) {
        char *rest = bytes + OWN_REST + i * (size_t)OWN_BYTES;
        memcpy(bytes + OWN_POSITIONS + 16 * i, vertices[i].position, 12);
        memcpy(rest, vertices[i].normal, 12);
        memcpy(rest, &normal_x, 4);
        memcpy(rest + 12, vertices[i].uv, 8);
        memcpy(rest + 20, &vertices[i].material, 4);
    }
}

static void vulkan_draw(const struct dt_vk_scene *scene, uint8_t trail[TRAIL_BYTES])
{
    struct dt_vk_host host = vk_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_import_scene(rt, scene) && dt_vk_create(rt, &features_vk) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, trail);
    dt_vk_close(rt);
}

static void vulkan_draws_vertices_of_another_layout(void **state)
{
    (void)state;
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    struct dt_vk_scene scene = vk.scene;
    scene.vertices = (struct dt_vk_range){VK_NULL_HANDLE, 0, 0};
    scene.attributes[DT_POSITION] = (struct dt_vk_attribute){vk.geometry, OWN_POSITIONS, 16};
    for (int i = DT_NORMAL; i <= DT_MATERIAL; i++)
        scene.attributes[i] =
            (struct dt_vk_attribute){vk.geometry, OWN_REST + own_places[i], OWN_BYTES};
    vulkan_draw(&vk.scene, wanted);
    lay_out(0);
    vulkan_draw(&scene, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    lay_out(1); /* other normals */
    vulkan_draw(&scene, found);
    assert_memory_not_equal(wanted, found, TRAIL_BYTES);
    assert_int_equal(heard.validation, 0);

    struct dt_vk_runtime *rt = open_features();
    scene.attributes[DT_NORMAL].buffer = VK_NULL_HANDLE;
    assert_true(dt_vk_import_scene(rt, &scene));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "the pass scene reads vertex_normal");
    scene.attributes[DT_UV].stride = 6;
    REFUSED(dt_vk_import_scene(rt, &scene), "vertex_uv: offset 98572 and stride 6");
    dt_vk_close(rt);
}

/* Records an indirect draw with the scene's own indices; `features` has no such draw. */
static bool record_scene_indirect(const struct dt_recording *r)
{
    return r->verbs->begin(r->runtime, FEATURES_PASS_HALVES, true) &&
           r->verbs->draw_indirect(r->runtime, FEATURES_PASS_HALVES, 1, DT_SCENE_INDICES,
                                   FEATURES_RESOURCE_DRAW_ARGUMENTS);
}

/* lavapipe (22.3.6) counts the indices of an indirect draw from the start of their buffer, and
 * ignores the offset of the binding. The runtime refuses the scene of these tests there, since its
 * indices stand behind its vertices. */
static void vulkan_refuses_indices_that_lavapipe_would_miss(void **state)
{
    (void)state;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(vk.physical, &properties);
    if (strncmp(properties.deviceName, "llvmpipe", 8) != 0)
        skip();
    struct dt_panel panel = features_panel;
    const struct dt_shaders indirect = {"vk", &panel, features_vk.stages};
    panel.record = record_scene_indirect;
    struct dt_vk_host host = vk_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    struct dt_frame frame = frame_of(0);
    assert_true(dt_vk_import_scene(rt, &vk.scene));
    assert_true(dt_vk_create(rt, &indirect));
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    REFUSED(dt_vk_record(rt, begin(), &frame, NULL),
            "pass halves: scene indices at byte 4096, but indirect draws of llvmpipe");
    REFUSED(dt_vk_record(rt, begin(), &frame, NULL), "call resize first");
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

/* The image `trail` after frames, a resize, and the same frames again. */
static void vulkan_trail(bool keeps, uint32_t width, uint8_t trail[TRAIL_BYTES])
{
    struct dt_vk_host host = vk_host();
    host.keep_history = keeps;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_import_scene(rt, &vk.scene) && dt_vk_create(rt, &features_vk) &&
                dt_vk_resize(rt, width, HEIGHT));
    if (width == WIDTH)
        run_frames(rt, trail);
    assert_true(dt_vk_create(rt, &features_vk) && dt_vk_resize(rt, WIDTH, HEIGHT) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, trail);
    dt_vk_close(rt);
}

static void vulkan_keeps_history(void **state)
{
    (void)state;
    static uint8_t twice[TRAIL_BYTES], found[TRAIL_BYTES];
    struct dt_vk_runtime *rt = open_features();
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, found);
    run_frames(rt, twice);
    dt_vk_close(rt);
    vulkan_trail(true, WIDTH, found);
    assert_memory_equal(found, twice, TRAIL_BYTES);
    vulkan_trail(true, 2 * WIDTH, found); /* another size */
    assert_memory_not_equal(found, twice, TRAIL_BYTES);
    vulkan_trail(false, WIDTH, found);
    assert_memory_not_equal(found, twice, TRAIL_BYTES);
    assert_int_equal(heard.validation, 0);
}

static void vulkan_takes_times(void **state)
{
    (void)state;
    static uint8_t trail[TRAIL_BYTES];
    struct dt_vk_host host = vk_host();
    double ms[FEATURES_PASSES], sum = 0;
    host.timing = true;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(dt_vk_import_scene(rt, &vk.scene) && dt_vk_create(rt, &features_vk) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, trail);
    assert_true(dt_vk_timings(rt, 0, ms));
    for (int i = 0; i < FEATURES_PASSES; i++)
        sum += isnan(ms[i]) ? 0 : ms[i];
    assert_true(sum > 0 && sum < 1e5);
    dt_vk_close(rt);
}

static void vulkan_needs_no_scene_that_nobody_sees(void **state)
{
    (void)state;
    struct dt_vk_host host = vk_host();
    struct dt_frame frame = frame_of(0);
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_create(rt, &layouts_vk) && dt_vk_resize(rt, WIDTH, HEIGHT));
    VkCommandBuffer commands = begin();
    assert_true(dt_vk_record(rt, commands, &frame, NULL));
    submit(commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    REFUSED(!dt_vk_create(rt, &features_vk) || dt_vk_resize(rt, WIDTH, HEIGHT), "import_scene");
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

/* An image of the host's own, of one mip. */
struct own_image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view; /* as an array */
};

/* Creates the image without a view. */
static struct own_image create_image(const VkImageCreateInfo *info)
{
    struct own_image own = {0};
    VkMemoryRequirements needs;
    assert_int_equal(vkCreateImage(vk.device, info, NULL, &own.image), VK_SUCCESS);
    vkGetImageMemoryRequirements(vk.device, own.image, &needs);
    own.memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    assert_int_equal(vkBindImageMemory(vk.device, own.image, own.memory, 0), VK_SUCCESS);
    return own;
}

static struct own_image make_image(VkFormat format, VkExtent3D extent, uint32_t layers,
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

static void destroy_image(const struct own_image *own)
{
    vkDestroyImageView(vk.device, own->view, NULL);
    vkDestroyImage(vk.device, own->image, NULL);
    vkFreeMemory(vk.device, own->memory, NULL);
}

static void move_image(VkCommandBuffer commands, VkImage image, VkImageLayout from,
                       VkImageLayout to)
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

/* Two layers of one sRGB texel each. */
static struct own_image make_textures(const uint8_t texels[2][4])
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const VkBufferImageCopy region = {.bufferOffset = GEOMETRY_BYTES / 2,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 2},
                                      .imageExtent = {1, 1, 1}};
    struct own_image own = make_image(VK_FORMAT_R8G8B8A8_SRGB, region.imageExtent, 2, usage);
    VkCommandBuffer commands = begin();
    memcpy((char *)vk.bytes + region.bufferOffset, texels, 8);
    move_image(commands, own.image, VK_IMAGE_LAYOUT_UNDEFINED,
               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdCopyBufferToImage(commands, vk.geometry, own.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                           1, &region);
    move_image(commands, own.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    submit(commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    return own;
}

/* Renders a frame. Every texel in the host's `color` must have these codes, within 2 for
 * rounding. */
static void draws(struct dt_vk_runtime *rt, const struct own_image *color, const double codes[3])
{
    const VkBufferImageCopy region = {.bufferOffset = GEOMETRY_BYTES / 2,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {WIDTH, HEIGHT, 1}};
    struct dt_frame frame = frame_of(0);
    VkCommandBuffer commands = begin();
    assert_true(dt_vk_record(rt, commands, &frame, NULL));
    vkCmdCopyImageToBuffer(commands, color->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           vk.geometry, 1, &region);
    submit(commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    const uint8_t *texels = (const uint8_t *)vk.bytes + region.bufferOffset;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            if (fabs(texels[4 * i + c] - codes[c]) > 2)
                fail_msg("texel %d.%d is %d, not %g", i, c, texels[4 * i + c], codes[c]);
}

/* The linear value of an 8 bit code by IEC 61966-2-1, also from 0 to 255. */
static double linear(double code)
{
    return 255 * pow((code / 255 + 0.055) / 1.055, 2.4);
}

static void vulkan_draws_the_hosts_textures(void **state)
{
    (void)state;
    static const uint8_t texels[2][4] = {{250, 60, 60, 255}, {60, 188, 120, 255}};
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const struct own_image textures = make_textures(texels);
    const struct own_image color =
        make_image(VK_FORMAT_R8G8B8A8_UNORM, (VkExtent3D){WIDTH, HEIGHT, 1}, 1, usage);
    const struct dt_vk_image target = {.image = color.image,
                                       .format = VK_FORMAT_R8G8B8A8_UNORM,
                                       .usage = usage,
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .layers = 1,
                                       .mips = 1,
                                       .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    struct dt_material *material = (struct dt_material *)((char *)vk.bytes + 8192);
    struct dt_vk_runtime *rt = open_features();
    struct dt_vk_scene scene = vk.scene;
    *material = (struct dt_material){.albedo = {1, 0.5f, 1}, .texture = 1};
    scene.textures = textures.view;
    assert_true(dt_vk_import_scene(rt, &scene) &&
                dt_vk_import_image(rt, FEATURES_RESOURCE_COLOR, &target) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    draws(rt, &color, (double[]){linear(60), linear(188) / 2, linear(120)});
    material->texture = 0; /* the next frame sees it */
    draws(rt, &color, (double[]){linear(250), linear(60) / 2, linear(60)});
    material->texture = -1;
    draws(rt, &color, (double[]){255, 127.5, 255});
    material->texture = 1; /* without textures, the colour is white */
    assert_true(dt_vk_import_scene(rt, &vk.scene) && dt_vk_resize(rt, WIDTH, HEIGHT));
    draws(rt, &color, (double[]){255, 127.5, 255});
    dt_vk_close(rt);
    destroy_image(&textures); /* the runtime did not destroy them */
    destroy_image(&color);
    memset(material, 0, sizeof *material);
    assert_int_equal(heard.validation, 0);
}

/* The last texel of the fog of tests/specs/shapes.yaml: (7/8, 5/6, 4/5, 7 ^ 5 ^ 4 & 1), as halves. */
static void is_last_fog(const uint16_t texel[4])
{
    const uint16_t wanted[4] = {0x3b00, 0x3aaa, 0x3a66, 0};
    for (int i = 0; i < 4; i++)
        assert_in_range(texel[i] + 1, wanted[i], wanted[i] + 2);
}

/* A 3D image and a cube of the host's. */
static void vulkan_takes_3d_images_and_cubes(void **state)
{
    (void)state;
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_3D,
                              .format = VK_FORMAT_R16G16B16A16_SFLOAT,
                              .extent = {8, 6, 5},
                              .mipLevels = 3,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                       VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    struct own_image fog = create_image(&info);
    info.flags = VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.extent = (VkExtent3D){8, 8, 1};
    info.mipLevels = 2;
    info.arrayLayers = 6;
    struct own_image sky = create_image(&info);
    struct dt_vk_image given = {.image = fog.image,
                                .format = info.format,
                                .usage = info.usage,
                                .width = 8,
                                .height = 6,
                                .layers = 1,
                                .mips = 3,
                                .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    struct dt_vk_host host = vk_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_create(rt, &shapes_vk));
    assert_true(dt_vk_import_image(rt, SHAPES_RESOURCE_FOG, &given));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "8x6 texels, 1 layers, 3 mips, but the pipeline");
    given.layers = 5;
    assert_true(dt_vk_import_image(rt, SHAPES_RESOURCE_FOG, &given));
    given.image = sky.image, given.height = 8, given.layers = 6, given.mips = 2;
    assert_true(dt_vk_import_image(rt, SHAPES_RESOURCE_SKY, &given));
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    const VkBufferImageCopy region = {.bufferOffset = GEOMETRY_BYTES / 2,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {8, 6, 5}};
    struct dt_frame frame = frame_of(0);
    VkCommandBuffer commands = begin();
    assert_true(dt_vk_record(rt, commands, &frame, NULL));
    vkCmdCopyImageToBuffer(commands, fog.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, vk.geometry,
                           1, &region);
    submit(commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    is_last_fog((const uint16_t *)((char *)vk.bytes + region.bufferOffset) + 4 * (8 * 6 * 5 - 1));
    dt_vk_close(rt);
    destroy_image(&fog);
    destroy_image(&sky);
    assert_int_equal(heard.validation, 0);
}

static struct {
    struct dt_vk_runtime *rt;
    VkCommandBuffer commands;
} outside;

static bool vulkan_writes(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    return dt_vk_write(outside.rt, outside.commands, resource, mip, bytes);
}

static bool vulkan_records(void)
{
    struct dt_frame frame = frame_of(0);
    return dt_vk_record(outside.rt, outside.commands, &frame, NULL);
}

/* Records a frame, and a copy of its picture to `offset` in the geometry's buffer. */
static void record_picture(VkDeviceSize offset)
{
    struct dt_vk_resource picture = {0};
    assert_true(vulkan_records() &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture));
    const VkBufferImageCopy region = {.bufferOffset = offset,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {WIDTH, HEIGHT, 1}};
    vkCmdCopyImageToBuffer(outside.commands, picture.image, picture.layout, vk.geometry, 1,
                           &region);
}

/* If content is replaced between two frames of one command buffer, only the second frame has the
 * new content. */
static void vulkan_takes_inputs(void **state)
{
    (void)state;
    enum { FIRST = GEOMETRY_BYTES / 2, SECOND = FIRST + 4 * WIDTH * HEIGHT };
    struct dt_vk_host host = vk_host();
    outside.rt = dt_vk_open(&host);
    assert_true(outside.rt && dt_vk_create(outside.rt, &outside_vk));
    const struct dt_vk_image image = {.image = (VkImage)&heard /* never used as one */};
    REFUSED(dt_vk_import_image(outside.rt, OUTSIDE_RESOURCE_PHOTO, &image),
            "which the layout_before");    /* no import: hand_in writes the photo */
    for (int turn = 0; turn < 2; turn++) { /* a resize drops all content */
        assert_true(dt_vk_resize(outside.rt, WIDTH, HEIGHT));
        outside.commands = begin();
        REFUSED(vulkan_records(), "mip 0 of the input kernel has no content");
        hand_in(vulkan_writes, vulkan_records, first_color);
        record_picture(FIRST);
        write_grade(vulkan_writes, second_color);
        record_picture(SECOND);
        submit(outside.commands);
        assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
        is_painted((const uint8_t *)vk.bytes + FIRST, first_color);
        is_painted((const uint8_t *)vk.bytes + SECOND, second_color);
    }
    dt_vk_close(outside.rt);
    assert_int_equal(heard.validation, 0);
}

/* Renders with these weights in the host's buffer; the picture must have this colour. */
static void vulkan_paints_with(const float weights[8], VkDeviceSize at, const uint8_t color[4])
{
    memcpy((char *)vk.bytes + at, weights, sizeof graded_alone);
    record_picture(GEOMETRY_BYTES / 2);
    submit(outside.commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    is_painted((const uint8_t *)vk.bytes + GEOMETRY_BYTES / 2, color);
}

static void vulkan_takes_buffers_and_describes_all(void **state)
{
    (void)state;
    const VkImageUsageFlags drawn = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    struct dt_vk_range weights = {vk.geometry, GEOMETRY_BYTES / 4, 16};
    struct dt_vk_host host = vk_host();
    struct dt_vk_resource found;
    struct dt_vk_runtime *rt = outside.rt = dt_vk_open(&host);
    REFUSED(dt_vk_add_buffer_usage(rt, OUTSIDE_RESOURCE_KERNEL, 0), "create comes first");
    assert_true(dt_vk_create(rt, &outside_vk));
    REFUSED(dt_vk_import_buffer(rt, OUTSIDE_RESOURCE_PHOTO, &weights), "has no buffer");
    REFUSED(dt_vk_add_image_usage(rt, OUTSIDE_RESOURCE_KERNEL, drawn), "has no image");
    assert_true(dt_vk_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT),
            "weights: 16 bytes at offset 262144 given; at least 32");
    weights.size = 4096;
    assert_true(dt_vk_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_vk_add_image_usage(rt, OUTSIDE_RESOURCE_BLURRED,
                                      VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT));
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "image blurred: the device does not support VkFormat");
    assert_true(
        dt_vk_add_image_usage(rt, OUTSIDE_RESOURCE_BLURRED, drawn) &&
        dt_vk_add_buffer_usage(rt, OUTSIDE_RESOURCE_KERNEL, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT) &&
        dt_vk_resize(rt, WIDTH, HEIGHT));
    outside.commands = begin();
    write_inputs(vulkan_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(vulkan_writes, first_color);
    vulkan_paints_with(graded_alone, weights.offset, first_color);
    outside.commands = begin();
    vulkan_paints_with(nothing, weights.offset, black);
    assert_true(dt_vk_get_resource(rt, OUTSIDE_RESOURCE_WEIGHTS, &found));
    assert_true(found.buffer == vk.geometry && found.offset == weights.offset && found.size == 32 &&
                found.stride == 16 && !found.image);
    assert_true(dt_vk_get_resource(rt, OUTSIDE_RESOURCE_KERNEL, &found));
    assert_true(found.buffer != vk.geometry && found.size % 4 == 0 && found.stride == 4 &&
                found.buffer_usage & VK_BUFFER_USAGE_VERTEX_BUFFER_BIT &&
                found.buffer_usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    assert_true(dt_vk_get_resource(rt, OUTSIDE_RESOURCE_BLURRED, &found)); /* `keep: true` */
    assert_true(found.usage & drawn && found.format == VK_FORMAT_R16G16B16A16_SFLOAT);
    weights.buffer = VK_NULL_HANDLE; /* canceled */
    assert_true(dt_vk_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    outside.commands = begin();
    hand_in(vulkan_writes, vulkan_records, second_color);
    submit(outside.commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

/* ---- Memory, caches and threads of the host -------------------------------------------------- */

static struct {
    atomic_int blocks;       /* of the callbacks, alive */
    int memory, fail_memory; /* allocations alive; the n-th from now on fails; 0: none */
    VkPipelineCache cache;
    atomic_int pipelines; /* created so far, all with the cache */
    atomic_int strangers; /* created without */
    atomic_bool fail_pipelines;
    VkPipelineStageFlags2 stages; /* of all barriers */
    int acquired, released;       /* from and to EXTERNAL */
    unsigned barriers, drop;      /* recorded; the one to leave out, from 1; 0: none */
} own;

static void *VKAPI_PTR own_alloc(void *user, size_t size, size_t alignment,
                                 VkSystemAllocationScope scope)
{
    void *block = NULL;
    (void)user, (void)scope;
    if (posix_memalign(&block, alignment < sizeof block ? sizeof block : alignment, size) != 0)
        return NULL;
    own.blocks++;
    return block;
}

static void VKAPI_PTR own_free(void *user, void *block)
{
    (void)user;
    own.blocks -= block != NULL;
    free(block);
}

static void *VKAPI_PTR own_realloc(void *user, void *block, size_t size, size_t alignment,
                                   VkSystemAllocationScope scope)
{
    void *more = own_alloc(user, size, alignment, scope);
    size_t old = block ? malloc_usable_size(block) : 0;
    if (more && block)
        memcpy(more, block, old < size ? old : size);
    own_free(user, block);
    return more;
}

static const VkAllocationCallbacks own_callbacks = {
    .pfnAllocation = own_alloc, .pfnReallocation = own_realloc, .pfnFree = own_free};

/* Allocates at an offset, never from the start of the memory. */
static VkResult own_allocate(void *user, const VkMemoryRequirements *needs, const char *name,
                             struct dt_vk_memory *out)
{
    enum { OFFSET = 1 << 16 };
    VkMemoryRequirements more = *needs;
    assert_true(user == &own && name[0] && OFFSET % needs->alignment == 0);
    *out = (struct dt_vk_memory){(VkDeviceMemory)&own /* ignored on an error */, 0, NULL};
    if (own.fail_memory && --own.fail_memory == 0)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    more.size += OFFSET;
    *out = (struct dt_vk_memory){allocate(more, 0), OFFSET, &own};
    own.memory++;
    return VK_SUCCESS;
}

static void own_release(void *user, const struct dt_vk_memory *memory)
{
    assert_true(user == &own && memory->allocation == &own);
    vkFreeMemory(vk.device, memory->memory, NULL);
    own.memory--;
}

static VkResult count_pipeline(VkPipelineCache cache)
{
    own.strangers += cache != own.cache;
    own.pipelines++;
    return own.fail_pipelines ? VK_ERROR_OUT_OF_HOST_MEMORY : VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL own_compute(VkDevice device, VkPipelineCache cache,
                                                  uint32_t count,
                                                  const VkComputePipelineCreateInfo *infos,
                                                  const VkAllocationCallbacks *callbacks,
                                                  VkPipeline *pipelines)
{
    VkResult result = count_pipeline(cache);
    return result == VK_SUCCESS
               ? vkCreateComputePipelines(device, cache, count, infos, callbacks, pipelines)
               : result;
}

static VKAPI_ATTR VkResult VKAPI_CALL own_graphics(VkDevice device, VkPipelineCache cache,
                                                   uint32_t count,
                                                   const VkGraphicsPipelineCreateInfo *infos,
                                                   const VkAllocationCallbacks *callbacks,
                                                   VkPipeline *pipelines)
{
    VkResult result = count_pipeline(cache);
    return result == VK_SUCCESS
               ? vkCreateGraphicsPipelines(device, cache, count, infos, callbacks, pipelines)
               : result;
}

static void count_owners(uint32_t from, uint32_t to, VkPipelineStageFlags2 stages)
{
    own.stages |= stages;
    assert_true(from == to || !(stages & VK_PIPELINE_STAGE_2_HOST_BIT)); /* as Vulkan demands */
    own.acquired += from == VK_QUEUE_FAMILY_EXTERNAL && to == 0;
    own.released += from == 0 && to == VK_QUEUE_FAMILY_EXTERNAL;
}

static VKAPI_ATTR void VKAPI_CALL own_barrier(VkCommandBuffer commands,
                                              const VkDependencyInfo *info)
{
    if (++own.barriers == own.drop)
        return;
    for (uint32_t i = 0; i < info->memoryBarrierCount; i++)
        own.stages |= info->pMemoryBarriers[i].srcStageMask | info->pMemoryBarriers[i].dstStageMask;
    for (uint32_t i = 0; i < info->bufferMemoryBarrierCount; i++) {
        const VkBufferMemoryBarrier2 *barrier = &info->pBufferMemoryBarriers[i];
        count_owners(barrier->srcQueueFamilyIndex, barrier->dstQueueFamilyIndex,
                     barrier->srcStageMask | barrier->dstStageMask);
    }
    for (uint32_t i = 0; i < info->imageMemoryBarrierCount; i++) {
        const VkImageMemoryBarrier2 *barrier = &info->pImageMemoryBarriers[i];
        count_owners(barrier->srcQueueFamilyIndex, barrier->dstQueueFamilyIndex,
                     barrier->srcStageMask | barrier->dstStageMask);
    }
    vkCmdPipelineBarrier2(commands, info);
}

static PFN_vkVoidFunction VKAPI_PTR own_device_functions(VkDevice device, const char *name)
{
    if (strcmp(name, "vkCmdPipelineBarrier2") == 0)
        return (PFN_vkVoidFunction)own_barrier;
    if (strcmp(name, "vkCreateComputePipelines") == 0)
        return (PFN_vkVoidFunction)own_compute;
    if (strcmp(name, "vkCreateGraphicsPipelines") == 0)
        return (PFN_vkVoidFunction)own_graphics;
    return vkGetDeviceProcAddr(device, name);
}

static PFN_vkVoidFunction VKAPI_PTR own_functions(VkInstance instance, const char *name)
{
    return strcmp(name, "vkGetDeviceProcAddr") == 0 ? (PFN_vkVoidFunction)own_device_functions
                                                    : vkGetInstanceProcAddr(instance, name);
}

struct own_jobs {
    void (*job)(void *data, uint32_t i);
    void *data;
    uint32_t count;
    atomic_uint next;
};

static void *work(void *argument)
{
    struct own_jobs *jobs = argument;
    for (uint32_t i; (i = jobs->next++) < jobs->count;)
        jobs->job(jobs->data, i);
    return NULL;
}

static void own_threads(void *user, uint32_t count, void (*job)(void *data, uint32_t i), void *data)
{
    struct own_jobs jobs = {.job = job, .data = data, .count = count};
    pthread_t threads[3];
    assert_true(user == &own);
    for (int i = 0; i < 3; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, work, &jobs), 0);
    for (int i = 0; i < 3; i++)
        pthread_join(threads[i], NULL);
}

static struct dt_vk_host own_host(void)
{
    struct dt_vk_host host = vk_host();
    host.get_instance_proc_addr = own_functions;
    host.callbacks = &own_callbacks;
    host.allocator = (struct dt_vk_allocator){&own, own_allocate, own_release};
    host.pipeline_cache = own.cache;
    host.threads = (struct dt_vk_threads){&own, own_threads};
    return host;
}

static void vulkan_uses_memory_cache_and_threads_of_the_host(void **state)
{
    (void)state;
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    const VkPipelineCacheCreateInfo cache = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    assert_int_equal(vkCreatePipelineCache(vk.device, &cache, NULL, &own.cache), VK_SUCCESS);
    vulkan_draw(&vk.scene, wanted);
    struct dt_vk_host host = own_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_import_scene(rt, &vk.scene));
    own.fail_pipelines = true;
    REFUSED(dt_vk_create(rt, &features_vk), "Pipelines(");
    own.fail_pipelines = false;
    own.pipelines = 0;
    assert_true(dt_vk_create(rt, &features_vk));
    assert_int_equal(own.pipelines, FEATURES_PASSES);
    own.fail_memory = 3;
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "): VK_ERROR_OUT_OF_DEVICE_MEMORY: use ");
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    assert_true(own.blocks > FEATURES_PASSES && own.memory > 1);

    struct dt_vk_runtime *other =
        dt_vk_open(&host); /* shares all programs, and outlives the first */
    assert_true(other && dt_vk_import_scene(other, &vk.scene) && dt_vk_create_from(other, rt) &&
                dt_vk_resize(other, WIDTH, HEIGHT));
    assert_int_equal(own.pipelines, FEATURES_PASSES);
    assert_int_equal(own.strangers, 0);
    dt_vk_close(rt);
    run_frames(other, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    dt_vk_close(other);
    assert_int_equal(own.blocks, 0);
    assert_int_equal(own.memory, 0);
    vkDestroyPipelineCache(vk.device, own.cache, NULL);
    own.cache = VK_NULL_HANDLE;
    assert_int_equal(heard.validation, 0);
}

static void vulkan_tells_what_cannot_be_shared(void **state)
{
    (void)state;
    struct dt_vk_host host = vk_host(), other = vk_host();
    struct dt_vk_runtime *rt = open_features(), *bare = dt_vk_open(&host);
    REFUSED(dt_vk_create_from(rt, bare), "create_from: the other runtime has no pipeline");
    REFUSED(dt_vk_create_from(rt, rt), "create_from: the other runtime has no pipeline");
    other.callbacks = &own_callbacks;
    struct dt_vk_runtime *careful = dt_vk_open(&other);
    REFUSED(dt_vk_create_from(careful, rt), "create_from: the runtimes have different devices");
    other.allocator.allocate = own_allocate;
    REFUSED(dt_vk_open(&other), "only one of allocate and free");
    dt_vk_close(careful);
    dt_vk_close(bare);
    dt_vk_close(rt);
    assert_int_equal(own.blocks, 0);
}

/* ---- Frames in flight ------------------------------------------------------------------------ */

enum { IN_FLIGHT = 2, CYCLES = 10 };

/* Command buffers that are submitted without waiting for the one before. */
struct flight {
    VkCommandPool pool;
    VkCommandBuffer commands[IN_FLIGHT];
    VkFence fences[IN_FLIGHT];
};

static struct flight make_flight(void)
{
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    struct flight flight;
    assert_int_equal(vkCreateCommandPool(vk.device, &pool, NULL, &flight.pool), VK_SUCCESS);
    const VkCommandBufferAllocateInfo info = {.sType =
                                                  VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = flight.pool,
                                              .commandBufferCount = IN_FLIGHT};
    assert_int_equal(vkAllocateCommandBuffers(vk.device, &info, flight.commands), VK_SUCCESS);
    for (int i = 0; i < IN_FLIGHT; i++)
        assert_int_equal(vkCreateFence(vk.device, &fence, NULL, &flight.fences[i]), VK_SUCCESS);
    return flight;
}

static void destroy_flight(const struct flight *flight)
{
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    for (int i = 0; i < IN_FLIGHT; i++)
        vkDestroyFence(vk.device, flight->fences[i], NULL);
    vkDestroyCommandPool(vk.device, flight->pool, NULL);
}

static void wait_for(const struct flight *flight, uint32_t frame)
{
    const VkFence *fence = &flight->fences[frame % IN_FLIGHT];
    assert_int_equal(vkWaitForFences(vk.device, 1, fence, VK_TRUE, UINT64_MAX), VK_SUCCESS);
}

static VkCommandBuffer begin_frame(const struct flight *flight, uint32_t frame)
{
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkCommandBuffer commands = flight->commands[frame % IN_FLIGHT];
    wait_for(flight, frame);
    assert_int_equal(vkResetFences(vk.device, 1, &flight->fences[frame % IN_FLIGHT]), VK_SUCCESS);
    assert_int_equal(vkBeginCommandBuffer(commands, &info), VK_SUCCESS);
    return commands;
}

static void end_frame(const struct flight *flight, uint32_t frame)
{
    const VkCommandBuffer *commands = &flight->commands[frame % IN_FLIGHT];
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .commandBufferCount = 1,
                               .pCommandBuffers = commands};
    assert_int_equal(vkEndCommandBuffer(*commands), VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(vk.queue, 1, &info, flight->fences[frame % IN_FLIGHT]),
                     VK_SUCCESS);
}

/* The value that the host writes into its image before a frame. Below: the place for the frame's
 * copy, one for each frame in flight. */
static float written_before(uint32_t frame)
{
    return 0.125f * (float)(frame % 4);
}
static VkDeviceSize copy_of(uint32_t frame)
{
    return GEOMETRY_BYTES / 2 + (VkDeviceSize)(frame % IN_FLIGHT) * TRAIL_BYTES;
}

/* The host records no barriers but those for its own changes of layout. */
static void write_image(VkCommandBuffer commands, VkImage image, VkImageLayout layout, float value)
{
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue color = {.float32 = {value, value, value, value}};
    move_image(commands, image, layout, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdClearColorImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &color, 1, &all);
}

/* Records a frame whose trail starts from the host's image. */
static void record_own_trail(struct dt_vk_runtime *rt, const struct flight *flight, VkImage image,
                             uint32_t frame)
{
    const VkBufferImageCopy region = {.bufferOffset = copy_of(frame),
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {WIDTH, HEIGHT, 1}};
    const struct dt_frame block = frame_of(0);
    VkCommandBuffer commands = begin_frame(flight, frame);
    write_image(commands, image,
                frame ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
                written_before(frame));
    assert_true(dt_vk_record(rt, commands, &block, NULL));
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, vk.geometry, 1,
                           &region);
    end_frame(flight, frame);
}

/* The trail mixes the value that the host wrote with the newest picture, by the default weight of
 * 0.25. The picture is the same in every frame. */
static void check_trail(const struct flight *flight, uint32_t frame, float first[TRAIL_BYTES / 4])
{
    wait_for(flight, frame);
    const float *found = (const float *)((const char *)vk.bytes + copy_of(frame));
    if (frame == 0)
        memcpy(first, found, TRAIL_BYTES);
    for (int i = 0; i < TRAIL_BYTES / 4; i++)
        if (fabsf(found[i] - first[i] - 0.75f * (written_before(frame) - written_before(0))) >
            1e-5f)
            fail_msg("frame %u, float %d is %g", frame, i, (double)found[i]);
}

static void import_trail(struct dt_vk_runtime *rt, const struct own_image *image)
{
    const struct dt_vk_image import = {.image = image->image,
                                       .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                       .usage = VK_IMAGE_USAGE_STORAGE_BIT,
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .layers = 1,
                                       .mips = 1,
                                       .layout_before = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                       .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &import));
}

/* Imports the output, and leaves it ready for a copy, as hosts do. Across command buffers, the
 * validation layers of 1.3.239 do not see that a change of layout waits for a write through another
 * barrier (their issue 6508). The layers would complain about an output that no command reads. */
static struct own_image import_output(struct dt_vk_runtime *rt, uint32_t width)
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const struct own_image output =
        make_image(VK_FORMAT_R8G8B8A8_UNORM, (VkExtent3D){width, HEIGHT, 1}, 1, usage);
    const struct dt_vk_image import = {.image = output.image,
                                       .format = VK_FORMAT_R8G8B8A8_UNORM,
                                       .usage = usage,
                                       .width = width,
                                       .height = HEIGHT,
                                       .layers = 1,
                                       .mips = 1,
                                       .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_SHOWN, &import));
    return output;
}

static bool vulkan_records_passes(uint32_t first, uint32_t end)
{
    const struct dt_frame frame = frame_of(0);
    return dt_vk_record_passes(outside.rt, outside.commands, first ? NULL : &frame, NULL, first,
                               end);
}

/* Records the two passes. With `clears`, the host clears the second pass's input between them, and
 * the second pass goes into a command buffer of its own. */
static void paint_between(bool clears, VkDeviceSize offset)
{
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue one = {.float32 = {1, 1, 1, 1}};
    struct dt_vk_resource blurred = {0}, picture = {0};
    assert_true(vulkan_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    REFUSED(dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture),
            "resource picture: a later part of this frame writes it");
    if (clears) {
        move_image(outside.commands, blurred.image, blurred.layout,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        vkCmdClearColorImage(outside.commands, blurred.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                             &one, 1, &all);
        move_image(outside.commands, blurred.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   blurred.layout);
        submit(outside.commands);
        outside.commands = begin();
    }
    assert_true(vulkan_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES) &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture));
    const VkBufferImageCopy region = {.bufferOffset = offset,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {WIDTH, HEIGHT, 1}};
    vkCmdCopyImageToBuffer(outside.commands, picture.image, picture.layout, vk.geometry, 1,
                           &region);
}

/* Imports made as described fit, and have the stages of the passes that write them. */
static void vulkan_describes_imports(void **state)
{
    (void)state;
    static const struct {
        uint32_t resource;
        VkPipelineStageFlags2 stages;
        VkAccessFlags2 accesses;
    } cases[] = {
        {FEATURES_RESOURCE_SHOWN, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
         VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT},
        {FEATURES_RESOURCE_BLURRED, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
         VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
        {FEATURES_RESOURCE_SLICE_DEPTH,
         VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
         VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
    };
    struct own_image images[DT_ARRAY_COUNT(cases)];
    struct dt_frame frame = frame_of(0);
    struct dt_vk_resource found;
    VkImageCreateInfo info;
    VkBufferCreateInfo buffer;
    struct dt_vk_runtime *rt = open_features();
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        assert_true(dt_vk_describe(&features_vk, cases[i].resource, WIDTH, HEIGHT, &info));
        images[i] = create_image(&info);
        assert_true(dt_vk_import_image(
            rt, cases[i].resource,
            &(struct dt_vk_image){images[i].image, info.format, info.usage, info.extent.width,
                                  info.extent.height, info.arrayLayers * info.extent.depth,
                                  info.mipLevels, 0, 0}));
    }
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        assert_true(dt_vk_get_resource(rt, cases[i].resource, &found));
        assert_int_equal(found.stages, cases[i].stages);
        assert_int_equal(found.accesses, cases[i].accesses);
    }
    struct features_live live = *(const struct features_live *)features_pipeline.live_defaults;
    live.blur = 0;
    assert_true(dt_vk_record(rt, begin(), &frame, &live));
    assert_true(dt_vk_get_resource(rt, FEATURES_RESOURCE_BLURRED, &found));
    assert_int_equal(found.stages, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT);
    assert_int_equal(found.accesses, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    assert_true(dt_vk_get_resource(rt, FEATURES_RESOURCE_MEMORY, &found));
    assert_true(dt_vk_describe_buffer(&features_vk, FEATURES_RESOURCE_MEMORY, 1, 1, &buffer));
    assert_true(buffer.size == found.size && (buffer.usage & ~found.buffer_usage) == 0);
    assert_false(dt_vk_describe(&features_vk, FEATURES_RESOURCE_MEMORY, 1, 1, &info));
    assert_false(dt_vk_describe_buffer(&features_vk, FEATURES_RESOURCE_SHOWN, 1, 1, &buffer));
    assert_false(dt_vk_describe(&features_vk, FEATURES_RESOURCES, 1, 1, &info));
    dt_vk_close(rt);
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++)
        destroy_image(&images[i]);
    assert_int_equal(heard.validation, 0);
}

extern const struct dt_shaders atomics_vk, bloom_vk, groups_vk, mips_vk;

/* The last resource of a frame may share memory with the first of the next. */
static void vulkan_records_two_frames_at_once(void **state)
{
    (void)state;
    static const struct dt_shaders *const pipelines[] = {&atomics_vk, &bloom_vk, &groups_vk,
                                                         &mips_vk, &shapes_vk};
    struct dt_frame frame = frame_of(0);
    for (size_t i = 0; i < DT_ARRAY_COUNT(pipelines); i++) {
        struct dt_vk_host host = vk_host();
        struct dt_vk_runtime *rt = dt_vk_open(&host);
        assert_true(rt && dt_vk_create(rt, pipelines[i]) && dt_vk_resize(rt, WIDTH, HEIGHT));
        VkCommandBuffer commands = begin();
        for (int k = 0; k < 2; k++)
            assert_true(dt_vk_record(rt, commands, &frame, NULL));
        submit(commands);
        assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
        dt_vk_close(rt);
        if (heard.validation)
            fail_msg("%s: %s", pipelines[i]->panel->pipeline->name, heard.text);
    }
}

static void vulkan_draws_the_same_in_parts(void **state)
{
    (void)state;
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    struct dt_vk_runtime *rt = open_features();
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, wanted);
    for (uint32_t passes = 1; passes < 4; passes++) {
        assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
        run_parts(rt, passes, found);
        assert_memory_equal(wanted, found, TRAIL_BYTES);
    }
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

static void vulkan_records_parts(void **state)
{
    (void)state;
    enum { FIRST = GEOMETRY_BYTES / 2, SECOND = FIRST + 4 * WIDTH * HEIGHT };
    struct dt_vk_host host = vk_host();
    outside.rt = dt_vk_open(&host);
    REFUSED(vulkan_records_passes(0, 1), "record_passes: call resize first");
    assert_true(dt_vk_create(outside.rt, &outside_vk) && dt_vk_resize(outside.rt, WIDTH, HEIGHT));
    outside.commands = begin();
    write_for_blurred(vulkan_writes);
    REFUSED(vulkan_records_passes(1, 2), "begins with pass 1, but the frame goes on with pass 0");
    REFUSED(vulkan_records_passes(0, 3), "passes 0 to 3, but the pipeline has 2");
    REFUSED(vulkan_records_passes(0, 0), "a part at least one");
    paint_between(false, FIRST);
    paint_between(true, SECOND);
    assert_true(vulkan_records_passes(0, 1));
    REFUSED(vulkan_records(),
            "record: begins with pass 0, but the frame goes on with pass 1, grade");
    submit(outside.commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    is_painted((const uint8_t *)vk.bytes + FIRST, black);
    is_painted((const uint8_t *)vk.bytes + SECOND, white);
    assert_true(dt_vk_resize(outside.rt, WIDTH, HEIGHT)); /* abandons the frame */
    outside.commands = begin();
    write_for_blurred(vulkan_writes);
    assert_true(vulkan_records());
    dt_vk_close(outside.rt);
    assert_int_equal(heard.validation, 0);
}

/* Each frame in flight has its own live parameters, as a buffer of the host shows, and its own
 * times. A frame waits only for the frame before the last. */
static void vulkan_tells_frames_in_flight_apart(void **state)
{
    (void)state;
    enum { SEEN = GEOMETRY_BYTES / 4, COPIES = GEOMETRY_BYTES / 2 };
    struct flight flight = make_flight();
    struct dt_vk_host host = vk_host();
    double ms[LAYOUTS_PASSES];
    const struct dt_vk_range seen = {vk.geometry, SEEN, sizeof(struct layouts_Seen)};
    struct layouts_live live = layouts_live_defaults;
    host.timing = true;
    host.frames = 17;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    REFUSED(dt_vk_create(rt, &layouts_vk), "opened for 17 frames in flight; use at most 16");
    dt_vk_close(rt);
    host.frames = IN_FLIGHT;
    rt = dt_vk_open(&host);
    assert_true(dt_vk_create(rt, &layouts_vk) &&
                dt_vk_import_buffer(rt, LAYOUTS_RESOURCE_SEEN, &seen) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    for (uint32_t frame = 0; frame < CYCLES; frame++) {
        const VkBufferCopy copy = {SEEN, COPIES + frame * sizeof live.gain, sizeof live.gain};
        const struct dt_frame block = frame_of(frame);
        VkCommandBuffer commands = begin_frame(&flight, frame);
        if (frame == 1)
            REFUSED(dt_vk_timings(rt, 1, ms), "timings: none of the frame 1 before the last");
        if (frame > 1) {
            assert_true(dt_vk_timings(rt, 1, ms));
            assert_true(ms[0] > 0 && ms[0] < 1e5 && ms[1] > 0 && ms[1] < 1e5);
        }
        live.gain = (float)frame;
        assert_true(dt_vk_record(rt, commands, &block, &live));
        vkCmdCopyBuffer(commands, vk.geometry, vk.geometry, 1, &copy);
        end_frame(&flight, frame);
    }
    REFUSED(dt_vk_timings(rt, IN_FLIGHT, ms), "up to the 2 that the runtime was opened for");
    destroy_flight(&flight);
    for (uint32_t frame = 0; frame < CYCLES; frame++)
        assert_true(((const float *)((const char *)vk.bytes + COPIES))[frame] == (float)frame);
    dt_vk_close(rt);
    assert_int_equal(heard.validation, 0);
}

/* In every frame the host copies weights into an imported buffer, and copies the picture out,
 * without a barrier of its own. */
static void copy_around(const struct dt_vk_sync *sync)
{
    enum { WEIGHTS = GEOMETRY_BYTES / 4, SOURCE = WEIGHTS + 4096, PICTURE = GEOMETRY_BYTES / 2 };
    const VkDeviceSize size = sizeof graded_alone;
    const struct dt_vk_range weights = {vk.geometry, WEIGHTS, size};
    struct dt_vk_host host = own_host();
    struct flight flight = make_flight();
    struct dt_vk_resource picture = {0};
    memcpy((char *)vk.bytes + SOURCE, nothing, size);
    memcpy((char *)vk.bytes + SOURCE + size, graded_alone, size);
    outside.rt = dt_vk_open(&host);
    assert_true(outside.rt && dt_vk_create(outside.rt, &outside_vk) &&
                dt_vk_import_buffer(outside.rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_vk_resize(outside.rt, WIDTH, HEIGHT));
    dt_vk_narrow(outside.rt, sync);
    for (uint32_t frame = 0; frame < CYCLES; frame++) {
        const VkBufferCopy copy = {SOURCE + frame % 2 * size, WEIGHTS, size};
        const VkBufferImageCopy region = {.bufferOffset = PICTURE + frame % 2 * 4 * WIDTH * HEIGHT,
                                          .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                          .imageExtent = {WIDTH, HEIGHT, 1}};
        VkCommandBuffer commands = outside.commands = begin_frame(&flight, frame);
        if (frame == 0)
            write_inputs(vulkan_writes, OUTSIDE_RESOURCE_WEIGHTS);
        if (frame == 0)
            write_grade(vulkan_writes, first_color);
        vkCmdCopyBuffer(commands, vk.geometry, vk.geometry, 1, &copy);
        assert_true(vulkan_records() &&
                    dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture));
        vkCmdCopyImageToBuffer(commands, picture.image, picture.layout, vk.geometry, 1, &region);
        end_frame(&flight, frame);
    }
    destroy_flight(&flight);
    dt_vk_close(outside.rt);
    is_painted((const uint8_t *)vk.bytes + PICTURE, black);
    is_painted((const uint8_t *)vk.bytes + PICTURE + 4 * (size_t)WIDTH * HEIGHT, first_color);
}

/* Validation sees the runtime's barriers and no others. It reports a hazard if `sync` lacks some of
 * the host's work. */
static void vulkan_waits_only_for_what_the_host_does(void **state)
{
    (void)state;
    const struct dt_vk_sync copies = {
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_COPY_BIT,
        VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
    struct dt_vk_sync wrong = copies;
    own.stages = 0;
    copy_around(&copies);
    assert_int_equal(heard.validation, 0);
    assert_int_equal(
        own.stages & (VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT |
                      VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_HOST_BIT),
        0);
    wrong.stages_after = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
    wrong.accesses_after = VK_ACCESS_2_SHADER_READ_BIT;
    copy_around(&wrong);
    assert_true(heard.validation > 0);
    assert_non_null(strstr(heard.hazard, "SYNC-HAZARD"));
    heard.validation = 0;
    copy_around(NULL);
    assert_int_equal(heard.validation, 0);
    assert_true(own.stages & VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
}

/* Between two passes the host clears the image that the first writes and the second reads, without
 * a barrier of its own. `drop`: the barrier to leave out. *seam: number of the last barrier before
 * the host's command. Returns whether validation reports a hazard. */
static bool clear_at_seam(const struct dt_vk_sync *sync, unsigned drop, unsigned *seam)
{
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue one = {.float32 = {1, 1, 1, 1}};
    struct dt_vk_host host = own_host();
    struct dt_vk_resource blurred = {0};
    heard.validation = 0;
    outside.rt = dt_vk_open(&host);
    assert_true(outside.rt && dt_vk_create(outside.rt, &outside_vk) &&
                dt_vk_resize(outside.rt, WIDTH, HEIGHT));
    outside.commands = begin();
    write_for_blurred(vulkan_writes);
    dt_vk_narrow(outside.rt, sync);
    own.barriers = 0;
    own.drop = drop;
    assert_true(vulkan_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    assert_int_equal(blurred.layout, VK_IMAGE_LAYOUT_GENERAL);
    *seam = own.barriers;
    vkCmdClearColorImage(outside.commands, blurred.image, blurred.layout, &one, 1, &all);
    assert_true(vulkan_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES));
    own.drop = 0;
    submit(outside.commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    dt_vk_close(outside.rt);
    return heard.validation;
}

/* Validation is silent with all barriers. It reports a hazard without the last barrier before the
 * host's command, or without the first one after it. */
static void vulkan_waits_at_seams(void **state)
{
    (void)state;
    const struct dt_vk_sync clears = {VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                      VK_PIPELINE_STAGE_2_CLEAR_BIT,
                                      VK_ACCESS_2_TRANSFER_WRITE_BIT};
    const struct dt_vk_sync *syncs[] = {&clears, NULL};
    for (int i = 0; i < 2; i++) {
        unsigned seam, ignored;
        assert_false(clear_at_seam(syncs[i], 0, &seam));
        assert_true(clear_at_seam(syncs[i], seam, &ignored));
        assert_non_null(strstr(heard.hazard, "SYNC-HAZARD-WRITE-AFTER-WRITE"));
        assert_true(clear_at_seam(syncs[i], seam + 1, &ignored));
        assert_non_null(strstr(heard.hazard, "SYNC-HAZARD"));
    }
    heard.validation = 0;
}

/* A buffer and an image that another queue family owns. EXTERNAL is such a family on every
 * device. */
static void vulkan_exchanges_imports(void **state)
{
    (void)state;
    const uint32_t external = VK_QUEUE_FAMILY_EXTERNAL;
    const struct dt_vk_range weights = {vk.geometry, GEOMETRY_BYTES / 4, sizeof graded_alone};
    const struct own_image output =
        make_image(VK_FORMAT_R8G8B8A8_UNORM, (VkExtent3D){WIDTH, HEIGHT, 1}, 1,
                   VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    struct dt_vk_image import = {.image = output.image,
                                 .format = VK_FORMAT_R8G8B8A8_UNORM,
                                 .usage = VK_IMAGE_USAGE_STORAGE_BIT,
                                 .width = WIDTH,
                                 .height = HEIGHT,
                                 .layers = 1,
                                 .mips = 1,
                                 .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    struct dt_vk_host host = own_host();
    struct dt_vk_runtime *rt = outside.rt = dt_vk_open(&host);
    assert_true(dt_vk_create(rt, &outside_vk));
    REFUSED(dt_vk_exchange(rt, OUTSIDE_RESOURCE_WEIGHTS, external), "is not imported");
    REFUSED(dt_vk_exchange(rt, OUTSIDE_RESOURCES, external), "is not imported");
    assert_true(dt_vk_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_vk_import_image(rt, OUTSIDE_RESOURCE_PICTURE, &import) &&
                dt_vk_exchange(rt, OUTSIDE_RESOURCE_WEIGHTS, external) &&
                dt_vk_exchange(rt, OUTSIDE_RESOURCE_PICTURE, external) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    memcpy((char *)vk.bytes + weights.offset, graded_alone, sizeof graded_alone);
    dt_vk_narrow(rt, &(struct dt_vk_sync){.stages_after = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT |
                                                          VK_PIPELINE_STAGE_2_HOST_BIT,
                                          .accesses_after = VK_ACCESS_2_TRANSFER_READ_BIT |
                                                            VK_ACCESS_2_HOST_READ_BIT});
    outside.commands = begin();
    write_inputs(vulkan_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(vulkan_writes, first_color);
    own.acquired = own.released = 0;
    assert_true(vulkan_records_passes(0, 1));
    assert_int_equal(own.acquired, 1); /* only the weights; the picture has no content yet */
    assert_int_equal(own.released, 0);
    assert_true(vulkan_records_passes(1, OUTSIDE_PASSES));
    assert_int_equal(own.acquired, 1);
    assert_int_equal(own.released, 2);
    import.layout_before = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    submit(outside.commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    assert_true(dt_vk_import_image(rt, OUTSIDE_RESOURCE_PICTURE, &import) &&
                dt_vk_exchange(rt, OUTSIDE_RESOURCE_WEIGHTS, VK_QUEUE_FAMILY_IGNORED) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    outside.commands = begin();
    write_inputs(vulkan_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(vulkan_writes, second_color);
    record_picture(GEOMETRY_BYTES / 2);
    submit(outside.commands);
    assert_int_equal(vkDeviceWaitIdle(vk.device), VK_SUCCESS);
    assert_int_equal(own.acquired, 2);
    assert_int_equal(own.released, 3);
    is_painted((const uint8_t *)vk.bytes + GEOMETRY_BYTES / 2, second_color);
    dt_vk_close(rt);
    destroy_image(&output);
    assert_int_equal(heard.validation, 0);
}

/* Two pipelines, each with two frames in flight. The host writes an image of the first pipeline
 * before every frame and reads it after the frame. */
static void run_in_flight(const struct dt_shaders *shaders)
{
    static float first[TRAIL_BYTES / 4];
    const struct own_image trail =
        make_image(VK_FORMAT_R32G32B32A32_SFLOAT, (VkExtent3D){WIDTH, HEIGHT, 1}, 1,
                   VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                       VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    struct dt_vk_runtime *rt = open_features(), *other = open_features();
    struct flight flight = make_flight(), other_flight = make_flight();
    assert_true(dt_vk_create(rt, shaders));
    import_trail(rt, &trail);
    const struct own_image output = import_output(rt, WIDTH),
                           other_output = import_output(other, 2 * WIDTH);
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT) && dt_vk_resize(other, 2 * WIDTH, HEIGHT));
    for (uint32_t frame = 0; frame < CYCLES; frame++) {
        const struct dt_frame block = frame_of(frame);
        record_own_trail(rt, &flight, trail.image, frame);
        assert_true(dt_vk_record(other, begin_frame(&other_flight, frame), &block, NULL));
        end_frame(&other_flight, frame);
        if (frame > 0)
            check_trail(&flight, frame - 1, first);
    }
    check_trail(&flight, CYCLES - 1, first);
    destroy_flight(&flight);
    destroy_flight(&other_flight);
    dt_vk_close(rt);
    dt_vk_close(other);
    destroy_image(&trail);
    destroy_image(&output);
    destroy_image(&other_output);
}

static void vulkan_keeps_frames_in_flight_apart(void **state)
{
    (void)state;
    run_in_flight(&features_vk);
    assert_int_equal(heard.validation, 0);
}

/* Checks that validation can fail, since its silence means nothing otherwise. First uses wait for
 * nothing here, not even for the barrier at the start of a frame. */
static const struct dt_verbs *verbs_below;

static bool barriers_without_stages(void *runtime, uint32_t pass, const struct dt_barrier *barriers,
                                    uint32_t count)
{
    struct dt_barrier changed[DT_MAX_BINDINGS];
    for (uint32_t i = 0; i < count; i++) {
        changed[i] = barriers[i];
        if (!changed[i].from)
            changed[i].from_stages = 0;
    }
    return verbs_below->barriers(runtime, pass, changed, count);
}

static bool record_without_stages(const struct dt_recording *r)
{
    struct dt_verbs verbs = *r->verbs;
    struct dt_recording changed = *r;
    verbs_below = r->verbs;
    verbs.barriers = barriers_without_stages;
    changed.verbs = &verbs;
    return features_panel.record(&changed);
}

static void vulkan_hears_first_uses_that_do_not_wait(void **state)
{
    (void)state;
    struct dt_panel panel = features_panel;
    const struct dt_shaders hasty = {"vk", &panel, features_vk.stages};
    panel.record = record_without_stages;
    assert_int_equal(heard.validation, 0);
    run_in_flight(&hasty);
    assert_true(heard.validation > 0);
    assert_non_null(strstr(heard.hazard, "SYNC-HAZARD"));
    heard.validation = 0;
}

/* ---- OpenGL ---------------------------------------------------------------------------------- */

static PFNGLCREATEBUFFERSPROC create_buffers;
static PFNGLNAMEDBUFFERSTORAGEPROC buffer_storage;
static PFNGLCREATETEXTURESPROC create_textures;
static PFNGLTEXTURESTORAGE2DPROC texture_storage;
static PFNGLGETERRORPROC get_error;
static PFNGLENABLEPROC enable;

static int open_opengl(void **state)
{
    (void)state;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    EGLDisplay display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    assert_true(eglInitialize(display, NULL, NULL) && eglBindAPI(EGL_OPENGL_API));
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    assert_true(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context));
    create_buffers = (PFNGLCREATEBUFFERSPROC)eglGetProcAddress("glCreateBuffers");
    buffer_storage = (PFNGLNAMEDBUFFERSTORAGEPROC)eglGetProcAddress("glNamedBufferStorage");
    create_textures = (PFNGLCREATETEXTURESPROC)eglGetProcAddress("glCreateTextures");
    texture_storage = (PFNGLTEXTURESTORAGE2DPROC)eglGetProcAddress("glTextureStorage2D");
    get_error = (PFNGLGETERRORPROC)eglGetProcAddress("glGetError");
    enable = (PFNGLENABLEPROC)eglGetProcAddress("glEnable");
    return 0;
}

static void (*no_function(const char *name))(void)
{
    (void)name;
    return NULL;
}

static struct dt_gl_scene gl_scene(void)
{
    GLuint buffers[2];
    create_buffers(2, buffers);
    buffer_storage(buffers[0], GEOMETRY_BYTES, vk.bytes, 0);
    buffer_storage(buffers[1], 12, (const char *)vk.bytes + 4096, 0);
    return (struct dt_gl_scene){
        .vertices = {buffers[0], 0, 3 * sizeof(struct dt_vertex)},
        .indices = {buffers[1], 0, 12},
        .index_count = 3,
        .materials = {buffers[0], 8192, DT_MAX_MATERIALS * sizeof(struct dt_material)},
        .objects = {buffers[0], 81920, sizeof(struct dt_object)},
        .numbered = true};
}

static GLuint texture_of(GLenum format, GLsizei width)
{
    GLuint texture;
    create_textures(GL_TEXTURE_2D, 1, &texture);
    texture_storage(texture, 1, format, width, HEIGHT);
    return texture;
}

static void opengl_tells_wrong_calls(void **state)
{
    (void)state;
    const struct dt_gl_scene right = gl_scene();
    struct dt_gl_scene scene = right;
    struct dt_frame frame = frame_of(0);
    struct dt_gl_resource resource;
    double ms[FEATURES_PASSES];
    REFUSED(dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = no_function}),
            "get_proc_address");
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_non_null(rt);
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "import_scene");
    REFUSED(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, 1), "create comes first");
    REFUSED(dt_gl_create(rt, &features_vk), "the shaders are for vk; give features_gl");
    struct dt_panel newer = features_panel;
    newer.version = DT_MAKE_VERSION(DT_VERSION_MAJOR, DT_VERSION_MINOR + 1, 2);
    struct dt_shaders other = features_gl;
    struct dt_program programs[FEATURES_PASSES];
    other.panel = &newer;
    REFUSED(dt_gl_create(rt, &other),
            "the pipeline is from diptych-gen 0.2.2, this library is 0.1");
    newer.version = DT_MAKE_VERSION(DT_VERSION_MAJOR + 1, DT_VERSION_MINOR, 0);
    REFUSED(dt_gl_create(rt, &other), "generate the pipeline again");
    const struct dt_demand much = {FEATURES_PASS_SLICE, DT_LIMIT_SHARED_BYTES, 1 << 30};
    newer = features_panel;
    newer.demands = &much;
    newer.demand_count = 1;
    REFUSED(dt_gl_create(rt, &other),
            "pass slice needs 1,073,741,824 bytes of shared memory; the device ");
    scene.index_count = 4;
    REFUSED(dt_gl_import_scene(rt, &scene), "4 indices");
    scene = right;
    scene.indices.offset = 256;
    REFUSED(dt_gl_import_scene(rt, &scene), "offset 256");
    scene = right;
    scene.materials.size = 32;
    REFUSED(dt_gl_import_scene(rt, &scene), "scene materials");
    scene = right;
    scene.objects.buffer = 0;
    assert_true(dt_gl_import_scene(rt, &scene));
    assert_true(dt_gl_create(rt, &features_gl));
    struct dt_gl_runtime *text = dt_gl_open(
        &(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress, .glsl = true});
    assert_non_null(text);
    REFUSED(dt_gl_create(text, &features_gl), "generate with diptych-gen --glsl");
    dt_gl_close(text);
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "the pass keep reads scene_objects");
    scene = right;
    scene.numbered = false;
    newer = features_with_numbers(programs);
    assert_true(dt_gl_create(rt, &other) && dt_gl_import_scene(rt, &scene));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "reads vertex_triangle; number the triangles");
    assert_true(dt_gl_create(rt, &features_gl));
    assert_true(dt_gl_import_scene(rt, &right));
    REFUSED(dt_gl_record(rt, &frame, NULL), "call resize first");
    REFUSED(dt_gl_get_resource(rt, 0, &resource), "resize comes first");
    REFUSED(dt_gl_import_image(rt, FEATURES_RESOURCE_MEMORY, 1), "no image");
    assert_true(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, texture_of(GL_RGBA8, WIDTH)));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "image trail: imported");
    assert_true(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, texture_of(GL_RGBA32F, 5)));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "5x16");
    GLuint trail = texture_of(GL_RGBA32F, WIDTH);
    assert_true(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, trail));
    assert_true(dt_gl_resize(rt, WIDTH, HEIGHT));
    REFUSED(dt_gl_timings(rt, 0, ms), "timing");
    REFUSED(dt_gl_record(rt, &empty, NULL), "`camera` of the struct dt_frame is zero");
    assert_true(dt_gl_record(rt, &frame, NULL));
    assert_true(dt_gl_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    assert_int_equal(resource.texture, trail);
    REFUSED(dt_gl_get_resource(rt, FEATURES_RESOURCE_HISTOGRAM, &resource),
            "resource histogram: other passes may reuse its memory; give it `keep: true`");
    dt_gl_close(rt);
    dt_gl_close(NULL);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_tells_errors_that_were_there(void **state)
{
    (void)state;
    enable(GL_RGBA8); /* no capability: GL_INVALID_ENUM */
    heard.warnings = heard.errors = 0;
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_non_null(rt);
    assert_int_equal(heard.warnings, 1);
    assert_int_equal(heard.errors, 0);
    assert_non_null(strstr(heard.text, "0x500"));
    dt_gl_close(rt);
}

static void opengl_needs_no_scene_that_nobody_sees(void **state)
{
    (void)state;
    struct dt_frame frame = frame_of(0);
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &layouts_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    assert_true(dt_gl_record(rt, &frame, NULL));
    REFUSED(!dt_gl_create(rt, &features_gl) || dt_gl_resize(rt, WIDTH, HEIGHT), "import_scene");
    dt_gl_close(rt);
}

static void opengl_draw(const struct dt_gl_scene *scene, uint8_t trail[TRAIL_BYTES])
{
    PFNGLGETTEXTUREIMAGEPROC get = (PFNGLGETTEXTUREIMAGEPROC)eglGetProcAddress("glGetTextureImage");
    struct dt_frame frame = frame_of(0);
    struct dt_gl_resource resource = {0};
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_import_scene(rt, scene) && dt_gl_create(rt, &features_gl) &&
                dt_gl_resize(rt, WIDTH, HEIGHT) && dt_gl_record(rt, &frame, NULL) &&
                dt_gl_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    get(resource.texture, 0, GL_RGBA, GL_FLOAT, TRAIL_BYTES, trail);
    dt_gl_close(rt);
}

static void opengl_draws_vertices_of_another_layout(void **state)
{
    (void)state;
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    for (int turned = 0; turned < 2; turned++) {
        lay_out((float)turned);
        struct dt_gl_scene scene = gl_scene();
        unsigned buffer = scene.vertices.buffer;
        opengl_draw(&scene, wanted);
        scene.vertices.buffer = 0;
        scene.attributes[DT_POSITION] = (struct dt_gl_attribute){buffer, OWN_POSITIONS, 16};
        for (int i = DT_NORMAL; i <= DT_MATERIAL; i++)
            scene.attributes[i] =
                (struct dt_gl_attribute){buffer, OWN_REST + own_places[i], OWN_BYTES};
        opengl_draw(&scene, found);
        assert_int_equal(memcmp(wanted, found, TRAIL_BYTES) != 0, turned);
    }
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_shares_programs(void **state)
{
    (void)state;
    const struct dt_gl_host host = {.log = test_log, .get_proc_address = eglGetProcAddress};
    const struct dt_gl_host text = {
        .log = test_log, .get_proc_address = eglGetProcAddress, .glsl = true};
    const struct dt_gl_scene scene = gl_scene();
    struct dt_frame frame = frame_of(0);
    struct dt_gl_runtime *rt = dt_gl_open(&host), *other = dt_gl_open(&host);
    REFUSED(dt_gl_create_from(other, rt), "create_from: the other runtime has no pipeline");
    assert_true(dt_gl_create(rt, &features_gl) && dt_gl_import_scene(other, &scene) &&
                dt_gl_create_from(other, rt) && dt_gl_resize(other, WIDTH, HEIGHT));
    dt_gl_close(rt);
    assert_true(dt_gl_record(other, &frame, NULL));
    rt = dt_gl_open(&text);
    REFUSED(dt_gl_create_from(rt, other), "one runtime has GLSL text");
    dt_gl_close(rt);
    dt_gl_close(other);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static struct dt_gl_runtime *outside_gl_runtime;

static bool opengl_writes(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    return dt_gl_write(outside_gl_runtime, resource, mip, bytes);
}

static bool opengl_records(void)
{
    struct dt_frame frame = frame_of(0);
    return dt_gl_record(outside_gl_runtime, &frame, NULL);
}

/* The picture of the last frame must have this colour. */
static void opengl_painted(const uint8_t color[4])
{
    PFNGLGETTEXTUREIMAGEPROC get = (PFNGLGETTEXTUREIMAGEPROC)eglGetProcAddress("glGetTextureImage");
    static uint8_t texels[4 * WIDTH * HEIGHT];
    struct dt_gl_resource picture = {0};
    assert_true(dt_gl_get_resource(outside_gl_runtime, OUTSIDE_RESOURCE_PICTURE, &picture));
    get(picture.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, sizeof texels, texels);
    is_painted(texels, color);
}

static void opengl_paints(const uint8_t color[4])
{
    assert_true(opengl_records());
    opengl_painted(color);
}

static bool opengl_records_passes(uint32_t first, uint32_t end)
{
    const struct dt_frame frame = frame_of(0);
    return dt_gl_record_passes(outside_gl_runtime, first ? NULL : &frame, NULL, first, end);
}

static void opengl_records_parts(void **state)
{
    (void)state;
    PFNGLCLEARTEXIMAGEPROC clear = (PFNGLCLEARTEXIMAGEPROC)eglGetProcAddress("glClearTexImage");
    const float one[4] = {1, 1, 1, 1};
    struct dt_gl_resource blurred = {0}, picture;
    struct dt_gl_runtime *rt = outside_gl_runtime =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &outside_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    write_for_blurred(opengl_writes);
    REFUSED(opengl_records_passes(1, 2), "begins with pass 1, but the frame goes on with pass 0");
    opengl_paints(black);
    assert_true(opengl_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_gl_get_resource(rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    REFUSED(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_PICTURE, &picture),
            "resource picture: a later part of this frame writes it");
    REFUSED(opengl_records(),
            "record: begins with pass 0, but the frame goes on with pass 1, grade");
    clear(blurred.texture, 0, GL_RGBA, GL_FLOAT, one);
    assert_true(opengl_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES));
    opengl_painted(white);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

/* `glsl`: uses the GLSL text in the generated C, not the SPIR-V. */
static void take_inputs(bool glsl)
{
    struct dt_gl_runtime *rt = dt_gl_open(
        &(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress, .glsl = glsl});
    outside_gl_runtime = rt;
    assert_true(rt && dt_gl_create(rt, &outside_gl));
    for (int turn = 0; turn < 2; turn++) { /* a resize drops all content */
        assert_true(dt_gl_resize(rt, WIDTH, HEIGHT));
        REFUSED(opengl_records(), "mip 0 of the input kernel has no content");
        hand_in(opengl_writes, opengl_records, first_color);
        opengl_paints(first_color);
        write_grade(opengl_writes, second_color);
        opengl_paints(second_color);
    }
    /* an imported image needs no content, and refuses content */
    struct dt_bytes photo = bytes_of(OUTSIDE_RESOURCE_PHOTO, 0);
    assert_true(
        dt_gl_import_image(rt, OUTSIDE_RESOURCE_PHOTO, texture_of(GL_SRGB8_ALPHA8, WIDTH)) &&
        dt_gl_resize(rt, WIDTH, HEIGHT));
    REFUSED(opengl_writes(OUTSIDE_RESOURCE_PHOTO, 0, &photo),
            "write photo: it is imported; write the host's own object");
    assert_true(dt_gl_import_image(rt, OUTSIDE_RESOURCE_PHOTO, 0)); /* canceled */
    REFUSED(opengl_writes(OUTSIDE_RESOURCE_PHOTO, 0, &photo), "write: call resize first");
    free(photo.data);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_takes_inputs(void **state)
{
    (void)state;
    take_inputs(false);
}

static void opengl_takes_text(void **state)
{
    (void)state;
    take_inputs(true);
}

static int links; /* programs that the runtime links itself */

static void APIENTRY count_link(GLuint program)
{
    links++;
    ((PFNGLLINKPROGRAMPROC)eglGetProcAddress("glLinkProgram"))(program);
}

static void (*address_of(const char *name))(void)
{
    return strcmp(name, "glLinkProgram") == 0 ? (void (*)(void))count_link
                                              : eglGetProcAddress(name);
}

/* Renders a frame with a cache. Returns how many programs were linked. */
static int links_with(struct dt_bytes cache)
{
    outside_gl_runtime = dt_gl_open(&(struct dt_gl_host){
        .log = test_log, .get_proc_address = address_of, .glsl = true, .cache = cache});
    links = 0;
    assert_true(outside_gl_runtime && dt_gl_create(outside_gl_runtime, &outside_gl) &&
                dt_gl_resize(outside_gl_runtime, WIDTH, HEIGHT));
    hand_in(opengl_writes, opengl_records, first_color);
    opengl_paints(first_color);
    dt_gl_close(outside_gl_runtime);
    return links;
}

static void opengl_takes_and_gives_a_cache(void **state)
{
    (void)state;
    struct dt_bytes cache;
    for (int text = 0; text < 2; text++) {
        struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
            .log = test_log, .get_proc_address = eglGetProcAddress, .glsl = text});
        REFUSED(dt_gl_get_cache(rt, &cache), "get_cache: no pipeline yet");
        assert_true(dt_gl_create(rt, &outside_gl) && dt_gl_get_cache(rt, &cache));
        dt_gl_close(rt);
        if (!text)
            free(cache.data);
    }
    assert_int_equal(links_with((struct dt_bytes){0}), OUTSIDE_PASSES);
    if (cache.size > 64) { /* the driver gives binaries */
        assert_int_equal(links_with(cache), 0);
        cache.data[cache.size / 2] ^= 1; /* each damage costs what it hits */
        assert_int_equal(links_with(cache), 1);
        assert_in_range(links_with((struct dt_bytes){cache.data, cache.size / 3, {0}}), 1,
                        OUTSIDE_PASSES);
    }
    assert_int_equal(links_with((struct dt_bytes){cache.data, 7, {0}}), OUTSIDE_PASSES);
    cache.data[8] ^= 1; /* of another driver */
    assert_int_equal(links_with(cache), OUTSIDE_PASSES);
    free(cache.data);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_takes_buffers_and_describes_all(void **state)
{
    (void)state;
    PFNGLNAMEDBUFFERSUBDATAPROC update =
        (PFNGLNAMEDBUFFERSUBDATAPROC)eglGetProcAddress("glNamedBufferSubData");
    struct dt_gl_range weights = {.offset = 1024, .size = 16};
    struct dt_gl_resource found;
    create_buffers(1, &weights.buffer);
    buffer_storage(weights.buffer, 4096, NULL, GL_DYNAMIC_STORAGE_BIT);
    update(weights.buffer, 1024, sizeof graded_alone, graded_alone);
    struct dt_gl_runtime *rt = outside_gl_runtime =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &outside_gl));
    REFUSED(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_PHOTO, &weights), "has no buffer");
    assert_true(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "weights: 16 bytes at offset 1024 given; at least 32");
    weights.size = 3072;
    assert_true(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_gl_resize(rt, WIDTH, HEIGHT));
    write_inputs(opengl_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(opengl_writes, first_color);
    opengl_paints(first_color);
    update(weights.buffer, 1024, sizeof nothing, nothing);
    opengl_paints(black);
    assert_true(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_WEIGHTS, &found));
    assert_true(found.buffer == weights.buffer && found.offset == 1024 && found.size == 32 &&
                found.stride == 16 && !found.texture);
    assert_true(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_SOFT, &found));
    assert_true(found.texture && found.target == GL_TEXTURE_2D && found.format == GL_RGBA16F &&
                found.layers == 1 && found.mips == 3 && !found.buffer);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_takes_3d_images_and_cubes(void **state)
{
    (void)state;
    PFNGLTEXTURESTORAGE3DPROC storage =
        (PFNGLTEXTURESTORAGE3DPROC)eglGetProcAddress("glTextureStorage3D");
    PFNGLGETTEXTURESUBIMAGEPROC get =
        (PFNGLGETTEXTURESUBIMAGEPROC)eglGetProcAddress("glGetTextureSubImage");
    struct dt_frame frame = frame_of(0);
    uint16_t texel[4];
    GLuint fog, sky, probes, flat = texture_of(GL_RGBA16F, 8);
    create_textures(GL_TEXTURE_3D, 1, &fog);
    storage(fog, 3, GL_RGBA16F, 8, 6, 5);
    create_textures(GL_TEXTURE_CUBE_MAP, 1, &sky);
    texture_storage(sky, 2, GL_RGBA16F, 8, 8);
    create_textures(GL_TEXTURE_CUBE_MAP_ARRAY, 1, &probes);
    storage(probes, 1, GL_RGBA8, 4, 4, 12);
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &shapes_gl));
    assert_true(dt_gl_import_image(rt, SHAPES_RESOURCE_FOG, flat));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "image fog: imported");
    assert_true(dt_gl_import_image(rt, SHAPES_RESOURCE_FOG, fog) &&
                dt_gl_import_image(rt, SHAPES_RESOURCE_SKY, sky) &&
                dt_gl_import_image(rt, SHAPES_RESOURCE_PROBES, probes) &&
                dt_gl_resize(rt, WIDTH, HEIGHT) && dt_gl_record(rt, &frame, NULL));
    get(fog, 0, 7, 5, 4, 1, 1, 1, GL_RGBA, GL_HALF_FLOAT, sizeof texel, texel);
    is_last_fog(texel);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

/* If the host has bound a query buffer, OpenGL would write the times into this buffer. */
static void opengl_takes_times_beside_a_query_buffer(void **state)
{
    (void)state;
    PFNGLGENBUFFERSPROC generate = (PFNGLGENBUFFERSPROC)eglGetProcAddress("glGenBuffers");
    PFNGLBINDBUFFERPROC bind = (PFNGLBINDBUFFERPROC)eglGetProcAddress("glBindBuffer");
    PFNGLGETINTEGERVPROC get = (PFNGLGETINTEGERVPROC)eglGetProcAddress("glGetIntegerv");
    struct dt_frame frame = frame_of(0);
    double ms[LAYOUTS_PASSES];
    GLuint buffer = 0;
    GLint bound = 0;
    PFNGLFINISHPROC finish = (PFNGLFINISHPROC)eglGetProcAddress("glFinish");
    struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
        .log = test_log, .get_proc_address = eglGetProcAddress, .timing = true, .frames = 2});
    assert_true(rt && dt_gl_create(rt, &layouts_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    assert_true(dt_gl_record(rt, &frame, NULL));
    REFUSED(dt_gl_timings(rt, 1, ms), "timings: none of the frame 1 before the last");
    assert_true(dt_gl_record(rt, &frame, NULL) && dt_gl_timings(rt, 1, ms));
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0 || isnan(ms[i])); /* never waits */
    finish();
    assert_true(dt_gl_timings(rt, 1, ms));
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0);
    generate(1, &buffer);
    bind(GL_QUERY_BUFFER, buffer);
    heard.errors = 0;
    assert_true(dt_gl_timings(rt, 0, ms));
    assert_int_equal(heard.errors, 0);
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0);
    get(GL_QUERY_BUFFER_BINDING, &bound);
    assert_int_equal(bound, buffer);
    bind(GL_QUERY_BUFFER, 0);
    dt_gl_close(rt);
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* Composes the frame of scenes/cornell.yaml by hand. */
static void a_frame_is_composed_as_of_a_file(void **state)
{
    (void)state;
    struct dt_scene_file *file = dt_scene_open("scenes/cornell.yaml", NULL, &test_log);
    assert_non_null(file);
    const struct dt_scene *scene = dt_scene_data(file);
    const float pi = 3.14159265358979f;
    const struct dt_scene_camera camera = {
        {0.278f, 0.273f, -0.8f}, {0.278f, 0.273f, 0}, {0, 1, 0}, 39.3f * pi / 180};
    struct dt_scene_light light = {.kind = DT_LIGHT_SPOT,
                                   .position = {0.15f, 0.5f, 0.2f},
                                   .cone = {25 * pi / 180, 35 * pi / 180},
                                   .color = {1, 1, 1}};
    struct dt_scene_extent extent = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY},
                                     0,
                                     scene->index_count / 3};
    struct dt_frame wanted, found;
    dt_scene_frame(file, 64, 48, &wanted);
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            extent.low[i] = fminf(extent.low[i], scene->vertices[v].position[i]);
            extent.high[i] = fmaxf(extent.high[i], scene->vertices[v].position[i]);
        }
    extent.radius = wanted.scene_radius;
    memcpy(light.direction, wanted.light.direction, sizeof light.direction);
    dt_scene_compose(&camera, &light, &extent, 64, 48, &found);
    const float *a = (const float *)&wanted, *b = (const float *)&found;
    for (size_t i = 0; i < offsetof(struct dt_frame, width) / sizeof *a; i++)
        if (fabsf(a[i] - b[i]) > 1e-6f * fmaxf(1, fabsf(a[i])))
            fail_msg("float %zu is %.9g, not %.9g", i, (double)b[i], (double)a[i]);
    assert_int_equal(wanted.triangle_count, found.triangle_count);
    dt_scene_look(file, &(struct dt_scene_camera){{1, 2, 3}, {1, 2, 0}, {0, 1, 0}, 1});
    dt_scene_frame(file, 64, 48, &found);
    assert_true(found.camera.position[0] == 1 && found.camera.position[1] == 2 &&
                found.camera.position[2] == 3 && found.camera.direction[2] == -1);
    dt_scene_close(file);
    REFUSED(dt_scene_open("scenes/nowhere.yaml", NULL, &test_log), "nowhere.yaml");
}

int main(void)
{
    const struct CMUnitTest vulkan[] = {
        cmocka_unit_test(vulkan_tells_wrong_hosts),
        cmocka_unit_test(vulkan_tells_which_device_suits),
        cmocka_unit_test(vulkan_checks_enabled_features),
        cmocka_unit_test(vulkan_tells_wrong_calls),
        cmocka_unit_test(vulkan_forgets_what_was_not_submitted),
        cmocka_unit_test(vulkan_draws_vertices_of_another_layout),
        cmocka_unit_test(vulkan_refuses_indices_that_lavapipe_would_miss),
        cmocka_unit_test(vulkan_keeps_history),
        cmocka_unit_test(vulkan_takes_times),
        cmocka_unit_test(vulkan_describes_imports),
        cmocka_unit_test(vulkan_records_two_frames_at_once),
        cmocka_unit_test(vulkan_draws_the_same_in_parts),
        cmocka_unit_test(vulkan_needs_no_scene_that_nobody_sees),
        cmocka_unit_test(vulkan_draws_the_hosts_textures),
        cmocka_unit_test(vulkan_takes_inputs),
        cmocka_unit_test(vulkan_takes_buffers_and_describes_all),
        cmocka_unit_test(vulkan_takes_3d_images_and_cubes),
        cmocka_unit_test(vulkan_uses_memory_cache_and_threads_of_the_host),
        cmocka_unit_test(vulkan_tells_what_cannot_be_shared),
        cmocka_unit_test_setup(opengl_tells_wrong_calls, open_opengl),
        cmocka_unit_test(opengl_tells_errors_that_were_there),
        cmocka_unit_test(opengl_needs_no_scene_that_nobody_sees),
        cmocka_unit_test(opengl_draws_vertices_of_another_layout),
        cmocka_unit_test(opengl_takes_times_beside_a_query_buffer),
        cmocka_unit_test(opengl_shares_programs),
        cmocka_unit_test(opengl_takes_and_gives_a_cache),
        cmocka_unit_test(opengl_takes_inputs),
        cmocka_unit_test(opengl_takes_text),
        cmocka_unit_test(opengl_takes_buffers_and_describes_all),
        cmocka_unit_test(opengl_records_parts),
        cmocka_unit_test(opengl_takes_3d_images_and_cubes),
        cmocka_unit_test(a_frame_is_composed_as_of_a_file),
    };
    const struct CMUnitTest flight[] = {
        cmocka_unit_test(vulkan_keeps_frames_in_flight_apart),
        cmocka_unit_test(vulkan_records_parts),
        cmocka_unit_test(vulkan_waits_only_for_what_the_host_does),
        cmocka_unit_test(vulkan_waits_at_seams),
        cmocka_unit_test(vulkan_exchanges_imports),
        cmocka_unit_test(vulkan_tells_frames_in_flight_apart),
        cmocka_unit_test(vulkan_hears_first_uses_that_do_not_wait),
    };
    int failed = cmocka_run_group_tests_name("library", vulkan, open_vulkan, close_vulkan);
    return failed +
           cmocka_run_group_tests_name("in flight", flight, open_vulkan_for_flight, close_vulkan);
}
