/* The page of a report: HTML that needs nothing but the files beside it. Called by report.c. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "measure/plot.h"
#include "report/report.h"

static const char page_head[] =
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<style>\n"
    ":root{color-scheme:light dark;--ink:#1f2328;--dim:#57606a;--line:#d0d7de;--page:#fff;"
    "--soft:#f4f6f8;--link:#0a58b8}\n"
    "@media(prefers-color-scheme:dark){:root{--ink:#e3e8ee;--dim:#9aa6b2;--line:#3a424c;"
    "--page:#14181d;--soft:#1c2229;--link:#7ab7ff}}\n"
    "*{box-sizing:border-box}\n"
    "body{margin:0 auto;max-width:84rem;padding:1.5rem 1.25rem 4rem;background:var(--page);"
    "color:var(--ink);font:1rem/1.5 system-ui,'DejaVu Sans',sans-serif}\n"
    "h1{font-size:1.75rem;line-height:1.2;margin:.5rem 0}"
    "h2{font-size:1.3rem;margin:3rem 0 .5rem;padding-top:.75rem;border-top:1px solid var(--line)}"
    "h2 small{font-size:.875rem;font-weight:400;margin-left:.75rem}"
    "h3{font-size:1.05rem;margin:1.75rem 0 .5rem}\n"
    "p,li{max-width:46rem}a{color:var(--link)}small,figcaption,.dim{color:var(--dim)}\n"
    "dl{display:grid;grid-template-columns:max-content 1fr;gap:.15rem 1rem;margin:1rem 0}"
    "dt{color:var(--dim)}dd{margin:0;overflow-wrap:anywhere}\n"
    ".strip,.plots{display:grid;gap:1rem}"
    "@media(min-width:34rem){.strip{grid-template-columns:repeat(2,1fr)}}"
    "@media(min-width:62rem){.strip{grid-template-columns:repeat(4,1fr)}}"
    ".plots{grid-template-columns:repeat(auto-fit,minmax(min(100%,22rem),30rem))}\n"
    "figure{margin:0}figure img{display:block;width:100%;height:auto;background:var(--soft)}"
    ".plots img{background:none}figcaption{font-size:.875rem;line-height:1.4;margin-top:.4rem}"
    "figcaption b{color:var(--ink);display:block}\n"
    ".scroll{overflow-x:auto;margin:1rem 0}"
    "table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}"
    "caption{text-align:left;font-weight:600;padding:.3rem 0}"
    "th,td{padding:.25rem .7rem;text-align:right;border-bottom:1px solid var(--line)}"
    "thead th{color:var(--dim);font-weight:600;vertical-align:bottom}"
    "th:first-child,th.word,td.word{text-align:left}tbody th{font-weight:600;vertical-align:top}"
    ".tables{display:grid;gap:0 3rem;grid-template-columns:"
    "repeat(auto-fit,minmax(min(100%,26rem),max-content))}"
    "th small,caption small{display:block;font-weight:400}tr.published td{background:var(--soft);"
    "color:var(--dim)}\n"
    "ul.scale{display:flex;list-style:none;padding:0;margin:.5rem 0;max-width:24rem;"
    "font-size:.875rem}"
    ".bar{flex:1;margin:0 .6rem;border-radius:3px;background:linear-gradient(90deg,#000004,"
    "#1c1044,#4f127b,#812581,#b5367a,#e55064,#fb8761,#fec287,#fcfdbf)}\n"
    "pre{background:var(--soft);padding:.75rem;overflow-x:auto;font-size:.8rem;line-height:1.45}"
    "pre.commands{white-space:pre-wrap;overflow-wrap:anywhere}"
    "summary{cursor:pointer;padding:.3rem 0}\n"
    "@media(max-width:34rem){body{padding:1rem .75rem}table{font-size:.8rem}"
    "th,td{padding:.25rem .3rem}}\n"
    "</style>\n";

/* ---- Head ------------------------------------------------------------------------------------ */

static void put_term(FILE *out, const char *name, const char *text)
{
    fprintf(out, "<dt>%s</dt><dd>", name);
    report_put_text(out, text);
    fputs("</dd>\n", out);
}

