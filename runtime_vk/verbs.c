/* The verbs of a frame as Vulkan commands: labels and timestamps around passes, barriers,
 * dispatches, draws and clears. */
#include "internal.h"

#include <string.h>

enum { BARRIER_BATCH = 64 };

/* ---- Passes ---------------------------------------------------------------------------------- */

/* `end`: 0 or 1. */
static void write_timestamp(const struct dt_vk_runtime *rt, uint32_t pass, uint32_t end)
{
    rt->vk.CmdWriteTimestamp2(rt->frame_commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, rt->queries,
                              2 * dt_run(&rt->core, rt->core.slot, pass) + end);
}

static bool begin(struct dt_core *core, uint32_t pass, bool runs)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    VkDebugUtilsLabelEXT label = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
        .pLabelName = dt_pass_name(&rt->core, pass),
    };
    if (rt->begin_label)
        rt->begin_label(rt->frame_commands, &label);
    if (!rt->core.timing || !runs)
        return true;
    write_timestamp(rt, pass, 0);
    /* lavapipe draws later, but dispatches at once, and notes the time when it draws: a dispatch
     * that waits for nothing would be over before its time begins. Any barrier makes it draw; one
     * of nothing hides no hazard from validation. */
    const VkDependencyInfo nothing = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    if (rt->core.device.software)
        rt->vk.CmdPipelineBarrier2(rt->frame_commands, &nothing);
    return true;
}

static bool end(struct dt_core *core, uint32_t pass)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    if (rt->core.timing && rt->core.ran[dt_run(&rt->core, rt->core.slot, pass)])
        write_timestamp(rt, pass, 1);
    if (rt->end_label)
        rt->end_label(rt->frame_commands);
    return true;
}

/* ---- Barriers -------------------------------------------------------------------------------- */

/* `flags[i]` stands for bit i of the mask. */
static VkFlags64 translate(unsigned mask, const VkFlags64 *flags)
{
    VkFlags64 bits = 0;
    for (; mask; mask &= mask - 1)
        bits |= flags[__builtin_ctz(mask)];
    return bits;
}

/* The place of a single bit. */
#define BIT(mask) __builtin_ctz(mask)

/* Validation layers 1.3.239 count vkCmdFillBuffer as a copy, not as a clear: clears wait for both. */
VkPipelineStageFlags2 vk_stages(unsigned stages)
{
    static const VkFlags64 flags[] = {
        [BIT(DT_STAGE_COMPUTE)] = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
        [BIT(DT_STAGE_VERTEX)] = VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
        [BIT(DT_STAGE_FRAGMENT)] = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
        [BIT(DT_STAGE_COLOR)] = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
        [BIT(DT_STAGE_DEPTH)] = VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
                                VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
        [BIT(DT_STAGE_INDIRECT)] = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
        [BIT(DT_STAGE_INDEX)] = VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT,
        [BIT(DT_STAGE_CLEAR)] = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
    };
    return translate(stages, flags);
}

VkAccessFlags2 vk_accesses(unsigned accesses)
{
    static const VkFlags64 flags[] = {
        [BIT(DT_READ_STORAGE)] = VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
        [BIT(DT_WRITE_STORAGE)] = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
        [BIT(DT_READ_TEXTURE)] = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
        [BIT(DT_READ_UNIFORM)] = VK_ACCESS_2_UNIFORM_READ_BIT,
        [BIT(DT_READ_COLOR)] = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT,
        [BIT(DT_WRITE_COLOR)] = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
        [BIT(DT_READ_DEPTH)] = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
        [BIT(DT_WRITE_DEPTH)] = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
        [BIT(DT_READ_INDIRECT)] = VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT,
        [BIT(DT_READ_INDEX)] = VK_ACCESS_2_INDEX_READ_BIT,
        [BIT(DT_WRITE_CLEAR)] = VK_ACCESS_2_TRANSFER_WRITE_BIT,
    };
    return translate(accesses, flags);
}

static VkBufferMemoryBarrier2 buffer_barrier(const struct dt_barrier *barrier,
                                             const struct vk_buffer *buffer)
{
    return (VkBufferMemoryBarrier2){
        .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2,
        .srcStageMask = vk_stages(barrier->from_stages),
        .srcAccessMask = vk_accesses(barrier->from),
        .dstStageMask = vk_stages(barrier->to_stages),
        .dstAccessMask = vk_accesses(barrier->to),
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .buffer = buffer->handle,
        .offset = buffer->offset,
        .size = VK_WHOLE_SIZE,
    };
}

/* A first use of shared memory waits for nobody in this frame, and the frame's own barrier has shown what
 * the frame before wrote. Validation layers 1.3.239 want to be told again. poisoned: the fill of discarded memory stays. */
