/* What the files of `diptych view` share: the window and what is shown in it. Called by nobody
 * else. view.c runs the frames; see the heads of the others. */
#ifndef DIPTYCH_VIEW_H
#define DIPTYCH_VIEW_H

#include <GLFW/glfw3.h>

#include "build/reload.h"
#include "result/picture.h"
#include "run/session.h"
#include "view/overlay.h"
#include "view/points.h"
#include "view/warm.h"

enum { VIEW_SIDES = 2, VIEW_MAX_POINTS = 8, VIEW_MAX_SOURCES = 4, VIEW_TIMED_FRAMES = 256 };

/* How two sides are shown. */
enum view_mode {
    VIEW_PANELS,     /* each whole, side by side */
    VIEW_CURTAIN,    /* one picture: the left half of the first, the right half of the second */
    VIEW_DIFFERENCE, /* one picture: how far they are apart, amplified */
    VIEW_MODES
};

/* Points that one wish shows: elements of one buffer or more. */
struct view_points {
    char *name; /* owned */
    struct point_source sources[VIEW_MAX_SOURCES];
    uint32_t count;
};

/* Of the last frames, in turn. */
struct view_times {
    uint32_t passes, frames; /* frames so far, also those that are overwritten */
    double *pass_ms;         /* VIEW_TIMED_FRAMES x passes; owned */
    double frame_ms[VIEW_TIMED_FRAMES];
};

/* A backend at work. The first one has the window. */
struct view_side {
    struct session session;
    struct view_times times;
    struct dt_bytes shown; /* what the last frame left in the resource shown; owned */
    /* and in the buffers of the points shown: of each source its own, and its labels; owned */
    struct dt_bytes elements[VIEW_MAX_SOURCES], labels[VIEW_MAX_SOURCES];
    struct picture picture; /* the same for looking at; without codes while copied directly */
};

struct view {
    struct console *console;
    const struct options *options;
    struct sides sides;
    struct pipeline pipeline;
    struct scene scene; /* its camera flies */
    struct view_side side[VIEW_SIDES];
    uint32_t side_count;
    GLFWwindow *window;
    struct overlay *overlay;
    bool overlay_hidden;
    struct warm *warm; /* NULL: the driver needs none, or there is no processor to spare */
    struct reload *reload;
    bool reloading;
    uint32_t losses;      /* of devices */
    uint32_t loss_frames; /* what `frames` was at the last one */
    bool gave_up;         /* paused since the device was lost once more: by a pass, it seems */
    bool noisy;           /* a side that is closed has heard validation messages */
    char *error;          /* of the last reload, NULL: it went well; owned */
    bool outline_wrong;   /* that is the error, and the pipeline is the new one */
    uint32_t reloads;
    double reload_ms; /* of the last one, from the saved file to its first picture; NAN: none */
    double device_ms; /* of it, programs and memory; then comes the frame */

    /* What is shown. */
    uint32_t home;     /* the display output, mostly */
    uint32_t resource; /* an image of the pipeline */
    int layer;         /* of it; -1: all of them, as a sheet */
    uint32_t mip;
    enum view_mode mode;
    float gain;            /* of the difference */
    uint32_t shown_points; /* counted from 1; 0: none */

    /* What the pipeline's outline offers. */
    const struct dt_param *digits; /* set by the keys 0 to 9; NULL: nothing is */
    struct view_points points[VIEW_MAX_POINTS];
    uint32_t points_count;

    /* As of the last frame. */
    bool direct; /* the first side's texture is a copy of its display output, row 0 at the bottom */
    uint32_t size[2]; /* of the pipeline's frame */
    struct dt_view camera;
    uint32_t window_size[2];
    uint32_t frame;  /* index of the next one, since the pipeline was made */
    uint32_t frames; /* so far */
    double time;     /* seconds, when the last frame began */

    /* Wishes of the user, carried out between frames. */
    bool paused, step; /* step: one more frame all the same */
    bool screenshot, save_camera, quit;
    double mouse[2]; /* where it was last */
    bool looking;
    uint32_t
        tapped; /* letters pressed since the last frame, also those that were let go, A the lowest bit */
    unsigned commanded; /* letters pressed with Ctrl and not let go of yet */
    float speed;        /* scene radii per second */
};

/* ---- view.c ---------------------------------------------------------------------------------- */

bool view_render(struct view *view); /* a frame on every side, and its pictures */
void view_warm(struct view *view);   /* begins with view->pipeline, whose first frame comes */
/* One side's device, scene and pipeline; the first one's window, and what stands over the picture. */
bool view_open_side(struct view *view, uint32_t index);
bool view_open_window(struct view *view, int width, int height);
void view_close_side(struct view *view, uint32_t index); /* takes one that is not open */

/* ---- view_revive.c --------------------------------------------------------------------------- */

/* After something failed: opens those devices anew that were lost. False when it was not that, or the
 * device does not come back. */
bool view_revive(struct view *view);

/* ---- view_input.c ---------------------------------------------------------------------------- */

void view_input_open(struct view *view);                /* callbacks of the window */
void view_input_fly(struct view *view, double seconds); /* keys that are held */

/* ---- view_overlay.c -------------------------------------------------------------------------- */

bool view_times_create(struct view *view); /* for the present pipeline */
void view_times_free(struct view_times *times);
bool view_times_take(struct view_side *side, double frame_ms); /* after its frame */
/* Whether the pass that writes the resource last was left out of the last frame. */
bool view_is_skipped(const struct view *view, const struct view_side *side, uint32_t resource);
bool view_overlay_build(struct view *view); /* takes what the user's hand changes */
void view_tell(const struct view *view); /* for --json: frames, and median times of the last ones */

/* ---- view_reload.c --------------------------------------------------------------------------- */

/* Takes what was made anew, if anything was. False when nothing can run any more. */
bool view_reload(struct view *view);
const struct dt_panel *view_panel_of(const struct view_side *side, const struct pipeline *pipeline);
void view_set_live(struct view *view, const struct dt_param *param, const double values[4]);

/* ---- view_outline.c -------------------------------------------------------------------------- */

/* Of view->pipeline. False, with the error logged, when it is wrong: then nothing is offered. */
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

/* The pipeline's display output, shown from device memory as it is. */
bool view_is_direct(const struct view *view);

/* To be called after that pass: reads what is shown, and points, where it is the last to write
 * them. */
bool view_take(const struct view *view, struct view_side *side, uint32_t pass);
void view_forget(struct view_side *side); /* what was read, and its picture */

/* Of what the last frame left: the window's textures. */
bool view_pictures(struct view *view);
/* Where they come to stand; appends to vertices and draws. Returns how many draws there are. */
enum { VIEW_MAX_DRAWS = 4 };
uint32_t view_layout(const struct view *view, struct dt_window_vertex vertices[6 * VIEW_MAX_DRAWS],
                     struct dt_window_draw draws[VIEW_MAX_DRAWS]);
/* What is shown, without overlay, as PNG. */
bool view_write_png(struct view *view, const char *path);

/* Which part of the window one side's picture has, in pixels. */
void view_panel_size(const struct view *view, uint32_t size[2]);

#endif
