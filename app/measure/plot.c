/* Plots; see plot.h. */
#include "measure/plot.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "console/tool.h"

/* Makes gnuplot's SVG follow a dark page: black becomes the text colour, white around points is
 * removed. The colours of the lines are visible on both. */
static const char svg_style[] =
    "<style>[color=\"white\"]{display:none}text{fill:#24292f}[stroke=\"black\"]{stroke:#57606a}"
    "@media(prefers-color-scheme:dark){text{fill:#d6dce3}[stroke=\"black\"]{stroke:#9aa4ae}}"
    "</style>\n";

static const char gnuplot_head[] = "set linetype 1 lc rgb '#2f80d0' lw 2 pt 7 ps 0.6\n"
                                   "set linetype 2 lc rgb '#d9771a' lw 2 pt 5 ps 0.6\n"
                                   "set linetype 3 lc rgb '#2c9c6c' lw 2 pt 9 ps 0.7\n"
                                   "set linetype 4 lc rgb '#a963c9' lw 2 pt 11 ps 0.7\n"
                                   "set linetype 5 lc rgb '#d34a4a' lw 2 pt 13 ps 0.7\n"
                                   "set linetype 6 lc rgb '#8a8f98' lw 2 pt 3 ps 0.6\n"
                                   "set border 3\n"
                                   "set tics nomirror\n"
                                   "set mytics 1\n"
                                   "set grid ytics lc rgb '#9099a4' lw 0.4\n";

static const struct tool gnuplot = {.what = "gnuplot", .hint = "install the package gnuplot-nox"};

bool plot_has_gnuplot(struct console *console)
{
    char *argv[] = {(char *)"gnuplot", (char *)"--version", NULL};
    return tool_run(&gnuplot, argv, -1, console);
}

/* ---- The x axis ------------------------------------------------------------------------------ */

static bool parse_coordinate(const char *text, double *value)
{
    char *end = NULL;
    *value = strtod(text, &end);
    return end > text && !*end && isfinite(*value);
}

static bool all_numbers(const struct plot *plot)
{
    double value;
    bool all = plot->value_count > 0;
    for (uint32_t i = 0; i < plot->value_count; i++)
        all = all && parse_coordinate(plot->values[i], &value);
    return all;
}

static bool is_logarithmic(const struct plot *plot)
{
    double value, low = INFINITY, high = 0;
    for (uint32_t i = 0; i < plot->value_count; i++) {
        if (!parse_coordinate(plot->values[i], &value) || !(value > 0))
            return false;
        low = fmin(low, value);
        high = fmax(high, value);
    }
    return high >= 4 * low;
}

double plot_x(const struct plot *plot, uint32_t index)
{
    double value = index;
    if (all_numbers(plot))
        parse_coordinate(plot->values[index], &value);
    return value;
}

/* Between single quotes, as gnuplot reads them. */
static void put_quoted(FILE *out, const char *text)
{
    fputc('\'', out);
    for (; *text; text++)
        fputs(*text == '\'' ? "''" : (char[2]){*text}, out);
    fputc('\'', out);
}

static void put_values(FILE *out, const struct plot *plot)
{
    double low = INFINITY, high = -INFINITY;
    bool log = is_logarithmic(plot);
    fputs("set xtics (", out);
    for (uint32_t i = 0; i < plot->value_count; i++) {
        double x = plot_x(plot, i);
        low = fmin(low, x);
        high = fmax(high, x);
        fputs(i ? ", " : "", out);
        put_quoted(out, plot->values[i]);
        fprintf(out, " %.9g", x);
    }
    double room = log ? pow(high / low, 0.06) : high > low ? 0.06 * (high - low) : 0.5;
    fprintf(out, ")\n%sset xrange [%.9g:%.9g]\n", log ? "set logscale x\n" : "",
            log ? low / room : low - room, log ? high * room : high + room);
}

/* ---- Lines ----------------------------------------------------------------------------------- */

