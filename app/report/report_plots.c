/* Plots of a report: error over the sweep, for all scenes; frame time over the sweep, per scene;
 * change from frame to frame, per motion. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "measure/plot.h"
#include "report/report.h"

static bool draw_plot(struct report *report, struct plot *plot, const char *name)
{
    char *folder = format_string("%s/plots", report->steps.folder);
    bool good = folder && plot_draw(plot, report->steps.console, folder, name);
    free(folder);
    return good;
}

/* ---- Over the sweep -------------------------------------------------------------------------- */

/* The values of the sweep, as the axis takes them. */
struct value_texts {
    char (*buffers)[32];
    const char **texts;
};

static bool read_plot_values(struct value_texts *values, const struct report *report)
{
    int count = report_value_count(report);
    values->buffers = calloc((size_t)count + 1, sizeof *values->buffers);
    values->texts = calloc((size_t)count + 1, sizeof *values->texts);
    bool good = values->buffers && values->texts;
    for (int i = 0; i < count && good; i++)
        values->texts[i] = report_item(report_values(report), i, values->buffers[i]);
    if (!good)
        report_error(&report->steps.console->log, "out of memory");
    return good;
}

static void free_values(struct value_texts *values)
{
    free(values->buffers);
    free(values->texts);
}

static struct plot plot_of_values(const struct report *report, const struct value_texts *values,
                                  const char *label)
{
    return (struct plot){.x_label = report_parameter(report),
                         .y_label = label,
                         .values = values->texts,
                         .value_count = (uint32_t)report_value_count(report)};
}

/* One of the plots of errors. */
struct error_plot {
    const char *name, *label, *column;
    bool from_zero;
    const struct image_number *number; /* NULL: not against the reference */
};

static bool is_ratio(const struct error_plot *what)
{
    return what->number && strcmp(what->number->name, "ratio") == 0;
}

static bool has_errors(const struct report *report, const struct step_scene *scene,
                       const cJSON *picture, const char *column)
{
    bool any = false;
    for (int i = 0; i < report_value_count(report); i++)
        any |=
            !isnan(grid_number(&report->grid, report_point(report, scene, picture, i), 0, column));
    return any;
}

/* A line for each picture of a scene: colours tell scenes apart, dashes all pictures but the last. */
static void put_error_lines(struct plot *plot, const struct report *report,
                            const struct step_scene *scene, uint32_t colour, const char *column)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    uint32_t dash = (uint32_t)cJSON_GetArraySize(pictures);
    cJSON_ArrayForEach(picture, pictures)
    {
        char *title = format_string("%s, %s", scene->name, step_text(picture, "title"));
        bool any = title && has_errors(report, scene, picture, column);
        if (any)
            plot_line(plot, title, colour, dash, false);
        for (int i = 0; i < report_value_count(report) && any; i++)
            plot_point(
                plot, plot_x(plot, (uint32_t)i),
                grid_number(&report->grid, report_point(report, scene, picture, i), 0, column), NAN,
                NAN);
        free(title);
        dash--;
    }
}

/* What the reference traced again has against the first, on the scene where that is most; 0: unknown. */
static double reference_noise(struct report *report, const struct error_plot *what)
{
    double most = 0;
    char *path = what->number ? measure_path(what->number) : NULL;
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        const struct step_scene *scene = &report->steps.scenes[i];
        char *file = scene->mesh && path ? report_file(scene, "noise", ".json") : NULL;
        double noise = file ? steps_number(&report->steps, file, path) : NAN;
        if (is_ratio(what) && noise > 0)
            noise = fmax(noise, 1 / noise);
        most = fmax(most, noise); /* never NaN */
        free(file);
    }
    free(path);
    return most;
}

static bool draw_errors(struct report *report, const struct value_texts *values,
                        const struct error_plot *what)
{
    struct plot plot = plot_of_values(report, values, what->label);
    uint32_t colour = 0;
    plot.from_zero = what->from_zero;
    plot.noise = reference_noise(report, what);
    plot.noise_is_ratio = is_ratio(what);
    bool good = plot_begin(&plot, &report->steps.console->log);
    for (uint32_t i = 0; i < report->steps.scene_count && good; i++) {
        const struct step_scene *scene = &report->steps.scenes[i];
        if (scene->mesh)
            put_error_lines(&plot, report, scene, colour++ % PLOT_COLOURS + 1, what->column);
    }
    good = good && draw_plot(report, &plot, what->name);
    plot_free(&plot);
    return good;
}

