/* The tables of a report's page. Called by report_page.c. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "report/report.h"

/* ---- Text ------------------------------------------------------------------------------------ */

void report_put_text(FILE *out, const char *text)
{
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc(*text, out);
        }
    }
}

void report_put_link(FILE *out, const char *path)
{
    static const char plain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~/";
    for (; *path; path++)
        fprintf(out, strchr(plain, *path) ? "%c" : "%%%02X", (unsigned char)*path);
}

void report_put_number(FILE *out, double value)
{
    double size = fabs(value);
    if (isnan(value))
        fputs("&ndash;", out);
    else if (size >= 100 || (size >= 2 && value == floor(value)))
        fprintf(out, "%.0f", value);
    else if (size >= 10)
        fprintf(out, "%.1f", value);
    else if (size >= 1 || size == 0)
        fprintf(out, "%.2f", value);
    else if (size >= 0.001)
        fprintf(out, "%#.3g", value);
    else
        fprintf(out, "%.1e", value);
}

void report_put_result(FILE *out, struct report *report, const char *file, const char *path)
{
    fputs("<data value=\"", out);
    report_put_text(out, file);
    fprintf(out, "#%s\">", path);
    report_put_number(out, steps_number(&report->steps, file, path));
    fputs("</data>", out);
}

void report_put_percentage(FILE *out, struct report *report, const char *file, const char *path)
{
    fputs("<data value=\"", out);
    report_put_text(out, file);
    fprintf(out, "#%s\">", path);
    double value = 100 * steps_number(&report->steps, file, path);
    report_put_number(out, value);
    fputs(isnan(value) ? "</data>" : "&nbsp;%</data>", out);
}

static void put_result_cell(FILE *out, struct report *report, const char *file, const char *path)
{
    fputs("<td>", out);
    if (file)
        report_put_result(out, report, file, path);
    fputs("</td>", out);
}

static void put_value_heads(FILE *out, const struct report *report)
{
    char buffer[32];
    for (int i = 0; i < report_value_count(report); i++) {
        fputs("<th scope=\"col\">", out);
        report_put_text(out, report_item(report_values(report), i, buffer));
        fputs("</th>", out);
    }
}

/* ---- Overview -------------------------------------------------------------------------------- */

static void put_overview_heads(FILE *out)
{
    fputs("<thead><tr><th scope=\"col\">Scene</th><th class=\"word\" scope=\"col\">Picture</th>"
          "<th scope=\"col\">Relative MSE</th><th scope=\"col\">FLIP</th>"
          "<th scope=\"col\">Mean / reference</th></tr></thead>\n",
          out);
}

static void put_ratio_cell(FILE *out, struct report *report, const char *file)
{
    fputs("<td>", out);
    report_put_number(out, steps_number(&report->steps, file, "hdr.mean_test") /
                               steps_number(&report->steps, file, "hdr.mean_reference"));
    fputs("</td>", out);
}

static void put_overview_rows(FILE *out, struct report *report, const struct step_scene *scene)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    bool first = true;
    fputs("<tbody>\n", out);
    cJSON_ArrayForEach(picture, pictures)
    {
        char *file = report_file(scene, step_text(picture, "name"), ".json");
        fputs("<tr>", out);
        if (first) {
            fprintf(out, "<th scope=\"rowgroup\" rowspan=\"%d\"><a href=\"#scene-%u\">",
                    cJSON_GetArraySize(pictures), (unsigned)(scene - report->steps.scenes));
            report_put_text(out, scene->name);
            fputs("</a></th>", out);
        }
        fputs("<td class=\"word\">", out);
        report_put_text(out, step_text(picture, "title"));
        fputs("</td>", out);
        put_result_cell(out, report, file, "hdr.relative_mse");
        put_result_cell(out, report, file, "ldr.flip.mean");
        put_ratio_cell(out, report, file ? file : "");
        fputs("</tr>\n", out);
        free(file);
        first = false;
    }
    fputs("</tbody>\n", out);
}

void report_put_overview(FILE *out, struct report *report)
{
    fputs("<div class=\"scroll\"><table>\n", out);
    put_overview_heads(out);
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (report->steps.scenes[i].mesh)
            put_overview_rows(out, report, &report->steps.scenes[i]);
    }
    fputs("</table></div>\n", out);
}

/* ---- Errors over the sweep ------------------------------------------------------------------- */

