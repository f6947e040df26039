/* What the steps of a report left in its folder. Called by the files that show it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files.h"
#include "report.h"

static const struct report_step *find_step(const struct report *report, const char *file)
{
    for (uint32_t i = 0; i < report->step_count; i++) {
        if (strcmp(report->steps[i].file, file) == 0)
            return &report->steps[i];
    }
    return NULL;
}

/* A step that failed leaves no file; one that waits for it was not run, whatever lies there. */
/* What a failed command tells with --json is no result. */
static bool tells_errors(const struct report *report, const char *path)
{
    size_t size, length = strlen(path);
    bool json = length > 5 && strcmp(path + length - 5, ".json") == 0;
    char *text = json ? file_read(path, &size, &report->console->log) : NULL;
    cJSON *root = text ? cJSON_Parse(text) : NULL;
    const cJSON *item, *status = cJSON_GetObjectItem(root, "exit_status");
    bool error = false;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(root, "errors")) error |=
        strcmp(report_text(item, "severity"), "error") == 0;
    error = error && status && status->valueint != 0;
    cJSON_Delete(root);
    free(text);
    return error;
}

bool report_step_is_done(const struct report *report, const struct report_step *step)
{
    char *path = format_string("%s/%s", report->folder, step->file);
    bool done = path && file_exists(path) && !tells_errors(report, path);
    for (size_t i = 0; i < DT_ARRAY_COUNT(step->needs) && step->needs[i] && done; i++)
        done = report_step_is_done(report, find_step(report, step->needs[i]));
    free(path);
    return done;
}

const cJSON *report_result(struct report *report, const char *file)
{
    const cJSON *known = cJSON_GetObjectItemCaseSensitive(report->results, file);
    if (known)
        return cJSON_IsNull(known) ? NULL : known;
    const struct report_step *step = find_step(report, file);
    char *path = format_string("%s/%s", report->folder, file);
    size_t size;
    char *text = step && path && report_step_is_done(report, step)
                     ? file_read(path, &size, &report->console->log)
                     : NULL;
    cJSON *result = text ? cJSON_Parse(text) : NULL;
    cJSON_AddItemToObject(report->results, file, result ? result : cJSON_CreateNull());
    free(text);
    free(path);
    return result;
}

double report_number(struct report *report, const char *file, const char *path)
{
    const cJSON *at = report_result(report, file);
    char name[64];
    for (; at && *path; path += *path == '.') {
        size_t length = strcspn(path, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        at = cJSON_GetObjectItemCaseSensitive(at, name);
        path += length;
    }
    return at && cJSON_IsNumber(at) ? at->valuedouble : NAN;
}

double report_frame_change(struct report *report, const char *file, int step, const char *name)
{
    const cJSON *list = cJSON_GetObjectItem(report_result(report, file), "per_frame");
    const cJSON *item = cJSON_GetObjectItem(cJSON_GetArrayItem(list, step), name);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

static const cJSON *find_side(struct report *report, const char *file, uint32_t side)
{
    return cJSON_GetArrayItem(cJSON_GetObjectItem(report_result(report, file), "sides"), (int)side);
}

static double number_in(const cJSON *spread, const char *of)
{
    const cJSON *item = cJSON_GetObjectItem(spread, of);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

double report_frame_ms(struct report *report, const char *file, uint32_t side, const char *of)
{
    return number_in(cJSON_GetObjectItem(find_side(report, file, side), "frame_ms"), of);
}

static bool stage_has(const cJSON *stage, const char *pass)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(stage, "passes"))
    {
        if (cJSON_IsString(item) && strcmp(item->valuestring, pass) == 0)
            return true;
    }
    return false;
}

static bool belongs_to(const struct report *report, const cJSON *stage, const char *pass)
{
    const cJSON *any;
    if (stage)
        return stage_has(stage, pass);
    cJSON_ArrayForEach(any, cJSON_GetObjectItem(report->outline, "stages"))
    {
        if (stage_has(any, pass))
            return false;
    }
    return true;
}

double report_stage_ms(struct report *report, const char *file, uint32_t side, const cJSON *stage)
{
    const cJSON *pass, *passes = cJSON_GetObjectItem(find_side(report, file, side), "passes");
    double sum = NAN;
    cJSON_ArrayForEach(pass, passes)
    {
        double ms = number_in(cJSON_GetObjectItem(pass, "ms"), "median");
        if (!isnan(ms) && belongs_to(report, stage, report_text(pass, "pass")))
            sum = (isnan(sum) ? 0 : sum) + ms;
    }
    return sum;
}
