/* `diptych sweep --measure`: times and errors over a grid of values, scenes, sizes and backends,
 * as CSV and plots. measure.h plans and reads; this file has the points, the plots and the table. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "measure/measure.h"
#include "measure/plot.h"
#include "measure/sweep.h"

enum { MOST_POINTS = 100000, LINE_HEIGHT = 18 };

/* One value list of --grid. */
struct axis {
    char *path;
    char **values;
    uint32_t count;
    uint32_t stride; /* points from one value to the next */
};

struct measured_sweep {
    const struct options *options;
    struct steps steps;
    struct grid grid;
    struct axis *axes;
    uint32_t axis_count;
    const char **columns;
    uint32_t combinations; /* of values: points of one scene and size */
    uint32_t x;            /* axis of the plots */
    unsigned measures;
    cJSON *plots; /* that were drawn: "file", "title" */
};

/* ---- Options --------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    unsigned measure;
} measure_names[] = {{"agree", MEASURE_AGREE},
                     {"time", MEASURE_TIME},
                     {"error", MEASURE_ERROR},
                     {"own", MEASURE_OWN}};

static unsigned read_measure(const char *text, size_t length)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(measure_names); i++)
        if (strlen(measure_names[i].name) == length &&
            strncmp(text, measure_names[i].name, length) == 0)
            return measure_names[i].measure;
    return 0;
}

static bool read_measures(unsigned *measures, const char *list, const struct dt_log *log)
{
    *measures = 0;
    for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        unsigned measure = read_measure(at, strcspn(at, ","));
        *measures |= measure;
        if (measure)
            continue;
        report_error(log, "--measure %s: must be some of agree,time,error,own", list);
        return false;
    }
    return true;
}

bool sweep_measures(const struct options *options, bool *wanted, const struct dt_log *log)
{
    unsigned measures = MEASURE_AGREE;
    bool good = !options->measure || read_measures(&measures, options->measure, log);
    *wanted = good && measures != MEASURE_AGREE;
    return good;
}

static bool check_grid_options(const struct measured_sweep *sweep, const struct options *options,
                               const struct dt_log *log)
{
    unsigned errors = MEASURE_ERROR | MEASURE_OWN;
    const char *wrong =
        options->random || options->memory ? "--random goes with --measure agree alone"
        : options->jobs > 1
            ? "--jobs goes with --measure agree alone: what is measured runs one at a time"
        : options->setup.device || options->setup.context || options->setup.glsl ||
                options->setup.debug || options->fault
            ? "--device, --context, --glsl, --debug and --fault go with --measure agree alone; "
              "--backend takes gl+glsl, osmesa, zink and vk@DEVICE"
        : !options->scene_list.count && (sweep->measures & MEASURE_ERROR)
            ? "--measure error needs at least one --scene FILE"
        : options->show && !(sweep->measures & errors) ? "--show goes with --measure error or own"
        : options->every_frame && (!(sweep->measures & MEASURE_ERROR) ||
                                   (sweep->measures & MEASURE_OWN) || options->run_frames < 2)
            ? "--every-frame goes with --measure error, without own, and needs two --frames at "
              "least"
        : options->warmup && !(sweep->measures & MEASURE_TIME) ? "--warmup goes with --measure time"
                                                               : NULL;
    if (wrong)
        report_error(log, "sweep: %s; see diptych sweep --help", wrong);
    return !wrong;
}

/* ---- Axes ------------------------------------------------------------------------------------ */

static bool read_axis(struct axis *axis, const char *row, const struct dt_log *log)
{
    if (!sweep_check_row(row, log))
        return false;
    axis->count = sweep_row_width(row);
    axis->path = strndup(row, strcspn(row, "="));
    axis->values = calloc(axis->count, sizeof *axis->values);
    bool good = axis->path && axis->values;
    for (uint32_t i = 0; i < axis->count && good; i++) {
        char *set = sweep_row_value(row, i);
        axis->values[i] = set ? strdup(strchr(set, '=') + 1) : NULL;
        good = axis->values[i];
        free(set);
    }
    if (!good)
        report_error(log, "out of memory");
    return good;
}