/* One of the tables of errors: which files, and where in them. */
struct error_table {
    const char *caption, *path;
    char *(*file)(const struct grid *grid, const struct grid_point *point, uint32_t side);
};

/* Of all pictures of a scene. */
static void put_error_rows(FILE *out, struct report *report, const struct step_scene *scene,
                           const struct error_table *table)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    fprintf(out, "<tbody><tr><th scope=\"rowgroup\" rowspan=\"%d\">", cJSON_GetArraySize(pictures));
    report_put_text(out, scene->name);
    fputs("</th>", out);
    cJSON_ArrayForEach(picture, pictures)
    {
        fprintf(out, "%s<td class=\"word\">", picture == pictures->child ? "" : "<tr>");
        report_put_text(out, step_text(picture, "title"));
        fputs("</td>", out);
        for (int i = 0; i < report_value_count(report); i++) {
            char *file = table->file(&report->grid, report_point(report, scene, picture, i), 0);
            put_result_cell(out, report, file, table->path);
            free(file);
        }
        fputs("</tr>\n", out);
    }
    fputs("</tbody>\n", out);
}

static void put_error_table(FILE *out, struct report *report, const struct error_table *table)
{
    fprintf(out,
            "<div class=\"scroll\"><table><caption>%s</caption>\n<thead><tr><th scope=\"col\">"
            "Scene</th><th class=\"word\" scope=\"col\">",
            table->caption);
    report_put_text(out, report_parameter(report));
    fputs("</th>", out);
    put_value_heads(out, report);
    fputs("</tr></thead>\n", out);
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (report->steps.scenes[i].mesh)
            put_error_rows(out, report, &report->steps.scenes[i], table);
    }
    fputs("</table></div>\n", out);
}

void report_put_errors(FILE *out, struct report *report)
{
    static const struct error_table tables[] = {
        {"Relative MSE against the reference", "hdr.relative_mse", grid_error_file},
        {"FLIP against the reference", "ldr.flip.mean", grid_error_file},
        {"Relative MSE against the same picture of the last column", "hdr.relative_mse",
         grid_own_file},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(tables); i++)
        put_error_table(out, report, &tables[i]);
}

/* ---- Flicker --------------------------------------------------------------------------------- */

static void put_flicker_row(FILE *out, struct report *report, const char *file, const char *title)
{
    static const char *const paths[] = {"relative_change", "relative_change_reference",
                                        "relative_excess", "relative_flicker"};
    fputs("<tr><th scope=\"row\">", out);
    report_put_text(out, title);
    fputs("</th>", out);
    for (size_t i = 0; i < DT_ARRAY_COUNT(paths); i++) {
        fputs("<td>", out);
        report_put_percentage(out, report, file, paths[i]);
        fputs("</td>", out);
    }
    fputs("</tr>\n", out);
}

void report_put_flicker(FILE *out, struct report *report, const struct step_scene *scene,
                        const cJSON *motion)
{
    const cJSON *run, *settings = cJSON_GetObjectItem(report->outline, "motion");
    fputs("<div class=\"scroll\"><table><caption>Means over all frames</caption>\n<thead><tr>"
          "<th scope=\"col\">Run</th><th scope=\"col\">Change</th>"
          "<th scope=\"col\">Reference&rsquo;s change</th><th scope=\"col\">Excess</th>"
          "<th scope=\"col\">Flicker</th></tr></thead>\n<tbody>\n",
          out);
    cJSON_ArrayForEach(run, cJSON_GetObjectItem(settings, "runs"))
    {
        char *file = report_motion_file(scene, motion, step_text(run, "name"), ".json");
        put_flicker_row(out, report, file ? file : "", step_text(run, "title"));
        free(file);
    }
    char *noise = report_motion_file(scene, motion, "noise", ".json");
    put_flicker_row(out, report, noise ? noise : "", "The reference once more, with other noise");
    free(noise);
    fputs("</tbody></table></div>\n", out);
}

/* ---- Stages ---------------------------------------------------------------------------------- */

/* What was published of this scene, or NULL. */
static const cJSON *published_of(const struct report *report, const struct step_scene *scene)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    return strcmp(step_text(published, "scene"), scene->name) == 0 ? published : NULL;
}

