/* What came out of a sweep: the results of its runs as a table, JSON and CSV. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "measure/sweep.h"

enum { SETTINGS_WIDTH = 60 };

/* MAY_DIFFER: it does, and its spec promises no equal bits. */
enum run_verdict { AGREE, DIFFER, MAY_DIFFER, FAILED, NOT_RUN, VERDICTS };
static const char *const verdict_names[VERDICTS] = {"agree", "differ", "may differ", "failed",
                                                    "not run"};

struct result {
    const cJSON *run;
    enum run_verdict verdict;
    double seconds;
    char *pass, *resource; /* where they differ, or NULL */
    char *error;           /* why it failed, or NULL */
    char *settings;        /* with blanks between */
};

/* ---- Reading --------------------------------------------------------------------------------- */

static char *read_run_file(const char *folder, int number, const char *ending,
                           const struct dt_log *log)
{
    char *path = format_string("%s/runs/%d.%s", folder, number, ending);
    size_t size;
    char *text = path && file_exists(path) ? file_read(path, &size, log) : NULL;
    free(path);
    return text;
}

/* The guilty pass of a comparison, or the first that broke; of several pairs, the first that has one. */
static const cJSON *find_place(const cJSON *report)
{
    static const char *const names[] = {"guilty", "first_break"};
    const cJSON *pair;
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
        if (cJSON_IsObject(cJSON_GetObjectItem(report, names[i])))
            return cJSON_GetObjectItem(report, names[i]);
    cJSON_ArrayForEach(pair, cJSON_GetObjectItem(report, "pairs"))
    {
        const cJSON *place = find_place(pair);
        if (place)
            return place;
    }
    return NULL;
}

static char *copy_member(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text ? strdup(text) : NULL;
}

static void read_place(struct result *result, const char *folder, int number,
                       const struct dt_log *log)
{
    char *text = read_run_file(folder, number, "json", log);
    cJSON *report = text ? cJSON_Parse(text) : NULL;
    const cJSON *place = find_place(report);
    result->pass = copy_member(place, "pass");
    result->resource = copy_member(place, "resource");
    cJSON_Delete(report);
    free(text);
}

/* The first line that tells an error, else the last. */
static char *read_error(const char *folder, int number, const struct dt_log *log)
{
    char *text = read_run_file(folder, number, "result.txt", log);
    char *at = text ? strstr(text, "error:") : NULL;
    size_t length = text ? strlen(text) : 0;
    while (text && !at && length > 0 && text[length - 1] == '\n')
        text[--length] = 0;
    if (text && !at)
        at = text + length;
    while (at && at > text && at[-1] != '\n')
        at--;
    char *line = at ? strndup(at, strcspn(at, "\n")) : NULL;
    free(text);
    return line;
}

static char *join_settings(const cJSON *run)
{
    char *text = NULL;
    size_t size;
    const cJSON *set;
    FILE *out = open_memstream(&text, &size);
    const char *separator = "";
    if (!out)
        return NULL;
    cJSON_ArrayForEach(set, cJSON_GetObjectItem(run, "sets"))
    {
        fprintf(out, "%s%s", separator, set->valuestring);
        separator = " ";
    }
    fclose(out);
    return text;
}

static void read_result(struct result *result, const cJSON *run, const char *folder, int number,
                        const struct dt_log *log)
{
    int status = -1;
    long milliseconds = 0;
    char *text = read_run_file(folder, number, "result", log);
    text = text ? text : read_run_file(folder, number, "result.failed", log);
    bool over = text && sscanf(text, "%d %ld", &status, &milliseconds) == 2;
    free(text);
    *result = (struct result){.run = run,
                              .verdict = NOT_RUN,
                              .seconds = (double)milliseconds / 1000,
                              .settings = join_settings(run)};
    if (!over)
        return;
    bool exact = cJSON_IsTrue(cJSON_GetObjectItem(run, "exact"));
    result->verdict = status == 0 ? AGREE : status != 1 ? FAILED : exact ? DIFFER : MAY_DIFFER;
    if (status == 1)
        read_place(result, folder, number, log);
    else if (status != 0)
        result->error = read_error(folder, number, log);
}

/* ---- Writing --------------------------------------------------------------------------------- */

static void add_result(cJSON *list, const struct result *result, int number)
{
    cJSON *root = cJSON_Duplicate(result->run, true);
    cJSON_AddNumberToObject(root, "run", number);
    cJSON_AddStringToObject(root, "verdict", verdict_names[result->verdict]);
    cJSON_AddNumberToObject(root, "seconds", result->seconds);
    if (result->pass)
        cJSON_AddStringToObject(root, "pass", result->pass);
    if (result->resource)
        cJSON_AddStringToObject(root, "resource", result->resource);
    if (result->error)
        cJSON_AddStringToObject(root, "error", result->error);
    cJSON_AddItemToArray(list, root);
}

static cJSON *summary_json(const struct result *results, int count, const int totals[VERDICTS],
                           const cJSON *sweep)
{
    cJSON *root = cJSON_CreateObject();
    for (int i = 0; i < VERDICTS; i++)
        cJSON_AddNumberToObject(root, verdict_names[i], totals[i]);
    cJSON_AddNumberToObject(root, "redrawn",
                            cJSON_GetArraySize(cJSON_GetObjectItem(sweep, "redrawn")));
    cJSON *list = cJSON_AddArrayToObject(root, "runs");
    for (int i = 0; i < count; i++)
        add_result(list, &results[i], i + 1);
    return root;
}