static bool find_x(struct measured_sweep *sweep, const char *name, const struct dt_log *log)
{
    for (uint32_t i = 0; i < sweep->axis_count; i++) {
        if (!name || strcmp(sweep->axes[i].path, name) == 0) {
            sweep->x = i;
            return true;
        }
    }
    if (name)
        report_error(log, "--x %s: must be the path of a --grid", name);
    return !name;
}

/* The last axis varies fastest. */
static bool read_axes(struct measured_sweep *sweep, const struct options *options,
                      const struct dt_log *log)
{
    const struct text_list *rows = &options->grid;
    uint64_t combinations = 1;
    bool good = true;
    sweep->axes = calloc(rows->count + 1, sizeof *sweep->axes);
    sweep->columns = calloc(rows->count + 1, sizeof *sweep->columns);
    if (!sweep->axes || !sweep->columns) {
        report_error(log, "out of memory");
        return false;
    }
    for (uint32_t i = 0; i < rows->count && good; i++) {
        sweep->axis_count = i + 1;
        good = read_axis(&sweep->axes[i], rows->items[i], log);
        sweep->columns[i] = sweep->axes[i].path;
    }
    for (uint32_t i = sweep->axis_count; i-- > 0 && good && combinations <= MOST_POINTS;) {
        sweep->axes[i].stride = (uint32_t)combinations;
        combinations *= sweep->axes[i].count;
    }
    uint32_t sizes = options->size_list.count ? options->size_list.count : 1;
    uint32_t scenes = options->scene_list.count;
    if (good && combinations * sizes * (scenes ? scenes : 1) > MOST_POINTS) {
        report_error(log, "the grid has more than %d points; give fewer values", MOST_POINTS);
        return false;
    }
    sweep->combinations = (uint32_t)combinations;
    return good && find_x(sweep, options->x, log);
}

static uint32_t value_index(const struct axis *axis, uint32_t combination)
{
    return combination / axis->stride % axis->count;
}

/* ---- Points ---------------------------------------------------------------------------------- */

static bool fill_point(struct measured_sweep *sweep, struct grid_point *point, uint32_t combination)
{
    char *size = format_string("%ux%u", point->size[0], point->size[1]);
    point->values = calloc(sweep->axis_count + 1, sizeof *point->values);
    point->sets = cJSON_CreateArray();
    point->measures = sweep->measures;
    point->reference =
        size ? format_string("%s/reference_%s.json", point->scene->name, size) : NULL;
    bool good = size && point->values && point->sets && point->reference;
    for (uint32_t i = 0; i < sweep->axis_count && good; i++) {
        const struct axis *axis = &sweep->axes[i];
        point->values[i] = strdup(axis->values[value_index(axis, combination)]);
        char *set = format_string("%s=%s", axis->path, point->values[i] ? point->values[i] : "");
        cJSON_AddItemToArray(point->sets, cJSON_CreateString(set ? set : ""));
        good = point->values[i] && set;
        free(set);
    }
    point->name = good ? grid_name(&sweep->grid, point, size) : NULL;
    if (sweep->axis_count) {
        const struct axis *x = &sweep->axes[sweep->x];
        point->last = point + (size_t)(x->count - 1 - value_index(x, combination)) * x->stride;
    } else {
        point->last = point;
    }
    free(size);
    return good && point->name;
}

static bool plan_scene(struct measured_sweep *sweep, const struct step_scene *scene,
                       const uint32_t size[2], uint32_t first)
{
    const struct options *options = sweep->options;
    const struct dt_log *log = &sweep->steps.console->log;
    char *name = format_string("reference_%ux%u", size[0], size[1]);
    bool good = name;
    for (uint32_t i = 0; i < sweep->combinations && good; i++) {
        struct grid_point *point = &sweep->grid.points[first + i];
        point->scene = scene;
        memcpy(point->size, size, sizeof point->size);
        good = fill_point(sweep, point, i);
    }
    if (!good)
        report_error(log, "out of memory");
    const struct reference reference = {.scene = scene,
                                        .size = size,
                                        .name = name,
                                        .bounces = options->bounces,
                                        .from_bounce = options->from_bounce,
                                        .quantity = options->quantity};
    good =
        good &&
        (!(sweep->measures & MEASURE_ERROR) || measure_add_reference(&sweep->steps, &reference)) &&
        grid_plan(&sweep->grid, first, first + sweep->combinations);
    free(name);
    return good;
}