/* Of the first run that any backend has told its device in. */
static const char *find_device(struct report *report, uint32_t side)
{
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        for (int v = 0; v < report_value_count(report) && report->steps.scenes[i].mesh; v++) {
            char *file = grid_bench_file(
                report_point(report, &report->steps.scenes[i], report_last_picture(report), v));
            const cJSON *sides =
                cJSON_GetObjectItem(steps_result(&report->steps, file ? file : ""), "sides");
            free(file);
            if (cJSON_GetArraySize(sides) > (int)side)
                return step_text(cJSON_GetArrayItem(sides, (int)side), "device");
        }
    }
    return "not known: no run of bench succeeded";
}

static void put_devices(FILE *out, struct report *report)
{
    for (uint32_t side = 0; side < report->steps.sides.count; side++) {
        fputs("<dt>Device of ", out);
        report_put_text(out, report->steps.sides.list[side].label);
        fputs("</dt><dd>", out);
        report_put_text(out, find_device(report, side));
        fputs("</dd>\n", out);
    }
}

/* As Linux names it; drivers that have no GPU work with it. */
static void put_processor(FILE *out)
{
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256], *name = NULL;
    while (file && !name && fgets(line, sizeof line, file)) {
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':'))
            name = strchr(line, ':') + 1;
    }
    if (file)
        fclose(file);
    if (!name)
        return;
    line[strcspn(line, "\n")] = 0;
    fputs("<dt>Processor</dt><dd>", out);
    report_put_text(out, name + strspn(name, " "));
    fprintf(out, ", %ld at work</dd>\n", sysconf(_SC_NPROCESSORS_ONLN));
}

static void put_settings(FILE *out, const struct report *report)
{
    const struct options *options = report->steps.options;
    fputs("<dt>Overrides</dt><dd>", out);
    for (uint32_t i = 0; i < options->set_count; i++) {
        fputs(i ? ", <code>" : "<code>", out);
        report_put_text(out, options->sets[i]);
        fputs("</code>", out);
    }
    fputs(options->set_count ? "</dd>\n" : "none, the spec as it is</dd>\n", out);
}

static void put_left_out(FILE *out, const struct report *report)
{
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (report->steps.scenes[i].mesh)
            continue;
        fputs("<dt>Left out</dt><dd>", out);
        report_put_text(out, report->steps.scenes[i].name);
        fputs(": its mesh is not here. The scene file tells where it can be had; "
              "<code>--scenes DIR</code> names the folder that holds it.</dd>\n",
              out);
    }
}

/* What the page lacks, and the first reason. */
static void put_failures(FILE *out, const struct report *report)
{
    const struct steps *steps = &report->steps;
    uint32_t failures = 0;
    char *reason = NULL;
    for (uint32_t i = 0; i < steps->count; i++) {
        if (steps_is_done(steps, &steps->list[i]))
            continue;
        reason = reason ? reason : steps_reason(steps, steps->list[i].file);
        failures++;
    }
    if (failures) {
        fprintf(out, "<dt>Missing</dt><dd>%u of %u results, shown by a dash: ", failures,
                steps->count);
        report_put_text(out, reason ? reason : "");
        fputs("</dd>\n", out);
    }
    free(reason);
}

static const char *page_title(const struct report *report)
{
    const char *title = step_text(report->outline, "title"),
               *slash = strrchr(report->steps.spec, '/');
    return *title ? title : slash + 1;
}

/* What is on the page, for whoever has only the page. */
static void put_contents(FILE *out, const struct report *report)
{
    fputs("<p>What the pipeline draws, held against path tracing of the same scenes, and how long "
          "it takes: <a href=\"#pictures\">pictures beside their reference</a>, <a "
          "href=\"#errors\">errors</a> and <a href=\"#times\">times against ",
          out);
    report_put_text(out, report_parameter(report));
    fputs("</a>", out);
    if (cJSON_HasObjectItem(report->outline, "motion"))
        fputs(", <a href=\"#motions\">temporal coherence</a>", out);
    fputs(", and <a href=\"#making\">how it was made</a>, command by command.</p>\n", out);
}

static void put_introduction(FILE *out, struct report *report)
{
    const struct options *options = report->steps.options;
    const char *source = step_text(report->outline, "source");
    fputs("<h1>", out);
    report_put_text(out, page_title(report));
    fputs("</h1>\n<p class=\"dim\">", out);
    report_put_text(out, source);
    fputs("</p>\n<dl>\n", out);
    put_term(out, "Spec", report->steps.spec);
    put_settings(out, report);
    fprintf(out, "<dt>Frame</dt><dd>%u &times; %u pixels</dd>\n", options->size[0],
            options->size[1]);
    put_devices(out, report);
    put_processor(out);
    put_left_out(out, report);
    put_failures(out, report);
    fputs("</dl>\n", out);
    put_contents(out, report);
}

