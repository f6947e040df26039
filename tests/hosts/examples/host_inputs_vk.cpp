/* A C++ renderer on Vulkan that has its own G-buffer lit by lit.yaml: images that it draws and copies and
 * imports, one of them owned by others between frames, lamps that it writes, a gain that is new in each
 * frame. Between the two passes it draws and copies into a resource of the pipeline. Two views, each
 * recorded on a thread of its own, two frames in flight; checks each pixel of each frame. Built against
 * an installed diptych by tests/hosts/install_test.sh. */
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <vector>

#include <diptych_vk.h>

#include "gbuffer.h"
#include "renderer_vk.h"

namespace
{
constexpr uint32_t views_count = 2, others = VK_QUEUE_FAMILY_EXTERNAL;
constexpr VkImageLayout drawn = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
constexpr VkImageSubresourceRange whole = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
constexpr VkFormat formats[TARGETS] = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT,
                                       VK_FORMAT_R8G8B8A8_UNORM};
constexpr VkImageLayout layouts[TARGETS] = {drawn, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, drawn};
constexpr uint32_t inputs[TARGETS] = {LIT_RESOURCE_GBUFFER_POSITION, LIT_RESOURCE_GBUFFER_NORMAL,
                                      LIT_RESOURCE_GBUFFER_ALBEDO};

/* What the renderer copies in. */
struct Upload {
    uint16_t normals[ROWS * TILE][COLUMNS * TILE][4]; /* halves */
    float mark[TILE][TILE];
};

struct View {
    dt_vk_runtime *rt;
    picture gbuffer[TARGETS];
    VkImageView targets[TARGETS];
    buffer uploads[IN_FLIGHT], pixels[IN_FLIGHT]; /* pixels: of the pictures */
};

struct Host {
    renderer base;
    View views[views_count];
    uint32_t frame;
};

void on_log(void *, dt_level level, const char *message)
{
    if (level >= DT_WARNING)
        std::fprintf(stderr, "diptych: %s\n", message);
}

bool suits(VkInstance instance, VkPhysicalDevice physical)
{
    dt_vk_host host = {};
    host.log.message = on_log;
    host.instance = instance;
    host.physical_device = physical;
    host.get_instance_proc_addr = vkGetInstanceProcAddr;
    return dt_vk_suits(&host, &lit_vk);
}

/* ---- Drawing, without any pipeline of the renderer's own ------------------------------------- */

void begin_drawing(VkCommandBuffer commands, const VkRect2D &area, VkImageLayout layout,
                   VkAttachmentLoadOp load, const VkImageView *views, uint32_t count)
{
    std::vector<VkRenderingAttachmentInfo> targets(count);
    for (uint32_t i = 0; i < count; i++) {
        targets[i].sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
        targets[i].imageView = views[i];
        targets[i].imageLayout = layout;
        targets[i].loadOp = load;
        targets[i].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    }
    VkRenderingInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea = area;
    info.layerCount = 1;
    info.colorAttachmentCount = count;
    info.pColorAttachments = targets.data();
    vkCmdBeginRendering(commands, &info);
}

VkRect2D place_of(uint32_t column, uint32_t row)
{
    return {{int32_t(column * TILE), int32_t(row * TILE)}, {TILE, TILE}};
}

void draw_tile(VkCommandBuffer commands, uint32_t target, uint32_t column, uint32_t row,
               const float color[4])
{
    VkClearAttachment clear = {VK_IMAGE_ASPECT_COLOR_BIT, target, {}};
    std::memcpy(clear.clearValue.color.float32, color, 4 * sizeof *color);
    const VkClearRect rect = {place_of(column, row), 0, 1};
    vkCmdClearAttachments(commands, 1, &clear, 1, &rect);
}

void copy_in(VkCommandBuffer commands, VkBuffer from, VkDeviceSize offset, VkImage to,
             VkImageLayout layout, const VkRect2D &area)
{
    VkBufferImageCopy region = {};
    region.bufferOffset = offset;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageOffset = {area.offset.x, area.offset.y, 0};
    region.imageExtent = {area.extent.width, area.extent.height, 1};
    vkCmdCopyBufferToImage(commands, from, to, layout, 1, &region);
}

/* The renderer's only barriers: a target's first layout, and the albedo's way to the others and back. */
void move_target(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                 uint32_t from_family, uint32_t to_family)
{
    VkImageMemoryBarrier2 barrier = {};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = from_family;
    barrier.dstQueueFamilyIndex = to_family;
    barrier.image = image;
    barrier.subresourceRange = whole;
    const VkDependencyInfo info = {
        VK_STRUCTURE_TYPE_DEPENDENCY_INFO, nullptr, 0, 0, nullptr, 0, nullptr, 1, &barrier};
    vkCmdPipelineBarrier2(commands, &info);
}

