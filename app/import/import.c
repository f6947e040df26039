/* `diptych import`; see import.h. */
#include "import/import.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/log.h"
#include "console/options.h"
#include "scenes/image.h"
#include "gen/check/check.h"

void import_identifier(const char *text, char *out, size_t size)
{
    size_t length = 0;
    for (; *text && length + 3 < size; text++) {
        bool word = isalnum((unsigned char)*text);
        if (word || (length && out[length - 1] != '_'))
            out[length++] = word ? *text : '_';
    }
    while (length && out[length - 1] == '_')
        length--;
    out[length] = 0;
    if (!isalpha((unsigned char)*out) || !name_is_free(out)) {
        memmove(out + 2, out, length + 1);
        memcpy(out, "p_", 2);
        length += 2;
    }
    if (!name_is_free(out)) /* ends like a macro */
        memcpy(out + length, "p", 2);
}

bool import_copy(struct import *import, const char *from, const char *name)
{
    size_t size = 0;
    char *all = file_read(from, &size, &import->console->log);
    bool good = all && folder_write(&import->folder, name, all, size);
    free(all);
    return good;
}

/* ---- The test card --------------------------------------------------------------------------- */

enum { CARD_WIDTH = 256, CARD_HEIGHT = 224 };

/* Bars, a ramp, checks and a disk, with something else in each corner. */
static void card_texel(unsigned x, unsigned y, uint8_t texel[3])
{
    static const uint8_t bars[8] = {7, 6, 3, 2, 5, 4, 1, 0}; /* bits: red, green, blue */
    int dx = (int)x - CARD_WIDTH / 2, dy = (int)y - CARD_HEIGHT / 2;
    unsigned bar = bars[x * 8 / CARD_WIDTH];
    for (unsigned c = 0; c < 3; c++) {
        uint8_t value = bar >> (2 - c) & 1 ? 224 : 16;
        if (y >= 160)
            value = (uint8_t)x;
        if (y >= 192)
            value = (x / (1 + x / 64) + y) & 1 ? 240 : 8;
        if (dx * dx + dy * dy < 40 * 40)
            value = (uint8_t)(128 + (c == 0 ? dx : c == 1 ? dy : -dx - dy));
        texel[c] = value;
    }
    if (x < 16 && y < 16)
        texel[0] = 255, texel[1] = texel[2] = 0;
    else if (x >= CARD_WIDTH - 16 && y < 16)
        texel[1] = 255, texel[0] = texel[2] = 0;
}

static bool write_card(const struct import *import, const char *path)
{
    uint8_t *texels = malloc(CARD_WIDTH * CARD_HEIGHT * 3);
    for (unsigned i = 0; texels && i < CARD_WIDTH * CARD_HEIGHT; i++)
        card_texel(i % CARD_WIDTH, i / CARD_WIDTH, texels + (size_t)i * 3);
    bool good =
        texels && image_write_png(path, CARD_WIDTH, CARD_HEIGHT, 3, texels, &import->console->log);
    free(texels);
    return good;
}

const char *import_picture(struct import *import)
{
    static char name[32];
    const char *dot = import->picture ? strrchr(import->picture, '.') : NULL;
    snprintf(name, sizeof name, "picture%.8s", dot && !strchr(dot, '/') ? dot : ".png");
    char *path = format_string("%s/%s", import->folder.temporary, name);
    bool good = path && (import->picture ? import_copy(import, import->picture, name)
                                         : write_card(import, path));
    free(path);
    return good ? name : NULL;
}

/* ---------------------------------------------------------------------------------------------- */

static bool ends(const char *path, const char *ending)
{
    size_t length = strlen(path), size = strlen(ending);
    return length > size && !strcasecmp(path + length - size, ending);
}

int verb_import(struct console *console, const struct options *options)
{
    const char *path = options->files[0], *slash = strrchr(path, '/');
    char base[128], name[128];
    snprintf(base, sizeof base, "%.*s", (int)strcspn(slash ? slash + 1 : path, "."),
             slash ? slash + 1 : path);
    import_identifier(base, name, sizeof name - 2);
    struct import import = {.console = console, .name = name, .picture = options->picture};
    bool preset = ends(path, ".slangp");
    bool good = folder_begin(&import.folder, console, "-o", options->output, "import") &&
                (preset ? import_preset(&import, path) : import_shaders(&import, options->files));
    good = folder_end(&import.folder, good) && good;
    if (good)
        printf("%s/%s.yaml\n", options->output, name);
    return good ? EXIT_FINE : EXIT_FAILED;
}
