/* The OpenGL renderer that was there before diptych, and knows nothing of it: a context without a window,
 * buffers, textures, and a state of the context that everybody else has to leave alone. host_gl.c and
 * host_inputs_gl.c take pipelines into it. Whatever fails ends the program. */
#ifndef RENDERER_GL_H
#define RENDERER_GL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

void check(bool good, const char *what);

/* Makes a context current; HOST_DEBUG=1 in the environment hears KHR_debug. */
void renderer_open(void);
bool renderer_is_silent(void); /* nothing was heard */

GLuint make_buffer(const void *data, size_t size);
GLuint make_texture(GLenum format, uint32_t width, uint32_t height);
void write_texture(GLuint texture, uint32_t width, uint32_t height, const char *path); /* PPM */

/* State that would spoil every pass, were it left so, as somebody's renderer has it. */
void make_disorder(void);
/* The program ends when some of it is no longer what make_disorder has left. */
void check_state(const char *after);

#endif
