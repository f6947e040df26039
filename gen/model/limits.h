/* Limits that checks and the plan hold a spec to, whatever the device. */
#pragma once

/* The reference frame: its size is used for reported bytes and for packing memory slots. */
enum { REFERENCE_WIDTH = 1920, REFERENCE_HEIGHT = 1080 };
enum { STORAGE_IMAGE_LIMIT = 8, TEXTURE_LIMIT = 16, COLOR_TARGET_LIMIT = 8, UNIFORM_LIMIT = 9 };
enum {
    SHARED_MEMORY_LIMIT = 16384,
    UNIFORM_BLOCK_LIMIT = 16384
};                                       /* bytes; every device of both APIs has as many */
enum { SOFTWARE_UNIFORM_LIMIT = 65536 }; /* bytes; on CPU drivers and desktop devices */

/* Most elements that a pass unrolls for CPU drivers in all its long ranges together: these drivers
 * take some milliseconds to compile one. */
enum { UNROLLED_LIMIT = 256 };
