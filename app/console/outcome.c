/* The JSON of every verb; see outcome.h. */
#include "console/outcome.h"

#include <cjson/cJSON.h>
#include <stdlib.h>

#include "base/files.h"

enum { OUTCOME_FORMAT = 1 };

static cJSON *outcome_json(const struct console *console, const char *verb, int status)
{
    char *errors = format_string("[%s\n  ]", console->kept.data ? console->kept.data : "");
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "verb", verb);
    cJSON_AddNumberToObject(root, "format", OUTCOME_FORMAT);
    cJSON_AddNumberToObject(root, "exit_status", status);
    cJSON_AddRawToObject(root, "errors", errors ? errors : "[]");
    free(errors);
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