/* What was published is told where its scene is in the report. */
static const cJSON *find_published(const struct report *report)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (report->steps.scenes[i].mesh &&
            strcmp(report->steps.scenes[i].name, step_text(published, "scene")) == 0)
            return published;
    }
    return NULL;
}

/* Of a section, with where the same was published. */
static void put_heading(FILE *out, const struct report *report, const char *id, const char *title,
                        const char *behind)
{
    const cJSON *published = find_published(report);
    const char *figures = step_text(cJSON_GetObjectItem(published, "figures"), id);
    fprintf(out, "<h2 id=\"%s\">%s", id, title);
    report_put_text(out, behind);
    if (*figures) {
        fputs("<small>", out);
        report_put_text(out, step_text(published, "by"));
        fputs(": ", out);
        report_put_text(out, figures);
        fputs("</small>", out);
    }
    fputs("</h2>\n", out);
}

/* ---- Pictures -------------------------------------------------------------------------------- */

/* `name` without an ending. */
static void put_image(FILE *out, const struct step_scene *scene, const char *name,
                      const char *title, const struct report *report)
{
    fputs("<img src=\"", out);
    report_put_link(out, scene->name);
    fputc('/', out);
    report_put_link(out, name);
    fprintf(out, ".png\" width=\"%u\" height=\"%u\" loading=\"lazy\" alt=\"",
            report->steps.options->size[0], report->steps.options->size[1]);
    report_put_text(out, scene->name);
    fputs(", ", out);
    report_put_text(out, title);
    fputs("\">", out);
}

static void put_picture(FILE *out, struct report *report, const struct step_scene *scene,
                        const cJSON *picture)
{
    const char *title = step_text(picture, "title");
    char *file = report_file(scene, step_text(picture, "name"), ".json");
    char *name = format_string("%s/test", step_text(picture, "name"));
    fputs("<figure>", out);
    if (file && name && steps_result(&report->steps, file)) {
        put_image(out, scene, name, title, report);
        fputs("<figcaption><b>", out);
        report_put_text(out, title);
        fputs("</b>relative MSE ", out);
        report_put_result(out, report, file, "hdr.relative_mse");
        fputs(", FLIP ", out);
        report_put_result(out, report, file, "ldr.flip.mean");
        fputs(", mean ", out);
        report_put_number(out, steps_number(&report->steps, file, "hdr.mean_test") /
                                   steps_number(&report->steps, file, "hdr.mean_reference"));
        fputs(" of the reference&rsquo;s</figcaption>", out);
    } else {
        fputs("<figcaption><b>", out);
        report_put_text(out, title);
        char *reason = file ? steps_reason(&report->steps, file) : NULL;
        fputs("</b>could not be made: ", out);
        report_put_text(out, reason ? reason : "");
        fputs("</figcaption>", out);
        free(reason);
    }
    fputs("</figure>\n", out);
    free(name);
    free(file);
}

static void put_reference(FILE *out, struct report *report, const struct step_scene *scene,
                          const char *name)
{
    const char *title = step_text(cJSON_GetObjectItem(report->outline, "reference"), "title");
    char *file = report_file(scene, "reference", ".json");
    char *picture = format_string("%s/reference", name);
    title = *title ? title : "Reference";
    fputs("<figure>", out);
    put_image(out, scene, picture ? picture : "", title, report);
    fputs("<figcaption><b>", out);
    report_put_text(out, title);
    fputs("</b>path-traced, ", out);
    report_put_result(out, report, file ? file : "", "samples");
    fputs(" samples per pixel; a pixel&rsquo;s standard error is ", out);
    report_put_number(out, 100 * steps_number(&report->steps, file ? file : "", "noise"));
    fputs("&nbsp;% of the mean</figcaption></figure>\n", out);
    free(picture);
    free(file);
}