static bool plan(struct measured_sweep *sweep)
{
    struct steps *steps = &sweep->steps;
    const struct options *options = sweep->options;
    const struct dt_log *log = &steps->console->log;
    char text[32];
    const char *default_size = text;
    const struct text_list one = {&default_size, 1},
                           *sizes = options->size_list.count ? &options->size_list : &one;
    uint32_t here = 0, first = 0, size[2];
    for (uint32_t i = 0; i < steps->scene_count; i++)
        here += steps->scenes[i].mesh != NULL;
    sweep->grid = (struct grid){.columns = sweep->columns,
                                .column_count = sweep->axis_count,
                                .pictured = steps->sides.count,
                                .frames = options->run_frames,
                                .every_frame = options->every_frame,
                                .show = options->show};
    if (!(sweep->measures & (MEASURE_ERROR | MEASURE_OWN)))
        sweep->grid.pictured = 0;
    bool good = sizes != &one || sweep_default_size(steps->console, options, "1920x1080", text);
    good = good && grid_begin(&sweep->grid, steps, here * sizes->count * sweep->combinations);
    for (uint32_t i = 0; i < steps->scene_count && good; i++) {
        for (uint32_t j = 0; j < sizes->count && steps->scenes[i].mesh && good; j++) {
            good = option_size(sizes->items[j], size, log) &&
                   plan_scene(sweep, &steps->scenes[i], size, first);
            first += sweep->combinations;
        }
    }
    return good;
}

/* ---- Plots ----------------------------------------------------------------------------------- */

struct plotted {
    const char *column, *low, *high; /* the last two: of a bar, or NULL */
    const char *label;
    bool from_zero;
};

/* Title of a line: scene, size, backend and values of other axes, where there are several. */
static char *line_title(const struct measured_sweep *sweep, const struct grid_point *point,
                        uint32_t side)
{
    const struct steps *steps = &sweep->steps;
    char *title = NULL;
    size_t size;
    FILE *out = open_memstream(&title, &size);
    if (!out)
        return NULL;
    fprintf(out, "%s, ", point->scene->name);
    if (sweep->options->size_list.count > 1)
        fprintf(out, "%ux%u, ", point->size[0], point->size[1]);
    for (uint32_t i = 0; i < sweep->axis_count; i++)
        if (i != sweep->x && sweep->axes[i].count > 1)
            fprintf(out, "%s %s, ", sweep->axes[i].path, point->values[i]);
    fputs(steps->sides.list[side].label, out);
    fclose(out);
    return title;
}

/* Adds the points of a line, from the one at the first value of x. */
static void put_line(struct plot *plot, const struct measured_sweep *sweep, uint32_t first,
                     uint32_t side, const struct plotted *what)
{
    const struct axis *x = &sweep->axes[sweep->x];
    uint32_t sides = sweep->steps.sides.count;
    char *title = line_title(sweep, &sweep->grid.points[first], side);
    uint32_t combination = plot->line_count / sides;
    uint32_t colour = sides > 1 ? side : combination, dash = sides > 1 ? combination : side;
    plot_line(plot, title ? title : "", colour % PLOT_COLOURS + 1, dash % 5 + 1, what->low);
    for (uint32_t i = 0; i < x->count; i++) {
        const struct grid_point *point = &sweep->grid.points[first + (size_t)i * x->stride];
        plot_point(plot, plot_x(plot, i), grid_number(&sweep->grid, point, side, what->column),
                   what->low ? grid_number(&sweep->grid, point, side, what->low) : NAN,
                   what->high ? grid_number(&sweep->grid, point, side, what->high) : NAN);
    }
    free(title);
}

