/* Pictures for the verbs that Python measures: app/python/diptych/stream.py reads them. */
#pragma once

#include <stdio.h>

#include "console/python.h"

/* As python_verb, and `send` writes to the stream that the request names as "stream", in a child process.
 * False: it has told why. */
int hand_over_stream(struct console *console, const char *verb, cJSON *request,
                     bool (*send)(FILE *stream, void *user), void *user);

/* Reads a picture and sends width, height, and RGBA in floats. With size[0] != 0, the picture must be so
 * large: `name` is what the error calls it. False: logged. */
bool hand_over_picture(FILE *stream, const char *path, const char *name, uint32_t size[2],
                       const struct dt_log *log);
