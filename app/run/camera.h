/* Moves the camera of the window, and writes it. */
#pragma once

#include "scenes/scene.h"

/* Moves eye and target along the camera's axes; distances in lengths of the scene. */
void camera_move(struct dt_scene_camera *camera, float right, float up, float forward);

/* Turns the view right and up, in radians; pitch is clamped below the vertical. */
void camera_turn(struct dt_scene_camera *camera, float right, float up);

/* Moves the eye around the target, right and up, in radians. */
void camera_orbit(struct dt_scene_camera *camera, float right, float up);

/* The camera as a mapping in YAML; free(). NULL: out of memory. */
char *camera_text(const struct dt_scene_camera *camera);