static bool draw_plot(struct measured_sweep *sweep, const struct plotted *what)
{
    struct console *console = sweep->steps.console;
    const struct axis *x = &sweep->axes[sweep->x];
    uint32_t sides = sweep->steps.sides.count, lines = sweep->grid.count / x->count * sides;
    struct plot plot = {.x_label = x->path,
                        .y_label = what->label,
                        .values = (const char *const *)x->values,
                        .value_count = x->count,
                        .from_zero = what->from_zero,
                        .beside = true};
    if (lines * LINE_HEIGHT + 60 > PLOT_HEIGHT)
        plot.height = (int)(lines * LINE_HEIGHT + 60);
    bool good = plot_begin(&plot, &console->log);
    for (uint32_t i = 0; i < sweep->grid.count && good; i++) {
        if (value_index(x, i % sweep->combinations) != 0)
            continue;
        for (uint32_t side = 0; side < sides; side++)
            put_line(&plot, sweep, i, side, what);
    }
    bool empty = plot_is_empty(&plot);
    good = good && plot_draw(&plot, console, sweep->steps.folder, what->column);
    plot_free(&plot);
    if (good && !empty) {
        char *file = format_string("%s.svg", what->column);
        cJSON *drawn = cJSON_CreateObject();
        cJSON_AddStringToObject(drawn, "file", file ? file : "");
        cJSON_AddStringToObject(drawn, "title", what->label);
        cJSON_AddItemToArray(sweep->plots, drawn);
        free(file);
    }
    return good;
}

/* Of times, of each headline, and of the error against the last value. */
static bool draw_plots(struct measured_sweep *sweep)
{
    static const struct plotted others[] = {
        {"frame_ms", "frame_ms_p5", "frame_ms_p95", "milliseconds per frame", false},
        {"own_relative_mse", NULL, NULL, "relative MSE against the last value", false},
    };
    bool good = true;
    for (size_t i = 0; i < DT_ARRAY_COUNT(others) && good; i++)
        good = draw_plot(sweep, &others[i]);
    for (size_t i = 0; i < IMAGE_HEADLINES && good; i++)
        good = draw_plot(sweep, &(struct plotted){.column = image_numbers[i].name,
                                                  .label = image_numbers[i].title,
                                                  .from_zero = image_numbers[i].share});
    return good;
}

/* ---- The table: Markdown ---------------------------------------------------------------------- */

/* The columns of the table; returns their number. */
static uint32_t find_columns(const struct measured_sweep *sweep,
                             const char *names[IMAGE_HEADLINES + 2])
{
    uint32_t count = 0;
    if (sweep->measures & MEASURE_TIME)
        names[count++] = "frame_ms";
    for (uint32_t i = 0; i < IMAGE_HEADLINES && (sweep->measures & MEASURE_ERROR); i++)
        names[count++] = image_numbers[i].name;
    if (sweep->measures & MEASURE_OWN)
        names[count++] = "own_relative_mse";
    return count;
}

static void print_head(const struct measured_sweep *sweep, const char *const names[],
                       uint32_t count)
{
    printf("| %-10s | %-7s | %9s |", "scene", "backend", "size");
    for (uint32_t i = 0; i < sweep->axis_count; i++)
        printf(" %s |", sweep->axes[i].path);
    for (uint32_t i = 0; i < count; i++)
        printf(" %*s |", sweep->grid.every_frame ? 17 : 12, names[i]);
    printf("\n|");
    for (uint32_t i = 0; i < 3 + sweep->axis_count + count; i++)
        printf("---|");
    printf("\n");
}

static void print_cell(const struct measured_sweep *sweep, const struct grid_point *point,
                       uint32_t side, const char *column)
{
    char *name = format_string("%s_standard_error", column);
    double value = grid_number(&sweep->grid, point, side, column);
    double error = name ? grid_number(&sweep->grid, point, side, name) : NAN;
    free(name);
    if (!isnan(error))
        printf(" %8.4f \u00b1 %.4f |", value, error);
    else if (isnan(value))
        printf(" %*s |", sweep->grid.every_frame ? 17 : 12, "-");
    else
        printf(" %12.5g |", value);
}

static void print_grid_row(const struct measured_sweep *sweep, const struct grid_point *point,
                           uint32_t side, const char *reason)
{
    const char *names[IMAGE_HEADLINES + 2];
    uint32_t count = find_columns(sweep, names);
    char size[32];
    snprintf(size, sizeof size, "%ux%u", point->size[0], point->size[1]);
    printf("| %-10s | %-7s | %9s |", point->scene->name, sweep->steps.sides.list[side].label, size);
    for (uint32_t i = 0; i < sweep->axis_count; i++)
        printf(" %*s |", (int)strlen(sweep->axes[i].path), point->values[i]);
    for (uint32_t i = 0; i < count; i++)
        print_cell(sweep, point, side, names[i]);
    printf("%s%s\n", reason ? " " : "", reason ? reason : "");
}

