/* Sums of samples, their noise and their checkpoints; see film.h. A checkpoint is three lines of
 * text (what it is, the settings, the number of samples), then the sums as the machine holds them,
 * then a hash of all that. */
#include "truth/film.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "base/files.h"

static size_t number_count(const struct film *film)
{
    return (size_t)film->width * film->height * 3;
}

bool film_create(struct film *film, uint32_t width, uint32_t height, const struct dt_log *log)
{
    *film = (struct film){.width = width, .height = height};
    for (int half = 0; half < 2; half++)
        film->sums[half] = calloc(number_count(film), sizeof(double));
    if (film->sums[0] && film->sums[1])
        return true;
    report_error(log, "out of memory for a picture of %ux%u", width, height);
    film_free(film);
    return false;
}

void film_free(struct film *film)
{
    free(film->sums[0]);
    free(film->sums[1]);
    *film = (struct film){0};
}

void film_mean(const struct film *film, float *texels)
{
    for (size_t i = 0; i < number_count(film); i++)
        texels[i] = (float)((film->sums[0][i] + film->sums[1][i]) / film->samples);
}

void film_add(struct film *film, size_t pixel, uint32_t sample, const float rgb[3])
{
    double *earlier = film->sums[0] + pixel * 3, *later = film->sums[1] + pixel * 3;
    bool power = (sample & (sample - 1)) == 0; /* 0 also when nothing moves */
    for (int c = 0; c < 3; c++) {
        if (power) {
            earlier[c] += later[c];
            later[c] = 0;
        }
        later[c] += rgb[c];
    }
}

static double luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

double film_noise(const struct film *film)
{
    if (film->samples < 2)
        return INFINITY;
    double earlier = 1, squares = 0, sum = 0;
    while (2 * earlier < film->samples)
        earlier *= 2;
    double later = film->samples - earlier;
    for (size_t i = 0; i < number_count(film); i += 3) {
        double a = luminance(&film->sums[0][i]), b = luminance(&film->sums[1][i]);
        /* With s^2 the variance of a sample, that of the difference is s^2 / earlier + s^2 / later,
         * that of the mean of all s^2 / (earlier + later). */
        double difference = a / earlier - b / later;
        squares += difference * difference * earlier * later / pow(earlier + later, 2);
        sum += (a + b) / (earlier + later);
    }
    double pixels = (double)film->width * film->height;
    return sum > 0 ? sqrt(squares / pixels) / (sum / pixels) : 0;
}

/* ---- Checkpoints ----------------------------------------------------------------------------- */

static const char magic[] = "diptych checkpoint 1";

bool film_save(const struct film *film, const char *path, const char *settings,
               const struct dt_log *log)
{
    char *head = format_string("%s\n%s\n%u\n", magic, settings, film->samples);
    size_t half = number_count(film) * sizeof(double);
    size_t length = head ? strlen(head) : 0, size = length + 2 * half;
    uint64_t hash = FILE_HASH_START;
    uint8_t *data = head ? malloc(size + sizeof hash) : NULL;
    bool good = data;
    if (good) {
        memcpy(data, head, length + 1);
        memcpy(data + length, film->sums[0], half);
        memcpy(data + length + half, film->sums[1], half);
        hash_bytes(&hash, data, size);
        memcpy(data + size, &hash, sizeof hash);
        good = file_write(path, data, size + sizeof hash, log);
    } else {
        report_error(log, "%s: out of memory for a checkpoint", path);
    }
    free(data);
    free(head);
    return good;
}

/* Cuts the next line off: puts a zero in place of its end. NULL where no line ends. */
static char *next_line(char **rest, const char *end)
{
    char *line = *rest;
    char *stop = memchr(line, '\n', (size_t)(end - line));
    if (!stop)
        return NULL;
    *stop = 0;
    *rest = stop + 1;
    return line;
}

static bool film_is_whole(const char *data, size_t size)
{
    uint64_t kept, hash = FILE_HASH_START;
    if (size < sizeof kept)
        return false;
    hash_bytes(&hash, data, size - sizeof kept);
    memcpy(&kept, data + size - sizeof kept, sizeof kept);
    return kept == hash;
}

bool film_load(struct film *film, const char *path, const char *settings, const struct dt_log *log)
{
    size_t size = 0, half = number_count(film) * sizeof(double);
    char *data = file_read(path, &size, log), *rest = data;
    if (!data)
        return false;
    const char *end = data + size;
    bool whole = film_is_whole(data, size), good = false;
    const char *title = whole ? next_line(&rest, end) : NULL;
    const char *made_with = title && strcmp(title, magic) == 0 ? next_line(&rest, end) : NULL;
    const char *samples = made_with ? next_line(&rest, end) : NULL;
    if (!samples)
        report_error(log, "%s: is no checkpoint, or is damaged; remove it", path);
    else if (strcmp(made_with, settings) != 0)
        report_error(log, "%s: is a checkpoint with other settings (%s, not %s); name another file",
                     path, made_with, settings);
    else if ((size_t)(end - rest) != 2 * half + sizeof(uint64_t))
        report_error(log, "%s: has the wrong size for its settings; remove it", path);
    else
        good = true;
    if (good) {
        film->samples = (uint32_t)strtoul(samples, NULL, 10);
        memcpy(film->sums[0], rest, half);
        memcpy(film->sums[1], rest + half, half);
    }
    free(data);
    return good;
}
