/* The plots of a report, by gnuplot, with the numbers behind them as CSV: error against the values of the sweep over
 * all scenes, frame time against them for each, change from frame to frame over motions. Called by report.c. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files.h"
#include "report.h"
#include "tool.h"

/* What SVG from gnuplot has in black follows the reader's choice of a dark page, and what it has in white, around
 * points, goes; the lines of the data have colours that can be seen on both. */
static const char svg_style[] =
    "<style>[color=\"white\"]{display:none}text{fill:#24292f}[stroke=\"black\"]{stroke:#57606a}"
    "@media(prefers-color-scheme:dark){text{fill:#d6dce3}[stroke=\"black\"]{stroke:#9aa4ae}}"
    "</style>\n";

static const char gnuplot_head[] = "set datafile separator ','\n"
                                   "set linetype 1 lc rgb '#2f80d0' lw 2 pt 7 ps 0.6\n"
                                   "set linetype 2 lc rgb '#d9771a' lw 2 pt 5 ps 0.6\n"
                                   "set linetype 3 lc rgb '#2c9c6c' lw 2 pt 9 ps 0.7\n"
                                   "set linetype 4 lc rgb '#a963c9' lw 2 pt 11 ps 0.7\n"
                                   "set linetype 5 lc rgb '#d34a4a' lw 2 pt 13 ps 0.7\n"
                                   "set linetype 6 lc rgb '#8a8f98' lw 2 pt 3 ps 0.6\n"
                                   "set border 3\n"
                                   "set tics nomirror\n"
                                   "set logscale y\n"
                                   "set mytics 1\n"
                                   "set grid ytics lc rgb '#9099a4' lw 0.4\n"
                                   "set key above\n"
                                   "set offsets 0.15, 0.15\n";

static void put_head(FILE *out, int height)
{
    fputs("# gnuplot, in this folder: the SVG comes on standard output.\n", out);
    fprintf(out,
            "set terminal svg size 480,%d font 'DejaVu Sans,Verdana,sans-serif,13' noenhanced\n",
            height);
    fputs(gnuplot_head, out);
}

/* ---- gnuplot --------------------------------------------------------------------------------- */

/* Of positive values, since the axis is logarithmic. */
struct range {
    double low, high; /* 0: no value yet */
};

static void take_in(struct range *range, double value)
{
    if (!(value > 0))
        return;
    range->low = range->low > 0 ? fmin(range->low, value) : value;
    range->high = fmax(range->high, value);
}

/* Room for all of them, and ticks at round numbers, the closer the narrower the range, which is one of 2.5
 * at least. */
static void put_range(FILE *out, const struct range *range)
{
    static const double room = 1.6, round[] = {1, 2, 5, 1.5, 3, 7};
    double low = range->low / room, high = range->high * room;
    int count = high < 10 * low ? DT_ARRAY_COUNT(round) : high < 1000 * low ? 3 : 1;
    const char *separator = "";
    fprintf(out, "set yrange [%g:%g]\nset ytics (", low, high);
    for (int decade = (int)floor(log10(low)); pow(10, decade) < high; decade++) {
        for (int i = 0; i < count; i++) {
            double tick = round[i] * pow(10, decade);
            fprintf(out, "%s\"%g\" %g", separator, tick, tick);
            separator = ", ";
        }
    }
    fputs(")\n", out);
}

/* Between single quotes, as gnuplot reads them. */
static void put_quoted(FILE *out, const char *text)
{
    fputc('\'', out);
    for (; *text; text++)
        fputs(*text == '\'' ? "''" : (char[2]){*text}, out);
    fputc('\'', out);
}

static const cJSON *sweep_values(const struct report *report)
{
    return cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "sweep"), "values");
}

/* The values of the sweep stand side by side, whatever they are. */
static void put_axes(FILE *out, const struct report *report, const char *y_label,
                     const struct range *range)
{
    char buffer[32];
    int count = cJSON_GetArraySize(sweep_values(report));
    put_head(out, REPORT_PLOT_HEIGHT);
    fputs("set xlabel ", out);
    put_quoted(out, report_text(cJSON_GetObjectItem(report->outline, "sweep"), "parameter"));
    fputs("\nset ylabel ", out);
    put_quoted(out, y_label);
    fputs("\nset xtics (", out);
    for (int i = 0; i < count; i++) {
        fputs(i ? ", " : "", out);
        put_quoted(out, report_item(sweep_values(report), i, buffer));
        fprintf(out, " %d", i);
    }
    fputs(")\n", out);
    put_range(out, range);
}

