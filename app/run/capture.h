/* `render --capture`: a frame as a file for RenderDoc. RenderDoc must be loaded before OpenGL and
 * Vulkan are, so the program starts again with it. */
#pragma once

#include "console/console.h"

/* Starts the program again with RenderDoc in it, unless it is there. False with the error logged where
 * there is no RenderDoc. Call it before a driver is loaded. */
bool capture_load(const struct dt_log *log);

/* Around the frame, with the device open. The file appears whole or not at all. False with the error
 * logged. */
bool capture_begin(const char *path, const struct dt_log *log);
bool capture_end(const char *path, const struct dt_log *log);