void fill_upload(Upload &upload, uint32_t moment)
{
    constexpr uint16_t one = 0x3C00;
    for (uint32_t y = 0; y < ROWS * TILE; y++)
        for (uint32_t x = 0; x < COLUMNS * TILE; x++)
            for (uint32_t k = 0; k < 4; k++) {
                const tile from = tile_at(moment, x / TILE, y / TILE);
                upload.normals[y][x][k] = from.targets[NORMAL][k] != 0 ? one : 0;
            }
    for (auto &row : upload.mark)
        std::fill_n(row, TILE, mark[0]);
}

void draw_gbuffer(const Host &host, VkCommandBuffer commands, const View &view, uint32_t moment)
{
    const VkImageView targets[] = {view.targets[POSITION], view.targets[ALBEDO]};
    VkImage albedo = view.gbuffer[ALBEDO].image;
    for (uint32_t i = 0; host.frame == 0 && i < TARGETS; i++)
        move_target(commands, view.gbuffer[i].image, VK_IMAGE_LAYOUT_UNDEFINED, layouts[i], 0, 0);
    if (host.frame > 0)
        move_target(commands, albedo, drawn, drawn, others, 0);
    begin_drawing(commands, {{}, {host.base.width, host.base.height}}, drawn,
                  VK_ATTACHMENT_LOAD_OP_DONT_CARE, targets, 2);
    for (uint32_t i = 0; i < ROWS * COLUMNS; i++) {
        const uint32_t column = i % COLUMNS, row = i / COLUMNS;
        const tile colors = tile_at(moment, column, row);
        draw_tile(commands, 0, column, row, colors.targets[POSITION]);
        draw_tile(commands, 1, column, row, colors.targets[ALBEDO]);
    }
    vkCmdEndRendering(commands);
    copy_in(commands, view.uploads[host.frame % IN_FLIGHT].handle, 0, view.gbuffer[NORMAL].image,
            layouts[NORMAL], {{}, {host.base.width, host.base.height}});
}

/* Into the irradiance, which the pass before wrote and the pass after reads: one tile is drawn, the other
 * copied. Lamps are bound as vertices, as for a draw of them. */
void draw_marks(const Host &host, VkCommandBuffer commands, const View &view)
{
    dt_vk_resource irradiance, lamps;
    check(dt_vk_get_resource(view.rt, LIT_RESOURCE_IRRADIANCE, &irradiance) &&
              irradiance.format == VK_FORMAT_R32_SFLOAT && irradiance.width == host.base.width &&
              irradiance.height == host.base.height && irradiance.layers == 1 &&
              irradiance.mips == 1 && irradiance.usage & VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT &&
              irradiance.layout == VK_IMAGE_LAYOUT_GENERAL && !irradiance.buffer,
          "taking the irradiance");
    check(dt_vk_get_resource(view.rt, LIT_RESOURCE_LAMPS, &lamps) && lamps.offset == 0 &&
              lamps.size == LAMPS * sizeof(lit_Lamp) && lamps.stride == sizeof(lit_Lamp) &&
              lamps.buffer_usage & VK_BUFFER_USAGE_VERTEX_BUFFER_BIT && !lamps.image,
          "taking the lamps");
    begin_drawing(commands, place_of(1, MARKED_ROW), irradiance.layout, VK_ATTACHMENT_LOAD_OP_LOAD,
                  &irradiance.view, 1);
    vkCmdBindVertexBuffers(commands, 0, 1, &lamps.buffer, &lamps.offset);
    draw_tile(commands, 0, 1, MARKED_ROW, mark);
    vkCmdEndRendering(commands);
    copy_in(commands, view.uploads[host.frame % IN_FLIGHT].handle, offsetof(Upload, mark),
            irradiance.image, irradiance.layout, place_of(2, MARKED_ROW));
}

/* ---- Views ----------------------------------------------------------------------------------- */

void import_target(const renderer &base, View &view, uint32_t i)
{
    constexpr VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                        VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                        VK_IMAGE_USAGE_STORAGE_BIT;
    view.gbuffer[i] = make_picture(&base, formats[i], usage);
    VkImageViewCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    info.image = view.gbuffer[i].image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = formats[i];
    info.subresourceRange = whole;
    CHECK(vkCreateImageView(base.device, &info, nullptr, &view.targets[i]));
    const dt_vk_image import = {info.image, formats[i], usage,      base.width, base.height,
                                1,          1,          layouts[i], layouts[i]};
    check(dt_vk_import_image(view.rt, inputs[i], &import), "importing a target");
}

