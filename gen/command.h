/* Command lines from tables: the parser, --help, and what manual pages and completion are made of. The
 * tables are in gen/main.c (diptych-gen) and app/base/options.c (diptych). */
#ifndef DIPTYCH_GEN_COMMAND_H
#define DIPTYCH_GEN_COMMAND_H

#include "diptych.h"

enum option_kind {                /* and the field that takes the value */
                   OPTION_FLAG,   /* bool; the option takes no value */
                   OPTION_STRING, /* const char * */
                   OPTION_CHOICE, /* const char *: one of those that `argument` lists */
                   OPTION_COUNT,  /* uint32_t from 1 to OPTIONS_MAX_COUNT */
                   OPTION_INDEX,  /* the same from 0 */
                   OPTION_NUMBER, /* double above 0 */
                   OPTION_SIZE,   /* uint32_t[2] from WIDTHxHEIGHT */
                   OPTION_SET,    /* struct text_list: PATH=VALUE, repeated */
                   OPTION_TEXTS   /* struct text_list: any text, repeated */
};

enum { OPTIONS_MAX_COUNT = 1000000, OPTIONS_MAX_SIZE = 65536 };

/* The values of an option that may be repeated. */
struct text_list {
    const char **items; /* owned; the texts are argv's */
    uint32_t count;
};

struct option_row {
    const char *name; /* without a dash: an argument that stands alone */
    enum option_kind kind;
    size_t offset;        /* into the struct that takes the values */
    unsigned verbs;       /* bits of the verbs that take it */
    unsigned required;    /* bits of the verbs that cannot do without; OPTION_STRING only */
    const char *argument; /* as --help shows it; a choice lists its values with | between */
    const char *help;
};

/* A program, or one verb of a program. */
struct command_line {
    const char *program;
    const char *verb; /* NULL: the program has no verbs */
    unsigned bit;     /* of the rows that it takes */
    const char *summary;
    const char *details; /* printed below the options: what it writes, its exit statuses */
    const struct option_row *rows;
    uint32_t row_count;
};

/* Reads argv[0..argc) into the fields of `options`; strings point into argv. Behind "--" no argument is
 * an option. On false the error and a hint are logged. Either way, free the lists of `options`. */
bool command_parse(const struct command_line *command, void *options, int argc, char **argv,
                   const struct dt_log *log);
/* Whether all required options were given; logs the first that was not. */
bool command_is_complete(const struct command_line *command, const void *options,
                         const struct dt_log *log);

/* --help, on stdout. */
void command_help(const struct command_line *command);
/* The same for app/manual.awk, tabs between the fields and "\n" for newlines: a line "program" or "verb",
 * name, summary, details; then for each option "option", name, argument, "required" or nothing, help. */
void command_describe(const struct command_line *command);

/* Reads WIDTHxHEIGHT as --size has it; logs the error. */
bool option_size(const char *text, uint32_t size[2], const struct dt_log *log);

#endif
