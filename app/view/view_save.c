/* What the window leaves: pictures, arrays, overlays, cases of a bisection, the user's settings; and
 * the messages that it shows. */
#include "view/view.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "base/text.h"
#include "console/hdr.h"
#include "console/texels.h"
#include "console/tool.h"
#include "view/camera.h"

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

/* ---- Arrays ---------------------------------------------------------------------------------- */

/* The elements of a buffer with its fields, without padding. */
static void add_fields(struct text *type, const struct dt_resource *resource)
{
    text_add(type, "[");
    for (uint32_t i = 0; i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        enum dt_type scalar = type_info(field->type)->scalar;
        const char *code = scalar == DT_TYPE_FLOAT ? "<f4" : scalar == DT_TYPE_INT ? "<i4" : "<u4";
        uint32_t numbers = type_components(field->type);
        text_add(type, "('%s', '%s', (", *field->name ? field->name : "value", code);
        if (field->array_count)
            text_add(type, "%u,", field->array_count);
        if (field->type == DT_TYPE_MAT4)
            text_add(type, "4,4,");
        else if (numbers > 1)
            text_add(type, "%u,", numbers);
        text_add(type, ")), ");
    }
    text_add(type, "]");
}

/* Codes of unorm and snorm stay codes; packed floats become float. */
static const char *number_code(enum number_kind kind)
{
    switch (number_is_packed(kind) ? NUMBER_FLOAT : kind) {
    case NUMBER_UNORM8:
    case NUMBER_UINT8:
        return "|u1";
    case NUMBER_INT8:
        return "|i1";
    case NUMBER_UNORM16:
    case NUMBER_UINT16:
        return "<u2";
    case NUMBER_SNORM16:
    case NUMBER_INT16:
        return "<i2";
    case NUMBER_HALF:
        return "<f2";
    case NUMBER_UINT:
        return "<u4";
    case NUMBER_INT:
        return "<i4";
    default:
        return "<f4";
    }
}

static void add_head(struct text *out, const struct dt_resource *resource,
                     const struct component *first, uint32_t count, const uint32_t extent[3])
{
    struct text type = {0}, head = {0};
    if (resource->kind == DT_BUFFER)
        add_fields(&type, resource);
    else
        text_add(&type, "'%s'", number_code(first->kind));
    text_add(&head, "{'descr': %s, 'fortran_order': False, 'shape': (", type.data ? type.data : "");
    if (resource->kind == DT_BUFFER)
        text_add(&head, "%u,), }", extent[0]);
    else
        text_add(&head, "%u, %u, %u, %u), }", extent[2], extent[1], extent[0], count);
    while ((10 + head.length + 1) % 64)
        text_add(&head, " ");
    text_add(&head, "\n");
    const char length[2] = {(char)(head.length & 255), (char)(head.length >> 8)};
    text_add_bytes(out, "\x93NUMPY\x01\x00", 8);
    text_add_bytes(out, length, 2);
    text_add_bytes(out, head.data ? head.data : "", head.length);
    out->failed |= type.failed || head.failed;
    text_free(&type);
    text_free(&head);
}

static bool write_npy(const struct view *view, const struct view_side *side, const char *path)
{
    const struct dt_resource *resource = &view->pipeline.info->resources[view->shown.resource];
    const struct dt_bytes bytes = view_layer(view, side);
    struct component *list = NULL;
    uint32_t count = resource_components(resource, &list), stride = resource_stride(resource);
    struct text out = {0};
    if (count)
        add_head(&out, resource, list, count, bytes.extent);
    for (size_t at = 0; count && at + stride <= bytes.size && !out.failed; at += stride)
        for (uint32_t i = 0; i < count; i++) {
            const uint8_t *place = bytes.data + at + list[i].offset;
            float number = (float)number_value(list[i].kind, place);
            bool packed = number_is_packed(list[i].kind);
            text_add_bytes(&out, packed ? (const char *)&number : (const char *)place,
                           packed ? sizeof number : number_size(list[i].kind));
        }
    bool good = count && !out.failed;
    if (!good)
        report_error(&view->console->log, "%s: out of memory", path);
    good = good && file_write(path, out.data, out.length, &view->console->log);
    text_free(&out);
    free(list);
    return good;
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
    if (wishes & OVERLAY_SAVE_CAMERA && !view->scene.path)
        report_message(log, DT_WARNING, "there is no scene file to save the camera into");
    else if (wishes & OVERLAY_SAVE_CAMERA &&
             camera_save(&view->scene.camera, view->scene.path, log))
        report_message(log, DT_INFO, "saved the camera into %s", view->scene.path);
}

