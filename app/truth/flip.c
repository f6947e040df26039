/* The two FLIP metrics; see flip.h. All filters are sums of Gaussians or their derivatives, so they
 * run along rows, then along columns; beyond its border an image repeats its last pixel. */
#include "truth/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/spread.h"

enum { MAX_RADIUS = 1024 }; /* more than any filter has at FLIP_MOST_PIXELS_PER_DEGREE */

/* ---- Colour ---------------------------------------------------------------------------------- */

/* Linear Rec. 709 to CIE XYZ, exact for primaries and white point D65 as given by sRGB. */
static const double rgb_to_xyz[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382},
};

struct color {
    double v[3];
};

/* XYZ relative to the white point, which is what (1, 1, 1) maps to. */
static struct color relative_xyz(struct color rgb)
{
    struct color xyz;
    for (int i = 0; i < 3; i++) {
        const double *row = rgb_to_xyz[i];
        xyz.v[i] = (row[0] * rgb.v[0] + row[1] * rgb.v[1] + row[2] * rgb.v[2]) /
                   (row[0] + row[1] + row[2]);
    }
    return xyz;
}

/* Cramer's rule on rgb_to_xyz. */
static struct color rgb_of(struct color xyz)
{
    const double(*m)[3] = rgb_to_xyz;
    struct color rgb;
    double determinant = 0;
    for (int i = 0; i < 3; i++)
        xyz.v[i] *= m[i][0] + m[i][1] + m[i][2];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        determinant += m[0][i] * (m[1][j] * m[2][k] - m[1][k] * m[2][j]);
        rgb.v[i] = xyz.v[0] * (m[1][j] * m[2][k] - m[1][k] * m[2][j]) +
                   xyz.v[1] * (m[2][j] * m[0][k] - m[2][k] * m[0][j]) +
                   xyz.v[2] * (m[0][j] * m[1][k] - m[0][k] * m[1][j]);
    }
    for (int i = 0; i < 3; i++)
        rgb.v[i] /= determinant;
    return rgb;
}

/* The opponent space of the filters: luminance, red-green, blue-yellow, all linear. */
static struct color ycxcz_of(struct color rgb)
{
    struct color xyz = relative_xyz(rgb);
    return (struct color){
        {116 * xyz.v[1] - 16, 500 * (xyz.v[0] - xyz.v[1]), 200 * (xyz.v[1] - xyz.v[2])}};
}

static struct color rgb_of_ycxcz(struct color color)
{
    double y = (color.v[0] + 16) / 116;
    return rgb_of((struct color){{y + color.v[1] / 500, y, y - color.v[2] / 200}});
}

static double lab_curve(double value)
{
    const double delta = 6.0 / 29;
    return value > delta * delta * delta ? cbrt(value) : value / (3 * delta * delta) + 4.0 / 29;
}

/* L*a*b* with the chroma scaled by lightness: dark colours look less colourful (Hunt). */
static struct color hunt_lab_of(struct color rgb)
{
    struct color xyz = relative_xyz(rgb);
    double x = lab_curve(xyz.v[0]), y = lab_curve(xyz.v[1]), z = lab_curve(xyz.v[2]);
    double lightness = 116 * y - 16;
    return (struct color){
        {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)}};
}

static double hyab(struct color a, struct color b)
{
    return fabs(a.v[0] - b.v[0]) + hypot(a.v[1] - b.v[1], a.v[2] - b.v[2]);
}

static double clamp01(double value)
{
    return value > 0 ? value < 1 ? value : 1 : 0; /* NaN counts as 0 */
}

/* ---- Filters --------------------------------------------------------------------------------- */

struct kernel {
    int radius;
    float weights[2 * MAX_RADIUS + 1];
};

/* One channel of an image. */
struct plane {
    int width, height;
    float *values;
};

static void filter_rows(const struct plane *in, const struct kernel *kernel, struct plane *out)
{
    for (int y = 0; y < in->height; y++) {
        const float *row = in->values + (size_t)y * (size_t)in->width;
        for (int x = 0; x < in->width; x++) {
            float sum = 0;
            for (int i = -kernel->radius; i <= kernel->radius; i++) {
                int at = x + i < 0 ? 0 : x + i >= in->width ? in->width - 1 : x + i;
                sum += kernel->weights[kernel->radius + i] * row[at];
            }
            out->values[(size_t)y * (size_t)in->width + (size_t)x] = sum;
        }
    }
}

