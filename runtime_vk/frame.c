/* Recording and running: one frame from begin to the fence, passes with labels and timestamps,
 * barriers, dispatches, draws and clears; and commands that run on the spot. Called by generated
 * pipelines from record, and by the other files of this folder. Nothing here allocates while a
 * frame is recorded. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BARRIER_BATCH = 64 };

/* ---- Command buffers ------------------------------------------------------------------------- */

void vk_full_barrier(const struct vk_runtime *rt, VkCommandBuffer commands)
{
    VkMemoryBarrier2 memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
        .dstAccessMask =
            VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT,
    };
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .memoryBarrierCount = 1,
        .pMemoryBarriers = &memory,
    };
    rt->vk.CmdPipelineBarrier2(commands, &info);
}

void vk_transition(const struct vk_runtime *rt, VkCommandBuffer commands, struct vk_image *image,
                   VkImageLayout layout)
{
    VkImageMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
        .oldLayout = image->layout,
        .newLayout = layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->handle,
        .subresourceRange = {image->aspect, 0, image->mips, 0, image->layers},
    };
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .imageMemoryBarrierCount = 1,
        .pImageMemoryBarriers = &barrier,
    };
    rt->vk.CmdPipelineBarrier2(commands, &info);
    image->layout = layout;
}

/* Every command buffer opens with a full barrier, so that the generated barriers only have to
 * order what stands in one frame, and uploads, read-backs and last frame's history need none. */
static bool begin_commands(struct vk_runtime *rt, VkCommandBuffer commands, const char *name)
{
    VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    if (!VK(rt, rt->vk.ResetCommandBuffer(commands, 0), name) || /* may be left half recorded */
        !VK(rt, rt->vk.BeginCommandBuffer(commands, &info), name))
        return false;
    rt->bound = (struct vk_bound){0};
    vk_full_barrier(rt, commands);
    return true;
}

/* The semaphore, or VK_NULL_HANDLE, is signalled when they are done. */
static bool run_commands(struct vk_runtime *rt, VkCommandBuffer commands, const char *name,
                         VkSemaphore done)
{
    VkSemaphoreSubmitInfo signal = {
        .sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
        .semaphore = done,
        .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
    };
    VkCommandBufferSubmitInfo buffer = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
        .commandBuffer = commands,
    };
    VkSubmitInfo2 submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
        .commandBufferInfoCount = 1,
        .pCommandBufferInfos = &buffer,
        .signalSemaphoreInfoCount = done != VK_NULL_HANDLE,
        .pSignalSemaphoreInfos = &signal,
    };
    vk_full_barrier(rt, commands); /* the fence alone does not show writes to the host */
    return VK(rt, rt->vk.EndCommandBuffer(commands), name) &&
           VK(rt, rt->vk.QueueSubmit2(rt->queue, 1, &submit, rt->fence), name) &&
           VK(rt, rt->vk.WaitForFences(rt->device, 1, &rt->fence, VK_TRUE, UINT64_MAX), name) &&
           VK(rt, rt->vk.ResetFences(rt->device, 1, &rt->fence), name);
}

VkCommandBuffer vk_immediate_begin(struct vk_runtime *rt, const char *name)
{
    return begin_commands(rt, rt->immediate_commands, name) ? rt->immediate_commands : NULL;
}

bool vk_immediate_end(struct vk_runtime *rt, const char *name)
{
    return run_commands(rt, rt->immediate_commands, name, VK_NULL_HANDLE);
}

bool vk_immediate_end_signal(struct vk_runtime *rt, const char *name, VkSemaphore done)
{
    return run_commands(rt, rt->immediate_commands, name, done);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

bool vk_frame_create(struct vk_runtime *rt)
{
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    struct vk_buffer_info live = {
        .name = "live",
        .size = pipeline->block_size,
        .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
    };
    VkQueryPoolCreateInfo queries = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP,
        .queryCount = 2 * pipeline->pass_count,
    };
    rt->pass_runs = calloc(pipeline->pass_count, sizeof *rt->pass_runs);
    rt->pass_ms = calloc(pipeline->pass_count, sizeof *rt->pass_ms);
    if (!rt->pass_runs || !rt->pass_ms)
        return vk_error(rt, "pipeline %s: out of memory; free some", pipeline->name);
    return vk_uniform_create(rt, &rt->builtin.live, &rt->live_memory, &rt->live_slot, &live) &&
           (!rt->timing || VK(rt, rt->vk.CreateQueryPool(rt->device, &queries, NULL, &rt->queries),
                              pipeline->name));
}

