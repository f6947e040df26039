/* `diptych report`: one HTML page on a pipeline: pictures beside their reference, errors, times,
 * and published numbers. Other verbs do the work, as steps of the report's folder (steps.h); the
 * page is made from their results. */
#include "report/report.h"

#include <stdlib.h>

#include "base/files.h"
#include "measure/plot.h"

/* ---- Preparing ------------------------------------------------------------------------------- */

static bool report_prepare(struct report *report, struct console *console,
                           const struct options *options)
{
    struct steps *steps = &report->steps;
    const struct steps_request request = {.setup = &options->setup,
                                          .output = options->output,
                                          .spp = options->spp,
                                          .noise = options->noise,
                                          .frames = options->run_frames,
                                          .warmup = options->warmup,
                                          .collect = options->collect};
    report->options = options;
    return steps_begin(steps, "report", console, &request) && report_read_outline(report) &&
           report_find_scenes(report) && plot_has_gnuplot(console) && steps_check_spec(steps) &&
           steps_make_folder(steps) && report_plan(report);
}

static void report_free(struct report *report)
{
    grid_free(&report->grid);
    steps_free(&report->steps);
    cJSON_Delete(report->outline);
    free(report->outline_path);
    free(report->command);
}

/* The rows of all that was measured, the plots and the page. */
static bool write_report(struct report *report)
{
    char *csv = format_string("%s/rows.csv", report->steps.folder);
    bool good = csv && grid_read(&report->grid);
    console_hold(report->steps.console);
    good = good && grid_write_csv(&report->grid, csv);
    console_release(report->steps.console);
    free(csv);
    return good && report_draw_plots(report) && report_write_page(report);
}

static cJSON *report_json(const struct report *report, uint32_t failures)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "spec", report->steps.spec);
    cJSON_AddStringToObject(root, "folder", report->steps.folder);
    cJSON_AddStringToObject(root, "page", "index.html");
    cJSON *scenes = cJSON_AddArrayToObject(root, "scenes");
    for (uint32_t i = 0; i < report->steps.scene_count; i++)
        if (report->steps.scenes[i].mesh)
            cJSON_AddItemToArray(scenes, cJSON_CreateString(report->steps.scenes[i].path));
    cJSON_AddNumberToObject(root, "steps", report->steps.count);
    cJSON_AddNumberToObject(root, "failures", failures);
    return root;
}

int verb_report(struct console *console, const struct options *options)
{
    struct report report = {0};
    int status = EXIT_USAGE;
    if (options->folder && options->collect)
        return report_collect(console, options->folder);
    if (options->folder || !options->output) {
        report_error(&console->log, "report: %s; see diptych report --help",
                     options->folder ? "DIR goes with --collect" : "-o DIR is missing");
        return status;
    }
    if (report_prepare(&report, console, options)) {
        status = EXIT_FAILED;
        if (options->collect || steps_run(&report.steps)) {
            uint32_t failures = steps_count_failures(&report.steps);
            bool good = write_report(&report);
            if (good) {
                printf("%s/index.html\n", report.steps.folder);
                console->result = report_json(&report, failures);
            }
            status = good && (!failures || options->collect) ? EXIT_FINE : EXIT_FAILED;
        }
    }
    report_free(&report);
    return status;
}
