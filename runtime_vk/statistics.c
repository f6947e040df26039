/* Statistics of a pipeline's programs; see statistics.h. */
#include "statistics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

struct vk_asking {
    struct dt_vk_runtime rt;
    PFN_vkGetPipelineExecutablePropertiesKHR properties;
    PFN_vkGetPipelineExecutableStatisticsKHR statistics;
};

static double number_of(const VkPipelineExecutableStatisticKHR *statistic)
{
    switch (statistic->format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR:
        return statistic->value.b32 != 0;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR:
        return (double)statistic->value.i64;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_FLOAT64_KHR:
        return statistic->value.f64;
    default:
        return (double)statistic->value.u64;
    }
}

static bool ask_executable(struct vk_asking *asking, VkPipeline pipeline, uint32_t index,
                           struct vk_executable *out)
{
    struct dt_vk_runtime *rt = &asking->rt;
    VkPipelineExecutableInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR,
                                        .pipeline = pipeline,
                                        .executableIndex = index};
    VkPipelineExecutableStatisticKHR list[VK_MAX_STATISTICS];
    out->count = VK_MAX_STATISTICS;
    for (uint32_t i = 0; i < VK_MAX_STATISTICS; i++)
        list[i] = (VkPipelineExecutableStatisticKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR};
    VkResult result = asking->statistics(rt->device, &info, &out->count, list);
    if (result != VK_INCOMPLETE && !vk_check(rt, result, "vkGetPipelineExecutableStatisticsKHR",
                                             dt_pass_name(&rt->core, out->pass)))
        return false;
    for (uint32_t i = 0; i < out->count; i++) {
        snprintf(out->list[i].name, sizeof out->list[i].name, "%s", list[i].name);
        out->list[i].value = number_of(&list[i]);
    }
    return true;
}

static bool ask_pipeline(struct vk_asking *asking, uint32_t pass, VkPipeline pipeline,
                         struct vk_executables *out)
{
    struct dt_vk_runtime *rt = &asking->rt;
    VkPipelineInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = pipeline};
    VkPipelineExecutablePropertiesKHR list[VK_MAX_EXECUTABLES];
    out->count = VK_MAX_EXECUTABLES;
    for (uint32_t i = 0; i < VK_MAX_EXECUTABLES; i++)
        list[i] = (VkPipelineExecutablePropertiesKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR};
    VkResult result = asking->properties(rt->device, &info, &out->count, list);
    if (result != VK_INCOMPLETE && !vk_check(rt, result, "vkGetPipelineExecutablePropertiesKHR",
                                             dt_pass_name(&rt->core, pass)))
        return false;
    for (uint32_t i = 0; i < out->count; i++) {
        out->list[i] = (struct vk_executable){
            .pass = pass, .stages = list[i].stages, .subgroup = list[i].subgroupSize};
        if (!ask_executable(asking, pipeline, i, &out->list[i]))
            return false;
    }
    return true;
}

bool vk_statistics_ask(struct vk_asking *asking, uint32_t pass, const struct dt_stages *stages,
                       struct vk_executables *out)
{
    struct vk_program_info info = vk_program_info_of(&asking->rt.core, pass);
    struct vk_program program;
    info.stages = stages;
    if (!vk_program_create(&asking->rt, &program, &info))
        return false;
    bool good = ask_pipeline(asking, pass, program.handle, out);
    vk_program_destroy(&asking->rt.core, &program);
    return good;
}

struct vk_asking *vk_statistics_open(const struct dt_runtime_options *options,
                                     const struct dt_shaders *shaders)
{
    struct vk_asking *asking = calloc(1, sizeof *asking);
    if (!asking) {
        dt_error(&(struct dt_core){.log = options->log}, "Vulkan: out of memory");
        return NULL;
    }
    struct dt_vk_runtime *rt = &asking->rt;
    rt->core.log = options->log;
    rt->core.shaders = *shaders;
    rt->core.panel = shaders->panel;
    rt->core.pipeline = shaders->panel->pipeline;
    rt->captures = true;
    if (!vk_context_open(rt, options)) {
        vk_statistics_close(asking);
        return NULL;
    }
    asking->properties = (PFN_vkGetPipelineExecutablePropertiesKHR)vkGetDeviceProcAddr(
        rt->device, "vkGetPipelineExecutablePropertiesKHR");
    asking->statistics = (PFN_vkGetPipelineExecutableStatisticsKHR)vkGetDeviceProcAddr(
        rt->device, "vkGetPipelineExecutableStatisticsKHR");
    return asking;
}

const char *vk_statistics_device(const struct vk_asking *asking, const char **driver)
{
    *driver = asking->rt.core.device.driver;
    return asking->rt.core.device.name;
}

void vk_statistics_close(struct vk_asking *asking)
{
    if (asking)
        vk_context_close(&asking->rt);
    free(asking);
}
