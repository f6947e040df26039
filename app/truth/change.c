/* Change from frame to frame; see change.h. */
#include "truth/change.h"

#include <math.h>
#include <stdlib.h>

static const double least_cosine = 0.9;     /* of two normals of one surface */
static const double most_off_plane = 0.005; /* relative to the depth */
static const double least_weight = 1e-3;    /* of a neighbour that counts; above rounding errors */

static double dot3(const float a[3], const float b[3])
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* Position in the picture, in pixels from the centre of the first one; false behind the camera. */
static bool project(const struct seen *seen, const float x[3], double place[2])
{
    double clip[4];
    for (int row = 0; row < 4; row++) {
        clip[row] = (double)seen->view_projection[3][row];
        for (int k = 0; k < 3; k++)
            clip[row] += (double)seen->view_projection[k][row] * (double)x[k];
    }
    if (!(clip[3] > 0))
        return false;
    place[0] = (0.5 + 0.5 * clip[0] / clip[3]) * seen->width - 0.5;
    place[1] = (0.5 - 0.5 * clip[1] / clip[3]) * seen->height - 0.5;
    return fabs(place[0]) < 1e9 && fabs(place[1]) < 1e9;
}

static bool is_same_surface(const struct seen_point *a, const struct seen_point *b)
{
    float apart[3];
    for (int i = 0; i < 3; i++)
        apart[i] = b->position[i] - a->position[i];
    return b->depth > 0 && dot3(a->normal, b->normal) > least_cosine &&
           fabs(dot3(a->plane, apart)) < most_off_plane * (double)a->depth;
}

/* Pixels of a frame and their weights, which interpolate the value at a point; the weights sum to
 * 1. 0 taps: the point was not visible. */
struct taps {
    uint32_t count;
    size_t pixel[4];
    float weight[4];
};

static struct taps reproject(const struct seen *before, const struct seen_point *point)
{
    struct taps taps = {0};
    double place[2], sum = 0;
    if (!(point->depth > 0) || !project(before, point->position, place))
        return taps;
    double left = floor(place[0]), top = floor(place[1]);
    for (int i = 0; i < 4; i++) {
        double x = left + (i & 1), y = top + (i >> 1);
        double weight = (1 - fabs(place[0] - x)) * (1 - fabs(place[1] - y));
        if (weight < least_weight)
            continue;
        size_t pixel = (size_t)(fmax(y, 0) * before->width + fmax(x, 0));
        if (x < 0 || y < 0 || x >= before->width || y >= before->height ||
            !is_same_surface(point, &before->points[pixel]))
            return (struct taps){0};
        taps.pixel[taps.count] = pixel;
        taps.weight[taps.count++] = (float)weight;
        sum += weight;
    }
    for (uint32_t i = 0; i < taps.count; i++)
        taps.weight[i] = (float)((double)taps.weight[i] / sum);
    return taps;
}

/* Values of a pixel in both frames. */
static bool values_of(const struct rgb_image images[2], const struct taps *taps, size_t pixel,
                      double before[3], double now[3])
{
    bool finite = true;
    for (int channel = 0; channel < 3; channel++) {
        now[channel] = (double)images[1].texels[3 * pixel + (size_t)channel];
        before[channel] = 0;
        for (uint32_t i = 0; i < taps->count; i++)
            before[channel] += (double)taps->weight[i] *
                               (double)images[0].texels[3 * taps->pixel[i] + (size_t)channel];
        finite = finite && isfinite(now[channel]) && isfinite(before[channel]);
    }
    return finite;
}

/* Sums over the compared pixels of a block. */
struct block {
    double pixels, test[3], reference[3];
};

static void add_changed_pixel(struct change *change, struct block *block, const struct taps *taps,
                              size_t pixel, const struct rgb_image test[2],
                              const struct rgb_image reference[2])
{
    double before[2][3] = {{0}}, now[2][3] = {{0}};
    if (!taps->count || !values_of(test, taps, pixel, before[0], now[0]) ||
        (reference && !values_of(reference, taps, pixel, before[1], now[1])))
        return;
    change->compared++;
    block->pixels++;
    for (int channel = 0; channel < 3; channel++) {
        change->mean += now[0][channel];
        change->mean_reference += now[1][channel];
        block->test[channel] += now[0][channel] - before[0][channel];
        block->reference[channel] += now[1][channel] - before[1][channel];
    }
}

bool change_measure(struct change *change, const struct seen seen[2],
                    const struct rgb_image test[2], const struct rgb_image reference[2],
                    uint32_t block)
{
    const struct seen *now = &seen[1];
    size_t columns = (now->width + block - 1) / block, rows = (now->height + block - 1) / block;
    struct block *blocks = calloc(columns * rows + 1, sizeof *blocks);
    *change = (struct change){0};
    if (!blocks)
        return false;
    for (uint32_t y = 0; y < now->height; y++)
        for (uint32_t x = 0; x < now->width; x++) {
            size_t pixel = (size_t)y * now->width + x;
            const struct taps taps = reproject(&seen[0], &now->points[pixel]);
            change->surfaces += now->points[pixel].depth > 0;
            add_changed_pixel(change, &blocks[y / block * columns + x / block], &taps, pixel, test,
                              reference);
        }
    for (size_t i = 0; i < columns * rows; i++)
        for (int channel = 0; channel < 3; channel++) { /* mean times weight is the sum */
            change->change += fabs(blocks[i].test[channel]);
            change->change_reference += fabs(blocks[i].reference[channel]);
            change->flicker += fabs(blocks[i].test[channel] - blocks[i].reference[channel]);
        }
    free(blocks);
    double numbers = change->compared ? 3.0 * (double)change->compared : 1;
    change->mean /= numbers;
    change->mean_reference /= numbers;
    change->change /= numbers;
    change->change_reference /= numbers;
    change->flicker = reference ? change->flicker / numbers : 0;
    return true;
}

struct change change_mean(const struct change *list, uint32_t count)
{
    struct change all = {0};
    for (uint32_t i = 0; i < count; i++) {
        double pixels = (double)list[i].compared;
        all.surfaces += list[i].surfaces;
        all.compared += list[i].compared;
        all.mean += list[i].mean * pixels;
        all.mean_reference += list[i].mean_reference * pixels;
        all.change += list[i].change * pixels;
        all.change_reference += list[i].change_reference * pixels;
        all.flicker += list[i].flicker * pixels;
    }
    double pixels = all.compared ? (double)all.compared : 1;
    all.mean /= pixels;
    all.mean_reference /= pixels;
    all.change /= pixels;
    all.change_reference /= pixels;
    all.flicker /= pixels;
    return all;
}
