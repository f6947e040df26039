/* Command lines from tables; see command.h. */
#include "base/command.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/input.h"
#include "base/nearest.h"

#define MOST_OVERLAY_BYTES ((size_t)1 << 20)

/* The command without its options: "diptych render", "diptych-gen". */
static const char *command_name(const struct command_line *command, char name[64])
{
    snprintf(name, 64, "%s%s%s", command->program, command->verb ? " " : "",
             command->verb ? command->verb : "");
    return name;
}

/* Prefix of an error: "render: ", or "" without a verb, because the log names the program. */
static const char *error_prefix(const struct command_line *command, char prefix[64])
{
    snprintf(prefix, 64, "%s%s", command->verb ? command->verb : "", command->verb ? ": " : "");
    return prefix;
}

/* ---- Parser ---------------------------------------------------------------------------------- */

static bool takes(const struct command_line *command, const struct option_row *row)
{
    return row->verbs & command->bit;
}

static const struct option_row *find_option(const struct command_line *command, const char *name,
                                            size_t length)
{
    if (length == 2 && strncmp(name, "-h", 2) == 0)
        return find_option(command, "--help", 6);
    for (uint32_t i = 0; i < command->row_count; i++) {
        const struct option_row *row = &command->rows[i];
        if (takes(command, row) && row->name[0] == '-' && strlen(row->name) == length &&
            strncmp(row->name, name, length) == 0)
            return row;
    }
    return NULL;
}

static const char *text_at(const void *options, const struct option_row *row)
{
    return *(const char *const *)(const void *)((const char *)options + row->offset);
}

/* The first positional argument without a value, or a list, which takes all the rest; or NULL. */
static const struct option_row *find_alone(const struct command_line *command, const void *options)
{
    for (uint32_t i = 0; i < command->row_count; i++) {
        const struct option_row *row = &command->rows[i];
        if (takes(command, row) && row->name[0] != '-' &&
            (row->kind == OPTION_TEXTS || !text_at(options, row)))
            return row;
    }
    return NULL;
}

static bool unknown_option(const struct command_line *command, const char *argument, size_t length,
                           const struct dt_log *log)
{
    char name[64], prefix[64];
    const char **names = calloc(command->row_count + 1, sizeof *names);
    char *word = strndup(argument, length);
    for (uint32_t i = 0; names && i < command->row_count; i++)
        names[i] = takes(command, &command->rows[i]) ? command->rows[i].name : NULL;
    char see[96];
    snprintf(see, sizeof see, "; see %s --help", command_name(command, name));
    report_error(log, "%sunknown option \"%s\"%s", error_prefix(command, prefix),
                 word ? word : argument, name_hint('"', word, names, command->row_count, see).text);
    free(word);
    free(names);
    return false;
}

/* Reads a whole number from least to most and `end` after it; returns the rest, or NULL. */
static const char *read_count(const char *text, char end, uint32_t least, uint32_t most,
                              uint32_t *value)
{
    if (*text < '0' || *text > '9')
        return NULL;
    char *rest = NULL;
    errno = 0;
    unsigned long number = strtoul(text, &rest, 10);
    if (errno || *rest != end || number < least || number > most)
        return NULL;
    *value = (uint32_t)number;
    return end ? rest + 1 : rest;
}

static bool parse_option_number(const char *text, double *value)
{
    char *rest = NULL;
    double number = strtod(text, &rest);
    if (rest == text || *rest || !(number > 0 && number < HUGE_VAL))
        return false;
    *value = number;
    return true;
}

static bool is_choice(const char *choices, const char *value)
{
    size_t length = strlen(value);
    for (const char *at = choices; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL)
        if (strcspn(at, "|") == length && strncmp(at, value, length) == 0)
            return true;
    return false;
}

/* WIDTHxHEIGHT */
static bool read_size(const char *text, uint32_t size[2], const struct dt_log *log)
{
    const char *height = read_count(text, 'x', 1, OPTIONS_MAX_SIZE, &size[0]);
    return (height && read_count(height, 0, 1, OPTIONS_MAX_SIZE, &size[1])) ||
           report_error(log, "--size %s: must be WIDTHxHEIGHT, each from 1 to %d, like 1920x1080",
                        text, OPTIONS_MAX_SIZE);
}

static bool append_text(struct text_list *list, const char *text, const struct dt_log *log)
{
    const char **grown = realloc(list->items, (list->count + 1) * sizeof *grown);
    if (!grown)
        return report_error(log, "out of memory");
    list->items = grown;
    list->items[list->count++] = text;
    return true;
}

