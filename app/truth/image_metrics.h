/* The numbers of `metrics` for each picture, as every table, CSV file, JSON file and plot has them. Those
 * before IMAGE_HEADLINES stand in tables and plots. */
#ifndef DIPTYCH_IMAGE_METRICS_H
#define DIPTYCH_IMAGE_METRICS_H

#include <stdbool.h>

struct image_number {
    const char *name;  /* in JSON and CSV */
    const char *title; /* in tables and plots */
    bool mapped;       /* sweeps and reports take that of the tone-mapped picture */
    bool share;        /* from 0; its axis is not logarithmic */
};
enum { IMAGE_HEADLINES = 6, IMAGE_NUMBERS = 11 };
extern const struct image_number image_numbers[IMAGE_NUMBERS];

#endif
