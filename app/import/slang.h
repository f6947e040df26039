/* RetroArch's files: shaders in Vulkan's GLSL with #pragma lines (.slang), and presets that chain them
 * (.slangp). https://docs.libretro.com/development/shader/slang-shaders describes both. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"
#include "diptych.h"

struct slang_param { /* #pragma parameter */
    char name[128], doc[256];
    double value, min, max, step;
};

struct slang {
    struct text
        text; /* one file: #include resolved, stages parted by #ifdef VERTEX, #ifdef FRAGMENT */
    char name[128];     /* #pragma name; "": none */
    const char *format; /* a word of formats.def; NULL: none */
    struct slang_param *params;
    uint32_t param_count;
};

/* False: logged with file and line. Call slang_free either way. */
bool slang_read(const char *path, struct slang *slang, const struct dt_log *log);
void slang_free(struct slang *slang);

struct preset_entry { /* KEY = VALUE */
    char *key, *value, *file;
    unsigned line, depth; /* depth: of references */
};
struct preset {
    struct preset_entry *entries;
    uint32_t count, references;
};

bool preset_read(const char *path, struct preset *preset, const struct dt_log *log);
void preset_free(struct preset *preset);
/* The last entry with this key (printf-like); NULL: none. */
const struct preset_entry *preset_find(const struct preset *preset, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Reads a number as RetroArch does, whatever follows it. False: none, or one that is no finite float. */
bool slang_number(const char *text, double *value);
/* NAME beside the file `from`, or `name` itself if absolute, with RetroArch's words as $VID-DRV$ replaced where
 * that leads to a file; free(). */
char *slang_path(const char *from, const char *name);
