/* Keys of a camera and of a light: names, ranges, rules, and conversion to the scene's structs. */
#pragma once

#include "base/yaml_file.h"
#include "scene.h"

enum { CAMERA_EYE, CAMERA_TARGET, CAMERA_UP, CAMERA_FOV_Y, CAMERA_KEYS };

/* `kind` is the last key of both lights. */
enum { SPOT_POSITION, SPOT_TARGET, SPOT_DIRECTION, SPOT_CONE, SPOT_INTENSITY, SPOT_KIND };
enum { SUN_DIRECTION, SUN_IRRADIANCE, SUN_OPENING_MIN, SUN_OPENING_MAX, SUN_KIND };
enum { LIGHT_KEYS = SPOT_KIND + 1 };

/* Fill in the allowed keys. light_keys returns how many keys this kind of light has. */
void camera_keys(struct key keys[CAMERA_KEYS]);
int light_keys(int kind, struct key keys[LIGHT_KEYS]);

/* Convert the keys to a camera or light, and report invalid combinations. Missing keys are reported
 * at `place`. If the reader has more than `errors` errors, further checks are skipped. `reader` may
 * be NULL for valid keys. */
void camera_take(struct reader *reader, int errors, const struct key keys[CAMERA_KEYS],
                 struct fy_node *place, struct dt_scene_camera *camera);
void light_take(struct reader *reader, int errors, int kind, const struct key keys[LIGHT_KEYS],
                struct fy_node *place, struct scene_light *light);

/* Convert a camera or light to keys. */
void camera_tell(const struct dt_scene_camera *camera, struct key keys[CAMERA_KEYS]);
void light_tell(const struct scene_light *light, struct key keys[LIGHT_KEYS]);