static VkImageMemoryBarrier2 image_barrier(const struct dt_barrier *barrier, struct vk_image *image,
                                           bool poisoned)
{
    bool first = barrier->discard && barrier->from_stages && !barrier->from;
    VkImageLayout old = barrier->discard && !poisoned ? VK_IMAGE_LAYOUT_UNDEFINED : image->layout;
    image->layout = vk_layout(barrier->layout);
    return (VkImageMemoryBarrier2){
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = vk_stages(barrier->from_stages),
        .srcAccessMask = first ? VK_ACCESS_2_MEMORY_WRITE_BIT : vk_accesses(barrier->from),
        .dstStageMask = vk_stages(barrier->to_stages),
        .dstAccessMask = vk_accesses(barrier->to),
        .oldLayout = old,
        .newLayout = image->layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->handle,
        .subresourceRange = {image->aspect, 0, image->mips, 0, image->layers},
    };
}

/* One vkCmdPipelineBarrier2 for up to BARRIER_BATCH of them. */
static bool barriers(struct dt_core *core, uint32_t pass, const struct dt_barrier *list,
                     uint32_t count)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    VkBufferMemoryBarrier2 buffers[BARRIER_BATCH];
    VkImageMemoryBarrier2 images[BARRIER_BATCH];
    (void)pass;
    for (uint32_t at = 0; at < count; at += BARRIER_BATCH) {
        VkDependencyInfo info = {
            .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
            .pBufferMemoryBarriers = buffers,
            .pImageMemoryBarriers = images,
        };
        for (uint32_t i = at; i < count && i < at + BARRIER_BATCH; i++) {
            struct vk_resource *resource = vk_resource_at(rt, list[i].resource);
            if (list[i].layout != DT_LAYOUT_NONE)
                images[info.imageMemoryBarrierCount++] =
                    image_barrier(&list[i], &resource->image, rt->core.poison);
            else
                buffers[info.bufferMemoryBarrierCount++] =
                    buffer_barrier(&list[i], &resource->buffer);
        }
        if (info.bufferMemoryBarrierCount + info.imageMemoryBarrierCount > 0)
            rt->vk.CmdPipelineBarrier2(rt->frame_commands, &info);
    }
    return true;
}

/* ---- Dispatches ------------------------------------------------------------------------------ */

/* Pipelines without attributes also lack their dynamic strides: afterwards they must be bound again. */
static bool bind(struct dt_core *core, uint32_t pass)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct vk_program *program = dt_program(&rt->core, pass);
    VkPipelineBindPoint point = rt->core.pipeline->passes[pass].kind == DT_PASS_DISPATCH
                                    ? VK_PIPELINE_BIND_POINT_COMPUTE
                                    : VK_PIPELINE_BIND_POINT_GRAPHICS;
    if (point == VK_PIPELINE_BIND_POINT_GRAPHICS && !rt->core.panel->programs[pass].attributes)
        rt->bound.indices = NULL;
    rt->vk.CmdBindPipeline(rt->frame_commands, point, program->handle);
    if (program->set)
        rt->vk.CmdBindDescriptorSets(rt->frame_commands, point, program->layout, 0, 1,
                                     &program->set, 0, NULL);
    return true;
}

static bool dispatch(struct dt_core *core, uint32_t pass, uint32_t x, uint32_t y, uint32_t z)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    (void)pass;
    rt->vk.CmdDispatch(rt->frame_commands, x, y, z);
    return true;
}

static bool dispatch_indirect(struct dt_core *core, uint32_t pass, uint32_t arguments)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct vk_buffer *buffer = &vk_resource_at(rt, arguments)->buffer;
    (void)pass;
    rt->vk.CmdDispatchIndirect(rt->frame_commands, buffer->handle, buffer->offset);
    return true;
}

/* ---- Draws ----------------------------------------------------------------------------------- */

static VkClearColorValue clear_color(const struct vk_image *image, const float clear[4])
{
    VkClearColorValue value;
    for (int i = 0; i < 4; i++) {
        switch (dt_front_scalar(image->texel)) {
        case DT_TYPE_UINT:
            value.uint32[i] = (uint32_t)clear[i];
            break;
        case DT_TYPE_INT:
            value.int32[i] = (int32_t)clear[i];
            break;
        default:
            value.float32[i] = clear[i];
        }
    }
    return value;
}

