/* A second process that compiles shaders of one backend; see helper.c. shaders.c hands it work. */
#ifndef DIPTYCH_GEN_HELPER_H
#define DIPTYCH_GEN_HELPER_H

#include "stages.h"

/* Before the first thread; false: there is none, and all is compiled here. */
bool helper_start(enum backend backend);
/* Whether it compiles shaders of this backend. */
bool helper_compiles(enum backend backend);

/* Hands over shaders, of which it takes stage and GLSL, and goes on at once; false: it is gone. */
bool helper_send(bool fast, bool gpu, struct shader *const *shaders, uint32_t count);
/* Their SPIR-V, in the same order; a shader that it could not compile keeps none. */
void helper_receive(struct shader *const *shaders, uint32_t count);

void helper_stop(void);

#endif
