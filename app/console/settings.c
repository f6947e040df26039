/* Reads and writes settings; see settings.h. */
#include "console/settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/text.h"

/* NULL: there is no place for it; free(). */
static char *folder_path(void)
{
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    if (config && *config == '/')
        return format_string("%s/diptych", config);
    return home && *home ? format_string("%s/.config/diptych", home) : NULL;
}

static void take(const struct setting *list, uint32_t count, const char *name, double value)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct setting *to = &list[i];
        if (strcmp(to->name, name) != 0 || !(value >= to->least && value <= to->most))
            continue;
        if (to->number)
            *to->number = (float)value;
        if (to->flag)
            *to->flag = value != 0;
        if (to->whole)
            *to->whole = (int)value;
    }
}

void settings_read(const char *name, const struct setting *list, uint32_t count)
{
    char line[128], key[32];
    double value;
    char *folder = folder_path(), *path = folder ? format_string("%s/%s", folder, name) : NULL;
    FILE *file = path ? fopen(path, "re") : NULL;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "%31[a-z_]: %lf", key, &value) == 2)
            take(list, count, key, value);
    if (file)
        fclose(file);
    free(path);
    free(folder);
}

bool settings_write(const char *name, const struct setting *list, uint32_t count,
                    const struct dt_log *log)
{
    struct text text = {0};
    char *folder = folder_path(), *path = folder ? format_string("%s/%s", folder, name) : NULL;
    for (uint32_t i = 0; i < count; i++)
        text_add(&text, "%s: %g\n", list[i].name,
                 list[i].number ? (double)*list[i].number
                 : list[i].flag ? (double)*list[i].flag
                                : (double)*list[i].whole);
    bool good = !path || text.failed || !text.data ||
                (file_make_folders(folder, log) && file_write(path, text.data, text.length, log));
    text_free(&text);
    free(path);
    free(folder);
    return good;
}
