/* See printable.h. */
#include "base/printable.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t text_character(const char *at)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const uint8_t *bytes = (const uint8_t *)at;
    size_t length = bytes[0] < 0x80             ? 1
                    : (bytes[0] & 0xe0) == 0xc0 ? 2
                    : (bytes[0] & 0xf0) == 0xe0 ? 3
                    : (bytes[0] & 0xf8) == 0xf0 ? 4
                                                : 0;
    if (length == 1)
        return (bytes[0] >= 0x20 && bytes[0] != 0x7f) || bytes[0] == '\n' || bytes[0] == '\t';
    uint32_t code = length ? bytes[0] & (0x7fu >> length) : 0;
    for (size_t i = 1; i < length; i++) {
        if ((bytes[i] & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (bytes[i] & 0x3f);
    }
    bool valid = length && code >= least[length] && code <= 0x10ffff &&
                 (code < 0xd800 || code > 0xdfff) && code > 0x9f;
    return valid ? length : 0;
}

bool text_is_printable(const char *text)
{
    while (*text) {
        size_t length = text_character(text);
        if (!length)
            return false;
        text += length;
    }
    return true;
}

/* A copy with what `other` writes in place of unprintable bytes, at most 4 characters each. */
static char *copy_with(const char *text, const char *other)
{
    char *copy = malloc(strlen(text) * 4 + 1), *to = copy;
    while (copy && *text) {
        size_t length = text_character(text);
        if (length)
            memcpy(to, text, length);
        to += length ? length : (size_t)sprintf(to, other, (uint8_t)*text);
        text += length ? length : 1;
    }
    if (copy)
        *to = 0;
    return copy;
}

char *text_printable(const char *text)
{
    return copy_with(text, "\\x%02x");
}

char *text_replaced(const char *text)
{
    return copy_with(text, "\xef\xbf\xbd");
}