/* Prints the rows; returns the number of incomplete ones. */
static uint32_t print_grid(const struct measured_sweep *sweep)
{
    const char *names[IMAGE_HEADLINES + 2];
    uint32_t failed = 0, rows = 0;
    print_head(sweep, names, find_columns(sweep, names));
    for (uint32_t i = 0; i < sweep->grid.count; i++) {
        for (uint32_t side = 0; side < sweep->steps.sides.count; side++, rows++) {
            char *reason = grid_reason(&sweep->grid, &sweep->grid.points[i], side);
            failed += reason != NULL;
            print_grid_row(sweep, &sweep->grid.points[i], side, reason);
            free(reason);
        }
    }
    printf("\n%u rows in %s/rows.csv: %u done, %u failed\n", rows, sweep->steps.folder,
           rows - failed, failed);
    return failed;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static cJSON *sweep_json(const struct measured_sweep *sweep, uint32_t failed)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "spec", sweep->steps.spec);
    cJSON_AddStringToObject(root, "folder", sweep->steps.folder);
    cJSON_AddStringToObject(root, "csv", "rows.csv");
    cJSON_AddNumberToObject(root, "failed", failed);
    cJSON_AddItemToObject(root, "rows", grid_json(&sweep->grid));
    return root;
}

static bool any_differs(const cJSON *rows)
{
    const cJSON *row;
    bool differs = false;
    cJSON_ArrayForEach(row, rows) differs |= strcmp(step_text(row, "agree"), "no") == 0;
    return differs;
}

/* Writes rows, plots and table from the available results. */
static int summarise(struct measured_sweep *sweep)
{
    struct console *console = sweep->steps.console;
    char *csv = format_string("%s/rows.csv", sweep->steps.folder);
    bool good = grid_read(&sweep->grid);
    console_hold(console);
    good = good && csv && grid_write_csv(&sweep->grid, csv);
    console_release(console);
    good = good && (!sweep->axis_count || draw_plots(sweep));
    free(csv);
    if (!good)
        return EXIT_USAGE;
    uint32_t failed = print_grid(sweep);
    console->result = sweep_json(sweep, failed);
    if (!sweep_write_page(console, sweep->steps.folder,
                          cJSON_GetObjectItem(console->result, "rows"), sweep->plots, "rows.csv") ||
        failed)
        return EXIT_USAGE;
    return any_differs(cJSON_GetObjectItem(console->result, "rows")) ? EXIT_DIFFER : EXIT_FINE;
}

static void sweep_free(struct measured_sweep *sweep)
{
    for (uint32_t i = 0; i < sweep->axis_count; i++) {
        for (uint32_t j = 0; j < sweep->axes[i].count && sweep->axes[i].values; j++)
            free(sweep->axes[i].values[j]);
        free(sweep->axes[i].values);
        free(sweep->axes[i].path);
    }
    grid_free(&sweep->grid);
    steps_free(&sweep->steps);
    cJSON_Delete(sweep->plots);
    free(sweep->columns);
    free(sweep->axes);
}

int sweep_measure(struct console *console, const struct options *options)
{
    const struct dt_log *log = &console->log;
    struct measured_sweep sweep = {.options = options, .plots = cJSON_CreateArray()};
    const struct steps_request request = {.setup = &options->setup,
                                          .output = options->output,
                                          .spp = options->spp,
                                          .noise = options->noise,
                                          .frames = options->run_frames,
                                          .warmup = options->warmup,
                                          .collect = options->collect};
    struct steps *steps = &sweep.steps;
    int status = EXIT_USAGE;
    bool good = read_measures(&sweep.measures, options->measure, log) &&
                check_grid_options(&sweep, options, log) && read_axes(&sweep, options, log) &&
                steps_begin(steps, "sweep", console, &request) &&
                (options->scene_list.count ? steps_find_scenes(steps, options->scene_list.items,
                                                               options->scene_list.count)
                                           : steps_without_scene(steps)) &&
                plot_has_gnuplot(console) && steps_check_spec(steps) && steps_make_folder(steps) &&
                plan(&sweep);
    if (good && (options->collect || steps_run(steps))) {
        status = summarise(&sweep);
        steps_count_failures(steps);
    }
    sweep_free(&sweep);
    return status;
}
