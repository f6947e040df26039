/* What a user has set in the window and wants to find again: lines `NAME: NUMBER` in $XDG_CONFIG_HOME/diptych/view.yaml, or in
 * ~/.config/diptych. */
#include "view/view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/text.h"

enum { SETTINGS = 10 };

/* One of the three pointers is given. */
struct setting {
    const char *name; /* of lower-case letters and _, at most 31 */
    float *number;
    bool *flag;
    int *whole;
    double least, most;
};

/* NULL: there is no place for it; free(). */
static char *folder_path(void)
{
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    if (config && *config == '/')
        return format_string("%s/diptych", config);
    return home && *home ? format_string("%s/.config/diptych", home) : NULL;
}

static void take(const struct setting *list, const char *name, double value)
{
    for (uint32_t i = 0; i < SETTINGS; i++) {
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

/* Stores what the file has; other names, and numbers out of range, are ignored, as is a missing file. */
static void read_settings(const struct setting *list)
{
    char line[128], key[32];
    double value;
    char *folder = folder_path(), *path = folder ? format_string("%s/view.yaml", folder) : NULL;
    FILE *file = path ? fopen(path, "re") : NULL;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "%31[a-z_]: %lf", key, &value) == 2)
            take(list, key, value);
    if (file)
        fclose(file);
    free(path);
    free(folder);
}

static void write_settings(const struct setting *list, const struct dt_log *log)
{
    struct text text = {0};
    char *folder = folder_path(), *path = folder ? format_string("%s/view.yaml", folder) : NULL;
    for (uint32_t i = 0; i < SETTINGS; i++)
        text_add(&text, "%s: %g\n", list[i].name,
                 list[i].number ? (double)*list[i].number
                 : list[i].flag ? (double)*list[i].flag
                                : (double)*list[i].whole);
    if (path && !text.failed && file_make_folders(folder, log))
        file_write(path, text.data, text.length, log);
    text_free(&text);
    free(path);
    free(folder);
}

static void list_settings(struct overlay_settings *s, struct setting list[SETTINGS])
{
    const struct setting all[SETTINGS] = {
        {.name = "left", .number = &s->left, .least = 50, .most = 4000},
        {.name = "right", .number = &s->right, .least = 50, .most = 4000},
        {.name = "bottom", .number = &s->bottom, .least = 30, .most = 4000},
        {.name = "font", .number = &s->font, .least = 8, .most = 48},
        {.name = "left_folded", .flag = &s->left_folded, .most = 1},
        {.name = "right_folded", .flag = &s->right_folded, .most = 1},
        {.name = "bottom_folded", .flag = &s->bottom_folded, .most = 1},
        {.name = "hidden", .flag = &s->hidden, .most = 1},
        {.name = "width", .whole = &s->window[0], .least = 16, .most = 16384},
        {.name = "height", .whole = &s->window[1], .least = 16, .most = 16384}};
    memcpy(list, all, sizeof all);
}

void view_settings_read(struct overlay_settings *settings)
{
    struct setting list[SETTINGS];
    *settings = (struct overlay_settings){
        .left = 300, .right = 300, .bottom = 130, .font = 15, .window = {1280, 720}};
    list_settings(settings, list);
    read_settings(list);
}

void view_settings_write(const struct view *view)
{
    struct overlay_settings settings = view->settings;
    struct setting list[SETTINGS];
    list_settings(&settings, list);
    write_settings(list, &view->console->log);
}
