/* Numbers and tables of a report's page, as JSON for its template. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "report/report.h"

/* ---- Numbers --------------------------------------------------------------------------------- */

void report_add_link(cJSON *item, const char *key, const char *path)
{
    static const char plain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~/";
    char *text = malloc(3 * strlen(path) + 1), *to = text;
    for (; text && *path; path++)
        to += sprintf(to, strchr(plain, *path) ? "%c" : "%%%02X", (unsigned char)*path);
    if (text)
        *to = 0;
    cJSON_AddStringToObject(item, key, text ? text : "");
    free(text);
}

/* With as many digits as a reader needs; a dash for NaN. */
static const char *number_text(double value, char buffer[32])
{
    double size = fabs(value);
    const char *format = size >= 100 || (size >= 2 && value == floor(value)) ? "%.0f"
                         : size >= 10                                        ? "%.1f"
                         : size >= 1 || size == 0                            ? "%.2f"
                         : size >= 0.001                                     ? "%#.3g"
                                                                             : "%.1e";
    if (isnan(value))
        return "\u2013";
    snprintf(buffer, 32, format, value);
    return buffer;
}

void report_add_number(cJSON *item, const char *key, double value)
{
    char buffer[32];
    cJSON_AddStringToObject(item, key, number_text(value, buffer));
}

/* {"from": "FILE#PATH", "text"}; a percentage has its sign. */
static cJSON *result_json(struct report *report, const char *file, const char *path, bool percent)
{
    double value = steps_number(&report->steps, file, path) * (percent ? 100 : 1);
    char buffer[32];
    char *from = format_string("%s#%s", file, path);
    char *text = format_string("%s%s", number_text(value, buffer),
                               percent && !isnan(value) ? "\u00a0%" : "");
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "from", from ? from : "");
    cJSON_AddStringToObject(item, "text", text ? text : "");
    free(text);
    free(from);
    return item;
}

void report_add_result(cJSON *item, const char *key, struct report *report, const char *file,
                       const char *path)
{
    cJSON_AddItemToObject(item, key, result_json(report, file, path, false));
}

void report_add_headlines(cJSON *item, const char *key, struct report *report, const char *file)
{
    cJSON *list = cJSON_AddArrayToObject(item, key);
    for (int i = 0; i < IMAGE_HEADLINES; i++) {
        char *path = measure_path(&image_numbers[i]);
        cJSON *number = result_json(report, file, path ? path : "", false);
        cJSON_AddStringToObject(number, "what", image_numbers[i].title);
        cJSON_AddItemToArray(list, number);
        free(path);
    }
}

/* ---- Errors over the sweep ------------------------------------------------------------------- */

/* One of the tables of errors: which files, and where in them. */
struct error_table {
    const char *caption, *path;
    char *(*file)(const struct grid *grid, const struct grid_point *point, uint32_t side);
};

/* All pictures of a scene, a row each. */
static cJSON *error_rows(struct report *report, const struct step_scene *scene,
                         const struct error_table *table)
{
    const cJSON *picture;
    cJSON *rows = cJSON_CreateArray();
    cJSON_ArrayForEach(picture, cJSON_GetObjectItem(report->outline, "pictures"))
    {
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "scene", scene->name);
        cJSON_AddStringToObject(row, "picture", step_text(picture, "title"));
        cJSON *cells = cJSON_AddArrayToObject(row, "cells");
        for (int i = 0; i < report_value_count(report); i++) {
            char *file = table->file(&report->grid, report_point(report, scene, picture, i), 0);
            cJSON_AddItemToArray(cells, result_json(report, file ? file : "", table->path, false));
            free(file);
        }
        cJSON_AddItemToArray(rows, row);
    }
    return rows;
}

static cJSON *error_table_json(struct report *report, const struct error_table *table)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "caption", table->caption);
    cJSON *groups = cJSON_AddArrayToObject(item, "groups");
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (!report->steps.scenes[i].mesh)
            continue;
        cJSON *group = cJSON_CreateObject();
        cJSON_AddItemToObject(group, "rows", error_rows(report, &report->steps.scenes[i], table));
        cJSON_AddItemToArray(groups, group);
    }
    return item;
}

