/* Prepares and plans a folder of measurements; see steps.h. */
#include "measure/steps.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/folder.h"
#include "console/quote.h"
#include "console/tool.h"
#include "spec/pipeline.h"
#include "scenes/scene.h"

const char *step_text(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text ? text : "";
}

bool step_is_name(const char *text)
{
    return *text && text[0] != '.' && !strpbrk(text, "/\n|");
}

/* ---- Preparing ------------------------------------------------------------------------------- */

static bool find_scenes_folder(struct steps *steps)
{
    const char *given =
        steps->request.setup->scenes ? steps->request.setup->scenes : getenv("DIPTYCH_SCENES");
    if (!given || !*given)
        return true;
    steps->scenes_folder = realpath(given, NULL);
    if (!steps->scenes_folder)
        report_error(&steps->console->log, "--scenes %s: %s", given, strerror(errno));
    return steps->scenes_folder;
}

bool steps_begin(struct steps *steps, const char *verb, struct console *console,
                 const struct steps_request *request)
{
    const struct dt_log *log = &console->log;
    *steps = (struct steps){.verb = verb, .console = console, .request = *request};
    steps->results = cJSON_CreateObject();
    steps->spec = pipeline_spec_path(request->setup->spec, log);
    if (!steps->spec || !sides_read_each(&steps->sides, request->setup, log) ||
        !find_scenes_folder(steps))
        return false;
    char *tools = tools_folder(log);
    steps->program = tools ? format_string("%s/diptych", tools) : NULL;
    free(tools);
    return steps->program;
}

static bool is_taken(const struct steps *steps, const char *name)
{
    for (uint32_t i = 0; i < steps->scene_count; i++)
        if (strcmp(steps->scenes[i].name, name) == 0)
            return true;
    return strcmp(name, "plots") == 0;
}

static bool add_scene(struct steps *steps, const char *path)
{
    const struct dt_log *log = &steps->console->log;
    struct step_scene *scene = &steps->scenes[steps->scene_count];
    char *found = find_scene(path, log);
    scene->path = found ? realpath(found, NULL) : NULL;
    free(found);
    const char *slash = scene->path ? strrchr(scene->path, '/') : NULL;
    if (!slash) {
        report_error(log, "%s: cannot be read: %s", path, strerror(errno));
        return false;
    }
    const char *dot = strrchr(slash, '.');
    scene->name =
        dot > slash + 1 ? strndup(slash + 1, (size_t)(dot - slash) - 1) : strdup(slash + 1);
    if (!scene->name || !step_is_name(scene->name) || is_taken(steps, scene->name)) {
        report_error(log, "%s: the %s cannot have a folder \"%s\" for it; rename the file",
                     scene->path, steps->verb, scene->name ? scene->name : "");
        free(scene->name);
        free(scene->path);
        return false;
    }
    steps->scene_count++;
    if (!scene_find_mesh(scene->path, steps->scenes_folder, &scene->mesh, log))
        return false;
    if (!scene->mesh)
        report_message(
            log, DT_WARNING,
            "%s is left out: its mesh was not found; --scenes or DIPTYCH_SCENES names its folder",
            scene->path);
    return true;
}

