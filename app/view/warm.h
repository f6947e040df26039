/* Halves the wait for a driver that compiles a shader when it is first run, one after the other, as those
 * for CPUs do: a second device, on a thread of its own, runs the passes of a pipeline from the last to the
 * first and leaves what it compiled in the driver's cache on disk, while the caller's first frame runs them
 * from the first to the last. What comes out of the passes is of no use to anybody. Called by view. */
#ifndef DIPTYCH_WARM_H
#define DIPTYCH_WARM_H

#include "diptych.h"
#include "run/side.h"

struct warm;

/* NULL when there is no memory. Side and scene are borrowed until warm_stop; of the scene one triangle is
 * drawn. What goes wrong is told to nobody: then nothing is gained. */
struct warm *warm_start(const struct dt_runtime *runtime, const struct side *side,
                        const struct dt_scene *scene);

/* Begins with the panel, borrowed until another one is taken, and returns at once. Width and height of the
 * frame are those of the caller's. */
void warm_begin(struct warm *warm, const struct dt_panel *panel, const struct dt_frame *frame,
                const void *live);
/* Before the caller's first frame runs the pass: waits while the other device is at it, so that its shaders are
 * compiled once. */
void warm_meet(struct warm *warm, uint32_t pass);
void warm_end(struct warm *warm); /* the first frame is done: no more of it */

/* Waits until nothing is held of a panel but of the last one that was begun with. */
void warm_settle(struct warm *warm);
void warm_stop(struct warm *warm); /* waits for the pass that runs; takes NULL */

#endif
