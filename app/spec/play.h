/* Plays a planned pipeline: the panel of a spec that was read in this process, without generated
 * C. Its record makes the same calls with the same arguments as that of NAME.c
 * (tests/app/play_test.c). */
#pragma once

#include "gen/lower/lower.h"

/* Gives the tables their functions: extent, runs and record. Then tables->shaders may go to a runtime, for
 * as long as the model lives. */
void play_prepare(struct lowered *tables);
