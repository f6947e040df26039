/* The camera that flies, and how it gets into a scene file. Called by view. */
#ifndef DIPTYCH_CAMERA_H
#define DIPTYCH_CAMERA_H

#include "scenes/scene.h"

/* Moves the eye along its own axes, by so many lengths of the scene; the target goes along. */
void camera_move(struct scene_camera *camera, float right, float up, float forward);

/* Turns the view to the right and up, radians; it never tips over the vertical. */
void camera_turn(struct scene_camera *camera, float right, float up);

/* Replaces the camera of the scene file, and nothing else in it. The file is there whole or as it
 * was; errors are logged. */
bool camera_save(const struct scene_camera *camera, const char *path, const struct dt_log *log);

#endif
