/* Writes a set of files; an error before the renames changes no file. */
#pragma once

#include "base/text.h"

struct output;
struct output *output_create(void);
void output_add(struct output *output, const char *dir, const char *name,
                struct text *text); /* takes the text */
/* Writes temporary files, then renames them; unchanged files keep their time stamp. Reports. */
bool output_commit(struct output *output);
void output_free(struct output *output);
