/* Plans the steps of a grid of measurements; see measure.h. */
#include "measure/measure.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/quote.h"

bool grid_begin(struct grid *grid, struct steps *steps, uint32_t count)
{
    grid->steps = steps;
    grid->count = count;
    grid->points = calloc(count + 1, sizeof *grid->points);
    if (!grid->points)
        report_error(&steps->console->log, "out of memory");
    return grid->points;
}

/* Replaces characters that file names cannot hold or that would need quotes. */
static void make_plain(char *text)
{
    for (; text && *text; text++)
        if (strchr("/[]{}, |\n", *text))
            *text = '_';
}

char *grid_name(const struct grid *grid, const struct grid_point *point, const char *before)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fputs(before, out);
    for (uint32_t i = 0; i < grid->column_count; i++)
        fprintf(out, "%s%s_%s", i || *before ? "_" : "", grid->columns[i], point->values[i]);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    make_plain(text);
    return text;
}

/* ---- Single steps ---------------------------------------------------------------------------- */

bool measure_add_reference(struct steps *steps, const struct reference *reference)
{
    const struct steps_request *request = &steps->request;
    const struct step_scene *scene = reference->scene;
    struct command command;
    /* one per setting: it cannot continue with fewer samples or other light */
    char *film = format_string("%s/%s_%u_%s_%s_%s_%s.film", scene->name, reference->name,
                               request->spp, request->noise ? request->noise : "",
                               reference->from_bounce ? reference->from_bounce : "",
                               reference->bounces ? reference->bounces : "",
                               reference->quantity ? reference->quantity : "");
    char *picture = format_string("%s/%s.exr", scene->name, reference->name);
    char *json = format_string("%s/%s.json", scene->name, reference->name);
    if (command_begin(&command, steps, "reference")) {
        command_scene(&command, scene);
        command_size(&command, reference->size);
        if (reference->from_bounce)
            quote_option(command.out, "--from-bounce", reference->from_bounce);
        if (reference->bounces)
            quote_option(command.out, "--bounces", reference->bounces);
        if (reference->quantity)
            quote_option(command.out, "--quantity", reference->quantity);
        command_quality(&command);
        if (reference->seed)
            fprintf(command.out, " --seed %" PRIu32, reference->seed);
        command_file(&command, "-o", picture);
        command_file(&command, "--checkpoint", film);
        command_file(&command, "--json", json);
        fprintf(command.out, " && rm");
        command_file(&command, "-f", film);
    }
    free(film);
    free(picture);
    return steps_add(
        steps,
        &(struct step){.scene = scene, .part = reference->part, .file = json, .traced = true},
        &command);
}

/* Of a picture's file without its ending. */
static int stem_length(const char *file)
{
    return (int)(strrchr(file, '.') - file);
}

/* The last picture of a numbered sequence; takes over `file`. */
static char *last_of(char *file, uint32_t frames)
{
    char *last = file ? format_string("%.*s_%03u.exr", stem_length(file), file, frames - 1) : NULL;
    free(file);
    return last;
}

bool measure_add_render(struct steps *steps, const struct rendering *rendering, char *file)
{
    struct command command;
    char *stem = file ? strndup(file, (size_t)stem_length(file)) : NULL;
    if (rendering->every_frame)
        file = last_of(file, rendering->frames);
    char *told = format_string("%s.json", file ? file : "");
    if (command_begin(&command, steps, "render")) {
        command_scene(&command, rendering->scene);
        command_size(&command, rendering->size);
        command_spec(&command, rendering->sets);
        quote_option(command.out, "--backend", rendering->side);
        if (rendering->frames)
            fprintf(command.out, " --frames %u", rendering->frames);
        if (rendering->show)
            quote_option(command.out, "--show", rendering->show);
        command_pattern(&command, "-o", stem, rendering->every_frame ? "_%03d.exr" : ".exr");
        command_file(&command, "--json", told);
    }
    free(told);
    free(stem);
    return steps_add(
        steps, &(struct step){.scene = rendering->scene, .part = rendering->part, .file = file},
        &command);
}

/* The picture of a step. */
static char *picture_of(const char *file)
{
    size_t length = strlen(file);
    bool json = length > 5 && strcmp(file + length - 5, ".json") == 0;
    return json ? format_string("%.*s.exr", (int)length - 5, file) : strdup(file);
}

bool measure_add_metrics(struct steps *steps, const struct measurement *measurement, char *file)
{
    struct command command;
    const char *picture = measurement->picture, *against = measurement->against;
    uint32_t frames = measurement->frames;
    char *reference = picture_of(against);
    /* of a sequence, without the last frame's number, too */
    size_t length = (size_t)(strrchr(picture, frames ? '_' : '.') - picture);
    char *stem = strndup(picture, length);
    if (command_begin(&command, steps, "metrics")) {
        command_file(&command, "--reference", reference);
        command_pattern(&command, "--test", stem, frames ? "_%03d.exr" : ".exr");
        if (frames)
            fprintf(command.out, " --frames %u", frames);
        if (measurement->maps)
            command_file(&command, "-o", measurement->maps);
        fprintf(command.out, " --flip ldr"); /* the picture of the other side is not used */
        command_file(&command, "--json", file);
    }
    free(stem);
    free(reference);
    return steps_add(steps,
                     &(struct step){.scene = steps_find(steps, picture)->scene,
                                    .part = measurement->part,
                                    .file = file,
                                    .needs = {picture, against}},
                     &command);
}

