/* Line plots by gnuplot, as SVG that follows a reader's choice of a dark page, with the script and its numbers beside. Called
 * by report_plots.c and sweep_grid.c. */
#ifndef DIPTYCH_PLOT_H
#define DIPTYCH_PLOT_H

#include <stdio.h>

#include "base/console.h"

enum { PLOT_WIDTH = 480, PLOT_HEIGHT = 340, PLOT_COLOURS = 6 };

struct plot {
    const char *x_label, *y_label;
    /* What stands along the x axis, if it is a list of values: numbers have their place, on a logarithmic axis where they grow by
     * 4 times and more, anything else stands side by side. */
    const char *const *values;
    uint32_t value_count;
    bool from_zero; /* y; else logarithmic, where only positive values can be seen */
    bool beside;    /* the key is right of the plot, which is wider for it */
    int height;     /* pixels; 0: what its lines need */
    /* What plot_line and plot_point gather. */
    FILE *data, *lines;
    char *data_text, *lines_text;
    size_t data_size, lines_size;
    uint32_t line_count, point_count;
    double low, high; /* of y, positive */
    bool bars;        /* in the line that was begun last */
};

/* Asked before hours of work; logs the error. */
bool plot_has_gnuplot(struct console *console);

/* From here on, the fields up to `height` stand. Logs when out of memory. plot_free either way. */
bool plot_begin(struct plot *plot, const struct dt_log *log);
/* A line, whose points follow; colour 1 to PLOT_COLOURS, dash 1 (none) to 5. `bars`: its points have them. */
void plot_line(struct plot *plot, const char *title, uint32_t colour, uint32_t dash, bool bars);
/* A point, with a bar from low to high; what is NAN leaves none. */
void plot_point(struct plot *plot, double x, double y, double low, double high);
double plot_x(const struct plot *plot, uint32_t index); /* of one of the values */
/* Writes FOLDER/NAME.gp and NAME.svg, or removes an SVG where there is nothing to be seen. Logs its error. */
bool plot_draw(struct plot *plot, struct console *console, const char *folder, const char *name);
int plot_height(int lines); /* with a line of the key above for each */
bool plot_is_empty(const struct plot *plot);
void plot_free(struct plot *plot);

#endif
