/* `diptych import`; see import.h. */
#include "import/import.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/input.h"
#include "base/installed.h"
#include "base/log.h"
#include "console/options.h"
#include "scenes/child.h"
#include "scenes/image.h"
#include "gen/check/check.h"
#include "gen/load.h"
#include "gen/read/body_files.h"
#include "gen/spirv/watchdog.h"
#include "scenes/picture_size.h"

/* ---- Names ------------------------------------------------------------------------------------ */

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

void import_file_name(const char *path, char *out, size_t size)
{
    const char *slash = strrchr(path, '/');
    snprintf(out, size, "%s", slash ? slash + 1 : path);
    for (char *at = out; *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("_-.", *at))
            *at = '_';
    *out = *out == '.' || !*out ? '_' : *out;
}

/* ---- Files ------------------------------------------------------------------------------------ */

char *import_text(const char *path, size_t *size, const struct dt_log *log)
{
    const char *reason;
    child_opens(path);
    char *text = input_read(path, IMPORT_TEXT_BYTES, size, &reason);
    if (!text)
        report_error(log, "%s: cannot be read: %s", path, reason);
    else if (!memcmp(text, "\xef\xbb\xbf", *size < 3 ? *size + 1 : 3))
        memmove(text, text + 3, (*size -= 3) + 1);
    return text;
}

bool import_refuse(const struct import *import, const char *path, const char *text,
                   const char *word, const char *format, ...)
{
    const struct source source = {.path = path};
    struct loc loc = {&source, 0, 1, 1};
    char *code = text && word ? strdup(text) : NULL, *why = NULL;
    va_list arguments;
    if (code)
        blank_comments(code);
    const char *found = code ? find_word(code, word) : NULL;
    for (const char *at = code; found && at <= found; at++) {
        loc.line += at == code || at[-1] == '\n';
        loc.column = at == code || at[-1] == '\n' ? 1 : loc.column + 1;
    }
    free(code);
    va_start(arguments, format);
    if (vasprintf(&why, format, arguments) < 0)
        why = NULL;
    va_end(arguments);
    report_at(&import->console->log, loc, "%s", why ? why : "out of memory");
    free(why);
    return false;
}

bool import_copy(struct import *import, const char *from, const char *name)
{
    enum { MOST = 1 << 30 };
    size_t size = 0;
    const char *reason;
    char *all = input_read(from, MOST, &size, &reason);
    if (!all)
        report_error(&import->console->log, "%s: cannot be read: %s", from, reason);
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
    snprintf(name, sizeof name, "picture%.8s", dot ? dot : ".png");
    if (!folder_takes(name))
        snprintf(name, sizeof name, "picture");
    char *path = format_string("%s/%s", import->folder.temporary, name);
    bool good = path && (import->picture ? import_copy(import, import->picture, name)
                                         : write_card(import, path));
    free(path);
    return good ? name : NULL;
}

bool import_picture_size(const struct import *import, uint32_t size[2])
{
    const char *why = NULL;
    size[0] = CARD_WIDTH;
    size[1] = CARD_HEIGHT;
    return !import->picture || picture_size(import->picture, &size[0], &size[1], &why) ||
           report_error(&import->console->log, "%s: %s", import->picture, why);
}

/* ---- The spec --------------------------------------------------------------------------------- */

/* What the generator does not take is not left. Known kinds were refused before, at their line. */
static void tell_spec(const struct import *import, const struct diag *diag)
{
    struct loc loc = {0};
    const char *why = diag_first_error(diag, &loc), *path = loc.source ? loc.source->path : "",
               *slash = strrchr(path, '/');
    char *text = loc.source && loc.source->text ? strdup(loc.source->text) : NULL, *rest = text,
         *line = NULL;
    for (int i = 0; rest && i < loc.line; i++)
        line = strsep(&rest, "\n");
    report_error(&import->console->log, "%s: this cannot be had as a spec: %s:%d: %s%s%s",
                 import->files[0], slash ? slash + 1 : path, loc.line, why ? why : "out of memory",
                 line ? ", at " : "", line ? line + strspn(line, " ") : "");
    free(text);
}

static bool check_spec(const struct import *import)
{
    struct spec spec = {0};
    struct diag *diag = diag_create();
    char *templates = templates_folder(&import->console->log);
    char *path = format_string("%s/%s.yaml", import->folder.temporary, import->name);
    const struct spec_request request = {.path = path, .templates = templates};
    bool loads = diag && templates && path, good = loads && spec_load(&spec, &request, false, diag);
    if (loads && !good)
        tell_spec(import, diag);
    spec_free(&spec);
    diag_free(diag);
    free(templates);
    free(path);
    return good;
}

/* In a child: compilers crash, hang and take memory. What it leaves half done goes with the folder. */
static bool import_apart(FILE *result, void *user, const struct dt_log *log)
{
    struct import *import = user;
    (void)result;
    import->console->log = *log;
    child_opens(import->files[0]);
    child_limit_time(SPEC_SECONDS);
    child_limit_memory((size_t)SPEC_GIBIBYTES << 30);
    size_t length = strlen(import->files[0]);
    bool preset = length > 7 && !strcasecmp(import->files[0] + length - 7, ".slangp");
    bool good =
        preset ? import_preset(import, import->files[0]) : import_shaders(import, import->files);
    child_limit_time(SPEC_SECONDS);
    return good && check_spec(import);
}

int verb_import(struct console *console, const struct options *options)
{
    char base[128], name[128];
    import_file_name(options->files[0], base, sizeof base);
    base[strcspn(base, ".")] = 0;
    import_identifier(base, name, sizeof name - 2);
    struct import import = {
        .console = console, .name = name, .picture = options->picture, .files = options->files};
    FILE *done = folder_begin(&import.folder, console, "-o", options->output, NULL)
                     ? child_run(import_apart, &import, &console->log)
                     : NULL;
    bool good = folder_end(&import.folder, done) && done;
    if (done)
        fclose(done);
    if (good)
        printf("%s/%s.yaml\n", options->output, name);
    return good ? EXIT_FINE : EXIT_FAILED;
}
