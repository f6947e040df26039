/* Messages into a struct dt_log. */
#pragma once

#include "diptych.h"

/* printf into a log, without the trailing newline; nowhere if its message is NULL. */
void report_message(const struct dt_log *log, enum dt_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Reports an error: printf into a log. False, for `return`; compilers and clang-tidy see that. */
#define report_error(...) log_false(log_error(__VA_ARGS__))
bool log_error(const struct dt_log *log, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static inline bool log_false(bool reported)
{
    (void)reported;
    return false;
}

/* A log that puts "NAME: " before each message and hands it on. `source` must outlive what it is
 * given to. */
struct log_source {
    const struct dt_log *log;
    const char *name;
};
struct dt_log log_from(struct log_source *source);
