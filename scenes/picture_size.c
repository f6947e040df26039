/* Headers of picture files; see picture_size.h. The file may come from anyone: every number is read
 * through `take`, which fails at the end of the file. */
#include "picture_size.h"

#include "base/input.h"

#include <stdio.h>
#include <string.h>

#define MOST_BYTES ((size_t)1 << 30)
enum { MOST_WORD = 256 }; /* bytes of a name or line in a header */

static bool take(FILE *file, uint8_t *bytes, size_t count)
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

static bool png(FILE *file, uint32_t size[2])
{
    uint8_t head[16];
    if (!skip(file, 8) || !take(file, head, sizeof head) || memcmp(head + 4, "IHDR", 4) != 0)
        return false;
    size[0] = big(head + 8, 4);
    size[1] = big(head + 12, 4);
    return true;
}

/* ---- JPEG: segments up to the start of a frame ----------------------------------------------- */

static bool is_frame(uint8_t marker)
{
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

static bool jpeg(FILE *file, uint32_t size[2])
{
    uint8_t head[7] = {0};
    if (!skip(file, 2))
        return false;
    for (;;) {
        if (!take(file, head, 2) || head[0] != 0xff)
            return false;
        while (head[1] == 0xff) /* fill bytes */
            if (!take(file, head + 1, 1))
                return false;
        uint8_t marker = head[1];
        if (!take(file, head, 2) || big(head, 2) < 2)
            return false;
        if (!is_frame(marker)) {
            if (!skip(file, big(head, 2) - 2))
                return false;
            continue;
        }
        if (!take(file, head, 5))
            return false;
        size[0] = big(head + 3, 2);
        size[1] = big(head + 1, 2);
        return true;
    }
}

/* ---- OpenEXR: attributes up to dataWindow ---------------------------------------------------- */

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

static bool exr(FILE *file, uint32_t size[2])
{
    char name[MOST_WORD], type[MOST_WORD];
    uint8_t box[16];
    if (!skip(file, 8))
        return false;
    while (take_word(file, name) && *name && take_word(file, type) && take(file, box, 4)) {
        uint32_t length = little(box);
        if (strcmp(name, "dataWindow") != 0 || length != sizeof box) {
            if (!skip(file, length))
                return false;
            continue;
        }
        if (!take(file, box, sizeof box))
            return false;
        for (int i = 0; i < 2; i++)
            size[i] = little(box + 8 + 4 * i) - little(box + 4 * i) + 1;
        return true;
    }
    return false;
}

/* ---- Radiance HDR: lines, an empty one, then the size ---------------------------------------- */

static bool hdr(FILE *file, uint32_t size[2])
{
    char line[MOST_WORD];
    while (fgets(line, sizeof line, file) && *line != '\n')
        continue;
    return fgets(line, sizeof line, file) && sscanf(line, "-Y %u +X %u", &size[1], &size[0]) == 2;
}

/* ---- All ------------------------------------------------------------------------------------- */

static const struct {
    const char *name, *magic;
    bool (*read)(FILE *file, uint32_t size[2]);
} kinds[] = {{"PNG", "\x89PNG", png},
             {"JPEG", "\xff\xd8\xff", jpeg},
             {"OpenEXR", "\x76\x2f\x31\x01", exr},
             {"HDR", "#?", hdr}};

bool picture_size(const char *path, uint32_t *width, uint32_t *height, const char **reason)
{
    enum { KINDS = sizeof kinds / sizeof *kinds };
    static _Thread_local char text[64];
    char start[8] = "";
    uint32_t size[2] = {0};
    FILE *file = input_open(path, MOST_BYTES, reason);
    if (!file)
        return false;
    size_t got = fread(start, 1, sizeof start, file), kind = 0;
    while (kind < KINDS && (got < strlen(kinds[kind].magic) ||
                            memcmp(start, kinds[kind].magic, strlen(kinds[kind].magic)) != 0))
        kind++;
    bool good = kind < KINDS;
    *reason = "it is no PNG, JPEG, OpenEXR or HDR picture";
    if (good) {
        rewind(file);
        good = kinds[kind].read(file, size) && size[0] && size[1];
        snprintf(text, sizeof text, "its %s header is damaged", kinds[kind].name);
        *reason = text;
    }
    fclose(file);
    *width = size[0];
    *height = size[1];
    return good;
}
