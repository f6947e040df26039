/* Pictures of a frame: read from each side, converted to codes if necessary, and laid out in the
 * window. The display output of a single side, or of the first of two side by side, stays on the
 * device that has the window. */
#include "view/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/texels.h"
#include "scenes/image.h"

uint32_t view_last_writer(const struct dt_pipeline *info, uint32_t resource, uint32_t mip)
{
    for (uint32_t i = info->pass_count; i-- > 0;)
        for (uint32_t j = 0; j < info->passes[i].write_count; j++)
            if (info->passes[i].writes[j] == resource &&
                (resource_mips(info, i, resource) >> mip & 1))
                return i;
    return info->pass_count;
}

bool view_can_show(const struct dt_pipeline *info, uint32_t resource)
{
    return info->resources[resource].kind == DT_IMAGE &&
           view_last_writer(info, resource, 0) < info->pass_count;
}

bool view_find_home(struct view *view)
{
    const struct dt_pipeline *info = view->pipeline.info;
    int output = info->display_output >= 0 ? info->display_output : info->linear_output;
    for (uint32_t i = 0; i < info->resource_count && output < 0; i++)
        if (view_can_show(info, i))
            output = (int)i;
    if (output < 0) {
        report_error(&view->console->log, "%s has no image that could be shown", info->name);
        return false;
    }
    view->home = (uint32_t)output;
    view_show(view, view->home);
    return true;
}

uint32_t view_mips(const struct view *view)
{
    return view->pipeline.info->resources[view->resource].mips;
}

uint32_t view_layers(const struct view *view)
{
    uint32_t extent[3];
    resource_extent(view->pipeline.info, view->resource, view->size, view->mip, extent);
    return extent[2];
}

void view_show(struct view *view, uint32_t resource)
{
    view->resource = resource;
    view->layer = -1;
    view->mip = 0;
}

/* Whether the pipeline's display output is shown from device memory. */
static bool is_direct(const struct view *view)
{
    const struct dt_pipeline *info = view->pipeline.info;
    const struct dt_resource *resource = &info->resources[view->resource];
    return (int)view->resource == info->display_output && resource->format == DT_FORMAT_RGBA8 &&
           !resource->layered && view->mip == 0 && !view->shown_points &&
           (view->side_count == 1 || view->mode != VIEW_DIFFERENCE);
}

/* ---- From resources to codes ----------------------------------------------------------------- */

static void free_bytes(struct dt_bytes *bytes)
{
    free(bytes->data);
    *bytes = (struct dt_bytes){0};
}

void view_forget(struct view_side *side)
{
    free_bytes(&side->shown);
    for (int i = 0; i < VIEW_MAX_SOURCES; i++) {
        free_bytes(&side->elements[i]);
        free_bytes(&side->labels[i]);
    }
    picture_free(&side->picture);
}

static bool take_picture(const struct view *view, const struct view_side *side, uint32_t pass,
                         uint32_t resource, uint32_t mip, struct dt_bytes *bytes)
{
    const struct session *session = &side->session;
    return view_last_writer(view->pipeline.info, resource, mip) != pass || bytes->data ||
           session->runtime->read(session->handle, resource, mip, bytes);
}

bool view_take(const struct view *view, struct view_side *side, uint32_t pass)
{
    if (!take_picture(view, side, pass, view->resource, view->mip, &side->shown))
        return false;
    if (!view->shown_points)
        return true;
    const struct view_points *points = &view->points[view->shown_points - 1];
    for (uint32_t i = 0; i < points->count; i++) {
        const struct point_source *source = &points->sources[i];
        if (!take_picture(view, side, pass, source->buffer, 0, &side->elements[i]) ||
            (source->label == POINT_BUFFER &&
             !take_picture(view, side, pass, source->label_buffer, 0, &side->labels[i])))
            return false;
    }
    return true;
}

