/* See log.h. */
#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void report_message(const struct dt_log *log, enum dt_level level, const char *format, ...)
{
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    log->message(log->user, level, length < 0 ? "out of memory" : text);
    if (length >= 0)
        free(text);
}

static void message_from(void *user, enum dt_level level, const char *message)
{
    const struct log_source *source = user;
    report_message(source->log, level, "%s: %s", source->name, message);
}

struct dt_log log_from(struct log_source *source)
{
    return (struct dt_log){.message = message_from, .user = source};
}
