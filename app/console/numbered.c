/* Names of numbered files; see numbered.h. */
#include "console/numbered.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"

enum { MAX_WIDTH = 9 };

/* What follows the %d that begins at `at`, a %; NULL when it is none. */
static const char *skip_conversion(const char *at, int *width, bool *zeros)
{
    *zeros = at[1] == '0';
    at += *zeros ? 2 : 1;
    *width = 0;
    if (*at >= '1' && *at <= '0' + MAX_WIDTH)
        *width = *at++ - '0';
    return *at == 'd' ? at + 1 : NULL;
}

bool is_numbered(const char *path, const char *option, bool *good, const struct dt_log *log)
{
    uint32_t conversions = 0;
    const char *at = strchr(path, '%');
    int width;
    bool zeros;
    if (!at)
        return false;
    for (; at && *good; at = at ? strchr(at, '%') : NULL) {
        if (at[1] == '%') {
            at += 2;
            continue;
        }
        at = skip_conversion(at, &width, &zeros);
        conversions++;
        *good = at && conversions == 1;
    }
    *good = *good && conversions == 1;
    if (!*good)
        report_error(log,
                     "%s %s: needs exactly one %%d or %%04d for the frame number; write a percent "
                     "sign as %%%%",
                     option, path);
    return true;
}

char *numbered_path(const char *pattern, uint32_t number)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    int width;
    bool zeros;
    if (!out)
        return NULL;
    while (*pattern) {
        if (*pattern != '%') {
            fputc(*pattern++, out);
        } else if (pattern[1] == '%') {
            fputc('%', out);
            pattern += 2;
        } else {
            pattern = skip_conversion(pattern, &width, &zeros);
            fprintf(out, zeros ? "%0*u" : "%*u", width, number);
        }
    }
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}