void vk_frame_destroy(struct vk_runtime *rt)
{
    vk_uniform_destroy(rt, &rt->builtin.live, &rt->live_memory, &rt->live_slot);
    rt->vk.DestroyQueryPool(rt->device, rt->queries, NULL);
    free(rt->pass_runs);
    free(rt->pass_ms);
    rt->queries = VK_NULL_HANDLE;
    rt->pass_runs = NULL;
    rt->pass_ms = NULL;
    rt->rendered = false;
}

/* Milliseconds of every pass that ran; timestamps wrap at the number of bits that the queue
 * counts with. Nobody waits for a host. */
bool vk_frame_timings(struct vk_runtime *rt)
{
    VkQueryResultFlags wait = rt->hosted ? 0 : VK_QUERY_RESULT_WAIT_BIT;
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    uint64_t mask = rt->timestamp_bits < 64 ? (1ull << rt->timestamp_bits) - 1 : UINT64_MAX;
    for (uint32_t pass = 0; pass < pipeline->pass_count; pass++) {
        uint64_t stamps[2];
        rt->pass_ms[pass] = NAN;
        if (!rt->pass_runs[pass])
            continue;
        if (!VK(rt,
                rt->vk.GetQueryPoolResults(rt->device, rt->queries, 2 * pass, 2, sizeof stamps,
                                           stamps, sizeof stamps[0], VK_QUERY_RESULT_64_BIT | wait),
                pipeline->passes[pass].name))
            return false;
        double ticks = (double)((stamps[1] - stamps[0]) & mask);
        rt->pass_ms[pass] = ticks * (double)rt->properties.limits.timestampPeriod * 1e-6;
    }
    return true;
}

static double thread_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

/* All commands of a frame but the last barrier. */
static bool record_frame(struct vk_runtime *rt, const void *live)
{
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    double start = thread_ms();
    if (!begin_commands(rt, rt->frame_commands, pipeline->name))
        return false;
    if (rt->timing)
        rt->vk.CmdResetQueryPool(rt->frame_commands, rt->queries, 0, 2 * pipeline->pass_count);
    bool good = rt->panel->record(rt, rt->state, live) && !rt->failed;
    rt->record_ms = rt->observer ? NAN : thread_ms() - start;
    return good;
}

static struct dt_frame sized_frame(const struct vk_runtime *rt, const struct dt_frame *frame)
{
    struct dt_frame block = *frame;
    block.width = rt->width;
    block.height = rt->height;
    return block;
}

static void forget_frame(struct vk_runtime *rt)
{
    memset(rt->pass_runs, 0, rt->panel->pipeline->pass_count * sizeof *rt->pass_runs);
    rt->failed = false;
    rt->barriers = 0;
}

/* Of the block with the live parameters, what a frame cannot change. */
static const char *behind_live(const struct dt_pipeline *pipeline)
{
    return (const char *)pipeline->live_defaults + pipeline->live_size;
}

bool vk_frame_render(struct vk_runtime *rt, const struct dt_frame *frame, const void *live)
{
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    struct dt_frame block = sized_frame(rt, frame);
    memcpy(rt->frame_memory.bytes, &block, sizeof block);
    memcpy(rt->live_memory.bytes, live, pipeline->live_size);
    memcpy((char *)rt->live_memory.bytes + pipeline->live_size, behind_live(pipeline),
           pipeline->block_size - pipeline->live_size);
    forget_frame(rt);
    if (!record_frame(rt, live) ||
        !run_commands(rt, rt->frame_commands, pipeline->name, VK_NULL_HANDLE))
        return false;
    uint32_t dropped =
        rt->drop_barrier > rt->drop_dependency ? rt->drop_barrier : rt->drop_dependency;
    if (dropped > rt->barriers)
        return vk_error(rt, "barrier %u: the frame has %u; drop one of those", dropped,
                        rt->barriers);
    return !rt->timing || vk_frame_timings(rt);
}

/* ---- Frames of a host ------------------------------------------------------------------------ */

/* Commands write the uniform blocks, so that frames before this one keep theirs until they are done. */
static void write_uniform(const struct vk_runtime *rt, const struct vk_buffer *buffer,
                          VkDeviceSize offset, const void *data, VkDeviceSize size)
{
    const VkDeviceSize most = 65536; /* in one vkCmdUpdateBuffer */
    for (VkDeviceSize at = 0; at < size; at += most)
        rt->vk.CmdUpdateBuffer(rt->frame_commands, buffer->handle, offset + at,
                               size - at < most ? size - at : most, (const char *)data + at);
}

