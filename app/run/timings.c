/* Takes and writes timings; see timings.h. */
#include "run/timings.h"

#include <math.h>
#include <stdlib.h>

#include "base/files.h"
#include "console/spread.h"

bool timings_create(struct timings *timings, uint32_t passes, uint32_t max_frames,
                    const struct dt_log *log)
{
    *timings = (struct timings){.passes = passes};
    timings->pass_ms = calloc((size_t)passes * max_frames + 1, sizeof *timings->pass_ms);
    timings->frame_ms = calloc(max_frames, sizeof *timings->frame_ms);
    if (timings->pass_ms && timings->frame_ms)
        return true;
    report_error(log, "out of memory for the timings of %u frames", max_frames);
    timings_free(timings);
    return false;
}

bool timings_take(struct timings *timings, const struct session *session, double frame_ms)
{
    if (!session->runtime->timings(session->handle,
                                   timings->pass_ms + (size_t)timings->frames * timings->passes))
        return false;
    timings->frame_ms[timings->frames++] = frame_ms;
    return true;
}

void timings_free(struct timings *timings)
{
    free(timings->pass_ms);
    free(timings->frame_ms);
    *timings = (struct timings){0};
}

static void add_pass_times(cJSON *root, const struct timings *timings,
                           const struct dt_pipeline *pipeline)
{
    double sum = 0;
    cJSON *passes = cJSON_CreateArray();
    for (uint32_t i = 0; i < timings->passes; i++) {
        double ms = spread_of(timings->pass_ms + i, timings->frames, timings->passes).median;
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "pass", pipeline->passes[i].name);
        if (isnan(ms))
            cJSON_AddNullToObject(item, "ms");
        else
            cJSON_AddNumberToObject(item, "ms", ms);
        cJSON_AddItemToArray(passes, item);
        sum += isnan(ms) ? 0 : ms;
    }
    cJSON_AddNumberToObject(root, "sum_ms", sum);
    cJSON_AddItemToObject(root, "passes", passes);
}

bool timings_write(const struct timings *timings, const struct session *session, const char *path)
{
    const struct setup *setup = session->info.setup;
    const struct dt_pipeline *pipeline = session->info.pipeline->info;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "backend", session->info.side->label);
    cJSON_AddStringToObject(root, "device", session->runtime->device_name(session->handle));
    cJSON_AddBoolToObject(root, "software", session->runtime->is_software(session->handle));
    cJSON_AddStringToObject(root, "pipeline", pipeline->name);
    cJSON_AddStringToObject(root, "scene", setup->scene);
    cJSON_AddNumberToObject(root, "width", setup->size[0]);
    cJSON_AddNumberToObject(root, "height", setup->size[1]);
    cJSON_AddNumberToObject(root, "frames", timings->frames);
    cJSON_AddNumberToObject(root, "frame_ms",
                            spread_of(timings->frame_ms, timings->frames, 1).median);
    add_pass_times(root, timings, pipeline);
    console_hold(session->info.console);
    bool good = file_write_json(path, root, &session->log);
    console_release(session->info.console);
    cJSON_Delete(root);
    return good;
}