static bool write_text(const struct report *report, const char *name, const char *ending,
                       const char *text)
{
    char *path = format_string("%s/plots/%s%s", report->folder, name, ending);
    bool good = path && text;
    if (good)
        good = file_write(path, text, strlen(text), &report->console->log);
    else
        report_error(&report->console->log, "out of memory");
    free(path);
    return good;
}

/* Runs plots/NAME.gp. The answer is the SVG; free(). */
static char *run_gnuplot(const struct report *report, const char *name)
{
    static const struct tool gnuplot = {.what = "gnuplot",
                                        .hint = "install the package gnuplot-nox"};
    char *place = NULL, *script = format_string("%s/plots/%s.gp", report->folder, name);
    size_t size;
    FILE *out = open_memstream(&place, &size);
    if (out) {
        char *folder = format_string("%s/plots", report->folder);
        fputs("cd ", out);
        put_quoted(out, folder ? folder : ".");
        fclose(out);
        free(folder);
    }
    char *argv[] = {(char *)"gnuplot", (char *)"-e", place, script, NULL};
    char *svg = place && script ? tool_read(&gnuplot, argv, report->console) : NULL;
    free(script);
    free(place);
    return svg;
}

static bool draw(const struct report *report, const char *name, FILE *out, char *const *script)
{
    bool good = out && fclose(out) == 0;
    if (!good)
        report_error(&report->console->log, "out of memory");
    good = good && write_text(report, name, ".gp", *script);
    char *svg = good ? run_gnuplot(report, name) : NULL;
    char *start = svg ? strstr(svg, "<svg") : NULL, *body = start ? strchr(start, '>') : NULL;
    char *styled = NULL;
    if (body)
        styled = format_string("%.*s\n%s%s", (int)(body + 1 - svg), svg, svg_style, body + 1);
    if (svg && !body)
        report_error(&report->console->log, "gnuplot has not drawn %s.gp", name);
    good = styled && write_text(report, name, ".svg", styled);
    free(styled);
    free(svg);
    return good;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static void put_field(FILE *out, double value)
{
    if (isnan(value))
        fputc(',', out);
    else
        fprintf(out, ",%.6g", value);
}

/* One row per scene, picture and value; the rows of a line of the plots follow one another. */
static void put_errors(FILE *out, struct report *report)
{
    static const char *const paths[] = {"hdr.relative_mse", "ldr.flip.mean"};
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    char buffer[32];
    int count = cJSON_GetArraySize(sweep_values(report));
    fprintf(out, "scene,picture,%s,relative_mse,flip,own_relative_mse,own_flip\n",
            report_text(cJSON_GetObjectItem(report->outline, "sweep"), "parameter"));
    for (uint32_t s = 0; s < report->scene_count; s++) {
        const struct report_scene *scene = &report->scenes[s];
        cJSON_ArrayForEach(picture, pictures) for (int i = 0; i < count && scene->mesh; i++)
        {
            char *file = report_error_file(report, scene, picture, i, ".json");
            char *own = report_error_file(report, scene, picture, i, "_own.json");
            fprintf(out, "%s,%s,\"%s\"", scene->name, report_text(picture, "name"),
                    report_item(sweep_values(report), i, buffer));
            for (int p = 0; p < 4 && file && own; p++)
                put_field(out, report_number(report, p < 2 ? file : own, paths[p % 2]));
            fputc('\n', out);
            free(own);
            free(file);
        }
    }
}

static void put_times(FILE *out, struct report *report)
{
    char buffer[32];
    int count = cJSON_GetArraySize(sweep_values(report));
    fprintf(out, "scene,side,%s,frame_ms,p5,p95\n",
            report_text(cJSON_GetObjectItem(report->outline, "sweep"), "parameter"));
    for (uint32_t s = 0; s < report->scene_count; s++) {
        const struct report_scene *scene = &report->scenes[s];
        for (uint32_t side = 0; side < report->sides.count && scene->mesh; side++) {
            for (int i = 0; i < count; i++) {
                char *file = report_sweep_file(report, scene, i, "_bench.json");
                fprintf(out, "%s,%s,\"%s\"", scene->name, report->sides.list[side].label,
                        report_item(sweep_values(report), i, buffer));
                put_field(out, report_frame_ms(report, file ? file : "", side, "median"));
                put_field(out, report_frame_ms(report, file ? file : "", side, "p5"));
                put_field(out, report_frame_ms(report, file ? file : "", side, "p95"));
                fputc('\n', out);
                free(file);
            }
        }
    }
}

static bool write_numbers(struct report *report, const char *name,
                          void (*put)(FILE *, struct report *))
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out)
        put(out, report);
    bool good = out && fclose(out) == 0 && write_text(report, name, ".csv", text);
    free(text);
    return good;
}