static void put_map(FILE *out, struct report *report, const struct step_scene *scene,
                    const cJSON *picture)
{
    const char *name = step_text(picture, "name");
    char *file = report_file(scene, name, ".json");
    char *map = format_string("%s/flip_ldr", name);
    fputs("<figure>", out);
    put_image(out, scene, map ? map : "", "FLIP map", report);
    fputs("<figcaption><b>FLIP: ", out);
    report_put_text(out, step_text(picture, "title"));
    fputs("</b>bright where it differs from the reference; 95&nbsp;% of the pixels are below ",
          out);
    report_put_result(out, report, file ? file : "", "ldr.flip.p95");
    fputs(", the worst is ", out);
    report_put_result(out, report, file ? file : "", "ldr.flip.max");
    fputs("</figcaption></figure>\n", out);
    free(map);
    free(file);
}

/* Whether the backends had the same bits, if there are two. */
static void put_agreement(FILE *out, struct report *report, const struct step_scene *scene)
{
    char *file = report_file(scene, "compare", ".json");
    const cJSON *result =
        report->steps.sides.count > 1 && file ? steps_result(&report->steps, file) : NULL;
    const cJSON *broken = cJSON_GetObjectItem(result, "first_break");
    const cJSON *guilty = cJSON_GetObjectItem(result, "guilty");
    free(file);
    if (!result)
        return;
    if (cJSON_IsNull(broken)) {
        fputs("<p>The backends agree on every resource of every pass.</p>\n", out);
        return;
    }
    fputs("<p>The backends differ, first in the pass <code>", out);
    report_put_text(out, step_text(cJSON_IsObject(guilty) ? guilty : broken, "pass"));
    fputs("</code>.</p>\n", out);
}

static void put_scene(FILE *out, struct report *report, const struct step_scene *scene)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    const cJSON *last = report_last_picture(report);
    char *file = report_file(scene, step_text(last, "name"), ".json");
    fprintf(out, "<h3 id=\"scene-%u\">", (unsigned)(scene - report->steps.scenes));
    report_put_text(out, scene->name);
    fputs("</h3>\n<div class=\"strip\">\n", out);
    cJSON_ArrayForEach(picture, pictures) put_picture(out, report, scene, picture);
    if (file && steps_result(&report->steps, file)) {
        put_reference(out, report, scene, step_text(last, "name"));
        put_map(out, report, scene, last);
    }
    fputs("</div>\n", out);
    put_agreement(out, report, scene);
    free(file);
}

static void put_pictures(FILE *out, struct report *report)
{
    put_heading(out, report, "pictures", "Pictures", "");
    fputs(
        "<p>All pictures of a scene are shown at one exposure, that of its reference, and were "
        "measured like that. Relative MSE is of the linear light, 0 for no error; FLIP is what an "
        "observer sees when the two pictures take turns, from 0, the same, to 1. Noise of the "
        "reference "
        "counts as an error of the picture.</p>\n"
        "<ul class=\"scale\" aria-label=\"Colours of FLIP maps\"><li>0</li>"
        "<li class=\"bar\" aria-hidden=\"true\"></li><li>1</li></ul>\n",
        out);
    report_put_overview(out, report);
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (report->steps.scenes[i].mesh)
            put_scene(out, report, &report->steps.scenes[i]);
    }
}

/* ---- Plots ----------------------------------------------------------------------------------- */

static void put_plot_of_height(FILE *out, const struct report *report, int height, const char *name,
                               const char *title, const char *what)
{
    char *path = format_string("%s/plots/%s.svg", report->steps.folder, name);
    if (path && file_exists(path)) {
        fputs("<figure><img src=\"plots/", out);
        report_put_link(out, name);
        fprintf(out, ".svg\" width=\"480\" height=\"%d\" loading=\"lazy\" alt=\"Plot: ", height);
        report_put_text(out, title);
        fputs("; the table has the numbers\"><figcaption><b>", out);
        report_put_text(out, title);
        fprintf(out, "</b>%s</figcaption></figure>\n", what);
    }
    free(path);
}

static void put_plot(FILE *out, const struct report *report, const char *name, const char *title,
                     const char *what)
{
    put_plot_of_height(out, report, PLOT_HEIGHT, name, title, what);
}

static void put_published_error(FILE *out, const struct report *report)
{
    const cJSON *published = find_published(report);
    const cJSON *error = cJSON_GetObjectItem(published, "own_error");
    const cJSON *item, *values = cJSON_GetObjectItem(error, "values");
    char buffer[32];
    int i = 0;
    if (!values)
        return;
    fputs("<p>Of ", out);
    report_put_text(out, step_text(published, "scene"));
    fputs(", ", out);
    report_put_text(out, step_text(published, "by"));
    fputs(" has against its own last picture:", out);
    cJSON_ArrayForEach(item, values)
    {
        fprintf(out, "%s %g at ", i ? "," : "", item->valuedouble);
        report_put_text(out, report_item(report_values(report), i++, buffer));
    }
    fputs(" (", out);
    report_put_text(out, step_text(error, "metric"));
    fputs("). That is another metric: compare how fast it falls, not the numbers.</p>\n", out);
}

