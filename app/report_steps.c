/* The steps of a report, which are commands of diptych, and the ninja file that runs them. Called by
 * report.c. */
#include <stdlib.h>
#include <string.h>

#include "files.h"
#include "quote.h"
#include "report.h"

/* ---- File names ------------------------------------------------------------------------------ */

char *report_file(const struct report_scene *scene, const char *name, const char *ending)
{
    return format_string("%s/%s%s", scene->name, name, ending);
}

char *report_sweep_file(const struct report *report, const struct report_scene *scene, int index,
                        const char *ending)
{
    const cJSON *sweep = cJSON_GetObjectItem(report->outline, "sweep");
    char buffer[32];
    char *file =
        format_string("%s/%s_%s%s", scene->name, report_text(sweep, "parameter"),
                      report_item(cJSON_GetObjectItem(sweep, "values"), index, buffer), ending);
    for (char *at = file ? file + strlen(scene->name) + 1 : NULL; at && *at; at++) {
        if (strchr("/[], |\n", *at))
            *at = '_';
    }
    return file;
}

char *report_error_file(const struct report *report, const struct report_scene *scene,
                        const cJSON *picture, int index, const char *ending)
{
    char *suffix = format_string("_%s%s", report_text(picture, "name"), ending);
    char *file = suffix ? report_sweep_file(report, scene, index, suffix) : NULL;
    free(suffix);
    return file;
}

char *report_motion_file(const struct report_scene *scene, const cJSON *motion, const char *name,
                         const char *ending)
{
    return format_string("%s/%s/%s%s", scene->name, report_text(motion, "name"), name, ending);
}

const cJSON *report_last_picture(const struct report *report)
{
    const cJSON *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    return cJSON_GetArrayItem(pictures, cJSON_GetArraySize(pictures) - 1);
}

/* ---- Commands -------------------------------------------------------------------------------- */

/* A command on its way into a step. */
struct command {
    const struct report *report;
    FILE *out;
    char *text;
    size_t size;
};

static bool command_begin(struct command *command, const struct report *report, const char *verb)
{
    *command = (struct command){.report = report};
    command->out = open_memstream(&command->text, &command->size);
    if (!command->out)
        return false;
    quote_word(command->out, report->program);
    fprintf(command->out, " %s", verb);
    return true;
}

static void put_file(struct command *command, const char *option, const char *file)
{
    char *path = file ? format_string("%s/%s", command->report->folder, file) : NULL;
    quote_option(command->out, option, path ? path : "");
    free(path);
}

static void put_scene_file(struct command *command, const struct report_scene *scene)
{
    const struct report *report = command->report;
    quote_option(command->out, "--scene", scene->path);
    if (report->scenes_folder)
        quote_option(command->out, "--scenes", report->scenes_folder);
}

static void put_scene(struct command *command, const struct report_scene *scene)
{
    const uint32_t *size = command->report->options->size;
    put_scene_file(command, scene);
    fprintf(command->out, " --size %ux%u", size[0], size[1]);
}

/* Those of the command line stand last, and win. */
static void put_spec(struct command *command, const cJSON *sets)
{
    const struct report *report = command->report;
    const cJSON *set;
    quote_option(command->out, "--spec", report->spec);
    cJSON_ArrayForEach(set, sets) quote_option(command->out, "--set", set->valuestring);
    for (uint32_t i = 0; i < report->options->set_count; i++)
        quote_option(command->out, "--set", report->options->sets[i]);
}

static void put_backends(struct command *command)
{
    if (command->report->options->backend)
        quote_option(command->out, "--backend", command->report->options->backend);
}

/* Of the reference. */
static void put_quality(struct command *command)
{
    const struct options *options = command->report->options;
    if (options->spp)
        fprintf(command->out, " --spp %u", options->spp);
    if (options->noise)
        quote_option(command->out, "--noise", options->noise);
}

/* Of bench. */
static void put_frames(struct command *command)
{
    const struct options *options = command->report->options;
    if (options->run_frames)
        fprintf(command->out, " --frames %u", options->run_frames);
    if (options->warmup)
        fprintf(command->out, " --warmup %u", options->warmup);
}

static bool is_planned(const struct report *report, const char *file)
{
    for (uint32_t i = 0; i < report->step_count; i++) {
        if (strcmp(report->steps[i].file, file) == 0)
            return true;
    }
    return false;
}

