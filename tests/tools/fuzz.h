/* Declarations that fuzz_gen.c and fuzz_app.c share with fuzz.c. Each kind tries one input: files
 * in fuzz_folder, which fuzz.c empties. */
#pragma once

#include "diptych.h"

extern const char *fuzz_folder;
extern const char *fuzz_templates;   /* folder with glsl/ and the bodies of tests/specs */
extern const struct dt_log fuzz_log; /* prints, and counts errors in fuzz_messages */
extern unsigned fuzz_messages;

/* Calls abort() where the condition does not hold, so that the fuzzer keeps the input. */
void fuzz_insist(bool holds, const char *what);
/* The path of a file in the folder. */
void fuzz_path(char path[256], const char *name);
void fuzz_put(const char *name, const char *bytes, size_t size);
/* Writes the files of an input, each behind a line "=== NAME"; false: the input has another
 * form. */
bool fuzz_unpack(const char *bytes, size_t size);

void fuzz_spec(const char *bytes, size_t size);
void fuzz_body(const char *bytes, size_t size);
void fuzz_cache(const char *bytes, size_t size);
void fuzz_scene(const char *bytes, size_t size);
void fuzz_input(const char *bytes, size_t size);
void fuzz_evidence(const char *bytes, size_t size);
void fuzz_preset(const char *bytes, size_t size);
void fuzz_module(const char *bytes, size_t size);
