/* Plays pipelines of diptych in other programs, without a renderer of their own: reads a spec at run
 * time, compiles its shaders, opens a device, and hands out results as bytes. The Python
 * package diptych is the same for Python. A renderer uses diptych_vk.h or diptych_gl.h instead.
 *
 *     struct dt_player *player = dt_play_open(&(struct dt_play_options){
 *         .log = log, .spec = "fog.yaml", .backend = "vk", .scene = "cornell.yaml",
 *         .width = 640, .height = 360});
 *     struct dt_bytes bytes;
 *     dt_play_set(player, "reach", "0.2");
 *     dt_play_render(player, NULL, NULL);
 *     dt_play_read(player, "picture", 0, &bytes);
 *     free(bytes.data);
 *     dt_play_close(player);
 *
 * Errors. A function that returns false or NULL has logged one DT_ERROR with the reason; for a wrong
 * spec, the text of diptych-gen with all errors. With NULL in place of the player it does nothing.
 * After a failed render, call only close. There is no
 * other output, no exit, and no change of the environment, where "zink" needs GALLIUM_DRIVER=zink. With
 * `debug`, each message of the validation layers or of KHR_debug is a DT_ERROR, too, and fails the render.
 *
 * Threads. The thread that opened a player uses it; dt_play_open and dt_play_close are for one thread at
 * a time. A child of fork() cannot use the players of its parent: their functions fail there, and close
 * does nothing. A pipeline of `file` pictures, or a scene with textures, is read by a child process of fork(). */
#ifndef DIPTYCH_PLAYER_H
#define DIPTYCH_PLAYER_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the library exports */

/* Strings are borrowed for the call of open. */
struct dt_play_options {
    struct dt_log log; /* message NULL: no log; may be called from threads of a driver */
    const char *spec;
    const char
        *backend;       /* as --backend takes one: "gl", "vk", "vk@DEVICE", "gl+glsl"; NULL: "vk" */
    const char *scene;  /* scene file; NULL: no pass uses the scene */
    const char *meshes; /* folder of meshes; NULL: DIPTYCH_SCENES, or beside the scene file */
    const char *const *sets; /* PATH=VALUE, as --set takes them */
    uint32_t set_count;
    const char *const *inputs; /* NAME=FILE, as --input takes them; others come by dt_play_write */
    uint32_t input_count;
    uint32_t width, height; /* of the frame; 0: that of an input of `inputs`, else 1920x1080 */
    bool debug;             /* validation layers, KHR_debug */
    bool timing;            /* timestamps around every pass, for dt_play_timings */
    bool keep_history;      /* dt_play_resize keeps that of resources whose size is the same */
    /* kinds of undefined behaviour to look for, as --sanitize takes them; "": all; NULL: none */
    const char *sanitize;
};

struct dt_player;

struct dt_player *dt_play_open(const struct dt_play_options *options);
/* Takes NULL. Within after_pass it does nothing but log an error. */
void dt_play_close(struct dt_player *player);

/* Parameters, resources, passes and outputs: JSON of `diptych list --json`, with "backend" and
 * "device". Valid until the next describe or close. NULL: out of memory. */
const char *dt_play_describe(struct dt_player *player);

/* Sets a live parameter from the next frame on: a number, true, false, or [a, b, ...]. */
bool dt_play_set(struct dt_player *player, const char *param, const char *value);

/* Hands in the content of an input: a buffer (mip 0), or one mip of an image, laid out as
 * dt_play_read gives it, of finite numbers. It stays until it is replaced, or until a resize changes its
 * extent; the first frame needs every input. */
bool dt_play_write(struct dt_player *player, const char *resource, uint32_t mip, const void *data,
                   size_t size);

/* Renders the next frame; the first has index 0. after_pass, if not NULL, is called after each pass,
 * in the order of describe, and returns false to fail the frame; then nothing is logged. It may call
 * describe, set and read. */
bool dt_play_render(struct dt_player *player, bool (*after_pass)(void *user, uint32_t pass),
                    void *user);

/* The content of a buffer (mip 0) or of one mip of an image: tightly packed, row 0 is the bottom of the
 * picture, padding of structs is zero. After a frame: of outputs, inputs, and resources with `keep` or
 * `history`, since others share memory. Within after_pass: also of what this pass wrote. The caller
 * frees out->data. */
bool dt_play_read(struct dt_player *player, const char *resource, uint32_t mip,
                  struct dt_bytes *out);

/* Gives frames from the next one on another size; resources with `history` begin as zero,
 * unless `keep_history` has kept them. After an error the
 * size stays; inputs whose extent depends on it, and history, are gone. */
bool dt_play_resize(struct dt_player *player, uint32_t width, uint32_t height);

/* Moves the camera from the next frame on, in the scene's units; fov_y: of the whole picture, degrees. */
bool dt_play_camera(struct dt_player *player, const float eye[3], const float target[3],
                    const float up[3], float fov_y);

/* Milliseconds of the last frame by the device's clock, one for each pass of describe; NAN: skipped. For
 * players with `timing`. */
bool dt_play_timings(struct dt_player *player, double *pass_ms);

/* What a player with `sanitize` has found in its frames so far: JSON, the list `undefined` of `diptych render --json`; free().
 * NULL after an error. */
char *dt_play_undefined(struct dt_player *player);

/* Renders the next frame with both players and compares every resource after every pass, under the
 * contracts of the spec. They have one pipeline, size and number of frames so far. Keeps what the first
 * one writes in memory. JSON: {"agree": bool, "results": [...]}, where results are those of `diptych
 * compare --json`; free(). NULL after an error, which `a` logs or, where it comes from b, b. */
char *dt_play_compare(struct dt_player *a, struct dt_player *b);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