/* Only over pictures of the frame's size: others may show another view. */
static void draw_points(const struct view *view, const struct view_side *side)
{
    const struct picture *picture = &side->picture;
    if (!view->shown_points || picture->width != view->size[0] || picture->height != view->size[1])
        return;
    const struct view_points *points = &view->points[view->shown_points - 1];
    for (uint32_t i = 0; i < points->count; i++)
        if (!view_is_skipped(view, side, points->sources[i].buffer)) /* else of an earlier frame */
            points_draw(picture, &view->camera, view->pipeline.info, &points->sources[i],
                        &side->elements[i], &side->labels[i]);
}

/* The bytes of one layer, or of all, in `shown`. */
static struct dt_bytes chosen_layer(const struct view *view, const struct dt_bytes *shown)
{
    struct dt_bytes part = *shown;
    if (view->layer < 0 || (uint32_t)view->layer >= shown->extent[2])
        return part;
    part.size = shown->size / shown->extent[2];
    part.data += part.size * (size_t)view->layer;
    part.extent[2] = 1;
    return part;
}

/* Makes the side's picture from the bytes read in the frame, or reads an output now, which stays
 * valid. */
static bool make_picture(struct view *view, struct view_side *side)
{
    const struct session *session = &side->session;
    if (!side->shown.data &&
        !session->runtime->read(session->handle, view->resource, view->mip, &side->shown))
        return false;
    struct dt_bytes part = chosen_layer(view, &side->shown);
    picture_free(&side->picture);
    if (!picture_codes(&side->picture, &view->pipeline.info->resources[view->resource], &part,
                       &session->log))
        return false;
    draw_points(view, side);
    return true;
}

/* The first picture becomes the difference of both. */
static void make_difference(struct view *view)
{
    struct picture *a = &view->side[0].picture, *b = &view->side[1].picture;
    for (size_t i = 0; i < (size_t)a->width * a->height * 3; i++) {
        float apart = (float)abs(a->codes[i] - b->codes[i]) * view->gain;
        a->codes[i] = apart < 255 ? (uint8_t)apart : 255;
    }
}

static bool make_pictures(struct view *view)
{
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!make_picture(view, &view->side[i]))
            return false;
    if (view->side_count > 1 && view->mode == VIEW_DIFFERENCE)
        make_difference(view);
    return true;
}

/* ---- Textures -------------------------------------------------------------------------------- */

static bool upload(const struct view *view, uint32_t index)
{
    const struct session *window = &view->side[0].session;
    const struct picture *picture = &view->side[index].picture;
    size_t count = (size_t)picture->width * picture->height;
    uint8_t *pixels = malloc(count * 4 + 1);
    if (!pixels) {
        report_error(&window->log, "window: out of memory for a picture");
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        memcpy(pixels + 4 * i, picture->codes + 3 * i, 3);
        pixels[4 * i + 3] = 255;
    }
    bool good = window->runtime->window_upload(window->handle, 1 + index, picture->width,
                                               picture->height, pixels);
    free(pixels);
    return good;
}

bool view_pictures(struct view *view)
{
    const struct session *window = &view->side[0].session;
    uint32_t first = is_direct(view) ? 1 : 0;
    view->direct = first > 0;
    if (view->direct) {
        view_forget(&view->side[0]);
        if (!window->runtime->window_copy(window->handle, 1, view->resource))
            return false;
    }
    for (uint32_t i = first; i < view->side_count; i++)
        if (!make_picture(view, &view->side[i]))
            return false;
    if (view->side_count > 1 && view->mode == VIEW_DIFFERENCE)
        make_difference(view);
    for (uint32_t i = first; i < view->side_count; i++)
        if (!upload(view, i))
            return false;
    return true;
}

/* ---- Layout ---------------------------------------------------------------------------------- */

static bool has_panels(const struct view *view)
{
    return view->side_count > 1 && view->mode == VIEW_PANELS;
}

void view_panel_size(const struct view *view, uint32_t size[2])
{
    size[0] = has_panels(view) ? view->window_size[0] / 2 : view->window_size[0];
    size[1] = view->window_size[1];
    size[0] = size[0] ? size[0] : 1;
    size[1] = size[1] ? size[1] : 1;
}

/* As large as fits, with a black border. In a texture copied on the device the bottom row comes
 * first. */