static void put_errors(FILE *out, struct report *report)
{
    put_heading(out, report, "errors", "Error against ", report_parameter(report));
    fputs("<div class=\"plots\">\n", out);
    put_plot(out, report, "errors", "Relative MSE against the reference",
             "Lower is better. What is left at the right end is the method&rsquo;s own, and the "
             "noise of the reference.");
    put_plot(out, report, "flip", "FLIP against the reference",
             "What an observer sees of the same, from 0 to 1.");
    put_plot(out, report, "own_errors",
             "Relative MSE against the pipeline's own picture with the last value",
             "How much would still change: the reference plays no part in it.");
    fputs("</div>\n", out);
    put_published_error(out, report);
    fputs("<details><summary>The numbers</summary>\n", out);
    report_put_errors(out, report);
    fputs("<p><a href=\"rows.csv\">rows.csv</a></p></details>\n", out);
}

/* ---- Motions --------------------------------------------------------------------------------- */

static void put_motion(FILE *out, struct report *report, const struct step_scene *scene,
                       const cJSON *motion)
{
    char *change = format_string("change_%s_%s", scene->name, step_text(motion, "name"));
    char *flicker = format_string("flicker_%s_%s", scene->name, step_text(motion, "name"));
    fputs("<h3>", out);
    report_put_text(out, scene->name);
    fputs(": ", out);
    report_put_text(out, step_text(motion, "title"));
    fputs("</h3>\n<div class=\"plots\">\n", out);
    int height = report_change_plot_height(report);
    put_plot_of_height(out, report, height, change ? change : "", "Change from frame to frame",
                       "Good is what the reference does.");
    put_plot_of_height(
        out, report, height, flicker ? flicker : "", "Flicker",
        "Mean difference between this change and the reference&rsquo;s, point by point.");
    fputs("</div>\n", out);
    report_put_flicker(out, report, scene, motion);
    free(flicker);
    free(change);
}

static void put_motions_head(FILE *out, const struct report *report)
{
    const cJSON *settings = cJSON_GetObjectItem(report->outline, "motion");
    int block = cJSON_GetObjectItem(settings, "block")->valueint;
    fputs("<h2 id=\"motions\">Temporal coherence</h2>\n<p>Over a motion of ", out);
    fprintf(out, "%d frames at ", cJSON_GetObjectItem(settings, "frames")->valueint);
    report_put_text(out, step_text(settings, "size"));
    fputs(", how much <code>", out);
    report_put_text(out, step_text(settings, "show"));
    fprintf(
        out,
        "</code>, the indirect irradiance, changes from one frame to the next where both show "
        "the same point of a surface, averaged over blocks of %d &times; %d pixels, in per cent "
        "of its mean. Light that moves must change; <i>excess</i> is what a run changes more "
        "than the reference, <i>flicker</i> where it does so in another way, also where both "
        "sums are alike. The last row of a table, the reference traced again with other noise, "
        "tells what noise does: 0.7 times its flicker, where two noises meet, is in that of the "
        "others.</p>\n",
        block, block);
}

static void put_motions(FILE *out, struct report *report)
{
    bool any = false;
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        const struct step_scene *scene = &report->steps.scenes[i];
        const cJSON *motion = NULL;
        while (scene->mesh && (motion = report_next_motion(report, scene, motion))) {
            if (!any)
                put_motions_head(out, report);
            any = true;
            put_motion(out, report, scene, motion);
        }
    }
}

/* ---- Times ----------------------------------------------------------------------------------- */

static void put_published_device(FILE *out, const struct report *report)
{
    const cJSON *published = find_published(report);
    if (!published)
        return;
    fputs("<p><strong>Other hardware:</strong> the numbers of ", out);
    report_put_text(out, step_text(published, "by"));
    fputs(" are from a ", out);
    report_put_text(out, step_text(published, "device"));
    fputs(" at ", out);
    report_put_text(out, step_text(published, "size"));
    fputs(", ours from the devices named above. Compare how they grow, not their size.</p>\n", out);
}

