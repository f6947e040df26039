/* The runtime's own command buffers: the app's frames and immediate commands. Also full barriers
 * and pass timings, which hosts use, too.
 *
 * How a frame is recorded: vk_frame_render copies the uniform blocks and begins the command buffer;
 * dt_front_record (templates/c/front.c) calls `record` of the panel, generated or played; each of
 * its calls goes through the checks of front.c to a verb of verbs.c, which records it. Then the
 * buffer is submitted, and the call waits.
 *
 * - Every command buffer begins and ends with a full barrier. So the barriers of a panel are
 *   constants of one frame (gen/plan/barrier.c), uploads and read-backs need none, and mapped memory may
 *   be read afterwards.
 * - One frame at a time: the app compares and measures, and a second frame in flight would blur
 *   both. A host may have several in flight: host.c records the same verbs into its command buffer,
 *   and waits for nothing.
 * - With an observer the buffer ends after each pass (pause) and begins anew (resume). The full
 *   barriers between hide missing ones.
 * - State that Vulkan keeps within a command buffer is in rt->bound, which begin_commands forgets.
 *   An image's layout is kept in the image, as of the last command recorded.
 * - Nothing here allocates while a frame is recorded. */
#include "internal.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* ---- Command buffers ------------------------------------------------------------------------- */

void vk_full_barrier(const struct dt_vk_runtime *rt, VkCommandBuffer commands)
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

void vk_transition(const struct dt_vk_runtime *rt, VkCommandBuffer commands, struct vk_image *image,
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

/* Every command buffer begins with a full barrier. So a pipeline's barriers order only one frame;
 * uploads, read-backs and last frame's history need none. */
static bool begin_commands(struct dt_vk_runtime *rt, VkCommandBuffer commands, const char *name)
{
    VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    if (!VK(rt, rt->vk.ResetCommandBuffer(commands, 0), name) || /* may hold a failed recording */
        !VK(rt, rt->vk.BeginCommandBuffer(commands, &info), name))
        return false;
    rt->bound = (struct vk_bound){0};
    vk_full_barrier(rt, commands);
    return true;
}

/* Submits the commands and waits. */
static bool run_commands(struct dt_vk_runtime *rt, VkCommandBuffer commands, const char *name)
{
    VkCommandBufferSubmitInfo buffer = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
        .commandBuffer = commands,
    };
    VkSubmitInfo2 submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
        .commandBufferInfoCount = 1,
        .pCommandBufferInfos = &buffer,
    };
    vk_full_barrier(rt, commands); /* the fence alone does not make writes visible to the host */
    return VK(rt, rt->vk.EndCommandBuffer(commands), name) &&
           VK(rt, rt->vk.QueueSubmit2(rt->queue, 1, &submit, rt->fence), name) &&
           VK(rt, rt->vk.WaitForFences(rt->device, 1, &rt->fence, VK_TRUE, UINT64_MAX), name) &&
           VK(rt, rt->vk.ResetFences(rt->device, 1, &rt->fence), name);
}

VkCommandBuffer vk_immediate_begin(struct dt_vk_runtime *rt, const char *name)
{
    return begin_commands(rt, rt->immediate_commands, name) ? rt->immediate_commands : NULL;
}

bool vk_immediate_end(struct dt_vk_runtime *rt, const char *name)
{
    return run_commands(rt, rt->immediate_commands, name);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static double thread_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

void vk_reset_queries(const struct dt_vk_runtime *rt)
{
    rt->vk.CmdResetQueryPool(rt->frame_commands, rt->queries,
                             2 * dt_run(&rt->core, rt->core.slot, 0),
                             2 * rt->core.pipeline->pass_count);
}

/* Records all commands of a frame except the last barrier. */
static bool record_frame(struct dt_vk_runtime *rt, const void *live)
{
    const struct dt_pipeline *pipeline = rt->core.pipeline;
    if (!begin_commands(rt, rt->frame_commands, pipeline->name))
        return false;
    double start = thread_ms(); /* excludes the reset, which frees the last frame's commands */
    if (rt->core.timing)
        vk_reset_queries(rt);
    bool good = dt_front_record(&rt->core, live);
    rt->record_ms = rt->core.observer ? NAN : thread_ms() - start;
    return good;
}

bool vk_frame_render(struct dt_core *core, const struct dt_frame *frame, const void *live)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct dt_pipeline *pipeline = core->pipeline;
    uint32_t size = pipeline->live_size; /* then come parameters that a frame cannot change */
    char *block = vk_buffer_at(rt, DT_LIVE)->bytes;
    memcpy(vk_buffer_at(rt, DT_FRAME)->bytes, frame, sizeof *frame);
    memcpy(block, live, size);
    memcpy(block + size, (const char *)pipeline->live_defaults + size, pipeline->block_size - size);
    return record_frame(rt, live) && run_commands(rt, rt->frame_commands, pipeline->name);
}

/* With an observer every pass ends in a submission, so nothing is pending before the next. */
bool vk_frame_pause(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    return run_commands(rt, rt->frame_commands, dt_pass_name(core, core->pass));
}

bool vk_frame_resume(struct dt_core *core)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    return begin_commands(rt, rt->frame_commands, dt_pass_name(core, core->pass));
}

/* Timestamps wrap after timestamp_bits bits. A host has waited for the frame, so the query does not wait. */
bool vk_frame_timing(struct dt_core *core, uint32_t run, const char *name, double *ms)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    VkQueryResultFlags wait = core->hosted ? 0 : VK_QUERY_RESULT_WAIT_BIT;
    uint64_t mask = rt->timestamp_bits < 64 ? (1ull << rt->timestamp_bits) - 1 : UINT64_MAX;
    uint64_t stamps[2];
    if (!VK(rt,
            rt->vk.GetQueryPoolResults(rt->device, rt->queries, 2 * run, 2, sizeof stamps, stamps,
                                       sizeof stamps[0], VK_QUERY_RESULT_64_BIT | wait),
            name))
        return false;
    double ticks = (double)((stamps[1] - stamps[0]) & mask);
    *ms = ticks * (double)rt->properties.limits.timestampPeriod * 1e-6;
    return true;
}
