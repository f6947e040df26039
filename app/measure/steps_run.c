/* Runs the steps of a folder with ninja, shows progress and remaining time, and reads their
 * results; see steps.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "measure/ninja.h"
#include "measure/steps.h"

/* ---- Files ----------------------------------------------------------------------------------- */

static void write_edge(FILE *out, const struct step *step)
{
    ninja_edge(out, step->file, step->traced ? "program" : "spec");
    ninja_path(out, step->scene->path);
    ninja_path(out, step->scene->mesh);
    ninja_path(out, step->motion);
    for (size_t i = 0; i < DT_ARRAY_COUNT(step->needs); i++)
        ninja_path(out, step->needs[i]);
    ninja_end(out, step->file, step->command);
}

static void write_ninja(FILE *out, const void *user)
{
    const struct steps *steps = user;
    const cJSON *item;
    ninja_begin(out, steps->verb, true);
    ninja_group(out, "program");
    ninja_path(out, steps->program);
    ninja_end(out, NULL, NULL);
    ninja_group(out, "spec");
    ninja_path(out, "program");
    cJSON_ArrayForEach(item, steps->spec_files) ninja_path(out, item->valuestring);
    for (uint32_t i = 0; i < steps->request.setup->inputs.count; i++) {
        char *path = step_input(steps->request.setup->inputs.items[i]);
        ninja_path(out, path);
        free(path);
    }
    ninja_end(out, NULL, NULL);
    for (uint32_t i = 0; i < steps->count; i++)
        write_edge(out, &steps->list[i]);
}

static void write_commands(FILE *out, const void *user)
{
    const struct steps *steps = user;
    fprintf(out, "# diptych %s: the commands of its steps\n", steps->verb);
    for (uint32_t i = 0; i < steps->count; i++)
        fprintf(out, "%s\n", steps->list[i].command);
}

/* The commands do not make the folders of what they write. */
static bool make_folders(const struct steps *steps)
{
    bool good = true;
    for (uint32_t i = 0; i < steps->count && good; i++) {
        const char *file = steps->list[i].file;
        char *folder =
            format_string("%s/%.*s", steps->folder, (int)(strrchr(file, '/') - file), file);
        good = folder && file_make_folders(folder, &steps->console->log);
        free(folder);
    }
    return good;
}

/* ---- Progress -------------------------------------------------------------------------------- */

/* Progress reported by ninja, per step. */
struct progress {
    const struct steps *steps;
    bool *waits;     /* scheduled and not started */
    double *seconds; /* duration; 0: not finished, or finished in an earlier run */
    uint32_t total, begun;
    const struct step *at; /* that runs, or NULL */
    struct timespec since;
    bool planning; /* dry run: ninja lists what it would do */
    bool skips;    /* skip the next line: the command of a failed step */
};

/* Prefix of a step's file in ninja's output. */
static const char mark[] = "step ";

/* Estimated seconds to the end, from the durations of finished steps of the same verb, or of any
 * verb. NAN before the first step has finished. */
static double seconds_left(const struct progress *progress)
{
    const struct steps *steps = progress->steps;
    double left = 0;
    for (uint32_t i = 0; i < steps->count; i++) {
        double sums[2] = {0}, counts[2] = {0}; /* of any verb, of its own */
        for (uint32_t j = 0; j < steps->count && progress->waits[i]; j++) {
            bool alike = steps->list[i].part == steps->list[j].part &&
                         strcmp(steps->list[i].verb, steps->list[j].verb) == 0;
            for (int own = 0; own <= alike && progress->seconds[j] > 0; own++) {
                sums[own] += progress->seconds[j];
                counts[own] += 1;
            }
        }
        if (progress->waits[i])
            left += counts[1] > 0 ? sums[1] / counts[1] : sums[0] / counts[0];
    }
    return left;
}

static void tell_step(struct progress *progress, const struct step *step)
{
    struct timespec now;
    char left[32] = "";
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (progress->at)
        progress->seconds[progress->at - progress->steps->list] =
            (double)(now.tv_sec - progress->since.tv_sec) +
            1e-9 * (double)(now.tv_nsec - progress->since.tv_nsec);
    double seconds = seconds_left(progress);
    progress->waits[step - progress->steps->list] = false;
    progress->at = step;
    progress->since = now;
    if (!isnan(seconds))
        console_duration(seconds, left, sizeof left);
    fprintf(stderr, "[%u/%u] %s%s%s%s\n", ++progress->begun, progress->total, step->file,
            *left ? ", about " : "", *left ? left : "", *left ? " left" : "");
}

static void take_ninja_line(void *user, const char *line)
{
    struct progress *progress = user;
    bool skipped = progress->skips;
    const struct step *step = strncmp(line, mark, strlen(mark)) == 0
                                  ? steps_find(progress->steps, line + strlen(mark))
                                  : NULL;
    progress->skips = strncmp(line, "FAILED: ", 8) == 0;
    if (step && progress->planning) {
        progress->waits[step - progress->steps->list] = true;
        progress->total++;
    } else if (step) {
        tell_step(progress, step);
    } else if (!progress->planning && !progress->skips && !skipped &&
               strncmp(line, "ninja: Entering", 15) != 0) {
        fprintf(stderr, "%s\n", line);
    }
}