/* `layer`: one of a layered target; -1: all. */
static VkRenderingAttachmentInfo attachment(const struct dt_vk_runtime *rt,
                                            const struct dt_target *target, int32_t layer)
{
    const struct vk_image *image = &vk_resource_at(rt, target->resource)->image;
    const float *clear = rt->core.panel->storage[target->resource].clear;
    VkRenderingAttachmentInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = layer < 0 ? vk_image_view(image, target->mip, target->one_layer, target->layer)
                               : vk_image_view(image, target->mip, true, (uint32_t)layer),
        .imageLayout = image->layout,
        .loadOp = target->load ? VK_ATTACHMENT_LOAD_OP_LOAD : VK_ATTACHMENT_LOAD_OP_CLEAR,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
    };
    if (image->aspect & VK_IMAGE_ASPECT_DEPTH_BIT)
        info.clearValue.depthStencil.depth = clear[0];
    else
        info.clearValue.color = clear_color(image, clear);
    return info;
}

static void set_area(struct dt_vk_runtime *rt, VkViewport viewport, VkRect2D scissor)
{
    struct vk_bound *bound = &rt->bound;
    if (memcmp(&bound->viewport, &viewport, sizeof viewport) == 0 &&
        memcmp(&bound->scissor, &scissor, sizeof scissor) == 0)
        return;
    bound->viewport = viewport;
    bound->scissor = scissor;
    rt->vk.CmdSetViewport(rt->frame_commands, 0, 1, &viewport);
    rt->vk.CmdSetScissor(rt->frame_commands, 0, 1, &scissor);
}

static void begin_rendering(struct dt_vk_runtime *rt, uint32_t pass, uint32_t layers, int32_t layer)
{
    const struct dt_program *program = &rt->core.panel->programs[pass];
    VkRenderingAttachmentInfo colors[DT_MAX_COLOR_TARGETS], depth;
    const struct dt_target *first = program->color_count ? &program->colors[0] : program->depth;
    const struct vk_image *image = &vk_resource_at(rt, first->resource)->image;
    uint32_t width = image->width >> first->mip, height = image->height >> first->mip;
    VkRect2D area = {.extent = {width ? width : 1, height ? height : 1}};
    struct dt_rect view, cut;
    dt_front_area(&rt->core, area.extent.width, area.extent.height, &view, &cut);
    VkViewport viewport = {
        (float)view.x, (float)view.y, (float)view.width, (float)view.height, 0, 1};
    VkRect2D scissor = {{cut.x, cut.y}, {cut.width, cut.height}};
    for (uint32_t i = 0; i < program->color_count; i++)
        colors[i] = attachment(rt, &program->colors[i], layer);
    if (program->depth)
        depth = attachment(rt, program->depth, layer);
    VkRenderingInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        .renderArea = area,
        .layerCount = layer < 0 ? layers : 1,
        .colorAttachmentCount = program->color_count,
        .pColorAttachments = colors,
        .pDepthAttachment = program->depth ? &depth : NULL,
    };
    rt->vk.CmdBeginRendering(rt->frame_commands, &info);
    set_area(rt, viewport, scissor);
}

/* Begins to render into all layers, or, on a device without shaderOutputLayer, into one after the
 * other; ends what it began before. False after the last. */
static bool next_layers(struct dt_vk_runtime *rt, uint32_t pass, uint32_t layers, uint32_t *done)
{
    bool layered = rt->core.panel->programs[pass].layered, alone = layered && !vk_has_layers(rt);
    int32_t layer = alone ? (int32_t)*done : -1;
    const struct vk_program *program = dt_program(&rt->core, pass);
    if (*done)
        rt->vk.CmdEndRendering(rt->frame_commands);
    if (*done == layers)
        return false;
    begin_rendering(rt, pass, layers, layer);
    if (layered)
        rt->vk.CmdPushConstants(rt->frame_commands, program->layout, vk_layer_range.stageFlags, 0,
                                sizeof layer, &layer);
    *done = alone ? *done + 1 : layers;
    return true;
}

bool vk_scene_attributes(struct dt_vk_runtime *rt,
                         const struct dt_vk_attribute given[DT_ATTRIBUTES])
{
    const struct vk_buffer *vertices = vk_buffer_at(rt, DT_SCENE_VERTICES);
    struct dt_vk_attribute *attributes = rt->builtin.attributes, any = {0};
    rt->core.has_vertices = vertices->handle;
    rt->core.attributes = 0;
    for (int i = 0; i < DT_ATTRIBUTES; i++) {
        attributes[i] = given[i].buffer
                            ? given[i]
                            : (struct dt_vk_attribute){vertices->handle,
                                                       vertices->offset + dt_attributes[i].offset,
                                                       sizeof(struct dt_vertex)};
        if (!attributes[i].buffer)
            continue;
        if (!dt_front_attribute(&rt->core, i, attributes[i].offset, attributes[i].stride))
            return false;
        any = attributes[i];
    }
    for (int i = 0; i < DT_ATTRIBUTES; i++)
        if (!attributes[i].buffer)
            attributes[i] = any;
    return true;
}

