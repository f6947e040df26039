/* `diptych view`: a window on one backend, or on two side by side, with a camera that flies. Frames
 * run one after the other on this thread, which owns the window; only the first frame of two
 * backends uses a second thread. Keys and mouse leave wishes, carried out between frames. */
#include "view/view.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "spec/inputs.h"
#include "view/camera.h"

/* ---- Opening --------------------------------------------------------------------------------- */

static bool read_sides(struct view *view)
{
    struct options options = *view->options;
    const struct dt_log *log = &view->console->log;
    const char *given = options.setup.backend ? options.setup.backend : "gl";
    options.setup.backend = strcmp(given, "both") == 0 ? "gl,vk" : given;
    if (!sides_read_each(&view->sides, &options.setup, log))
        return false;
    struct side *first = &view->sides.list[0];
    if (view->sides.count > VIEW_SIDES) {
        report_error(log, "--backend %s: a window shows one backend, or two of them", given);
        return false;
    }
    if (first->context) {
        report_error(log, "--backend %s: only gl and vk can draw into a window", first->label);
        return false;
    }
    first->context = "window";
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
                                      .name_in_log = view->side_count > 1};
    struct view_side *side = &view->side[index];
    struct session *session = &side->session;
    return session_open(session, &info) &&
           session->runtime->set_scene(session->handle, &view->scene.data) &&
           session->runtime->create(session->handle, view_shaders_of(side, &view->pipeline));
}

static bool open_overlay(struct view *view)
{
    const struct session *window = &view->side[0].session;
    uint32_t width, height;
    view->overlay = overlay_open(view->window);
    if (!view->overlay) {
        report_error(&view->console->log, "out of memory for the overlay");
        return false;
    }
    const uint8_t *atlas = overlay_atlas(view->overlay, &width, &height);
    return window->runtime->window_upload(window->handle, 0, width, height, atlas);
}

bool view_open_window(struct view *view, int width, int height)
{
    char *title =
        format_string("diptych: %s, %s", view->pipeline.info->name,
                      view->options->setup.scene ? view->options->setup.scene : "no scene");
    view->window = view->side[0].session.runtime->window(view->side[0].session.handle);
    glfwSetWindowTitle(view->window, title ? title : "diptych");
    glfwSetWindowSize(view->window, width, height);
    glfwShowWindow(view->window);
    free(title);
    view_input_open(view);
    return open_overlay(view);
}

static bool open_view(struct view *view)
{
    const struct options *options = view->options;
    const struct dt_log *log = &view->console->log;
    int width = (int)options->setup.size[0], height = (int)options->setup.size[1];
    view->own.setup.default_size = true; /* --size is the window's; an input may set the frame's */
    if ((options->screenshot && !file_can_write(options->screenshot, log)) || !read_sides(view) ||
        !pipeline_load(&view->pipeline, view->console, &options->setup) || !view_find_home(view) ||
        !inputs_load(&view->pipeline, view->console, &view->own.setup) ||
        !view_outline_read(view) ||
        !session_load_scene(&view->scene, view->console, view->pipeline.info, &options->setup))
        return false;
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!view_open_side(view, i))
            return false;
    int panels = view->side_count > 1 ? 2 : 1;
    if (!view_open_window(view, width * panels, height))
        return false;
    view->reload = reload_start(view->console, &options->setup, &view->pipeline);
    console_status(view->console, "%s", "");
    return view->reload && view_times_create(view);
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
    return view_take(watch->view, watch->side, pass);
}

static bool render_side(struct view *view, struct view_side *side, const struct dt_frame *frame)
{
    struct watch watch = {view, side};
    const struct dt_pipeline *info = view->pipeline.info;
    bool output = (int)view->resource == info->display_output; /* lives on after the frame */
    bool takes = !output || view->shown_points;
    const struct dt_observer observer = {.after_pass = view_after_pass, .user = &watch};
    double start = milliseconds_now();
    view_forget(side);
    return side->session.runtime->render(side->session.handle, frame, view->pipeline.live,
                                         takes ? &observer : NULL) &&
           view_times_take(side, milliseconds_now() - start);
}

/* One side's frame on a thread of its own. */
struct side_frame {
    struct view *view;
    struct view_side *side;
    const struct dt_frame *frame;
    pthread_t waits; /* the thread that waits for the frame */
    bool good;
};

static void *render_apart(void *user)
{
    struct side_frame *work = user;
    console_capture_too(work->view->console, work->waits);
    work->good = render_side(work->view, work->side, work->frame);
    return NULL;
}

/* The first frame mostly compiles shaders in the drivers, each on one thread: Vulkan does that on
 * another thread than OpenGL, whose context belongs to this one. Later frames take turns, since
 * their times are shown. */
static bool render_both(struct view *view, const struct dt_frame *frame)
{
    struct view_side *second = &view->side[1];
    struct side_frame work = {view, second, frame, pthread_self(), false};
    pthread_t thread;
    bool apart = frame->index == 0 && strcmp(second->session.runtime->name, "vk") == 0 &&
                 pthread_create(&thread, NULL, render_apart, &work) == 0;
    bool good = render_side(view, &view->side[0], frame);
    if (!apart)
        return good && render_side(view, second, frame);
    pthread_join(thread, NULL);
    return good && work.good;
}

static bool render_sides(struct view *view, const struct dt_frame *frame)
{
    return view->side_count == 1 ? render_side(view, &view->side[0], frame)
                                 : render_both(view, frame);
}

