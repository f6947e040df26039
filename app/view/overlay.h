/* The panel over the picture: times, parameters, the image shown, errors. C interface to Dear
 * ImGui: build describes the panel anew in every frame, and the window's runtime draws its
 * triangles. */
#ifndef DIPTYCH_OVERLAY_H
#define DIPTYCH_OVERLAY_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { OVERLAY_SIDES = 2 };

struct overlay_pass {
    const char *name;
    const char *doc;
    double ms[OVERLAY_SIDES]; /* NAN: skipped */
};

struct overlay_param {
    const char *name;
    const char *doc;
    bool is_bool;
    bool is_whole;
    uint32_t count;  /* of numbers, at most 4 */
    double value[4]; /* in and out */
    double initial[4];
    double min, max, step; /* as in struct dt_param */
    bool changed;          /* out */
};

struct overlay_model {
    bool hidden; /* all but the error */
    const char *title;
    const char *shown;  /* the resource and which part of it */
    const char *doc;    /* its description, or "" */
    const char *state;  /* paused, reloading, ..., or "" */
    const char *points; /* points that are shown, or "" */
    const char *error;  /* of a reload that failed; NULL: none */
    const char *error_title;
    const char *const *sides;
    double frame_ms[OVERLAY_SIDES];
    uint32_t side_count;
    const struct overlay_pass *passes;
    uint32_t pass_count;
    struct overlay_param *params;
    uint32_t param_count;
};

struct overlay;

/* For a GLFWwindow; set its own callbacks before. NULL when out of memory. */
struct overlay *overlay_open(void *window);
void overlay_close(struct overlay *overlay); /* takes NULL; before the window goes */

/* The texture that its draws name 0: RGBA8; lives as long as the overlay. */
const uint8_t *overlay_atlas(struct overlay *overlay, uint32_t *width, uint32_t *height);

/* Builds the panel of a frame; the user's input changes the model's params. */
void overlay_build(struct overlay *overlay, struct overlay_model *model);
/* The last one's triangles, in pixels of the window; live until the next build. */
struct dt_window_frame overlay_frame(const struct overlay *overlay);

/* Whether the panel, not the camera, takes mouse or keys now. */
bool overlay_takes_mouse(const struct overlay *overlay);
bool overlay_takes_keys(const struct overlay *overlay);

#ifdef __cplusplus
}
#endif

#endif
