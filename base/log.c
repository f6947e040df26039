/* See log.h. */
#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static void report_list(const struct dt_log *log, enum dt_level level, const char *format,
                        va_list arguments)
{
    char *text = NULL, short_text[1024]; /* where memory is out */
    va_list again;
    va_copy(again, arguments);
    int length = vasprintf(&text, format, arguments);
    if (length < 0)
        vsnprintf(short_text, sizeof short_text, format, again);
    va_end(again);
    if (log->message)
        log->message(log->user, level, length < 0 ? short_text : text);
    if (length >= 0)
        free(text);
}

void report_message(const struct dt_log *log, enum dt_level level, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report_list(log, level, format, arguments);
    va_end(arguments);
}

bool log_error(const struct dt_log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report_list(log, DT_ERROR, format, arguments);
    va_end(arguments);
    return false;
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
