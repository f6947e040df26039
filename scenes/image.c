/* Implements image.h: PNG by libpng; everything else by the OpenImageIO shim, which it finds and
 * loads. Writes files by temporary name and rename. Called by texture.c and by the app. */
#include "image.h"

#include "child.h"
#include "image_oiio.h"
#include "base/input.h"
#include "mesh.h"
#include "base/temporary.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SHIM             "libdiptych_image.so"
#define MOST_IMAGE_BYTES ((size_t)1 << 30)

/* The shim stays loaded after its first use (RTLD_NODELETE), so every call can open it again
 * without global state. Search order: beside the executable; its parent folder (tests);
 * ../lib/diptych/ of an installation; beside the library that contains this code, diptych/ there,
 * and beside its folder, as from lib/TRIPLET; the path of the loader. */
static const char *const places[] = {"", "../", "../lib/diptych/", "", "diptych/", "../diptych/"};
enum { PLACES = DT_ARRAY_COUNT(places), IN_LIBRARY = PLACES - 3 };

static bool shim_path(int place, char path[static PATH_MAX])
{
    char file[PATH_MAX] = "";
    Dl_info library;
    if (place >= IN_LIBRARY && dladdr((const void *)places, &library))
        snprintf(file, sizeof file, "%s", library.dli_fname);
    else if (readlink("/proc/self/exe", file, sizeof file - 1) < 0)
        return false;
    const char *slash = strrchr(file, '/');
    int folder = slash ? (int)(slash - file) + 1 : 0;
    return snprintf(path, PATH_MAX, "%.*s%s%s", folder, file, places[place], SHIM) < PATH_MAX &&
           access(path, R_OK) == 0;
}

static void *shim_open(const struct dt_log *log)
{
    char path[PATH_MAX];
    int place = 0;
    while (place < PLACES && !shim_path(place, path))
        place++;
    void *shim = dlopen(place < PLACES ? path : SHIM, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!shim)
        log_message(log, DT_ERROR, "cannot read images: " SHIM " is not beside the executable (%s)",
                    dlerror());
    return shim;
}

static void *shim_function(void *shim, const char *name, const struct dt_log *log)
{
    void *function = dlsym(shim, name);
    if (!function)
        log_message(log, DT_ERROR, SHIM " has no %s; build it again", name);
    return function;
}

/* Libraries open the file by its name. */
bool image_may_open(const char *path, const struct dt_log *log)
{
    const char *reason;
    child_opens(path);
    if (input_check(path, MOST_IMAGE_BYTES, &reason))
        return true;
    log_message(log, DT_ERROR, "cannot read image %s: %s", path, reason);
    return false;
}

/* Begins to read a PNG of 8-bit sRGB by libpng's simplified interface; png_image_free(). False for
 * all else, for damaged files, and for a size that is not the one wanted: OpenImageIO reads these,
 * or tells why not. */
static bool png_begin(png_image *png, const char *path, uint32_t width, uint32_t height)
{
    *png = (png_image){.version = PNG_IMAGE_VERSION};
    return png_image_begin_read_from_file(png, path) && !(png->format & PNG_FORMAT_FLAG_LINEAR) &&
           !(png->flags & PNG_IMAGE_FLAG_COLORSPACE_NOT_sRGB) &&
           (uint64_t)png->width * png->height <= IMAGE_MOST_PIXELS &&
           (width == 0 || (width == png->width && height == png->height));
}

static bool read_png(const char *path, uint32_t *width, uint32_t *height, uint8_t **texels)
{
    png_image png;
    uint8_t *codes = NULL;
    bool good = png_begin(&png, path, *width, *height);
    png.format = PNG_FORMAT_RGBA;
    good = good && (codes = malloc(PNG_IMAGE_SIZE(png))) &&
           png_image_finish_read(&png, NULL, codes, 0, NULL);
    if (good)
        *width = png.width, *height = png.height, *texels = codes;
    else
        free(codes);
    png_image_free(&png);
    return good;
}

bool image_size(const char *path, uint32_t *width, uint32_t *height, const struct dt_log *log)
{
    if (!image_may_open(path, log))
        return false;
    png_image png;
    bool is_png = png_begin(&png, path, 0, 0);
    *width = png.width, *height = png.height;
    png_image_free(&png);
    if (is_png)
        return true;
    void *shim = shim_open(log);
    if (!shim)
        return false;
    image_oiio_size_fn *size = (image_oiio_size_fn *)shim_function(shim, "image_oiio_size", log);
    struct image_error error = {""};
    bool ok = size && size(path, width, height, &error);
    if (size && !ok)
        log_message(log, DT_ERROR, "cannot read image %s: %s", path, error.text);
    dlclose(shim);
    return ok;
}