bool steps_find_scenes(struct steps *steps, const char *const *paths, uint32_t count)
{
    const struct dt_log *log = &steps->console->log;
    uint32_t here = 0;
    bool good = true;
    steps->scenes = calloc(count + 1, sizeof *steps->scenes);
    if (!steps->scenes) {
        report_error(log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < count && good; i++)
        good = add_scene(steps, paths[i]);
    for (uint32_t i = 0; i < steps->scene_count; i++)
        here += steps->scenes[i].mesh != NULL;
    if (good && !here)
        report_error(log, "no scene is left for the %s; name one with --scene FILE", steps->verb);
    return good && here;
}

bool steps_without_scene(struct steps *steps)
{
    struct step_scene *scene = steps->scenes = calloc(1, sizeof *steps->scenes);
    if (scene) {
        *scene = (struct step_scene){strdup(""), strdup("none"), strdup("")};
        steps->scene_count = 1;
    }
    bool good = scene && scene->path && scene->name && scene->mesh;
    if (!good)
        report_error(&steps->console->log, "out of memory");
    return good;
}

bool steps_check_spec(struct steps *steps)
{
    struct pipeline pipeline;
    if (!pipeline_load(&pipeline, steps->console, steps->request.setup))
        return false;
    uint32_t count;
    const char *const *sources = plan_sources(pipeline.plan, &count);
    steps->spec_files = cJSON_CreateStringArray(sources, (int)count);
    if (!steps->spec_files)
        report_error(&steps->console->log, "out of memory");
    pipeline_unload(&pipeline);
    return steps->spec_files;
}

/* Whether the folder's `commands` are those of the same verb; see write_commands in steps_run.c. */
static bool is_own(const struct steps *steps, const char *path)
{
    char *commands = format_string("%s/commands", path);
    char *mark = format_string("# diptych %s:", steps->verb);
    size_t size;
    char *text = commands && mark && file_exists(commands)
                     ? file_read(commands, &size, &steps->console->log)
                     : NULL;
    bool own = text && strncmp(text, mark, strlen(mark)) == 0;
    free(text);
    free(mark);
    free(commands);
    return own;
}

bool steps_make_folder(struct steps *steps)
{
    const struct dt_log *log = &steps->console->log;
    const char *path = steps->request.output;
    if (!folder_is_empty(path) && !is_own(steps, path)) {
        report_error(log, "%s: holds files, but no %s; give another folder", path,
                     strcmp(steps->verb, "report") == 0 ? "report" : "sweep that measures");
        return false;
    }
    if (!file_make_folders(path, log))
        return false;
    steps->folder = realpath(path, NULL);
    if (steps->folder && !strpbrk(steps->folder, "\n|"))
        return true;
    report_error(log, "%s: a ninja file cannot hold a path with a line break or a |", path);
    return false;
}

void steps_free(struct steps *steps)
{
    for (uint32_t i = 0; i < steps->count; i++) {
        free(steps->list[i].file);
        free(steps->list[i].command);
        free(steps->list[i].motion);
    }
    for (uint32_t i = 0; i < steps->scene_count; i++) {
        free(steps->scenes[i].path);
        free(steps->scenes[i].name);
        free(steps->scenes[i].mesh);
    }
    free(steps->list);
    free(steps->scenes);
    cJSON_Delete(steps->results);
    cJSON_Delete(steps->spec_files);
    sides_free(&steps->sides);
    free(steps->scenes_folder);
    free(steps->spec);
    free(steps->program);
    free(steps->folder);
}

/* ---- Commands -------------------------------------------------------------------------------- */

char *step_input(const char *input)
{
    const char *file = strchr(input, '=') + 1;
    char *path = realpath(file, NULL);
    return path ? path : strdup(file);
}

bool command_begin(struct command *command, const struct steps *steps, const char *verb)
{
    *command = (struct command){.steps = steps, .verb = verb};
    command->out = open_memstream(&command->text, &command->size);
    if (!command->out)
        return false;
    quote_word(command->out, steps->program);
    fprintf(command->out, " %s", verb);
    return true;
}

void command_file(struct command *command, const char *option, const char *file)
{
    char *path = file ? format_string("%s/%s", command->steps->folder, file) : NULL;
    quote_option(command->out, option, path ? path : "");
    free(path);
}

void command_pattern(struct command *command, const char *option, const char *file,
                     const char *ending)
{
    char *path = file ? format_string("%s/%s", command->steps->folder, file) : NULL;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (const char *at = path; at && *at && out; at++)
        fputs(*at == '%' ? "%%" : (char[2]){*at}, out);
    if (out) {
        fputs(ending, out);
        fclose(out);
    }
    quote_option(command->out, option, text ? text : "");
    free(text);
    free(path);
}

void command_scene(struct command *command, const struct step_scene *scene)
{
    if (*scene->path)
        quote_option(command->out, "--scene", scene->path);
    if (*scene->path && command->steps->scenes_folder)
        quote_option(command->out, "--scenes", command->steps->scenes_folder);
}

void command_size(struct command *command, const uint32_t size[2])
{
    fprintf(command->out, " --size %ux%u", size[0], size[1]);
}

void command_spec(struct command *command, const cJSON *sets)
{
    const struct steps *steps = command->steps;
    const cJSON *set;
    quote_option(command->out, "--spec", steps->spec);
    cJSON_ArrayForEach(set, sets) quote_option(command->out, "--set", set->valuestring);
    for (uint32_t i = 0; i < steps->request.setup->set_count; i++)
        quote_option(command->out, "--set", steps->request.setup->sets[i]);
    for (uint32_t i = 0; i < steps->request.setup->inputs.count; i++) {
        const char *input = steps->request.setup->inputs.items[i];
        char *path = step_input(input);
        char *text = format_string("%.*s=%s", (int)strcspn(input, "="), input, path ? path : "");
        quote_option(command->out, "--input", text ? text : input);
        free(text);
        free(path);
    }
}

void command_backends(struct command *command)
{
    if (command->steps->request.setup->backend)
        quote_option(command->out, "--backend", command->steps->request.setup->backend);
}

void command_quality(struct command *command)
{
    const struct steps_request *request = &command->steps->request;
    if (request->spp)
        fprintf(command->out, " --spp %u", request->spp);
    if (request->noise)
        quote_option(command->out, "--noise", request->noise);
}

void command_frames(struct command *command)
{
    const struct steps_request *request = &command->steps->request;
    if (request->frames)
        fprintf(command->out, " --frames %u", request->frames);
    if (request->warmup)
        fprintf(command->out, " --warmup %u", request->warmup);
}

/* ---- The list -------------------------------------------------------------------------------- */

const struct step *steps_find(const struct steps *steps, const char *file)
{
    for (uint32_t i = 0; i < steps->count; i++)
        if (strcmp(steps->list[i].file, file) == 0)
            return &steps->list[i];
    return NULL;
}

bool steps_add(struct steps *steps, const struct step *step, struct command *command)
{
    const struct dt_log *log = &steps->console->log;
    bool good = step->file && command->out && fclose(command->out) == 0 && command->text;
    bool twice = good && steps_find(steps, step->file);
    bool broken = good && strchr(command->text, '\n');
    struct step *grown =
        good && !twice && !broken ? realloc(steps->list, (steps->count + 1) * sizeof *grown) : NULL;
    if (grown) {
        steps->list = grown;
        grown[steps->count] = *step;
        grown[steps->count].verb = command->verb;
        grown[steps->count++].command = command->text;
        return true;
    }
    if (twice)
        report_error(log,
                     "two steps would write %s; give pictures and values different names, other "
                     "than \"reference\"",
                     step->file);
    else if (broken)
        report_error(log, "%s: a ninja file cannot hold a line break; remove it from the value",
                     command->text);
    else
        report_error(log, "out of memory");
    free(command->text);
    free(step->file);
    return false;
}

const char *steps_last(const struct steps *steps)
{
    return steps->list[steps->count - 1].file;
}
