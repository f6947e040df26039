/* The parameters, resources and passes of a pipeline, as JSON. */
#pragma once

#include <cjson/cJSON.h>

#include "spec/pipeline.h"

/* As `list --json` has it, for a frame size in pixels; cJSON_Delete. */
cJSON *list_json(const struct pipeline *pipeline, const uint32_t size[2]);
