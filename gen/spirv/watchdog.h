/* Ends a command when a spec takes too much processor time, memory or stack, with a message: glslang can
 * neither be interrupted nor be told a limit. Commands start it around spec_load; a library does
 * not, since it never ends its host. shaders.c tells it the passes. */
#pragma once

#include <stdbool.h>

enum { SPEC_GIBIBYTES = 8 }; /* of memory, of diptych-gen */
enum { SPEC_SECONDS = 60 };  /* of processor time, which is enough for a hundred of ssvp's size */

/* From here on, the process ends with this status after so many seconds of processor time of all its
 * threads, and when C++ code runs out of memory or of stack. False: errno. */
bool watchdog_start(unsigned seconds, int status);
void watchdog_stop(void);

/* The message names the passes that threads are compiling. `label`: a pass and its place; it must
 * stay until the matching end, which is given the same pointer. */
void watchdog_begin(const char *label);
void watchdog_end(const char *label);
