/* Writes a set of files: first every file under a temporary name, then renames all. An error
 * before the renames changes no file. Unchanged files are not written, so that ninja rebuilds
 * nothing. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "output.h"

#include "base/temporary.h"

struct output_file {
    char *path, *temporary; /* temporary: NULL while there is none */
    char *former;           /* a second name of the file that was replaced; NULL: there was none */
    bool replaced, is_new;
    struct text text;
    bool unchanged;
    bool stream; /* the path is a pipe, a terminal or the like: write to it, never replace it */
};

struct output {
    struct output_file *files;
    size_t count;
    bool failed;
};

struct output *output_create(void)
{
    return calloc(1, sizeof(struct output));
}

void output_add(struct output *output, const char *dir, const char *name, struct text *text)
{
    struct output_file file = {.text = *text};
    *text = (struct text){0};
    struct output_file *files = realloc(output->files, (output->count + 1) * sizeof *files);
    if (files)
        output->files = files;
    const char *slash = *dir && dir[strlen(dir) - 1] != '/' ? "/" : "";
    if (!files || asprintf(&file.path, "%s%s%s", dir, slash, name) < 0) {
        text_free(&file.text);
        output->failed = true;
        return;
    }
    files[output->count++] = file;
}

static bool output_fail(const char *what, const char *path)
{
    fprintf(stderr, "diptych-gen: error: cannot %s `%s`: %s\n", what, path, strerror(errno));
    return false;
}

static bool is_unchanged(const struct output_file *file)
{
    FILE *old = fopen(file->path, "rb");
    if (!old)
        return false;
    size_t at = 0;
    char buffer[8192];
    bool same = true;
    for (size_t got; same && (got = fread(buffer, 1, sizeof buffer, old)) > 0; at += got)
        same = got <= file->text.length - at && !memcmp(buffer, file->text.data + at, got);
    same = same && at == file->text.length && !ferror(old);
    fclose(old);
    return same;
}

/* Makes the folders above a path, like mkdir -p. */
static bool make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        bool good = !mkdir(path, 0777) || errno == EEXIST;
        if (!good)
            output_fail("make the folder", path);
        *slash = '/';
        if (!good)
            return false;
    }
    return true;
}

static bool write_temporary(struct output_file *file)
{
    if (!make_folders(file->path))
        return false;
    file->temporary = temporary_path(file->path);
    int descriptor = file->temporary
                         ? open(file->temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)
                         : -1;
    if (descriptor < 0)
        return output_fail("write", file->path);
    bool good = write_all(descriptor, file->text.data, file->text.length);
    if (!good)
        output_fail("write", file->path);
    if (close(descriptor) && good)
        good = output_fail("write", file->path);
    return good;
}

/* Writes to the existing pipe or device. */
static bool write_stream(const struct output_file *file)
{
    int descriptor = open(file->path, O_WRONLY | O_CLOEXEC);
    bool good = descriptor >= 0 && write_all(descriptor, file->text.data, file->text.length);
    if (!good)
        output_fail("write", file->path);
    if (descriptor >= 0)
        close(descriptor);
    return good;
}

static void remove_name(char **path)
{
    if (*path)
        unlink(*path);
    free(*path);
    *path = NULL;
}

static void remove_temporaries(struct output *output)
{
    for (size_t i = 0; i < output->count; i++) {
        remove_name(&output->files[i].temporary);
        remove_name(&output->files[i].former);
    }
}

/* Gives the former file a second name for `restore`, then renames the new one over it. */
static bool replace(struct output_file *file)
{
    if (asprintf(&file->former, "%s" TEMPORARY_FORMER, file->temporary) < 0) {
        file->former = NULL;
        return output_fail("write", file->path);
    }
    bool linked = !link(file->path, file->former);
    file->is_new = !linked && errno == ENOENT;
    if (!linked && !file->is_new)
        remove_name(&file->former); /* a file system without links: there is no way back */
    if (rename(file->temporary, file->path))
        return output_fail("write", file->path);
    free(file->temporary);
    file->temporary = NULL;
    file->replaced = true;
    return true;
}

/* After an error: all files are the former ones again. */
static void restore(struct output *output)
{
    for (size_t i = 0; i < output->count; i++) {
        struct output_file *file = &output->files[i];
        if (!file->replaced)
            continue;
        if (file->is_new ? unlink(file->path) : !file->former || rename(file->former, file->path))
            output_fail("restore", file->path);
    }
}

/* Whether a signal that ends the process is pending. output_commit blocks these signals until the
 * temporary files are gone. */
static bool interrupted(const sigset_t *signals)
{
    sigset_t pending;
    if (sigpending(&pending))
        return false;
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (sigismember(signals, numbers[i]) == 1 && sigismember(&pending, numbers[i]) == 1)
            return true;
    return false;
}

/* A symbolic link stays: its target is written instead. */
static void follow_link(struct output_file *file)
{
    struct stat status;
    char *real =
        !lstat(file->path, &status) && S_ISLNK(status.st_mode) ? realpath(file->path, NULL) : NULL;
    if (!real)
        return;
    free(file->path);
    file->path = real;
}

/* Writes the temporary file, unless the file is unchanged or a stream. */
static bool output_prepare(struct output_file *file)
{
    struct stat status;
    follow_link(file);
    temporary_sweep(file->path, unlink);
    bool exists = !stat(file->path, &status);
    file->stream = exists && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
    file->unchanged = !file->stream && is_unchanged(file);
    if (file->stream || file->unchanged)
        return true;
    if (!write_temporary(file))
        return false;
    if (exists && S_ISDIR(status.st_mode)) { /* its rename would fail after others succeeded */
        errno = EISDIR;
        return output_fail("write", file->path);
    }
    return true;
}

static bool write_and_rename(struct output *output, const sigset_t *signals)
{
    for (size_t i = 0; i < output->count; i++)
        if (interrupted(signals) || !output_prepare(&output->files[i]))
            return false;
    for (size_t i = 0; i < output->count; i++) {
        struct output_file *file = &output->files[i];
        if (file->unchanged || (file->stream ? write_stream(file) : replace(file)))
            continue;
        restore(output);
        return false;
    }
    return true;
}

bool output_commit(struct output *output)
{
    for (size_t i = 0; i < output->count; i++)
        output->failed |= output->files[i].text.failed;
    if (output->failed || memory_was_lost()) {
        fputs("diptych-gen: error: out of memory; nothing was written\n", stderr);
        return false;
    }
    sigset_t signals, before;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGHUP);
    bool blocked = !sigprocmask(SIG_BLOCK, &signals, &before);
    bool good = write_and_rename(output, &signals);
    remove_temporaries(output);
    if (blocked)
        sigprocmask(SIG_SETMASK, &before, NULL); /* a pending signal ends the process here */
    return good;
}

void output_free(struct output *output)
{
    if (!output)
        return;
    remove_temporaries(output);
    for (size_t i = 0; i < output->count; i++) {
        free(output->files[i].path);
        text_free(&output->files[i].text);
    }
    free(output->files);
    free(output);
}