/* Exit status 1, they differ, is a result, too. */
bool measure_add_comparison(struct steps *steps, const struct rendering *rendering, char *file)
{
    struct command command;
    if (command_begin(&command, steps, "compare")) {
        command_scene(&command, rendering->scene);
        command_size(&command, rendering->size);
        command_spec(&command, rendering->sets);
        command_backends(&command);
        if (rendering->frames)
            fprintf(command.out, " --frames %u", rendering->frames);
        command_file(&command, "--json", file);
        fprintf(command.out, " || [ $? = 1 ]");
    }
    return steps_add(
        steps, &(struct step){.scene = rendering->scene, .part = rendering->part, .file = file},
        &command);
}

/* ---- The grid -------------------------------------------------------------------------------- */

static bool add_bench(struct grid *grid, const struct grid_point *point)
{
    struct command command;
    char *file = grid_bench_file(point);
    if (command_begin(&command, grid->steps, "bench")) {
        command_scene(&command, point->scene);
        command_size(&command, point->size);
        command_spec(&command, point->sets);
        command_backends(&command);
        command_frames(&command);
        command_file(&command, "--json", file);
    }
    return steps_add(grid->steps,
                     &(struct step){.scene = point->scene, .part = grid->part_time, .file = file},
                     &command);
}

/* Of one side: the picture, and its error where that is wanted. */
static bool add_measured_picture(struct grid *grid, const struct grid_point *point, uint32_t side)
{
    const struct rendering rendering = {.scene = point->scene,
                                        .size = point->size,
                                        .sets = point->sets,
                                        .side = grid->steps->sides.list[side].label,
                                        .show = grid->show,
                                        .frames = grid->frames,
                                        .every_frame = grid->every_frame,
                                        .part = grid->part_error};
    if (!measure_add_render(grid->steps, &rendering, grid_picture_file(grid, point, side)))
        return false;
    if (!(point->measures & MEASURE_ERROR))
        return true;
    return measure_add_metrics(
        grid->steps,
        &(struct measurement){.part = grid->part_error,
                              .picture = steps_last(grid->steps),
                              .against = steps_find(grid->steps, point->reference)->file,
                              .frames = grid->every_frame ? grid->frames : 0},
        grid_error_file(grid, point, side));
}

/* Behind the pictures of all points. */
static bool add_own_error(struct grid *grid, const struct grid_point *point, uint32_t side)
{
    char *picture = grid_picture_file(grid, point, side);
    char *last = grid_picture_file(grid, point->last, side);
    bool good =
        picture && last &&
        measure_add_metrics(grid->steps,
                            &(struct measurement){.part = grid->part_error,
                                                  .picture = steps_find(grid->steps, picture)->file,
                                                  .against = steps_find(grid->steps, last)->file},
                            grid_own_file(grid, point, side));
    free(last);
    free(picture);
    return good;
}

static bool add_agreement(struct grid *grid, const struct grid_point *point)
{
    const struct rendering rendering = {.scene = point->scene,
                                        .size = point->size,
                                        .sets = point->sets,
                                        .frames = grid->frames,
                                        .part = grid->part_agree};
    return measure_add_comparison(grid->steps, &rendering, grid_compare_file(point));
}

bool grid_plan(struct grid *grid, uint32_t first, uint32_t end)
{
    bool good = true;
    for (uint32_t i = first; i < end && good; i++) {
        const struct grid_point *point = &grid->points[i];
        grid->measures |= point->measures;
        bool pictured = point->measures & (MEASURE_ERROR | MEASURE_OWN);
        for (uint32_t side = 0; side < grid->pictured && pictured && good; side++)
            good = add_measured_picture(grid, point, side);
        good = good && (!(point->measures & MEASURE_TIME) || add_bench(grid, point)) &&
               (!(point->measures & MEASURE_AGREE) || add_agreement(grid, point));
    }
    for (uint32_t i = first; i < end && good; i++) {
        const struct grid_point *point = &grid->points[i];
        bool own = (point->measures & MEASURE_OWN) && point->last != point;
        for (uint32_t side = 0; side < grid->pictured && good; side++)
            good = !own || add_own_error(grid, point, side);
    }
    return good;
}

void grid_free(struct grid *grid)
{
    for (uint32_t i = 0; i < grid->count && grid->points; i++) {
        struct grid_point *point = &grid->points[i];
        for (uint32_t j = 0; j < grid->column_count && point->values; j++)
            free(point->values[j]);
        free(point->values);
        free(point->name);
        free(point->reference);
        cJSON_Delete(point->sets);
    }
    for (uint32_t i = 0; i < grid->pass_count; i++)
        free(grid->passes[i]);
    free(grid->passes);
    free(grid->points);
}
