/* A grid of measurements: at each point, a scene with some values set, the times of all passes and
 * the error against a path-traced reference. Plans the steps, reads their results, and writes them
 * as CSV, one row per point and backend. */
#ifndef DIPTYCH_MEASURE_H
#define DIPTYCH_MEASURE_H

#include "measure/steps.h"
#include "truth/image_metrics.h"

enum {
    MEASURE_AGREE = 1, /* whether all backends agree, by compare */
    MEASURE_TIME = 2,  /* times of all backends, by bench */
    MEASURE_ERROR = 4, /* error of the picture against the reference, by render and metrics */
    MEASURE_OWN = 8    /* and against the picture of another point, the last of a row */
};

struct grid_point {
    const struct step_scene *scene;
    uint32_t size[2];
    char *name;    /* of its files in the scene's folder */
    char **values; /* one for each column of the grid */
    cJSON *sets;   /* PATH=VALUE, those and others */
    unsigned measures;
    const struct grid_point *last; /* MEASURE_OWN: the point to compare with; itself: no step */
    char *reference;               /* MEASURE_ERROR: file of the reference's step */
};

struct grid {
    struct steps *steps;
    const char *const *columns;
    uint32_t column_count;
    struct grid_point *points; /* in the order of their rows */
    uint32_t count;
    unsigned measures; /* of any point */
    uint32_t pictured; /* number of sides, from the first, whose pictures are measured */
    uint32_t frames;   /* frames to run; the picture is of the last. 0: 1 */
    bool every_frame;  /* errors are means over all frames, with standard errors */
    const char *show;  /* image to measure; NULL: the spec's output */
    int part_time, part_error, part_agree; /* of the steps */
    char **passes;                         /* passes that any run has times of, in order */
    uint32_t pass_count;
};

/* Allocates `count` zeroed points. False with the error logged when out of memory. grid_free either
 * way. */
bool grid_begin(struct grid *grid, struct steps *steps, uint32_t count);
/* Name for the files of a point: `before`, then COLUMN_VALUE of each column; free(). */
char *grid_name(const struct grid *grid, const struct grid_point *point, const char *before);

/* The path-traced picture of a scene, SCENE/NAME.exr, and the step SCENE/NAME.json. */
struct reference {
    const struct step_scene *scene;
    const uint32_t *size;
    const char *name;
    const char *bounces, *from_bounce, *quantity; /* as `reference` takes them; NULL: its default */
    uint32_t seed;                                /* of other noise; 0: the usual */
    int part;
};
bool measure_add_reference(struct steps *steps, const struct reference *reference);
/* A linear picture of one side; `file` is taken over. */
struct rendering {
    const struct step_scene *scene;
    const uint32_t *size;
    const cJSON *sets;
    const char *side, *show;
    uint32_t frames;
    bool every_frame; /* a picture of each: `file` becomes FILE_000.exr, FILE_001.exr, ... */
    int part;
};
bool measure_add_render(struct steps *steps, const struct rendering *rendering, char *file);
/* A step that compares the picture of one step with another's: a reference (named by its JSON) or a
 * rendering. */
struct measurement {
    const char *picture, *against;
    const char *maps; /* folder for error maps, or NULL */
    uint32_t frames;  /* all frames of a rendering with every_frame; 0: one picture */
    int part;
};
/* Takes over `file`. */
bool measure_add_metrics(struct steps *steps, const struct measurement *measurement, char *file);
bool measure_add_comparison(struct steps *steps, const struct rendering *rendering, char *file);

/* Adds the steps of points first to end - 1; their last points, if others, among them. */
bool grid_plan(struct grid *grid, uint32_t first, uint32_t end);

/* ---- measure_rows.c: what has been measured -------------------------------------------------- */

/* Names of files, as the steps have them; free(). */
char *grid_bench_file(const struct grid_point *point);
char *grid_compare_file(const struct grid_point *point);
char *grid_picture_file(const struct grid *grid, const struct grid_point *point, uint32_t side);
char *grid_error_file(const struct grid *grid, const struct grid_point *point, uint32_t side);
char *grid_own_file(const struct grid *grid, const struct grid_point *point, uint32_t side);

/* A number by the name of its column, such as frame_ms, own_flip or, with every_frame,
 * flip_standard_error; NAN where there is none. */
double grid_number(const struct grid *grid, const struct grid_point *point, uint32_t side,
                   const char *name);
/* Path of a number in the JSON of `metrics`, such as hdr.relative_mse; free(). */
char *measure_path(const struct image_number *number);
/* Of a pass: "median", "p5" or "p95", milliseconds. */
double grid_pass_ms(const struct grid *grid, const struct grid_point *point, uint32_t side,
                    const char *pass, const char *of);
/* Why a row is incomplete, or NULL; free(). */
char *grid_reason(const struct grid *grid, const struct grid_point *point, uint32_t side);

/* After the steps were run: which passes there are. Logs when out of memory. */
bool grid_read(struct grid *grid);
/* README has the columns. */
bool grid_write_csv(const struct grid *grid, const char *path);
cJSON *grid_json(const struct grid *grid);
void grid_free(struct grid *grid);

#endif