static void put_quoted_field(FILE *out, const char *text, char end)
{
    fputc('"', out);
    for (; text && *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text, out);
    }
    fprintf(out, "\"%c", end);
}

static bool write_csv(const struct result *results, int count, const char *path,
                      const struct dt_log *log)
{
    struct file_draft draft;
    if (!file_draft_begin(&draft, log))
        return false;
    FILE *out = draft.out;
    fputs("run,verdict,pass,resource,seconds,scene,width,height,frames,settings,error\n", out);
    for (int i = 0; i < count; i++) {
        const struct result *result = &results[i];
        fprintf(out, "%d,%s,", i + 1, verdict_names[result->verdict]);
        put_quoted_field(out, result->pass, ',');
        put_quoted_field(out, result->resource, ',');
        fprintf(out, "%.3f,", result->seconds);
        put_quoted_field(out, sweep_text(result->run, "scene"), ',');
        fprintf(out, "%u,%u,%u,", sweep_number(result->run, "width"),
                sweep_number(result->run, "height"), sweep_number(result->run, "frames"));
        put_quoted_field(out, result->settings, ',');
        put_quoted_field(out, result->error, '\n');
    }
    return file_draft_end(&draft, path, log);
}

/* ---- The table ------------------------------------------------------------------------------- */

static void print_run(const struct result *result, int number)
{
    const char *scene = strrchr(sweep_text(result->run, "scene"), '/');
    const char *settings = result->settings ? result->settings : "";
    char size[32];
    snprintf(size, sizeof size, "%ux%u", sweep_number(result->run, "width"),
             sweep_number(result->run, "height"));
    printf("%5d  %-10s %8.2f  %-18s %9s %6u  %.*s%s\n", number, verdict_names[result->verdict],
           result->seconds, scene ? scene + 1 : "", size, sweep_number(result->run, "frames"),
           SETTINGS_WIDTH, settings, strlen(settings) > SETTINGS_WIDTH ? "..." : "");
}

/* What is to be looked at, with the command that shows it. */
static void print_case(const struct result *result, int number)
{
    const char *command = sweep_text(result->run, "command");
    if (result->verdict == DIFFER || result->verdict == MAY_DIFFER)
        printf("\nrun %d: pass %s, resource %s\n  %s\n", number,
               result->pass ? result->pass : "unknown",
               result->resource ? result->resource : "unknown", command);
    else if (result->verdict == FAILED)
        printf("\nrun %d: %s\n  %s\n", number, result->error ? result->error : "", command);
}

static void print_runs(const struct result *results, int count, const int totals[VERDICTS])
{
    double seconds = 0;
    printf("%5s  %-10s %8s  %-18s %9s %6s  %s\n", "run", "verdict", "seconds", "scene", "size",
           "frames", "settings");
    for (int i = 0; i < count; i++) {
        print_run(&results[i], i + 1);
        seconds += results[i].seconds;
    }
    for (int i = 0; i < count; i++)
        print_case(&results[i], i + 1);
    printf("\n%d runs, %.1f s of work:", count, seconds);
    for (int i = 0; i < VERDICTS; i++)
        if (totals[i] || i <= DIFFER)
            printf("%s %d %s", i ? "," : "", totals[i], verdict_names[i]);
    printf("\n");
}

/* ---- All of it ------------------------------------------------------------------------------- */

static bool write_summary(struct console *console, const struct result *results, int count,
                          const int totals[VERDICTS], const cJSON *sweep, const char *folder)
{
    char *json = format_string("%s/summary.json", folder);
    char *csv = format_string("%s/summary.csv", folder);
    console_hold(console);
    console->result = summary_json(results, count, totals, sweep);
    bool good = json && csv && file_write_json(json, console->result, &console->log) &&
                write_csv(results, count, csv, &console->log);
    console_release(console);
    free(csv);
    free(json);
    return good && sweep_write_page(console, folder, cJSON_GetObjectItem(console->result, "runs"),
                                    NULL, "summary.csv");
}

int sweep_summarise(struct console *console, const cJSON *sweep, const char *folder)
{
    const cJSON *run, *runs = cJSON_GetObjectItem(sweep, "runs");
    int count = cJSON_GetArraySize(runs), totals[VERDICTS] = {0}, number = 0;
    struct result *results = calloc((size_t)count + 1, sizeof *results);
    if (!results) {
        report_error(&console->log, "out of memory");
        return EXIT_USAGE;
    }
    cJSON_ArrayForEach(run, runs)
    {
        read_result(&results[number], run, folder, number + 1, &console->log);
        totals[results[number++].verdict]++;
    }
    bool good = write_summary(console, results, count, totals, sweep, folder);
    print_runs(results, count, totals);
    for (int i = 0; i < count; i++) {
        free(results[i].pass);
        free(results[i].resource);
        free(results[i].error);
        free(results[i].settings);
    }
    free(results);
    if (!good || totals[FAILED] || totals[NOT_RUN])
        return EXIT_USAGE;
    return totals[DIFFER] ? EXIT_DIFFER : EXIT_FINE;
}
