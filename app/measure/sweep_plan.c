/* Plans the runs of a sweep: random variations of a spec, made by the generator, or a grid over
 * values. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/tool.h"
#include "spec/inputs.h"
#include "spec/pipeline.h"
#include "measure/sweep.h"

enum { MOST_RUNS = 100000, DEFAULT_MEMORY = 64 };

/* ---- Options --------------------------------------------------------------------------------- */

static void add_texts(cJSON *object, const char *name, const struct text_list *list)
{
    cJSON *array = cJSON_AddArrayToObject(object, name);
    for (uint32_t i = 0; i < list->count; i++)
        cJSON_AddItemToArray(array, cJSON_CreateString(list->items[i]));
}

static void add_text(cJSON *object, const char *name, const char *text)
{
    if (text)
        cJSON_AddStringToObject(object, name, text);
}

/* Adds the absolute path, since the runs start elsewhere, behind `length` bytes of `item` that stand
 * before it. */
static bool add_path_behind(cJSON *array, const char *item, size_t length, const struct dt_log *log)
{
    const char *path = item + length;
    char *real = realpath(path, NULL);
    bool good = real && !strpbrk(real, "\n|");
    char *text = good ? format_string("%.*s%s", (int)length, item, real) : NULL;
    if (!real)
        report_error(log, "%s: cannot be read: %s", path, strerror(errno));
    else if (!good)
        report_error(log, "%s: a ninja file cannot hold a path with a line break or a |", real);
    else
        cJSON_AddItemToArray(array, cJSON_CreateString(text ? text : real));
    free(text);
    free(real);
    return good;
}

static bool add_path(cJSON *array, const char *path, const struct dt_log *log)
{
    return add_path_behind(array, path, 0, log);
}

bool sweep_default_size(struct console *console, const struct options *options,
                        const char *otherwise, char text[32])
{
    struct options own = *options;
    struct pipeline pipeline;
    memset(own.setup.size, 0, sizeof own.setup.size);
    own.setup.default_size = true;
    snprintf(text, 32, "%s", otherwise);
    if (!options->setup.inputs.count)
        return true;
    bool good = pipeline_load(&pipeline, console, &own.setup) &&
                inputs_find_size(&pipeline, &own.setup, &console->log);
    if (good && own.setup.size[0])
        snprintf(text, 32, "%ux%u", own.setup.size[0], own.setup.size[1]);
    pipeline_unload(&pipeline);
    return good;
}

static bool add_runs_wanted(cJSON *root, struct console *console, const struct options *options)
{
    char text[32] = "";
    const char *size = text;
    bool given = options->size_list.count;
    if (!given && !sweep_default_size(console, options, options->random ? "" : "64x64", text))
        return false;
    const struct text_list one_size = {&size, *text != 0}; /* none: random */
    if (options->random) {
        cJSON_AddNumberToObject(root, "random", options->random);
        cJSON_AddNumberToObject(root, "seed", options->seed ? options->seed : 1);
        cJSON_AddNumberToObject(root, "memory", options->memory ? options->memory : DEFAULT_MEMORY);
    } else {
        add_texts(root, "grid", &options->grid);
    }
    add_texts(root, "size", given ? &options->size_list : &one_size);
    cJSON_AddNumberToObject(root, "frames", options->run_frames);
    return true;
}

bool sweep_check_row(const char *row, const struct dt_log *log)
{
    const char *equals = strchr(row, '=');
    bool good = equals && equals > row && equals[1];
    if (!good)
        report_error(log, "--grid %s: must be PATH=V1,V2,..., like clusters=4,8", row);
    return good;
}

