/* A window with an OpenGL context of its own, whatever renders its pictures. It holds the pictures as
 * textures; Dear ImGui draws them and the overlay between begin and end. For `diptych view`. */
#pragma once

#include "diptych.h"

struct gl_window;

/* Its context is current afterwards. NULL: the reason was logged. `debug`: KHR_debug. */
struct gl_window *gl_window_open(struct dt_log log, bool debug);
void gl_window_close(struct gl_window *window); /* accepts NULL */
/* The GLFWwindow, hidden at first. The caller handles its events; only the main thread may use it. */
void *gl_window_handle(const struct gl_window *window);

enum { WINDOW_PICTURES = 3 };
/* Rows of RGBA8 become a picture. False: logged. */
bool gl_window_upload(struct gl_window *window, uint32_t picture, uint32_t width, uint32_t height,
                      const uint8_t *pixels);
/* OpenGL's name of its texture, which another size replaces. 0: nothing was uploaded. */
unsigned gl_window_texture(const struct gl_window *window, uint32_t picture);

/* Makes the context current, and clears to black. False: logged. */
bool gl_window_begin(struct gl_window *window);
/* Shows what was drawn since, and waits for it. `photo`: NULL, or gets that, as RGBA8, row 0 at the top;
 * left as it is while the window has no pixels. The caller frees its data. False: logged. */
bool gl_window_end(struct gl_window *window, struct dt_bytes *photo);

/* Whether a call has failed because the context was lost: then only close works. */
bool gl_window_is_lost(const struct gl_window *window);
uint32_t gl_window_messages(const struct gl_window *window); /* of KHR_debug so far; must be 0 */
