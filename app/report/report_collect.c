/* `diptych report --collect DIR`: one page of what the `run` of a bundle left in a folder:
 * devices, verdicts and times. Of each run, a pipeline in a scene, run has RUN.bench.json by bench
 * and, with two devices or more, RUN.json by compare. */
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/files.h"
#include "console/fill.h"
#include "base/foreign.h"
#include "base/printable.h"
#include "report/report.h"

#define BENCH_ENDING ".bench.json"

/* The folder's file NAME.txt; "" where it is not there; free(). */
static char *read_text(const char *folder, const char *name, const struct dt_log *log)
{
    size_t size;
    char *file = format_string("%s.txt", name);
    char *text = file && foreign_has(folder, file)
                     ? foreign_read(folder, file, FOREIGN_TEXT_BYTES, &size, log)
                     : strdup("");
    char *shown = text ? text_printable(text) : NULL;
    free(file);
    free(text);
    return shown;
}

/* NULL where it is not there, and, logged, where it is wrong. */
static cJSON *read_result(const char *folder, const char *name, const char *ending,
                          const struct dt_log *log)
{
    char *file = format_string("%s%s", name, ending);
    cJSON *result = file && foreign_has(folder, file) ? foreign_json(folder, file, log) : NULL;
    free(file);
    return result;
}

/* As run names its files: links to them are no scripts. */
static int is_bench(const struct dirent *entry)
{
    size_t length = strlen(entry->d_name), ending = strlen(BENCH_ENDING);
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
    return length > ending && entry->d_name[0] != '.' &&
           entry->d_name[strspn(entry->d_name, plain)] == 0 &&
           strcmp(entry->d_name + length - ending, BENCH_ENDING) == 0;
}

/* The first error that a verb told; "" where there is none. */
static const char *first_error(const cJSON *result)
{
    const cJSON *error;
    cJSON_ArrayForEach(error, cJSON_GetObjectItem(result, "errors"))
    {
        if (strcmp(step_text(error, "severity"), "error") == 0)
            return step_text(error, "message");
    }
    return "";
}

/* Of one pair of sides, as compare has it. */
static cJSON *verdict_json(const cJSON *pair)
{
    const cJSON *sides = cJSON_GetObjectItem(pair, "sides");
    const cJSON *guilty = cJSON_GetObjectItem(pair, "guilty");
    const cJSON *at = cJSON_IsObject(guilty) ? guilty : cJSON_GetObjectItem(pair, "first_break");
    cJSON *item = cJSON_CreateObject();
    cJSON_AddItemToObject(item, "first", cJSON_Duplicate(cJSON_GetArrayItem(sides, 0), false));
    cJSON_AddItemToObject(item, "second", cJSON_Duplicate(cJSON_GetArrayItem(sides, 1), false));
    cJSON_AddBoolToObject(item, "agree", cJSON_IsTrue(cJSON_GetObjectItem(pair, "agree")));
    cJSON_AddStringToObject(item, "pass", step_text(at, "pass"));
    cJSON_AddStringToObject(item, "resource", step_text(at, "resource"));
    return item;
}

static cJSON *verdicts_json(const char *run, const cJSON *result)
{
    const cJSON *pair, *pairs = cJSON_GetObjectItem(result, "pairs");
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "run", run);
    cJSON_AddStringToObject(item, "reason", first_error(result));
    cJSON *list = cJSON_AddArrayToObject(item, "verdicts");
    cJSON_ArrayForEach(pair, pairs) cJSON_AddItemToArray(list, verdict_json(pair));
    if (!pairs && cJSON_HasObjectItem(result, "sides"))
        cJSON_AddItemToArray(list, verdict_json(result));
    return item;
}

