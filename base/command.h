/* Command lines from tables: the parser, --help, and the input for manual pages and completion. The
 * tables are in gen/main.c (diptych-gen) and app/console/options.c (diptych). */
#pragma once

#include "diptych.h"

/* With the field that takes the value. */
enum option_kind {
    OPTION_FLAG,   /* bool; the option takes no value */
    OPTION_STRING, /* const char * */
    OPTION_WORDS,  /* const char *: `--name` is "", `--name=WORDS` has a value */
    OPTION_CHOICE, /* const char *: one of the words in `argument` */
    OPTION_COUNT,  /* uint32_t from 1 to OPTIONS_MAX_COUNT */
    OPTION_INDEX,  /* uint32_t from 0 to OPTIONS_MAX_COUNT */
    OPTION_NUMBER, /* double above 0 */
    OPTION_SIZE,   /* uint32_t[2] from WIDTHxHEIGHT */
    OPTION_SET,    /* struct text_list: PATH=VALUE or NAME=FILE, repeated */
    OPTION_TEXTS   /* struct text_list: any text, repeated */
};

enum { OPTIONS_MAX_COUNT = 1000000, OPTIONS_MAX_SIZE = 65536 };

/* The values of an option that may be repeated. */
struct text_list {
    const char **items; /* owned; the texts are argv's */
    uint32_t count;
};

struct option_row {
    const char *name; /* without a dash: a positional argument */
    enum option_kind kind;
    size_t offset;        /* into the struct that takes the values */
    unsigned verbs;       /* bits of the verbs that take it */
    unsigned required;    /* bits of the verbs that require it; OPTION_STRING only */
    const char *argument; /* as --help shows it; a choice lists its values with | between */
    const char *help;
};

/* A program, or one verb of a program. */
struct command_line {
    const char *program;
    const char *verb; /* NULL: the program has no verbs */
    unsigned bit;     /* in the `verbs` of its rows */
    const char *summary;
    const char *details; /* printed below the options: output files, exit statuses */
    const struct option_row *rows;
    uint32_t row_count;
};

/* Reads argv[0..argc) into the fields of `options`; strings point into argv. After "--" every
 * argument is positional. False: logged an error and a hint. Always free the lists of `options`. */
bool command_parse(const struct command_line *command, void *options, int argc, char **argv,
                   const struct dt_log *log);
/* Puts the assignments of a file before those of a list. Each of its lines is `- PATH=VALUE`, empty, or a comment behind #. *text
 * has them; free() it after the list. False: logged an error. */
bool command_overlay(struct text_list *sets, const char *path, char **text,
                     const struct dt_log *log);
/* Whether all required options were given; logs the first missing one. */
bool command_is_complete(const struct command_line *command, const void *options,
                         const struct dt_log *log);

/* Prints --help on stdout. */
void command_help(const struct command_line *command);
/* Prints the same for app/manual.awk, with tabs between fields and "\n" for newlines. First line:
 * "program" or "verb", name, summary, details. Per option: "option", name, argument, "required" or
 * nothing, help. */
void command_describe(const struct command_line *command);