/* Takes over `file`. Logs its error. */
static bool add_step(struct report *report, const struct report_scene *scene, enum report_part part,
                     char *file, struct command *command)
{
    bool good = file && command->out && fclose(command->out) == 0 && command->text;
    bool twice = good && is_planned(report, file);
    bool broken = good && strchr(command->text, '\n');
    struct report_step *grown =
        good && !twice && !broken ? realloc(report->steps, (report->step_count + 1) * sizeof *grown)
                                  : NULL;
    if (!grown) {
        if (twice)
            report_error(&report->console->log,
                         "%s: two steps would write %s; give pictures and values of the sweep "
                         "names of their own, other than \"reference\"",
                         report->outline_path, file);
        else if (broken)
            report_error(&report->console->log,
                         "%s: a line break cannot stand in a ninja file; leave it out of the value",
                         command->text);
        else
            report_error(&report->console->log, "out of memory");
        free(command->text);
        free(file);
        return false;
    }
    report->steps = grown;
    grown[report->step_count++] =
        (struct report_step){.scene = scene, .part = part, .file = file, .command = command->text};
    return true;
}

/* The step that was added last must wait for these. */
static void wait_for(struct report *report, const char *first, const char *second)
{
    struct report_step *step = &report->steps[report->step_count - 1];
    step->needs[0] = first;
    step->needs[1] = second;
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static bool add_reference(struct report *report, const struct report_scene *scene)
{
    const struct options *options = report->options;
    const cJSON *reference = cJSON_GetObjectItem(report->outline, "reference");
    struct command command;
    /* of its own, since it cannot be taken up with fewer samples */
    char *film = format_string("%s/reference_%u_%s.film", scene->name, options->spp,
                               options->noise ? options->noise : "");
    char *picture = report_file(scene, "reference", ".exr");
    char *json = report_file(scene, "reference", ".json");
    if (command_begin(&command, report, "reference")) {
        put_scene(&command, scene);
        fprintf(command.out, " --bounces %.0f",
                cJSON_GetObjectItem(reference, "bounces")->valuedouble);
        put_quality(&command);
        put_file(&command, "-o", picture);
        put_file(&command, "--checkpoint", film);
        put_file(&command, "--json", json);
        fprintf(command.out, " && rm");
        put_file(&command, "-f", film);
    }
    free(film);
    free(picture);
    bool good = add_step(report, scene, PART_PICTURES, json, &command);
    if (good)
        report->steps[report->step_count - 1].traced = true;
    return good;
}

/* A picture of one backend, EXR. */
static bool add_render(struct report *report, const struct report_scene *scene,
                       enum report_part part, char *file, const cJSON *sets)
{
    struct command command;
    if (command_begin(&command, report, "render")) {
        put_scene(&command, scene);
        put_spec(&command, sets);
        quote_option(command.out, "--backend", report->sides.list[0].label);
        put_file(&command, "-o", file);
    }
    return add_step(report, scene, part, file, &command);
}

/* Measures a picture against another; both are EXR that steps make, the reference's with a JSON behind
 * it. `maps`: a folder for error maps, or NULL. */
static bool add_metrics(struct report *report, enum report_part part, const char *picture,
                        const char *reference, const char *reference_step, const char *maps,
                        char *file)
{
    const struct report_scene *scene = report->steps[report->step_count - 1].scene;
    struct command command;
    if (command_begin(&command, report, "metrics")) {
        put_file(&command, "--reference", reference);
        put_file(&command, "--test", picture);
        if (maps)
            put_file(&command, "-o", maps);
        put_file(&command, "--json", file);
    }
    bool good = add_step(report, scene, part, file, &command);
    if (good)
        wait_for(report, picture, reference_step);
    return good;
}

static const char *last_file(const struct report *report)
{
    return report->steps[report->step_count - 1].file;
}

static bool add_pictures(struct report *report, const struct report_scene *scene)
{
    const cJSON *picture;
    bool good = add_reference(report, scene);
    const char *reference = good ? last_file(report) : NULL;
    char *reference_picture = report_file(scene, "reference", ".exr");
    cJSON_ArrayForEach(picture, cJSON_GetObjectItem(report->outline, "pictures"))
    {
        const char *name = report_text(picture, "name");
        char *maps = report_file(scene, name, "");
        good = good &&
               add_render(report, scene, PART_PICTURES, report_file(scene, name, ".exr"),
                          cJSON_GetObjectItem(picture, "set")) &&
               add_metrics(report, PART_PICTURES, last_file(report), reference_picture, reference,
                           maps, report_file(scene, name, ".json"));
        free(maps);
    }
    free(reference_picture);
    return good;
}

/* What a picture sets, and behind it PARAMETER=VALUE of one value of the sweep, which wins. */
static cJSON *sweep_sets(const struct report *report, const cJSON *picture, int index)
{
    const cJSON *sweep = cJSON_GetObjectItem(report->outline, "sweep");
    char buffer[32];
    char *set = format_string("%s=%s", report_text(sweep, "parameter"),
                              report_item(cJSON_GetObjectItem(sweep, "values"), index, buffer));
    cJSON *sets = cJSON_Duplicate(cJSON_GetObjectItem(picture, "set"), true);
    cJSON_AddItemToArray(sets, cJSON_CreateString(set ? set : ""));
    free(set);
    return sets;
}

static bool add_bench(struct report *report, const struct report_scene *scene, const cJSON *sets,
                      char *file)
{
    struct command command;
    if (command_begin(&command, report, "bench")) {
        put_scene(&command, scene);
        put_spec(&command, sets);
        put_backends(&command);
        put_frames(&command);
        put_file(&command, "--json", file);
    }
    return add_step(report, scene, PART_TIMES, file, &command);
}

/* One picture at one value: its errors against the reference, and against `best`, the same picture at
 * the last value, if that is another. */
static bool add_errors(struct report *report, const struct report_scene *scene,
                       const cJSON *picture, int index, const char *reference, const char **best)
{
    char *reference_picture = report_file(scene, "reference", ".exr");
    cJSON *sets = sweep_sets(report, picture, index);
    bool good = reference_picture && sets &&
                add_render(report, scene, PART_ERRORS,
                           report_error_file(report, scene, picture, index, ".exr"), sets);
    const char *made = good ? last_file(report) : NULL;
    good = good && add_metrics(report, PART_ERRORS, made, reference_picture, reference, NULL,
                               report_error_file(report, scene, picture, index, ".json"));
    if (good && *best)
        good = add_metrics(report, PART_ERRORS, made, *best, *best, NULL,
                           report_error_file(report, scene, picture, index, "_own.json"));
    *best = *best ? *best : made;
    cJSON_Delete(sets);
    free(reference_picture);
    return good;
}

/* The last value comes first, since the others are held against its picture, too. */
static bool add_sweep(struct report *report, const struct report_scene *scene,
                      const char *reference)
{
    const cJSON *picture, *last = report_last_picture(report);
    int count = cJSON_GetArraySize(
        cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "sweep"), "values"));
    bool good = true;
    cJSON_ArrayForEach(picture, cJSON_GetObjectItem(report->outline, "pictures"))
    {
        const char *best = NULL;
        for (int i = count - 1; i >= 0 && good; i--)
            good = add_errors(report, scene, picture, i, reference, &best);
    }
    for (int i = count - 1; i >= 0 && good; i--) {
        cJSON *sets = sweep_sets(report, last, i);
        good = add_bench(report, scene, sets, report_sweep_file(report, scene, i, "_bench.json"));
        cJSON_Delete(sets);
    }
    return good;
}

