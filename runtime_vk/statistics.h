/* What the compiler of a Vulkan driver tells of a pipeline's programs, by
 * VK_KHR_pipeline_executable_properties. Makes pipelines and nothing else: no memory, no commands. So
 * it also works on the null hardware of Mesa's RADV, which has neither. */
#pragma once

#include "diptych.h"

enum { VK_MAX_STATISTICS = 32, VK_MAX_STATISTIC_NAME = 64 };

struct vk_statistic {
    char name[VK_MAX_STATISTIC_NAME]; /* the driver's */
    double value;
};

/* One compiled stage of a pass; or several, if the driver joins them. */
struct vk_executable {
    uint32_t pass;
    uint32_t stages;   /* VkShaderStageFlags */
    uint32_t subgroup; /* invocations of a wave */
    uint32_t count;
    struct vk_statistic list[VK_MAX_STATISTICS];
};

struct vk_statistics {
    char device[256], driver[520];
    struct vk_executable *list; /* in order of passes; owned */
    uint32_t count;
};

/* Opens the device of the options (`log`, `device` and `panel` are read), and compiles all passes. False: logged; nothing
 * to free. free(found->list). */
bool vk_statistics_find(const struct dt_runtime_options *options, const struct dt_shaders *shaders,
                        struct vk_statistics *found);