static void fill_now(struct vk_runtime *rt, const struct vk_fill *fill)
{
    VkCommandBuffer commands = rt->frame_commands;
    struct vk_image *image = fill->user.image;
    const VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    if (!image) {
        rt->vk.CmdFillBuffer(commands, fill->user.buffer->handle, 0, VK_WHOLE_SIZE, 0);
        return;
    }
    VkImageSubresourceRange range = {image->aspect, 0, image->mips, 0, image->layers};
    VkClearDepthStencilValue depth = {.depth = fill->value};
    VkClearColorValue color = {.float32 = {fill->value, fill->value, fill->value, fill->value}};
    vk_transition(rt, commands, image, layout);
    if (image->aspect & VK_IMAGE_ASPECT_DEPTH_BIT)
        rt->vk.CmdClearDepthStencilImage(commands, image->handle, layout, &depth, 1, &range);
    else
        rt->vk.CmdClearColorImage(commands, image->handle, layout, &color, 1, &range);
    vk_transition(rt, commands, image, fill->layout);
}

bool vk_frame_record(struct vk_runtime *rt, VkCommandBuffer commands, const struct dt_frame *frame,
                     const void *live)
{
    const struct dt_pipeline *pipeline = rt->panel->pipeline;
    struct dt_frame block = sized_frame(rt, frame);
    rt->frame_commands = commands;
    forget_frame(rt);
    rt->bound = (struct vk_bound){0};
    vk_full_barrier(rt, commands);
    for (uint32_t i = 0; i < rt->import_count; i++)
        if (rt->imports[i].image)
            rt->imports[i].image->layout = rt->imports[i].given.layout_before;
    write_uniform(rt, &rt->builtin.frame, 0, &block, sizeof block);
    write_uniform(rt, &rt->builtin.live, 0, live, pipeline->live_size);
    write_uniform(rt, &rt->builtin.live, pipeline->live_size, behind_live(pipeline),
                  pipeline->block_size - pipeline->live_size);
    for (uint32_t i = 0; i < rt->fill_count; i++)
        fill_now(rt, &rt->fills[i]);
    rt->fill_count = 0;
    if (rt->timing)
        rt->vk.CmdResetQueryPool(commands, rt->queries, 0, 2 * pipeline->pass_count);
    vk_full_barrier(rt, commands);
    bool good = rt->panel->record(rt, rt->state, live) && !rt->failed;
    for (uint32_t i = 0; i < rt->import_count; i++) {
        const struct vk_import *import = &rt->imports[i];
        if (import->image && import->given.layout_after != VK_IMAGE_LAYOUT_UNDEFINED)
            vk_transition(rt, commands, import->image, import->given.layout_after);
    }
    vk_full_barrier(rt, commands);
    rt->frame_commands = VK_NULL_HANDLE;
    return good;
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static void write_timestamp(struct vk_runtime *rt, uint32_t query)
{
    rt->vk.CmdWriteTimestamp2(rt->frame_commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, rt->queries,
                              query);
}

/* With an observer every pass ends in a submission, so nothing is pending before the next. */
static enum dt_action ask_observer(const struct vk_runtime *rt, uint32_t pass)
{
    const struct dt_observer *observer = rt->observer;
    if (!observer || !observer->before_pass)
        return DT_RUN;
    return observer->before_pass(observer->user, pass);
}

bool dt_vk_pass_begin(struct vk_runtime *rt, uint32_t pass, bool runs)
{
    VkDebugUtilsLabelEXT label = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
        .pLabelName = rt->panel->pipeline->passes[pass].name,
    };
    enum dt_action action = rt->failed ? DT_STOP : ask_observer(rt, pass);
    rt->pass = pass;
    rt->skips = action == DT_SKIP;
    rt->pass_runs[pass] = runs && action == DT_RUN;
    if (action == DT_STOP)
        return false;
    if (rt->begin_label)
        rt->begin_label(rt->frame_commands, &label);
    if (rt->timing && rt->pass_runs[pass]) {
        write_timestamp(rt, 2 * pass);
        /* lavapipe draws later, but dispatches at once, and notes the time when it draws: a dispatch
         * that waits for nothing would be over before its time begins. Any barrier makes it draw; one
         * of nothing hides no hazard from validation. */
        const VkDependencyInfo nothing = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        if (rt->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU)
            rt->vk.CmdPipelineBarrier2(rt->frame_commands, &nothing);
    }
    return true;
}

