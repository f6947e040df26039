/* The texts of a shader: its file, and what that includes. Each is read once; their number and size are
 * bounded. In the folder they stand to each other as they do where they are. */
#pragma once

#include "import/import.h"

enum { MOST_TEXTS = 256, MOST_INCLUDES = 4096 };

struct import_texts {
    struct import *import;
    struct import_source {
        char *path, *text; /* absolute; without a byte order mark */
        char number[12];   /* for glslang: index + 1 */
        size_t size;
    } list[MOST_TEXTS]; /* the shader first */
    uint32_t count, includes;
    size_t bytes;       /* of all includes so far; a file counts as often as it is included */
    const char *excess; /* a bound that was met; NULL: none */
    bool of_2021;       /* HLSL that needs functions which glslang has not */
};

/* Reads the shader. False: logged. texts_free either way. */
bool texts_read(struct import_texts *texts, struct import *import, const char *path);
/* As of glslang_job; user: the texts. */
struct glslang_file;
bool texts_include(const void *user, const char *from, const char *name, struct glslang_file *file);
/* Copies them below `prefix` of the folder; `name`: the shader's path there. False: logged. */
bool texts_write(const struct import_texts *texts, const char *prefix, char *name, size_t size);
void texts_free(struct import_texts *texts);