/* Against the reference, and against the same picture at the last value, which has no error of its own. */
static bool draw_all_errors(struct report *report, const struct value_texts *values)
{
    bool good =
        draw_errors(report, values,
                    &(struct error_plot){"own_errors", "relative MSE against the last value",
                                         "own_relative_mse", false, NULL});
    for (int i = 0; i < IMAGE_HEADLINES && good; i++) {
        const struct image_number *number = &image_numbers[i];
        good = draw_errors(
            report, values,
            &(struct error_plot){number->name, number->title, number->name, number->share, number});
    }
    return good;
}

static const cJSON *published_total(const struct report *report, const struct step_scene *scene)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    return strcmp(step_text(published, "scene"), scene->name) == 0
               ? cJSON_GetObjectItem(published, "total")
               : NULL;
}

/* From the 5th to the 95th percentile around the median; false when there is none. */
static bool put_times(struct plot *plot, const struct report *report,
                      const struct step_scene *scene, uint32_t side)
{
    const struct grid *grid = &report->grid;
    plot_line(plot, report->steps.sides.list[side].label, side % PLOT_COLOURS + 1, 1, true);
    for (int i = 0; i < report_value_count(report); i++) {
        const struct grid_point *point =
            report_point(report, scene, report_last_picture(report), i);
        plot_point(plot, plot_x(plot, (uint32_t)i), grid_number(grid, point, side, "frame_ms"),
                   grid_number(grid, point, side, "frame_ms_p5"),
                   grid_number(grid, point, side, "frame_ms_p95"));
    }
    return !plot_is_empty(plot);
}

static void put_published(struct plot *plot, const struct report *report, const cJSON *total)
{
    const cJSON *item, *published = cJSON_GetObjectItem(report->outline, "published");
    uint32_t i = 0;
    char *title = format_string("%s (other hardware)", step_text(published, "by"));
    plot_line(plot, title ? title : "", PLOT_COLOURS, 2, false);
    cJSON_ArrayForEach(item, total)
        plot_point(plot, plot_x(plot, i++), item->valuedouble, NAN, NAN);
    free(title);
}

/* A line for each backend, and what was published of the scene. */
static bool draw_times(struct report *report, const struct step_scene *scene,
                       const struct value_texts *values)
{
    struct plot plot = plot_of_values(report, values, "milliseconds per frame");
    char *name = format_string("times_%s", scene->name);
    const cJSON *total = published_total(report, scene);
    bool any = false, good = name && plot_begin(&plot, &report->steps.console->log);
    for (uint32_t side = 0; side < report->steps.sides.count && good; side++)
        any |= put_times(&plot, report, scene, side);
    if (any && total)
        put_published(&plot, report, total);
    good = good && draw_plot(report, &plot, name);
    plot_free(&plot);
    free(name);
    return good;
}

/* ---- Over motions ---------------------------------------------------------------------------- */

static const cJSON *motion_runs(const struct report *report)
{
    return cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "motion"), "runs");
}

int report_change_plot_height(const struct report *report)
{
    return plot_height(cJSON_GetArraySize(motion_runs(report)));
}

/* Per cent, of a run's step from frame `step` to the next. */
static double change(struct report *report, const struct step_scene *scene, const cJSON *motion,
                     const cJSON *run, int step, const char *name)
{
    char *file = report_motion_file(scene, motion, step_text(run, "name"), ".json");
    const cJSON *list =
        cJSON_GetObjectItem(file ? steps_result(&report->steps, file) : NULL, "per_frame");
    const cJSON *item = cJSON_GetObjectItem(cJSON_GetArrayItem(list, step), name);
    free(file);
    return cJSON_IsNumber(item) ? 100 * item->valuedouble : NAN;
}

static int step_count(const struct report *report)
{
    return cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "motion"), "frames")->valueint -
           1;
}

/* The reference's change, from any run that has a result. */
static double reference_change(struct report *report, const struct step_scene *scene,
                               const cJSON *motion, int step)
{
    const cJSON *run;
    double truth = NAN;
    cJSON_ArrayForEach(run, motion_runs(report))
    {
        if (isnan(truth))
            truth = change(report, scene, motion, run, step, "relative_change_reference");
    }
    return truth;
}