/* Row after row, which the cache likes better than column after column. */
static void filter_columns(const struct plane *in, const struct kernel *kernel, struct plane *out)
{
    size_t width = (size_t)in->width;
    for (int y = 0; y < in->height; y++) {
        float *to = out->values + (size_t)y * width;
        memset(to, 0, width * sizeof *to);
        for (int i = -kernel->radius; i <= kernel->radius; i++) {
            int at = y + i < 0 ? 0 : y + i >= in->height ? in->height - 1 : y + i;
            const float *from = in->values + (size_t)at * width;
            float weight = kernel->weights[kernel->radius + i];
            for (size_t x = 0; x < width; x++)
                to[x] += weight * from[x];
        }
    }
}

static double gauss(double x, double variance)
{
    return exp(-x * x / (2 * variance));
}

/* Gaussian that sums to 1. */
static void gauss_kernel(struct kernel *kernel, int radius, double variance)
{
    double sum = 0;
    *kernel = (struct kernel){.radius = radius};
    for (int i = -radius; i <= radius; i++)
        sum += gauss(i, variance);
    for (int i = -radius; i <= radius; i++)
        kernel->weights[radius + i] = (float)(gauss(i, variance) / sum);
}

static double derivative(double x, double variance, int order)
{
    return (order == 1 ? -x : x * x / variance - 1) * gauss(x, variance);
}

/* First or second derivative of a Gaussian; positive weights sum to 1, negative ones to -1. */
static void derivative_kernel(struct kernel *kernel, int radius, double variance, int order)
{
    double positive = 0, negative = 0;
    *kernel = (struct kernel){.radius = radius};
    for (int i = -radius; i <= radius; i++) {
        double weight = derivative(i, variance, order);
        positive += weight > 0 ? weight : 0;
        negative -= weight < 0 ? weight : 0;
    }
    for (int i = -radius; i <= radius; i++) {
        double weight = derivative(i, variance, order);
        kernel->weights[radius + i] = (float)(weight / (weight < 0 ? negative : positive));
    }
}

/* Contrast sensitivity in the frequency domain is a sum of exponentials with these parameters; in
 * the spatial domain, Gaussians of variance b / (2 pi^2) degrees squared. */
struct sensitivity {
    double a[2], b[2];
};
static const struct sensitivity sensitivities[3] = {
    {{1, 0}, {0.0047, 0.0047}},    /* luminance */
    {{1, 0}, {0.0053, 0.0053}},    /* red-green */
    {{34.1, 13.5}, {0.04, 0.025}}, /* blue-yellow */
};
static const double widest_sensitivity = 0.04;

struct scratch {
    struct plane rows, sum;
    struct kernel kernel;
};

static double sensitivity_variance(double b, double pixels_per_degree)
{
    return b / (2 * M_PI * M_PI) * pixels_per_degree * pixels_per_degree;
}

/* Filters a plane in place by the sum of the channel's Gaussians. The weights of the sum are those
 * of the two-dimensional, truncated Gaussians, since the whole filter sums to 1. */
static void filter_sensitivity(struct plane *plane, const struct sensitivity *s,
                               double pixels_per_degree, struct scratch *scratch)
{
    size_t count = (size_t)plane->width * (size_t)plane->height;
    int radius = (int)ceil(3 * sqrt(sensitivity_variance(widest_sensitivity, pixels_per_degree)));
    double weights[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        double line = 0;
        for (int x = -radius; x <= radius; x++)
            line += gauss(x, sensitivity_variance(s->b[i], pixels_per_degree));
        weights[i] = s->a[i] * sqrt(M_PI / s->b[i]) * line * line;
    }
    struct plane out = scratch->sum;
    for (int i = 0; i < 2 && s->a[i] > 0; i++) {
        float weight = (float)(weights[i] / (weights[0] + weights[1]));
        gauss_kernel(&scratch->kernel, radius, sensitivity_variance(s->b[i], pixels_per_degree));
        filter_rows(plane, &scratch->kernel, &scratch->rows);
        struct plane column = {plane->width, plane->height, out.values + (size_t)i * count};
        filter_columns(&scratch->rows, &scratch->kernel, &column);
        for (size_t at = 0; at < count; at++)
            column.values[at] *= weight;
    }
    memcpy(plane->values, out.values, count * sizeof *out.values);
    for (size_t at = 0; at < count && s->a[1] > 0; at++)
        plane->values[at] += out.values[count + at];
}

/* ---- The two halves of the metric ------------------------------------------------------------ */

