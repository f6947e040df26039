/* Statistics of a pipeline's programs; see statistics.h. */
#include "statistics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

enum { MAX_EXECUTABLES = 8 };

struct asking {
    struct dt_vk_runtime *rt;
    PFN_vkGetPipelineExecutablePropertiesKHR properties;
    PFN_vkGetPipelineExecutableStatisticsKHR statistics;
    struct vk_statistics *found;
    uint32_t capacity;
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

static bool ask_executable(const struct asking *asking, VkPipeline pipeline, uint32_t index,
                           struct vk_executable *out)
{
    struct dt_vk_runtime *rt = asking->rt;
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
                                             rt->core.pipeline->passes[out->pass].name))
        return false;
    for (uint32_t i = 0; i < out->count; i++) {
        snprintf(out->list[i].name, sizeof out->list[i].name, "%s", list[i].name);
        out->list[i].value = number_of(&list[i]);
    }
    return true;
}

static bool ask_pipeline(struct asking *asking, uint32_t pass, VkPipeline pipeline)
{
    struct dt_vk_runtime *rt = asking->rt;
    struct vk_statistics *found = asking->found;
    VkPipelineInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = pipeline};
    VkPipelineExecutablePropertiesKHR list[MAX_EXECUTABLES];
    uint32_t count = MAX_EXECUTABLES;
    for (uint32_t i = 0; i < MAX_EXECUTABLES; i++)
        list[i] = (VkPipelineExecutablePropertiesKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR};
    VkResult result = asking->properties(rt->device, &info, &count, list);
    if (result != VK_INCOMPLETE && !vk_check(rt, result, "vkGetPipelineExecutablePropertiesKHR",
                                             rt->core.pipeline->passes[pass].name))
        return false;
    if (found->count + count > asking->capacity) {
        uint32_t capacity = 2 * asking->capacity + MAX_EXECUTABLES;
        struct vk_executable *grown = realloc(found->list, capacity * sizeof *grown);
        if (!grown)
            return dt_error(&rt->core, "pipeline %s: out of memory", rt->core.pipeline->name);
        found->list = grown;
        asking->capacity = capacity;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct vk_executable *out = &found->list[found->count++];
        *out = (struct vk_executable){
            .pass = pass, .stages = list[i].stages, .subgroup = list[i].subgroupSize};
        if (!ask_executable(asking, pipeline, i, out))
            return false;
    }
    return true;
}

static bool ask_pass(struct asking *asking, uint32_t pass)
{
    struct dt_vk_runtime *rt = asking->rt;
    struct vk_program_info info = vk_program_info_of(&rt->core, pass);
    struct vk_program program;
    if (!vk_program_create(rt, &program, &info))
        return false;
    bool good = ask_pipeline(asking, pass, program.pipeline->handle);
    vk_program_destroy(&rt->core, &program);
    return good;
}

static bool ask_all(struct dt_vk_runtime *rt, struct vk_statistics *found)
{
    struct asking asking = {
        .rt = rt,
        .properties = (PFN_vkGetPipelineExecutablePropertiesKHR)vkGetDeviceProcAddr(
            rt->device, "vkGetPipelineExecutablePropertiesKHR"),
        .statistics = (PFN_vkGetPipelineExecutableStatisticsKHR)vkGetDeviceProcAddr(
            rt->device, "vkGetPipelineExecutableStatisticsKHR"),
        .found = found,
    };
    for (uint32_t i = 0; i < rt->core.pipeline->pass_count; i++)
        if (!ask_pass(&asking, i))
            return false;
    return true;
}

bool vk_statistics_find(const struct dt_runtime_options *options, const struct dt_shaders *shaders,
                        struct vk_statistics *found)
{
    *found = (struct vk_statistics){0};
    struct dt_vk_runtime *rt = calloc(1, sizeof *rt);
    if (!rt)
        return dt_error(&(struct dt_core){.log = options->log}, "Vulkan: out of memory");
    rt->core.log = options->log;
    rt->core.shaders = *shaders;
    rt->core.panel = shaders->panel;
    rt->core.pipeline = shaders->panel->pipeline;
    rt->captures = true;
    bool good = vk_context_open(rt, options) && ask_all(rt, found);
    memcpy(found->device, rt->core.device_name, sizeof found->device);
    memcpy(found->driver, rt->core.driver, sizeof found->driver);
    vk_context_close(rt);
    free(rt);
    if (!good) {
        free(found->list);
        found->list = NULL;
        found->count = 0;
    }
    return good;
}
