/* What the tests of the libraries share: their log, a frame, a triangle that covers it, and content for
 * the inputs of tests/specs/outside.yaml. A wrong call gives one message that names the thing, and a
 * right call after it succeeds. */
#pragma once

#include <string.h>

#include "tests/lib/unit.h"

#include "features.h"
#include "outside.h"
#include "panel.h"

enum { WIDTH = 24, HEIGHT = 16, TRAIL_BYTES = WIDTH * HEIGHT * 16, GEOMETRY_BYTES = 1 << 20 };

/* What the log got so far. Tests set the counts back. */
extern struct heard {
    int errors, warnings, validation;
    char text[2048]; /* of the last error or warning */
    char hazard[64]; /* kind of the last message of validation */
} heard;
extern const struct dt_log test_log;

/* The call must fail with exactly one error, which contains these words. */
#define REFUSED(call, words)                                                                       \
    do {                                                                                           \
        heard.errors = 0;                                                                          \
        assert_false(call);                                                                        \
        assert_int_equal(heard.errors, 1);                                                         \
        if (!strstr(heard.text, words))                                                            \
            fail_msg("\"%s\" lacks \"%s\"", heard.text, words);                                    \
    } while (0)

/* Setup and teardown of tests with a context of OpenGL 4.5, without a window. */
int open_opengl(void **state);
int close_opengl(void **state);

/* A frame with identity matrices. */
struct dt_frame frame_of(uint32_t index);

/* Lays out GEOMETRY_BYTES: at 0 the vertices of a triangle, then its indices, an array of materials
 * and an object, all zero. Tests use the second half for what they read back. */
enum { INDICES = 4096, MATERIALS = 8192, OBJECTS = 81920 };
void lay_triangle(void *bytes);

/* Lays out the triangle once more: positions 16 bytes apart; normal, uv and material in 24 bytes, at
 * own_places. */
enum { OWN_POSITIONS = 98304, OWN_REST = OWN_POSITIONS + 256, OWN_BYTES = 24 };
extern const uint32_t own_places[];
void lay_out(void *geometry, float normal_x);

/* As if the pass `keep` read vertex_triangle. */
struct dt_panel features_with_numbers(struct dt_program programs[FEATURES_PASSES]);

typedef bool write_content(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes);

extern const float graded_alone[8], nothing[8]; /* weights; a vec3 has four */
extern const uint8_t first_color[4], second_color[4], black[4], white[4];

/* Zeros for a mip of a resource. The caller frees the data. */
struct dt_bytes bytes_of(uint32_t resource, uint32_t mip);

/* Fills the table of colours with one colour. */
void write_grade(write_content *write, const uint8_t color[4]);

/* Writes content for all inputs but the table and the `imported` one. The `imported` input refuses
 * content. */
void write_inputs(write_content *write, uint32_t imported);

/* Writes content for all inputs, the table last. The picture then has the table's colour. `reads`,
 * a frame, must fail before. */
void hand_in(write_content *write, bool (*reads)(void), const uint8_t color[4]);

/* Without the blurred picture the frame is black; with a blurred picture of ones it is white. */
void write_for_blurred(write_content *write);

/* All texels of the picture must have this colour. */
void is_painted(const uint8_t *texels, const uint8_t color[4]);

/* The last texel of the fog of tests/specs/shapes.yaml: (7/8, 5/6, 4/5, 7 ^ 5 ^ 4 & 1), as halves. */
void is_last_fog(const uint16_t texel[4]);
