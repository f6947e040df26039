/* What the compiler of a Vulkan driver tells of a pipeline's programs, by
 * VK_KHR_pipeline_executable_properties. Makes pipelines and nothing else: no memory, no commands. So
 * it also works on the null hardware of Mesa's RADV, which has neither. */
#pragma once

#include "diptych.h"

enum { VK_MAX_STATISTICS = 32, VK_MAX_STATISTIC_NAME = 64, VK_MAX_EXECUTABLES = 8 };

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

struct vk_executables { /* of one pass */
    struct vk_executable list[VK_MAX_EXECUTABLES];
    uint32_t count;
};

struct vk_asking;

/* Opens the device of the options (`log`, `device` and `panel` are read). NULL: logged. */
struct vk_asking *vk_statistics_open(const struct dt_runtime_options *options,
                                     const struct dt_shaders *shaders);
void vk_statistics_close(struct vk_asking *asking); /* may be NULL */
/* Names of device and driver, which live until close. */
const char *vk_statistics_device(const struct vk_asking *asking, const char **driver);
/* Compiles a pass from these stages, which have the interface of its own. False: logged. */
bool vk_statistics_ask(struct vk_asking *asking, uint32_t pass, const struct dt_stages *stages,
                       struct vk_executables *out);