/* ---- Motions --------------------------------------------------------------------------------- */

/* How many frames are traced a second time, with other noise, to tell how much of it there is. */
enum { NOISE_FRAMES = 3 };

static const cJSON *motion_settings(const struct report *report)
{
    return cJSON_GetObjectItem(report->outline, "motion");
}

static int motion_count(const struct report *report, const char *name)
{
    return cJSON_GetObjectItem(motion_settings(report), name)->valueint;
}

static void put_motion(struct command *command, const struct report_scene *scene,
                       const cJSON *motion)
{
    char *file = report_outline_file(command->report, report_text(motion, "file"));
    put_scene_file(command, scene);
    quote_option(command->out, "--motion", file ? file : "");
    free(file);
}

/* A pattern of the names of frames, in which a percent sign of the folder's must not count. */
static void put_frames_of(struct command *command, const char *option,
                          const struct report_scene *scene, const cJSON *motion, const char *name)
{
    char *file = report_motion_file(scene, motion, name, "");
    char *path = file ? format_string("%s/%s", command->report->folder, file) : NULL;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (const char *at = path; at && *at && out; at++)
        fputs(*at == '%' ? "%%" : (char[2]){*at}, out);
    if (out) {
        fputs("_%03d.exr", out);
        fclose(out);
    }
    quote_option(command->out, option, text ? text : "");
    free(text);
    free(path);
    free(file);
}

static bool add_motion_step(struct report *report, const struct report_scene *scene,
                            const cJSON *motion, char *file, struct command *command)
{
    bool good = add_step(report, scene, PART_MOTIONS, file, command);
    struct report_step *step = &report->steps[report->step_count - 1];
    if (good)
        step->motion = report_outline_file(report, report_text(motion, "file"));
    if (good && !step->motion)
        report_error(&report->console->log, "out of memory");
    return good && step->motion;
}

/* A frame of the indirect light, path-traced; each waits for the one before, so that the last stands
 * for all. */
