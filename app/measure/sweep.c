/* `diptych sweep`: runs `compare` over many variations of a spec, scenes and sizes. Writes a folder
 * with an edge per run in a ninja file, starts ninja there, and summarises. Finished runs are kept:
 * the same command continues an interrupted sweep. sweep_grid.c does --measure. */
#include "measure/sweep.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "console/folder.h"
#include "measure/ninja.h"

const char *sweep_text(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text ? text : "";
}

uint32_t sweep_number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    return cJSON_IsNumber(item) && item->valuedouble > 0 ? (uint32_t)item->valuedouble : 0;
}

/* ---- The folder ------------------------------------------------------------------------------ */

/* Reads the folder's sweep; NULL with *good true when there is none. */
static cJSON *read_sweep(const char *folder, bool wanted, bool *good, const struct dt_log *log)
{
    char *path = format_string("%s/sweep.json", folder);
    size_t size;
    cJSON *sweep = NULL;
    *good = path;
    if (path && (wanted || file_exists(path))) {
        char *text = file_read(path, &size, log);
        sweep = text ? cJSON_Parse(text) : NULL;
        *good = cJSON_IsArray(cJSON_GetObjectItem(sweep, "runs"));
        if (text && !*good)
            report_error(log, "%s: is no file of diptych sweep", path);
        free(text);
    } else if (path && !folder_is_empty(folder)) {
        report_error(log, "%s: holds files, but no sweep; give another folder", folder);
        *good = false;
    }
    free(path);
    return sweep;
}

/* Whether the folder's sweep has the same options; logs the first difference. */
static bool is_same_sweep(const cJSON *former, const cJSON *wanted, const char *folder,
                          const struct dt_log *log)
{
    const cJSON *old = cJSON_GetObjectItem(former, "options"), *item;
    if (cJSON_Compare(old, wanted, true))
        return true;
    const char *name = cJSON_HasObjectItem(old, "random") ? "random" : "grid";
    cJSON_ArrayForEach(item, wanted)
    {
        if (!cJSON_Compare(item, cJSON_GetObjectItem(old, item->string), true)) {
            name = item->string;
            break;
        }
    }
    char *was = cJSON_PrintUnformatted(cJSON_GetObjectItem(old, name));
    report_error(log, "%s: holds another sweep, with --%s %s; give another folder, or remove it",
                 folder, name, was ? was : "not given");
    cJSON_free(was);
    return false;
}

/* ---- The verb -------------------------------------------------------------------------------- */

static void tell_redrawn(const struct console *console, const cJSON *sweep, const char *folder)
{
    int redrawn = cJSON_GetArraySize(cJSON_GetObjectItem(sweep, "redrawn"));
    if (redrawn)
        report_message(&console->log, DT_INFO,
                       "%d draws were invalid specs or too large and were drawn again; "
                       "%s/sweep.json lists them",
                       redrawn, folder);
}

/* Plans a sweep, or continues the folder's. NULL with the error logged. */
static cJSON *make_sweep(struct console *console, const struct options *options)
{
    const struct dt_log *log = &console->log;
    bool good = false;
    cJSON *wanted = sweep_options(console, options);
    cJSON *former = wanted ? read_sweep(options->output, false, &good, log) : NULL;
    if (former && good && is_same_sweep(former, wanted, options->output, log)) {
        cJSON_Delete(wanted);
        return former;
    }
    cJSON *sweep = wanted && good && !former ? cJSON_CreateObject() : NULL;
    if (sweep) {
        cJSON_AddItemToObject(sweep, "options", wanted);
        good = sweep_plan(sweep, console);
    } else {
        cJSON_Delete(wanted);
    }
    cJSON_Delete(former);
    if (sweep && good)
        return sweep;
    cJSON_Delete(sweep);
    return NULL;
}

static char *make_folder(const char *path, const struct dt_log *log)
{
    char *real = file_make_folders(path, log) ? realpath(path, NULL) : NULL;
    if (real && strchr(real, '\n')) {
        report_error(log, "%s: a ninja file cannot hold a path with a line break", real);
        free(real);
        return NULL;
    }
    return real;
}

static int run_sweep(struct console *console, const struct options *options, cJSON *sweep)
{
    const struct dt_log *log = &console->log;
    char *folder = make_folder(options->output, log);
    int status = EXIT_USAGE;
    bool good = folder && sweep_add_commands(sweep, folder, log);
    console_hold(console);
    good = good && sweep_write(sweep, folder, log);
    console_release(console);
    if (good)
        tell_redrawn(console, sweep, folder);
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t jobs = options->jobs ? options->jobs : processors > 0 ? (uint32_t)processors : 1;
    if (good &&
        ninja_run(console, folder, jobs, false, NULL, NULL)) /* what failed is in the results */
        status = sweep_summarise(console, sweep, folder);
    free(folder);
    return status;
}

int verb_sweep(struct console *console, const struct options *options)
{
    bool good = true, measures = false;
    if (!sweep_measures(options, &measures, &console->log))
        return EXIT_USAGE;
    if (measures)
        return sweep_measure(console, options);
    cJSON *sweep = options->collect ? read_sweep(options->output, true, &good, &console->log)
                                    : make_sweep(console, options);
    int status = EXIT_USAGE;
    if (sweep && good)
        status = options->collect ? sweep_summarise(console, sweep, options->output)
                                  : run_sweep(console, options, sweep);
    cJSON_Delete(sweep);
    return status;
}
