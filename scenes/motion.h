/* Camera and light that move from frame to frame, read from a file of keyframes. Called by scene.c
 * and by the verbs that run many frames. */
#ifndef DIPTYCH_MOTION_H
#define DIPTYCH_MOTION_H

#include "scene.h"

struct motion;

/* Reads a motion file for this scene, which has what no keyframe says; its keys are listed at the
 * head of motion.c. All frames are tried, so that motion_at cannot fail. NULL, logged with
 * file:line:col, when the file is wrong. */
struct motion *motion_load(const char *path, const struct scene *scene, const struct dt_log *log);
void motion_free(struct motion *motion); /* takes NULL */

/* From the first frame to the one that shows the last keyframe; 1 and up. */
uint32_t motion_frames(const struct motion *motion);
const char *motion_path(const struct motion *motion);

/* Where camera and light are in a frame, from 0 on; after the last keyframe they stand still. */
void motion_at(const struct motion *motion, uint32_t frame, struct scene_camera *camera,
               struct scene_light *light);

#endif
