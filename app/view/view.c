/* `diptych view`: a window on up to three backends, with a camera that flies. Frames run one after
 * the other on this thread, which owns the window; only the first frame of several backends uses more
 * threads. Keys and mouse leave wishes, carried out between frames. */
#include "view/view.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "scenes/motion.h"
#include "spec/inputs.h"

/* ---- Opening --------------------------------------------------------------------------------- */

static bool read_sides(struct view *view)
{
    struct options options = *view->options;
    const struct dt_log *log = &view->console->log;
    const char *given = options.setup.backend ? options.setup.backend : "both";
    options.setup.backend = strcmp(given, "both") == 0 ? "gl,vk" : given;
    view->own.setup.backend = options.setup.backend;
    if (!sides_read_each(&view->sides, &options.setup, log))
        return false;
    struct side *first = &view->sides.list[0];
    if (view->sides.count > VIEW_SIDES)
        return report_error(log, "--backend %s: a window shows at most %d backends", given,
                            VIEW_SIDES);
    if (first->context)
        return report_error(log, "--backend %s: only gl and vk can draw into a window",
                            first->label);
    view->side_count = view->sides.count;
    return true;
}

bool view_open_side(struct view *view, uint32_t index)
{
    const struct session_info info = {.side = &view->sides.list[index],
                                      .console = view->console,
                                      .setup = &view->options->setup,
                                      .pipeline = &view->pipeline,
                                      .scene = &view->scene,
                                      .timing = true,
                                      .keep_history = true,
                                      .name_in_log = view->side_count > 1};
    struct session *session = &view->side[index].session;
    return session_open(session, &info) &&
           session->runtime->set_scene(session->handle, &view->scene.data) &&
           session_create(session, &view->pipeline);
}

/* Letters in the size of the user's settings, on a screen of this density. */
static void set_fonts(struct view *view)
{
    float density[2] = {1, 1};
    glfwGetWindowContentScale(view->window, &density[0], &density[1]);
    overlay_fonts(view->overlay, roundf(view->settings.font * fmaxf(density[0], 1)));
}

static bool open_overlay(struct view *view)
{
    view->overlay = overlay_open(view->window);
    if (!view->overlay)
        return report_error(&view->console->log,
                            "the overlay does not open: out of memory, or no libGL");
    set_fonts(view);
    return true;
}

/* As the options say, else as the last one was, if the screen has that room. */
static void choose_window(const struct view *view, int size[2])
{
    const uint32_t *given = view->options->window;
    int place[2] = {0}, room[2] = {0};
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (monitor)
        glfwGetMonitorWorkarea(monitor, &place[0], &place[1], &room[0], &room[1]);
    for (int i = 0; i < 2; i++) {
        size[i] = given[i] ? (int)given[i] : view->settings.window[i];
        if (!given[i] && room[i] > 0 && size[i] > room[i])
            size[i] = room[i];
    }
}

bool view_open_window(struct view *view, int width, int height)
{
    int size[2] = {width, height};
    view->screen = gl_window_open(view->console->log, view->options->setup.debug);
    if (!view->screen)
        return false;
    char *title =
        format_string("diptych: %s, %s", view->pipeline.info->name,
                      view->options->setup.scene ? view->options->setup.scene : "no scene");
    view->window = gl_window_handle(view->screen);
    if (!width)
        choose_window(view, size);
    glfwSetWindowTitle(view->window, title ? title : "diptych");
    glfwSetWindowSize(view->window, size[0], size[1]);
    glfwShowWindow(view->window);
    free(title);
    view_input_open(view);
    return open_overlay(view);
}

void view_close_window(struct view *view)
{
    if (view->overlay) {
        gl_window_begin(view->screen); /* a lost context logs an error; go on */
        overlay_close(view->overlay);
        view->overlay = NULL;
    }
    view->noisy |= view->screen && gl_window_messages(view->screen);
    gl_window_close(view->screen);
    view->screen = NULL;
}

