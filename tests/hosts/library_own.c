/* The host that library_own.h declares. */
#include "library_own.h"

#include <string.h>

struct own own;

VkResult own_allocate(void *user, const VkMemoryRequirements *needs, const char *name,
                      struct dt_vk_memory *out)
{
    enum { OFFSET = 1 << 16 };
    VkMemoryRequirements more = *needs;
    assert_true(user == &own && name[0] && OFFSET % needs->alignment == 0);
    *out = (struct dt_vk_memory){(VkDeviceMemory)&own /* ignored on an error */, 0, NULL};
    if (own.fail_memory && --own.fail_memory == 0)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    more.size += OFFSET;
    *out = (struct dt_vk_memory){renderer_allocate(&vk, &more, 0), OFFSET, &own};
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

static VKAPI_ATTR void VKAPI_CALL own_barrier(VkCommandBuffer commands,
                                              const VkDependencyInfo *info)
{
    if (++own.barriers != own.drop)
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

static void own_threads(void *user, uint32_t count, void (*job)(void *data, uint32_t i), void *data)
{
    assert_true(user == &own);
    renderer_run(&vk, count, job, data);
}

struct dt_vk_host own_host(void)
{
    struct dt_vk_host host = vk_host();
    host.get_instance_proc_addr = own_functions;
    host.callbacks = &vk.callbacks;
    host.allocator = (struct dt_vk_allocator){&own, own_allocate, own_release};
    host.pipeline_cache = own.cache;
    host.threads = (struct dt_vk_threads){&own, own_threads};
    return host;
}
