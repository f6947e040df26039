/* Drives one runtime through its verbs; see session.h.
 *
 * A session is one backend, one pipeline, one scene: what `render`, `view`, the library and each
 * worker of a comparison have in common. It is the only file of the application that opens a
 * runtime: a device's options and the label before its messages are decided here. The order is
 * open, set_scene, create, resize, inputs, frames, close; `view` creates again when the spec has
 * changed.
 *
 * - A session borrows all: pipeline, scene and setup must outlive it. Workers fork after these are
 *   loaded, so both sides of a comparison read the same bytes.
 * - Frames count up from first_frame. All that moves is computed from the frame's number
 *   (scene_frame_at), never from a clock: frame 7 is the same in every run and on both sides.
 *   Replays give a frame block instead.
 * - Inputs are written after each resize, since resources of another size lose their content.
 * - An error of validation fails the run at its end (session_is_silent), not the pass: a message
 *   often explains the next. */
#include "run/session.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "console/tool.h"
#include "spec/inputs.h"
#include "front.h"
#include "scenes/motion.h"

static const struct dt_runtime *find_runtime(const char *backend)
{
    return strcmp(backend, runtime_gl.name) == 0 ? &runtime_gl : &runtime_vk;
}

/* Mesa maps its cache: on a full disk the process would die of SIGBUS. */
static void spare_full_disk(struct console *console)
{
    enum { LEAST_BYTES = 16 << 20 };
    const char *own = getenv("MESA_SHADER_CACHE_DIR"), *all = getenv("XDG_CACHE_HOME");
    const char *home = getenv("HOME");
    char *folder = own && *own   ? strdup(own)
                   : all && *all ? strdup(all)
                   : home        ? format_string("%s/.cache", home)
                                 : NULL;
    struct statvfs disk;
    if (!console->attached && folder && !getenv("MESA_SHADER_CACHE_DISABLE") &&
        statvfs(folder, &disk) == 0 && (uint64_t)disk.f_bavail * disk.f_frsize < LEAST_BYTES &&
        setenv("MESA_SHADER_CACHE_DISABLE", "true", 0) == 0)
        report_message(&console->log, DT_WARNING, "%s: the disk is full; Mesa keeps no shaders",
                       folder);
    free(folder);
}

/* LLVM takes 100 us to optimize an operation. Without, it takes a third, and a frame of 300,000 operations 1 us more per
 * pixel. */
static bool spare_compiler(const struct session_info *info)
{
    enum { MANY_OPERATIONS = 100000, FEW_PIXELS = 10000000 };
    const struct setup *setup = info->setup;
    uint64_t pixels = (uint64_t)setup->size[0] * setup->size[1];
    if (info->timing || !info->pipeline->plan || getenv("GALLIVM_PERF") ||
        pixels * session_frames(setup, info->scene) > FEW_PIXELS)
        return true;
    uint64_t operations = plan_operations(info->pipeline->plan);
    if (operations < MANY_OPERATIONS)
        return true;
    report_message(&info->console->log, DT_INFO,
                   "%" PRIu64 " operations: Mesa does not optimize them (GALLIVM_PERF=nopt)",
                   operations);
    return setenv("GALLIVM_PERF", "nopt", 1) == 0;
}

/* Drivers and layers read their settings from the environment, which belongs to the process: a library
 * leaves it to its host. zink runs on the CPU's Vulkan driver, unless the user sets
 * LIBGL_ALWAYS_SOFTWARE=0. Without NODEVICE_SELECT a Vulkan layer of Mesa looks for a Wayland display.
 * Newer validation layers leave out the accesses of shaders by default. */
static bool set_environment(const struct session_info *info)
{
    const char *context = info->side->context;
    bool zink = context && strcmp(context, "zink") == 0, debug = info->setup->debug;
    bool good = info->console->attached ||
                (spare_compiler(info) &&
                 (!zink || (setenv("GALLIUM_DRIVER", "zink", 1) == 0 &&
                            setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0) == 0 &&
                            setenv("NODEVICE_SELECT", "1", 0) == 0)) &&
                 (!debug || setenv("VK_LAYER_SYNCVAL_SHADER_ACCESSES_HEURISTIC", "1", 0) == 0));
    return good || report_error(&info->console->log, "out of memory");
}

