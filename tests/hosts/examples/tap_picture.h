/* What both small engines upload: a picture, and the exposures of a row of cameras. */
#ifndef TAP_PICTURE_H
#define TAP_PICTURE_H

#include <stdint.h>

enum { WIDTH = 96, HEIGHT = 63, SMALL = 3 /* times smaller */, CAMERAS = 5 };

struct camera {
    float position[3], exposure;
    uint32_t id;
};

/* A texel of the picture, y from the top. */
static inline void paint(unsigned char texel[4], int x, int y)
{
    texel[0] = (unsigned char)(x * 2 + (x / 9 + y / 7) % 2 * 40);
    texel[1] = (unsigned char)(y * 3);
    texel[2] = (unsigned char)((x * x + y * 5) % 256);
    texel[3] = 255;
}

static inline void place(struct camera cameras[CAMERAS])
{
    for (uint32_t i = 0; i < CAMERAS; i++) {
        const struct camera camera = {{(float)i, 1.5f, -2.0f}, 0.25f * (float)(i + 1), 100 + i};
        cameras[i] = camera;
    }
}

#endif