static cJSON *times_json(const char *run, const cJSON *result)
{
    static const char *const names[] = {"median", "p5", "p95"};
    const cJSON *side;
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "run", run);
    cJSON_AddStringToObject(item, "reason", first_error(result));
    cJSON *list = cJSON_AddArrayToObject(item, "times");
    cJSON_ArrayForEach(side, cJSON_GetObjectItem(result, "sides"))
    {
        cJSON *cell = cJSON_CreateObject();
        for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
            report_add_number(cell, names[i],
                              cJSON_GetNumberValue(cJSON_GetObjectItem(
                                  cJSON_GetObjectItem(side, "frame_ms"), names[i])));
        cJSON_AddItemToArray(list, cell);
    }
    return item;
}

/* Label and device of each side; bench has them in every result. */
static cJSON *sides_json(const cJSON *result)
{
    const cJSON *side;
    cJSON *list = cJSON_CreateArray();
    cJSON_ArrayForEach(side, cJSON_GetObjectItem(result, "sides"))
    {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "label", step_text(side, "side"));
        cJSON_AddStringToObject(item, "device", step_text(side, "device"));
        cJSON_AddStringToObject(item, "driver", step_text(side, "driver"));
        cJSON_AddItemToArray(list, item);
    }
    return list;
}

static void add_run(cJSON *page, const char *folder, const char *run, const struct dt_log *log)
{
    cJSON *bench = read_result(folder, run, BENCH_ENDING, log);
    cJSON *compare = read_result(folder, run, ".json", log);
    cJSON_AddItemToArray(cJSON_GetObjectItem(page, "times_of"), times_json(run, bench));
    if (compare)
        cJSON_AddItemToArray(cJSON_GetObjectItem(page, "verdicts_of"), verdicts_json(run, compare));
    if (!cJSON_GetArraySize(cJSON_GetObjectItem(page, "sides")))
        cJSON_ReplaceItemInObject(page, "sides", sides_json(bench));
    cJSON_Delete(compare);
    cJSON_Delete(bench);
}

static bool is_link(const char *path)
{
    struct stat info;
    return lstat(path, &info) == 0 && S_ISLNK(info.st_mode);
}

static void free_runs(struct dirent **runs, int count)
{
    for (int i = 0; i < count; i++)
        free(runs[i]);
    free(runs);
}

int report_collect(struct console *console, const char *folder)
{
    static const char *const texts[] = {"version", "machine", "refused"};
    const struct dt_log *log = &console->log;
    struct dirent **runs = NULL;
    int count = scandir(folder, &runs, is_bench, alphasort);
    if (count <= 0) {
        report_error(log, "%s: %s", folder,
                     count ? strerror(errno)
                           : "holds no results; name the folder that a bundle's `run` left");
        return EXIT_USAGE;
    }
    char *path = format_string("%s/index.html", folder);
    if (!path || is_link(path)) {
        report_error(log,
                     path ? "%s: is a symbolic link, which a folder of others may not have"
                          : "out of memory",
                     path);
        free(path);
        free_runs(runs, count);
        return EXIT_FAILED;
    }
    cJSON *page = cJSON_CreateObject();
    for (size_t i = 0; i < DT_ARRAY_COUNT(texts); i++) {
        char *text = read_text(folder, texts[i], log);
        cJSON_AddStringToObject(page, texts[i], text ? text : "");
        free(text);
    }
    cJSON_AddArrayToObject(page, "sides");
    cJSON_AddArrayToObject(page, "verdicts_of");
    cJSON_AddArrayToObject(page, "times_of");
    for (int i = 0; i < count; i++) {
        runs[i]->d_name[strlen(runs[i]->d_name) - strlen(BENCH_ENDING)] = 0;
        add_run(page, folder, runs[i]->d_name, log);
    }
    bool good = !atomic_load(&console->errors) && fill_page(console, "collect.html", path, page);
    if (good)
        printf("%s\n", path);
    cJSON_Delete(page);
    free_runs(runs, count);
    free(path);
    return good ? EXIT_FINE : EXIT_FAILED;
}
