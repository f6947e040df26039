/* Writes and runs a folder's ninja file; see ninja.h. */
#include "measure/ninja.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/files.h"
#include "console/quote.h"
#include "console/tool.h"

/* A failed edge leaves no file, also none from an earlier run. */
void ninja_begin(FILE *out, const char *what, bool alone)
{
    fprintf(out,
            "# One edge per step of the %s; the command that made this file goes on where it was "
            "left.\n"
            "rule step\n"
            "  command = rm -f $out $out.failed && { { $line; } >$out.txt || { status=$$?; "
            "[ ! -e $out ] || mv $out $out.failed; exit $$status; }; }\n"
            "  description = step $what\n%s",
            what, alone ? "  pool = console\n" : "");
}

void ninja_group(FILE *out, const char *name)
{
    fprintf(out, "\nbuild %s: phony", name);
}

void ninja_edge(FILE *out, const char *file, const char *group)
{
    fputs("\nbuild ", out);
    quote_path(out, file);
    fprintf(out, ": step | %s", group);
}

void ninja_path(FILE *out, const char *path)
{
    if (!path || !*path)
        return;
    fputc(' ', out);
    quote_path(out, path);
}

void ninja_end(FILE *out, const char *what, const char *line)
{
    if (line) {
        fputs("\n  what = ", out);
        quote_value(out, what);
        fputs("\n  line = ", out);
        quote_value(out, line);
    }
    fputc('\n', out);
}

bool content_write(const char *folder, const char *name, content_writer *writer, const void *user,
                   const struct dt_log *log)
{
    char *path = format_string("%s/%s", folder, name);
    struct file_draft draft;
    if (file_draft_begin(&draft, log))
        writer(draft.out, user);
    bool good = file_draft_end(&draft, path, log);
    free(path);
    return good;
}

bool ninja_run(struct console *console, const char *folder, uint32_t jobs, bool plans,
               void (*take)(void *user, const char *line), void *user)
{
    static const struct tool ninja = {
        .what = "ninja", .hint = "install the package ninja-build", .explains = true};
    char number[16];
    snprintf(number, sizeof number, "%u", jobs);
    char *argv[] = {(char *)"ninja",
                    (char *)"-C",
                    (char *)folder,
                    (char *)"-k",
                    (char *)"0",
                    (char *)"-j",
                    number,
                    plans ? (char *)"-n" : NULL,
                    NULL};
    unsigned errors = atomic_load(&console->errors);
    if (take)
        tool_lines(&ninja, argv, take, user, console);
    else
        tool_run(&ninja, argv, STDERR_FILENO, console);
    return atomic_load(&console->errors) == errors;
}