bool steps_run(struct steps *steps)
{
    struct console *console = steps->console;
    const struct dt_log *log = &console->log;
    struct progress progress = {.steps = steps,
                                .planning = true,
                                .waits = calloc(steps->count + 1, sizeof *progress.waits),
                                .seconds = calloc(steps->count + 1, sizeof *progress.seconds)};
    bool good = progress.waits && progress.seconds && setenv("NINJA_STATUS", "", 1) == 0 &&
                /* a message that every step would repeat */
                setenv("DIPTYCH_QUIET", "1", 1) == 0;
    if (!good)
        report_error(log, "out of memory");
    console_hold(console);
    good = good && make_folders(steps) &&
           content_write(steps->folder, "build.ninja", write_ninja, steps, log) &&
           content_write(steps->folder, "commands", write_commands, steps, log);
    console_release(console);
    good = good && ninja_run(console, steps->folder, 1, true, take_ninja_line, &progress);
    progress.planning = false;
    good = good && ninja_run(console, steps->folder, 1, false, take_ninja_line, &progress);
    free(progress.seconds);
    free(progress.waits);
    return good;
}

/* ---- Results --------------------------------------------------------------------------------- */

/* A failed step has no file. A step that waits for it did not run, even if an old file exists. */
bool steps_is_done(const struct steps *steps, const struct step *step)
{
    char *path = format_string("%s/%s", steps->folder, step->file);
    bool done = path && file_exists(path);
    for (size_t i = 0; i < DT_ARRAY_COUNT(step->needs) && step->needs[i] && done; i++)
        done = steps_is_done(steps, steps_find(steps, step->needs[i]));
    free(path);
    return done;
}

/* Steps that wait for a failed one are only counted, not reported. */
uint32_t steps_count_failures(const struct steps *steps)
{
    uint32_t failures = 0;
    for (uint32_t i = 0; i < steps->count; i++) {
        const struct step *step = &steps->list[i];
        bool waits = false;
        if (steps_is_done(steps, step))
            continue;
        failures++;
        for (size_t j = 0; j < DT_ARRAY_COUNT(step->needs) && step->needs[j]; j++)
            waits |= !steps_is_done(steps, steps_find(steps, step->needs[j]));
        char *reason = waits || steps->request.collect ? NULL : steps_reason(steps, step->file);
        if (reason)
            report_error(&steps->console->log, "%s; there is no result of: %s", reason,
                         step->command);
        free(reason);
    }
    if (failures && steps->request.collect)
        report_message(&steps->console->log, DT_INFO, "%u of %u steps have no result yet", failures,
                       steps->count);
    return failures;
}

/* The first error in a file of --json; NULL where there is none. */
static char *read_reason(const struct steps *steps, const char *file, const char *ending)
{
    char *path = format_string("%s/%s%s", steps->folder, file, ending), *reason = NULL;
    size_t size;
    char *text = path && file_exists(path) ? file_read(path, &size, &steps->console->log) : NULL;
    cJSON *root = text ? cJSON_Parse(text) : NULL;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(root, "errors"))
    {
        if (!reason && strcmp(step_text(item, "severity"), "error") == 0)
            reason = strdup(step_text(item, "message"));
    }
    cJSON_Delete(root);
    free(text);
    free(path);
    return reason;
}

char *steps_reason(const struct steps *steps, const char *file)
{
    const struct step *step = steps_find(steps, file);
    char *reason = NULL;
    if (!step || steps_is_done(steps, step))
        return NULL;
    for (size_t i = 0; i < DT_ARRAY_COUNT(step->needs) && step->needs[i] && !reason; i++)
        reason = steps_reason(steps, step->needs[i]);
    if (!reason)
        reason = read_reason(steps, file, ".failed");
    if (!reason) /* of a command whose file is a picture */
        reason = read_reason(steps, file, ".json");
    if (!reason) {
        char *said = format_string("%s/%s.txt", steps->folder, file);
        reason = said && file_exists(said)
                     ? format_string("%s: was not made, see %s.txt", file, file)
                     : format_string("%s: has not been made yet", file);
        free(said);
    }
    return reason;
}

const cJSON *steps_result(struct steps *steps, const char *file)
{
    const cJSON *known = cJSON_GetObjectItemCaseSensitive(steps->results, file);
    if (known)
        return cJSON_IsNull(known) ? NULL : known;
    const struct step *step = steps_find(steps, file);
    char *path = format_string("%s/%s", steps->folder, file);
    size_t size;
    char *text = step && path && steps_is_done(steps, step)
                     ? file_read(path, &size, &steps->console->log)
                     : NULL;
    cJSON *result = text ? cJSON_Parse(text) : NULL;
    cJSON_AddItemToObject(steps->results, file, result ? result : cJSON_CreateNull());
    free(text);
    free(path);
    return result;
}

double steps_number(struct steps *steps, const char *file, const char *path)
{
    const cJSON *at = steps_result(steps, file);
    char name[64];
    for (; at && *path; path += *path == '.') {
        size_t length = strcspn(path, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        at = cJSON_GetObjectItemCaseSensitive(at, name);
        path += length;
    }
    return at && cJSON_IsNumber(at) ? at->valuedouble : NAN;
}
