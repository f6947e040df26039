/* A folder of measurements: commands of diptych, each an edge of a ninja file there, one at a time, so that what was
 * interrupted goes on where it was and only what has changed is done again. Called by the verbs that make pages and tables of
 * what the commands wrote: report*.c, sweep_grid.c, and by measure.c, which plans for both. */
#ifndef DIPTYCH_STEPS_H
#define DIPTYCH_STEPS_H

#include <cjson/cJSON.h>
#include <stdio.h>

#include "base/console.h"
#include "base/options.h"
#include "run/side.h"

struct step_scene {
    char *path; /* of the scene file, absolute */
    char *name; /* of its folder: the file's, without .yaml */
    char *mesh; /* NULL: not here, and the scene is left out */
};

/* One command, an edge of the ninja file. */
struct step {
    const struct step_scene *scene;
    int part;             /* as its planner tells steps apart */
    char *file;           /* in the folder, that the command writes last; its name is the step's */
    const char *needs[2]; /* files of other steps, or NULL */
    char *motion;         /* file, absolute, or NULL */
    bool traced;          /* no matter of the spec */
    const char *verb;     /* whose durations are alike */
    char *command;        /* a line for /bin/sh that can be pasted anywhere */
};

struct steps {
    struct console *console;
    const struct options *options;
    const char *verb; /* whose folder it is */
    struct sides sides;
    char *folder;        /* absolute */
    char *program;       /* this executable */
    char *spec;          /* absolute */
    cJSON *spec_files;   /* absolute paths: the spec and all that it takes in */
    char *scenes_folder; /* absolute, or NULL */
    struct step_scene *scenes;
    uint32_t scene_count;
    struct step *list;
    uint32_t count;
    cJSON *results; /* of file names, what the files hold */
};

/* ---- steps.c: preparing, in this order; each logs its error. steps_free at the end, of a zeroed one, too -------- */

/* The spec, the sides, this program, the folder of meshes. */
bool steps_begin(struct steps *steps, const char *verb, struct console *console,
                 const struct options *options);
/* The scenes, of which one at least must have its mesh. */
bool steps_find_scenes(struct steps *steps, const char *const *paths, uint32_t count);
/* The generator's word on the spec and the overrides, before hours of work. */
bool steps_check_spec(struct steps *steps);
/* A new folder, an empty one, or one of the same verb. */
bool steps_make_folder(struct steps *steps);
void steps_free(struct steps *steps);

/* A word that can be the name of a file. */
bool step_is_name(const char *text);
/* A member's text; "" where it is not. */
const char *step_text(const cJSON *object, const char *name);

/* ---- steps.c: planning ----------------------------------------------------------------------- */

/* A command on its way into a step. */
struct command {
    const struct steps *steps;
    const char *verb;
    FILE *out;
    char *text;
    size_t size;
};

bool command_begin(struct command *command, const struct steps *steps, const char *verb);
void command_file(struct command *command, const char *option, const char *file);
void command_scene(struct command *command, const struct step_scene *scene);
void command_size(struct command *command, const uint32_t size[2]);
/* The spec, with these values set; those of the command line stand last, and win. `sets`: or NULL */
void command_spec(struct command *command, const cJSON *sets);
void command_backends(struct command *command);
void command_quality(struct command *command); /* of a reference */
void command_frames(struct command *command);  /* of bench */

/* Takes over step->file, and the command's text. */
bool steps_add(struct steps *steps, const struct step *step, struct command *command);
const char *steps_last(const struct steps *steps); /* the file of the step that was added last */
const struct step *steps_find(const struct steps *steps, const char *file);

/* ---- steps_run.c ----------------------------------------------------------------------------- */

/* Writes build.ninja and `commands`, and does what is to be done; what has failed is in the results. */
bool steps_run(struct steps *steps);
/* How many steps have no result; logs an error for each that failed by itself, with --collect how many there are. */
uint32_t steps_count_failures(const struct steps *steps);
bool steps_is_done(const struct steps *steps, const struct step *step);
/* Why a step, or one that it needs, has no result; NULL when it has; free(). */
char *steps_reason(const struct steps *steps, const char *file);
/* What a step's file holds, JSON; NULL or NaN where it has failed. */
const cJSON *steps_result(struct steps *steps, const char *file);
double steps_number(struct steps *steps, const char *file, const char *path); /* a.b.c */

#endif
