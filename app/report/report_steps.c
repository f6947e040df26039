/* The steps of a report. */
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/quote.h"
#include "report/report.h"

/* ---- File names ------------------------------------------------------------------------------ */

char *report_file(const struct step_scene *scene, const char *name, const char *ending)
{
    return format_string("%s/%s%s", scene->name, name, ending);
}

char *report_motion_file(const struct step_scene *scene, const cJSON *motion, const char *name,
                         const char *ending)
{
    return format_string("%s/%s/%s%s", scene->name, step_text(motion, "name"), name, ending);
}

const cJSON *report_last_picture(const struct report *report)
{
    const cJSON *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    return cJSON_GetArrayItem(pictures, cJSON_GetArraySize(pictures) - 1);
}

/* Scenes that are not here have no points. */
const struct grid_point *report_point(const struct report *report, const struct step_scene *scene,
                                      const cJSON *picture, int value)
{
    const cJSON *item = cJSON_GetObjectItem(report->outline, "pictures")->child;
    const struct grid_point *point = report->grid.points;
    int pictures = cJSON_GetArraySize(cJSON_GetObjectItem(report->outline, "pictures"));
    int values = report_value_count(report);
    for (const struct step_scene *before = report->steps.scenes; before != scene; before++)
        point += before->mesh ? (ptrdiff_t)pictures * values : 0;
    for (; item != picture; item = item->next)
        point += values;
    return point + value;
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static bool add_reference_step(struct report *report, const struct step_scene *scene,
                               const char *name, uint32_t seed)
{
    const cJSON *bounces =
        cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "reference"), "bounces");
    char number[32];
    snprintf(number, sizeof number, "%.0f", bounces->valuedouble);
    return measure_add_reference(&report->steps,
                                 &(struct reference){.scene = scene,
                                                     .size = report->steps.request.setup->size,
                                                     .name = name,
                                                     .bounces = number,
                                                     .seed = seed,
                                                     .part = PART_PICTURES});
}

/* A picture as the outline has it, with error maps. */
static bool add_picture_step(struct report *report, const struct step_scene *scene,
                             const cJSON *picture, const char *reference)
{
    const char *name = step_text(picture, "name");
    const struct rendering rendering = {.scene = scene,
                                        .size = report->steps.request.setup->size,
                                        .sets = cJSON_GetObjectItem(picture, "set"),
                                        .side = report->steps.sides.list[0].label,
                                        .part = PART_PICTURES};
    char *maps = report_file(scene, name, "");
    bool good = measure_add_render(&report->steps, &rendering, report_file(scene, name, ".exr")) &&
                measure_add_metrics(&report->steps,
                                    &(struct measurement){.part = PART_PICTURES,
                                                          .picture = steps_last(&report->steps),
                                                          .against = reference,
                                                          .maps = maps},
                                    report_file(scene, name, ".json"));
    free(maps);
    return good;
}

/* The reference once more, with other noise, against the first. */
static bool add_noise_steps(struct report *report, const struct step_scene *scene,
                            const char *reference)
{
    return add_reference_step(report, scene, "again", 2) &&
           measure_add_metrics(&report->steps,
                               &(struct measurement){.part = PART_PICTURES,
                                                     .picture = steps_last(&report->steps),
                                                     .against = reference},
                               report_file(scene, "noise", ".json"));
}

static bool add_pictures(struct report *report, const struct step_scene *scene)
{
    const cJSON *picture;
    bool good = add_reference_step(report, scene, "reference", 0);
    const char *reference = good ? steps_last(&report->steps) : NULL;
    good = good && add_noise_steps(report, scene, reference);
    cJSON_ArrayForEach(picture, cJSON_GetObjectItem(report->outline, "pictures")) good =
        good && add_picture_step(report, scene, picture, reference);
    return good;
}

/* Adds the points of a picture: its --set, then PARAMETER=VALUE of the sweep, which wins. Errors
 * are measured for all pictures, on the first side only, since compare shows whether the others
 * agree; times for the last picture. */
static bool fill_point(struct report *report, struct grid_point *point, const cJSON *picture,
                       int value)
{
    char buffer[32];
    bool last = picture == report_last_picture(report);
    const char *text = report_item(report_values(report), value, buffer);
    char *set = format_string("%s=%s", report_parameter(report), text);
    memcpy(point->size, report->steps.request.setup->size, sizeof point->size);
    point->values = calloc(2, sizeof *point->values);
    point->sets = cJSON_Duplicate(cJSON_GetObjectItem(picture, "set"), true);
    cJSON_AddItemToArray(point->sets, cJSON_CreateString(set ? set : ""));
    point->measures = MEASURE_ERROR | MEASURE_OWN | (last ? MEASURE_TIME : 0);
    point->last = point + (report_value_count(report) - 1 - value);
    point->reference = report_file(point->scene, "reference", ".json");
    if (point->values) {
        point->values[0] = strdup(step_text(picture, "name"));
        point->values[1] = strdup(text);
    }
    bool good = set && point->reference && point->values && point->values[0] && point->values[1];
    point->name = good ? grid_name(&report->grid, point, "") : NULL;
    free(set);
    if (!point->name)
        report_error(&report->steps.console->log, "out of memory");
    return point->name;
}