bool plot_begin(struct plot *plot, const struct dt_log *log)
{
    plot->data = open_memstream(&plot->data_text, &plot->data_size);
    plot->lines = open_memstream(&plot->lines_text, &plot->lines_size);
    if (!plot->data || !plot->lines)
        report_error(log, "out of memory");
    return plot->data && plot->lines;
}

static void end_line(struct plot *plot)
{
    if (plot->line_count)
        fputs("END\n", plot->data);
}

void plot_line(struct plot *plot, const char *title, uint32_t colour, uint32_t dash, bool bars)
{
    end_line(plot);
    uint32_t number = ++plot->line_count;
    fprintf(plot->data, "$line%u << END\n", number);
    fputs(number > 1 ? ", \\\n    " : "plot ", plot->lines);
    if (bars)
        fprintf(plot->lines, "$line%u using 1:2:3:4 with yerrorbars lt %u notitle, ", number,
                colour);
    fprintf(plot->lines, "$line%u using 1:2 with linespoints lt %u dt %u lw w%u ps 0.25*w%u title ",
            number, colour, dash, number, number);
    put_quoted(plot->lines, title);
}

/* The axis is as long as what is on it. */
static void take_in(struct plot *plot, double value)
{
    if (!(value > 0))
        return;
    plot->low = plot->low > 0 ? fmin(plot->low, value) : value;
    plot->high = fmax(plot->high, value);
}

static void put_number(FILE *out, double value)
{
    if (isfinite(value))
        fprintf(out, " %.9g", value);
    else
        fputs(" NaN", out);
}

void plot_point(struct plot *plot, double x, double y, double low, double high)
{
    fprintf(plot->data, "%.9g", x);
    put_number(plot->data, y);
    put_number(plot->data, low);
    put_number(plot->data, high);
    fputc('\n', plot->data);
    if (isnan(y) || (!plot->from_zero && !(y > 0)))
        return;
    plot->point_count++;
    take_in(plot, y);
    take_in(plot, low);
    take_in(plot, high);
}

int plot_height(int lines)
{
    return PLOT_HEIGHT - 20 + 17 * lines;
}

bool plot_is_empty(const struct plot *plot)
{
    return plot->point_count == 0;
}

/* ---- Drawing --------------------------------------------------------------------------------- */

/* Range that holds all values, at least a factor of 2.5, with ticks at round numbers. */
static void put_range(FILE *out, const struct plot *plot)
{
    static const double room = 1.6, round[] = {1, 2, 5, 1.5, 3, 7};
    double noise = plot->noise > 0 ? plot->noise : plot->high;
    double low = fmin(plot->low, noise) / room, high = fmax(plot->high, noise) * room;
    int count = high < 10 * low ? DT_ARRAY_COUNT(round) : high < 1000 * low ? 3 : 1;
    const char *separator = "";
    fprintf(out, "set logscale y\nset yrange [%g:%g]\nset ytics (", low, high);
    for (int decade = (int)floor(log10(low)); pow(10, decade) < high; decade++) {
        for (int i = 0; i < count; i++) {
            double tick = round[i] * pow(10, decade);
            fprintf(out, "%s\"%g\" %g", separator, tick, tick);
            separator = ", ";
        }
    }
    fputs(")\n", out);
}

/* A key of more than four lines stands above the plot, which it must not eat up. */
static bool has_tall_key(const struct plot *plot)
{
    return !plot->beside && plot->line_count > 4;
}

static int height_of(const struct plot *plot)
{
    int height = has_tall_key(plot) ? plot_height((int)plot->line_count) : PLOT_HEIGHT;
    return plot->height ? plot->height : height;
}

/* Each line is thinner than the ones before, which are seen on both sides of it where they coincide. */
static void put_widths(FILE *out, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        fprintf(out, "w%u = %g\n", i + 1,
                1.5 + 3.0 * (count - 1 - i) / (count > 1 ? count - 1 : 1));
}