/* ---- Plots ----------------------------------------------------------------------------------- */

/* A plot that nothing can be drawn in, since steps have failed, is not there. */
static bool remove_plot(const struct report *report, const char *name)
{
    char *path = format_string("%s/plots/%s.svg", report->folder, name);
    bool good = path && (unlink(path) == 0 || errno == ENOENT);
    if (!good)
        report_error(&report->console->log, "plots/%s.svg: cannot be removed", name);
    free(path);
    return good;
}

/* One of the plots of errors. */
struct error_plot {
    const char *name, *label;
    const char *ending, *path; /* of the results, and in them */
    int column;                /* of errors.csv */
    int points;                /* values of the sweep, from the first on */
};

/* Takes in the errors of a picture; false when there is none that the axis can show. */
static bool find_errors(struct report *report, const struct report_scene *scene,
                        const cJSON *picture, const struct error_plot *plot, struct range *range)
{
    struct range own = {0};
    for (int i = 0; i < plot->points && scene->mesh; i++) {
        char *file = report_error_file(report, scene, picture, i, plot->ending);
        take_in(&own, report_number(report, file ? file : "", plot->path));
        free(file);
    }
    take_in(range, own.low);
    take_in(range, own.high);
    return own.high > 0;
}

/* A line for each picture of each scene: colours tell scenes apart, dashes all pictures but the last. */
static void put_error_lines(FILE *out, struct report *report, const struct error_plot *plot)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    struct range unused = {0};
    int lines = 0, rows = 1, colour = 0; /* the head is a row */
    fprintf(out, "set xrange [0:%d]\nplot", plot->points - 1);
    for (uint32_t i = 0; i < report->scene_count; i++) {
        const struct report_scene *scene = &report->scenes[i];
        int dash = cJSON_GetArraySize(pictures);
        colour += scene->mesh != NULL;
        cJSON_ArrayForEach(picture, pictures)
        {
            if (find_errors(report, scene, picture, plot, &unused)) {
                char *title = format_string("%s, %s", scene->name, report_text(picture, "title"));
                fprintf(out,
                        "%s 'errors.csv' skip %d every ::0::%d using 0:%d with linespoints lt %d "
                        "dt %d title ",
                        lines++ ? "," : "", rows, plot->points - 1, plot->column, colour, dash);
                put_quoted(out, title ? title : "");
                free(title);
            }
            dash--;
            rows += scene->mesh ? cJSON_GetArraySize(sweep_values(report)) : 0;
        }
    }
    fputs("\n", out);
}

static bool draw_errors(struct report *report, const struct error_plot *plot)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    char *script = NULL;
    size_t size = 0;
    struct range range = {0};
    for (uint32_t i = 0; i < report->scene_count; i++)
        cJSON_ArrayForEach(picture, pictures)
            find_errors(report, &report->scenes[i], picture, plot, &range);
    if (!(range.high > 0))
        return remove_plot(report, plot->name);
    FILE *out = open_memstream(&script, &size);
    if (out) {
        put_axes(out, report, plot->label, &range);
        put_error_lines(out, report, plot);
    }
    bool good = draw(report, plot->name, out, &script);
    free(script);
    return good;
}

/* Against the reference, and against the same picture at the last value, which has no error of its own. */
static bool draw_all_errors(struct report *report)
{
    int count = cJSON_GetArraySize(sweep_values(report));
    const struct error_plot plots[] = {
        {"errors", "relative MSE against the reference", ".json", "hdr.relative_mse", 4, count},
        {"flip", "FLIP against the reference", ".json", "ldr.flip.mean", 5, count},
        {"own_errors", "relative MSE against the last value", "_own.json", "hdr.relative_mse", 6,
         count - 1},
    };
    bool good = true;
    for (size_t i = 0; i < DT_ARRAY_COUNT(plots) && good; i++)
        good = draw_errors(report, &plots[i]);
    return good;
}

