/* `diptych render`: one scene, one backend, one picture; on request a dump and timings. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/files.h"
#include "picture/hdr.h"
#include "console/numbered.h"
#include "console/options.h"
#include "console/spread.h"
#include "picture/texels.h"
#include "spec/inputs.h"
#include "result/dump.h"
#include "result/identity.h"
#include "picture/picture.h"
#include "run/capture.h"
#include "run/session.h"
#include "run/undefined.h"
#include "scenes/image.h"

/* Milliseconds per pass over several frames. */
struct timings {
    uint32_t passes;
    uint32_t frames;  /* taken so far */
    double *pass_ms;  /* frames x passes, NAN for a skipped pass; owned */
    double *frame_ms; /* from the call to the finished frame, by the host's clock; owned */
};

struct render {
    struct console *console;
    struct options options; /* with the frames of the motion */
    struct side side;
    struct pipeline pipeline;
    struct scene scene;
    struct session session;
    struct timings timings; /* of frames without an observer, when there are any */
    struct dump dump;
    bool exr;
    bool numbered;  /* the picture is one of every frame */
    bool last;      /* the frame that runs is the last */
    uint32_t shown; /* resource that becomes the picture */
    /* last pass that writes it; read then, since resources may share memory. pass_count: no picture */
    uint32_t shown_pass;
    struct dt_bytes picture; /* its bytes */
    struct undefined undefined;
};

/* ---- Times ----------------------------------------------------------------------------------- */

static void timings_free(struct timings *timings)
{
    free(timings->pass_ms);
    free(timings->frame_ms);
    *timings = (struct timings){0};
}

static bool timings_create(struct timings *timings, uint32_t passes, uint32_t max_frames,
                           const struct dt_log *log)
{
    *timings = (struct timings){.passes = passes};
    timings->pass_ms = calloc((size_t)passes * max_frames + 1, sizeof *timings->pass_ms);
    timings->frame_ms = calloc(max_frames, sizeof *timings->frame_ms);
    if (timings->pass_ms && timings->frame_ms)
        return true;
    report_error(log, "out of memory for the timings of %u frames", max_frames);
    timings_free(timings);
    return false;
}

static bool timings_take(struct timings *timings, const struct session *session, double frame_ms)
{
    if (!session->runtime->timings(session->handle,
                                   timings->pass_ms + (size_t)timings->frames * timings->passes))
        return false;
    timings->frame_ms[timings->frames++] = frame_ms;
    return true;
}

static void add_pass_times(cJSON *root, const struct timings *timings,
                           const struct dt_pipeline *pipeline)
{
    double sum = 0;
    cJSON *passes = cJSON_CreateArray();
    for (uint32_t i = 0; i < timings->passes; i++) {
        double ms = median_of(timings->pass_ms + i, timings->frames, timings->passes);
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "pass", pipeline->passes[i].name);
        if (isnan(ms))
            cJSON_AddNullToObject(item, "ms");
        else
            cJSON_AddNumberToObject(item, "ms", ms);
        cJSON_AddItemToArray(passes, item);
        sum += isnan(ms) ? 0 : ms;
    }
    cJSON_AddNumberToObject(root, "sum_ms", sum);
    cJSON_AddItemToObject(root, "passes", passes);
}

/* Medians, as {"backend", "device", "software", "pipeline", "scene", "width", "height", "frames",
 * "frame_ms", "sum_ms", "passes": [{"pass", "ms"}]}; a pass that never ran has null. */
static bool timings_write(const struct timings *timings, const struct session *session,
                          const char *path)
{
    const struct setup *setup = session->info.setup;
    const struct dt_pipeline *pipeline = session->info.pipeline->info;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "backend", session->info.side->label);
    cJSON_AddStringToObject(root, "device", session->runtime->device(session->handle)->name);
    cJSON_AddBoolToObject(root, "software", session->runtime->device(session->handle)->software);
    cJSON_AddStringToObject(root, "pipeline", pipeline->name);
    cJSON_AddStringToObject(root, "scene", setup->scene);
    cJSON_AddNumberToObject(root, "width", setup->size[0]);
    cJSON_AddNumberToObject(root, "height", setup->size[1]);
    cJSON_AddNumberToObject(root, "frames", timings->frames);
    cJSON_AddNumberToObject(root, "frame_ms", median_of(timings->frame_ms, timings->frames, 1));
    add_pass_times(root, timings, pipeline);
    console_hold(session->info.console);
    bool good = file_write_json(path, root, &session->log);
    console_release(session->info.console);
    cJSON_Delete(root);
    return good;
}

