/* What the files of `diptych report` share. Internal to report*.c.
 *
 * A report's folder holds index.html; rows.csv, what was measured; a folder per scene with what the commands of its steps
 * wrote; plots in plots/; and what steps.h puts there. The page is made last, from the files alone. */
#ifndef DIPTYCH_REPORT_H
#define DIPTYCH_REPORT_H

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
    struct steps steps;
    struct grid
        grid; /* columns: picture, the sweep's parameter; of each scene, each picture, each value */
    const char *columns[2];
    char *command;      /* that makes this report, for /bin/sh */
    char *outline_path; /* absolute */
    cJSON *outline;     /* see report_outline.c */
};

/* report_outline.c: the outline beside the spec, or --outline; the scenes that it or --scene names. */
bool report_read_outline(struct report *report);
bool report_find_scenes(struct report *report);
/* Element `index` of a list of numbers or words, as text; "" behind its end. */
const char *report_item(const cJSON *list, int index, char buffer[32]);

/* A file that the outline names, beside it; free(). */
char *report_outline_file(const struct report *report, const char *name);
/* Motions of the outline that are of this scene, one after the other: the first after NULL. */
const cJSON *report_next_motion(const struct report *report, const struct step_scene *scene,
                                const cJSON *motion);
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
/* The picture that stands for the pipeline at its best, whose times are taken. */
const cJSON *report_last_picture(const struct report *report);
/* Where a picture of a scene that is here was measured at a value of the sweep. */
const struct grid_point *report_point(const struct report *report, const struct step_scene *scene,
                                      const cJSON *picture, int value);

/* report_plots.c: plots/ of the report's folder. */
bool report_draw_plots(struct report *report);
/* Pixels: plots of motions have a line of the key for each run. */
int report_change_plot_height(const struct report *report);

/* report_page.c: index.html. */
bool report_write_page(struct report *report);

/* report_tables.c: parts of the page. */
void report_put_text(FILE *out, const char *text); /* escaped */
void report_put_link(FILE *out, const char *path); /* of a file in the report's folder */
/* A number with as many digits as a reader needs, "-" for NaN. */
void report_put_number(FILE *out, double value);
/* The same, marked with the file and the place in it that it was read from. */
void report_put_result(FILE *out, struct report *report, const char *file, const char *path);
/* The same as a percentage. */
void report_put_percentage(FILE *out, struct report *report, const char *file, const char *path);
void report_put_overview(FILE *out, struct report *report);
void report_put_errors(FILE *out, struct report *report);
void report_put_flicker(FILE *out, struct report *report, const struct step_scene *scene,
                        const cJSON *motion);
void report_put_stages(FILE *out, struct report *report, const struct step_scene *scene);

#endif