static const cJSON *published_total(const struct report *report, const struct report_scene *scene)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    return strcmp(report_text(published, "scene"), scene->name) == 0
               ? cJSON_GetObjectItem(published, "total")
               : NULL;
}

static void put_published(FILE *out, const cJSON *total)
{
    const cJSON *item;
    int i = 0;
    fputs("$published << END\n", out);
    cJSON_ArrayForEach(item, total) fprintf(out, "%d,%g\n", i++, item->valuedouble);
    fputs("END\n", out);
}

/* Takes in the times of a scene and what was published of it; false when there is no time. */
static bool find_times(struct report *report, const struct report_scene *scene, struct range *range)
{
    static const char *const parts[] = {"median", "p5", "p95"};
    const cJSON *item;
    for (int i = 0; i < cJSON_GetArraySize(sweep_values(report)); i++) {
        char *file = report_sweep_file(report, scene, i, "_bench.json");
        for (uint32_t j = 0; j < report->sides.count * DT_ARRAY_COUNT(parts) && file; j++)
            take_in(range, report_frame_ms(report, file, j / DT_ARRAY_COUNT(parts),
                                           parts[j % DT_ARRAY_COUNT(parts)]));
        free(file);
    }
    bool any = range->high > 0;
    cJSON_ArrayForEach(item, published_total(report, scene)) take_in(range, item->valuedouble);
    return any;
}

/* A line for each backend, from the 5th to the 95th percentile around the median. `first`: the scene's
 * place among those that are here. */
static void put_time_lines(FILE *out, const struct report *report, uint32_t first)
{
    unsigned count = (unsigned)cJSON_GetArraySize(sweep_values(report));
    fprintf(out, "set xrange [0:%u]\nplot", count - 1);
    for (uint32_t side = 0; side < report->sides.count; side++) {
        unsigned skip = 1 + (first * report->sides.count + side) * count;
        fprintf(out,
                "%s 'times.csv' skip %u every ::0::%u using 0:4:5:6 with yerrorbars lt %u "
                "notitle, '' skip %u every ::0::%u using 0:4 with linespoints lt %u title ",
                side ? "," : "", skip, count - 1, side + 1, skip, count - 1, side + 1);
        put_quoted(out, report->sides.list[side].label);
    }
}

static void put_published_line(FILE *out, const struct report *report)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    fputs(", $published using 1:2 with linespoints lt 6 dt 2 title ", out);
    char *title = format_string("%s (other hardware)", report_text(published, "by"));
    put_quoted(out, title ? title : "");
    free(title);
}

static bool draw_times(struct report *report, const struct report_scene *scene, uint32_t first)
{
    char *script = NULL, *name = format_string("times_%s", scene->name);
    size_t size = 0;
    struct range range = {0};
    const cJSON *total = published_total(report, scene);
    bool any = name && find_times(report, scene, &range), good = name;
    FILE *out = any ? open_memstream(&script, &size) : NULL;
    if (out) {
        put_axes(out, report, "milliseconds per frame", &range);
        put_published(out, total);
        put_time_lines(out, report, first);
        if (total)
            put_published_line(out, report);
        fputs("\n", out);
    }
    good = any ? draw(report, name, out, &script) : good && remove_plot(report, name);
    free(script);
    free(name);
    return good;
}

/* A row per step from frame to frame, in per cent: the reference's change, then change and flicker of each
 * run. False when nothing was measured. */