/* ---- The picture ----------------------------------------------------------------------------- */

static bool ends_with(const char *text, const char *tail)
{
    size_t length = strlen(text);
    size_t size = strlen(tail);
    return length >= size && strcasecmp(text + length - size, tail) == 0;
}

static bool check_output(struct render *render)
{
    const char *path = render->options.output;
    if (!path) {
        return (!render->options.show && (render->options.dump || render->options.timings ||
                                          render->options.setup.capture)) ||
               report_error(&render->console->log, "-o FILE is missing: the file of the picture");
    }
    bool good = true;
    render->exr = ends_with(path, ".exr");
    render->numbered = is_numbered(path, "-o", &good, &render->console->log);
    if (!render->exr && !ends_with(path, ".png"))
        return report_error(&render->console->log,
                            "-o %s: must end in .exr (linear) or .png (tone-mapped)", path);
    if (good && render->numbered && render->options.timings)
        return report_error(
            &render->console->log,
            "--timings: pictures of every frame would slow the frames down; leave out -o %s", path);
    return good;
}

static bool read_side(struct render *render)
{
    const struct options *options = &render->options;
    const struct dt_log *log = &render->console->log;
    return side_read(&render->side, options->setup.backend, &options->setup, log) &&
           sides_heed(&render->side, 1, &options->setup, log);
}

static bool find_shown(struct render *render)
{
    const struct dt_pipeline *info = render->pipeline.info;
    const struct dt_log *log = &render->console->log;
    int output = render->exr ? info->linear_output : info->display_output;
    render->shown_pass = info->pass_count;
    if (!render->options.output)
        return true;
    if (render->options.show) {
        if (!pipeline_find(info, "--show", render->options.show, &render->shown, log))
            return false;
    } else if (output < 0) {
        return report_error(log, "%s names no %s output; pick a resource with --show", info->name,
                            render->exr ? "linear" : "display");
    } else {
        render->shown = (uint32_t)output;
    }
    const struct dt_resource *resource = &info->resources[render->shown];
    if (resource->kind != DT_IMAGE)
        return report_error(
            log, "%s is a buffer; a picture can only be made of an image (--dump writes buffers)",
            resource->name);
    for (uint32_t i = info->pass_count; i-- > 0;) {
        for (uint32_t j = 0; j < info->passes[i].write_count; j++) {
            if (info->passes[i].writes[j] == render->shown &&
                (pass_mips(&info->passes[i], j) & 1)) {
                render->shown_pass = i;
                return true;
            }
        }
    }
    return report_error(log, "%s%s is written by no pass of %s",
                        resource->mips > 1 ? "mip 0 of " : "", resource->name, info->name);
}

/* Reads one mip of what the pass wrote, to be dumped, shown or both. */
static bool take_frame_output(struct render *render, uint32_t pass, uint32_t resource, uint32_t mip)
{
    const struct session *session = &render->session;
    bool show = mip == 0 && resource == render->shown && pass == render->shown_pass;
    bool dumped = render->dump.entries && render->last;
    if (!show && !dumped)
        return true;
    struct dt_bytes bytes = {0};
    bool good = session->runtime->read(session->handle, resource, mip, &bytes);
    if (good && dumped)
        good = dump_add(&render->dump, pass, resource, mip, &bytes);
    if (good && show) {
        free(render->picture.data);
        render->picture = bytes;
        bytes.data = NULL;
    }
    free(bytes.data);
    return good;
}

/* --sanitize: what the frames have found. */
static bool take_undefined(struct render *render)
{
    const struct session *session = &render->session;
    struct dt_bytes bytes = {0};
    if (!render->options.setup.sanitize)
        return true;
    bool good =
        session->runtime->read(session->handle, plan_reports(render->pipeline.plan), 0, &bytes) &&
        undefined_add(&render->undefined, &render->pipeline, 0, &bytes, &render->console->log);
    free(bytes.data);
    if (good)
        undefined_warn_idle(&render->pipeline, render->console);
    return good;
}