static bool store(void *options, const struct option_row *row, const char *value,
                  const struct dt_log *log)
{
    void *place = (char *)options + row->offset;
    uint32_t least = row->kind == OPTION_COUNT ? 1 : 0;
    switch (row->kind) {
    case OPTION_FLAG:
        *(bool *)place = true;
        return true;
    case OPTION_STRING:
    case OPTION_WORDS:
        *(const char **)place = value;
        return true;
    case OPTION_CHOICE:
        *(const char **)place = value;
        return is_choice(row->argument, value) ||
               report_error(log, "%s %s: must be one of %s", row->name, value, row->argument);
    case OPTION_COUNT:
    case OPTION_INDEX:
        return read_count(value, 0, least, OPTIONS_MAX_COUNT, place) ||
               report_error(log, "%s %s: must be a whole number from %u to %d", row->name, value,
                            least, OPTIONS_MAX_COUNT);
    case OPTION_NUMBER:
        return parse_option_number(value, place) ||
               report_error(log, "%s %s: must be a number above 0", row->name, value);
    case OPTION_SIZE:
        return read_size(value, place, log);
    case OPTION_SET:
        if (!strchr(value, '=') || value[0] == '=')
            return report_error(log, "%s %s: must be %s, like %s", row->name, value, row->argument,
                                strcmp(row->argument, "NAME=FILE") ? "clusters=16"
                                                                   : "photo=in.png");
        return append_text(place, value, log);
    case OPTION_TEXTS:
        return append_text(place, value, log);
    }
    return false;
}

/* Stores the option at argv[*at]. If its value is the next argument, moves *at there. */
static bool take_option(const struct command_line *command, void *options, int argc, char **argv,
                        int *at, const struct dt_log *log)
{
    const char *argument = argv[*at];
    size_t length = strcspn(argument, "=");
    const struct option_row *row = find_option(command, argument, length);
    const char *value = argument[length] ? argument + length + 1 : NULL;
    if (!row)
        return unknown_option(command, argument, length, log);
    if (row->kind == OPTION_FLAG)
        return value ? report_error(log, "%s: takes no value", row->name)
                     : store(options, row, "", log);
    if (row->kind == OPTION_WORDS && !value)
        return store(options, row, "", log);
    /* An option is no value: `--graph --help` must not write a file named `--help`. */
    if (!value && *at + 1 < argc && strncmp(argv[*at + 1], "--", 2) != 0)
        value = argv[++*at];
    if (!value || !*value)
        return report_error(log, "%s: %s is missing", row->name, row->argument);
    return store(options, row, value, log);
}

bool command_parse(const struct command_line *command, void *options, int argc, char **argv,
                   const struct dt_log *log)
{
    char name[64], prefix[64];
    bool only_names = false;
    for (int i = 0; i < argc; i++) {
        bool alone = only_names || argv[i][0] != '-' || !argv[i][1];
        const struct option_row *row = alone ? find_alone(command, options) : NULL;
        if (!only_names && strcmp(argv[i], "--") == 0) {
            only_names = true;
        } else if (alone && !row) {
            return report_error(log, "%sunexpected argument \"%s\"; see %s --help",
                                error_prefix(command, prefix), argv[i],
                                command_name(command, name));
        } else if (alone ? !store(options, row, argv[i], log)
                         : !take_option(command, options, argc, argv, &i, log)) {
            return false;
        }
    }
    return true;
}

static bool is_one_of(const char *name, size_t length, const char *const *words, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strlen(words[i]) == length && strncmp(name, words[i], length) == 0)
            return true;
    return false;
}

/* Whether an overlay may set this: values of parameters, and what `tune` chooses. An overlay may come
 * from anyone, and names no file. */
static bool is_tunable(const char *set)
{
    static const char *const keys[] = {"local", "storage", "loop"};
    static const char *const others[] = {"pipeline",  "doc",    "include",
                                         "exactness", "target", "origin"}; /* of a spec */
    size_t length = strcspn(set, "=");
    const char *last = memrchr(set, '.', length);
    if (!last)
        return !is_one_of(set, length, others, sizeof others / sizeof *others);
    size_t ending = (size_t)(set + length - last - 1);
    if (strncmp(set, "params.", strlen("params.")) == 0)
        return last == set + strlen("params") ||
               is_one_of(last + 1, ending, (const char *[]){"value"}, 1);
    return strncmp(set, "passes.", strlen("passes.")) == 0 &&
           is_one_of(last + 1, ending, keys, sizeof keys / sizeof *keys);
}

