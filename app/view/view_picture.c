/* Pictures of a frame: read from each side, converted to codes if necessary, and uploaded to the
 * window. */
#include "view/view.h"

#include <stdlib.h>
#include <string.h>

#include "picture/texels.h"
#include "scenes/image.h"

uint32_t view_last_writer(const struct dt_pipeline *info, uint32_t resource, uint32_t mip)
{
    for (uint32_t i = info->pass_count; i-- > 0;)
        for (uint32_t j = 0; j < info->passes[i].write_count; j++)
            if (info->passes[i].writes[j] == resource &&
                (pass_mips(&info->passes[i], j) >> mip & 1))
                return i;
    return info->pass_count;
}

bool view_can_show(const struct dt_pipeline *info, uint32_t resource)
{
    return info->resources[resource].input ||
           view_last_writer(info, resource, 0) < info->pass_count;
}

bool view_find_home(struct view *view)
{
    const struct dt_pipeline *info = view->pipeline.info;
    int output = info->display_output >= 0 ? info->display_output : info->linear_output;
    for (uint32_t i = 0; i < info->resource_count && output < 0; i++)
        if (info->resources[i].kind == DT_IMAGE && view_can_show(info, i))
            output = (int)i;
    if (output < 0)
        return report_error(&view->console->log, "%s has no image that could be shown", info->name);
    view->home = (uint32_t)output;
    view_show(view, view->home);
    return true;
}

uint32_t view_mips(const struct view *view)
{
    return view->pipeline.info->resources[view->shown.resource].mips;
}

uint32_t view_layers(const struct view *view)
{
    uint32_t extent[3];
    resource_extent(view->pipeline.info, view->shown.resource, view->size, view->shown.mip, extent);
    return view->pipeline.info->resources[view->shown.resource].kind == DT_IMAGE ? extent[2] : 1;
}

void view_show(struct view *view, uint32_t resource)
{
    const struct dt_pipeline *info = view->pipeline.info;
    struct overlay_shown *shown = &view->shown;
    uint32_t pass = view_last_writer(info, resource, 0);
    if (resource != shown->resource)
        shown->look = (struct picture_look){0};
    shown->pass = pass < info->pass_count ? pass : info->pass_count - 1;
    shown->resource = resource;
    shown->layer = -1;
    shown->mip = 0;
    shown->marked = false;
}

static bool is_image(const struct view *view)
{
    return view->pipeline.info->resources[view->shown.resource].kind == DT_IMAGE;
}

static bool is_difference(const struct view *view)
{
    return view->side_count > 1 && view->shown.mode == OVERLAY_DIFFERENCE;
}

/* Whether the pipeline's display output is shown as it is. */
static bool is_direct(const struct view *view)
{
    const struct dt_pipeline *info = view->pipeline.info;
    const struct dt_resource *resource = &info->resources[view->shown.resource];
    const struct picture_look *look = &view->shown.look;
    return (int)view->shown.resource == info->display_output &&
           view->shown.pass == view_last_writer(info, view->shown.resource, 0) &&
           resource->format == DT_FORMAT_RGBA8 && !resource->layered && view->shown.mip == 0 &&
           !look->channel && look->exposure == 0 && !look->ranged && !look->tinted &&
           !is_difference(view);
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
    picture_free(&side->picture);
}

struct dt_bytes view_layer(const struct view *view, const struct view_side *side)
{
    struct dt_bytes part = side->shown;
    if (!is_image(view) || view->shown.layer < 0 || (uint32_t)view->shown.layer >= part.extent[2])
        return part;
    part.size /= part.extent[2];
    part.data += part.size * (size_t)view->shown.layer;
    part.extent[2] = 1;
    return part;
}

bool view_read(const struct view *view, struct view_side *side)
{
    const struct session *session = &side->session;
    return side->shown.data || session->runtime->read(session->handle, view->shown.resource,
                                                      view->shown.mip, &side->shown);
}

/* Makes the side's picture from the bytes read in the frame, or reads an output now, which stays
 * valid. */
static bool make_picture(struct view *view, struct view_side *side)
{
    if (!view_read(view, side))
        return false;
    if (!is_image(view))
        return true;
    struct dt_bytes part = view_layer(view, side);
    picture_free(&side->picture);
    if (!picture_look(&side->picture, &view->pipeline.info->resources[view->shown.resource], &part,
                      &view->shown.look, &side->session.log))
        return false;
    return true;
}

/* The pictures but the first become differences from it. */
static void make_differences(struct view *view)
{
    const struct picture *a = &view->side[0].picture;
    for (uint32_t k = 1; k < view->side_count; k++) {
        struct picture *b = &view->side[k].picture;
        for (size_t i = 0; i < (size_t)a->width * a->height * 3; i++) {
            float apart = (float)abs(a->codes[i] - b->codes[i]) * view->shown.gain;
            b->codes[i] = apart < 255 ? (uint8_t)apart : 255;
        }
    }
}

static bool make_pictures(struct view *view)
{
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!make_picture(view, &view->side[i]))
            return false;
    if (is_difference(view) && is_image(view))
        make_differences(view);
    return true;
}

/* ---- Textures -------------------------------------------------------------------------------- */

static bool upload(const struct view *view, uint32_t index)
{
    const struct picture *picture = &view->side[index].picture;
    size_t count = (size_t)picture->width * picture->height;
    uint8_t *pixels = malloc(count * 4 + 1);
    if (!pixels)
        return report_error(&view->console->log, "window: out of memory for a picture");
    for (size_t i = 0; i < count; i++) {
        memcpy(pixels + 4 * i, picture->codes + 3 * i, 3);
        pixels[4 * i + 3] = 255;
    }
    bool good = gl_window_upload(view->screen, index, picture->width, picture->height, pixels);
    free(pixels);
    return good;
}

static bool upload_directly(const struct view *view, uint32_t index)
{
    const struct dt_bytes *shown = &view->side[index].shown;
    return gl_window_upload(view->screen, index, shown->extent[0], shown->extent[1], shown->data);
}

bool view_pictures(struct view *view)
{
    view->direct = is_direct(view);
    for (uint32_t i = 0; i < view->side_count; i++)
        if (view->direct ? !view_read(view, &view->side[i]) : !make_picture(view, &view->side[i]))
            return false;
    if (!is_image(view))
        return true;
    if (is_difference(view))
        make_differences(view);
    for (uint32_t i = 0; i < view->side_count; i++)
        if (view->direct ? !upload_directly(view, i) : !upload(view, i))
            return false;
    return true;
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
    uint32_t first = is_difference(view) ? 1 : 0, count = view->side_count;
    bool curtain = count > 1 && view->shown.mode == OVERLAY_CURTAIN;
    const struct picture *picture = &view->side[0].picture;
    uint32_t width = picture->width * (curtain ? 1 : count - first), left = 0;
    uint8_t *out = calloc((size_t)width * picture->height + 1, 3);
    if (!out)
        return report_error(log, "%s: out of memory for a picture", path);
    for (uint32_t i = first; i < count; i++) {
        uint32_t from = curtain ? picture->width * i / count : 0;
        uint32_t to = curtain ? picture->width * (i + 1) / count : picture->width;
        paste(out, width, left, &view->side[i].picture, from, to);
        left += to - from;
    }
    console_hold(view->console);
    bool good = image_write_png(path, width, picture->height, 3, out, log);
    console_release(view->console);
    free(out);
    return good;
}
