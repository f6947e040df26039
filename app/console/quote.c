/* Quoting; see quote.h. */
#include "console/quote.h"

#include <string.h>

void quote_word(FILE *out, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-+=./,:@%";
    if (*word && word[strspn(word, plain)] == 0) {
        fputs(word, out);
        return;
    }
    fputc('\'', out);
    for (; *word; word++)
        if (*word == '\'')
            fputs("'\\''", out);
        else
            fputc(*word, out);
    fputc('\'', out);
}

void quote_option(FILE *out, const char *name, const char *value)
{
    fprintf(out, " %s ", name);
    quote_word(out, value);
}

void quote_value(FILE *out, const char *text)
{
    for (; *text; text++)
        fputs(*text == '$' ? "$$" : (char[2]){*text}, out);
}

void quote_path(FILE *out, const char *path)
{
    for (; *path; path++) {
        if (strchr("$ :", *path))
            fputc('$', out);
        fputc(*path, out);
    }
}