static void put_times(FILE *out, struct report *report)
{
    put_heading(out, report, "times", "Time against ", report_parameter(report));
    fputs("<p>Medians over frames; the backends took turns frame by frame. Bars in the plots "
          "reach from the 5th to the 95th percentile.</p>\n",
          out);
    put_published_device(out, report);
    fputs("<div class=\"plots\">\n", out);
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        char *name = format_string("times_%s", report->steps.scenes[i].name);
        if (name && report->steps.scenes[i].mesh)
            put_plot(out, report, name, report->steps.scenes[i].name, "Whole frame, logarithmic.");
        free(name);
    }
    fputs("</div>\n<h3>By stage</h3>\n<p>A stage is the sum of its passes&rsquo; medians.</p>\n"
          "<div class=\"tables\">\n",
          out);
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (report->steps.scenes[i].mesh)
            report_put_stages(out, report, &report->steps.scenes[i]);
    }
    fputs("</div>\n<p><a href=\"rows.csv\">rows.csv</a></p>\n", out);
}

/* ---- How it was made ------------------------------------------------------------------------- */

static void put_commands(FILE *out, const struct report *report, const struct step_scene *scene,
                         enum report_part part, const char *title)
{
    fprintf(out, "<h3>%s</h3>\n<pre class=\"commands\">", title);
    for (uint32_t i = 0; i < report->steps.count; i++) {
        const struct step *step = &report->steps.list[i];
        if (step->scene == scene && step->part == (int)part) {
            report_put_text(out, step->command);
            fputs("\n", out);
        }
    }
    fputs("</pre>\n", out);
}

static bool put_spec(FILE *out, const struct report *report)
{
    size_t size;
    char *text = file_read(report->steps.spec, &size, &report->steps.console->log);
    if (!text)
        return false;
    fputs("<details><summary>The spec</summary>\n<pre>", out);
    report_put_text(out, text);
    fputs("</pre></details>\n", out);
    free(text);
    return true;
}

static bool put_making(FILE *out, const struct report *report)
{
    static const char *const titles[REPORT_PARTS] = {
        [PART_PICTURES] = "Pictures",
        [PART_ERRORS] = "Errors of the sweep",
        [PART_MOTIONS] = "Temporal coherence",
        [PART_TIMES] = "Times",
        [PART_COMPARISON] = "Comparison of the backends",
    };
    fputs(
        "<h2 id=\"making\">How it was made</h2>\n<p>Every number comes from a file beside this "
        "page that one "
        "command wrote; the commands can be pasted. This one brings the whole page up to date, and "
        "does again only what has changed:</p>\n<pre class=\"commands\">",
        out);
    report_put_text(out, report->command);
    fputs("</pre>\n", out);
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        if (!report->steps.scenes[i].mesh)
            continue;
        fputs("<details><summary>Commands: ", out);
        report_put_text(out, report->steps.scenes[i].name);
        fputs("</summary>\n", out);
        for (int part = 0; part < REPORT_PARTS; part++) {
            if ((part != PART_COMPARISON || report->steps.sides.count > 1) &&
                (part != PART_MOTIONS ||
                 report_next_motion(report, &report->steps.scenes[i], NULL)))
                put_commands(out, report, &report->steps.scenes[i], (enum report_part)part,
                             titles[part]);
        }
        fputs("</details>\n", out);
    }
    return put_spec(out, report);
}

/* ---- The file -------------------------------------------------------------------------------- */

static bool put_page(FILE *out, struct report *report)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>", out);
    report_put_text(out, page_title(report));
    fputs("</title>\n", out);
    fputs(page_head, out);
    fputs("</head>\n<body>\n", out);
    put_introduction(out, report);
    put_pictures(out, report);
    put_errors(out, report);
    put_motions(out, report);
    put_times(out, report);
    bool good = put_making(out, report);
    fputs("</body>\n</html>\n", out);
    return good;
}

bool report_write_page(struct report *report)
{
    const struct dt_log *log = &report->steps.console->log;
    char *path = format_string("%s/index.html", report->steps.folder);
    struct file_draft draft;
    bool good = file_draft_begin(&draft, log) && put_page(draft.out, report);
    if (good) {
        console_hold(report->steps.console);
        good = file_draft_end(&draft, path, log);
        console_release(report->steps.console);
    } else {
        file_draft_discard(&draft);
    }
    free(path);
    return good;
}