void report_add_errors(cJSON *page, struct report *report)
{
    const struct error_table own = {"relative MSE against the same picture of the last column",
                                    "hdr.relative_mse", grid_own_file};
    char buffer[32];
    cJSON *values = cJSON_AddArrayToObject(page, "values");
    for (int i = 0; i < report_value_count(report); i++)
        cJSON_AddItemToArray(values,
                             cJSON_CreateString(report_item(report_values(report), i, buffer)));
    cJSON *list = cJSON_AddArrayToObject(page, "error_tables");
    for (int i = 0; i < IMAGE_HEADLINES; i++) {
        char *path = measure_path(&image_numbers[i]);
        const struct error_table table = {image_numbers[i].title, path ? path : "",
                                          grid_error_file};
        cJSON_AddItemToArray(list, error_table_json(report, &table));
        free(path);
    }
    cJSON_AddItemToArray(list, error_table_json(report, &own));
}

/* ---- Flicker --------------------------------------------------------------------------------- */

static cJSON *flicker_row(struct report *report, const char *file, const char *title)
{
    static const char *const paths[] = {"relative_change", "relative_change_reference",
                                        "relative_excess", "relative_flicker"};
    cJSON *row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "run", title);
    cJSON *cells = cJSON_AddArrayToObject(row, "cells");
    for (size_t i = 0; i < DT_ARRAY_COUNT(paths); i++)
        cJSON_AddItemToArray(cells, result_json(report, file, paths[i], true));
    return row;
}

void report_add_flicker(cJSON *item, struct report *report, const struct step_scene *scene,
                        const cJSON *motion)
{
    const cJSON *run, *settings = cJSON_GetObjectItem(report->outline, "motion");
    cJSON *rows = cJSON_AddArrayToObject(item, "rows");
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(settings, "runs"))
    {
        char *file = report_motion_file(scene, motion, step_text(run, "name"), ".json");
        cJSON_AddItemToArray(rows, flicker_row(report, file ? file : "", step_text(run, "title")));
        free(file);
    }
    char *noise = report_motion_file(scene, motion, "noise", ".json");
    cJSON_AddItemToArray(
        rows, flicker_row(report, noise ? noise : "", "The reference once more, with other noise"));
    free(noise);
}

/* ---- Stages ---------------------------------------------------------------------------------- */

void report_add_published(cJSON *item, const char *key, const cJSON *published)
{
    static const char *const names[] = {"by", "device", "size"};
    cJSON *copy = published ? cJSON_AddObjectToObject(item, key) : NULL;
    for (size_t i = 0; copy && i < DT_ARRAY_COUNT(names); i++)
        cJSON_AddStringToObject(copy, names[i], step_text(published, names[i]));
}

/* What was published of this scene, or NULL. */
static const cJSON *published_of(const struct report *report, const struct step_scene *scene)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    return strcmp(step_text(published, "scene"), scene->name) == 0 ? published : NULL;
}

/* A row group of the table: a line for each backend, and one for what was published. */
struct stage_row {
    const char *name, *doc;
    const cJSON *stage;     /* NULL: the passes of no stage, or the whole frame */
    const cJSON *published; /* numbers, or NULL */
    bool whole;
};

static bool stage_has(const cJSON *stage, const char *pass)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(stage, "passes"))
    {
        if (cJSON_IsString(item) && strcmp(item->valuestring, pass) == 0)
            return true;
    }
    return false;
}

/* A stage of NULL has the passes that no stage has. */
static bool belongs_to(const struct report *report, const cJSON *stage, const char *pass)
{
    const cJSON *any;
    if (stage)
        return stage_has(stage, pass);
    cJSON_ArrayForEach(any, cJSON_GetObjectItem(report->outline, "stages"))
    {
        if (stage_has(any, pass))
            return false;
    }
    return true;
}