bool dt_vk_pass_end(struct vk_runtime *rt, uint32_t pass)
{
    const char *name = rt->panel->pipeline->passes[pass].name;
    const struct dt_observer *observer = rt->observer;
    if (rt->timing && rt->pass_runs[pass])
        write_timestamp(rt, 2 * pass + 1);
    if (rt->end_label)
        rt->end_label(rt->frame_commands);
    if (rt->failed || !observer)
        return !rt->failed;
    return run_commands(rt, rt->frame_commands, name, VK_NULL_HANDLE) &&
           (!observer->after_pass || observer->after_pass(observer->user, pass)) &&
           begin_commands(rt, rt->frame_commands, name);
}

/* ---- Barriers -------------------------------------------------------------------------------- */

static VkBufferMemoryBarrier2 buffer_barrier(const struct vk_barrier *barrier)
{
    return (VkBufferMemoryBarrier2){
        .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2,
        .srcStageMask = barrier->src_stage,
        .srcAccessMask = barrier->src_access,
        .dstStageMask = barrier->dst_stage,
        .dstAccessMask = barrier->dst_access,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .buffer = barrier->buffer->handle,
        .size = VK_WHOLE_SIZE,
    };
}

static VkImageMemoryBarrier2 image_barrier(const struct vk_barrier *barrier)
{
    struct vk_image *image = barrier->image;
    VkImageLayout old = barrier->discard ? VK_IMAGE_LAYOUT_UNDEFINED : image->layout;
    image->layout = barrier->layout;
    return (VkImageMemoryBarrier2){
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = barrier->src_stage,
        .srcAccessMask = barrier->src_access,
        .dstStageMask = barrier->dst_stage,
        .dstAccessMask = barrier->dst_access,
        .oldLayout = old,
        .newLayout = barrier->layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->handle,
        .subresourceRange = {image->aspect, 0, image->mips, 0, image->layers},
    };
}

/* Leaves out what options.drop_barrier and drop_dependency name. False: nothing is left of the
 * barrier; all that follows in the frame takes its layout for granted, as hand-written code would. */
static bool keep_barrier(struct vk_runtime *rt, struct vk_barrier *barrier)
{
    const char *pass = rt->panel->pipeline->passes[rt->pass].name;
    struct vk_image *image = barrier->image;
    const char *name = image ? image->name : barrier->buffer->name;
    rt->barriers++;
    if (rt->barriers == rt->drop_dependency) {
        vk_info(rt, "barrier %u waits for nothing: pass %s, resource %s", rt->barriers, pass, name);
        barrier->src_stage = VK_PIPELINE_STAGE_2_NONE;
        barrier->src_access = VK_ACCESS_2_NONE;
    }
    if (rt->barriers != rt->drop_barrier)
        return true;
    vk_info(rt, "dropped barrier %u: pass %s, resource %s, %s", rt->barriers, pass, name,
            image && image->layout != barrier->layout ? "layout change" : "no layout change");
    if (image)
        image->layout = barrier->layout;
    return false;
}

void dt_vk_barriers(struct vk_runtime *rt, const struct vk_barrier *barriers, uint32_t count)
{
    VkBufferMemoryBarrier2 buffers[BARRIER_BATCH];
    VkImageMemoryBarrier2 images[BARRIER_BATCH];
    while (count > 0) {
        uint32_t batch = count < BARRIER_BATCH ? count : BARRIER_BATCH;
        VkDependencyInfo info = {
            .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
            .pBufferMemoryBarriers = buffers,
            .pImageMemoryBarriers = images,
        };
        for (uint32_t i = 0; i < batch; i++) {
            struct vk_barrier barrier = barriers[i];
            if (!keep_barrier(rt, &barrier))
                continue;
            if (barrier.buffer)
                buffers[info.bufferMemoryBarrierCount++] = buffer_barrier(&barrier);
            else
                images[info.imageMemoryBarrierCount++] = image_barrier(&barrier);
        }
        if (info.bufferMemoryBarrierCount + info.imageMemoryBarrierCount > 0)
            rt->vk.CmdPipelineBarrier2(rt->frame_commands, &info);
        barriers += batch;
        count -= batch;
    }
}

/* ---- Dispatches ------------------------------------------------------------------------------ */

static void bind_program(struct vk_runtime *rt, const struct vk_program *program,
                         VkPipelineBindPoint point)
{
    rt->vk.CmdBindPipeline(rt->frame_commands, point, program->pipeline);
    if (program->set)
        rt->vk.CmdBindDescriptorSets(rt->frame_commands, point, program->layout, 0, 1,
                                     &program->set, 0, NULL);
}

