/* The parameters, resources and passes of a pipeline as JSON. */
#ifndef DIPTYCH_LIST_H
#define DIPTYCH_LIST_H

#include <cjson/cJSON.h>

#include "spec/pipeline.h"

/* As `list --json` has it, for a frame size in pixels; cJSON_Delete. */
cJSON *list_json(const struct pipeline *pipeline, const uint32_t size[2]);

#endif
