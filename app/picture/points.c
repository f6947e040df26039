/* Draws points; see points.h. */
#include "picture/points.h"

#include <math.h>
#include <string.h>

#include "picture/texels.h"

struct dots {
    const struct picture *picture;
    const struct dt_view *camera;
    const struct dt_pipeline *info;
    const struct point_source *source;
    float brightest;
};

static void fetch(const uint8_t *element, uint32_t offset, float out[3])
{
    memcpy(out, element + offset, 3 * sizeof *out);
}

/* Pixel of a point, from the top left corner; false: outside. */
static bool project(const struct dots *dots, const float position[3], float place[2])
{
    const float(*m)[4] = dots->camera->view_projection;
    float clip[4];
    for (int i = 0; i < 4; i++)
        clip[i] = m[0][i] * position[0] + m[1][i] * position[1] + m[2][i] * position[2] + m[3][i];
    if (!(clip[3] > 0) || !isfinite(clip[3]))
        return false;
    place[0] = (clip[0] / clip[3] * 0.5f + 0.5f) * (float)dots->picture->width;
    place[1] = (0.5f - clip[1] / clip[3] * 0.5f) * (float)dots->picture->height;
    float margin = 100;
    return place[0] > -margin && place[0] < (float)dots->picture->width + margin &&
           place[1] > -margin && place[1] < (float)dots->picture->height + margin;
}

/* A disc with a dark rim, so that it stands out from what is behind it. */
static void draw_disc(const struct picture *picture, const float place[2], float radius,
                      const uint8_t color[3])
{
    float outer = radius + 1;
    int left = (int)floorf(place[0] - outer), right = (int)ceilf(place[0] + outer);
    int top = (int)floorf(place[1] - outer), bottom = (int)ceilf(place[1] + outer);
    for (int y = top < 0 ? 0 : top; y <= bottom && y < (int)picture->height; y++) {
        for (int x = left < 0 ? 0 : left; x <= right && x < (int)picture->width; x++) {
            float distance = hypotf((float)x + 0.5f - place[0], (float)y + 0.5f - place[1]);
            float cover = fminf(fmaxf(outer - distance + 0.5f, 0), 1);
            float fill = fminf(fmaxf(radius - distance + 0.5f, 0), 1);
            uint8_t *codes = picture->codes + ((size_t)y * picture->width + (size_t)x) * 3;
            for (int c = 0; c < 3; c++)
                codes[c] = (uint8_t)((float)codes[c] * (1 - cover) +
                                     cover * fill * (float)color[c] + 0.5f);
        }
    }
}

static bool is_negative(const struct dt_resource *resource, const uint8_t *element, int offset)
{
    for (uint32_t i = 0; i < resource->field_count; i++) {
        if ((int)resource->fields[i].offset != offset)
            continue;
        float number;
        int32_t whole;
        memcpy(&number, element + offset, sizeof number);
        memcpy(&whole, element + offset, sizeof whole);
        return type_info(resource->fields[i].type)->scalar == DT_TYPE_FLOAT ? number < 0
                                                                            : whole < 0;
    }
    return false;
}

/* False: the element is hidden. */
static bool color_of(const struct dots *dots, const uint8_t *element, uint32_t index,
                     const struct dt_bytes *labels, uint8_t color[3])
{
    const struct point_source *source = dots->source;
    int32_t label = (int32_t)index;
    float flux[3];
    memset(color, 255, 3);
    if (source->label == POINT_BUFFER) {
        if (!labels->data || (index + 1) * sizeof label > labels->size)
            return false;
        memcpy(&label, labels->data + index * sizeof label, sizeof label);
    }
    if (source->label != POINT_UNLABELLED) {
        if (label >= 0)
            picture_label(label, color);
        return label >= 0;
    }
    if (source->color < 0)
        return true;
    fetch(element, (uint32_t)source->color, flux);
    for (int c = 0; c < 3; c++) {
        float share = dots->brightest > 0 ? fmaxf(flux[c], 0) / dots->brightest : 0;
        color[c] = (uint8_t)(255 * powf(fminf(share, 1), 1 / 2.2f));
    }
    return flux[0] > 0 || flux[1] > 0 || flux[2] > 0;
}

static float find_brightest(const struct point_source *source, const struct dt_bytes *elements,
                            uint32_t stride)
{
    float most = 0, color[3];
    for (uint32_t i = 0; source->color >= 0 && i < elements->extent[0]; i++) {
        fetch(elements->data + (size_t)i * stride, (uint32_t)source->color, color);
        for (int c = 0; c < 3; c++)
            most = isfinite(color[c]) ? fmaxf(most, color[c]) : most;
    }
    return most;
}

void points_draw(const struct picture *picture, const struct dt_view *camera,
                 const struct dt_pipeline *info, const struct point_source *source,
                 const struct dt_bytes *elements, const struct dt_bytes *labels)
{
    const struct dt_resource *resource = &info->resources[source->buffer];
    struct dots dots = {picture, camera, info, source, 0};
    float scale = fmaxf(0.5f, (float)picture->height / 540);
    dots.brightest = find_brightest(source, elements, resource->stride);
    for (uint32_t i = 0; elements->data && i < elements->extent[0]; i++) {
        const uint8_t *element = elements->data + (size_t)i * resource->stride;
        float position[3], place[2];
        uint8_t color[3];
        fetch(element, source->position, position);
        if ((source->where < 0 || !is_negative(resource, element, source->where)) &&
            color_of(&dots, element, i, labels, color) && project(&dots, position, place))
            draw_disc(picture, place, source->radius * scale, color);
    }
}