static bool fit_to_window(struct view *view)
{
    uint32_t size[2];
    view_panel_size(view, size);
    if (view->pipeline.frame_size[0]) /* shown as large as fits */
        memcpy(size, view->pipeline.frame_size, sizeof size);
    if (size[0] == view->size[0] && size[1] == view->size[1])
        return true;
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!session_resize(&view->side[i].session, size))
            return false;
    memcpy(view->size, size, sizeof size);
    view->step = true;
    return true;
}

bool view_render(struct view *view)
{
    struct dt_frame frame;
    memset(&frame, 0, sizeof frame);
    scene_frame(&view->scene, view->size[0], view->size[1], &frame);
    frame.index = view->frame++;
    if (frame.index == 0)
        view->start = milliseconds_now();
    frame.time = (float)((milliseconds_now() - view->start) * 1e-3);
    view->frames++;
    view->camera = frame.camera;
    return render_sides(view, &frame) && view_pictures(view);
}

/* The overlay's triangles behind those of the pictures. */
static bool join(const struct view *view, struct dt_window_vertex **vertices,
                 struct dt_window_draw **draws, struct dt_window_frame *frame)
{
    struct dt_window_vertex own[6 * VIEW_MAX_DRAWS];
    struct dt_window_draw own_draws[VIEW_MAX_DRAWS];
    uint32_t count = view_layout(view, own, own_draws);
    const struct dt_window_frame over = overlay_frame(view->overlay);
    *vertices = malloc((6 * count + over.vertex_count) * sizeof **vertices);
    *draws = malloc((count + over.draw_count) * sizeof **draws);
    if (!*vertices || !*draws) {
        report_error(&view->console->log, "window: out of memory");
        return false;
    }
    memcpy(*vertices, own, 6 * count * sizeof *own);
    memcpy(*draws, own_draws, count * sizeof *own_draws);
    if (over.draw_count) {
        memcpy(*vertices + 6 * (size_t)count, over.vertices,
               over.vertex_count * sizeof *over.vertices);
        memcpy(*draws + count, over.draws, over.draw_count * sizeof *over.draws);
    }
    for (uint32_t i = 0; i < over.draw_count; i++)
        (*draws)[count + i].first += 6 * count;
    *frame = (struct dt_window_frame){*vertices, 6 * count + over.vertex_count, *draws,
                                      count + over.draw_count};
    return true;
}

static bool present(struct view *view)
{
    struct dt_window_vertex *vertices = NULL;
    struct dt_window_draw *draws = NULL;
    struct dt_window_frame frame;
    const struct session *window = &view->side[0].session;
    bool good = view_overlay_build(view) && join(view, &vertices, &draws, &frame) &&
                window->runtime->present(window->handle, &frame);
    free(vertices);
    free(draws);
    return good;
}

/* Writes diptych-NNN.png with the first free number. */
static bool take_screenshot(struct view *view)
{
    char *path = NULL;
    for (int i = 0; i < 1000 && (!path || access(path, F_OK) == 0); i++) {
        free(path);
        path = format_string("diptych-%03d.png", i);
        if (!path)
            return false;
    }
    bool good = view_write_png(view, path);
    if (good)
        report_message(&view->console->log, DT_INFO, "wrote %s", path);
    free(path);
    return good;
}

/* Carries out wishes that need a finished frame. Errors are logged and ignored. */
static void fulfil_wishes(struct view *view)
{
    const struct dt_log *log = &view->console->log;
    if (view->step)
        return;
    if (view->screenshot)
        take_screenshot(view);
    if (view->save_camera && camera_save(&view->scene.camera, view->scene.path, log))
        report_message(log, DT_INFO, "saved the camera into %s", view->scene.path);
    view->screenshot = view->save_camera = false;
}

static bool is_over(const struct view *view)
{
    uint32_t frames = view->options->run_frames;
    return view->quit || glfwWindowShouldClose(view->window) || (frames && view->frames >= frames);
}

/* Whether no frame runs: paused, or a reload on a software driver, which frames would slow down. */
static bool rests(const struct view *view)
{
    const struct session *window = &view->side[0].session;
    return (view->paused && !view->step) ||
           (view->reloading && window->runtime->is_software(window->handle));
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
    if (!present(view))
        return false;
    fulfil_wishes(view);
    return true;
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

static bool run_window(struct view *view)
{
    view->time = glfwGetTime();
    while (!is_over(view)) {
        if (rests(view))
            glfwWaitEventsTimeout(0.02);
        else
            glfwPollEvents();
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
    if (index == 0) { /* over its window */
        overlay_close(view->overlay);
        view->overlay = NULL;
    }
    if (side->session.handle && !session_is_silent(&side->session))
        view->noisy = true;
    session_close(&side->session);
    view_forget(side);
}

static void close_sides(struct view *view)
{
    for (uint32_t i = view->side_count; i-- > 0;) { /* last: it owns the window */
        view_close_side(view, i);
        view_times_free(&view->side[i].times);
    }
}

int verb_view(struct console *console, const struct options *options)
{
    struct view view = {.console = console,
                        .own = *options,
                        .options = &view.own,
                        .gain = 16,
                        .speed = 0.5f,
                        .reload_ms = (double)NAN};
    bool good = open_view(&view) && run_window(&view);
    if (good && options->screenshot)
        good = view_write_png(&view, options->screenshot);
    if (good)
        view_tell(&view);
    reload_stop(view.reload);
    close_sides(&view);
    view_outline_forget(&view);
    free(view.error);
    scene_free(&view.scene);
    sides_free(&view.sides);
    pipeline_unload(&view.pipeline);
    return good && !view.noisy ? EXIT_FINE : EXIT_FAILED;
}