static bool add_motion_reference(struct report *report, const struct report_scene *scene,
                                 const cJSON *motion, const char *name, int frame)
{
    const cJSON *reference = cJSON_GetObjectItem(report->outline, "reference");
    struct command command;
    char *stem = format_string("%s_%03d", name, frame);
    char *picture = report_motion_file(scene, motion, stem ? stem : "", ".exr");
    char *json = report_motion_file(scene, motion, stem ? stem : "", ".json");
    if (command_begin(&command, report, "reference")) {
        put_motion(&command, scene, motion);
        quote_option(command.out, "--size", report_text(motion_settings(report), "size"));
        fprintf(command.out,
                " --frame %d --from-bounce 1 --bounces %.0f --quantity irradiance --spp %d "
                "--seed %d",
                frame, cJSON_GetObjectItem(reference, "bounces")->valuedouble,
                motion_count(report, "spp"), strcmp(name, "reference") == 0 ? 1 : 2);
        put_file(&command, "-o", picture);
        put_file(&command, "--json", json);
    }
    free(picture);
    free(stem);
    const char *before = frame > 0 ? last_file(report) : NULL;
    bool good = add_motion_step(report, scene, motion, json, &command);
    if (good) {
        report->steps[report->step_count - 1].traced = true;
        wait_for(report, before, NULL);
    }
    return good;
}

static bool add_motion_render(struct report *report, const struct report_scene *scene,
                              const cJSON *motion, const cJSON *run)
{
    const cJSON *settings = motion_settings(report);
    int frames = motion_count(report, "frames");
    struct command command;
    char *stem = format_string("%s_%03d", report_text(run, "name"), frames - 1);
    if (command_begin(&command, report, "render")) {
        put_motion(&command, scene, motion);
        quote_option(command.out, "--size", report_text(settings, "size"));
        fprintf(command.out, " --frames %d", frames);
        put_spec(&command, cJSON_GetObjectItem(run, "set"));
        quote_option(command.out, "--backend", report->sides.list[0].label);
        quote_option(command.out, "--show", report_text(settings, "show"));
        put_frames_of(&command, "-o", scene, motion, report_text(run, "name"));
    }
    bool good =
        add_motion_step(report, scene, motion,
                        report_motion_file(scene, motion, stem ? stem : "", ".exr"), &command);
    free(stem);
    return good;
}

/* Of pictures that the last step left. */
static bool add_flicker(struct report *report, const struct report_scene *scene,
                        const cJSON *motion, const char *name, int frames, const char *reference)
{
    struct command command;
    const char *pictures = last_file(report);
    if (command_begin(&command, report, "flicker")) {
        put_motion(&command, scene, motion);
        fprintf(command.out, " --frames %d --block %d", frames, motion_count(report, "block"));
        put_frames_of(&command, "--test", scene, motion, name);
        put_frames_of(&command, "--reference", scene, motion, "reference");
        char *json = report_motion_file(scene, motion, name, ".json");
        put_file(&command, "--json", json);
        free(json);
    }
    bool good = add_motion_step(report, scene, motion,
                                report_motion_file(scene, motion, name, ".json"), &command);
    if (good)
        wait_for(report, pictures, reference);
    return good;
}

static bool add_motion(struct report *report, const struct report_scene *scene, const cJSON *motion)
{
    int frames = motion_count(report, "frames");
    int noise = frames < NOISE_FRAMES ? frames : NOISE_FRAMES;
    const cJSON *run;
    bool good = true;
    for (int i = 0; i < frames && good; i++)
        good = add_motion_reference(report, scene, motion, "reference", i);
    const char *reference = good ? last_file(report) : NULL;
    for (int i = 0; i < noise && good; i++)
        good = add_motion_reference(report, scene, motion, "noise", i);
    good = good && add_flicker(report, scene, motion, "noise", noise, reference);
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(motion_settings(report), "runs"))
    {
        good = good && add_motion_render(report, scene, motion, run) &&
               add_flicker(report, scene, motion, report_text(run, "name"), frames, reference);
    }
    return good;
}

static bool add_motions(struct report *report, const struct report_scene *scene)
{
    const cJSON *motion = NULL;
    bool good = true;
    while (good && (motion = report_next_motion(report, scene, motion)))
        good = add_motion(report, scene, motion);
    return good;
}

/* ---- The plan -------------------------------------------------------------------------------- */

