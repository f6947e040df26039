/* The JSON of every verb; see outcome.h. */
#include "console/outcome.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/place.h"

enum { OUTCOME_FORMAT = 1 };

static void add_text(cJSON *item, const char *name, const char *text, size_t length)
{
    char *copy = strndup(text, length);
    cJSON_AddStringToObject(item, name, copy ? copy : "");
    free(copy);
}

static void add_placed(cJSON *list, const char *line, const struct place *place)
{
    cJSON *item = cJSON_CreateObject();
    add_text(item, "severity", place->level, strcspn(place->level, ":"));
    add_text(item, "message", place->text, strcspn(place->text, "\n"));
    add_text(item, "file", line, place->path_length);
    cJSON_AddNumberToObject(item, "line", place->line);
    cJSON_AddNumberToObject(item, "column", place->column);
    cJSON_AddItemToArray(list, item);
}

/* Text that begins with a place may hold several messages, with source lines and carets between
 * them. */
static void add_message(cJSON *list, const struct console_message *message)
{
    struct place place;
    if (!place_read(message->text, &place)) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "severity", message->level == DT_ERROR ? "error" : "warning");
        cJSON_AddStringToObject(item, "message", message->text);
        cJSON_AddItemToArray(list, item);
        return;
    }
    for (const char *line = message->text; *line; line += *line == '\n') {
        if (place_read(line, &place))
            add_placed(list, line, &place);
        line += strcspn(line, "\n");
    }
}

static cJSON *outcome_json(const struct console *console, const char *verb, int status)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "verb", verb);
    cJSON_AddNumberToObject(root, "format", OUTCOME_FORMAT);
    cJSON_AddNumberToObject(root, "exit_status", status);
    cJSON *errors = cJSON_AddArrayToObject(root, "errors");
    for (unsigned i = 0; i < console->kept_count; i++)
        add_message(errors, &console->kept[i]);
    while (console->result && console->result->child) {
        cJSON *item = cJSON_DetachItemViaPointer(console->result, console->result->child);
        cJSON_AddItemToObject(root, item->string, item);
    }
    return root;
}

bool outcome_write(struct console *console, const char *verb, const char *path, int status)
{
    cJSON *root = outcome_json(console, verb, status);
    console_hold(console);
    bool good = file_write_json(path, root, &console->log);
    console_release(console);
    cJSON_Delete(root);
    return good;
}