void dt_vk_dispatch(struct vk_runtime *rt, const struct vk_program *program, uint32_t x, uint32_t y,
                    uint32_t z)
{
    const uint32_t *limit = rt->properties.limits.maxComputeWorkGroupCount;
    if (rt->skips)
        return;
    if (x > limit[0] || y > limit[1] || z > limit[2]) {
        vk_error(rt,
                 "pass %s: %u x %u x %u workgroups, but the device's limit is %u x %u x %u; "
                 "use larger workgroups or a smaller frame",
                 program->name, x, y, z, limit[0], limit[1], limit[2]);
        rt->failed = true;
        return;
    }
    bind_program(rt, program, VK_PIPELINE_BIND_POINT_COMPUTE);
    rt->vk.CmdDispatch(rt->frame_commands, x, y, z);
}

void dt_vk_dispatch_indirect(struct vk_runtime *rt, const struct vk_program *program,
                             const struct vk_buffer *arguments)
{
    if (rt->skips)
        return;
    bind_program(rt, program, VK_PIPELINE_BIND_POINT_COMPUTE);
    rt->vk.CmdDispatchIndirect(rt->frame_commands, arguments->handle, 0);
}

/* ---- Draws ----------------------------------------------------------------------------------- */

static VkClearColorValue clear_color(const struct vk_image *image, const float clear[4])
{
    VkClearColorValue value;
    for (int i = 0; i < 4; i++) {
        switch (image->texel) {
        case DT_FORMAT_R32UI:
        case DT_FORMAT_RG32UI:
        case DT_FORMAT_RGBA32UI:
            value.uint32[i] = (uint32_t)clear[i];
            break;
        case DT_FORMAT_R32I:
            value.int32[i] = (int32_t)clear[i];
            break;
        default:
            value.float32[i] = clear[i];
        }
    }
    return value;
}

static VkRenderingAttachmentInfo attachment(const struct vk_target *target)
{
    const struct vk_image *image = target->image;
    bool depth = image->aspect & VK_IMAGE_ASPECT_DEPTH_BIT;
    VkRenderingAttachmentInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = image->mip_views[target->mip],
        .imageLayout = image->layout,
        .loadOp = target->load ? VK_ATTACHMENT_LOAD_OP_LOAD : VK_ATTACHMENT_LOAD_OP_CLEAR,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
    };
    if (depth)
        info.clearValue.depthStencil.depth = target->clear[0];
    else
        info.clearValue.color = clear_color(image, target->clear);
    return info;
}

/* Draws of one size, and all draws of the scene, follow each other: what they share is said once. */
static void set_area(struct vk_runtime *rt, VkExtent2D extent)
{
    VkViewport viewport = {0, 0, (float)extent.width, (float)extent.height, 0, 1};
    VkRect2D scissor = {.extent = extent};
    if (rt->bound.area.width == extent.width && rt->bound.area.height == extent.height)
        return;
    rt->bound.area = extent;
    rt->vk.CmdSetViewport(rt->frame_commands, 0, 1, &viewport);
    rt->vk.CmdSetScissor(rt->frame_commands, 0, 1, &scissor);
}

static void begin_rendering(struct vk_runtime *rt, const struct vk_targets *targets)
{
    VkRenderingAttachmentInfo colors[VK_MAX_COLOR_TARGETS], depth;
    const struct vk_target *first = targets->color_count ? &targets->color[0] : &targets->depth;
    uint32_t width = first->image->width >> first->mip, height = first->image->height >> first->mip;
    VkRect2D area = {.extent = {width ? width : 1, height ? height : 1}};
    for (uint32_t i = 0; i < targets->color_count; i++)
        colors[i] = attachment(&targets->color[i]);
    if (targets->depth.image)
        depth = attachment(&targets->depth);
    VkRenderingInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        .renderArea = area,
        .layerCount = targets->layers,
        .colorAttachmentCount = targets->color_count,
        .pColorAttachments = colors,
        .pDepthAttachment = targets->depth.image ? &depth : NULL,
    };
    rt->vk.CmdBeginRendering(rt->frame_commands, &info);
    set_area(rt, area.extent);
}