/* That they differ is a result, too. */
static bool add_comparison(struct report *report, const struct report_scene *scene)
{
    struct command command;
    char *json = report_file(scene, "compare", ".json");
    if (command_begin(&command, report, "compare")) {
        put_scene(&command, scene);
        put_spec(&command, NULL);
        put_backends(&command);
        put_file(&command, "--json", json);
        fprintf(command.out, " || [ $? = 1 ]");
    }
    return add_step(report, scene, PART_COMPARISON, json, &command);
}

/* The command of the whole report. */
static char *own_command(const struct report *report)
{
    const struct options *options = report->options;
    struct command command;
    if (!command_begin(&command, report, "report"))
        return NULL;
    for (uint32_t i = 0; i < report->scene_count; i++)
        quote_option(command.out, "--scene", report->scenes[i].path);
    if (report->scenes_folder)
        quote_option(command.out, "--scenes", report->scenes_folder);
    fprintf(command.out, " --size %ux%u", options->size[0], options->size[1]);
    put_spec(&command, NULL);
    put_backends(&command);
    quote_option(command.out, "--outline", report->outline_path);
    put_quality(&command);
    put_frames(&command);
    quote_option(command.out, "-o", report->folder);
    if (fclose(command.out) == 0)
        return command.text;
    free(command.text);
    return NULL;
}

bool report_plan(struct report *report)
{
    bool good = (report->command = own_command(report));
    if (!good)
        report_error(&report->console->log, "out of memory");
    for (uint32_t i = 0; i < report->scene_count && good; i++) {
        const struct report_scene *scene = &report->scenes[i];
        if (!scene->mesh)
            continue;
        uint32_t first = report->step_count;
        good = add_pictures(report, scene) && add_sweep(report, scene, report->steps[first].file) &&
               add_motions(report, scene) &&
               (report->sides.count < 2 || add_comparison(report, scene));
    }
    return good;
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* A step whose command fails leaves no file, not even that of an earlier time. */
static void write_rules(FILE *out, const struct report *report)
{
    const cJSON *item;
    fputs("# One edge per step of the report; the command that made this file goes on where it was "
          "left.\n"
          "rule step\n"
          "  command = rm -f $out && { $line; } >$out.txt\n"
          "  description = $out\n"
          "  pool = console\n\n"
          "build program: phony ",
          out);
    quote_path(out, report->program);
    fputs("\nbuild spec: phony program", out);
    cJSON_ArrayForEach(item, report->spec_files)
    {
        fputc(' ', out);
        quote_path(out, item->valuestring);
    }
    fputc('\n', out);
}

static void write_edge(FILE *out, const struct report_step *step)
{
    fputs("\nbuild ", out);
    quote_path(out, step->file);
    fprintf(out, ": step | %s ", step->traced ? "program" : "spec");
    quote_path(out, step->scene->path);
    fputc(' ', out);
    quote_path(out, step->scene->mesh);
    if (step->motion) {
        fputc(' ', out);
        quote_path(out, step->motion);
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(step->needs) && step->needs[i]; i++) {
        fputc(' ', out);
        quote_path(out, step->needs[i]);
    }
    fputs("\n  line = ", out);
    quote_value(out, step->command);
    fputc('\n', out);
}

static bool write_file(const struct report *report, const char *name, char *text, size_t size,
                       bool good)
{
    const struct dt_log *log = &report->console->log;
    char *path = format_string("%s/%s", report->folder, name);
    if (!good || !path)
        report_error(log, "out of memory");
    else
        good = file_write(path, text, size, log);
    free(path);
    free(text);
    return good && path;
}

static bool write_ninja(const struct report *report)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out)
        write_rules(out, report);
    for (uint32_t i = 0; i < report->step_count && out; i++)
        write_edge(out, &report->steps[i]);
    return write_file(report, "build.ninja", text, size, out && fclose(out) == 0);
}

static bool write_commands(const struct report *report)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (uint32_t i = 0; i < report->step_count && out; i++)
        fprintf(out, "%s\n", report->steps[i].command);
    return write_file(report, "commands", text, size, out && fclose(out) == 0);
}

/* A scene's folder, and in it one for each of its motions. */
static bool make_folders(const struct report *report, const struct report_scene *scene)
{
    const cJSON *motion = NULL;
    bool good = true;
    do {
        char *folder = format_string("%s/%s/%s", report->folder, scene->name,
                                     motion ? report_text(motion, "name") : "");
        good = folder && file_make_folders(folder, &report->console->log);
        free(folder);
    } while (good && (motion = report_next_motion(report, scene, motion)));
    return good;
}

bool report_write_steps(const struct report *report)
{
    bool good = true;
    for (uint32_t i = 0; i < report->scene_count && good; i++)
        good = !report->scenes[i].mesh || make_folders(report, &report->scenes[i]);
    return good && write_ninja(report) && write_commands(report);
}
