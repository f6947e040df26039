/* Presets of slang.h. */
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/log.h"
#include "import/import.h"
#include "import/slang.h"

enum { MOST_DEPTH = 16, MOST_REFERENCES = 256, MOST_ENTRIES = 65536 };

static bool read_preset(const char *path, struct preset *preset, unsigned depth,
                        const struct dt_log *log);

static char *trim(char *text)
{
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length && isspace((unsigned char)text[length - 1]))
        text[--length] = 0;
    return text;
}

/* Without quotes; without a comment behind them, or behind a value that has none, as in `s.slang#x`. */
static char *unquote(char *value)
{
    value = trim(value);
    if (*value == '"') {
        value++;
        value[strcspn(value, "\"")] = 0;
        return value;
    }
    value[strcspn(value, "#")] = 0;
    char *other = strstr(value, "//");
    if (other && (other == value || isspace((unsigned char)other[-1])))
        *other = 0;
    return trim(value);
}

static bool add_entry(struct preset *preset, struct preset_entry given, const struct dt_log *log)
{
    if (preset->count == MOST_ENTRIES)
        return report_error(log, "%s:%u: there are more than %d keys", given.file, given.line,
                            MOST_ENTRIES);
    struct preset_entry *all =
        realloc(preset->entries, (preset->count + 1) * sizeof *preset->entries);
    if (!all)
        return false;
    preset->entries = all;
    all[preset->count] = (struct preset_entry){strdup(given.key), strdup(given.value),
                                               strdup(given.file), given.line, given.depth};
    const struct preset_entry *entry = &all[preset->count++];
    return entry->key && entry->value && entry->file;
}

static bool read_reference(const char *path, char *line, struct preset *preset, unsigned depth,
                           unsigned number, const struct dt_log *log)
{
    char *other = slang_path(path, unquote(line));
    bool good = false;
    if (depth == MOST_DEPTH || preset->references++ == MOST_REFERENCES)
        report_error(log, "%s:%u: presets refer to each other", path, number);
    else if (!other || !file_exists(other))
        report_error(log, "%s:%u: this reference cannot be used: there is no %s", path, number,
                     other ? other : "file");
    else
        good = read_preset(other, preset, depth + 1, log);
    free(other);
    return good;
}

static bool read_preset(const char *path, struct preset *preset, unsigned depth,
                        const struct dt_log *log)
{
    static const char reference[] = "#reference";
    size_t size = 0;
    char *all = import_text(path, &size, log), *rest = all, *line;
    bool good = all;
    for (unsigned number = 1; good && (line = strsep(&rest, "\n")); number++) {
        line = trim(line);
        char *equals = strchr(line, '=');
        if (!strncmp(line, reference, sizeof reference - 1)) {
            good = read_reference(path, line + sizeof reference - 1, preset, depth, number, log);
        } else if (*line != '#' && strncmp(line, "//", 2) != 0 && equals) {
            *equals = 0;
            struct preset_entry own = {unquote(line), unquote(equals + 1), (char *)path, number,
                                       depth};
            good = add_entry(preset, own, log);
        }
    }
    free(all);
    return good;
}

bool preset_read(const char *path, struct preset *preset, const struct dt_log *log)
{
    *preset = (struct preset){0};
    return read_preset(path, preset, 0, log);
}

void preset_free(struct preset *preset)
{
    for (uint32_t i = 0; i < preset->count; i++) {
        free(preset->entries[i].key);
        free(preset->entries[i].value);
        free(preset->entries[i].file);
    }
    free(preset->entries);
    *preset = (struct preset){0};
}

/* Keys of a preset count before those of its references, in a file the first, of two references the second. */
const struct preset_entry *preset_find(const struct preset *preset, const char *format, ...)
{
    char key[256];
    const struct preset_entry *found = NULL;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(key, sizeof key, format, arguments);
    va_end(arguments);
    for (uint32_t i = preset->count; i-- > 0;) {
        const struct preset_entry *own = &preset->entries[i];
        if (!strcmp(own->key, key) &&
            (!found || own->depth < found->depth || !strcmp(own->file, found->file)))
            found = own;
    }
    return found;
}
