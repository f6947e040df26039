/* What the window leaves: pictures, arrays, overlays, cases of a bisection; and the messages
 * that it shows. */
#include "view/view.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "console/tool.h"
#include "picture/hdr.h"
#include "picture/array.h"
#include "run/camera.h"

/* diptych-NNN with that ending, of the first free number; free(). */
static char *free_name(const char *ending, const struct dt_log *log)
{
    for (int i = 0; i < 1000; i++) {
        char *path = format_string("diptych-%03d%s", i, ending);
        if (!path || access(path, F_OK) != 0)
            return path;
        free(path);
    }
    report_error(log, "diptych-000%s to diptych-999%s exist already: move some", ending, ending);
    return NULL;
}

/* With several sides, the side's name stands in the ending. */
static char *side_name(const struct view *view, uint32_t side, const char *ending)
{
    char *own = view->side_count > 1 ? format_string("-%s%s", view->sides.list[side].label, ending)
                                     : strdup(ending);
    for (char *at = own; at && *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("-.+", *at))
            *at = '_';
    char *path = own ? free_name(own, &view->console->log) : NULL;
    free(own);
    return path;
}

static void tell(const struct view *view, bool good, const char *path)
{
    if (good)
        report_message(&view->console->log, DT_INFO, "wrote %s", path);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static bool write_npy(const struct view *view, const struct view_side *side, const char *path)
{
    const struct dt_bytes bytes = view_layer(view, side);
    return array_write(path, &view->pipeline.info->resources[view->shown.resource], &bytes,
                       &view->console->log);
}

static bool write_exr(const struct view *view, const struct view_side *side, const char *path)
{
    const struct dt_resource *resource = &view->pipeline.info->resources[view->shown.resource];
    const struct dt_bytes bytes = view_layer(view, side);
    struct picture picture = {0};
    bool good = picture_linear(&picture, resource, &bytes, &view->console->log);
    console_hold(view->console);
    good =
        good && hdr_write(path, picture.width, picture.height, picture.linear, &view->console->log);
    console_release(view->console);
    picture_free(&picture);
    return good;
}

static void save_sides(struct view *view, const char *ending,
                       bool (*write)(const struct view *, const struct view_side *, const char *))
{
    for (uint32_t i = 0; i < view->side_count; i++) {
        char *path = side_name(view, i, ending);
        if (path && view_read(view, &view->side[i]))
            tell(view, write(view, &view->side[i], path), path);
        free(path);
    }
}

/* The camera as a motion of one frame. */
static char *write_camera(const struct view *view)
{
    char *path = free_name(".motion.yaml", &view->console->log);
    char *camera = camera_text(&view->scene.camera);
    char *text = camera ? format_string("keys:\n  - {at: 0, camera: %s}\n", camera) : NULL;
    bool good = path && text && file_write(path, text, strlen(text), &view->console->log);
    free(text);
    free(camera);
    if (good)
        return path;
    free(path);
    return NULL;
}

/* ---- What the user asks for ------------------------------------------------------------------ */

static void save_sets(const struct view *view)
{
    char *path = free_name(".yaml", &view->console->log);
    char *text = view_params_text(view, "- ", "\n", true, true);
    if (path && text && *text)
        tell(view, file_write(path, text, strlen(text), &view->console->log), path);
    free(text);
    free(path);
}

void view_save(struct view *view, unsigned wishes)
{
    const struct dt_log *log = &view->console->log;
    bool image = view->pipeline.info->resources[view->shown.resource].kind == DT_IMAGE;
    if (image && wishes & OVERLAY_SAVE_PNG) {
        char *path = free_name(".png", log);
        if (path)
            tell(view, view_write_png(view, path), path);
        free(path);
    }
    if (image && wishes & OVERLAY_SAVE_EXR)
        save_sides(view, ".exr", write_exr);
    if (wishes & OVERLAY_SAVE_NPY)
        save_sides(view, ".npy", write_npy);
    if (wishes & OVERLAY_SAVE_SETS)
        save_sets(view);
    if (wishes & OVERLAY_SAVE_CAMERA && !view->scene.path) {
        report_message(log, DT_WARNING, "there is no scene, and no camera to save");
    } else if (wishes & OVERLAY_SAVE_CAMERA) {
        char *path = write_camera(view);
        tell(view, path, path);
        free(path);
    }
}

bool view_photograph(struct view *view, const char *path)
{
    const struct dt_log *log = &view->console->log;
    struct dt_bytes photo = {0};
    if (!view_present(view, &photo))
        return false;
    if (!photo.data)
        return report_error(log, "--present %s: the window shows nothing", path);
    size_t count = photo.size / 4;
    for (size_t i = 0; i < count; i++) /* RGBA to RGB, in place */
        memmove(photo.data + 3 * i, photo.data + 4 * i, 3);
    console_hold(view->console);
    bool good = image_write_png(path, photo.extent[0], photo.extent[1], 3, photo.data, log);
    console_release(view->console);
    free(photo.data);
    return good;
}

/* ---- Bisection ------------------------------------------------------------------------------- */

/* All that the thread needs; owned. */
struct bisection {
    struct console *console;
    atomic_bool *running;
    struct words words;
    char *folder, *motion; /* motion: a file to remove; NULL: none */
};

static void free_bisection(struct bisection *work)
{
    if (work && work->motion)
        unlink(work->motion);
    if (work) {
        free(work->motion);
        free(work->folder);
        words_free(&work->words);
    }
    free(work);
}

static void *run_bisection(void *user)
{
    struct bisection *work = user;
    int status = tool_status(work->words.list, work->console);
    if (file_exists(work->folder))
        report_message(&work->console->log, DT_INFO, "wrote %s: diptych replay %s --backend NAME",
                       work->folder, work->folder);
    else
        report_message(&work->console->log, DT_WARNING,
                       "bisect: no pass is guilty in frame 0 (exit status %d); nothing was written",
                       status);
    *work->running = false;
    free_bisection(work);
    return NULL;
}

/* What the user has changed, --set of each line. */
static void add_edits(const struct view *view, struct words *words)
{
    char *edits = view_params_text(view, "", "\n", true, true), *rest = NULL;
    words->failed |= !edits;
    for (char *edit = edits ? strtok_r(edits, "\n", &rest) : NULL; edit;
         edit = strtok_r(NULL, "\n", &rest))
        words_pair(words, "--set", edit);
    free(edits);
}

/* Starts `compare --bisect` with the settings of the window. */
static void add_comparison(const struct view *view, const char *motion, const char *folder,
                           struct words *words)
{
    const struct setup *setup = &view->options->setup;
    char size[32], frames[16];
    snprintf(size, sizeof size, "%ux%u", view->size[0], view->size[1]);
    snprintf(frames, sizeof frames, "%u", view->moving ? view->present_moment + 1 : 1);
    words_pair(words, "/proc/self/exe", "compare");
    words_pair(words, "--backend", setup->backend);
    words_pair(words, "--spec", setup->spec);
    for (uint32_t i = 0; i < setup->set_count; i++)
        words_pair(words, "--set", setup->sets[i]);
    add_edits(view, words);
    words_pair(words, "--scene", setup->scene);
    words_pair(words, "--scenes", setup->scenes);
    words_pair(words, "--device", setup->device);
    if (setup->glsl)
        words_add(words, "--glsl");
    for (uint32_t i = 0; i < setup->inputs.count; i++)
        words_pair(words, "--input", setup->inputs.items[i]);
    words_pair(words, "--size", size);
    words_pair(words, "--frames", frames);
    words_pair(words, "--motion", view->moving ? setup->motion : motion);
    words_pair(words, "--bisect", folder);
}

static struct bisection *plan_bisection(struct view *view)
{
    struct bisection *work = calloc(1, sizeof *work);
    if (!work)
        return NULL;
    work->console = view->console;
    work->running = &view->bisecting;
    work->folder = free_name("-case", &view->console->log);
    bool own = !view->moving && view->scene.path;
    if (own)
        work->motion = write_camera(view);
    add_comparison(view, work->motion, work->folder, &work->words);
    if (work->folder && !work->words.failed && (!own || work->motion))
        return work;
    free_bisection(work);
    return NULL;
}

void view_bisect(struct view *view)
{
    const struct dt_log *log = &view->console->log;
    view_bisect_end(view);
    struct bisection *work = plan_bisection(view);
    view->bisecting = work;
    if (work && pthread_create(&view->bisector, NULL, run_bisection, work) == 0) {
        view->bisected = true;
        report_message(log, DT_INFO, "bisecting in a process of its own ...");
        return;
    }
    view->bisecting = false;
    free_bisection(work);
    report_error(log, "the bisection cannot be started");
}

void view_bisect_end(struct view *view)
{
    if (view->bisected)
        pthread_join(view->bisector, NULL);
    view->bisected = false;
}

/* ---- Messages -------------------------------------------------------------------------------- */

static void on_message(void *user, enum dt_level level, const char *message)
{
    static const size_t most = 1 << 16;
    static const char *const words[] = {
        [DT_INFO] = "", [DT_WARNING] = "warning: ", [DT_ERROR] = "error: "};
    struct view_log *log = &((struct view *)user)->log;
    pthread_mutex_lock(&log->lock);
    const char *old = log->text ? log->text : "";
    if (strlen(old) > most)
        old = strchr(old + most / 2, '\n') ? strchr(old + most / 2, '\n') + 1 : "";
    char *text = format_string("%s%s%s\n", old, words[level], message);
    if (text) {
        free(log->text);
        log->text = text;
        log->lines++;
    }
    pthread_mutex_unlock(&log->lock);
    log->before.message(log->before.user, level, message);
}

void view_log_open(struct view *view)
{
    pthread_mutex_init(&view->log.lock, NULL);
    view->log.before = view->console->log;
    view->console->log = (struct dt_log){.message = on_message, .user = view};
}

void view_log_close(struct view *view)
{
    view->console->log = view->log.before;
    pthread_mutex_destroy(&view->log.lock);
    free(view->log.text);
    free(view->log.seen);
}
