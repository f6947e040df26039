/* Implements image.h: PNG of up to 8 bits by libpng; everything else by the OpenImageIO shim,
 * which it finds and loads. */
#include "image.h"

#include "child.h"
#include "image_oiio.h"
#include "base/files.h"
#include "base/log.h"
#include "base/input.h"
#include "picture_size.h"

#include <dlfcn.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHIM             "libdiptych_image.so"
#define MOST_IMAGE_BYTES ((size_t)1 << 30)

/* Libraries open the file by its name. */
bool image_may_open(const char *path, const struct dt_log *log)
{
    const char *reason, *other;
    struct picture picture;
    child_opens(path);
    bool good = input_check(path, MOST_IMAGE_BYTES, &reason);
    if (good && picture_read(path, &picture, &other) && *picture.trouble) {
        reason = picture.trouble;
        good = false;
    }
    return good || report_error(log, "cannot read image %s: %s", path, reason);
}

/* ---- PNG ------------------------------------------------------------------------------------- */

static _Noreturn void png_fail(png_structp png, png_const_charp text)
{
    (void)text;
    png_longjmp(png, 1);
}

static void png_ignore(png_structp png, png_const_charp text)
{
    (void)png, (void)text;
}

/* What the chunks before the pixels declare; the first of these counts. */
static void take_space(png_structp png, png_infop info, char space[PICTURE_SPACE])
{
    /* white, red, green and blue of Rec. 709, in 1/100000 */
    static const png_fixed_point rec709[8] = {31270, 32900, 64000, 33000,
                                              30000, 60000, 15000, 6000};
    png_charp name;
    png_bytep profile;
    png_uint_32 size;
    png_fixed_point gamma = 0, at[8];
    int number;
    if (png_get_iCCP(png, info, &name, &number, &profile, &size)) {
        picture_profile(profile, size, space);
        return;
    }
    if (png_get_sRGB(png, info, &number)) {
        snprintf(space, PICTURE_SPACE, "sRGB");
        return;
    }
    bool far = false;
    if (png_get_cHRM_fixed(png, info, &at[0], &at[1], &at[2], &at[3], &at[4], &at[5], &at[6],
                           &at[7]))
        for (int i = 0; i < 8; i++)
            far = far || abs(at[i] - rec709[i]) > 1000;
    if (far)
        snprintf(space, PICTURE_SPACE, "one of the primaries (%g, %g), (%g, %g), (%g, %g)",
                 at[2] / 1e5, at[3] / 1e5, at[4] / 1e5, at[5] / 1e5, at[6] / 1e5, at[7] / 1e5);
    else if (!png_get_gAMA_fixed(png, info, &gamma))
        return;
    else if (abs(gamma - 45455) < 1000)
        snprintf(space, PICTURE_SPACE, "sRGB");
    else if (abs(gamma - 100000) < 1000)
        snprintf(space, PICTURE_SPACE, "linear");
    else
        snprintf(space, PICTURE_SPACE, "one of gamma %.3g", 1e5 / gamma);
}

/* As RGBA, the numbers of the file. libpng jumps out where the file is damaged. */
static void read_codes(png_structp png, png_infop info, uint32_t width, uint32_t height,
                       uint8_t *codes, png_bytepp rows)
{
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_filler(png, 255, PNG_FILLER_AFTER);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    for (uint32_t y = 0; y < height; y++)
        rows[y] = codes + (size_t)4 * width * y;
    png_read_image(png, rows);
    png_read_end(png, NULL);
}

/* Reads the header of a PNG, its space unless `read` has one, and, with `texels`, its pixels if they are of 8
 * bits or less and of the size wanted (0: any). False for all else, and for damaged files: OpenImageIO
 * reads these, or tells why not. */
static bool read_png(const char *path, const uint32_t wanted[2], struct picture *read,
                     uint8_t **texels)
{
    FILE *file = fopen(path, "rb");
    png_structp png =
        file ? png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, png_fail, png_ignore) : NULL;
    png_infop info = png ? png_create_info_struct(png) : NULL;
    uint8_t *volatile codes = NULL;
    png_bytepp volatile rows = NULL;
    volatile bool good = false;
    png_uint_32 size;
    png_bytep exif;
    if (info && setjmp(png_jmpbuf(png)) == 0) {
        png_init_io(png, file);
        png_read_info(png, info);
        read->width = png_get_image_width(png, info);
        read->height = png_get_image_height(png, info);
        if (!*read->space)
            take_space(png, info, read->space);
        if (png_get_eXIf_1(png, info, &size, &exif))
            read->turn = picture_exif_turn(exif, size);
        uint64_t count = (uint64_t)read->width * read->height;
        bool fits = !wanted || wanted[0] == 0 || wanted[1] == 0 ||
                    (wanted[0] == read->width && wanted[1] == read->height);
        if (texels && fits && png_get_bit_depth(png, info) <= 8 && count <= IMAGE_MOST_PIXELS) {
            codes = malloc(4 * count);
            rows = malloc(read->height * sizeof *rows);
            if (codes && rows) {
                read_codes(png, info, read->width, read->height, codes, rows);
                good = true;
            }
        }
        good = good || !texels;
    }
    free(rows);
    if (good && texels)
        *texels = codes;
    else
        free(codes);
    png_destroy_read_struct(&png, &info, NULL);
    if (file)
        fclose(file);
    return good;
}