/* A line `- PATH=VALUE`. */
static bool take_overlay_line(struct text_list *all, const char *path, int number, const char *line,
                              const struct dt_log *log)
{
    const struct source source = {.path = path};
    if (strncmp(line, "- ", 2) != 0 || !strchr(line, '='))
        report_at(log, (struct loc){&source, number, 1, 1}, "this is no line `- PATH=VALUE`");
    else if (!is_tunable(line + 2))
        report_at(log, (struct loc){&source, number, 3, 1},
                  "an overlay sets parameters, `local`, `storage` and `loop` alone; use --set for "
                  "`%.*s`",
                  (int)strcspn(line + 2, "="), line + 2);
    else
        return append_text(all, line + 2, log);
    return false;
}

bool command_overlay(struct text_list *sets, const char *path, char **text,
                     const struct dt_log *log)
{
    struct text_list all = {0};
    int number = 1;
    const char *reason;
    size_t length;
    *text = input_read(path, MOST_OVERLAY_BYTES, &length, &reason);
    bool good = *text || report_error(log, "--with %s: cannot be read: %s", path, reason);
    if (good && strlen(*text) != length)
        good = report_error(log, "--with %s: is no text: it has a byte of zero", path);
    for (char *rest = *text, *line; good && (line = strsep(&rest, "\n")); number++) {
        if (!*line || *line == '#')
            continue;
        good = take_overlay_line(&all, path, number, line, log);
    }
    for (uint32_t i = 0; i < sets->count && good; i++)
        good = append_text(&all, sets->items[i], log);
    free(good ? sets->items : all.items);
    if (good)
        *sets = all;
    return good;
}

bool command_is_complete(const struct command_line *command, const void *options,
                         const struct dt_log *log)
{
    char name[64], prefix[64];
    for (uint32_t i = 0; i < command->row_count; i++) {
        const struct option_row *row = &command->rows[i];
        if ((row->required & command->bit) && !text_at(options, row))
            return report_error(log, "%s%s%s%s is missing; see %s --help",
                                error_prefix(command, prefix), row->name, row->argument ? " " : "",
                                row->argument ? row->argument : "", command_name(command, name));
    }
    return true;
}

/* ---- Help ------------------------------------------------------------------------------------ */

enum { HELP_INDENT = 30, HELP_COLUMNS = 100 };

/* Prints text from column HELP_INDENT on, broken between words. */
static void print_wrapped(const char *text)
{
    int column = HELP_INDENT;
    for (const char *end; *text; text = end) {
        end = text + strspn(text, " ");
        end += strcspn(end, " ");
        if (column > HELP_INDENT && column + (end - text) > HELP_COLUMNS) {
            text += strspn(text, " ");
            column = printf("\n%*s", HELP_INDENT, "") - 1;
        }
        column += printf("%.*s", (int)(end - text), text);
    }
    printf("\n");
}

void command_help(const struct command_line *command)
{
    char name[64];
    command_name(command, name);
    printf("%s: %s\n\nusage: %s", name, command->summary, name);
    for (uint32_t i = 0; i < command->row_count; i++) {
        const struct option_row *row = &command->rows[i];
        bool required = row->required & command->bit;
        if (required || (takes(command, row) && row->name[0] != '-'))
            printf(required ? " %s%s%s" : " [%s%s%s]", row->name, row->argument ? " " : "",
                   row->argument ? row->argument : "");
    }
    printf(" [options]\n\n");
    for (uint32_t i = 0; i < command->row_count; i++) {
        const struct option_row *row = &command->rows[i];
        if (!takes(command, row))
            continue;
        int used = printf("  %s %s", row->name, row->argument ? row->argument : "");
        if (used >= HELP_INDENT)
            printf("\n%*s", HELP_INDENT, "");
        else
            printf("%*s", HELP_INDENT - used, "");
        print_wrapped(row->help);
    }
    printf("\n%s\n", command->details);
}

void command_describe(const struct command_line *command)
{
    printf("%s\t%s\t%s\t", command->verb ? "verb" : "program",
           command->verb ? command->verb : command->program, command->summary);
    for (const char *at = command->details; *at; at++)
        fputs(*at == '\n' ? "\\n" : (char[]){*at, 0}, stdout);
    putchar('\n');
    for (uint32_t i = 0; i < command->row_count; i++) {
        const struct option_row *row = &command->rows[i];
        if (takes(command, row))
            printf("option\t%s\t%s\t%s\t%s\n", row->name, row->argument ? row->argument : "",
                   row->required & command->bit ? "required" : "", row->help);
    }
}
