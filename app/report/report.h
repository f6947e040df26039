/* Shared by the files of `diptych report`. A report's folder holds index.html; rows.csv with all
 * measurements; a folder per scene with the results of its steps; plots/; and the files of steps.h.
 * The page is made last, from the files alone. */
#ifndef DIPTYCH_REPORT_H
#define DIPTYCH_REPORT_H

#include "console/options.h"
#include "measure/measure.h"
#include "measure/steps.h"

enum report_part {
    PART_PICTURES,
    PART_ERRORS,
    PART_MOTIONS,
    PART_TIMES,
    PART_COMPARISON,
    REPORT_PARTS
};

struct report {
    const struct options *options;
    struct steps steps;
    /* columns: picture and the sweep's parameter; points by scene, picture, value */
    struct grid grid;
    const char *columns[2];
    char *command;      /* that makes this report, for /bin/sh */
    char *outline_path; /* absolute */
    cJSON *outline;     /* see report_outline.c */
};

/* report_outline.c: the outline beside the spec, or --outline; the scenes that it or --scene names. */
bool report_read_outline(struct report *report);
bool report_find_scenes(struct report *report);
/* Element `index` of a list of numbers or words, as text; "" beyond its end. */
const char *report_item(const cJSON *list, int index, char buffer[32]);

/* A file that the outline names, beside it; free(). */
char *report_outline_file(const struct report *report, const char *name);
/* Iterates over the outline's motions of a scene; NULL gives the first. */
const cJSON *report_next_motion(const struct report *report, const struct step_scene *scene,
                                const cJSON *motion);
/* What the references of motions show: "radiance" or "irradiance", from so many bounces on. */
const char *report_motion_quantity(const struct report *report);
int report_motion_from_bounce(const struct report *report);
/* The sweep: its parameter, its values, and how many. */
const char *report_parameter(const struct report *report);
const cJSON *report_values(const struct report *report);
int report_value_count(const struct report *report);

/* report_steps.c: the steps. */
bool report_plan(struct report *report);
/* Names of files in the report's folder, by scene and by the outline; free(). */
char *report_file(const struct step_scene *scene, const char *name, const char *ending);
/* Of a run of a motion, or of its references. */
char *report_motion_file(const struct step_scene *scene, const cJSON *motion, const char *name,
                         const char *ending);
/* The last picture of the outline: the one whose times are taken. */
const cJSON *report_last_picture(const struct report *report);
/* Point of the grid for a picture at a value of the sweep; the scene's mesh must be there. */
const struct grid_point *report_point(const struct report *report, const struct step_scene *scene,
                                      const cJSON *picture, int value);

/* report_plots.c: plots/ of the report's folder. */
bool report_draw_plots(struct report *report);
/* Pixels: plots of motions have a line of the key for each run. */
int report_change_plot_height(const struct report *report);

/* report_collect.c: writes index.html into a folder that the `run` of a bundle left, from its results.
 * Returns the exit status; errors are logged. */
int report_collect(struct console *console, const char *folder);

/* report_page.c: index.html. */
bool report_write_page(struct report *report);

/* report_tables.c: adds values to the JSON that fills templates/report/report.html. */
void report_add_link(cJSON *item, const char *key, const char *path); /* of the report's folder */
/* A number with as many digits as a reader needs, as text; a dash for NaN. */
void report_add_number(cJSON *item, const char *key, double value);
/* The same with the file and the place in it that it was read from: {"from": "FILE#PATH", "text"}. */
void report_add_result(cJSON *item, const char *key, struct report *report, const char *file,
                       const char *path);
/* The headlines of image_metrics.h: a list of {"from", "text", "what"}. */
void report_add_headlines(cJSON *item, const char *key, struct report *report, const char *file);
void report_add_errors(cJSON *page, struct report *report);
void report_add_flicker(cJSON *item, struct report *report, const struct step_scene *scene,
                        const cJSON *motion);
void report_add_stages(cJSON *item, const struct report *report, const struct step_scene *scene);
/* Who published numbers, and of which device; nothing for NULL. */
void report_add_published(cJSON *item, const char *key, const cJSON *published);

#endif