void open_view(Host &host, uint32_t lane)
{
    View &view = host.views[lane];
    const renderer &base = host.base;
    dt_vk_host what = {};
    what.log.message = on_log;
    what.instance = base.instance;
    what.physical_device = base.physical;
    what.device = base.device;
    what.get_instance_proc_addr = vkGetInstanceProcAddr;
    what.device_info = &base.device_info;
    view.rt = dt_vk_open(&what);
    check(view.rt && dt_vk_create(view.rt, &lit_vk), "opening a view");
    for (uint32_t i = 0; i < TARGETS; i++)
        import_target(base, view, i);
    for (uint32_t i = 0; i < IN_FLIGHT; i++) {
        view.uploads[i] = make_buffer(&base, sizeof(Upload), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        view.pixels[i] = make_buffer(&base, VkDeviceSize(4) * base.width * base.height,
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    }
    check(dt_vk_add_image_usage(view.rt, LIT_RESOURCE_IRRADIANCE,
                                VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT) &&
              dt_vk_add_buffer_usage(view.rt, LIT_RESOURCE_LAMPS,
                                     VK_BUFFER_USAGE_VERTEX_BUFFER_BIT) &&
              dt_vk_resize(view.rt, base.width, base.height),
          "making a view's resources");
}

void check_pixels(Host &host, uint32_t frame)
{
    for (uint32_t lane = 0; lane < views_count; lane++)
        check(is_lit(static_cast<const uint8_t *>(host.views[lane].pixels[frame % IN_FLIGHT].bytes),
                     frame + lane),
              "lighting");
}

void copy_out(const Host &host, VkCommandBuffer commands, const View &view)
{
    dt_vk_resource shown;
    const VkBufferImageCopy region = {
        0, 0, 0, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, {}, {host.base.width, host.base.height, 1}};
    check(dt_vk_get_resource(view.rt, LIT_RESOURCE_SHOWN, &shown), "taking the picture");
    vkCmdCopyImageToBuffer(commands, shown.image, shown.layout,
                           view.pixels[host.frame % IN_FLIGHT].handle, 1, &region);
}

/* On a thread. The second view is a moment ahead. */
void record_view(void *data, uint32_t lane)
{
    Host &host = *static_cast<Host *>(data);
    const View &view = host.views[lane];
    const uint32_t moment = host.frame + lane;
    lit_Lamp lamps[LAMPS] = {lamp_at(moment, 0), lamp_at(moment, 1)};
    const dt_bytes bytes = {reinterpret_cast<uint8_t *>(lamps), sizeof lamps, {LAMPS, 1, 1}};
    const lit_live live = {gain_at(moment), {}};
    dt_frame frame = {};
    frame.index = host.frame;
    VkCommandBuffer commands = begin_commands(&host.base, host.frame, lane);
    if (host.frame == 0 || moment % 2 == 0)
        check(dt_vk_write(view.rt, commands, LIT_RESOURCE_LAMPS, 0, &bytes), "writing the lamps");
    fill_upload(*static_cast<Upload *>(view.uploads[host.frame % IN_FLIGHT].bytes), moment);
    draw_gbuffer(host, commands, view, moment);
    check(dt_vk_record_passes(view.rt, commands, &frame, &live, 0, LIT_PASS_SHADE), "a frame");
    draw_marks(host, commands, view);
    check(dt_vk_record_passes(view.rt, commands, nullptr, nullptr, LIT_PASS_SHADE, LIT_PASSES),
          "the rest of a frame");
    move_target(commands, view.gbuffer[ALBEDO].image, drawn, drawn, 0, others);
    copy_out(host, commands, view);
}

void close_view(const Host &host, const View &view)
{
    dt_vk_close(view.rt);
    for (uint32_t i = 0; i < TARGETS; i++) {
        vkDestroyImageView(host.base.device, view.targets[i], nullptr);
        destroy_picture(&host.base, &view.gbuffer[i]);
    }
    for (uint32_t i = 0; i < IN_FLIGHT; i++) {
        destroy_buffer(&host.base, &view.uploads[i]);
        destroy_buffer(&host.base, &view.pixels[i]);
    }
}

void run(Host &host)
{
    host.base.width = COLUMNS * TILE;
    host.base.height = ROWS * TILE;
    renderer_open(&host.base, suits);
    for (uint32_t lane = 0; lane < views_count; lane++)
        open_view(host, lane);
    for (host.frame = 0; host.frame < MOMENTS; host.frame++) {
        begin_frame(&host.base, host.frame);
        if (host.frame >= IN_FLIGHT)
            check_pixels(host, host.frame - IN_FLIGHT);
        renderer_run(&host.base, views_count, record_view, &host);
        end_frame(&host.base, host.frame, views_count);
    }
    wait_for_frames(&host.base);
    for (uint32_t frame = MOMENTS - IN_FLIGHT; frame < MOMENTS; frame++)
        check_pixels(host, frame);
    for (const View &view : host.views)
        close_view(host, view);
    renderer_close(&host.base);
}
} // namespace

int main()
{
    static Host host;
    renderer &base = host.base;
    renderer_prepare(&base);
    base.vulkan13.dynamicRendering = VK_TRUE; /* the renderer's own needs */
    base.vulkan13.synchronization2 = VK_TRUE;
    dt_vk_need_features(&lit_vk, &base.core, &base.vulkan11, &base.vulkan12, &base.vulkan13);
    run(host);
    return 0;
}
