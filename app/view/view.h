/* Shared by the files of `diptych view`: the window and its state. view.c runs the frames. */
#pragma once

#include <GLFW/glfw3.h>
#include <pthread.h>
#include <stdatomic.h>

#include "console/options.h"
#include "spec/reload.h"
#include "result/difference.h"
#include "picture/picture.h"
#include "run/session.h"
#include "run/undefined.h"
#include "runtime_gl/window.h"
#include "view/overlay.h"

enum { VIEW_SIDES = OVERLAY_SIDES, VIEW_TIMED_FRAMES = 256, VIEW_UNDOS = 256 };

/* Times of the last frames, in a ring. */
struct view_times {
    uint32_t passes, frames;            /* frames so far, also those that are overwritten */
    double *pass_ms;                    /* VIEW_TIMED_FRAMES x passes; owned */
    double frame_ms[VIEW_TIMED_FRAMES]; /* NAN: the frame was checked, which takes time, too */
};

/* Whether the sides agree: all that passes write in a frame, under the spec's contracts. */
struct view_verdict {
    struct rows rows;
    struct dt_bytes *kept; /* per row of rows.outputs: the first side's, while a frame is checked */
    enum overlay_mark *marks; /* per row */
    bool known, stale;
    bool checking;             /* this frame */
    char text[256];            /* "" while there are not two sides */
    enum overlay_mark worst;   /* of all rows */
    uint32_t first;            /* row that differs; rows.outputs.count: none */
    struct difference largest; /* of that row */
    uint32_t side;             /* that differs from the first there */
    bool wanted;               /* the picture stands still */
    char *why;                 /* of the difference in the row `first`; owned */
    char *undefined;           /* --sanitize: what was found, a line each; NULL: not known; owned */
    double checked, cost;      /* end of the last check, and how long it took, in milliseconds */
};

/* The parameters as the user has them. */
struct view_params {
    struct overlay_param *list; /* owned, like the next two */
    uint32_t count;
    double (*kept)[4];  /* per parameter: as of the last edit that ended */
    double (*other)[4]; /* the other setting, A or B */
    char slot;
    bool quiet; /* the next changes are no edits to undo */
    struct view_edit {
        char name[64];
        double value[4]; /* before */
    } undo[VIEW_UNDOS];
    uint32_t undo_count;
};

/* Messages, for the lower pane. */
struct view_log {
    struct dt_log before; /* the console's own, which gets them, too */
    pthread_mutex_t lock; /* of the next two */
    char *text;
    uint32_t lines;
    char *seen; /* a copy for the overlay, with that many lines */
    uint32_t seen_lines;
};

/* A backend at work. */
struct view_side {
    struct session session;
    struct view_times times;
    struct dt_bytes shown;  /* content of the shown resource after the last frame; owned */
    struct picture picture; /* of what is shown; no codes while `direct` */
};

struct view {
    struct console *console;
    struct options own; /* with the size of an input */
    const struct options *options;
    struct sides sides;
    bool backend_given;
    struct pipeline pipeline;
    struct scene scene; /* its camera flies */
    struct view_side side[VIEW_SIDES];
    uint32_t side_count;
    struct gl_window *screen; /* what OpenGL draws, in its window: */
    GLFWwindow *window;
    struct overlay *overlay;
    struct overlay_settings settings;
    struct view_verdict verdict;
    struct view_params params;
    struct view_log log;
    pthread_t bisector; /* joined at the end, or before the next */
    bool bisected;
    atomic_bool bisecting;
    struct reload *reload;
    bool reloading;
    uint32_t losses;      /* of devices */
    uint32_t loss_frames; /* `frames` at the last loss */
    bool gave_up;         /* paused, since the device was lost twice: probably by a pass */
    bool noisy;           /* a closed side had validation messages */
    char *error;          /* of the last reload; NULL: none; owned */
    uint32_t reloads;
    double reload_ms; /* of the last reload, from the saved file to its first picture; NAN: none */
    double device_ms; /* of that, for programs and memory */

    uint32_t home; /* resource, usually the display output */
    struct overlay_shown shown;

    /* As of the last frame. */
    bool direct;      /* textures are display outputs as they were read, row 0 at the bottom */
    uint32_t size[2]; /* of the pipeline's frame */
    struct dt_view camera;
    uint32_t window_size[2], fitted[2]; /* fitted: of the window that the frame's size is for */
    uint32_t frame;                     /* index of the next one, since the pipeline was made */
    double start;                       /* of frame 0 */
    uint32_t frames;                    /* so far */
    double time;                        /* start of the last frame, in seconds */

    /* Wishes of the user, carried out between frames. */
    bool paused, step; /* step: one frame while paused */
    bool quit;
    unsigned wishes; /* of enum overlay_wish */
    bool moving;     /* camera and light follow the motion */
    uint32_t moment; /* frame of the motion that comes next, and the one that is shown */
    uint32_t present_moment;
    double mouse[2]; /* last position of the mouse */
    bool looking, orbiting;
    uint32_t tapped;    /* letters pressed since the last frame, even if released; A: lowest bit */
    unsigned commanded; /* letters pressed with Ctrl and still held */
    float speed;        /* scene radii per second */
};

