/* Objects of the host in the Vulkan library: textures, images of all kinds, buffers, and content for
 * inputs. The runtime uses them as they are described, and never destroys them. */
#include <math.h>
#include <string.h>

#include "library_vk.h"
#include "shapes.h"

/* Two layers of one sRGB texel each. */
static struct own_image make_textures(const uint8_t texels[2][4])
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const VkBufferImageCopy region = {.bufferOffset = GEOMETRY_BYTES / 2,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 2},
                                      .imageExtent = {1, 1, 1}};
    struct own_image own = make_image(VK_FORMAT_R8G8B8A8_SRGB, region.imageExtent, 2, usage);
    VkCommandBuffer commands = new_commands();
    memcpy((char *)geometry.bytes + region.bufferOffset, texels, 8);
    move_image(commands, own.image, VK_IMAGE_LAYOUT_UNDEFINED,
               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdCopyBufferToImage(commands, geometry.handle, own.image,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    move_image(commands, own.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    finish_commands(commands);
    return own;
}

/* Renders a frame. Every texel in the host's `color` must have these codes, within 2 for
 * rounding. */
static void draws(struct dt_vk_runtime *rt, const struct own_image *color, const double codes[3])
{
    struct dt_frame frame = frame_of(0);
    VkCommandBuffer commands = new_commands();
    assert_true(dt_vk_record(rt, commands, &frame, NULL));
    copy_image(commands, color->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, GEOMETRY_BYTES / 2);
    finish_commands(commands);
    const uint8_t *texels = (const uint8_t *)geometry.bytes + GEOMETRY_BYTES / 2;
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

TEST_WITH(vulkan_draws_the_hosts_textures, NULL, is_silent)
{
    static const uint8_t texels[2][4] = {{250, 60, 60, 255}, {60, 188, 120, 255}};
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const struct own_image textures = make_textures(texels);
    const struct own_image color =
        make_image(VK_FORMAT_R8G8B8A8_UNORM, (VkExtent3D){WIDTH, HEIGHT, 1}, 1, usage);
    const struct dt_vk_image target = import_of(&color, VK_FORMAT_R8G8B8A8_UNORM, usage, WIDTH);
    struct dt_material *material = (struct dt_material *)((char *)geometry.bytes + MATERIALS);
    struct dt_vk_runtime *rt = open_features();
    struct dt_vk_scene scene = vk_scene;
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
    assert_true(dt_vk_import_scene(rt, &vk_scene) && dt_vk_resize(rt, WIDTH, HEIGHT));
    draws(rt, &color, (double[]){255, 127.5, 255});
    dt_vk_close(rt);
    destroy_image(&textures); /* the runtime did not destroy them */
    destroy_image(&color);
    memset(material, 0, sizeof *material);
}

/* A 3D image and a cube of the host's. */
TEST_WITH(vulkan_takes_3d_images_and_cubes, NULL, is_silent)
{
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
    struct dt_vk_runtime *rt = open_vk_runtime(vk_host(), NULL);
    assert_true(dt_vk_create(rt, &shapes_vk));
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
    VkCommandBuffer commands = new_commands();
    assert_true(dt_vk_record(rt, commands, &frame, NULL));
    vkCmdCopyImageToBuffer(commands, fog.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           geometry.handle, 1, &region);
    finish_commands(commands);
    is_last_fog((const uint16_t *)((char *)geometry.bytes + region.bufferOffset) +
                4 * (8 * 6 * 5 - 1));
    dt_vk_close(rt);
    destroy_image(&fog);
    destroy_image(&sky);
}

/* If content is replaced between two frames of one command buffer, only the second frame has the
 * new content. */
TEST_WITH(vulkan_takes_inputs, NULL, is_silent)
{
    enum { FIRST = GEOMETRY_BYTES / 2, SECOND = FIRST + 4 * WIDTH * HEIGHT };
    outside.rt = open_vk_runtime(vk_host(), &outside_vk);
    const struct dt_vk_image image = {.image = (VkImage)&heard /* never used as one */};
    REFUSED(dt_vk_import_image(outside.rt, OUTSIDE_RESOURCE_PHOTO, &image),
            "which the layout_before");    /* no import: hand_in writes the photo */
    for (int turn = 0; turn < 2; turn++) { /* a resize drops all content */
        assert_true(dt_vk_resize(outside.rt, WIDTH, HEIGHT));
        outside.commands = new_commands();
        REFUSED(vulkan_records(), "mip 0 of the input kernel has no content");
        hand_in(vulkan_writes, vulkan_records, first_color);
        record_picture(FIRST);
        write_grade(vulkan_writes, second_color);
        record_picture(SECOND);
        finish_commands(outside.commands);
        is_painted((const uint8_t *)geometry.bytes + FIRST, first_color);
        is_painted((const uint8_t *)geometry.bytes + SECOND, second_color);
    }
    dt_vk_close(outside.rt);
}

/* Renders with these weights in the host's buffer; the picture must have this colour. */
static void vulkan_paints_with(const float weights[8], VkDeviceSize at, const uint8_t color[4])
{
    memcpy((char *)geometry.bytes + at, weights, sizeof graded_alone);
    record_picture(GEOMETRY_BYTES / 2);
    finish_commands(outside.commands);
    is_painted((const uint8_t *)geometry.bytes + GEOMETRY_BYTES / 2, color);
}

TEST_WITH(vulkan_takes_buffers, NULL, is_silent)
{
    const VkImageUsageFlags drawn = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    struct dt_vk_range weights = {geometry.handle, GEOMETRY_BYTES / 4, 16};
    struct dt_vk_resource found;
    struct dt_vk_runtime *rt = outside.rt = open_vk_runtime(vk_host(), NULL);
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
    outside.commands = new_commands();
    write_inputs(vulkan_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(vulkan_writes, first_color);
    vulkan_paints_with(graded_alone, weights.offset, first_color);
    outside.commands = new_commands();
    vulkan_paints_with(nothing, weights.offset, black);
    assert_true(dt_vk_get_resource(rt, OUTSIDE_RESOURCE_WEIGHTS, &found));
    assert_true(found.buffer == geometry.handle && found.offset == weights.offset &&
                found.size == 32 && found.stride == 16 && !found.image);
    assert_true(dt_vk_get_resource(rt, OUTSIDE_RESOURCE_KERNEL, &found));
    assert_true(found.buffer != geometry.handle && found.size % 4 == 0 && found.stride == 4 &&
                found.buffer_usage & VK_BUFFER_USAGE_VERTEX_BUFFER_BIT &&
                found.buffer_usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    assert_true(dt_vk_get_resource(rt, OUTSIDE_RESOURCE_BLURRED, &found)); /* `keep: true` */
    assert_true(found.usage & drawn && found.format == VK_FORMAT_R16G16B16A16_SFLOAT);
    weights.buffer = VK_NULL_HANDLE; /* canceled */
    assert_true(dt_vk_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    outside.commands = new_commands();
    hand_in(vulkan_writes, vulkan_records, second_color);
    finish_commands(outside.commands);
    dt_vk_close(rt);
}

/* Imports have the stages of the passes that write them, or of a clear in their place. */
TEST_WITH(vulkan_tells_stages, NULL, is_silent)
{
    static const struct {
        uint32_t resource, width, height, layers;
        VkFormat format;
        VkImageUsageFlags usage;
        VkPipelineStageFlags2 stages;
        VkAccessFlags2 accesses;
    } cases[] = {
        {FEATURES_RESOURCE_SHOWN, WIDTH, HEIGHT, 1, VK_FORMAT_R8G8B8A8_UNORM,
         VK_IMAGE_USAGE_STORAGE_BIT, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
         VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT},
        {FEATURES_RESOURCE_BLURRED, WIDTH, HEIGHT, 1, VK_FORMAT_R16G16B16A16_SFLOAT,
         VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_STORAGE_BIT,
         VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
        {FEATURES_RESOURCE_SLICE_DEPTH, 8, 8, 3, VK_FORMAT_D32_SFLOAT,
         VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
         VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
         VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
    };
    struct own_image images[DT_ARRAY_COUNT(cases)];
    struct dt_frame frame = frame_of(0);
    struct dt_vk_resource found;
    struct dt_vk_runtime *rt = open_features();
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        const VkExtent3D extent = {cases[i].width, cases[i].height, 1};
        images[i] = create_image(&(VkImageCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                                      .imageType = VK_IMAGE_TYPE_2D,
                                                      .format = cases[i].format,
                                                      .extent = extent,
                                                      .mipLevels = 1,
                                                      .arrayLayers = cases[i].layers,
                                                      .samples = VK_SAMPLE_COUNT_1_BIT,
                                                      .usage = cases[i].usage});
        assert_true(dt_vk_import_image(
            rt, cases[i].resource,
            &(struct dt_vk_image){images[i].image, cases[i].format, cases[i].usage, extent.width,
                                  extent.height, cases[i].layers, 1, 0, 0}));
    }
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        assert_true(dt_vk_get_resource(rt, cases[i].resource, &found));
        assert_int_equal(found.stages, cases[i].stages);
        assert_int_equal(found.accesses, cases[i].accesses);
    }
    struct features_live live = *(const struct features_live *)features_pipeline.live_defaults;
    live.blur = 0;
    assert_true(dt_vk_record(rt, new_commands(), &frame, &live));
    assert_true(dt_vk_get_resource(rt, FEATURES_RESOURCE_BLURRED, &found));
    assert_int_equal(found.stages, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT);
    assert_int_equal(found.accesses, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    dt_vk_close(rt);
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++)
        destroy_image(&images[i]);
}

RUN_TESTS("imports", open_vulkan, close_vulkan)
