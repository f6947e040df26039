/* `diptych sweep` and `diptych report`, which Python does: app/python/diptych. What only this program knows is handed over. */
#include <stdlib.h>

#include "base/installed.h"
#include "console/python.h"
#include "run/side.h"

static int start_python(struct console *console, const struct options *options, const char *verb,
                        enum verb_id id)
{
    struct sides sides = {0};
    char *templates = templates_folder(&console->log);
    if (!templates || !sides_read_each(&sides, &options->setup, &console->log)) {
        sides_free(&sides);
        free(templates);
        return EXIT_USAGE;
    }
    cJSON *request = options_json(options, id);
    cJSON *labels = cJSON_AddArrayToObject(request, "sides");
    for (uint32_t i = 0; i < sides.count; i++)
        cJSON_AddItemToArray(labels, cJSON_CreateString(sides.list[i].label));
    cJSON_AddStringToObject(request, "templates", templates);
    sides_free(&sides);
    free(templates);
    return python_verb(console, verb, request);
}

int verb_sweep(struct console *console, const struct options *options)
{
    return start_python(console, options, "sweep", VERB_SWEEP);
}

int verb_report(struct console *console, const struct options *options)
{
    return start_python(console, options, "report", VERB_REPORT);
}
