/* Feeds files to the functions that read them: `fuzz KIND FILE...`, from the project's root.
 * Nothing may crash, and each failure must have a message. Kinds: spec, a pipeline spec, and body,
 * the GLSL of the one pass of a spec; scene and evidence, several files in one, each behind a line
 * "=== NAME"; input, an array or a picture; cache, an entry of the shader cache; preset, files as of a scene
 * that begin with a.slangp; module, SPIR-V from outside. Built by
 * tests/fuzz.ninja for afl-fuzz, which writes the file anew before each turn of the loop; built
 * with the other tests for fuzz_test.sh. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "fuzz.h"
#include "base/input.h"

#ifndef __AFL_LOOP
#define __AFL_LOOP(turns) 0
#endif

enum { MOST_BYTES = 4 << 20, MOST_FILES = 32 };

static char base[] = "/tmp/diptych-fuzz-XXXXXX";
static char folder[sizeof base + 6], templates[sizeof base + 10], cache[sizeof base + 6];
const char *fuzz_folder = folder, *fuzz_templates = templates;
unsigned fuzz_messages;

static _Noreturn void die(const char *what, const char *path)
{
    fprintf(stderr, "fuzz: %s: %s: %s\n", path, what, strerror(errno));
    exit(2);
}

void fuzz_insist(bool holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "fuzz: %s\n", what);
        abort();
    }
}

static void count_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    fuzz_messages += level == DT_ERROR;
    fprintf(stderr, "%s\n", message);
}

const struct dt_log fuzz_log = {.message = count_message};

/* ---- Files of one input ---------------------------------------------------------------------- */

void fuzz_path(char path[256], const char *name)
{
    snprintf(path, 256, "%s/%s", folder, name);
}

void fuzz_put(const char *name, const char *bytes, size_t size)
{
    char path[256];
    fuzz_path(path, name);
    for (char *slash = path + sizeof folder; (slash = strchr(slash, '/')); *slash++ = '/') {
        *slash = '\0';
        if (mkdir(path, 0700) && errno != EEXIST)
            die("mkdir", path);
    }
    FILE *file = fopen(path, "w");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file))
        die("cannot be written", path);
}

static bool is_name(const char *name, size_t length)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_./";
    return length > 0 && length < 64 && strspn(name, letters) >= length && *name != '/' &&
           !memmem(name, length, "..", 2) && name[length - 1] != '/' &&
           !memmem(name, length, "//", 2);
}

bool fuzz_unpack(const char *bytes, size_t size)
{
    static const char mark[] = "=== ";
    const char *at = bytes, *end = bytes + size;
    for (int count = 0; at < end; count++) {
        const char *line = memchr(at, '\n', (size_t)(end - at)), *name = at + strlen(mark);
        if (count == MOST_FILES || !line || line < name || memcmp(at, mark, strlen(mark)) != 0 ||
            !is_name(name, (size_t)(line - name)))
            return false;
        const char *next = memmem(line, (size_t)(end - line), "\n=== ", 5);
        char text[64], path[256];
        struct stat status;
        snprintf(text, sizeof text, "%.*s", (int)(line - name), name);
        fuzz_path(path, text);
        if (!stat(path, &status) || next == line) /* this name again, or no content */
            return false;
        fuzz_put(text, line + 1, (size_t)((next ? next : end) - line - 1));
        at = next ? next + 1 : end;
    }
    return true;
}

/* Empties a folder. */
static void sweep(const char *path)
{
    DIR *listing = opendir(path);
    for (struct dirent *entry; listing && (entry = readdir(listing));) {
        char inner[512];
        snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        if (unlink(inner)) {
            sweep(inner);
            rmdir(inner);
        }
    }
    if (listing)
        closedir(listing);
}

static void remove_base(void)
{
    sweep(base);
    rmdir(base);
}

static void link_to(const char *path, const char *name)
{
    char link[512], *real = realpath(path, NULL);
    snprintf(link, sizeof link, "%s/%s", templates, name);
    if (!real || symlink(real, link))
        die("cannot be linked", path);
    free(real);
}

/* The folder for the inputs, and one of templates with the bodies of tests/specs. */
static void make_folders(void)
{
    if (!mkdtemp(base))
        die("mkdtemp", base);
    atexit(remove_base);
    snprintf(folder, sizeof folder, "%s/files", base);
    snprintf(templates, sizeof templates, "%s/templates", base);
    snprintf(cache, sizeof cache, "%s/cache", base);
    setenv("XDG_CACHE_HOME", cache, 1); /* not the user's own */
    DIR *specs = opendir("tests/specs");
    if (mkdir(folder, 0700) || mkdir(templates, 0700) || mkdir(cache, 0700) || !specs)
        die("tests/specs", base);
    link_to("templates/glsl", "glsl");
    for (struct dirent *entry; (entry = readdir(specs));) {
        char path[512];
        snprintf(path, sizeof path, "tests/specs/%s", entry->d_name);
        if (strstr(entry->d_name, ".glsl"))
            link_to(path, entry->d_name);
    }
    closedir(specs);
}

/* ---- The program ----------------------------------------------------------------------------- */

static const struct kind {
    const char *name;
    void (*attempt)(const char *bytes, size_t size);
} kinds[] = {{"spec", fuzz_spec},     {"body", fuzz_body},         {"scene", fuzz_scene},
             {"input", fuzz_input},   {"evidence", fuzz_evidence}, {"cache", fuzz_cache},
             {"preset", fuzz_preset}, {"module", fuzz_module}};

int main(int argc, char **argv)
{
    const struct kind *kind = NULL;
    for (size_t i = 0; i < DT_ARRAY_COUNT(kinds); i++)
        if (argc > 2 && strcmp(argv[1], kinds[i].name) == 0)
            kind = &kinds[i];
    if (!kind) {
        fprintf(stderr, "usage: fuzz spec|body|scene|input|evidence|cache|preset|module FILE...\n");
        return 2;
    }
    make_folders();
    do {
        for (int i = 2; i < argc; i++) {
            const char *reason;
            size_t size;
            char *bytes = input_read(argv[i], MOST_BYTES, &size, &reason);
            if (!bytes) {
                fprintf(stderr, "fuzz: %s: %s\n", argv[i], reason);
                return 2;
            }
            kind->attempt(bytes, size);
            sweep(folder);
            free(bytes);
        }
    } while (__AFL_LOOP(1000));
    return 0;
}