/* Before the last frame: dumps resources with history. */
static enum dt_action render_before_pass(void *user, uint32_t pass)
{
    struct render *render = user;
    const struct dt_pipeline *info = render->pipeline.info;
    for (uint32_t i = 0; i < info->resource_count && pass == 0; i++) {
        uint32_t mips = resource_mips_before(info, 0, i);
        for (uint32_t mip = 0; mips >> mip; mip++)
            if ((mips >> mip & 1) && !take_frame_output(render, DUMP_HISTORY, i, mip))
                return DT_STOP;
    }
    return DT_RUN;
}

/* After a pass of the last frame, or of every shown frame: reads what is dumped or shown. */
static bool render_after_pass(void *user, uint32_t pass)
{
    struct render *render = user;
    const struct dt_pass *info = &render->pipeline.info->passes[pass];
    console_status(render->console, "%s: pass %s", render->side.label, info->name);
    for (uint32_t i = 0; i < info->write_count; i++) {
        uint32_t mips = resource_mips_before(render->pipeline.info, pass + 1, info->writes[i]);
        for (uint32_t mip = 0; mips >> mip; mip++)
            if ((mips >> mip & 1) && !take_frame_output(render, pass, info->writes[i], mip))
                return false;
    }
    return true;
}

static bool write_frame_picture(const struct render *render, const char *path)
{
    const struct dt_resource *resource = &render->pipeline.info->resources[render->shown];
    const struct dt_log *log = &render->console->log;
    struct picture picture = {0};
    console_status(render->console, "writing %s", path);
    bool good = render->exr ? picture_linear(&picture, resource, &render->picture, log)
                            : picture_codes(&picture, resource, &render->picture, log);
    if (good) {
        console_hold(render->console);
        good = render->exr
                   ? hdr_write(path, picture.width, picture.height, picture.linear, log)
                   : image_write_png(path, picture.width, picture.height, 3, picture.codes, log);
        console_release(render->console);
    }
    picture_free(&picture);
    return good;
}

/* Writes the picture of one frame. */
static bool write_numbered(struct render *render, uint32_t frame)
{
    char *path = numbered_path(render->options.output, frame);
    if (!path)
        report_error(&render->console->log, "out of memory");
    bool good = path && (!render->picture.data || write_frame_picture(render, path));
    free(path);
    return good;
}

static bool run_frames(struct render *render)
{
    const struct options *options = &render->options;
    const struct dt_observer observer = {
        .before_pass = render_before_pass, .after_pass = render_after_pass, .user = render};
    for (uint32_t i = 0; i < options->setup.frames; i++) {
        bool only = options->setup.capture && !options->output && !options->dump;
        bool looks = render->numbered || (i + 1 == options->setup.frames && !only);
        double start = milliseconds_now();
        render->last = i + 1 == options->setup.frames;
        bool captured = options->setup.capture && render->last;
        if ((captured && !capture_begin(options->setup.capture, &render->console->log)) ||
            !session_frame(&render->session, looks ? &observer : NULL) ||
            (captured && !capture_end(options->setup.capture, &render->console->log)) ||
            (render->numbered && !write_numbered(render, i)))
            return false;
        /* the observer makes every pass wait, so the last frame is timed only when it is also the
         * first */
        if (options->timings && (!render->last || i == 0) &&
            !timings_take(&render->timings, &render->session, milliseconds_now() - start))
            return false;
    }
    if (!take_undefined(render) || !session_is_silent(&render->session))
        return false;
    return render->picture.data || !options->output ||
           report_error(&render->console->log,
                        "the runtime finished the frame without reporting pass %s",
                        render->pipeline.info->passes[render->shown_pass].name);
}

/* Adds backend, pipeline, scene and frame to the dump's manifest. */
static bool identify(struct render *render)
{
    const struct session *session = &render->session;
    struct identity identity =
        pipeline_identity(&render->pipeline, &render->scene, &render->options.setup);
    identity.backend = render->side.label;
    identity.device = session->runtime->device(session->handle)->name;
    return identity_add(render->dump.manifest, &identity, &render->console->log);
}

/* RenderDoc reports version 1.2 of a device that it cannot replay buffer addresses of. */
static bool open_session(struct render *render, const struct session_info *info)
{
    if (session_open(&render->session, info))
        return true;
    if (info->setup->capture && strcmp(render->side.backend, "vk") == 0)
        report_message(&render->console->log, DT_INFO,
                       "--capture: RenderDoc hides Vulkan 1.3 of drivers without "
                       "bufferDeviceAddressCaptureReplay, such as Mesa 22's lavapipe");
    return false;
}