/* One binding for each attribute. */
static void bind_scene(struct dt_vk_runtime *rt, const struct vk_buffer *indices)
{
    VkBuffer buffers[DT_ATTRIBUTES];
    VkDeviceSize offsets[DT_ATTRIBUTES], strides[DT_ATTRIBUTES];
    if (rt->bound.indices == indices)
        return;
    for (int i = 0; i < DT_ATTRIBUTES; i++) {
        buffers[i] = rt->builtin.attributes[i].buffer;
        offsets[i] = rt->builtin.attributes[i].offset;
        strides[i] = rt->builtin.attributes[i].stride;
    }
    if (!rt->bound.indices)
        rt->vk.CmdBindVertexBuffers2(rt->frame_commands, 0, DT_ATTRIBUTES, buffers, offsets, NULL,
                                     strides);
    rt->bound.indices = indices;
    rt->vk.CmdBindIndexBuffer(rt->frame_commands, indices->handle, indices->offset,
                              VK_INDEX_TYPE_UINT32);
}

/* lavapipe 22.3.6 binds an index buffer at an offset for direct draws only: indirect ones count from the
 * start of the buffer, and draw something else without a word. */
static bool counts_from_start(const struct dt_vk_runtime *rt, uint32_t pass,
                              const struct vk_buffer *indices)
{
    return !indices->offset || strncmp(rt->core.device.name, "llvmpipe", 8) != 0 ||
           dt_error(&rt->core,
                    "pass %s: scene indices at byte %llu, but indirect draws of %s count from the "
                    "start of the buffer; give them a buffer of their own",
                    dt_pass_name(&rt->core, pass), (unsigned long long)indices->offset,
                    rt->core.device.name);
}

static void record_draw(struct dt_vk_runtime *rt, const struct dt_draw *draw, bool indexed)
{
    VkCommandBuffer commands = rt->frame_commands;
    if (draw->arguments == DT_NO_BUFFER && indexed) {
        rt->vk.CmdDrawIndexed(commands, draw->count, draw->instances, 0, 0, 0);
    } else if (draw->arguments == DT_NO_BUFFER) {
        rt->vk.CmdDraw(commands, draw->count, draw->instances, 0, 0);
    } else {
        const struct vk_buffer *draws = vk_buffer_at(rt, draw->arguments);
        uint32_t bytes = indexed ? DT_DRAW_BYTES : DT_VERTEX_DRAW_BYTES;
        (indexed ? rt->vk.CmdDrawIndexedIndirect : rt->vk.CmdDrawIndirect)(
            commands, draws->handle, draws->offset, (uint32_t)(draws->size / bytes), bytes);
    }
}

static bool draw_pass(struct dt_core *core, uint32_t pass, const struct dt_draw *draw)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    bool indexed = draw->indices != DT_NO_BUFFER;
    const struct vk_buffer *indices = indexed ? vk_buffer_at(rt, draw->indices) : NULL;
    if (indexed && draw->arguments != DT_NO_BUFFER && !counts_from_start(rt, pass, indices))
        return false;
    if (indexed)
        bind_scene(rt, indices);
    for (uint32_t done = 0; next_layers(rt, pass, draw->layers, &done);)
        record_draw(rt, draw, indexed);
    return true;
}

/* ---- Clears ---------------------------------------------------------------------------------- */

static bool clear_targets(struct dt_core *core, uint32_t pass, uint32_t layers)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    for (uint32_t done = 0; next_layers(rt, pass, layers, &done);)
        continue;
    return true;
}

/* The plan's barriers order the clears of a pass that may be skipped, too. */
static bool clear_image(struct dt_core *core, uint32_t resource, uint32_t mip)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct vk_image *image = &vk_resource_at(rt, resource)->image;
    VkClearColorValue value = clear_color(image, rt->core.panel->storage[resource].clear);
    VkImageSubresourceRange range = {image->aspect, mip, 1, 0, image->layers};
    rt->vk.CmdClearColorImage(rt->frame_commands, image->handle, image->layout, &value, 1, &range);
    return true;
}

static bool clear_buffer(struct dt_core *core, uint32_t resource)
{
    const struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct vk_buffer *buffer = &vk_resource_at(rt, resource)->buffer;
    rt->vk.CmdFillBuffer(rt->frame_commands, buffer->handle, buffer->offset, buffer->size, 0);
    return true;
}

const struct dt_commands vk_commands = {
    .begin = begin,
    .barriers = barriers,
    .bind = bind,
    .dispatch = dispatch,
    .dispatch_indirect = dispatch_indirect,
    .draw = draw_pass,
    .clear_targets = clear_targets,
    .clear_buffer = clear_buffer,
    .clear_image = clear_image,
    .end = end,
};