/* The sum of its passes' medians. */
static double stage_ms(const struct report *report, const cJSON *stage,
                       const struct grid_point *point, uint32_t side)
{
    const struct grid *grid = &report->grid;
    double sum = NAN;
    for (uint32_t i = 0; i < grid->pass_count; i++) {
        double ms = grid_pass_ms(grid, point, side, grid->passes[i], "median");
        if (!isnan(ms) && belongs_to(report, stage, grid->passes[i]))
            sum = (isnan(sum) ? 0 : sum) + ms;
    }
    return sum;
}

/* A line of a row group; its cells are the caller's to add. */
static void add_line(cJSON *lines, const char *label, bool published, cJSON **cells)
{
    cJSON *line = cJSON_CreateObject();
    cJSON_AddStringToObject(line, "label", label);
    cJSON_AddBoolToObject(line, "is_published", published);
    *cells = cJSON_AddArrayToObject(line, "cells");
    cJSON_AddItemToArray(lines, line);
}

static void add_cell(cJSON *cells, double value)
{
    char buffer[32];
    cJSON_AddItemToArray(cells, cJSON_CreateString(number_text(value, buffer)));
}

/* At a value of the sweep, on one side. */
static double row_ms(const struct report *report, const struct step_scene *scene,
                     const struct stage_row *row, int value, uint32_t side)
{
    const struct grid_point *point =
        report_point(report, scene, report_last_picture(report), value);
    return row->whole ? grid_number(&report->grid, point, side, "frame_ms")
                      : stage_ms(report, row->stage, point, side);
}

/* What was published, and each side divided by it. */
static void add_published_lines(cJSON *lines, const struct report *report,
                                const struct step_scene *scene, const struct stage_row *row)
{
    const char *by = step_text(published_of(report, scene), "by");
    const cJSON *number;
    cJSON *cells;
    add_line(lines, by, true, &cells);
    cJSON_ArrayForEach(number, row->published) add_cell(cells, number->valuedouble);
    for (uint32_t side = 0; side < report->steps.sides.count; side++) {
        int value = 0;
        char *label = format_string("%s / %s", report->steps.sides.list[side].label, by);
        add_line(lines, label ? label : "", true, &cells);
        cJSON_ArrayForEach(number, row->published)
            add_cell(cells, row_ms(report, scene, row, value++, side) / number->valuedouble);
        free(label);
    }
}

static cJSON *stage_json(const struct report *report, const struct step_scene *scene,
                         const struct stage_row *row)
{
    cJSON *cells, *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "stage", row->name);
    cJSON_AddStringToObject(item, "doc", row->doc);
    cJSON *lines = cJSON_AddArrayToObject(item, "lines");
    for (uint32_t side = 0; side < report->steps.sides.count; side++) {
        add_line(lines, report->steps.sides.list[side].label, false, &cells);
        for (int i = 0; i < report_value_count(report); i++)
            add_cell(cells, row_ms(report, scene, row, i, side));
    }
    if (row->published)
        add_published_lines(lines, report, scene, row);
    cJSON_AddNumberToObject(item, "line_count", cJSON_GetArraySize(lines));
    return item;
}

void report_add_stages(cJSON *item, const struct report *report, const struct step_scene *scene)
{
    const cJSON *stage, *published = published_of(report, scene);
    const cJSON *numbers = cJSON_GetObjectItem(published, "stages");
    report_add_published(item, "scene_published", published);
    cJSON *stages = cJSON_AddArrayToObject(item, "stages");
    cJSON_ArrayForEach(stage, cJSON_GetObjectItem(report->outline, "stages"))
    {
        const struct stage_row row = {.name = step_text(stage, "name"),
                                      .doc = step_text(stage, "doc"),
                                      .stage = stage,
                                      .published =
                                          cJSON_GetObjectItem(numbers, step_text(stage, "name"))};
        cJSON_AddItemToArray(stages, stage_json(report, scene, &row));
    }
    const struct stage_row other = {.name = "Other passes", .doc = ""};
    const struct stage_row whole = {.name = "Whole frame",
                                    .doc = "without timestamps",
                                    .published = cJSON_GetObjectItem(published, "total"),
                                    .whole = true};
    cJSON_AddItemToArray(stages, stage_json(report, scene, &other));
    cJSON_AddItemToArray(stages, stage_json(report, scene, &whole));
}