bool session_open(struct session *session, const struct session_info *info)
{
    spare_full_disk(info->console);
    if (!set_environment(info))
        return false;
    const struct setup *setup = info->setup;
    const struct side *side = info->side;
    *session = (struct session){
        .info = *info, .runtime = find_runtime(side->backend), .frame = info->first_frame};
    session->source = (struct log_source){.log = &info->console->log, .name = side->label};
    session->log = info->name_in_log ? log_from(&session->source) : info->console->log;
    console_status(info->console, "%s: opening the device", side->label);
    session->handle = session->runtime->open(&(struct dt_runtime_options){
        .log = session->log,
        .device = side->device,
        .panel = info->pipeline->vk ? info->pipeline->vk->panel : NULL,
        .context = side->context,
        .debug = setup->debug,
        .labels = setup->capture,
        .glsl = side->glsl,
        .timing = info->timing,
        .poison = info->poison,
        .keep_history = info->keep_history,
    });
    return session->handle;
}

static const struct dt_shaders *shaders_of(const struct session *session,
                                           const struct pipeline *pipeline)
{
    return session->runtime == &runtime_gl ? pipeline->gl : pipeline->vk;
}

bool session_create(struct session *session, const struct pipeline *pipeline)
{
    const struct dt_shaders *shaders = shaders_of(session, pipeline);
    session->for_gpu = pipeline->plan && plan_is_automatic(pipeline->plan) &&
                       session->runtime->takes_gpu(session->handle, shaders->panel);
    if (session->for_gpu) {
        struct plan *plan = plan_for_gpu(pipeline->plan, session->info.console);
        shaders = plan ? plan_shaders(plan, session->runtime->name) : NULL;
    }
    return shaders && session->runtime->create(session->handle, shaders);
}

bool session_prepare(struct session *session)
{
    const struct session_info *info = &session->info;
    const uint32_t *size = info->setup->size;
    console_status(info->console, "%s: uploading the scene", info->side->label);
    if (!session->runtime->set_scene(session->handle, &info->scene->data))
        return false;
    console_status(info->console, "%s: creating the programs", info->side->label);
    return session_create(session, info->pipeline) && session_resize(session, size);
}

bool session_resize(const struct session *session, const uint32_t size[2])
{
    return session->runtime->resize(session->handle, size[0], size[1]) &&
           inputs_write(session->info.pipeline, session->runtime, session->handle, size);
}

bool session_frame(struct session *session, const struct dt_observer *observer)
{
    const struct session_info *info = &session->info;
    struct dt_frame frame;
    memset(&frame, 0, sizeof frame);
    scene_frame_at(info->scene, session->frame, info->setup->size[0], info->setup->size[1], &frame);
    session->frame++;
    if (info->frame_block)
        frame = *info->frame_block;
    console_status(info->console, "%s: frame %u of %u", info->side->label, session->frame,
                   info->setup->frames);
    return session->runtime->render(session->handle, &frame, info->pipeline->live, observer);
}

bool session_is_silent(const struct session *session)
{
    uint32_t count = session->runtime->device(session->handle)->messages;
    if (count)
        report_error(&session->log, "%u debug or validation messages, see above: the run failed",
                     count);
    return count == 0;
}

void session_close(struct session *session)
{
    if (session->runtime)
        session->runtime->close(session->handle);
    session->handle = NULL;
}

bool session_can_lack_scene(const struct dt_pipeline *pipeline, struct console *console)
{
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        if (!pipeline->passes[i].uses_scene)
            continue;
        return report_error(&console->log,
                            "--scene FILE is missing: the pass %s of %s uses the scene",
                            pipeline->passes[i].name, pipeline->name);
    }
    return true;
}

bool session_load_scene(struct scene *scene, struct console *console,
                        const struct dt_pipeline *pipeline, const struct setup *setup)
{
    const char *folder = setup->scenes ? setup->scenes : getenv("DIPTYCH_SCENES");
    *scene = (struct scene){0};
    if (!setup->scene)
        return session_can_lack_scene(pipeline, console) && scene_none(scene, &console->log) &&
               (!setup->motion || scene_load_motion(scene, setup->motion, &console->log));
    console_status(console, "loading %s", setup->scene);
    char *path = find_scene(setup->scene, &console->log);
    bool good = path ? scene_load(scene, path, folder, true, &console->log)
                     : (report_error(&console->log, "out of memory"), false);
    free(path);
    return good && (!setup->motion || scene_load_motion(scene, setup->motion, &console->log));
}

uint32_t session_frames(const struct setup *setup, const struct scene *scene)
{
    if (setup->frames)
        return setup->frames;
    return scene->motion ? motion_frames(scene->motion) : 1;
}
