/* `diptych report`: one HTML page on a pipeline: pictures beside their reference, errors, times, and what was
 * published of it. The work is done by other verbs, which a ninja file in the report's folder runs; the
 * page is made of what they left. */
#include "report.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files.h"
#include "pipeline.h"
#include "tool.h"

/* ---- Preparing ------------------------------------------------------------------------------- */

/* Asked before hours of work. */
static bool has_gnuplot(struct console *console)
{
    static const struct tool gnuplot = {.what = "gnuplot",
                                        .hint = "install the package gnuplot-nox"};
    char *argv[] = {(char *)"gnuplot", (char *)"--version", NULL};
    return tool_run(&gnuplot, argv, -1, console);
}

/* The files that the spec is made of; the generator checks the overrides, too. */
static bool ask_generator(struct report *report)
{
    static const struct tool generator = {
        .what = "checking the spec", .hint = "build the project with ninja", .explains = true};
    const struct options *options = report->options;
    struct console *console = report->console;
    char *tools = tools_folder(&console->log), *found = templates_folder(&console->log);
    char *program = format_string("%s/diptych-gen", tools ? tools : "");
    char *templates = format_string("--templates=%s", found ? found : "");
    char **argv = calloc((size_t)options->set_count * 2 + 5, sizeof *argv);
    char *text = NULL;
    if (tools && found && program && templates && argv) {
        char *first[] = {program, templates, (char *)"--variations=0", report->spec};
        memcpy(argv, first, sizeof first);
        for (uint32_t i = 0; i < options->set_count; i++) {
            argv[4 + 2 * i] = (char *)"--set";
            argv[5 + 2 * i] = (char *)options->sets[i];
        }
        text = tool_read(&generator, argv, console);
    }
    cJSON *answer = text ? cJSON_Parse(text) : NULL;
    report->spec_files = cJSON_DetachItemFromObject(answer, "inputs");
    if (text && !report->spec_files)
        report_error(&console->log, "the generator's answer cannot be read");
    cJSON_Delete(answer);
    free(text);
    free(argv);
    free(templates);
    free(program);
    free(found);
    free(tools);
    return report->spec_files;
}

static bool find_scenes_folder(struct report *report)
{
    const char *given =
        report->options->scenes ? report->options->scenes : getenv("DIPTYCH_SCENES");
    if (!given || !*given)
        return true;
    report->scenes_folder = realpath(given, NULL);
    if (!report->scenes_folder)
        report_error(&report->console->log, "--scenes %s: %s", given, strerror(errno));
    return report->scenes_folder;
}

static bool find_program(struct report *report)
{
    char *tools = tools_folder(&report->console->log);
    report->program = tools ? format_string("%s/diptych", tools) : NULL;
    free(tools);
    return report->program;
}

/* A report goes into a new folder, an empty one, or that of a report. */
static bool make_folder(struct report *report)
{
    const struct dt_log *log = &report->console->log;
    const char *path = report->options->output;
    char *commands = format_string("%s/commands", path);
    DIR *listing = opendir(path);
    int entries = 0;
    while (listing && readdir(listing))
        entries++;
    if (listing)
        closedir(listing);
    bool good = commands && (entries <= 2 || file_exists(commands));
    if (commands && !good)
        report_error(log, "%s: holds files, but no report; give another folder", path);
    free(commands);
    if (!good || !file_make_folders(path, log))
        return false;
    report->folder = realpath(path, NULL);
    if (report->folder && !strpbrk(report->folder, "\n|"))
        return true;
    report_error(log, "%s: a path with a line break or a | cannot stand in a ninja file", path);
    return false;
}

static bool prepare(struct report *report)
{
    const struct options *options = report->options;
    const struct dt_log *log = &report->console->log;
    report->spec = pipeline_spec_path(options->spec, log);
    report->results = cJSON_CreateObject();
    return report->spec && sides_read_each(&report->sides, options, log) && find_program(report) &&
           find_scenes_folder(report) && report_read_outline(report) &&
           report_find_scenes(report) && has_gnuplot(report->console) && ask_generator(report) &&
           make_folder(report) && report_plan(report);
}

/* ---- Running --------------------------------------------------------------------------------- */

/* One step at a time: half of them measure time. */
static bool run_steps(struct report *report)
{
    static const struct tool ninja = {
        .what = "ninja", .hint = "install the package ninja-build", .explains = true};
    char *argv[] = {(char *)"ninja", (char *)"-C", report->folder, (char *)"-k",
                    (char *)"0",     (char *)"-j", (char *)"1",    NULL};
    unsigned errors = atomic_load(&report->console->errors);
    console_hold(report->console);
    bool good = report_write_steps(report);
    console_release(report->console);
    if (good)
        tool_run(&ninja, argv, STDERR_FILENO,
                 report->console); /* what failed is looked for below */
    return good && atomic_load(&report->console->errors) == errors;
}

static uint32_t count_failures(const struct report *report)
{
    uint32_t failures = 0;
    for (uint32_t i = 0; i < report->step_count; i++) {
        if (report_step_is_done(report, &report->steps[i]))
            continue;
        failures++;
        report_error(&report->console->log, "%s: there is no result of: %s", report->steps[i].file,
                     report->steps[i].command);
    }
    return failures;
}

static void report_free(struct report *report)
{
    for (uint32_t i = 0; i < report->step_count; i++) {
        free(report->steps[i].file);
        free(report->steps[i].command);
        free(report->steps[i].motion);
    }
    for (uint32_t i = 0; i < report->scene_count; i++) {
        free(report->scenes[i].path);
        free(report->scenes[i].name);
        free(report->scenes[i].mesh);
    }
    free(report->steps);
    free(report->scenes);
    cJSON_Delete(report->results);
    cJSON_Delete(report->spec_files);
    cJSON_Delete(report->outline);
    sides_free(&report->sides);
    free(report->scenes_folder);
    free(report->outline_path);
    free(report->spec);
    free(report->program);
    free(report->command);
    free(report->folder);
}

static cJSON *report_json(const struct report *report, uint32_t failures)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "spec", report->spec);
    cJSON_AddStringToObject(root, "folder", report->folder);
    cJSON_AddStringToObject(root, "page", "index.html");
    cJSON *scenes = cJSON_AddArrayToObject(root, "scenes");
    for (uint32_t i = 0; i < report->scene_count; i++) {
        if (report->scenes[i].mesh)
            cJSON_AddItemToArray(scenes, cJSON_CreateString(report->scenes[i].path));
    }
    cJSON_AddNumberToObject(root, "steps", report->step_count);
    cJSON_AddNumberToObject(root, "failures", failures);
    return root;
}

int verb_report(struct console *console, const struct options *options)
{
    struct report report = {.console = console, .options = options};
    int status = EXIT_USAGE;
    if (prepare(&report)) {
        status = EXIT_FAILED;
        if (run_steps(&report)) {
            uint32_t failures = count_failures(&report);
            bool good = report_draw_plots(&report) && report_write_page(&report);
            if (good) {
                printf("%s/index.html\n", report.folder);
                console->result = report_json(&report, failures);
            }
            status = good && !failures ? EXIT_FINE : EXIT_FAILED;
        }
    }
    report_free(&report);
    return status;
}
