/* A folder of measurements. Each step is a diptych command and an edge of a ninja file in the
 * folder; steps run one at a time. ninja continues an interrupted run and repeats only what has
 * changed. */
#ifndef DIPTYCH_STEPS_H
#define DIPTYCH_STEPS_H

#include <cjson/cJSON.h>
#include <stdio.h>

#include "console/console.h"
#include "console/setup.h"
#include "run/side.h"

struct step_scene {
    char *path; /* of the scene file, absolute; "": the pipeline runs without a scene */
    char *name; /* name of its folder: the file's without .yaml */
    char *mesh; /* NULL: not found, the scene is left out */
};

/* One command, an edge of the ninja file. */
struct step {
    const struct step_scene *scene;
    int part;             /* kind of step, defined by the planner */
    char *file;           /* file in the folder that the command writes last; names the step */
    const char *needs[2]; /* files of other steps, or NULL */
    char *motion;         /* file, absolute, or NULL */
    bool traced;          /* path-traced: does not depend on the spec */
    const char *verb;     /* verb of the command, for estimates of time */
    char *command;        /* a line for /bin/sh that can be pasted anywhere */
};

/* What a verb wants of its steps. */
struct steps_request {
    const struct setup *setup;
    const char *output; /* folder */
    uint32_t spp;       /* of references; 0, NULL: by default */
    const char *noise;
    uint32_t frames, warmup; /* of bench; 0: by default */
    bool collect;            /* of the results that are there */
};

struct steps {
    struct console *console;
    struct steps_request request;
    const char *verb; /* verb that made the folder */
    struct sides sides;
    char *folder;        /* absolute */
    char *program;       /* this executable */
    char *spec;          /* absolute */
    cJSON *spec_files;   /* absolute paths: the spec and all its inputs */
    char *scenes_folder; /* absolute, or NULL */
    struct step_scene *scenes;
    uint32_t scene_count;
    struct step *list;
    uint32_t count;
    cJSON *results; /* parsed JSON of results, by file name */
};

/* ---- steps.c: preparing, in this order; each logs its error. steps_free at the end, of a zeroed one, too -------- */

/* The spec, the sides, this program, the folder of meshes. */
bool steps_begin(struct steps *steps, const char *verb, struct console *console,
                 const struct steps_request *request);
/* The scenes, of which one at least must have its mesh. */
bool steps_find_scenes(struct steps *steps, const char *const *paths, uint32_t count);
/* Instead: one scene named "none", for pipelines that do not use a scene. */
bool steps_without_scene(struct steps *steps);
/* Checks spec and overrides with the generator, before hours of work. */
bool steps_check_spec(struct steps *steps);
/* A new folder, an empty one, or one of the same verb. */
bool steps_make_folder(struct steps *steps);
void steps_free(struct steps *steps);

/* Whether the text can be a file name. */
bool step_is_name(const char *text);
/* A member's text; "" where it is not. */
const char *step_text(const cJSON *object, const char *name);

/* ---- steps.c: planning ----------------------------------------------------------------------- */

/* A command being built for a step. */
struct command {
    const struct steps *steps;
    const char *verb;
    FILE *out;
    char *text;
    size_t size;
};

/* The file of an --input, absolute: commands run elsewhere; free(). */
char *step_input(const char *input);
bool command_begin(struct command *command, const struct steps *steps, const char *verb);
void command_file(struct command *command, const char *option, const char *file);
/* The same of a name that may be a pattern: percent signs of the folder are doubled. `ending` stands
 * behind the file, such as _%03d.exr. */
void command_pattern(struct command *command, const char *option, const char *file,
                     const char *ending);
void command_scene(struct command *command, const struct step_scene *scene);
void command_size(struct command *command, const uint32_t size[2]);
/* --spec and --set of `sets`, which may be NULL. The command line's own --set come last, and
 * win. */
void command_spec(struct command *command, const cJSON *sets);
void command_backends(struct command *command);
void command_quality(struct command *command); /* of a reference */
void command_frames(struct command *command);  /* of bench */

/* Takes over step->file, and the command's text. */
bool steps_add(struct steps *steps, const struct step *step, struct command *command);
const char *steps_last(const struct steps *steps); /* the file of the step that was added last */
const struct step *steps_find(const struct steps *steps, const char *file);

/* ---- steps_run.c ----------------------------------------------------------------------------- */

/* Writes build.ninja and `commands`, and runs ninja. Failed steps are found by their results. */
bool steps_run(struct steps *steps);
/* Number of steps without a result. Logs an error for each that failed itself; with --collect, only
 * the number. */
uint32_t steps_count_failures(const struct steps *steps);
bool steps_is_done(const struct steps *steps, const struct step *step);
/* Why a step, or one that it needs, has no result; NULL when it has; free(). */
char *steps_reason(const struct steps *steps, const char *file);
/* Parsed JSON of a step's file; NULL or NaN when the step failed. */
const cJSON *steps_result(struct steps *steps, const char *file);
double steps_number(struct steps *steps, const char *file, const char *path); /* a.b.c */

#endif
