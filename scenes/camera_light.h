/* The keys of a camera and of a light, and what they make of a scene's: the one place that knows
 * their names, ranges and rules. Called by scene.c, which reads them once, and by motion.c, which
 * reads them as keyframes. */
#ifndef DIPTYCH_SCENES_CAMERA_LIGHT_H
#define DIPTYCH_SCENES_CAMERA_LIGHT_H

#include "reader.h"
#include "scene.h"

enum { CAMERA_EYE, CAMERA_TARGET, CAMERA_UP, CAMERA_FOV_Y, CAMERA_KEYS };

/* `kind`, the last of both, says which of the two it is. */
enum { SPOT_POSITION, SPOT_TARGET, SPOT_DIRECTION, SPOT_CONE, SPOT_INTENSITY, SPOT_KIND };
enum { SUN_DIRECTION, SUN_IRRADIANCE, SUN_OPENING_MIN, SUN_OPENING_MAX, SUN_KIND };
enum { LIGHT_KEYS = SPOT_KIND + 1 };

/* What may stand in the mapping. light_keys returns how many keys its kind of light has. */
void camera_keys(struct key keys[CAMERA_KEYS]);
int light_keys(int kind, struct key keys[LIGHT_KEYS]);

/* Takes the keys' numbers, and reports what does not go together; what is missing is reported at
 * `place`, and keys whose reading brought the number of errors above `errors` are not looked at
 * closer. `reader` may be NULL for keys that are known to be right. */
void camera_take(struct reader *reader, int errors, const struct key keys[CAMERA_KEYS],
                 struct fy_node *place, struct scene_camera *camera);
void light_take(struct reader *reader, int errors, int kind, const struct key keys[LIGHT_KEYS],
                struct fy_node *place, struct scene_light *light);

/* The other way round. */
void camera_tell(const struct scene_camera *camera, struct key keys[CAMERA_KEYS]);
void light_tell(const struct scene_light *light, struct key keys[LIGHT_KEYS]);

#endif