/* ---- view.c ---------------------------------------------------------------------------------- */

bool view_render(struct view *view); /* a frame on every side, and its pictures */
/* Opens one side's device, scene and pipeline. */
bool view_open_side(struct view *view, uint32_t index);
/* Window and overlay. A size of 0: as options, settings and screen say. */
bool view_open_window(struct view *view, int width, int height);
void view_close_window(struct view *view);               /* also takes a closed one */
void view_close_side(struct view *view, uint32_t index); /* also takes a closed one */
/* Shows the window. `photo`: see gl_window_end. */
bool view_present(struct view *view, struct dt_bytes *photo);

/* ---- view_revive.c --------------------------------------------------------------------------- */

/* After a failure: reopens lost devices, and the window. False when none was lost, or it does not come back. */
bool view_revive(struct view *view);

/* ---- view_input.c ---------------------------------------------------------------------------- */

void view_input_open(struct view *view);                /* callbacks of the window */
void view_input_fly(struct view *view, double seconds); /* keys that are held */

/* ---- view_overlay.c -------------------------------------------------------------------------- */

bool view_times_create(struct view *view); /* for the present pipeline */
void view_times_free(struct view_times *times);
bool view_times_take(struct view_side *side, double frame_ms); /* after its frame */
bool view_overlay_build(struct view *view); /* applies the user's changes of parameters */
void view_tell(struct view *view); /* for --json: frames, and median times of the last ones */

/* ---- view_reload.c --------------------------------------------------------------------------- */

/* Swaps in a newly made pipeline, if there is one. False when neither runs. */
bool view_reload(struct view *view);
void view_set_live(struct view *view, const struct dt_param *param, const double values[4]);

/* ---- view_verdict.c -------------------------------------------------------------------------- */

bool view_verdict_create(struct view *view); /* for the present pipeline; nothing is known */
void view_verdict_free(struct view_verdict *verdict);
/* Before a frame: whether it is to be checked. Checks take at most a third of the time. */
void view_verdict_begin(struct view *view);
/* After that pass of that side, in a frame that is checked. */
bool view_verdict_take(struct view *view, uint32_t side, uint32_t pass);
bool view_verdict_end(struct view *view); /* after the frame */
void view_show_first(struct view *view);  /* the first difference, at its largest texel */

/* ---- view_params.c --------------------------------------------------------------------------- */

/* For the present pipeline; what the user changed stays, by name. */
bool view_params_create(struct view *view);
void view_params_free(struct view_params *params);
bool view_params_apply(struct view *view); /* after the user's edits; false: out of memory */
void view_params_set(struct view *view, const char *name, double value);
void view_params_undo(struct view *view);
void view_params_swap(struct view *view); /* settings A and B */
/* Edits as `before` NAME=VALUE `after`, one behind the other; those of live or of other parameters,
 * or both. free(); NULL: out of memory. */
char *view_params_text(const struct view *view, const char *before, const char *after, bool live,
                       bool baked);

/* ---- view_save.c ----------------------------------------------------------------------------- */

/* Carries out the wishes to save, with the first free name. Errors are logged and ignored. */
void view_save(struct view *view, unsigned wishes);
/* Writes what is seen in the window as PNG. */
bool view_photograph(struct view *view, const char *path);
void view_bisect(struct view *view); /* in a process of its own */
void view_bisect_end(struct view *view);
void view_settings_read(struct overlay_settings *settings);
void view_settings_write(const struct view *view);
void view_log_open(struct view *view); /* from now on, messages are kept, too */
void view_log_close(struct view *view);

/* ---- view_picture.c -------------------------------------------------------------------------- */

bool view_find_home(struct view *view); /* and shows it */
/* Something that a pass writes, or an input. */
bool view_can_show(const struct dt_pipeline *info, uint32_t resource);
/* The last pass that writes that mip; pass_count: none does. */
uint32_t view_last_writer(const struct dt_pipeline *info, uint32_t resource, uint32_t mip);
/* After its last pass; layer and mip go back to the first. */
void view_show(struct view *view, uint32_t resource);
uint32_t view_mips(const struct view *view);
uint32_t view_layers(const struct view *view);

void view_forget(struct view_side *side); /* what was read, and its picture */
/* Reads what is shown now, if the frame did not. */
bool view_read(const struct view *view, struct view_side *side);
/* The bytes of the layer that is shown, or of all; borrowed. */
struct dt_bytes view_layer(const struct view *view, const struct view_side *side);

/* Makes the window's textures from the results of the last frame. */
bool view_pictures(struct view *view);
/* Writes the picture, without what is around it, as PNG. */
bool view_write_png(struct view *view, const char *path);
