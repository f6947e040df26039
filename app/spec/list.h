/* The parameters, resources and passes of a pipeline, for people and as JSON. */
#pragma once

#include <cjson/cJSON.h>

#include "spec/pipeline.h"

/* As `list --json` has it, for a frame size in pixels; cJSON_Delete. */
cJSON *list_json(const struct pipeline *pipeline, const uint32_t size[2]);

/* On stdout. `more`, unless NULL, prints lines of its own behind those of each pass; names take `width`
 * columns. */
typedef void list_more(const void *user, uint32_t pass, int width);
void list_print(const struct pipeline *pipeline, const uint32_t size[2], list_more *more,
                const void *user);