static bool check_wanted(const struct options *options, const struct dt_log *log)
{
    const char *wrong = !options->random == !options->grid.count
                            ? "give --random N or --grid PATH=V1,V2,..."
                        : options->memory && !options->random ? "--memory goes with --random"
                                                              : NULL;
    if (wrong)
        report_error(log, "sweep: %s; see diptych sweep --help", wrong);
    for (uint32_t i = 0; i < options->grid.count && !wrong; i++)
        wrong = sweep_check_row(options->grid.items[i], log) ? NULL : "grid";
    uint32_t size[2];
    for (uint32_t i = 0; i < options->size_list.count && !wrong; i++)
        wrong = option_size(options->size_list.items[i], size, log) ? NULL : "size";
    return !wrong;
}

/* Options that change a run or its verdict, under the names of the command line. */
cJSON *sweep_options(struct console *console, const struct options *options)
{
    const struct dt_log *log = &console->log;
    if (!check_wanted(options, log))
        return NULL;
    char *spec = pipeline_spec_path(options->setup.spec, log);
    char *folder = options->setup.scenes ? realpath(options->setup.scenes, NULL) : NULL;
    cJSON *root = cJSON_CreateObject();
    bool good = spec;
    add_text(root, "spec", spec);
    cJSON *scenes = cJSON_AddArrayToObject(root, "scene");
    for (uint32_t i = 0; i < options->scene_list.count; i++) {
        char *path = good ? find_scene(options->scene_list.items[i], log) : NULL;
        good = path && add_path(scenes, path, log);
        free(path);
    }
    if (!options->scene_list.count) /* runs without a scene */
        cJSON_AddItemToArray(scenes, cJSON_CreateString(""));
    cJSON *inputs = cJSON_AddArrayToObject(root, "input");
    for (uint32_t i = 0; i < options->setup.inputs.count; i++)
        good = good && add_path_behind(inputs, options->setup.inputs.items[i],
                                       strcspn(options->setup.inputs.items[i], "=") + 1, log);
    if (options->setup.scenes && !folder) {
        report_error(log, "--scenes %s: %s", options->setup.scenes, strerror(errno));
        good = false;
    }
    add_texts(root, "set", &(struct text_list){options->setup.sets, options->setup.set_count});
    good = good && add_runs_wanted(root, console, options);
    add_text(root, "scenes", folder);
    add_text(root, "backend", options->setup.backend);
    add_text(root, "device", options->setup.device);
    add_text(root, "context", options->setup.context);
    add_text(root, "fault", options->fault);
    cJSON_AddBoolToObject(root, "glsl", options->setup.glsl);
    cJSON_AddBoolToObject(root, "debug", options->setup.debug);
    free(folder);
    free(spec);
    if (good)
        return root;
    cJSON_Delete(root);
    return NULL;
}

/* ---- Variations ------------------------------------------------------------------------------- */

/* The values that point `index` of the grid takes; the last row turns fastest. */
static cJSON *grid_sets(const cJSON *grid, uint32_t index)
{
    cJSON *sets = cJSON_CreateArray();
    for (int i = cJSON_GetArraySize(grid) - 1; i >= 0; i--) {
        const char *row = cJSON_GetArrayItem(grid, i)->valuestring;
        uint32_t width = sweep_row_width(row);
        char *set = sweep_row_value(row, index % width);
        cJSON_InsertItemInArray(sets, 0, cJSON_CreateString(set ? set : row));
        free(set);
        index /= width;
    }
    return sets;
}

/* The list of variations, none of them when the sweep is a grid, and of the files that the
 * spec is made of; NULL, logged. */