static bool add_sweep(struct report *report, const struct step_scene *scene)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    struct grid *grid = &report->grid;
    uint32_t first = (uint32_t)(report_point(report, scene, pictures->child, 0) - grid->points);
    uint32_t next = first;
    bool good = true;
    cJSON_ArrayForEach(picture, pictures)
    {
        for (int i = 0; i < report_value_count(report) && good; i++) {
            grid->points[next].scene = scene;
            good = fill_point(report, &grid->points[next++], picture, i);
        }
    }
    return good && grid_plan(grid, first, next);
}

static bool begin_grid(struct report *report)
{
    uint32_t here = 0,
             pictures =
                 (uint32_t)cJSON_GetArraySize(cJSON_GetObjectItem(report->outline, "pictures"));
    for (uint32_t i = 0; i < report->steps.scene_count; i++)
        here += report->steps.scenes[i].mesh != NULL;
    report->columns[0] = "picture";
    report->columns[1] = report_parameter(report);
    report->grid = (struct grid){.columns = report->columns,
                                 .column_count = 2,
                                 .pictured = 1,
                                 .part_time = PART_TIMES,
                                 .part_error = PART_ERRORS};
    return grid_begin(&report->grid, &report->steps,
                      here * pictures * (uint32_t)report_value_count(report));
}

/* ---- Motions --------------------------------------------------------------------------------- */

/* Number of frames that are traced a second time with other noise, to measure the noise. */
enum { NOISE_FRAMES = 3 };

static const cJSON *motion_settings(const struct report *report)
{
    return cJSON_GetObjectItem(report->outline, "motion");
}

static int motion_count(const struct report *report, const char *name)
{
    return cJSON_GetObjectItem(motion_settings(report), name)->valueint;
}

static void put_motion(struct command *command, const struct report *report,
                       const struct step_scene *scene, const cJSON *motion)
{
    char *file = report_outline_file(report, step_text(motion, "file"));
    command_scene(command, scene);
    quote_option(command->out, "--motion", file ? file : "");
    free(file);
}

static void put_frames_of(struct command *command, const char *option,
                          const struct step_scene *scene, const cJSON *motion, const char *name)
{
    char *file = report_motion_file(scene, motion, name, "");
    command_pattern(command, option, file, "_%03d.exr");
    free(file);
}

/* Takes over `file`. `first` and `second`: steps that it must wait for, or NULL. */
static bool add_motion_step(struct report *report, const struct step_scene *scene,
                            const cJSON *motion, char *file, struct command *command,
                            const char *first, const char *second)
{
    const struct step step = {
        .scene = scene,
        .part = PART_MOTIONS,
        .file = file,
        .traced = strcmp(command->verb, "reference") == 0,
        .needs = {first, second},
        .motion = report_outline_file(report, step_text(motion, "file")),
    };
    bool good = steps_add(&report->steps, &step, command);
    if (!good)
        free(step.motion);
    return good;
}

/* Path-traces one frame. Each step waits for the one before, so that the last stands for all. */
static bool add_motion_reference(struct report *report, const struct step_scene *scene,
                                 const cJSON *motion, const char *name, int frame)
{
    const cJSON *reference = cJSON_GetObjectItem(report->outline, "reference");
    struct command command;
    char *stem = format_string("%s_%03d", name, frame);
    char *picture = report_motion_file(scene, motion, stem ? stem : "", ".exr");
    char *json = report_motion_file(scene, motion, stem ? stem : "", ".json");
    if (command_begin(&command, &report->steps, "reference")) {
        put_motion(&command, report, scene, motion);
        quote_option(command.out, "--size", step_text(motion_settings(report), "size"));
        fprintf(command.out,
                " --frame %d --from-bounce %d --bounces %.0f --quantity %s --spp %d --seed %d",
                frame, report_motion_from_bounce(report),
                cJSON_GetObjectItem(reference, "bounces")->valuedouble,
                report_motion_quantity(report), motion_count(report, "spp"),
                strcmp(name, "reference") == 0 ? 1 : 2);
        command_file(&command, "-o", picture);
        command_file(&command, "--json", json);
    }
    free(picture);
    free(stem);
    const char *before = frame > 0 ? steps_last(&report->steps) : NULL;
    return add_motion_step(report, scene, motion, json, &command, before, NULL);
}