static bool image_read(const char *path, bool is_float, uint32_t *width, uint32_t *height,
                       void **texels, const struct dt_log *log)
{
    void *shim = shim_open(log);
    if (!shim)
        return false;
    image_oiio_read_fn *read = (image_oiio_read_fn *)shim_function(shim, "image_oiio_read", log);
    struct image_error error = {""};
    bool ok = read && read(path, is_float, width, height, texels, &error);
    if (read && !ok)
        log_message(log, DT_ERROR, "cannot read image %s: %s", path, error.text);
    dlclose(shim);
    return ok;
}

bool image_read_rgba8(const char *path, uint32_t *width, uint32_t *height, uint8_t **texels,
                      const struct dt_log *log)
{
    void *bytes = NULL;
    if (!image_may_open(path, log))
        return false;
    if (read_png(path, width, height, texels))
        return true;
    if (!image_read(path, false, width, height, &bytes, log))
        return false;
    *texels = bytes;
    return true;
}

bool image_read_float(const char *path, uint32_t *width, uint32_t *height, float **texels,
                      const struct dt_log *log)
{
    void *bytes = NULL;
    uint8_t *codes;
    *width = *height = 0;
    if (!image_may_open(path, log))
        return false;
    if (!read_png(path, width, height, &codes)) {
        bool good = image_read(path, true, width, height, &bytes, log);
        *texels = bytes;
        return good;
    }
    size_t count = (size_t)*width * *height * 4;
    *texels = malloc(count * sizeof **texels);
    for (size_t i = 0; i < count && *texels; i++)
        (*texels)[i] = (float)codes[i] / 255;
    if (!*texels)
        log_message(log, DT_ERROR, "cannot read image %s: out of memory", path);
    free(codes);
    return *texels;
}

/* fsync: a full disk or a network folder may report a failed write only then. */
static bool sync_and_rename(const char *from, const char *to, struct image_error *error)
{
    FILE *file = fopen(from, "rb");
    bool ok = file && fsync(fileno(file)) == 0;
    struct stat status;
    ok = ok && fstat(fileno(file), &status) == 0 && status.st_size > 0;
    ok = ok && rename(from, to) == 0;
    if (!ok)
        snprintf(error->text, sizeof error->text, "%s",
                 errno ? strerror(errno) : "the file came out empty");
    if (file)
        fclose(file);
    return ok;
}

/* By libpng's simplified interface. */
static bool write_png(const char *path, uint32_t width, uint32_t height, uint32_t channels,
                      const void *texels, struct image_error *error)
{
    static const png_uint_32 formats[] = {0, PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB,
                                          PNG_FORMAT_RGBA};
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = width,
                       .height = height,
                       .format = formats[channels]};
    bool good = png_image_write_to_file(&image, path, 0, texels, 0, NULL);
    if (!good)
        snprintf(error->text, sizeof error->text, "%s", image.message);
    return good;
}

bool image_write(const char *path, image_write_fn *write, uint32_t width, uint32_t height,
                 uint32_t channels, const void *texels, const struct dt_log *log)
{
    if (width == 0 || height == 0 || channels == 0 || channels > 4) {
        log_message(log, DT_ERROR, "cannot write %s: no picture of %ux%u texels with %u channels",
                    path, width, height, channels);
        return false;
    }
    char *temporary = temporary_path(path);
    struct image_error error = {"out of memory"};
    bool ok = temporary;
    if (ok) {
        temporary_sweep(path, unlink);
        errno = 0;
        ok = write(temporary, width, height, channels, texels, &error) &&
             sync_and_rename(temporary, path, &error);
        if (!ok)
            unlink(temporary);
    }
    if (!ok)
        log_message(log, DT_ERROR, "cannot write %s: %s", path, error.text);
    free(temporary);
    return ok;
}

bool image_write_png(const char *path, uint32_t width, uint32_t height, uint32_t channels,
                     const uint8_t *texels, const struct dt_log *log)
{
    return image_write(path, write_png, width, height, channels, texels, log);
}

bool image_compare_yee(uint32_t width, uint32_t height, const float *a, const float *b,
                       float luminance, float field_of_view, uint64_t *failing,
                       const struct dt_log *log)
{
    void *shim = shim_open(log);
    if (!shim)
        return false;
    image_oiio_yee_fn *yee = (image_oiio_yee_fn *)shim_function(shim, "image_oiio_yee", log);
    struct image_error error = {""};
    bool ok = yee && yee(width, height, a, b, luminance, field_of_view, failing, &error);
    if (yee && !ok)
        log_message(log, DT_ERROR, "cannot compare two pictures: %s", error.text);
    dlclose(shim);
    return ok;
}
