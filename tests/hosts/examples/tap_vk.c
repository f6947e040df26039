/* The same engine as tap_gl.c on Vulkan, with row 0 at the top: `tap_vk FOLDER [faulty]`. The faulty one turns the picture
 * over when it makes it smaller, as if Vulkan's rows began at the bottom. */
#include "renderer_vk.h"

#include "diptych_tap_vk.h"

#include "tap_picture.h"

struct target {
    VkImage image;
    VkDeviceMemory memory;
    int width, height;
};

static struct target make_target(const struct renderer *renderer, VkFormat format, int width,
                                 int height)
{
    struct target target = {.width = width, .height = height};
    VkMemoryRequirements needs;
    CHECK(vkCreateImage(renderer->device,
                        &(VkImageCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                             .imageType = VK_IMAGE_TYPE_2D,
                                             .format = format,
                                             .extent = {(uint32_t)width, (uint32_t)height, 1},
                                             .mipLevels = 1,
                                             .arrayLayers = 1,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                      VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                        NULL, &target.image));
    vkGetImageMemoryRequirements(renderer->device, target.image, &needs);
    target.memory = renderer_allocate(renderer, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    CHECK(vkBindImageMemory(renderer->device, target.image, target.memory, 0));
    return target;
}

/* From UNDEFINED, or between transfers: all targets are GENERAL. */
static void wait_for(VkCommandBuffer commands, VkImage image, VkImageLayout from)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = from,
        .newLayout = VK_IMAGE_LAYOUT_GENERAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         0, 0, NULL, 0, NULL, 1, &barrier);
}

static void fill(VkCommandBuffer commands, const struct buffer *staging, const struct target *to)
{
    const VkBufferImageCopy region = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {(uint32_t)to->width, (uint32_t)to->height, 1}};
    wait_for(commands, to->image, VK_IMAGE_LAYOUT_UNDEFINED);
    vkCmdCopyBufferToImage(commands, staging->handle, to->image, VK_IMAGE_LAYOUT_GENERAL, 1,
                           &region);
    wait_for(commands, to->image, VK_IMAGE_LAYOUT_GENERAL);
}

static void upload(VkCommandBuffer commands, const struct buffer *staging, const struct target *to)
{
    unsigned char(*texels)[WIDTH][4] = staging->bytes;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            paint(texels[y][x], x, y);
    fill(commands, staging, to);
}

static void blit(VkCommandBuffer commands, const struct target *from, const struct target *to,
                 bool over)
{
    const VkImageSubresourceLayers layers = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    const VkImageBlit region = {
        .srcSubresource = layers,
        .srcOffsets = {{0, over ? from->height : 0, 0}, {from->width, over ? 0 : from->height, 1}},
        .dstSubresource = layers,
        .dstOffsets = {{0, 0, 0}, {to->width, to->height, 1}}};
    wait_for(commands, to->image, VK_IMAGE_LAYOUT_UNDEFINED);
    vkCmdBlitImage(commands, from->image, VK_IMAGE_LAYOUT_GENERAL, to->image,
                   VK_IMAGE_LAYOUT_GENERAL, 1, &region, VK_FILTER_NEAREST);
    wait_for(commands, to->image, VK_IMAGE_LAYOUT_GENERAL);
}

static void tap_target(struct tap_vk *taps, VkCommandBuffer commands, const char *pass,
                       const char *resource, const struct target *target, VkFormat format)
{
    const struct tap_vk_image_info image = {.image = target->image,
                                            .format = format,
                                            .layout = VK_IMAGE_LAYOUT_GENERAL,
                                            .width = (unsigned)target->width,
                                            .height = (unsigned)target->height};
    tap_vk_image(taps, commands, pass, resource, &image);
}

static bool suits(VkInstance instance, VkPhysicalDevice physical)
{
    return instance && physical;
}

static void run(struct renderer *renderer, struct tap *tap, bool faulty)
{
    static const struct tap_field fields[] = {
        {"position", "vec3", 0, 0, 0}, {"exposure", "float", 12, 0, 0}, {"id", "uint", 16, 0, 0}};
    const VkFormat format = VK_FORMAT_B8G8R8A8_UNORM, wide = VK_FORMAT_R16G16B16A16_SFLOAT;
    struct tap_vk taps;
    struct target albedo = make_target(renderer, VK_FORMAT_R8G8B8A8_UNORM, WIDTH, HEIGHT);
    struct target small = make_target(renderer, wide, WIDTH / SMALL, HEIGHT / SMALL);
    struct target screen = make_target(renderer, format, WIDTH, HEIGHT);
    struct buffer staging =
        make_buffer(renderer, (VkDeviceSize)WIDTH * HEIGHT * 4, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    struct buffer cameras =
        make_buffer(renderer, sizeof(struct camera[CAMERAS]), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    place(cameras.bytes);
    tap_vk_begin(&taps, tap, renderer->physical, renderer->device);

    begin_frame(renderer, 0);
    VkCommandBuffer commands = begin_commands(renderer, 0, 0);
    upload(commands, &staging, &albedo);
    tap_target(&taps, commands, "upload", "albedo", &albedo, VK_FORMAT_R8G8B8A8_UNORM);
    tap_vk_buffer(&taps, commands, "upload", "cameras", cameras.handle, 0, CAMERAS,
                  sizeof(struct camera), fields, 3);
    blit(commands, &albedo, &small, faulty);
    tap_target(&taps, commands, "downsample", "small", &small, wide);
    blit(commands, &small, &screen, false);
    tap_target(&taps, commands, "present", "screen", &screen, format);
    end_frame(renderer, 0, 1);
    wait_for_frames(renderer);

    tap_vk_end(&taps);
    const struct target *targets[] = {&albedo, &small, &screen};
    for (int i = 0; i < 3; i++) {
        vkDestroyImage(renderer->device, targets[i]->image, NULL);
        vkFreeMemory(renderer->device, targets[i]->memory, NULL);
    }
    destroy_buffer(renderer, &staging);
    destroy_buffer(renderer, &cameras);
}

int main(int argc, char **argv)
{
    static struct renderer renderer = {.width = WIDTH, .height = HEIGHT};
    check(argc == 2 || argc == 3, "usage: tap_vk FOLDER [faulty]:");
    renderer_prepare(&renderer);
    renderer_open(&renderer, suits);
    struct tap *tap = tap_open(argv[1], "vk", NULL);
    run(&renderer, tap, argc > 2);
    check(tap && tap_close(tap), argv[1]);
    renderer_close(&renderer);
    return 0;
}