/* Everything that one evaluation needs. Planes 0 to 2 of each image are Y, Cx, Cz. */
struct evaluation {
    int width, height;
    size_t count;
    double pixels_per_degree;
    float *memory;
    struct plane planes[2][3];
    struct plane features[2][2]; /* strength of edges and of points */
    struct scratch scratch;
};

static bool evaluation_begin(struct evaluation *evaluation, const struct rgb_image *image,
                             double pixels_per_degree)
{
    enum { PLANES = 2 * 3 + 2 * 2 + 3 };
    size_t count = (size_t)image->width * image->height;
    evaluation->width = (int)image->width;
    evaluation->height = (int)image->height;
    evaluation->count = count;
    evaluation->pixels_per_degree = pixels_per_degree;
    evaluation->memory = malloc((count ? count : 1) * PLANES * sizeof *evaluation->memory);
    if (!evaluation->memory)
        return false;
    struct plane *const places[] = {
        &evaluation->planes[0][0],   &evaluation->planes[0][1],   &evaluation->planes[0][2],
        &evaluation->planes[1][0],   &evaluation->planes[1][1],   &evaluation->planes[1][2],
        &evaluation->features[0][0], &evaluation->features[0][1], &evaluation->features[1][0],
        &evaluation->features[1][1], &evaluation->scratch.rows,   &evaluation->scratch.sum,
    };
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) /* the last takes two */
        *places[i] =
            (struct plane){evaluation->width, evaluation->height, evaluation->memory + i * count};
    return true;
}

static void flip_load(struct evaluation *evaluation, int which, const struct rgb_image *image)
{
    for (size_t i = 0; i < evaluation->count; i++) {
        const float *texel = image->texels + 3 * i;
        struct color rgb = {{clamp01(texel[0]), clamp01(texel[1]), clamp01(texel[2])}};
        struct color color = ycxcz_of(rgb);
        for (int channel = 0; channel < 3; channel++)
            evaluation->planes[which][channel].values[i] = (float)color.v[channel];
    }
}

/* Edges (first derivative) or points (second) of the luminance: length of the response along both
 * axes. The detector's width is 0.082 degrees from peak to trough. */
static void detect(struct evaluation *evaluation, int which, int order)
{
    struct scratch *scratch = &evaluation->scratch;
    double deviation = 0.5 * 0.082 * evaluation->pixels_per_degree;
    double variance = deviation * deviation;
    int radius = (int)ceil(3 * deviation);
    const struct plane *in = &evaluation->planes[which][0];
    struct plane *out = &evaluation->features[which][order - 1];
    struct kernel smooth;
    gauss_kernel(&smooth, radius, variance);
    derivative_kernel(&scratch->kernel, radius, variance, order);
    filter_rows(in, &scratch->kernel, &scratch->rows);
    filter_columns(&scratch->rows, &smooth, out);
    filter_rows(in, &smooth, &scratch->rows);
    filter_columns(&scratch->rows, &scratch->kernel, &scratch->sum);
    for (size_t i = 0; i < evaluation->count; i++) /* of (Y + 16) / 116, which is linear in light */
        out->values[i] = hypotf(out->values[i], scratch->sum.values[i]) / 116;
}

static double feature_error(const struct evaluation *evaluation, size_t i)
{
    double most = 0;
    for (int kind = 0; kind < 2; kind++)
        most = fmax(most, fabs((double)evaluation->features[0][kind].values[i] -
                               (double)evaluation->features[1][kind].values[i]));
    return sqrt(M_SQRT1_2 * most); /* exponent q_f = 0.5 */
}

static struct color filtered_color(const struct evaluation *evaluation, int which, size_t i)
{
    struct color color;
    for (int channel = 0; channel < 3; channel++)
        color.v[channel] = evaluation->planes[which][channel].values[i];
    color = rgb_of_ycxcz(color);
    for (int channel = 0; channel < 3; channel++)
        color.v[channel] = clamp01(color.v[channel]);
    return hunt_lab_of(color);
}

/* Distances up to p_c of the largest one, that of green and blue, take up p_t of the range. */
static double color_error(double distance)
{
    const double exponent = 0.7, p_c = 0.4, p_t = 0.95;
    static const struct color green = {{0, 1, 0}}, blue = {{0, 0, 1}};
    double most = pow(hyab(hunt_lab_of(green), hunt_lab_of(blue)), exponent);
    double error = pow(distance, exponent), knee = p_c * most;
    return error < knee ? p_t / knee * error : p_t + (error - knee) / (most - knee) * (1 - p_t);
}

