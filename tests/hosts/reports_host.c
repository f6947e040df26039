/* A renderer whose pipeline diptych-gen made with --sanitize: it reads the reports behind three frames and has them logged.
 * HOST_GL: with OpenGL, else with Vulkan. */
#include <stdio.h>
#include <string.h>

#include "wrong.h"

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user;
    fprintf(level == DT_ERROR ? stdout : stderr, "%s\n", message);
}
static const struct dt_log host_log = {.message = on_log};
static struct dt_frame frame = {.width = 16, .height = 16};

#ifdef HOST_GL
#include "renderer_gl.h"
#include <EGL/egl.h>
#include "diptych_gl.h"

int main(void)
{
    static uint32_t bytes[1 << 18];
    struct dt_gl_resource reports;
    renderer_open();
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = host_log, .get_proc_address = eglGetProcAddress});
    check(rt && dt_gl_create(rt, &wrong_gl) && dt_gl_resize(rt, 16, 16), "opening the pipeline");
    for (frame.index = 0; frame.index < 3; frame.index++)
        check(dt_gl_record(rt, &frame, NULL), "a frame");
    check(dt_gl_get_resource(rt, WRONG_RESOURCE_DIPTYCH_REPORTS, &reports) &&
              (size_t)reports.size <= sizeof bytes,
          "the reports");
    glGetNamedBufferSubData(reports.buffer, (GLintptr)reports.offset, (GLsizeiptr)reports.size,
                            bytes);
    uint32_t found = wrong_report(bytes, (size_t)reports.size, &host_log);
    dt_gl_close(rt);
    return found == 2 ? 0 : 1;
}
#else
#include "renderer_vk.h"
#include "diptych_vk.h"

static bool suits(VkInstance instance, VkPhysicalDevice physical)
{
    const struct dt_vk_host host = {.instance = instance,
                                    .physical_device = physical,
                                    .get_instance_proc_addr = vkGetInstanceProcAddr};
    return dt_vk_suits(&host, &wrong_vk);
}

static uint32_t run(struct renderer *renderer)
{
    struct dt_vk_resource reports;
    renderer_open(renderer, suits);
    struct dt_vk_runtime *rt =
        dt_vk_open(&(struct dt_vk_host){.log = host_log,
                                        .instance = renderer->instance,
                                        .physical_device = renderer->physical,
                                        .device = renderer->device,
                                        .get_instance_proc_addr = vkGetInstanceProcAddr,
                                        .device_info = &renderer->device_info});
    check(rt && dt_vk_create(rt, &wrong_vk) && dt_vk_resize(rt, 16, 16), "opening the pipeline");
    check(dt_vk_get_resource(rt, WRONG_RESOURCE_DIPTYCH_REPORTS, &reports), "the reports");
    struct buffer copy = make_buffer(renderer, reports.size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const VkBufferCopy region = {.srcOffset = reports.offset, .size = reports.size};
    for (frame.index = 0; frame.index < 3; frame.index++) {
        begin_frame(renderer, frame.index);
        VkCommandBuffer commands = begin_commands(renderer, frame.index, 0);
        check(dt_vk_record(rt, commands, &frame, NULL), "a frame");
        vkCmdCopyBuffer(commands, reports.buffer, copy.handle, 1, &region);
        end_frame(renderer, frame.index, 1);
    }
    wait_for_frames(renderer);
    uint32_t found = wrong_report(copy.bytes, (size_t)reports.size, &host_log);
    dt_vk_close(rt);
    destroy_buffer(renderer, &copy);
    renderer_close(renderer);
    return found;
}

int main(void)
{
    static struct renderer renderer = {.width = 16, .height = 16};
    renderer_prepare(&renderer);
    dt_vk_need_features(&wrong_vk, &renderer.core, &renderer.vulkan11, &renderer.vulkan12,
                        &renderer.vulkan13);
    return run(&renderer) == 2 ? 0 : 1;
}
#endif
