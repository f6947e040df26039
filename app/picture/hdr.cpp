/* Implements hdr.h. No exception leaves this file. */
#include "picture/hdr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <string>

extern "C" {
#include "base/files.h"
#include "base/log.h"
}
#include "scenes/image.h"
#include "scenes/image_oiio.h"

namespace
{

enum { CHANNELS = 4 };
const char *const names[CHANNELS] = {"R", "G", "B", "A"};

/* Into memory: OpenEXR does not see every write that fails. */
std::string exr_bytes(uint32_t width, uint32_t height, const float *rgb)
{
    Imf::Header header((int)width, (int)height);
    Imf::FrameBuffer frame;
    for (uint32_t channel = 0; channel < 3; channel++) {
        header.channels().insert(names[channel], Imf::Channel(Imf::FLOAT));
        frame.insert(names[channel], Imf::Slice::Make(Imf::FLOAT, rgb + channel,
                                                      header.dataWindow(), 3 * sizeof(float)));
    }
    Imf::StdOSStream memory;
    {
        Imf::OutputFile file(memory, header);
        file.setFrameBuffer(frame);
        file.writePixels((int)height);
    }
    return memory.str();
}

typedef std::unique_ptr<float, decltype(&std::free)> unique_floats;

uint64_t extent(int low, int high)
{
    return (uint64_t)((int64_t)high - low + 1);
}

/* Copies what two windows have in common. */
void place(const float *from, const Imath::Box2i &source, float *to, const Imath::Box2i &target)
{
    int left = std::max(source.min.x, target.min.x), right = std::min(source.max.x, target.max.x);
    int top = std::max(source.min.y, target.min.y), low = std::min(source.max.y, target.max.y);
    for (int y = top; y <= low && left <= right; y++) {
        uint64_t row = extent(source.min.y, y - 1) * extent(source.min.x, source.max.x);
        uint64_t out = extent(target.min.y, y - 1) * extent(target.min.x, target.max.x);
        std::memcpy(to + CHANNELS * (out + extent(target.min.x, left - 1)),
                    from + CHANNELS * (row + extent(source.min.x, left - 1)),
                    extent(left, right) * CHANNELS * sizeof(float));
    }
}

/* Reads the display window, zeros where it has no data. False if the file is no EXR, is damaged, or has no channels R, G and B of full size. */
bool read_exr(const char *path, uint32_t *width_out, uint32_t *height_out, float **rgba)
try {
    Imf::InputFile file(path);
    const Imath::Box2i &data = file.header().dataWindow(), &display = file.header().displayWindow();
    uint64_t columns = extent(display.min.x, display.max.x),
             rows = extent(display.min.y, display.max.y);
    for (int channel = 0; channel < 3; channel++)
        if (!file.header().channels().findChannel(names[channel]))
            return false;
    uint64_t width = extent(data.min.x, data.max.x), height = extent(data.min.y, data.max.y);
    if (rows > IMAGE_MOST_PIXELS / columns || height > IMAGE_MOST_PIXELS / width)
        return false;
    size_t texel = CHANNELS * sizeof(float);
    unique_floats all((float *)std::malloc(width * height * texel), std::free);
    unique_floats texels((float *)std::calloc(columns * rows, texel), std::free);
    if (!all || !texels)
        return false;
    Imf::FrameBuffer frame;
    for (int channel = 0; channel < CHANNELS; channel++)
        frame.insert(names[channel],
                     Imf::Slice::Make(Imf::FLOAT, all.get() + channel, data, texel, 0, 1, 1, 1.0));
    file.setFrameBuffer(frame);
    file.readPixels(data.min.y, data.max.y);
    place(all.get(), data, texels.get(), display);
    *width_out = (uint32_t)columns;
    *height_out = (uint32_t)rows;
    *rgba = texels.release();
    return true;
} catch (const std::exception &) {
    return false;
}

} // namespace

bool hdr_write(const char *path, uint32_t width, uint32_t height, const float *rgb,
               const struct dt_log *log)
try {
    std::string bytes = exr_bytes(width, height, rgb);
    return file_write(path, bytes.data(), bytes.size(), log);
} catch (const std::exception &exception) {
    report_error(log, "cannot write %s: %s", path, exception.what());
    return false;
}

/* OpenImageIO reads what read_exr does not, or tells why it cannot. */
bool hdr_read(const char *path, uint32_t *width, uint32_t *height, float **rgba,
              const struct dt_log *log)
{
    return image_may_open(path, log) && (read_exr(path, width, height, rgba) ||
                                         image_read_float(path, width, height, rgba, log));
}