/* A row group of the table: one line per backend, and what was published. */
struct stage_row {
    const char *name, *doc;
    const cJSON *stage;     /* NULL: passes of none, or the whole frame */
    const cJSON *published; /* numbers, or NULL */
    bool whole;
};

static void put_row_head(FILE *out, const struct stage_row *row, uint32_t lines)
{
    fprintf(out, "<tbody><tr><th scope=\"rowgroup\" rowspan=\"%u\">", lines);
    report_put_text(out, row->name);
    if (*row->doc) {
        fputs("<small>", out);
        report_put_text(out, row->doc);
        fputs("</small>", out);
    }
    fputs("</th>", out);
}

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

/* NULL has the passes that no stage has. */
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

static void put_time_cell(FILE *out, const struct report *report, const struct stage_row *row,
                          const struct grid_point *point, uint32_t side)
{
    fputs("<td>", out);
    report_put_number(out, row->whole ? grid_number(&report->grid, point, side, "frame_ms")
                                      : stage_ms(report, row->stage, point, side));
    fputs("</td>", out);
}

static void put_published_row(FILE *out, const struct report *report, const cJSON *numbers)
{
    const cJSON *item;
    fputs("<tr class=\"published\"><td class=\"word\">", out);
    report_put_text(out, step_text(cJSON_GetObjectItem(report->outline, "published"), "by"));
    fputs("</td>", out);
    cJSON_ArrayForEach(item, numbers)
    {
        fputs("<td>", out);
        report_put_number(out, item->valuedouble);
        fputs("</td>", out);
    }
    fputs("</tr>\n", out);
}

static void put_stage(FILE *out, const struct report *report, const struct step_scene *scene,
                      const struct stage_row *row)
{
    put_row_head(out, row, report->steps.sides.count + (row->published != NULL));
    for (uint32_t side = 0; side < report->steps.sides.count; side++) {
        fprintf(out, "%s<td class=\"word\">", side ? "<tr>" : "");
        report_put_text(out, report->steps.sides.list[side].label);
        fputs("</td>", out);
        for (int i = 0; i < report_value_count(report); i++)
            put_time_cell(out, report, row,
                          report_point(report, scene, report_last_picture(report), i), side);
        fputs("</tr>\n", out);
    }
    if (row->published)
        put_published_row(out, report, row->published);
    fputs("</tbody>\n", out);
}

static void put_stage_rows(FILE *out, const struct report *report, const struct step_scene *scene)
{
    const cJSON *stage, *published = published_of(report, scene);
    const cJSON *stages = cJSON_GetObjectItem(published, "stages");
    cJSON_ArrayForEach(stage, cJSON_GetObjectItem(report->outline, "stages"))
    {
        const char *name = step_text(stage, "name");
        put_stage(out, report, scene,
                  &(struct stage_row){.name = name,
                                      .doc = step_text(stage, "doc"),
                                      .stage = stage,
                                      .published = cJSON_GetObjectItem(stages, name)});
    }
    put_stage(out, report, scene, &(struct stage_row){.name = "Other passes", .doc = ""});
    put_stage(out, report, scene,
              &(struct stage_row){.name = "Whole frame",
                                  .doc = "without timestamps",
                                  .published = cJSON_GetObjectItem(published, "total"),
                                  .whole = true});
}

static void put_other_hardware(FILE *out, const cJSON *published)
{
    if (!published)
        return;
    fputs("<small>other hardware: ", out);
    report_put_text(out, step_text(published, "by"));
    fputs(" had a ", out);
    report_put_text(out, step_text(published, "device"));
    fputs(" at ", out);
    report_put_text(out, step_text(published, "size"));
    fputs("</small>", out);
}

void report_put_stages(FILE *out, struct report *report, const struct step_scene *scene)
{
    fputs("<div class=\"scroll\"><table><caption>", out);
    report_put_text(out, scene->name);
    fprintf(out, ": milliseconds at %ux%u", report->steps.options->size[0],
            report->steps.options->size[1]);
    put_other_hardware(out, published_of(report, scene));
    fputs("</caption>\n<thead><tr><th scope=\"col\">Stage</th><th class=\"word\" scope=\"col\">",
          out);
    report_put_text(out, report_parameter(report));
    fputs("</th>", out);
    put_value_heads(out, report);
    fputs("</tr></thead>\n", out);
    put_stage_rows(out, report, scene);
    fputs("</table></div>\n", out);
}
