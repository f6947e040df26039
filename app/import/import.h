/* Specs from RetroArch's presets and from single shaders. The text of a shader stays
 * as it is; what a spec says about it comes from reflection. */
#pragma once

#include "console/folder.h"
#include "import/reflect.h"
#include "base/text.h"

enum {
    IMPORT_TEXT_BYTES = 16 << 20
}; /* the largest text that is read, with all that it includes */

struct import {
    struct console *console;
    struct folder folder; /* to fill */
    const char *const *files;
    const char *name;    /* of the pipeline: an identifier */
    const char *picture; /* file for the textures that shaders read; NULL: a test card */
};

/* chain.c: a preset as NAME.yaml, its shaders and pictures. False: logged. */
bool import_preset(struct import *import, const char *path);
/* shader.c: a compute or a fragment shader, or a vertex and a fragment shader. `paths` ends with
 * NULL. */
bool import_shaders(struct import *import, const char *const *paths);

/* import.c: reads a text, without a byte order mark; *size counts no terminating zero. free(). NULL: logged. */
char *import_text(const char *path, size_t *size, const struct dt_log *log);
/* An error in the line of the text that has the word first, behind comments; NULL, or no such word: in the file.
 * Returns false. */
bool import_refuse(const struct import *import, const char *path, const char *text,
                   const char *word, const char *format, ...) __attribute__((format(printf, 5, 6)));
/* Copies a file into the folder under this name. */
bool import_copy(struct import *import, const char *from, const char *name);
/* Writes the picture, or the test card, into the folder; the name of its file. NULL: logged. */
const char *import_picture(struct import *import);
/* The size of that picture. False: logged. */
bool import_picture_size(const struct import *import, uint32_t size[2]);
/* The name of the file, without folders, as one that folder_write takes; `size` bytes. */
void import_file_name(const char *path, char *out, size_t size);
/* The text as an identifier that a spec may declare; `size` bytes. */
void import_identifier(const char *text, char *out, size_t size);
