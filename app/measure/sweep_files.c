/* The files of a sweep: list of commands, ninja file with an edge per run, and the script that
 * starts one run. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/quote.h"
#include "measure/steps.h"
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

/* A run that differs is finished. A run that could not run fails its edge and is tried again. An
 * interrupt also ends the script, which then leaves no result. */
static void write_runner(FILE *out, const void *sweep)
{
    (void)sweep;
    fputs("#!/bin/sh\n"
          "# sh run.sh NUMBER COMMAND...: one run of the sweep. Leaves what it says in\n"
          "# runs/NUMBER.txt, its exit status and milliseconds in runs/NUMBER.result.\n"
          "cd \"$(dirname \"$0\")\" || exit 2\n"
          "number=$1\n"
          "shift\n"
          "begin=$(date +%s%N)\n"
          "\"$@\" >\"runs/$number.txt\" 2>&1 </dev/null\n"
          "status=$?\n"
          "echo \"$status $((($(date +%s%N) - begin) / 1000000))\" >\"runs/$number.part\"\n"
          "mv \"runs/$number.part\" \"runs/$number.result\"\n"
          "[ $status -le 1 ] || exit $status\n",
          out);
}

static void write_commands(FILE *out, const void *sweep)
{
    const cJSON *run;
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(sweep, "runs"))
        fprintf(out, "%s\n", sweep_text(run, "command"));
}

static void write_ninja(FILE *out, const void *sweep)
{
    const cJSON *item;
    int number = 0;
    fputs("# One edge per run; `ninja -k 0` here goes on where it was left.\n"
          "rule run\n"
          "  command = sh run.sh $number $command_line\n"
          "  description = run $number: $what\n\n"
          "build inputs: phony",
          out);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(sweep, "inputs"))
    {
        fputc(' ', out);
        quote_path(out, item->valuestring);
    }
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(sweep, "runs"))
    {
        const char *scene = strrchr(sweep_text(item, "scene"), '/');
        fprintf(out, "\nbuild runs/%d.result: run | inputs\n  number = %d\n  what = ", number + 1,
                number + 1);
        quote_value(out, scene ? scene + 1 : "");
        fprintf(out, " %ux%u\n  command_line = ", sweep_number(item, "width"),
                sweep_number(item, "height"));
        quote_value(out, sweep_text(item, "command"));
        fputc('\n', out);
        number++;
    }
}

/* ---- Writing --------------------------------------------------------------------------------- */

bool sweep_write(const cJSON *sweep, const char *folder, const struct dt_log *log)
{
    static const struct {
        const char *name;
        content_writer *writer;
    } files[] = {
        {"commands", write_commands},
        {"run.sh", write_runner},
        {"build.ninja", write_ninja},
    };
    char *runs = format_string("%s/runs", folder);
    char *manifest = format_string("%s/sweep.json", folder);
    bool good = runs && manifest && file_make_folders(runs, log);
    for (size_t i = 0; i < DT_ARRAY_COUNT(files) && good; i++)
        good = content_write(folder, files[i].name, files[i].writer, sweep, log);
    good = good && file_write_json(manifest, sweep, log); /* last: marks the folder as a sweep's */
    free(manifest);
    free(runs);
    return good;
}