/* Without any option, the Cornell Box and both backends, if there are two. */
static bool open_sides(struct view *view)
{
    bool chosen = view->options->setup.backend && view->backend_given;
    for (uint32_t i = 0; i < view->side_count; i++) {
        if (view_open_side(view, i))
            continue;
        if (i == 0 || chosen)
            return false;
        report_message(&view->console->log, DT_WARNING, "%s does not open: %s is shown alone",
                       view->sides.list[i].label, view->sides.list[0].label);
        view_close_side(view, i);
        view->side_count = i;
    }
    return true;
}

static bool open_view(struct view *view)
{
    const struct options *options = view->options;
    const struct dt_log *log = &view->console->log;
    view_settings_read(&view->settings);
    view->backend_given = options->setup.backend;
    if (!options->setup.spec && !options->setup.scene)
        view->own.setup.scene = "cornell";
    if ((options->screenshot && !file_can_write(options->screenshot, log)) ||
        (options->present && !file_can_write(options->present, log)) || !read_sides(view) ||
        !pipeline_load(&view->pipeline, view->console, &options->setup) || !view_find_home(view) ||
        !inputs_load(&view->pipeline, view->console, &view->own.setup) ||
        !session_load_scene(&view->scene, view->console, view->pipeline.info, &options->setup))
        return false;
    view->moving = view->scene.motion;
    memcpy(view->size, options->setup.size, sizeof view->size);
    if (!open_sides(view) || !view_open_window(view, 0, 0))
        return false;
    view->own.setup.for_gpu = true; /* of later plans, where no side takes the other */
    for (uint32_t i = 0; i < view->side_count; i++)
        view->own.setup.for_gpu &= view->side[i].session.for_gpu;
    view->reload = reload_start(view->console, &view->own.setup, &view->pipeline);
    console_status(view->console, "%s", "");
    return view->reload && view_times_create(view) && view_params_create(view) &&
           view_verdict_create(view);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

struct watch {
    struct view *view;
    struct view_side *side;
};

/* Resources may share memory: read the shown one after the pass that wrote it. */
static bool view_after_pass(void *user, uint32_t pass)
{
    const struct watch *watch = user;
    struct view *view = watch->view;
    uint32_t index = (uint32_t)(watch->side - view->side);
    return (pass != view->shown.pass || view_read(view, watch->side)) &&
           (!view->verdict.checking || view_verdict_take(view, index, pass));
}

static bool render_side(struct view *view, struct view_side *side, const struct dt_frame *frame)
{
    struct watch watch = {view, side};
    const struct session *session = &side->session;
    const struct dt_pipeline *info = view->pipeline.info;
    bool output =
        (int)view->shown.resource == info->display_output && /* lives on after the frame */
        view->shown.pass == view_last_writer(info, view->shown.resource, 0);
    bool takes = !output || view->verdict.checking;
    const struct dt_observer own = {.after_pass = view_after_pass, .user = &watch};
    const struct dt_observer *observer = takes ? &own : NULL;
    double start = milliseconds_now();
    view_forget(side);
    return session->runtime->render(session->handle, frame, view->pipeline.live, observer) &&
           view_times_take(side, view->verdict.checking ? (double)NAN : milliseconds_now() - start);
}

/* One side's frame on a thread of its own. */
struct side_frame {
    struct view *view;
    struct view_side *side;
    const struct dt_frame *frame;
    int messages; /* where those of the thread go that waits for the frame */
    bool good;
};

static void *render_apart(void *user)
{
    struct side_frame *work = user;
    console_capture_too(work->messages);
    work->good = render_side(work->view, work->side, work->frame);
    return NULL;
}

/* The first frame mostly compiles shaders in the drivers, each on one thread: Vulkan does that on
 * another thread than OpenGL, whose context belongs to this one. Later frames take turns, since
 * their times are shown. */
static bool render_sides(struct view *view, const struct dt_frame *frame)
{
    struct side_frame work[VIEW_SIDES];
    pthread_t threads[VIEW_SIDES];
    bool apart[VIEW_SIDES] = {false}, good = true;
    for (uint32_t i = 1; i < view->side_count && frame->index == 0 && !view->verdict.checking;
         i++) {
        struct view_side *side = &view->side[i];
        work[i] = (struct side_frame){view, side, frame, console_capturing(), false};
        apart[i] = i == 1 && strcmp(side->session.runtime->name, "vk") == 0 &&
                   pthread_create(&threads[i], NULL, render_apart, &work[i]) == 0;
    }
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!apart[i])
            good = good && render_side(view, &view->side[i], frame);
    for (uint32_t i = 1; i < view->side_count; i++)
        if (apart[i]) {
            pthread_join(threads[i], NULL);
            good = good && work[i].good;
        }
    return good;
}