static cJSON *vary_spec(struct console *console, const cJSON *options)
{
    const cJSON *sets = cJSON_GetObjectItem(options, "set"), *set;
    bool random = cJSON_HasObjectItem(options, "random");
    char *folder = tools_folder(&console->log), *templates = templates_folder(&console->log);
    char *cache = folder ? pipeline_cache(folder) : NULL; /* the runs find their shaders there */
    /* a grid's first point shows whether the spec knows its names, before a run starts */
    cJSON *point =
        random ? cJSON_CreateArray() : grid_sets(cJSON_GetObjectItem(options, "grid"), 0);
    int most = cJSON_GetArraySize(sets) + cJSON_GetArraySize(point);
    struct plan_request request = {
        .spec = sweep_text(options, "spec"), .templates = templates, .cache = cache};
    const char **list = calloc((size_t)most + 1, sizeof *list);
    for (set = list ? sets->child : NULL; set; set = set->next)
        list[request.set_count++] = set->valuestring;
    for (set = list ? point->child : NULL; set; set = set->next)
        list[request.set_count++] = set->valuestring;
    request.sets = list;
    cJSON *answer = NULL;
    if (list && folder && templates)
        answer = plan_variations(
            &request, random ? sweep_number(options, "random") : 0,
            random ? sweep_number(options, "seed") : 1,
            (uint64_t)(random ? sweep_number(options, "memory") : DEFAULT_MEMORY) << 20, console);
    if (!list)
        report_error(&console->log, "out of memory");
    free(list);
    cJSON_Delete(point);
    free(cache);
    free(templates);
    free(folder);
    return answer;
}

/* ---- Runs ------------------------------------------------------------------------------------ */

static void add_run(cJSON *runs, const char *scene, const uint32_t size[2], uint32_t frames,
                    bool exact, cJSON *sets)
{
    cJSON *run = cJSON_CreateObject();
    cJSON_AddStringToObject(run, "scene", scene);
    cJSON_AddNumberToObject(run, "width", size[0]);
    cJSON_AddNumberToObject(run, "height", size[1]);
    cJSON_AddNumberToObject(run, "frames", frames);
    cJSON_AddBoolToObject(run, "exact", exact);
    cJSON_AddItemToObject(run, "sets", sets);
    cJSON_AddItemToArray(runs, run);
}

/* The sets of the command line stand behind those of the run, and win. */
static void append_texts(cJSON *array, const cJSON *more)
{
    for (const cJSON *item = more->child; item; item = item->next)
        cJSON_AddItemToArray(array, cJSON_CreateString(item->valuestring));
}

/* Scenes and the sizes of the command line, which stand in place of those that were drawn, take turns from
 * draw to draw: an exact run and its fast twin have the same. */
static bool add_random_runs(cJSON *runs, const cJSON *options, const cJSON *variations,
                            const struct dt_log *log)
{
    const cJSON *scenes = cJSON_GetObjectItem(options, "scene");
    const cJSON *sizes = cJSON_GetObjectItem(options, "size");
    int scene_count = cJSON_GetArraySize(scenes), size_count = cJSON_GetArraySize(sizes);
    for (const cJSON *item = variations->child; item; item = item->next) {
        uint32_t size[2] = {sweep_number(item, "width"), sweep_number(item, "height")};
        uint32_t frames = sweep_number(options, "frames");
        int turn = (int)sweep_number(item, "draw");
        const cJSON *scene = cJSON_GetArrayItem(scenes, turn % scene_count);
        if (size_count &&
            !option_size(cJSON_GetArrayItem(sizes, turn % size_count)->valuestring, size, log))
            return false;
        cJSON *sets = cJSON_Duplicate(cJSON_GetObjectItem(item, "sets"), true);
        append_texts(sets, cJSON_GetObjectItem(options, "set"));
        add_run(runs, scene->valuestring, size, frames ? frames : sweep_number(item, "frames"),
                cJSON_IsTrue(cJSON_GetObjectItem(item, "exact")), sets);
    }
    return true;
}

/* The length of the first value of a list like 1,[2,3],4: up to a comma outside brackets. */
static size_t value_length(const char *text)
{
    int depth = 0;
    size_t length = 0;
    for (; text[length] && (text[length] != ',' || depth > 0); length++)
        depth += (text[length] == '[' || text[length] == '{') -
                 (text[length] == ']' || text[length] == '}');
    return length;
}