/* ---- What files claim ------------------------------------------------------------------------ */

void image_check_claims(const char *path, enum image_encoding encoding, const struct dt_log *log)
{
    static const char *const taken[] = {[IMAGE_AS_NUMBERS] = "are kept",
                                        [IMAGE_AS_LIGHT] = "are taken as linear",
                                        [IMAGE_AS_SRGB] = "are taken as sRGB codes"};
    struct picture picture;
    const char *reason, *space = picture.space;
    picture_read(path, &picture, &reason);
    read_png(path, NULL, &picture, NULL);
    if (picture.turn != 1)
        report_message(
            log, DT_WARNING,
            "%s: its EXIF orientation is %u, and viewers turn it; its rows are taken as they are",
            path, picture.turn);
    bool srgb = strcmp(space, "sRGB") == 0, linear = strcmp(space, "linear") == 0;
    if (*space && !(srgb && encoding != IMAGE_AS_LIGHT) && !(linear && encoding != IMAGE_AS_SRGB))
        report_message(log, DT_WARNING, "%s: its colour space is %s; its numbers %s", path, space,
                       taken[encoding]);
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* By the shim, which stays loaded after its first use (RTLD_NODELETE), so every call can open it again
 * without global state. It is found by the run path of the program or library that contains this code
 * (ldflags in build.ninja), then by the path of the loader. texels NULL: the size alone. */
static bool image_read(const char *path, bool is_float, uint32_t *width, uint32_t *height,
                       void **texels, const struct dt_log *log)
{
    void *shim = dlopen(SHIM, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    image_oiio_read_fn *read = shim ? (image_oiio_read_fn *)dlsym(shim, "image_oiio_read") : NULL;
    struct image_error error = {""};
    if (!read)
        return report_error(log,
                            "cannot read images: " SHIM " is not beside the executable, or of "
                            "another version (%s)",
                            dlerror());
    bool good = read(path, is_float, width, height, texels, &error) ||
                report_error(log, "cannot read image %s: %s", path, error.text);
    dlclose(shim);
    return good;
}

bool image_size(const char *path, uint32_t *width, uint32_t *height, const struct dt_log *log)
{
    struct picture png = {.width = 0};
    if (!image_may_open(path, log))
        return false;
    if (!read_png(path, NULL, &png, NULL))
        return image_read(path, false, width, height, NULL, log);
    *width = png.width, *height = png.height;
    return true;
}

bool image_read_rgba8(const char *path, uint32_t *width, uint32_t *height, uint8_t **texels,
                      const struct dt_log *log)
{
    const uint32_t wanted[2] = {*width, *height};
    struct picture png = {.width = 0};
    void *bytes = NULL;
    if (!image_may_open(path, log))
        return false;
    if (read_png(path, wanted, &png, texels)) {
        *width = png.width, *height = png.height;
        return true;
    }
    if (!image_read(path, false, width, height, &bytes, log))
        return false;
    *texels = bytes;
    return true;
}

bool image_read_float(const char *path, uint32_t *width, uint32_t *height, float **texels,
                      const struct dt_log *log)
{
    struct picture png = {.width = 0};
    void *bytes = NULL;
    uint8_t *codes;
    *width = *height = 0;
    if (!image_may_open(path, log))
        return false;
    if (!read_png(path, NULL, &png, &codes)) {
        bool good = image_read(path, true, width, height, &bytes, log);
        *texels = bytes;
        return good;
    }
    *width = png.width, *height = png.height;
    size_t count = (size_t)*width * *height * 4;
    *texels = malloc(count * sizeof **texels);
    for (size_t i = 0; i < count && *texels; i++)
        (*texels)[i] = (float)codes[i] / 255;
    if (!*texels)
        report_error(log, "cannot read image %s: out of memory", path);
    free(codes);
    return *texels;
}

/* By libpng's simplified interface. */
bool image_write_png(const char *path, uint32_t width, uint32_t height, uint32_t channels,
                     const uint8_t *texels, const struct dt_log *log)
{
    static const png_uint_32 formats[] = {0, PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB,
                                          PNG_FORMAT_RGBA};
    if (width == 0 || height == 0 || channels == 0 || channels > 4)
        return report_error(log, "cannot write %s: no picture of %ux%u texels with %u channels",
                            path, width, height, channels);
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = width,
                       .height = height,
                       .format = formats[channels]};
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    void *file = malloc(size);
    bool made = file && png_image_write_to_memory(&image, file, &size, 0, texels, 0, NULL);
    if (!made)
        report_error(log, "cannot write %s: %s", path, file ? image.message : "out of memory");
    bool good = made && file_write(path, file, size, log);
    free(file);
    return good;
}
