/* For target_test.sh: stands between host_gl.c or host_vk.c and the libraries. Opens runtimes for TARGET of
 * the environment (0 auto, 1 software, 2 gpu, 3 auto on a device that is no CPU driver), and prints whose
 * shaders create has taken. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "diptych_gl.h"
#include "diptych_vk.h"
#include "front.h"

static enum dt_target_device target(void)
{
    return (enum dt_target_device)(atoi(getenv("TARGET")) % 3);
}

/* Both runtimes begin with a core. */
static void be_gpu(void *rt)
{
    if (rt && strcmp(getenv("TARGET"), "3") == 0)
        ((struct dt_core *)rt)->device.software = false;
}

static void tell(const void *rt, const struct dt_shaders *shaders)
{
    const struct dt_core *core = rt;
    bool gpu = core->panel == shaders->panel->gpu && core->panel;
    bool own = core->shaders.stages == shaders->stages + (gpu ? core->pipeline->pass_count : 0);
    printf("%s: %s%s\n", core->pipeline->name, gpu ? "gpu" : "software",
           own ? "" : ", others' shaders");
}

#ifdef HOST_VK
struct dt_vk_runtime *open_for_target(const struct dt_vk_host *host);
bool create_and_tell(struct dt_vk_runtime *rt, const struct dt_shaders *shaders);
void need_features(const struct dt_shaders *shaders, VkPhysicalDeviceFeatures *core,
                   VkPhysicalDeviceVulkan11Features *vulkan11,
                   VkPhysicalDeviceVulkan12Features *vulkan12,
                   VkPhysicalDeviceVulkan13Features *vulkan13);

/* SwiftShader has no shaderOutputLayer, which a host may leave off. */
void need_features(const struct dt_shaders *shaders, VkPhysicalDeviceFeatures *core,
                   VkPhysicalDeviceVulkan11Features *vulkan11,
                   VkPhysicalDeviceVulkan12Features *vulkan12,
                   VkPhysicalDeviceVulkan13Features *vulkan13)
{
    dt_vk_need_features(shaders, core, vulkan11, vulkan12, vulkan13);
    vulkan12->shaderOutputLayer = VK_FALSE;
}

struct dt_vk_runtime *open_for_target(const struct dt_vk_host *host)
{
    struct dt_vk_host own = *host;
    own.target = target();
    struct dt_vk_runtime *rt = dt_vk_open(&own);
    be_gpu(rt);
    return rt;
}

bool create_and_tell(struct dt_vk_runtime *rt, const struct dt_shaders *shaders)
{
    bool good = dt_vk_create(rt, shaders);
    if (good)
        tell(rt, shaders);
    return good;
}
#else
struct dt_gl_runtime *open_for_target(const struct dt_gl_host *host);
bool create_and_tell(struct dt_gl_runtime *rt, const struct dt_shaders *shaders);

struct dt_gl_runtime *open_for_target(const struct dt_gl_host *host)
{
    struct dt_gl_host own = *host;
    own.target = target();
    struct dt_gl_runtime *rt = dt_gl_open(&own);
    be_gpu(rt);
    return rt;
}

bool create_and_tell(struct dt_gl_runtime *rt, const struct dt_shaders *shaders)
{
    bool good = dt_gl_create(rt, shaders);
    if (good)
        tell(rt, shaders);
    return good;
}
#endif
