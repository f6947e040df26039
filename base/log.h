/* Messages into a struct dt_log. */
#ifndef DIPTYCH_LOG_H
#define DIPTYCH_LOG_H

#include "diptych.h"

/* printf into a log, without the trailing newline; nowhere if its message is NULL. */
void report_message(const struct dt_log *log, enum dt_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* An error. False, for `return`. */
bool report_error(const struct dt_log *log, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* A log that puts "NAME: " before each message and hands it on. `source` must outlive what it is
 * given to. */
struct log_source {
    const struct dt_log *log;
    const char *name;
};
struct dt_log log_from(struct log_source *source);

#endif