/* The frame is as large as --size or an input says, else as the room for the picture was when the window got its size. */
static bool fit_to_window(struct view *view)
{
    uint32_t size[2] = {view->options->setup.size[0], view->options->setup.size[1]};
    bool same_window =
        view->fitted[0] == view->window_size[0] && view->fitted[1] == view->window_size[1];
    if (view->pipeline.frame_size[0])
        memcpy(size, view->pipeline.frame_size, sizeof size);
    else if (view->options->setup.default_size &&
             (same_window || overlay_is_editing(view->overlay)))
        memcpy(size, view->size, sizeof size);
    else if (view->options->setup.default_size) {
        for (int i = 0; i < 2; i++) /* the first finds how high the lines above the picture are */
            if (!view_overlay_build(view))
                return false;
        overlay_room(view->overlay, size);
    }
    memcpy(view->fitted, view->window_size, sizeof view->fitted);
    if (size[0] == view->size[0] && size[1] == view->size[1] && view->frames)
        return true;
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!session_resize(&view->side[i].session, size))
            return false;
    memcpy(view->size, size, sizeof view->size);
    view->shown.marked = false;
    view->step = true;
    return true;
}

/* Camera and light of the motion's present frame. */
static void move(struct view *view)
{
    uint32_t count = motion_frames(view->scene.motion);
    motion_at(view->scene.motion, view->moment, &view->scene.camera, &view->scene.light);
    view->present_moment = view->moment;
    if (!view->paused)
        view->moment = (view->moment + 1) % count;
}

bool view_render(struct view *view)
{
    struct dt_frame frame;
    memset(&frame, 0, sizeof frame);
    view_verdict_begin(view);
    if (view->moving)
        move(view);
    scene_frame(&view->scene, view->size[0], view->size[1], &frame);
    frame.index = view->frame++;
    if (frame.index == 0)
        view->start = milliseconds_now();
    frame.time = view->moving ? (float)view->present_moment / 60
                              : (float)((milliseconds_now() - view->start) * 1e-3);
    view->frames++;
    view->camera = frame.camera;
    return render_sides(view, &frame) && view_verdict_end(view) && view_pictures(view);
}

bool view_present(struct view *view, struct dt_bytes *photo)
{
    if (!gl_window_begin(view->screen))
        return false;
    set_fonts(view);
    if (!view_overlay_build(view))
        return false;
    overlay_draw(view->overlay);
    return gl_window_end(view->screen, photo);
}

static void fit_range(struct view *view)
{
    struct view_side *side = &view->side[0];
    struct picture_look *look = &view->shown.look;
    const struct dt_resource *resource = &view->pipeline.info->resources[view->shown.resource];
    if (resource->kind != DT_IMAGE || !view_read(view, side))
        return;
    const struct dt_bytes part = view_layer(view, side);
    picture_range(resource, &part, look->channel, look->range);
    look->exposure = 0;
    look->ranged = true;
}

/* Carries out wishes that need a finished frame. */
static bool fulfil_wishes(struct view *view)
{
    const unsigned wishes = view->wishes;
    if (view->step)
        return true;
    view->wishes = 0;
    view_save(view, wishes);
    if (wishes & OVERLAY_BISECT)
        view_bisect(view);
    if (wishes & OVERLAY_UNDO)
        view_params_undo(view);
    if (wishes & OVERLAY_SWAP)
        view_params_swap(view);
    if (wishes & OVERLAY_FIRST)
        view_show_first(view);
    if (wishes & OVERLAY_PAUSE)
        view->paused = !view->paused;
    if (wishes & OVERLAY_STEP) {
        view->paused |= (wishes & OVERLAY_ALONE) != 0;
        view->step = true;
    }
    if (wishes & OVERLAY_FIT)
        fit_range(view);
    return view->step || !(wishes & (OVERLAY_REDRAW | OVERLAY_FIT)) || view_pictures(view);
}

