/* Camera and light that move from frame to frame, read from a file of keyframes. */
#pragma once

#include "scene.h"

struct motion;

/* Reads a motion file for this scene (keys: see the head of motion.c). Values without keyframes are
 * the scene's. Checks all frames, so that motion_at cannot fail. NULL after an error, logged with
 * file:line:col. */
struct motion *motion_load(const char *path, const struct scene *scene, const struct dt_log *log);
void motion_free(struct motion *motion); /* takes NULL */

/* Number of frames up to the last keyframe; at least 1. */
uint32_t motion_frames(const struct motion *motion);
const char *motion_path(const struct motion *motion);

/* Camera and light in a frame, counted from 0; constant after the last keyframe. */
void motion_at(const struct motion *motion, uint32_t frame, struct dt_scene_camera *camera,
               struct scene_light *light);