static void fit(const struct view *view, uint32_t index, float left, float quad[4])
{
    const struct picture *picture = &view->side[index].picture;
    bool direct = view->direct && index == 0;
    uint32_t panel[2];
    view_panel_size(view, panel);
    float width = (float)(direct ? view->size[0] : picture->width);
    float height = (float)(direct ? view->size[1] : picture->height);
    float factor = fminf((float)panel[0] / width, (float)panel[1] / height);
    quad[0] = left + floorf(((float)panel[0] - width * factor) / 2);
    quad[1] = floorf(((float)panel[1] - height * factor) / 2);
    quad[2] = quad[0] + width * factor;
    quad[3] = quad[1] + height * factor;
}

/* From `from` to `to`, parts of the picture's width. */
static void add_quad(const struct view *view, uint32_t index, const float quad[4], float from,
                     float to, struct dt_window_vertex *vertices, struct dt_window_draw *draw,
                     uint32_t first)
{
    static const uint8_t corners[6] = {0, 1, 2, 2, 1, 3};
    bool flipped = view->direct && index == 0;
    float x[2] = {quad[0] + (quad[2] - quad[0]) * from, quad[0] + (quad[2] - quad[0]) * to};
    float y[2] = {quad[1], quad[3]}, u[2] = {from, to};
    float v[2] = {flipped ? 1 : 0, flipped ? 0 : 1};
    for (int i = 0; i < 6; i++) {
        int right = corners[i] & 1, low = corners[i] >> 1;
        vertices[i] =
            (struct dt_window_vertex){{x[right], y[low]}, {u[right], v[low]}, {255, 255, 255, 255}};
    }
    *draw = (struct dt_window_draw){
        .texture = 1 + index,
        .first = first,
        .count = 6,
        .clip = {0, 0, (int32_t)view->window_size[0], (int32_t)view->window_size[1]}};
}

uint32_t view_layout(const struct view *view, struct dt_window_vertex vertices[6 * VIEW_MAX_DRAWS],
                     struct dt_window_draw draws[VIEW_MAX_DRAWS])
{
    float quad[4];
    bool curtain = view->side_count > 1 && view->mode == VIEW_CURTAIN;
    uint32_t count = has_panels(view) || curtain ? 2 : 1;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t panel[2];
        view_panel_size(view, panel);
        fit(view, i, has_panels(view) ? (float)(i * panel[0]) : 0, quad);
        add_quad(view, i, quad, curtain && i == 1 ? 0.5f : 0, curtain && i == 0 ? 0.5f : 1,
                 vertices + 6 * (size_t)i, &draws[i], 6 * i);
    }
    return count;
}

/* ---- Screenshots ----------------------------------------------------------------------------- */

/* Columns `from` to `to` of a picture into one that is `width` wide. */
static void paste(uint8_t *out, uint32_t width, uint32_t left, const struct picture *picture,
                  uint32_t from, uint32_t to)
{
    for (uint32_t y = 0; y < picture->height; y++)
        memcpy(out + ((size_t)y * width + left) * 3,
               picture->codes + ((size_t)y * picture->width + from) * 3, (size_t)(to - from) * 3);
}

bool view_write_png(struct view *view, const char *path)
{
    const struct dt_log *log = &view->console->log;
    if (!make_pictures(view))
        return false;
    const struct picture *a = &view->side[0].picture, *b = &view->side[1].picture;
    bool panels = has_panels(view), curtain = view->side_count > 1 && view->mode == VIEW_CURTAIN;
    uint32_t width = panels ? a->width + b->width : a->width;
    uint8_t *out = calloc((size_t)width * a->height + 1, 3);
    if (!out) {
        report_error(log, "%s: out of memory for a picture", path);
        return false;
    }
    paste(out, width, 0, a, 0, curtain ? a->width / 2 : a->width);
    if (panels)
        paste(out, width, a->width, b, 0, b->width);
    if (curtain)
        paste(out, width, a->width / 2, b, b->width / 2, b->width);
    console_hold(view->console);
    bool good = image_write_png(path, width, a->height, 3, out, log);
    console_release(view->console);
    free(out);
    return good;
}