static bool put_changes(FILE *out, struct report *report, const struct report_scene *scene,
                        const cJSON *motion, const cJSON *runs)
{
    const cJSON *run,
        *frames = cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "motion"), "frames");
    bool any = false;
    fputs("frame,reference", out);
    cJSON_ArrayForEach(run, runs)
        fprintf(out, ",%s,%s_flicker", report_text(run, "name"), report_text(run, "name"));
    fputc('\n', out);
    for (int step = 0; step + 1 < frames->valueint; step++) {
        double truth = NAN;
        fprintf(out, "%d", step + 1);
        for (int pass = 0; pass < 2; pass++) { /* any run that there is tells of the reference */
            cJSON_ArrayForEach(run, runs)
            {
                char *file = report_motion_file(scene, motion, report_text(run, "name"), ".json");
                double change =
                    report_frame_change(report, file ? file : "", step, "relative_change");
                double flicker =
                    report_frame_change(report, file ? file : "", step, "relative_flicker");
                double its = report_frame_change(report, file ? file : "", step,
                                                 "relative_change_reference");
                free(file);
                truth = isnan(truth) ? its : truth;
                any = any || !isnan(change);
                if (pass == 1) {
                    put_field(out, 100 * change);
                    put_field(out, 100 * flicker);
                }
            }
            if (pass == 0)
                put_field(out, 100 * truth);
        }
        fputc('\n', out);
    }
    return any;
}

int report_change_plot_height(const struct report *report)
{
    const cJSON *runs = cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "motion"), "runs");
    return REPORT_PLOT_HEIGHT - 20 + 17 * cJSON_GetArraySize(runs);
}

/* One line per run; `first` is the column of the first, and the reference's has a line where wanted. */
static bool draw_motion(struct report *report, const char *name, const char *csv, const char *label,
                        const cJSON *runs, int first, bool reference)
{
    const cJSON *run;
    char *script = NULL;
    size_t size = 0;
    int column = first;
    FILE *out = open_memstream(&script, &size);
    if (out) {
        put_head(out, report_change_plot_height(report));
        fputs("unset logscale y\nset yrange [0:*]\nset xlabel 'frame'\nset ylabel ", out);
        put_quoted(out, label);
        fputs("\nset key above vertical maxrows 99\nplot", out);
        cJSON_ArrayForEach(run, runs)
        {
            fputs(column > first ? ", " : " ", out);
            put_quoted(out, csv);
            fprintf(out, " skip 1 using 1:%d with linespoints lt %d title ", column,
                    (column - first) / 2 % 5 + 1);
            put_quoted(out, report_text(run, "title"));
            column += 2;
        }
        if (reference) {
            fputs(", ", out);
            put_quoted(out, csv);
            fputs(" skip 1 using 1:2 with linespoints lt 6 dt 2 title 'the reference'", out);
        }
        fputs("\n", out);
    }
    bool good = draw(report, name, out, &script);
    free(script);
    return good;
}

/* Two plots of one motion, and the numbers behind both. */
static bool draw_changes(struct report *report, const struct report_scene *scene,
                         const cJSON *motion)
{
    const cJSON *runs = cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "motion"), "runs");
    char *name = format_string("change_%s_%s", scene->name, report_text(motion, "name"));
    char *other = format_string("flicker_%s_%s", scene->name, report_text(motion, "name"));
    char *csv = name ? format_string("%s.csv", name) : NULL, *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    bool any = out && put_changes(out, report, scene, motion, runs);
    bool good = out && fclose(out) == 0 && csv && other && write_text(report, name, ".csv", text);
    if (good && any)
        good = draw_motion(report, name, csv, "change per frame, %", runs, 3, true) &&
               draw_motion(report, other, csv, "flicker per frame, %", runs, 4, false);
    else
        good = good && remove_plot(report, name) && remove_plot(report, other);
    free(text);
    free(csv);
    free(other);
    free(name);
    return good;
}

static bool draw_motions(struct report *report, const struct report_scene *scene)
{
    const cJSON *motion = NULL;
    bool good = true;
    while (good && scene->mesh && (motion = report_next_motion(report, scene, motion)))
        good = draw_changes(report, scene, motion);
    return good;
}

bool report_draw_plots(struct report *report)
{
    char *folder = format_string("%s/plots", report->folder);
    bool good = folder && file_make_folders(folder, &report->console->log) &&
                write_numbers(report, "errors", put_errors) &&
                write_numbers(report, "times", put_times);
    free(folder);
    console_status(report->console, "drawing plots");
    good = good && draw_all_errors(report);
    for (uint32_t i = 0; i < report->scene_count && good; i++)
        good = draw_motions(report, &report->scenes[i]);
    for (uint32_t i = 0, here = 0; i < report->scene_count && good; i++) {
        if (report->scenes[i].mesh)
            good = draw_times(report, &report->scenes[i], here++);
    }
    console_status(report->console, "%s", "");
    return good;
}