static bool is_over(const struct view *view)
{
    uint32_t frames = view->options->run_frames;
    return view->quit || glfwWindowShouldClose(view->window) || (frames && view->frames >= frames);
}

/* Whether no frame runs: paused, or a reload on a software driver, which frames would slow down. */
static bool rests(const struct view *view)
{
    const struct session *first = &view->side[0].session;
    return (view->paused && !view->step) ||
           (view->reloading && first->runtime->device(first->handle)->software);
}

static bool run_frame(struct view *view)
{
    double now = glfwGetTime();
    view_input_fly(view, now - view->time);
    view->time = now;
    if (!view_reload(view) || !fit_to_window(view))
        return false;
    if (!rests(view)) {
        if (!view_render(view))
            return false;
        view->step = view->gave_up = false;
    }
    return view_present(view, NULL) && fulfil_wishes(view);
}

/* Some window systems give a minimised window no pixels, others let it keep its size. */
static bool is_minimised(const struct view *view)
{
    return !view->window_size[0] || !view->window_size[1] ||
           glfwGetWindowAttrib(view->window, GLFW_ICONIFIED);
}

static void measure_window(struct view *view)
{
    int width, height;
    glfwGetFramebufferSize(view->window, &width, &height);
    view->window_size[0] = width > 0 ? (uint32_t)width : 0;
    view->window_size[1] = height > 0 ? (uint32_t)height : 0;
}

/* Screens without a refresh to wait for, such as Xvfb's, would get frames that nobody sees. */
static void wait_for_frame(const struct view *view)
{
    GLFWmonitor *screen = glfwGetPrimaryMonitor();
    const GLFWvidmode *mode = screen ? glfwGetVideoMode(screen) : NULL;
    int rate = mode && mode->refreshRate > 0 ? mode->refreshRate : 60;
    double left = rests(view)                 ? 0.05
                  : view->options->run_frames ? 0
                                              : view->time + 1.0 / rate - glfwGetTime();
    if (left > 0)
        glfwWaitEventsTimeout(left);
    else
        glfwPollEvents();
}

static bool run_window(struct view *view)
{
    view->time = glfwGetTime();
    measure_window(view);
    if (!view_present(view, NULL)) /* the panes, while drivers compile for the first frame */
        return false;
    while (!is_over(view)) {
        wait_for_frame(view);
        measure_window(view);
        if (is_minimised(view)) { /* minimised: the camera stands still, too */
            glfwWaitEventsTimeout(0.2);
            view->time = glfwGetTime();
        } else if (!run_frame(view) && !view_revive(view)) {
            return false;
        }
    }
    return true;
}

/* ---- Closing --------------------------------------------------------------------------------- */

void view_close_side(struct view *view, uint32_t index)
{
    struct view_side *side = &view->side[index];
    if (side->session.handle && !session_is_silent(&side->session))
        view->noisy = true;
    session_close(&side->session);
    view_forget(side);
}

static void close_sides(struct view *view)
{
    for (uint32_t i = view->side_count; i-- > 0;) {
        view_close_side(view, i);
        view_times_free(&view->side[i].times);
    }
}

int verb_view(struct console *console, const struct options *options)
{
    struct view view = {.console = console,
                        .own = *options,
                        .options = &view.own,
                        .shown.gain = 16,
                        .speed = 0.5f,
                        .reload_ms = (double)NAN};
    view_log_open(&view);
    bool good = open_view(&view) && run_window(&view);
    if (good && options->screenshot)
        good = view_write_png(&view, options->screenshot);
    if (good && options->present)
        good = view_photograph(&view, options->present);
    if (good) {
        view_tell(&view);
        view_settings_write(&view);
    }
    view_bisect_end(&view);
    reload_stop(view.reload);
    close_sides(&view);
    view_close_window(&view);
    view_params_free(&view.params);
    view_verdict_free(&view.verdict);
    view_log_close(&view);
    free(view.error);
    scene_free(&view.scene);
    sides_free(&view.sides);
    pipeline_unload(&view.pipeline);
    return good && !view.noisy ? EXIT_FINE : EXIT_FAILED;
}