static bool add_motion_render(struct report *report, const struct step_scene *scene,
                              const cJSON *motion, const cJSON *run)
{
    const cJSON *settings = motion_settings(report);
    int frames = motion_count(report, "frames");
    struct command command;
    char *stem = format_string("%s_%03d", step_text(run, "name"), frames - 1);
    if (command_begin(&command, &report->steps, "render")) {
        put_motion(&command, report, scene, motion);
        quote_option(command.out, "--size", step_text(settings, "size"));
        fprintf(command.out, " --frames %d", frames);
        command_spec(&command, cJSON_GetObjectItem(run, "set"));
        quote_option(command.out, "--backend", report->steps.sides.list[0].label);
        quote_option(command.out, "--show", step_text(settings, "show"));
        put_frames_of(&command, "-o", scene, motion, step_text(run, "name"));
    }
    bool good = add_motion_step(report, scene, motion,
                                report_motion_file(scene, motion, stem ? stem : "", ".exr"),
                                &command, NULL, NULL);
    free(stem);
    return good;
}

/* Of pictures that the last step left. */
static bool add_flicker(struct report *report, const struct step_scene *scene, const cJSON *motion,
                        const char *name, int frames, const char *reference)
{
    struct command command;
    const char *pictures = steps_last(&report->steps);
    char *json = report_motion_file(scene, motion, name, ".json");
    if (command_begin(&command, &report->steps, "flicker")) {
        put_motion(&command, report, scene, motion);
        fprintf(command.out, " --frames %d --block %d", frames, motion_count(report, "block"));
        put_frames_of(&command, "--test", scene, motion, name);
        put_frames_of(&command, "--reference", scene, motion, "reference");
        command_file(&command, "--json", json);
    }
    return add_motion_step(report, scene, motion, json, &command, pictures, reference);
}

static bool add_motion(struct report *report, const struct step_scene *scene, const cJSON *motion)
{
    int frames = motion_count(report, "frames");
    int noise = frames < NOISE_FRAMES ? frames : NOISE_FRAMES;
    const cJSON *run;
    bool good = true;
    for (int i = 0; i < frames && good; i++)
        good = add_motion_reference(report, scene, motion, "reference", i);
    const char *reference = good ? steps_last(&report->steps) : NULL;
    for (int i = 0; i < noise && good; i++)
        good = add_motion_reference(report, scene, motion, "noise", i);
    good = good && add_flicker(report, scene, motion, "noise", noise, reference);
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(motion_settings(report), "runs"))
    {
        good = good && add_motion_render(report, scene, motion, run) &&
               add_flicker(report, scene, motion, step_text(run, "name"), frames, reference);
    }
    return good;
}

static bool add_motions(struct report *report, const struct step_scene *scene)
{
    const cJSON *motion = NULL;
    bool good = true;
    while (good && (motion = report_next_motion(report, scene, motion)))
        good = add_motion(report, scene, motion);
    return good;
}

/* ---- The plan -------------------------------------------------------------------------------- */

static bool add_comparison(struct report *report, const struct step_scene *scene)
{
    const struct rendering rendering = {
        .scene = scene, .size = report->steps.request.setup->size, .part = PART_COMPARISON};
    return measure_add_comparison(&report->steps, &rendering,
                                  report_file(scene, "compare", ".json"));
}

/* The command of the whole report. */
static char *own_command(const struct report *report)
{
    const struct setup *setup = report->steps.request.setup;
    struct command command;
    if (!command_begin(&command, &report->steps, "report"))
        return NULL;
    for (uint32_t i = 0; i < report->steps.scene_count; i++)
        quote_option(command.out, "--scene", report->steps.scenes[i].path);
    if (report->steps.scenes_folder)
        quote_option(command.out, "--scenes", report->steps.scenes_folder);
    fprintf(command.out, " --size %ux%u", setup->size[0], setup->size[1]);
    command_spec(&command, NULL);
    command_backends(&command);
    quote_option(command.out, "--outline", report->outline_path);
    command_quality(&command);
    command_frames(&command);
    quote_option(command.out, "-o", report->steps.folder);
    if (fclose(command.out) == 0)
        return command.text;
    free(command.text);
    return NULL;
}

bool report_plan(struct report *report)
{
    bool good = (report->command = own_command(report));
    if (!good)
        report_error(&report->steps.console->log, "out of memory");
    good = good && begin_grid(report);
    for (uint32_t i = 0; i < report->steps.scene_count && good; i++) {
        const struct step_scene *scene = &report->steps.scenes[i];
        if (!scene->mesh)
            continue;
        good = add_pictures(report, scene) && add_sweep(report, scene) &&
               add_motions(report, scene) &&
               (report->steps.sides.count < 2 || add_comparison(report, scene));
    }
    return good;
}
