/* What the files of `diptych report` share. Internal to report*.c.
 *
 * A report's folder holds index.html; a folder per scene with what the commands of its steps wrote;
 * plots and the numbers behind them in plots/; build.ninja, whose edges are the steps, so that an
 * interrupted report goes on where it was. The page is made last, from the files alone. */
#ifndef DIPTYCH_REPORT_H
#define DIPTYCH_REPORT_H

#include <cjson/cJSON.h>
#include <stdio.h>

#include "console.h"
#include "options.h"
#include "side.h"

struct report_scene {
    char *path; /* of the scene file, absolute */
    char *name; /* of its folder: the file's, without .yaml */
    char *mesh; /* NULL: not here, and the scene is left out */
};

enum report_part {
    PART_PICTURES,
    PART_ERRORS,
    PART_MOTIONS,
    PART_TIMES,
    PART_COMPARISON,
    REPORT_PARTS
};

/* One command, an edge of the ninja file. */
struct report_step {
    const struct report_scene *scene;
    enum report_part part;
    char *file; /* in the report's folder, that the command writes last; its name is the step's */
    const char *needs[2]; /* files of other steps, or NULL */
    char *motion;         /* file, absolute, or NULL */
    bool traced;          /* no matter of the spec */
    char *command;        /* a line for /bin/sh that can be pasted anywhere */
};

struct report {
    struct console *console;
    const struct options *options;
    struct sides sides;
    char *folder;        /* absolute */
    char *program;       /* this executable */
    char *command;       /* that makes this report, for /bin/sh */
    char *spec;          /* absolute */
    char *outline_path;  /* absolute */
    cJSON *outline;      /* see report_outline.c */
    cJSON *spec_files;   /* absolute paths: the spec and all that it takes in */
    char *scenes_folder; /* absolute, or NULL */
    struct report_scene *scenes;
    uint32_t scene_count;
    struct report_step *steps;
    uint32_t step_count;
    cJSON *results; /* report_results.c: of file names, what the files hold */
};

/* report_outline.c: the outline beside the spec, or --outline; the scenes that it or --scene names. */
bool report_read_outline(struct report *report);
bool report_find_scenes(struct report *report);
const char *report_text(const cJSON *object, const char *name); /* "" where it is not */
/* Element `index` of a list of numbers or words, as text; "" behind its end. */
const char *report_item(const cJSON *list, int index, char buffer[32]);

/* A file that the outline names, beside it; free(). */
char *report_outline_file(const struct report *report, const char *name);
/* Motions of the outline that are of this scene, one after the other: the first after NULL. */
const cJSON *report_next_motion(const struct report *report, const struct report_scene *scene,
                                const cJSON *motion);

/* report_steps.c: the steps, and the files build.ninja and commands. */
bool report_plan(struct report *report);
bool report_write_steps(const struct report *report);
/* Names of files in the report's folder, by scene and by the outline; free(). */
char *report_file(const struct report_scene *scene, const char *name, const char *ending);
char *report_sweep_file(const struct report *report, const struct report_scene *scene, int index,
                        const char *ending);
/* Of a picture of the outline at a value of the sweep. */
char *report_error_file(const struct report *report, const struct report_scene *scene,
                        const cJSON *picture, int index, const char *ending);
/* Of a run of a motion, or of its references. */
char *report_motion_file(const struct report_scene *scene, const cJSON *motion, const char *name,
                         const char *ending);
/* The picture that stands for the pipeline at its best. */
const cJSON *report_last_picture(const struct report *report);

/* report_results.c: what the steps left; NULL or NaN where a step has failed. */
const cJSON *report_result(struct report *report, const char *file);
double report_number(struct report *report, const char *file, const char *path); /* a.b.c */
/* Of a file of bench: the median time of a whole frame; the sum of the medians of the passes that a stage of the
 * outline names, or with NULL of those that none does. Milliseconds. */
double report_frame_ms(struct report *report, const char *file, uint32_t side, const char *of);
double report_stage_ms(struct report *report, const char *file, uint32_t side, const cJSON *stage);
/* Of a file of flicker: a number of the step from frame `step` to the next. */
double report_frame_change(struct report *report, const char *file, int step, const char *name);
bool report_step_is_done(const struct report *report, const struct report_step *step);

/* report_plots.c: plots/ of the report's folder. */
bool report_draw_plots(struct report *report);
/* Pixels, of 480 across: plots of motions have a line of the key for each run. */
enum { REPORT_PLOT_HEIGHT = 340 };
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
void report_put_flicker(FILE *out, struct report *report, const struct report_scene *scene,
                        const cJSON *motion);
void report_put_stages(FILE *out, struct report *report, const struct report_scene *scene);

#endif
