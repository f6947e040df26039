/* Line plots by gnuplot, as SVG that follows a dark page, with the script and its data beside. */
#ifndef DIPTYCH_PLOT_H
#define DIPTYCH_PLOT_H

#include <stdio.h>

#include "console/console.h"

enum { PLOT_WIDTH = 480, PLOT_HEIGHT = 340, PLOT_COLOURS = 6 };

struct plot {
    const char *x_label, *y_label;
    /* Values of the x axis, when it is a list. Numbers are placed by value, on a logarithmic axis
     * when their range is a factor of 4 or more; other values are spaced evenly. */
    const char *const *values;
    uint32_t value_count;
    bool from_zero; /* y axis; else logarithmic, which shows positive values only */
    bool beside;    /* the key is right of the plot, in additional width */
    int height;     /* pixels; 0: what its lines need */
    double
        noise; /* a grey band of y: from 0 to it, or if it is a ratio, from 1 / it to it; 0: none */
    bool noise_is_ratio;
    /* Filled by plot_line and plot_point. */
    FILE *data, *lines;
    char *data_text, *lines_text;
    size_t data_size, lines_size;
    uint32_t line_count, point_count;
    double low, high; /* of y, positive */
};

/* Whether gnuplot is installed, checked before hours of work; logs the error. */
bool plot_has_gnuplot(struct console *console);

/* Do not change the fields up to `noise_is_ratio` from here on. Logs when out of memory. plot_free either
 * way. */
bool plot_begin(struct plot *plot, const struct dt_log *log);
/* A line, whose points follow; colour 1 to PLOT_COLOURS, dash 1 (none) to 5. `bars`: its points have them. */
void plot_line(struct plot *plot, const char *title, uint32_t colour, uint32_t dash, bool bars);
/* A point with a bar from low to high; NAN leaves out the point or the bar. */
void plot_point(struct plot *plot, double x, double y, double low, double high);
double plot_x(const struct plot *plot, uint32_t index); /* of one of the values */
/* Writes FOLDER/NAME.gp and NAME.svg; removes the SVG when there is no point. Logs its error. */
bool plot_draw(struct plot *plot, struct console *console, const char *folder, const char *name);
int plot_height(int lines); /* with a line of the key above for each */
bool plot_is_empty(const struct plot *plot);
void plot_free(struct plot *plot);

#endif
