/* Shared by the files of `diptych view`: the window and its state. view.c runs the frames. */
#ifndef DIPTYCH_VIEW_H
#define DIPTYCH_VIEW_H

#include <GLFW/glfw3.h>

#include "console/options.h"
#include "spec/reload.h"
#include "result/picture.h"
#include "run/session.h"
#include "view/overlay.h"
#include "view/points.h"

enum { VIEW_SIDES = 2, VIEW_MAX_POINTS = 8, VIEW_MAX_SOURCES = 4, VIEW_TIMED_FRAMES = 256 };

/* How two sides are shown. */
enum view_mode {
    VIEW_PANELS,     /* each whole, side by side */
    VIEW_CURTAIN,    /* one picture: the left half of the first, the right half of the second */
    VIEW_DIFFERENCE, /* one picture: the amplified difference */
    VIEW_MODES
};

/* Points shown together: elements of one buffer or more. */
struct view_points {
    char *name; /* owned */
    struct point_source sources[VIEW_MAX_SOURCES];
    uint32_t count;
};

/* Times of the last frames, in a ring. */
struct view_times {
    uint32_t passes, frames; /* frames so far, also those that are overwritten */
    double *pass_ms;         /* VIEW_TIMED_FRAMES x passes; owned */
    double frame_ms[VIEW_TIMED_FRAMES];
};

/* A backend at work. The first one has the window. */
struct view_side {
    struct session session;
    struct view_times times;
    struct dt_bytes shown; /* content of the shown resource after the last frame; owned */
    /* content of the buffers and labels of shown points, by source; owned */
    struct dt_bytes elements[VIEW_MAX_SOURCES], labels[VIEW_MAX_SOURCES];
    struct picture picture; /* its picture; no codes while copied on the device */
};

struct view {
    struct console *console;
    struct options own; /* with the size of an input */
    const struct options *options;
    struct sides sides;
    struct pipeline pipeline;
    struct scene scene; /* its camera flies */
    struct view_side side[VIEW_SIDES];
    uint32_t side_count;
    GLFWwindow *window;
    struct overlay *overlay;
    bool overlay_hidden;
    struct reload *reload;
    bool reloading;
    uint32_t losses;      /* of devices */
    uint32_t loss_frames; /* `frames` at the last loss */
    bool gave_up;         /* paused, since the device was lost twice: probably by a pass */
    bool noisy;           /* a closed side had validation messages */
    char *error;          /* of the last reload; NULL: none; owned */
    bool outline_wrong;   /* the error is of the outline; the pipeline is the new one */
    uint32_t reloads;
    double reload_ms; /* of the last reload, from the saved file to its first picture; NAN: none */
    double device_ms; /* of that, for programs and memory */

    /* What is shown. */
    uint32_t home;     /* usually the display output */
    uint32_t resource; /* an image of the pipeline */
    int layer;         /* its layer; -1: all, as a sheet */
    uint32_t mip;
    enum view_mode mode;
    float gain;            /* of the difference */
    uint32_t shown_points; /* counted from 1; 0: none */

    /* From the pipeline's outline. */
    const struct dt_param *digits; /* parameter set by the keys 0 to 9; NULL: none */
    struct view_points points[VIEW_MAX_POINTS];
    uint32_t points_count;

    /* As of the last frame. */
    bool direct; /* the first side's texture is a copy of its display output, row 0 at the bottom */
    uint32_t size[2]; /* of the pipeline's frame */
    struct dt_view camera;
    uint32_t window_size[2];
    uint32_t frame;  /* index of the next one, since the pipeline was made */
    double start;    /* of frame 0 */
    uint32_t frames; /* so far */
    double time;     /* start of the last frame, in seconds */

    /* Wishes of the user, carried out between frames. */
    bool paused, step; /* step: one frame while paused */
    bool screenshot, save_camera, quit;
    double mouse[2]; /* last position of the mouse */
    bool looking;
    uint32_t tapped;    /* letters pressed since the last frame, even if released; A: lowest bit */
    unsigned commanded; /* letters pressed with Ctrl and still held */
    float speed;        /* scene radii per second */
};

/* ---- view.c ---------------------------------------------------------------------------------- */

bool view_render(struct view *view); /* a frame on every side, and its pictures */
/* Opens one side's device, scene and pipeline; for the first side also window and overlay. */
bool view_open_side(struct view *view, uint32_t index);
bool view_open_window(struct view *view, int width, int height);
void view_close_side(struct view *view, uint32_t index); /* also takes a closed one */

/* ---- view_revive.c --------------------------------------------------------------------------- */

/* After a failure: reopens lost devices. False when none was lost, or it does not come back. */
bool view_revive(struct view *view);

/* ---- view_input.c ---------------------------------------------------------------------------- */

void view_input_open(struct view *view);                /* callbacks of the window */
void view_input_fly(struct view *view, double seconds); /* keys that are held */

/* ---- view_overlay.c -------------------------------------------------------------------------- */

bool view_times_create(struct view *view); /* for the present pipeline */
void view_times_free(struct view_times *times);
bool view_times_take(struct view_side *side, double frame_ms); /* after its frame */
/* Whether the last pass that writes the resource was skipped in the last frame. */
bool view_is_skipped(const struct view *view, const struct view_side *side, uint32_t resource);
bool view_overlay_build(struct view *view); /* applies the user's changes of parameters */
void view_tell(const struct view *view); /* for --json: frames, and median times of the last ones */

/* ---- view_reload.c --------------------------------------------------------------------------- */

/* Swaps in a newly made pipeline, if there is one. False when neither runs. */
bool view_reload(struct view *view);
void view_set_live(struct view *view, const struct dt_param *param, const double values[4]);

/* ---- view_outline.c -------------------------------------------------------------------------- */

/* Reads the outline of view->pipeline. False with the error logged: then it offers nothing. */
bool view_outline_read(struct view *view);
void view_outline_forget(struct view *view);

/* ---- view_picture.c -------------------------------------------------------------------------- */

bool view_find_home(struct view *view); /* and shows it */
/* An image that some pass writes can be shown. */
bool view_can_show(const struct dt_pipeline *info, uint32_t resource);
/* The last pass that writes that mip; pass_count: none does. */
uint32_t view_last_writer(const struct dt_pipeline *info, uint32_t resource, uint32_t mip);
void view_show(struct view *view, uint32_t resource); /* its layer and mip go back to the first */
uint32_t view_mips(const struct view *view);
uint32_t view_layers(const struct view *view);

/* Call after that pass: reads the shown resource, and points, when the pass is the last to write
 * them. */
bool view_take(const struct view *view, struct view_side *side, uint32_t pass);
void view_forget(struct view_side *side); /* what was read, and its picture */

/* Makes the window's textures from the results of the last frame. */
bool view_pictures(struct view *view);
/* Lays them out; appends to vertices and draws. Returns the number of draws. */
enum { VIEW_MAX_DRAWS = 4 };
uint32_t view_layout(const struct view *view, struct dt_window_vertex vertices[6 * VIEW_MAX_DRAWS],
                     struct dt_window_draw draws[VIEW_MAX_DRAWS]);
/* Writes the picture, without overlay, as PNG. */
bool view_write_png(struct view *view, const char *path);

/* Rectangle of one side's picture in the window, in pixels. */
void view_panel_size(const struct view *view, uint32_t size[2]);

#endif