bool view_photograph(struct view *view, const char *path)
{
    const struct dt_log *log = &view->console->log;
    struct dt_bytes photo = {0};
    if (!view_present(view, &photo))
        return false;
    if (!photo.data) {
        report_error(log, "--present %s: the window shows nothing", path);
        return false;
    }
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

enum { MOST_WORDS = 512 };

/* A command line; its strings are owned, and NULL behind the last. */
struct bisection {
    struct console *console;
    atomic_bool *running;
    char *words[MOST_WORDS + 1];
    uint32_t count;
    bool failed;
    char *folder, *motion; /* motion: a file to remove; NULL: none */
};

static void add_word(struct bisection *work, const char *name, const char *value)
{
    const char *const both[2] = {name, value};
    for (int i = 0; i < 2 && !work->failed; i++) {
        if (!both[i] || (i == 0 && !value))
            continue;
        work->failed = work->count == MOST_WORDS || !(work->words[work->count] = strdup(both[i]));
        work->count += !work->failed;
    }
}

static void free_bisection(struct bisection *work)
{
    for (uint32_t i = 0; i < work->count; i++)
        free(work->words[i]);
    if (work->motion)
        unlink(work->motion);
    free(work->motion);
    free(work->folder);
    free(work);
}

static void *run_bisection(void *user)
{
    struct bisection *work = user;
    int status = tool_status(work->words, work->console);
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

static void add_setup(struct bisection *work, const struct view *view)
{
    const struct setup *setup = &view->options->setup;
    char size[32], frames[16];
    snprintf(size, sizeof size, "%ux%u", view->size[0], view->size[1]);
    snprintf(frames, sizeof frames, "%u", view->moving ? view->moment + 1 : 1);
    add_word(work, "--backend", setup->backend);
    add_word(work, "--spec", setup->spec);
    add_word(work, "--scene", setup->scene);
    add_word(work, "--scenes", setup->scenes);
    add_word(work, "--device", setup->device);
    add_word(work, "--fault", view->options->fault);
    if (setup->glsl)
        add_word(work, "", "--glsl");
    for (uint32_t i = 0; i < setup->inputs.count; i++)
        add_word(work, "--input", setup->inputs.items[i]);
    for (uint32_t i = 0; i < setup->set_count; i++)
        add_word(work, "--set", setup->sets[i]);
    char *edits = view_params_text(view, "", "\n", true, true);
    char *rest = NULL;
    for (char *edit = strtok_r(edits ? edits : (char[]){""}, "\n", &rest); edit;
         edit = strtok_r(NULL, "\n", &rest))
        add_word(work, "--set", edit);
    work->failed |= !edits;
    free(edits);
    add_word(work, "--size", size);
    add_word(work, "--frames", frames);
    add_word(work, "--motion", view->moving ? setup->motion : work->motion);
    add_word(work, "--bisect", work->folder);
}

void view_bisect(struct view *view)
{
    const struct dt_log *log = &view->console->log;
    struct bisection *work = calloc(1, sizeof *work);
    view_bisect_end(view);
    if (work) {
        *work = (struct bisection){.console = view->console, .folder = free_name("-case", log)};
        if (!view->moving && view->scene.path)
            work->motion = write_camera(view);
        add_word(work, "/proc/self/exe", "compare");
        add_setup(work, view);
    }
    view->bisecting = true;
    if (work)
        work->running = &view->bisecting;
    if (!work || work->failed || !work->folder ||
        pthread_create(&view->bisector, NULL, run_bisection, work) != 0) {
        report_error(log, "the bisection cannot be started: out of memory");
        view->bisecting = false;
        if (work)
            free_bisection(work);
        return;
    }
    view->bisected = true;
    report_message(log, DT_INFO, "bisecting in a process of its own ...");
}

void view_bisect_end(struct view *view)
{
    if (view->bisected)
        pthread_join(view->bisector, NULL);
    view->bisected = false;
}

/* ---- Settings -------------------------------------------------------------------------------- */

struct setting {
    const char *name;
    float *number;
    bool *flag;
    int *whole;
    double least, most;
};

enum { SETTINGS = 10 };

static void list_settings(struct overlay_settings *s, struct setting list[SETTINGS])
{
    const struct setting all[SETTINGS] = {
        {.name = "left", .number = &s->left, .least = 50, .most = 4000},
        {.name = "right", .number = &s->right, .least = 50, .most = 4000},
        {.name = "bottom", .number = &s->bottom, .least = 30, .most = 4000},
        {.name = "font", .number = &s->font, .least = 8, .most = 48},
        {.name = "left_folded", .flag = &s->left_folded, .most = 1},
        {.name = "right_folded", .flag = &s->right_folded, .most = 1},
        {.name = "bottom_folded", .flag = &s->bottom_folded, .most = 1},
        {.name = "hidden", .flag = &s->hidden, .most = 1},
        {.name = "width", .whole = &s->window[0], .least = 16, .most = 16384},
        {.name = "height", .whole = &s->window[1], .least = 16, .most = 16384}};
    memcpy(list, all, sizeof all);
}

/* In $XDG_CONFIG_HOME or ~/.config; NULL: neither is known; free(). */
static char *settings_path(void)
{
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    if (config && *config == '/')
        return format_string("%s/diptych/view.yaml", config);
    return home && *home ? format_string("%s/.config/diptych/view.yaml", home) : NULL;
}

static void take_setting(struct setting *list, const char *name, double value)
{
    for (int i = 0; i < SETTINGS; i++) {
        const struct setting *to = &list[i];
        if (strcmp(to->name, name) != 0 || !(value >= to->least && value <= to->most))
            continue;
        if (to->number)
            *to->number = (float)value;
        if (to->flag)
            *to->flag = value != 0;
        if (to->whole)
            *to->whole = (int)value;
    }
}

void view_settings_read(struct overlay_settings *settings)
{
    struct setting list[SETTINGS];
    char line[128], name[32];
    double value;
    *settings = (struct overlay_settings){
        .left = 300, .right = 300, .bottom = 130, .font = 15, .window = {1280, 720}};
    list_settings(settings, list);
    char *path = settings_path();
    FILE *file = path ? fopen(path, "re") : NULL;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "%31[a-z_]: %lf", name, &value) == 2)
            take_setting(list, name, value);
    if (file)
        fclose(file);
    free(path);
}

void view_settings_write(const struct view *view)
{
    struct overlay_settings settings = view->settings;
    struct setting list[SETTINGS];
    struct text text = {0};
    char *path = settings_path(), *slash = path ? strrchr(path, '/') : NULL;
    list_settings(&settings, list);
    for (int i = 0; i < SETTINGS; i++)
        text_add(&text, "%s: %g\n", list[i].name,
                 list[i].number ? (double)*list[i].number
                 : list[i].flag ? (double)*list[i].flag
                                : (double)*list[i].whole);
    if (slash && !text.failed) {
        *slash = 0;
        bool good = file_make_folders(path, &view->console->log);
        *slash = '/';
        if (good)
            file_write(path, text.data, text.length, &view->console->log);
    }
    text_free(&text);
    free(path);
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