static bool can_write_picture(const struct render *render)
{
    const char *path = render->options.output;
    char *first = path && render->numbered ? numbered_path(path, 0) : NULL;
    bool good = !path || file_can_write(first ? first : path, &render->console->log);
    free(first);
    return good;
}

static bool render_prepare(struct render *render)
{
    const struct options *options = &render->options;
    const struct dt_log *log = &render->console->log;
    if (!can_write_picture(render) ||
        (options->timings && !file_can_write(options->timings, log)) ||
        (options->setup.capture && !file_can_write(options->setup.capture, log)))
        return false;
    if (!pipeline_load(&render->pipeline, render->console, &options->setup))
        return false;
    if (!find_shown(render) ||
        !inputs_load(&render->pipeline, render->console, &render->options.setup) ||
        !session_load_scene(&render->scene, render->console, render->pipeline.info,
                            &options->setup))
        return false;
    render->options.setup.frames = session_frames(&options->setup, &render->scene);
    if (options->timings && !timings_create(&render->timings, render->pipeline.info->pass_count,
                                            options->setup.frames, log))
        return false;
    if (options->dump &&
        !dump_begin(&render->dump, render->console, render->pipeline.info, options->dump))
        return false;
    const struct session_info info = {.side = &render->side,
                                      .console = render->console,
                                      .setup = &options->setup,
                                      .pipeline = &render->pipeline,
                                      .scene = &render->scene,
                                      .timing = options->timings};
    return open_session(render, &info) && (!options->dump || identify(render)) &&
           session_prepare(&render->session);
}

static cJSON *render_json(const struct render *render)
{
    const struct options *options = &render->options;
    const struct session *session = &render->session;
    const struct dt_pipeline *info = render->pipeline.info;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", info->name);
    cJSON_AddStringToObject(root, "scene", options->setup.scene);
    cJSON_AddStringToObject(root, "backend", render->side.label);
    cJSON_AddStringToObject(root, "device", session->runtime->device(session->handle)->name);
    cJSON_AddBoolToObject(root, "software", session->runtime->device(session->handle)->software);
    cJSON_AddNumberToObject(root, "width", options->setup.size[0]);
    cJSON_AddNumberToObject(root, "height", options->setup.size[1]);
    cJSON_AddNumberToObject(root, "frames", options->setup.frames);
    if (options->output) {
        cJSON_AddStringToObject(root, "output", options->output);
        cJSON_AddStringToObject(root, "resource", info->resources[render->shown].name);
    }
    cJSON_AddStringToObject(root, "dump", options->dump);
    cJSON_AddStringToObject(root, "timings", options->timings);
    cJSON_AddStringToObject(root, "capture", options->setup.capture);
    if (options->setup.sanitize)
        cJSON_AddItemToObject(
            root, "undefined",
            undefined_json(&render->undefined, (const char *const *)&render->side.label, 1));
    return root;
}

int verb_render(struct console *console, const struct options *options)
{
    struct render render = {.console = console, .options = *options};
    if (options->setup.capture && !capture_load(&console->log))
        return EXIT_FAILED;
    if (!read_side(&render) || !check_output(&render)) {
        side_free(&render.side);
        return EXIT_USAGE;
    }
    bool good = render_prepare(&render) && run_frames(&render);
    if (good && options->timings)
        good = timings_write(&render.timings, &render.session, options->timings);
    console->result = good ? render_json(&render) : NULL;
    session_close(&render.session);
    good = good && atomic_load(&console->errors) ==
                       0; /* messages while the device was torn down count, too */
    if (good && options->output && !render.numbered)
        good = write_frame_picture(&render, options->output);
    good = dump_end(&render.dump, good) && good;
    if (good)
        undefined_print(&render.undefined, (const char *const *)&render.side.label, 1);
    good = good && !render.undefined.count;
    undefined_free(&render.undefined);
    free(render.picture.data);
    timings_free(&render.timings);
    scene_free(&render.scene);
    side_free(&render.side);
    pipeline_unload(&render.pipeline);
    return good ? EXIT_FINE : EXIT_FAILED;
}