bool flip_ldr(const struct rgb_image *reference, const struct rgb_image *test,
              double pixels_per_degree, float *errors)
{
    const struct rgb_image *const images[2] = {reference, test};
    struct evaluation *evaluation = calloc(1, sizeof *evaluation);
    bool good = evaluation && evaluation_begin(evaluation, reference, pixels_per_degree);
    for (int which = 0; which < 2 && good; which++) {
        flip_load(evaluation, which, images[which]);
        detect(evaluation, which, 1);
        detect(evaluation, which, 2);
        for (int channel = 0; channel < 3; channel++)
            filter_sensitivity(&evaluation->planes[which][channel], &sensitivities[channel],
                               pixels_per_degree, &evaluation->scratch);
    }
    for (size_t i = 0; good && i < evaluation->count; i++) {
        double distance = hyab(filtered_color(evaluation, 0, i), filtered_color(evaluation, 1, i));
        errors[i] = (float)pow(color_error(distance), 1 - feature_error(evaluation, i));
    }
    if (evaluation)
        free(evaluation->memory);
    free(evaluation);
    return good;
}

/* ---- High dynamic range ---------------------------------------------------------------------- */

/* Narkowicz's fit of the ACES curve, with its pre-exposure of 0.6 folded in:
 * (k0 x2 + k1 x) / (k2 x2 + k3 x + k4). */
static const double aces[5] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

static double aces_curve(double x)
{
    if (!(x > 0))
        return 0;
    if (x > 1e6)
        return 1;
    return clamp01((aces[0] * x + aces[1]) * x / ((aces[2] * x + aces[3]) * x + aces[4]));
}

static double aces_inverse(double y)
{
    double a = aces[0] - aces[2] * y, b = aces[1] - aces[3] * y, c = -aces[4] * y;
    return (-b + sqrt(b * b - 4 * a * c)) / (2 * a);
}

static bool find_exposures(const struct rgb_image *reference, struct flip_exposures *exposures)
{
    const double nearly_white = 0.85;
    size_t count = (size_t)reference->width * reference->height;
    double *luminance = malloc((count ? count : 1) * sizeof *luminance);
    if (!luminance)
        return false;
    for (size_t i = 0; i < count; i++) {
        const float *t = reference->texels + 3 * i;
        double sum = 0.2126 * (double)t[0] + 0.7152 * (double)t[1] + 0.0722 * (double)t[2];
        luminance[i] = isfinite(sum) && sum > 0 ? sum : 0;
    }
    sort_numbers(luminance, count);
    double brightest = count ? luminance[count - 1] : 0;
    double median = count ? quantile(luminance, count, 0.5) : 0;
    free(luminance);
    *exposures = (struct flip_exposures){0, 0, 1};
    if (brightest > 0) {
        double x = aces_inverse(nearly_white);
        exposures->start = log2(x / brightest);
        exposures->stop = log2(x / fmax(median, brightest * 0x1p-24)); /* mostly black images */
        double stops = ceil(exposures->stop - exposures->start);
        exposures->count = stops > 2 ? (uint32_t)stops : 2;
    }
    return true;
}

static void expose(const struct rgb_image *image, double stops, float *texels)
{
    double scale = exp2(stops);
    size_t count = (size_t)image->width * image->height * 3;
    for (size_t i = 0; i < count; i++)
        texels[i] = (float)aces_curve(scale * (double)image->texels[i]);
}

bool flip_hdr(const struct rgb_image *reference, const struct rgb_image *test,
              double pixels_per_degree, float *errors, struct flip_exposures *exposures)
{
    size_t count = (size_t)reference->width * reference->height;
    float *memory = malloc((count ? count : 1) * 7 * sizeof *memory);
    bool good = memory && find_exposures(reference, exposures);
    memset(errors, 0, count * sizeof *errors);
    for (uint32_t i = 0; good && i < exposures->count; i++) {
        double step = exposures->count > 1 ? (double)i / (exposures->count - 1) : 0;
        double stops = exposures->start + (exposures->stop - exposures->start) * step;
        struct rgb_image left = *reference, right = *test;
        float *one = memory + 6 * count;
        left.texels = memory;
        right.texels = memory + 3 * count;
        expose(reference, stops, memory);
        expose(test, stops, memory + 3 * count);
        good = flip_ldr(&left, &right, pixels_per_degree, one);
        for (size_t at = 0; good && at < count; at++)
            errors[at] = fmaxf(errors[at], one[at]);
    }
    free(memory);
    return good;
}
