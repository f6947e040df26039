/* OpenImageIO behind a C function (image_oiio.h). Built into its own shared object, so that
 * only programs that use image files pay for loading the library. No exception leaves this file. */
#include "image_oiio.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "srgb.h"

namespace
{

bool fail(image_error *error, const std::string &reason)
{
    std::snprintf(error->text, sizeof error->text, "%s",
                  reason.empty() ? "unknown reason" : reason.c_str());
    return false;
}

void map_color(OIIO::ImageBuf &image, float (*map)(float))
{
    float *texels =
        (float *)image.localpixels(); /* four channels; iterators take ten times as long */
    for (OIIO::imagesize_t i = 0; i < 4 * image.spec().image_pixels(); i++)
        if (i % 4 < 3)
            texels[i] = map(texels[i]);
}

/* Averages light, not codes. */
bool resize(OIIO::ImageBuf &image, uint32_t width, uint32_t height, bool is_encoded)
{
    if (is_encoded)
        map_color(image, srgb_decode);
    OIIO::ROI roi(0, (int)width, 0, (int)height, 0, 1, 0, 4);
    OIIO::ImageBuf resized = OIIO::ImageBufAlgo::resize(image, "triangle", 0.0f, roi);
    if (resized.has_error())
        return false;
    image = resized;
    if (is_encoded)
        map_color(image, srgb_encode);
    return true;
}

enum { CHANNELS = 4, CONSTANT = -1 };

/* Which channel becomes red, green, blue and alpha; CONSTANT: 0, or 1 for alpha. Channels without
 * names: one or two are grey (and alpha), three or four are colour (and alpha). */
void order_by_count(int count, int order[CHANNELS])
{
    order[0] = 0;
    order[1] = count < 3 ? 0 : 1;
    order[2] = count < 3 ? 0 : 2;
    order[3] = count == 2 ? 1 : count >= 4 ? 3 : CONSTANT;
}

/* Of OpenEXR, whose channels are named: those without a layer, else those of the only layer. False: names
 * that say no colour. */
bool order_by_name(const std::vector<std::string> &names, int order[CHANNELS])
{
    static const char *const sets[][CHANNELS] = {
        {"R", "G", "B", "A"}, {"Y", "Y", "Y", "A"}, {"X", "Y", "Z", nullptr}};
    size_t end = names[0].rfind('.');
    std::string layer = end == std::string::npos ? "" : names[0].substr(0, end + 1);
    for (const std::string &name : names) /* no layer comes before others */
        if (name.find('.') == std::string::npos)
            layer = "";
        else if (!layer.empty() && name.compare(0, layer.size(), layer) != 0)
            return false;
    auto find = [&](const char *base) {
        auto found = std::find_if(names.begin(), names.end(), [&](const std::string &name) {
            return base && OIIO::Strutil::iequals(name, layer + base);
        });
        return found == names.end() ? (int)CONSTANT : (int)(found - names.begin());
    };
    for (auto set : sets) {
        bool other = set[0][0] == 'Y' && (find("RY") >= 0 || find("X") >= 0);
        for (int i = 0; i < CHANNELS; i++)
            order[i] = find(set[i]);
        if (order[0] >= 0 && !other)
            return true;
    }
    return false;
}

bool find_channels(const OIIO::ImageSpec &spec, bool named, int order[CHANNELS], image_error *error)
{
    std::string text;
    order_by_count(spec.nchannels, order);
    if (!named || spec.nchannels == 1 || order_by_name(spec.channelnames, order))
        return true;
    for (const std::string &name : spec.channelnames)
        text += (text.empty() ? "" : ", ") + name;
    return fail(error, "its channels are " + text +
                           "; those of one picture are R, G, B and A, Y and A, or X, Y and Z");
}

OIIO::ImageBuf to_rgba(const OIIO::ImageBuf &image, const int order[CHANNELS])
{
    float values[CHANNELS] = {0, 0, 0, 1};
    return OIIO::ImageBufAlgo::channels(image, CHANNELS, OIIO::cspan<int>(order, CHANNELS), values);
}

/* Whether the file has a data window apart from its display window. */
bool has_windows(const OIIO::ImageInput &input)
{
    return std::strcmp(input.format_name(), "openexr") == 0;
}

/* The display window, moved to the origin: zeros where there is no data. Four channels. */
OIIO::ImageBuf whole_window(const OIIO::ImageBuf &image)
{
    const OIIO::ImageSpec &from = image.spec();
    OIIO::ImageBuf whole(
        OIIO::ImageSpec(from.full_width, from.full_height, 4, OIIO::TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::zero(whole);
    const float *data = (const float *)image.localpixels();
    float *texels = (float *)whole.localpixels();
    int left = std::max(from.x, from.full_x) - from.full_x;
    int right = std::min(from.x + from.width, from.full_x + from.full_width) - from.full_x;
    for (int y = 0; y < from.full_height && left < right; y++) {
        int row = y + from.full_y - from.y;
        if (row >= 0 && row < from.height)
            std::memcpy(texels + 4 * ((size_t)y * from.full_width + left),
                        data + 4 * ((size_t)row * from.width + left + from.full_x - from.x),
                        (size_t)(right - left) * 4 * sizeof(float));
    }
    return whole;
}

} // namespace

extern "C" bool image_oiio_read(const char *path, bool is_float, uint32_t *width, uint32_t *height,
                                void **texels, image_error *error)
try {
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    auto input = OIIO::ImageInput::open(path, &hints);
    if (!input)
        return fail(error, OIIO::geterror());
    OIIO::ImageSpec spec = input->spec();
    if (!has_windows(*input)) { /* others have a place on a page, or none */
        spec.x = spec.y = spec.full_x = spec.full_y = 0;
        spec.full_width = spec.width;
        spec.full_height = spec.height;
    }
    if (!texels) {
        *width = (uint32_t)spec.full_width;
        *height = (uint32_t)spec.full_height;
        return true;
    }
    uint64_t whole = (uint64_t)spec.full_width * (uint64_t)spec.full_height;
    if (spec.image_pixels() > IMAGE_MOST_PIXELS || whole > IMAGE_MOST_PIXELS)
        return fail(error, std::to_string(spec.full_width) + "x" +
                               std::to_string(spec.full_height) + " pixels are too many; " +
                               std::to_string(IMAGE_MOST_PIXELS) + " is the limit");
    int order[CHANNELS];
    if (!find_channels(spec, has_windows(*input), order, error))
        return false;
    spec.set_format(OIIO::TypeDesc::FLOAT);
    spec.channelformats.clear();
    OIIO::ImageBuf source(spec);
    /* A warning of a library, such as that the file ends too early, is an error with pixels. */
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, source.localpixels()) ||
        input->has_error())
        return fail(error, input->geterror());
    OIIO::ImageBuf image = to_rgba(source, order);
    if (!image.has_error() && has_windows(*input))
        image = whole_window(image);
    if (image.has_error())
        return fail(error, image.geterror());
    if (*width == 0 || *height == 0) {
        *width = (uint32_t)image.spec().width;
        *height = (uint32_t)image.spec().height;
    } else if (!resize(image, *width, *height, !is_float)) {
        return fail(error, image.geterror());
    }
    size_t count = (size_t)*width * *height * 4;
    std::unique_ptr<void, decltype(&std::free)> bytes(
        std::malloc(count * (is_float ? sizeof(float) : 1)), std::free);
    if (!bytes)
        return fail(error, "out of memory");
    if (!image.get_pixels(image.roi(), is_float ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8,
                          bytes.get()))
        return fail(error, image.geterror());
    *texels = bytes.release();
    return true;
} catch (const std::exception &exception) {
    return fail(error, exception.what());
}
