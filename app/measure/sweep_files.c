/* The files of a sweep: the list of commands, and a ninja file with an edge per run. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/quote.h"
#include "measure/ninja.h"
#include "measure/sweep.h"

/* ---- Commands -------------------------------------------------------------------------------- */

static void put_command(FILE *out, const cJSON *sweep, const cJSON *run, const char *folder,
                        int number)
{
    static const char *const texts[] = {"backend", "scenes", "device", "context", "fault"};
    static const char *const flags[] = {"glsl", "debug"};
    const cJSON *options = cJSON_GetObjectItem(sweep, "options"), *set, *input;
    quote_word(out, cJSON_GetObjectItem(sweep, "inputs")->child->valuestring);
    fputs(" compare", out);
    if (*sweep_text(run, "scene"))
        quote_option(out, "--scene", sweep_text(run, "scene"));
    quote_option(out, "--spec", sweep_text(options, "spec"));
    fprintf(out, " --size %ux%u --frames %u", sweep_number(run, "width"),
            sweep_number(run, "height"), sweep_number(run, "frames"));
    for (size_t i = 0; i < DT_ARRAY_COUNT(texts); i++) {
        const cJSON *item = cJSON_GetObjectItem(options, texts[i]);
        if (item)
            fprintf(out, " --%s ", texts[i]);
        if (item)
            quote_word(out, item->valuestring);
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(flags); i++)
        if (cJSON_IsTrue(cJSON_GetObjectItem(options, flags[i])))
            fprintf(out, " --%s", flags[i]);
    cJSON_ArrayForEach(set, cJSON_GetObjectItem(run, "sets"))
        quote_option(out, "--set", set->valuestring);
    cJSON_ArrayForEach(input, cJSON_GetObjectItem(options, "input"))
        quote_option(out, "--input", input->valuestring);
    char *json = format_string("%s/runs/%d.json", folder, number);
    if (json)
        quote_option(out, "--json", json);
    free(json);
}

bool sweep_add_commands(cJSON *sweep, const char *folder, const struct dt_log *log)
{
    int number = 0;
    cJSON *run;
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(sweep, "runs"))
    {
        char *command = NULL;
        size_t size;
        FILE *out = open_memstream(&command, &size);
        if (out)
            put_command(out, sweep, run, folder, ++number);
        bool good = out && fclose(out) == 0;
        cJSON_DeleteItemFromObject(run, "command"); /* the folder may have moved since */
        if (good)
            cJSON_AddStringToObject(run, "command", command);
        free(command);
        if (!good) {
            report_error(log, "out of memory");
            return false;
        }
    }
    return true;
}

/* ---- The files' contents --------------------------------------------------------------------- */

static void write_commands(FILE *out, const void *sweep)
{
    const cJSON *run;
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(sweep, "runs"))
        fprintf(out, "%s\n", sweep_text(run, "command"));
}

/* A run that differs is finished. A run that could not run fails its edge and is tried again. */
static void write_run(FILE *out, const cJSON *run, int number)
{
    const char *scene = strrchr(sweep_text(run, "scene"), '/');
    char file[32], what[200];
    snprintf(file, sizeof file, "runs/%d.result", number);
    snprintf(what, sizeof what, "%d: %s %ux%u", number, scene ? scene + 1 : "",
             sweep_number(run, "width"), sweep_number(run, "height"));
    char *line = format_string("begin=$(date +%%s%%N); %s 2>&1 </dev/null; status=$?; "
                               "echo \"$status $((($(date +%%s%%N) - begin) / 1000000))\" >%s; "
                               "[ $status -le 1 ]",
                               sweep_text(run, "command"), file);
    ninja_edge(out, file, "inputs");
    ninja_end(out, what, line ? line : "false"); /* out of memory: the run fails */
    free(line);
}

static void write_ninja(FILE *out, const void *sweep)
{
    const cJSON *item;
    int number = 0;
    ninja_begin(out, "sweep", false);
    ninja_group(out, "inputs");
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(sweep, "inputs"))
        ninja_path(out, item->valuestring);
    ninja_end(out, NULL, NULL);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(sweep, "runs")) write_run(out, item, ++number);
}

/* ---- Writing --------------------------------------------------------------------------------- */

bool sweep_write(const cJSON *sweep, const char *folder, const struct dt_log *log)
{
    char *runs = format_string("%s/runs", folder);
    char *manifest = format_string("%s/sweep.json", folder);
    bool good = runs && manifest && file_make_folders(runs, log) &&
                content_write(folder, "commands", write_commands, sweep, log) &&
                content_write(folder, "build.ninja", write_ninja, sweep, log) &&
                file_write_json(manifest, sweep, log); /* last: marks the folder as a sweep's */
    free(manifest);
    free(runs);
    return good;
}
