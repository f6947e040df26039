/* Implements hdr.h. No exception leaves this file. */
#include "console/hdr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>

#include "scenes/image_oiio.h"

namespace
{

enum { CHANNELS = 4 };
const char *const names[CHANNELS] = {"R", "G", "B", "A"};

bool write_exr(const char *path, uint32_t width, uint32_t height, uint32_t channels,
               const void *texels, image_error *error)
try {
    Imf::Header header((int)width, (int)height);
    Imf::FrameBuffer frame;
    for (uint32_t channel = 0; channel < channels; channel++) {
        header.channels().insert(names[channel], Imf::Channel(Imf::FLOAT));
        frame.insert(names[channel],
                     Imf::Slice::Make(Imf::FLOAT, (const float *)texels + channel,
                                      header.dataWindow(), channels * sizeof(float)));
    }
    /* Into memory: OpenEXR does not see every write that fails. */
    Imf::StdOSStream memory;
    {
        Imf::OutputFile file(memory, header);
        file.setFrameBuffer(frame);
        file.writePixels((int)height);
    }
    std::string bytes = memory.str();
    std::FILE *file = std::fopen(path, "wb");
    bool good = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    good = file && !std::fclose(file) && good;
    if (!good)
        std::snprintf(error->text, sizeof error->text, "%s", std::strerror(errno));
    return good;
} catch (const std::exception &exception) {
    std::snprintf(error->text, sizeof error->text, "%s", exception.what());
    return false;
}

/* False if the file is no EXR, is damaged, or has no channels R, G and B of full size. */
bool read_exr(const char *path, uint32_t *width, uint32_t *height, float **rgba)
try {
    Imf::InputFile file(path);
    const Imath::Box2i &window = file.header().dataWindow();
    uint64_t columns = (uint64_t)((int64_t)window.max.x - window.min.x + 1);
    uint64_t rows = (uint64_t)((int64_t)window.max.y - window.min.y + 1);
    for (int channel = 0; channel < 3; channel++)
        if (!file.header().channels().findChannel(names[channel]))
            return false;
    if (rows > IMAGE_MOST_PIXELS / columns)
        return false;
    size_t texel = CHANNELS * sizeof(float);
    std::unique_ptr<float, decltype(&std::free)> texels(
        (float *)std::malloc(columns * rows * texel), std::free);
    if (!texels)
        return false;
    Imf::FrameBuffer frame;
    for (int channel = 0; channel < CHANNELS; channel++)
        frame.insert(names[channel], Imf::Slice::Make(Imf::FLOAT, texels.get() + channel, window,
                                                      texel, 0, 1, 1, 1.0));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    *width = (uint32_t)columns;
    *height = (uint32_t)rows;
    *rgba = texels.release();
    return true;
} catch (const std::exception &) {
    return false;
}

} // namespace

bool hdr_write(const char *path, uint32_t width, uint32_t height, const float *rgb,
               const struct dt_log *log)
{
    return image_write(path, write_exr, width, height, 3, rgb, log);
}

/* OpenImageIO reads what read_exr does not, or tells why it cannot. */
bool hdr_read(const char *path, uint32_t *width, uint32_t *height, float **rgba,
              const struct dt_log *log)
{
    return image_may_open(path, log) && (read_exr(path, width, height, rgba) ||
                                         image_read_float(path, width, height, rgba, log));
}
