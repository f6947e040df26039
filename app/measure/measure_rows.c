/* Rows of a grid of measurements, from the results of its steps; see measure.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "measure/measure.h"

/* ---- Files ----------------------------------------------------------------------------------- */

char *grid_bench_file(const struct grid_point *point)
{
    return format_string("%s/%s_bench.json", point->scene->name, point->name);
}

char *grid_compare_file(const struct grid_point *point)
{
    return format_string("%s/%s_compare.json", point->scene->name, point->name);
}

static char *side_file(const struct grid *grid, const struct grid_point *point, uint32_t side,
                       const char *ending)
{
    char *label = strdup(grid->steps->sides.list[side].label);
    for (char *at = label; at && *at; at++)
        if (strchr("/ |\n", *at))
            *at = '_';
    char *file =
        label ? format_string("%s/%s_%s%s", point->scene->name, point->name, label, ending) : NULL;
    free(label);
    return file;
}

char *grid_picture_file(const struct grid *grid, const struct grid_point *point, uint32_t side)
{
    return side_file(grid, point, side, ".exr");
}

char *grid_error_file(const struct grid *grid, const struct grid_point *point, uint32_t side)
{
    return side_file(grid, point, side, ".json");
}

char *grid_own_file(const struct grid *grid, const struct grid_point *point, uint32_t side)
{
    return side_file(grid, point, side, "_own.json");
}

/* ---- Numbers --------------------------------------------------------------------------------- */

/* A column with one number. */
struct column {
    char name[64];
    unsigned measure;
    char path[64]; /* in the JSON of the measure's command; of a time, in `frame_ms` */
};

/* One of the columns of times: 0 to TIME_COLUMNS - 1. */
enum { TIME_COLUMNS = 3 };
static struct column time_column(uint32_t index)
{
    static const struct column columns[TIME_COLUMNS] = {
        {"frame_ms", MEASURE_TIME, "median"},
        {"frame_ms_p5", MEASURE_TIME, "p5"},
        {"frame_ms_p95", MEASURE_TIME, "p95"},
    };
    return columns[index];
}

char *measure_path(const struct image_number *number)
{
    return format_string("%s.%s%s", number->mapped ? "ldr" : "hdr", number->name,
                         strcmp(number->name, "flip") == 0 ? ".mean" : "");
}

static struct column error_column(unsigned measure, uint32_t index, bool standard_error)
{
    const struct image_number *number = &image_numbers[index];
    struct column column = {.measure = measure};
    char *path = measure_path(number);
    snprintf(column.name, sizeof column.name, "%s%s%s", measure == MEASURE_OWN ? "own_" : "",
             number->name, standard_error ? "_standard_error" : "");
    snprintf(column.path, sizeof column.path, "%s%s", standard_error ? "standard_errors." : "",
             path ? path : "");
    free(path);
    return column;
}

/* The columns that the grid has, in order, from index 0; false beyond the last. */
static bool column_at(const struct grid *grid, uint32_t index, struct column *column)
{
    uint32_t times = grid->measures & MEASURE_TIME ? TIME_COLUMNS : 0;
    uint32_t each = grid->every_frame ? 2 : 1;
    uint32_t errors = grid->measures & MEASURE_ERROR ? each * IMAGE_NUMBERS : 0;
    uint32_t own = grid->measures & MEASURE_OWN ? IMAGE_NUMBERS : 0;
    if (index < times)
        *column = time_column(index);
    else if ((index -= times) < errors)
        *column = error_column(MEASURE_ERROR, index / each, index % each);
    else if ((index -= errors) < own)
        *column = error_column(MEASURE_OWN, index, false);
    else
        return false;
    return true;
}

static const cJSON *bench_side(const struct grid *grid, const struct grid_point *point,
                               uint32_t side)
{
    char *file = grid_bench_file(point);
    const cJSON *result = file ? steps_result(grid->steps, file) : NULL;
    free(file);
    return cJSON_GetArrayItem(cJSON_GetObjectItem(result, "sides"), (int)side);
}