static void put_noise(FILE *out, const struct plot *plot)
{
    if (plot->noise <= 0)
        return;
    fputs("set object 1 rectangle from graph 0, ", out);
    if (plot->noise_is_ratio)
        fprintf(out, "first %g", 1 / plot->noise);
    else
        fputs("graph 0", out);
    fprintf(out,
            " to graph 1, first %g behind fillcolor rgb '#808080' fillstyle transparent solid 0.2 "
            "noborder\n",
            plot->noise);
}

static void put_script(FILE *out, const struct plot *plot)
{
    fputs("# gnuplot, anywhere: the SVG comes on standard output.\n", out);
    fprintf(out,
            "set terminal svg size %d,%d font 'DejaVu Sans,Verdana,sans-serif,13' noenhanced\n",
            plot->beside ? 2 * PLOT_WIDTH : PLOT_WIDTH, height_of(plot));
    fputs(gnuplot_head, out);
    fputs("set xlabel ", out);
    put_quoted(out, plot->x_label);
    fputs("\nset ylabel ", out);
    put_quoted(out, plot->y_label);
    fprintf(out, "\nset key %s\n",
            plot->beside         ? "outside right top vertical Left reverse"
            : has_tall_key(plot) ? "above vertical maxrows 99"
                                 : "above");
    if (plot->value_count)
        put_values(out, plot);
    if (plot->from_zero)
        fputs("set yrange [0:*]\n", out);
    else
        put_range(out, plot);
    put_noise(out, plot);
    put_widths(out, plot->line_count);
    fprintf(out, "%s%s\n", plot->data_text, plot->lines_text);
}

static bool write_script(const struct plot *plot, const char *path, const struct dt_log *log)
{
    struct file_draft draft;
    if (file_draft_begin(&draft, log))
        put_script(draft.out, plot);
    return file_draft_end(&draft, path, log);
}

/* A plot without points is removed. */
static bool remove_plot(const char *folder, const char *name, const struct dt_log *log)
{
    char *path = format_string("%s/%s.svg", folder, name);
    bool good = path && (unlink(path) == 0 || errno == ENOENT);
    if (!good)
        report_error(log, "%s/%s.svg: cannot be removed", folder, name);
    free(path);
    return good;
}

/* Puts the style behind the first tag. */
static bool write_svg(const char *svg, const char *folder, const char *name,
                      const struct dt_log *log)
{
    const char *start = strstr(svg, "<svg"), *body = start ? strchr(start, '>') : NULL;
    if (!body) {
        report_error(log, "gnuplot has not drawn %s/%s.gp", folder, name);
        return false;
    }
    char *path = format_string("%s/%s.svg", folder, name);
    struct file_draft draft;
    if (file_draft_begin(&draft, log))
        fprintf(draft.out, "%.*s\n%s%s", (int)(body + 1 - svg), svg, svg_style, body + 1);
    bool good = file_draft_end(&draft, path, log);
    free(path);
    return good;
}

bool plot_draw(struct plot *plot, struct console *console, const char *folder, const char *name)
{
    const struct dt_log *log = &console->log;
    char *script = format_string("%s/%s.gp", folder, name);
    end_line(plot);
    bool good = fflush(plot->data) == 0 && fflush(plot->lines) == 0;
    if (good && plot_is_empty(plot)) {
        free(script);
        return remove_plot(folder, name, log);
    }
    if (!good)
        report_error(log, "out of memory");
    char *argv[] = {(char *)"gnuplot", script, NULL};
    char *svg = good && write_script(plot, script, log) ? tool_read(&gnuplot, argv, console) : NULL;
    good = svg && write_svg(svg, folder, name, log);
    free(svg);
    free(script);
    return good;
}

void plot_free(struct plot *plot)
{
    if (plot->data)
        fclose(plot->data);
    if (plot->lines)
        fclose(plot->lines);
    free(plot->data_text);
    free(plot->lines_text);
    plot->data = plot->lines = NULL;
    plot->data_text = plot->lines_text = NULL;
}
