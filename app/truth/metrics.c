/* `diptych metrics`: looks at the options, reads the pictures, and lets Python measure them; see
 * app/python/diptych/metrics.py. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "console/numbered.h"
#include "console/options.h"
#include "scenes/image.h"
#include "truth/hand_over.h"

struct metrics {
    const struct options *options;
    const struct dt_log *log;
    bool hdr; /* the files hold linear light, not 8-bit codes */
    cJSON *pictures;
};

static bool holds_light(const char *path)
{
    static const char *const endings[] = {".exr", ".hdr", ".pfm"};
    size_t length = strlen(path);
    for (size_t i = 0; i < DT_ARRAY_COUNT(endings); i++)
        if (length >= 4 && strcasecmp(path + length - 4, endings[i]) == 0)
            return true;
    return false;
}

static bool check_metrics_options(const struct metrics *metrics, bool numbered)
{
    const struct options *options = metrics->options;
    const struct dt_log *log = metrics->log;
    if (metrics->hdr != holds_light(options->test))
        report_error(
            log, "%s and %s: one holds light and the other 8-bit codes; give two .exr or two .png",
            options->reference, options->test);
    else if (!metrics->hdr && options->exposure > 0)
        report_error(log, "--exposure: %s holds 8-bit codes, which are exposed already",
                     options->reference);
    else if (options->setup.frames > 1 && !numbered)
        report_error(log,
                     "--test %s: names one picture; put %%04d in place of the frame number, or "
                     "leave out --frames",
                     options->test);
    else if (options->output && options->setup.frames > 1)
        report_error(log, "-o: maps are of one picture; leave out --frames");
    else
        return true;
    return false;
}

static bool check_picture(const struct metrics *metrics, const char *path)
{
    if (!image_may_open(path, metrics->log))
        return false;
    image_check_claims(path, metrics->hdr ? IMAGE_AS_LIGHT : IMAGE_AS_SRGB, metrics->log);
    return true;
}

/* Names the pictures, and looks at what stands before their pixels. */
static bool check_pictures(const struct metrics *metrics, bool numbered)
{
    const struct options *options = metrics->options;
    bool good = check_picture(metrics, options->reference);
    for (uint32_t i = 0; i < options->setup.frames && good; i++) {
        char *path = numbered ? numbered_path(options->test, i) : strdup(options->test);
        good = path && check_picture(metrics, path);
        if (good)
            cJSON_AddItemToArray(metrics->pictures, cJSON_CreateString(path));
        free(path);
    }
    return good;
}

static bool send_pictures(FILE *stream, void *user)
{
    const struct metrics *metrics = user;
    const cJSON *path;
    bool good =
        hand_over_picture(stream, metrics->options->reference, "", (uint32_t[2]){0}, metrics->log);
    cJSON_ArrayForEach(path, metrics->pictures) good =
        good && hand_over_picture(stream, path->valuestring, "", (uint32_t[2]){0}, metrics->log);
    return good;
}

int verb_metrics(struct console *console, const struct options *options)
{
    bool good = true, numbered = is_numbered(options->test, "--test", &good, &console->log);
    cJSON *request = options_json(options, VERB_METRICS);
    struct metrics metrics = {.options = options,
                              .log = &console->log,
                              .hdr = holds_light(options->reference),
                              .pictures = cJSON_AddArrayToObject(request, "pictures")};
    cJSON_AddBoolToObject(request, "hdr", metrics.hdr);
    if (good && check_metrics_options(&metrics, numbered) && check_pictures(&metrics, numbered))
        return hand_over_stream(console, "metrics", request, send_pictures, &metrics);
    cJSON_Delete(request);
    return EXIT_FAILED;
}