static void bind_scene(struct vk_runtime *rt, const struct vk_buffer *indices)
{
    const struct vk_buffer *vertices = &rt->builtin.vertices;
    struct vk_bound *bound = &rt->bound;
    if (!bound->vertices)
        rt->vk.CmdBindVertexBuffers(rt->frame_commands, 0, 1, &vertices->handle, &vertices->offset);
    if (bound->indices != indices->handle || bound->index_offset != indices->offset)
        rt->vk.CmdBindIndexBuffer(rt->frame_commands, indices->handle, indices->offset,
                                  VK_INDEX_TYPE_UINT32);
    bound->vertices = true;
    bound->indices = indices->handle;
    bound->index_offset = indices->offset;
}

void dt_vk_draw_scene(struct vk_runtime *rt, const struct vk_program *program,
                      const struct vk_targets *targets, uint32_t instances)
{
    if (rt->skips)
        return;
    begin_rendering(rt, targets);
    bind_program(rt, program, VK_PIPELINE_BIND_POINT_GRAPHICS);
    bind_scene(rt, &rt->builtin.indices);
    rt->vk.CmdDrawIndexed(rt->frame_commands, rt->index_count, instances, 0, 0, 0);
    rt->vk.CmdEndRendering(rt->frame_commands);
}

/* lavapipe 22.3.6 binds an index buffer at an offset for direct draws only: indirect ones count from the
 * start of the buffer, and draw something else without a word. */
static bool counts_from_start(struct vk_runtime *rt, const struct vk_program *program,
                              const struct vk_buffer *indices)
{
    if (!indices->offset || strncmp(rt->properties.deviceName, "llvmpipe", 8) != 0)
        return true;
    vk_error(rt,
             "pass %s: scene indices at byte %llu, but indirect draws of %s count from the start "
             "of the buffer; give them a buffer of their own",
             program->name, (unsigned long long)indices->offset, rt->properties.deviceName);
    return false;
}

void dt_vk_draw_scene_indirect(struct vk_runtime *rt, const struct vk_program *program,
                               const struct vk_targets *targets, const struct vk_buffer *indices,
                               const struct vk_buffer *arguments, uint32_t draw_count)
{
    uint32_t limit = rt->properties.limits.maxDrawIndirectCount;
    indices = indices ? indices : &rt->builtin.indices;
    if (rt->skips)
        return;
    if (!counts_from_start(rt, program, indices)) {
        rt->failed = true;
        return;
    }
    if (draw_count > limit) {
        vk_error(rt, "pass %s: %u indirect draws, but the device's limit is %u; use fewer",
                 program->name, draw_count, limit);
        rt->failed = true;
        return;
    }
    begin_rendering(rt, targets);
    bind_program(rt, program, VK_PIPELINE_BIND_POINT_GRAPHICS);
    bind_scene(rt, indices);
    rt->vk.CmdDrawIndexedIndirect(rt->frame_commands, arguments->handle, 0, draw_count,
                                  sizeof(VkDrawIndexedIndirectCommand));
    rt->vk.CmdEndRendering(rt->frame_commands);
}

void dt_vk_draw_fullscreen(struct vk_runtime *rt, const struct vk_program *program,
                           const struct vk_targets *targets)
{
    if (rt->skips)
        return;
    begin_rendering(rt, targets);
    bind_program(rt, program, VK_PIPELINE_BIND_POINT_GRAPHICS);
    rt->vk.CmdDraw(rt->frame_commands, 3, 1, 0, 0); /* one triangle that covers all */
    rt->vk.CmdEndRendering(rt->frame_commands);
}

/* ---- Clears ---------------------------------------------------------------------------------- */

void dt_vk_clear_targets(struct vk_runtime *rt, const struct vk_targets *targets)
{
    if (rt->skips)
        return;
    begin_rendering(rt, targets);
    rt->vk.CmdEndRendering(rt->frame_commands);
}

/* The plan's barriers order the clears of a pass that may be skipped, too. */
void dt_vk_clear_image(struct vk_runtime *rt, struct vk_image *image, uint32_t mip,
                       const float clear[4])
{
    VkClearColorValue value = clear_color(image, clear);
    VkImageSubresourceRange range = {image->aspect, mip, 1, 0, image->layers};
    if (rt->skips)
        return;
    rt->vk.CmdClearColorImage(rt->frame_commands, image->handle, image->layout, &value, 1, &range);
}

void dt_vk_clear_buffer(struct vk_runtime *rt, struct vk_buffer *buffer)
{
    if (rt->skips)
        return;
    rt->vk.CmdFillBuffer(rt->frame_commands, buffer->handle, 0, VK_WHOLE_SIZE, 0);
}
