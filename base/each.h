/* All elements of a list, in order: pointers to them, const or not. */
#pragma once

#define EACH(item, list, count)                                                                    \
    for (const __typeof__(*(list)) *item = (list); item < (list) + (count); item++)
#define CHANGE_EACH(item, list, count)                                                             \
    for (__typeof__(*(list)) *item = (list); item < (list) + (count); item++)
