/* The window's panes: the verdict, passes and resources, the picture, parameters, errors and log. C
 * interface to Dear ImGui: build describes all of it anew in every frame, and the window's runtime
 * draws its triangles. */
#pragma once

#include "diptych.h"
#include "picture/picture.h"
#include "result/rows.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { OVERLAY_SIDES = 3 };

/* How the sides are shown. */
enum overlay_mode {
    OVERLAY_PANELS,     /* each whole, side by side */
    OVERLAY_CURTAIN,    /* one picture, of each side its part of the width */
    OVERLAY_DIFFERENCE, /* the amplified difference of the first and each of the others */
    OVERLAY_MODES
};

/* What is shown, and how. */
struct overlay_shown {
    uint32_t pass; /* after which it is read */
    uint32_t resource;
    int layer; /* -1: all, as a sheet */
    uint32_t mip;
    struct picture_look look;
    enum overlay_mode mode;
    float gain; /* of the difference */
    bool marked;
    uint64_t texel; /* that is marked, or element of a buffer; counted through all layers */
};

struct overlay_side {
    const char *label, *device;
    const double *pass_ms; /* NAN: skipped; NULL: no frame yet */
    double frame_ms;
    const struct dt_bytes *bytes; /* of the shown resource, all layers; no data: not read */
    unsigned texture;             /* OpenGL's name of its picture */
    bool flipped;                 /* the texture's row 0 is at the bottom */
};

/* A number of the pipeline that the user may change. */
struct overlay_param {
    const char *name;
    const char *doc;
    bool live; /* else the plan is made again */
    bool is_bool;
    bool is_whole;
    uint32_t count;        /* of numbers, at most 4 */
    double value[4];       /* in and out */
    double initial[4];     /* as the spec and the command line have it */
    double min, max, step; /* as in struct dt_param */
};

enum overlay_mark { OVERLAY_UNKNOWN, OVERLAY_EQUAL, OVERLAY_WITHIN, OVERLAY_DIFFERS };

/* What the user asks for; bits. */
enum overlay_wish {
    OVERLAY_STEP = 1 << 0,   /* a frame, also while paused */
    OVERLAY_REDRAW = 1 << 1, /* the same frame, with another look */
    OVERLAY_UNDO = 1 << 2,
    OVERLAY_SWAP = 1 << 3,  /* settings A and B */
    OVERLAY_FIRST = 1 << 4, /* show the first difference */
    OVERLAY_FIT = 1 << 5,   /* the range to the numbers shown */
    OVERLAY_PAUSE = 1 << 6,
    OVERLAY_SAVE_PNG = 1 << 7,
    OVERLAY_SAVE_EXR = 1 << 8,
    OVERLAY_SAVE_NPY = 1 << 9,
    OVERLAY_SAVE_SETS = 1 << 10,
    OVERLAY_SAVE_CAMERA = 1 << 11,
    OVERLAY_BISECT = 1 << 12,
    OVERLAY_ALONE = 1 << 13, /* with OVERLAY_STEP: and pause */
};

/* Kept for the user from one window to the next; lengths in pixels of a screen of usual density. */
struct overlay_settings {
    float left, right, bottom; /* sizes of the panes */
    float font;
    bool left_folded, right_folded, bottom_folded;
    bool hidden; /* all but the picture, and errors */
    int window[2];
};

struct overlay_model {
    struct overlay_settings *settings; /* in and out, like the next two */
    struct overlay_shown *shown;
    struct overlay_param *params;
    uint32_t param_count;
    const char *title;
    const char *verdict; /* "" while there is none */
    enum overlay_mark mark;
    bool stale;                        /* the verdict is of an earlier state */
    const enum overlay_mark *row_mark; /* of rows->outputs */
    const struct dt_pipeline *info;
    const struct rows *rows;
    struct overlay_side sides[OVERLAY_SIDES];
    uint32_t side_count;
    uint32_t extent[3]; /* of the shown resource: its mip, all layers */
    const char *state;  /* paused, reloading, ..., or "" */
    const char *error;  /* of a reload that failed; NULL: none */
    const char *error_title;
    const char *why;       /* lines: what would make the sides equal; NULL or "": not known */
    const char *undefined; /* lines of --sanitize; NULL: without it */
    const char *log;       /* lines */
    uint32_t log_size;     /* grows with every line, also when old ones go */
    const char *changes;   /* --set NAME=VALUE ..., or "" */
    char slot;             /* 'A' or 'B' */
    bool paused;
    uint32_t moments; /* frames of the motion; 0: nothing moves */
    uint32_t *moment; /* the present one; in and out, like the next */
    bool *moving;
    unsigned wishes; /* out: of enum overlay_wish */
};

struct overlay;

/* For a GLFWwindow, whose OpenGL context is current in the calls of this file; set its own callbacks
 * before. NULL when out of memory, or without libGL. */
struct overlay *overlay_open(void *window);
void overlay_close(struct overlay *overlay); /* before the window goes */

/* Makes the fonts in that size, if it is another than before. */
void overlay_fonts(struct overlay *overlay, float size);

/* Builds the window of a frame; what the user did is in the model afterwards. */
void overlay_build(struct overlay *overlay, struct overlay_model *model);
void overlay_draw(const struct overlay *overlay); /* what was built last */

/* Of the last build: the room for each side's picture, in pixels. */
void overlay_room(const struct overlay *overlay, uint32_t size[2]);
void overlay_whole_picture(struct overlay *overlay); /* ends a zoom */
void overlay_keys(struct overlay *overlay);          /* shows what the keys do */

/* Whether the panes, not the camera, take mouse or keys now. */
bool overlay_takes_mouse(const struct overlay *overlay);
bool overlay_takes_keys(const struct overlay *overlay);
bool overlay_is_editing(const struct overlay *overlay);  /* a slider is held, a number is typed */
bool overlay_is_pointing(const struct overlay *overlay); /* at a texel of the picture */

#ifdef __cplusplus
}
#endif