static void put_csv_number(FILE *out, double value)
{
    if (isnan(value))
        fputc(',', out);
    else
        fprintf(out, ",%.6g", value);
}

/* A row per step from frame to frame, in per cent: the reference's change, then change and flicker of each
 * run. */
static void put_changes(FILE *out, struct report *report, const struct step_scene *scene,
                        const cJSON *motion)
{
    const cJSON *run;
    fputs("frame,reference", out);
    cJSON_ArrayForEach(run, motion_runs(report))
        fprintf(out, ",%s,%s_flicker", step_text(run, "name"), step_text(run, "name"));
    fputc('\n', out);
    for (int step = 0; step < step_count(report); step++) {
        fprintf(out, "%d", step + 1);
        put_csv_number(out, reference_change(report, scene, motion, step));
        cJSON_ArrayForEach(run, motion_runs(report))
        {
            put_csv_number(out, change(report, scene, motion, run, step, "relative_change"));
            put_csv_number(out, change(report, scene, motion, run, step, "relative_flicker"));
        }
        fputc('\n', out);
    }
}

static bool write_changes(struct report *report, const struct step_scene *scene,
                          const cJSON *motion, const char *name)
{
    const struct dt_log *log = &report->steps.console->log;
    char *path = format_string("%s/plots/%s.csv", report->steps.folder, name);
    struct file_draft draft;
    if (file_draft_begin(&draft, log))
        put_changes(draft.out, report, scene, motion);
    bool good = file_draft_end(&draft, path, log);
    free(path);
    return good;
}

/* A line for each run, and the reference's where `flicker` is not asked for. */
static bool draw_changes(struct report *report, const struct step_scene *scene, const cJSON *motion,
                         const char *name, bool flicker)
{
    const cJSON *run;
    uint32_t colour = 0;
    struct plot plot = {.x_label = "frame",
                        .y_label = flicker ? "flicker per frame, %" : "change per frame, %",
                        .from_zero = true,
                        .height = report_change_plot_height(report)};
    bool good = plot_begin(&plot, &report->steps.console->log);
    cJSON_ArrayForEach(run, motion_runs(report))
    {
        if (good)
            plot_line(&plot, step_text(run, "title"), colour++ % (PLOT_COLOURS - 1) + 1, 1, false);
        for (int i = 0; i < step_count(report) && good; i++)
            plot_point(&plot, i + 1,
                       change(report, scene, motion, run, i,
                              flicker ? "relative_flicker" : "relative_change"),
                       NAN, NAN);
    }
    if (good && !flicker)
        plot_line(&plot, "the reference", PLOT_COLOURS, 2, false);
    for (int i = 0; i < step_count(report) && good && !flicker; i++)
        plot_point(&plot, i + 1, reference_change(report, scene, motion, i), NAN, NAN);
    good = good && draw_plot(report, &plot, name);
    plot_free(&plot);
    return good;
}

/* Two plots of one motion, and the numbers behind both. */
static bool draw_motion(struct report *report, const struct step_scene *scene, const cJSON *motion)
{
    char *name = format_string("change_%s_%s", scene->name, step_text(motion, "name"));
    char *other = format_string("flicker_%s_%s", scene->name, step_text(motion, "name"));
    bool good = name && other && write_changes(report, scene, motion, name) &&
                draw_changes(report, scene, motion, name, false) &&
                draw_changes(report, scene, motion, other, true);
    free(other);
    free(name);
    return good;
}

static bool draw_motions(struct report *report, const struct step_scene *scene)
{
    const cJSON *motion = NULL;
    bool good = true;
    while (good && scene->mesh && (motion = report_next_motion(report, scene, motion)))
        good = draw_motion(report, scene, motion);
    return good;
}

bool report_draw_plots(struct report *report)
{
    char *folder = format_string("%s/plots", report->steps.folder);
    struct value_texts values = {0};
    bool good = folder && file_make_folders(folder, &report->steps.console->log) &&
                read_plot_values(&values, report);
    free(folder);
    console_status(report->steps.console, "drawing plots");
    good = good && draw_all_errors(report, &values);
    for (uint32_t i = 0; i < report->steps.scene_count && good; i++) {
        const struct step_scene *scene = &report->steps.scenes[i];
        good = draw_motions(report, scene) && (!scene->mesh || draw_times(report, scene, &values));
    }
    console_status(report->steps.console, "%s", "");
    free_values(&values);
    return good;
}