static double member(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

/* NAN where the point does not have it. */
static double column_number(const struct grid *grid, const struct grid_point *point, uint32_t side,
                            const struct column *column)
{
    if (!(point->measures & column->measure))
        return NAN;
    if (column->measure == MEASURE_TIME)
        return member(cJSON_GetObjectItem(bench_side(grid, point, side), "frame_ms"), column->path);
    if (side >= grid->pictured)
        return NAN;
    char *file = column->measure == MEASURE_OWN ? grid_own_file(grid, point, side)
                                                : grid_error_file(grid, point, side);
    double value = file ? steps_number(grid->steps, file, column->path) : NAN;
    free(file);
    return value;
}

double grid_number(const struct grid *grid, const struct grid_point *point, uint32_t side,
                   const char *name)
{
    struct column column;
    for (uint32_t i = 0; column_at(grid, i, &column); i++)
        if (strcmp(column.name, name) == 0)
            return column_number(grid, point, side, &column);
    return NAN;
}

double grid_pass_ms(const struct grid *grid, const struct grid_point *point, uint32_t side,
                    const char *pass, const char *of)
{
    const cJSON *item, *passes = cJSON_GetObjectItem(bench_side(grid, point, side), "passes");
    cJSON_ArrayForEach(item, passes)
    {
        if (strcmp(step_text(item, "pass"), pass) == 0)
            return member(cJSON_GetObjectItem(item, "ms"), of);
    }
    return NAN;
}

/* "yes", "no" or "". */
static const char *agreement(const struct grid *grid, const struct grid_point *point)
{
    char *file = point->measures & MEASURE_AGREE ? grid_compare_file(point) : NULL;
    const cJSON *status =
        cJSON_GetObjectItem(file ? steps_result(grid->steps, file) : NULL, "exit_status");
    free(file);
    return !status ? "" : status->valueint == 0 ? "yes" : "no";
}

/* Takes over `file`. */
static char *reason_of(const struct grid *grid, char *file, bool wanted)
{
    char *reason = file && wanted ? steps_reason(grid->steps, file) : NULL;
    free(file);
    return reason;
}

char *grid_reason(const struct grid *grid, const struct grid_point *point, uint32_t side)
{
    unsigned measures = point->measures;
    bool pictured = side < grid->pictured;
    char *reason = reason_of(grid, grid_bench_file(point), measures & MEASURE_TIME);
    if (!reason)
        reason = reason_of(grid, grid_error_file(grid, point, side),
                           pictured && (measures & MEASURE_ERROR));
    if (!reason)
        reason =
            reason_of(grid, grid_own_file(grid, point, side), pictured && (measures & MEASURE_OWN));
    if (!reason)
        reason = reason_of(grid, grid_compare_file(point), measures & MEASURE_AGREE);
    return reason;
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static bool add_pass(struct grid *grid, const char *pass)
{
    for (uint32_t i = 0; i < grid->pass_count; i++)
        if (strcmp(grid->passes[i], pass) == 0)
            return true;
    char **grown = realloc(grid->passes, (grid->pass_count + 1) * sizeof *grown);
    if (!grown)
        return false;
    grid->passes = grown;
    grown[grid->pass_count] = strdup(pass);
    return grown[grid->pass_count] && ++grid->pass_count;
}

bool grid_read(struct grid *grid)
{
    bool good = true;
    for (uint32_t i = 0; i < grid->count; i++) {
        const cJSON *side =
            grid->points[i].measures & MEASURE_TIME ? bench_side(grid, &grid->points[i], 0) : NULL;
        const cJSON *item;
        cJSON_ArrayForEach(item, cJSON_GetObjectItem(side, "passes")) good =
            good && add_pass(grid, step_text(item, "pass"));
    }
    if (!good)
        report_error(&grid->steps->console->log, "out of memory");
    return good;
}

/* ---- CSV and JSON ---------------------------------------------------------------------------- */

/* As RFC 4180 has it. */
static void put_csv_field(FILE *out, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++)
        fputs(*text == '"' ? "\"\"" : (char[2]){*text}, out);
    fputc('"', out);
}

static void put_number(FILE *out, double value)
{
    fputc(',', out);
    if (isfinite(value))
        fprintf(out, "%.6g", value);
}

static void put_heads(FILE *out, const struct grid *grid)
{
    static const char *const endings[] = {"_ms", "_ms_p5", "_ms_p95"};
    struct column column;
    fputs("scene,backend,width,height", out);
    for (uint32_t i = 0; i < grid->column_count; i++) {
        fputc(',', out);
        put_csv_field(out, grid->columns[i]);
    }
    fputs(",status,reason", out);
    if (grid->measures & MEASURE_AGREE)
        fputs(",agree", out);
    for (uint32_t i = 0; column_at(grid, i, &column); i++)
        fprintf(out, ",%s", column.name);
    for (size_t i = 0; i < grid->pass_count * DT_ARRAY_COUNT(endings); i++)
        fprintf(out, ",%s%s", grid->passes[i / DT_ARRAY_COUNT(endings)],
                endings[i % DT_ARRAY_COUNT(endings)]);
    fputc('\n', out);
}

static void put_row(FILE *out, const struct grid *grid, const struct grid_point *point,
                    uint32_t side)
{
    static const char *const spread[] = {"median", "p5", "p95"};
    struct column column;
    char *reason = grid_reason(grid, point, side);
    put_csv_field(out, point->scene->name);
    fputc(',', out);
    put_csv_field(out, grid->steps->sides.list[side].label);
    fprintf(out, ",%u,%u", point->size[0], point->size[1]);
    for (uint32_t i = 0; i < grid->column_count; i++) {
        fputc(',', out);
        put_csv_field(out, point->values[i]);
    }
    fprintf(out, ",%s,", reason ? "failed" : "done");
    put_csv_field(out, reason ? reason : "");
    free(reason);
    if (grid->measures & MEASURE_AGREE)
        fprintf(out, ",%s", agreement(grid, point));
    for (uint32_t i = 0; column_at(grid, i, &column); i++)
        put_number(out, column_number(grid, point, side, &column));
    for (size_t i = 0; i < grid->pass_count * DT_ARRAY_COUNT(spread); i++)
        put_number(out, grid_pass_ms(grid, point, side, grid->passes[i / DT_ARRAY_COUNT(spread)],
                                     spread[i % DT_ARRAY_COUNT(spread)]));
    fputc('\n', out);
}

/* A side without measurements at a point has no row there. */
static bool has_row(const struct grid *grid, const struct grid_point *point, uint32_t side)
{
    return side < grid->pictured || (point->measures & (MEASURE_TIME | MEASURE_AGREE));
}

bool grid_write_csv(const struct grid *grid, const char *path)
{
    const struct dt_log *log = &grid->steps->console->log;
    struct file_draft draft;
    if (!file_draft_begin(&draft, log))
        return false;
    put_heads(draft.out, grid);
    for (uint32_t i = 0; i < grid->count; i++) {
        for (uint32_t side = 0; side < grid->steps->sides.count; side++)
            if (has_row(grid, &grid->points[i], side))
                put_row(draft.out, grid, &grid->points[i], side);
    }
    return file_draft_end(&draft, path, log);
}

static void add_if_finite(cJSON *row, const char *name, double value)
{
    if (isfinite(value))
        cJSON_AddNumberToObject(row, name, value);
}

static cJSON *row_json(const struct grid *grid, const struct grid_point *point, uint32_t side)
{
    cJSON *row = cJSON_CreateObject();
    struct column column;
    char *reason = grid_reason(grid, point, side);
    cJSON_AddStringToObject(row, "scene", point->scene->path);
    cJSON_AddStringToObject(row, "backend", grid->steps->sides.list[side].label);
    cJSON_AddNumberToObject(row, "width", point->size[0]);
    cJSON_AddNumberToObject(row, "height", point->size[1]);
    cJSON *values = cJSON_AddObjectToObject(row, "values");
    for (uint32_t i = 0; i < grid->column_count; i++)
        cJSON_AddStringToObject(values, grid->columns[i], point->values[i]);
    cJSON_AddStringToObject(row, "status", reason ? "failed" : "done");
    if (reason)
        cJSON_AddStringToObject(row, "reason", reason);
    if (*agreement(grid, point))
        cJSON_AddStringToObject(row, "agree", agreement(grid, point));
    for (uint32_t i = 0; column_at(grid, i, &column); i++)
        add_if_finite(row, column.name, column_number(grid, point, side, &column));
    cJSON *passes = point->measures & MEASURE_TIME ? cJSON_AddObjectToObject(row, "passes") : NULL;
    for (uint32_t i = 0; i < grid->pass_count && passes; i++)
        add_if_finite(passes, grid->passes[i],
                      grid_pass_ms(grid, point, side, grid->passes[i], "median"));
    free(reason);
    return row;
}

cJSON *grid_json(const struct grid *grid)
{
    cJSON *rows = cJSON_CreateArray();
    for (uint32_t i = 0; i < grid->count; i++) {
        for (uint32_t side = 0; side < grid->steps->sides.count; side++)
            if (has_row(grid, &grid->points[i], side))
                cJSON_AddItemToArray(rows, row_json(grid, &grid->points[i], side));
    }
    return rows;
}
