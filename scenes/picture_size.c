/* Headers of picture files; see picture_size.h. The file may come from anyone. A function for each kind reads
 * its header once; false: it is damaged. */
#include "picture_size.h"

#include "base/input.h"

#include <stdio.h>
#include <string.h>

#define MOST_BYTES ((size_t)1 << 30)
enum { MOST_WORD = 256 }; /* bytes of a name or line in a header */

static bool read_bytes(FILE *file, uint8_t *bytes, size_t count)
{
    return fread(bytes, 1, count, file) == count;
}

static bool skip(FILE *file, uint64_t count)
{
    return count <= MOST_BYTES && fseek(file, (long)count, SEEK_CUR) == 0;
}

static uint32_t big(const uint8_t *at, int count)
{
    uint32_t value = 0;
    for (int i = 0; i < count; i++)
        value = value << 8 | at[i];
    return value;
}

static uint32_t little(const uint8_t *at)
{
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

/* ---- PNG: the first chunk is IHDR ------------------------------------------------------------ */

/* The chunk cICP has precedence over those that libpng reads. */
static bool png(FILE *file, struct picture *picture)
{
    uint8_t head[16], codes[4];
    if (!skip(file, 8) || !read_bytes(file, head, sizeof head) || memcmp(head + 4, "IHDR", 4) != 0)
        return false;
    picture->width = big(head + 8, 4);
    picture->height = big(head + 12, 4);
    bool more = fseek(file, 8, SEEK_SET) == 0;
    while (more && read_bytes(file, head, 8) && memcmp(head + 4, "IDAT", 4) != 0) {
        more = memcmp(head + 4, "cICP", 4) != 0 || big(head, 4) != sizeof codes;
        if (more)
            more = skip(file, (uint64_t)big(head, 4) + 4);
        else if (read_bytes(file, codes, sizeof codes))
            snprintf(picture->space, PICTURE_SPACE,
                     codes[0] == 1 && codes[1] == 13  ? "sRGB"
                     : codes[0] == 1 && codes[1] == 8 ? "linear"
                                                      : "one of primaries %d, transfer %d (cICP)",
                     codes[0], codes[1]);
    }
    return true;
}

/* ---- JPEG: segments up to the start of a frame ----------------------------------------------- */

static bool is_frame(uint8_t marker)
{
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/* Goes to the content of the next segment. */
static bool next_segment(FILE *file, uint8_t *marker, uint32_t *length)
{
    uint8_t head[2] = {0};
    if (!read_bytes(file, head, 2) || head[0] != 0xff)
        return false;
    while (head[1] == 0xff) /* fill bytes */
        if (!read_bytes(file, head + 1, 1))
            return false;
    *marker = head[1];
    if (!read_bytes(file, head, 2) || big(head, 2) < 2)
        return false;
    *length = big(head, 2) - 2;
    return true;
}

/* Whether a segment's content begins with these `head` bytes, and goes on. */
static bool begins(const uint8_t *content, uint32_t length, const char *mark, size_t head)
{
    return length > head && memcmp(content, mark, head) == 0;
}

/* Libraries warn of an early end, which the reader of pixels takes for an error. The description of an ICC
 * profile stands in its first segment. */
static bool jpeg(FILE *file, struct picture *picture)
{
    static const char icc[] = "ICC_PROFILE"; /* then the segment's number, and how many there are */
    static const char exif[] = "Exif\0";
    uint8_t marker, content[1 << 16];
    uint32_t length;
    bool good = skip(file, 2), turns = false; /* the first EXIF data counts */
    while (good && (good = next_segment(file, &marker, &length)) && !is_frame(marker)) {
        good = read_bytes(file, content, length);
        if (good && marker == 0xe2 && !*picture->space &&
            begins(content, length, icc, sizeof icc) && length > sizeof icc + 2)
            picture_profile(content + sizeof icc + 2, length - sizeof icc - 2, picture->space);
        if (good && marker == 0xe1 && !turns && begins(content, length, exif, sizeof exif)) {
            picture->turn = picture_exif_turn(content + sizeof exif, length - sizeof exif);
            turns = true;
        }
    }
    if (!good || !read_bytes(file, content, 6)) /* bits, height, width, components */
        return false;
    picture->width = big(content + 3, 2);
    picture->height = big(content + 1, 2);
    if (content[5] == 4)
        snprintf(picture->trouble, PICTURE_TROUBLE,
                 "its colours are CMYK; grey and RGB are supported");
    return true;
}

/* ---- EXIF: TIFF's header, then a directory of entries of 12 bytes ------------------------------ */

static uint32_t exif_word(const uint8_t *at, bool is_little)
{
    return is_little ? at[0] | (uint32_t)at[1] << 8 : big(at, 2);
}

uint32_t picture_exif_turn(const uint8_t *exif, size_t size)
{
    enum { ORIENTATION = 0x112 };
    if (size < 8)
        return 1;
    bool is_little = exif[0] == 'I';
    size_t at = is_little ? little(exif + 4) : big(exif + 4, 4);
    if (at > size - 2)
        return 1;
    uint32_t count = exif_word(exif + at, is_little);
    at += 2;
    for (; count > 0 && at + 12 <= size; count--, at += 12) {
        uint32_t turn = exif_word(exif + at + 8, is_little);
        if (exif_word(exif + at, is_little) == ORIENTATION && turn >= 1 && turn <= 8)
            return turn;
    }
    return 1;
}

/* ---- ICC profiles: a table of tags at byte 128, `desc` is text --------------------------------- */

static bool find_tag(const uint8_t *profile, size_t size, const char *name, size_t *at,
                     size_t *length)
{
    uint32_t count = size >= 132 ? big(profile + 128, 4) : 0;
    for (size_t i = 0; i < count && 144 + 12 * i <= size; i++) {
        const uint8_t *tag = profile + 132 + 12 * i;
        *at = big(tag + 4, 4);
        *length = big(tag + 8, 4);
        if (memcmp(tag, name, 4) == 0)
            return *at <= size && *length <= size - *at;
    }
    return false;
}

void picture_profile(const uint8_t *profile, size_t size, char space[PICTURE_SPACE])
{
    size_t at, length, step = 1, used = 0;
    snprintf(space, PICTURE_SPACE, "that of an ICC profile without a name");
    if (!find_tag(profile, size, "desc", &at, &length) || length < 28)
        return;
    const uint8_t *tag = profile + at, *text = tag + 12;
    size_t count = big(tag + 8, 4);
    if (memcmp(tag, "mluc", 4) == 0) { /* UTF-16, big-endian: the first language */
        size_t from = big(tag + 24, 4);
        count = big(tag + 20, 4);
        if (from >= length)
            return;
        text = tag + from + 1;
        step = 2;
    }
    for (size_t i = 0; i < count && (size_t)(text - tag) + i < length && text[i]; i += step)
        if (used < PICTURE_SPACE - 1 && text[i] >= ' ' && text[i] < 127)
            space[used++] = (char)text[i];
    space[used] = '\0';
    if (strstr(space, "sRGB"))
        snprintf(space, PICTURE_SPACE, "sRGB");
}

/* ---- OpenEXR: attributes --------------------------------------------------------------------- */

static bool take_word(FILE *file, char word[MOST_WORD])
{
    for (int i = 0; i < MOST_WORD; i++) {
        int byte = fgetc(file);
        if (byte == EOF)
            return false;
        word[i] = (char)byte;
        if (!byte)
            return true;
    }
    return false;
}

/* Of eight numbers behind each other; primaries of Rec. 709 have no name. */
static void name_primaries(const uint8_t bytes[32], char space[PICTURE_SPACE])
{
    static const float rec709[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    float at[8];
    bool far = false;
    memcpy(at, bytes, sizeof at); /* little-endian */
    for (int i = 0; i < 8; i++)
        far = far || !(at[i] > rec709[i] - 0.01f && at[i] < rec709[i] + 0.01f);
    if (far)
        snprintf(space, PICTURE_SPACE, "one of the chromaticities (%g, %g), (%g, %g), (%g, %g)",
                 (double)at[0], (double)at[1], (double)at[2], (double)at[3], (double)at[4],
                 (double)at[5]);
}

/* Linear, with the primaries of Rec. 709 unless it says otherwise. Its size is that of the display window:
 * what lies in it and not in the data window is zero. */
static bool exr(FILE *file, struct picture *picture)
{
    enum { DEEP = 1 << 11, PARTS = 1 << 12 }; /* of the word behind the magic number */
    char name[MOST_WORD], type[MOST_WORD];
    uint8_t head[8], bytes[32];
    bool good = read_bytes(file, head, sizeof head), found = false;
    uint32_t flags = good ? little(head + 4) : 0;
    snprintf(picture->space, PICTURE_SPACE, "linear");
    if (flags & (DEEP | PARTS))
        snprintf(picture->trouble, PICTURE_TROUBLE, "%s",
                 flags & DEEP ? "it is deep, with any number of samples in a pixel; flat pictures "
                                "are supported"
                              : "it has several parts; pictures of one part are supported");
    while (good && take_word(file, name) && *name && take_word(file, type) &&
           read_bytes(file, head, 4)) {
        uint32_t length = little(head);
        bool window = strcmp(name, "displayWindow") == 0 && length == 16;
        bool primaries = strcmp(name, "chromaticities") == 0 && length == sizeof bytes;
        good = window || primaries ? read_bytes(file, bytes, length) : skip(file, length);
        if (good && window) {
            picture->width = little(bytes + 8) - little(bytes) + 1;
            picture->height = little(bytes + 12) - little(bytes + 4) + 1;
        } else if (good && primaries) {
            name_primaries(bytes, picture->space);
        }
        found |= good && window;
    }
    return found;
}

/* ---- Radiance HDR: lines, an empty one, the size, rows ----------------------------------------- */

/* Reads a line, or the start of a long one. */
static bool take_header_line(FILE *file, char line[MOST_WORD])
{
    if (!fgets(line, MOST_WORD, file))
        return false;
    bool whole = strchr(line, '\n');
    for (int byte = 0; !whole && byte != EOF && byte != '\n';) /* its end */
        byte = fgetc(file);
    line[strcspn(line, "\r\n")] = '\0';
    return true;
}

/* Skips a row of the run lengths in use since 1991: the bytes of each channel apart. */
static bool skip_runs(FILE *file, uint32_t width)
{
    for (uint32_t at = 0; at < 4 * width;) {
        int count = fgetc(file);
        bool run = count > 128;
        if (count == EOF || !skip(file, run ? 1 : (uint64_t)count))
            return false;
        at += (uint32_t)(run ? count - 128 : count);
        if (count == 0)
            return false;
    }
    return true;
}

/* Whether a pixel of (1, 1, 1), a run length of the first version, is among the rows. */
static bool has_old_runs(FILE *file, const uint32_t size[2])
{
    uint8_t pixel[4];
    for (uint32_t y = 0; y < size[1]; y++)
        for (uint32_t x = 0; x < size[0]; x++) {
            if (!read_bytes(file, pixel, sizeof pixel))
                return false;
            bool runs = x == 0 && size[0] >= 8 && size[0] < 32768 && pixel[0] == 2 &&
                        pixel[1] == 2 && pixel[2] < 128;
            if (runs && !skip_runs(file, size[0]))
                return false;
            if (runs)
                break;
            if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1)
                return true;
        }
    return false;
}

/* A line of the header: the colours are linear, unless it says that the numbers were changed or have other
 * primaries. */
static void take_hdr_line(const char *line, struct picture *picture)
{
    static const char *const keys[] = {"EXPOSURE=", "COLORCORR=", "PRIMARIES=", "GAMMA="};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        const char *value = line + strlen(keys[i]);
        double number;
        int end = 0;
        if (strncmp(line, keys[i], strlen(keys[i])) == 0 &&
            !(sscanf(value, "%lf %n", &number, &end) == 1 && number == 1 && !value[end]))
            snprintf(picture->space, PICTURE_SPACE, "linear, changed by `%.*s`", PICTURE_SPACE - 24,
                     line);
    }
    if (strncmp(line, "FORMAT=", 7) == 0 && strcmp(line, "FORMAT=32-bit_rle_rgbe") != 0)
        snprintf(picture->trouble, PICTURE_TROUBLE, "its `%s` is not supported; 32-bit_rle_rgbe is",
                 line);
}

static bool hdr(FILE *file, struct picture *picture)
{
    char line[MOST_WORD];
    uint32_t size[2] = {0};
    snprintf(picture->space, PICTURE_SPACE, "linear");
    while (take_header_line(file, line) && *line)
        take_hdr_line(line, picture);
    if (!take_header_line(file, line))
        return false;
    if (sscanf(line, "-Y %u +X %u", &size[1], &size[0]) != 2)
        snprintf(picture->trouble, PICTURE_TROUBLE,
                 "its rows and columns are `%s`; `-Y height +X width` is supported", line);
    else if (!*picture->trouble && has_old_runs(file, size))
        snprintf(picture->trouble, PICTURE_TROUBLE,
                 "it has run lengths of Radiance's first version, which are not supported");
    picture->width = size[0];
    picture->height = size[1];
    return true;
}

/* ---- All ------------------------------------------------------------------------------------- */

bool picture_read(const char *path, struct picture *picture, const char **reason)
{
    static const struct {
        const char *name, *magic;
        bool (*read)(FILE *file, struct picture *picture);
    } kinds[] = {{"PNG", "\x89PNG", png},
                 {"JPEG", "\xff\xd8\xff", jpeg},
                 {"OpenEXR", "\x76\x2f\x31\x01", exr},
                 {"HDR", "#?", hdr}};
    static _Thread_local char text[128];
    char start[8] = "";
    *picture = (struct picture){.turn = 1};
    FILE *file = input_open(path, MOST_BYTES, reason);
    size_t got = file ? fread(start, 1, sizeof start, file) : 0, i = 0;
    while (i < sizeof kinds / sizeof *kinds &&
           (got < strlen(kinds[i].magic) ||
            memcmp(start, kinds[i].magic, strlen(kinds[i].magic)) != 0))
        i++;
    bool known = file && i < sizeof kinds / sizeof *kinds;
    if (known) {
        rewind(file);
        picture->kind = kinds[i].name;
        if (!kinds[i].read(file, picture))
            picture->width = picture->height = 0;
    } else if (file) {
        const char *seen = input_seen(path);
        snprintf(text, sizeof text, "it is no PNG, JPEG, OpenEXR or HDR picture%s%s",
                 seen ? "; it is " : "", seen ? seen : "");
        *reason = text;
    }
    if (file)
        fclose(file);
    return known;
}

bool picture_size(const char *path, uint32_t *width, uint32_t *height, const char **reason)
{
    static _Thread_local char text[PICTURE_TROUBLE];
    struct picture picture;
    if (!picture_read(path, &picture, reason))
        return false;
    if (*picture.trouble)
        memcpy(text, picture.trouble, sizeof text);
    else
        snprintf(text, sizeof text, "its %s header is damaged", picture.kind);
    *reason = text;
    *width = picture.width;
    *height = picture.height;
    return !*picture.trouble && picture.width && picture.height;
}