/* Value number `index` of a row PATH=V1,V2,... as PATH=V; free(). */
char *sweep_row_value(const char *row, uint32_t index)
{
    const char *value = strchr(row, '=') + 1;
    for (; index > 0; index--)
        value += value_length(value) + 1;
    return format_string("%.*s%.*s", (int)(strchr(row, '=') + 1 - row), row,
                         (int)value_length(value), value);
}

/* How many values a row has: at least one. */
uint32_t sweep_row_width(const char *row)
{
    uint32_t count = 1;
    const char *value = strchr(row, '=') + 1;
    while (value[value_length(value)]) {
        value += value_length(value) + 1;
        count++;
    }
    return count;
}

static bool add_grid_runs(cJSON *runs, const cJSON *options, const struct dt_log *log)
{
    const cJSON *grid = cJSON_GetObjectItem(options, "grid"), *scene, *size;
    const cJSON *sizes = cJSON_GetObjectItem(options, "size");
    uint32_t frames = sweep_number(options, "frames");
    uint64_t points = 1, turns = (uint64_t)cJSON_GetArraySize(sizes);
    turns *= (uint64_t)cJSON_GetArraySize(cJSON_GetObjectItem(options, "scene"));
    for (const cJSON *row = grid->child; row && points <= MOST_RUNS; row = row->next)
        points *= sweep_row_width(row->valuestring);
    if (points * turns > MOST_RUNS) {
        report_error(log, "the grid has more than %d runs; give fewer values", MOST_RUNS);
        return false;
    }
    cJSON_ArrayForEach(scene, cJSON_GetObjectItem(options, "scene")) cJSON_ArrayForEach(size, sizes)
    {
        uint32_t sides[2];
        if (!option_size(size->valuestring, sides, log))
            return false;
        for (uint32_t i = 0; i < points; i++) {
            cJSON *sets = grid_sets(grid, i);
            append_texts(sets, cJSON_GetObjectItem(options, "set"));
            add_run(runs, scene->valuestring, sides, frames ? frames : 1, true, sets);
        }
    }
    return true;
}

/* ---- All of it ------------------------------------------------------------------------------- */

/* The spec, its files, the scenes, the inputs, and the executables: when one of them changes, a run is done again. */
static bool add_inputs(cJSON *sweep, const cJSON *answer, const struct dt_log *log)
{
    const cJSON *item, *options = cJSON_GetObjectItem(sweep, "options");
    cJSON *inputs = cJSON_AddArrayToObject(sweep, "inputs");
    char *folder = tools_folder(log);
    char *tools[] = {format_string("%s/diptych", folder ? folder : ""),
                     format_string("%s/diptych-gen", folder ? folder : "")};
    bool good = folder && tools[0] && tools[1] && add_path(inputs, tools[0], log) &&
                add_path(inputs, tools[1], log);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(answer, "inputs")) good =
        good && add_path(inputs, item->valuestring, log);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(options, "scene")) good =
        good && (!*item->valuestring || add_path(inputs, item->valuestring, log));
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(options, "input")) good =
        good && add_path(inputs, strchr(item->valuestring, '=') + 1, log);
    free(tools[0]);
    free(tools[1]);
    free(folder);
    return good;
}

bool sweep_plan(cJSON *sweep, struct console *console)
{
    const struct dt_log *log = &console->log;
    const cJSON *options = cJSON_GetObjectItem(sweep, "options");
    console_status(console, "drawing variations");
    cJSON *answer = vary_spec(console, options);
    console_status(console, "%s", "");
    bool good = answer && add_inputs(sweep, answer, log);
    cJSON *runs = cJSON_AddArrayToObject(sweep, "runs");
    if (good && cJSON_HasObjectItem(options, "random"))
        good = add_random_runs(runs, options, cJSON_GetObjectItem(answer, "variations"), log);
    else if (good)
        good = add_grid_runs(runs, options, log);
    if (good)
        cJSON_AddItemToObject(sweep, "redrawn", cJSON_DetachItemFromObject(answer, "redrawn"));
    cJSON_Delete(answer);
    return good;
}
