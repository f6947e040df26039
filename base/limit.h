/* Limits of memory, which children inherit: what a spec, a driver or a tool takes beyond them fails there,
 * and not in other programs of the machine. */
#pragma once

#include <stdbool.h>

/* Of this process: private memory that it may write. A lower limit stays. 0: what the machine has. Does nothing
 * under a sanitizer, whose shadow counts. False: errno. */
bool limit_memory(unsigned gibibytes);
