/* Stands before the runtime's vkCmdPipelineBarrier2; see drop.h. */
#include "drop.h"

enum { MOST = 64 };

static struct {
    const struct dt_vk_runtime *rt;
    PFN_vkCmdPipelineBarrier2 real;
    enum drop drop;
    uint32_t number, count;
} state;

/* Whether the barrier stays. */
static bool keep(VkPipelineStageFlags2 *stages, VkAccessFlags2 *accesses)
{
    if (++state.count != state.number)
        return true;
    *stages = VK_PIPELINE_STAGE_2_NONE;
    *accesses = VK_ACCESS_2_NONE;
    return state.drop == DROP_DEPENDENCY;
}

static void VKAPI_PTR changed_barrier(VkCommandBuffer commands, const VkDependencyInfo *info)
{
    VkBufferMemoryBarrier2 buffers[MOST];
    VkImageMemoryBarrier2 images[MOST];
    VkDependencyInfo copy = *info;
    if (commands != state.rt->frame_commands || info->bufferMemoryBarrierCount > MOST ||
        info->imageMemoryBarrierCount > MOST) {
        state.real(commands, info);
        return;
    }
    copy.bufferMemoryBarrierCount = copy.imageMemoryBarrierCount = 0;
    copy.pBufferMemoryBarriers = buffers;
    copy.pImageMemoryBarriers = images;
    for (uint32_t i = 0; i < info->bufferMemoryBarrierCount; i++) {
        VkBufferMemoryBarrier2 *barrier = &buffers[copy.bufferMemoryBarrierCount];
        *barrier = info->pBufferMemoryBarriers[i];
        copy.bufferMemoryBarrierCount += keep(&barrier->srcStageMask, &barrier->srcAccessMask);
    }
    for (uint32_t i = 0; i < info->imageMemoryBarrierCount; i++) {
        VkImageMemoryBarrier2 *barrier = &images[copy.imageMemoryBarrierCount];
        *barrier = info->pImageMemoryBarriers[i];
        copy.imageMemoryBarrierCount += keep(&barrier->srcStageMask, &barrier->srcAccessMask);
    }
    if (copy.memoryBarrierCount + copy.bufferMemoryBarrierCount + copy.imageMemoryBarrierCount > 0)
        state.real(commands, &copy);
}

void drop_next(struct dt_vk_runtime *rt, enum drop drop, uint32_t number)
{
    if (rt->vk.CmdPipelineBarrier2 != changed_barrier)
        state.real = rt->vk.CmdPipelineBarrier2;
    rt->vk.CmdPipelineBarrier2 = changed_barrier;
    state.rt = rt;
    state.drop = drop;
    state.number = number;
    state.count = 0;
}
