/* The page of a report: what templates/report/report.html is filled with. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/files.h"
#include "console/fill.h"
#include "console/tool.h"
#include "measure/plot.h"
#include "report/report.h"

/* ---- Head ------------------------------------------------------------------------------------ */

/* Of the first run that any backend has told its "device" or "driver" in; "" where none has. */
static const char *find_device(struct report *report, uint32_t side, const char *what)
{
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        for (int v = 0; v < report_value_count(report) && report->steps.scenes[i].mesh; v++) {
            char *file = grid_bench_file(
                report_point(report, &report->steps.scenes[i], report_last_picture(report), v));
            const cJSON *sides =
                cJSON_GetObjectItem(steps_result(&report->steps, file ? file : ""), "sides");
            free(file);
            if (cJSON_GetArraySize(sides) > (int)side)
                return step_text(cJSON_GetArrayItem(sides, (int)side), what);
        }
    }
    return "";
}

static void add_devices(cJSON *page, struct report *report)
{
    cJSON *list = cJSON_AddArrayToObject(page, "devices");
    for (uint32_t side = 0; side < report->steps.sides.count; side++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "label", report->steps.sides.list[side].label);
        const char *device = find_device(report, side, "device");
        cJSON_AddStringToObject(item, "device",
                                *device ? device : "not known: no run of bench succeeded");
        cJSON_AddStringToObject(item, "driver", find_device(report, side, "driver"));
        cJSON_AddItemToArray(list, item);
    }
}

/* As Linux names it; software drivers run on it. */
static void add_processor(cJSON *page)
{
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256], *name = NULL;
    while (file && !name && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':'))
            name = strchr(line, ':') + 1;
    if (file)
        fclose(file);
    if (!name)
        return;
    line[strcspn(line, "\n")] = 0;
    cJSON *processor = cJSON_AddObjectToObject(page, "processor");
    cJSON_AddStringToObject(processor, "name", name + strspn(name, " "));
    cJSON_AddNumberToObject(processor, "count", (double)sysconf(_SC_NPROCESSORS_ONLN));
}

/* The commit that diptych was built from, where that is a checkout, and today's date. */
static void add_version(cJSON *page, struct console *console)
{
    static const struct tool git = {.what = "git", .hint = "install git", .explains = true};
    char date[32] = "", *tools = tools_folder(&console->log);
    char *argv[] = {(char *)"git",      (char *)"-C",      tools, (char *)"describe",
                    (char *)"--always", (char *)"--dirty", NULL};
    bool checked_out = tools && !tools_installed(tools) && tool_is_there("git");
    bool captures = checked_out && console_capture(console); /* a copy without .git is no error */
    char *commit = captures ? tool_read(&git, argv, console) : NULL;
    if (captures)
        free(console_captured(console));
    if (commit)
        commit[strcspn(commit, "\n")] = 0;
    time_t now = time(NULL);
    struct tm parts;
    if (gmtime_r(&now, &parts))
        strftime(date, sizeof date, "%F", &parts);
    cJSON_AddStringToObject(page, "version", VERSION);
    cJSON_AddStringToObject(page, "commit", commit ? commit : "");
    cJSON_AddStringToObject(page, "date", date);
    free(commit);
    free(tools);
}

static void add_left_out(cJSON *page, const struct report *report)
{
    cJSON *list = cJSON_AddArrayToObject(page, "left_out");
    for (uint32_t i = 0; i < report->steps.scene_count; i++)
        if (!report->steps.scenes[i].mesh)
            cJSON_AddItemToArray(list, cJSON_CreateString(report->steps.scenes[i].name));
}

/* How many results the page lacks, and the first reason. */
static void add_missing(cJSON *page, const struct report *report)
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
        cJSON *missing = cJSON_AddObjectToObject(page, "missing");
        cJSON_AddNumberToObject(missing, "count", failures);
        cJSON_AddNumberToObject(missing, "of", steps->count);
        cJSON_AddStringToObject(missing, "reason", reason ? reason : "");
    }
    free(reason);
}

static const char *page_title(const struct report *report)
{
    const char *title = step_text(report->outline, "title"),
               *slash = strrchr(report->steps.spec, '/');
    return *title ? title : slash + 1;
}

/* What was published, when its scene is in the report; else NULL. */
static const cJSON *find_published(const struct report *report)
{
    const cJSON *published = cJSON_GetObjectItem(report->outline, "published");
    for (uint32_t i = 0; i < report->steps.scene_count; i++)
        if (report->steps.scenes[i].mesh &&
            strcmp(report->steps.scenes[i].name, step_text(published, "scene")) == 0)
            return published;
    return NULL;
}

/* Where the same as in each section was published. */
static void add_figures(cJSON *page, const cJSON *published)
{
    const cJSON *figure;
    cJSON_ArrayForEach(figure, cJSON_GetObjectItem(published, "figures"))
    {
        char *name = format_string("figures_%s", figure->string);
        cJSON *item = name ? cJSON_AddObjectToObject(page, name) : NULL;
        cJSON_AddStringToObject(item, "by", step_text(published, "by"));
        cJSON_AddStringToObject(item, "figures", cJSON_GetStringValue(figure));
        free(name);
    }
}

static void add_head(cJSON *page, struct report *report)
{
    const struct setup *setup = report->steps.request.setup;
    cJSON_AddStringToObject(page, "title", page_title(report));
    cJSON_AddStringToObject(page, "source", step_text(report->outline, "source"));
    cJSON_AddStringToObject(page, "spec", report->steps.spec);
    cJSON *overrides = cJSON_AddArrayToObject(page, "overrides");
    for (uint32_t i = 0; i < setup->set_count; i++)
        cJSON_AddItemToArray(overrides, cJSON_CreateString(setup->sets[i]));
    cJSON_AddNumberToObject(page, "width", setup->size[0]);
    cJSON_AddNumberToObject(page, "height", setup->size[1]);
    cJSON_AddStringToObject(page, "parameter", report_parameter(report));
    add_version(page, report->steps.console);
    add_devices(page, report);
    add_processor(page);
    add_left_out(page, report);
    add_missing(page, report);
    cJSON_AddBoolToObject(page, "motion", cJSON_HasObjectItem(report->outline, "motion"));
}

/* ---- Pictures -------------------------------------------------------------------------------- */

/* `name` without an ending, in a scene's folder. */
static void add_page_image(cJSON *item, const char *key, const struct step_scene *scene,
                           const char *name, const char *part)
{
    char *path = format_string("%s/%s/%s.png", scene->name, name, part);
    report_add_link(item, key, path ? path : "");
    free(path);
}

static cJSON *picture_json(struct report *report, const struct step_scene *scene,
                           const cJSON *picture)
{
    const char *name = step_text(picture, "name");
    char *result = report_file(scene, name, ".json");
    const char *file = result ? result : "";
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "picture", step_text(picture, "title"));
    report_add_headlines(item, "errors", report, file);
    if (steps_result(&report->steps, file)) {
        add_page_image(item, "file", scene, name, "test");
    } else {
        char *reason = steps_reason(&report->steps, file);
        cJSON_AddStringToObject(item, "file", "");
        cJSON_AddStringToObject(item, "reason", reason ? reason : "");
        free(reason);
    }
    free(result);
    return item;
}

/* The reference, and the FLIP map of the last picture. */
static void add_page_reference(cJSON *item, struct report *report, const struct step_scene *scene)
{
    const cJSON *last = report_last_picture(report);
    const char *name = step_text(last, "name");
    const char *title = step_text(cJSON_GetObjectItem(report->outline, "reference"), "title");
    char *measured = report_file(scene, name, ".json");
    char *traced = report_file(scene, "reference", ".json");
    if (measured && traced && steps_result(&report->steps, measured)) {
        cJSON *reference = cJSON_AddObjectToObject(item, "reference");
        cJSON_AddStringToObject(reference, "title", *title ? title : "Reference");
        add_page_image(reference, "file", scene, name, "reference");
        report_add_result(reference, "samples", report, traced, "samples");
        report_add_number(reference, "noise", 100 * steps_number(&report->steps, traced, "noise"));
        cJSON *map = cJSON_AddObjectToObject(item, "map");
        cJSON_AddStringToObject(map, "picture", step_text(last, "title"));
        add_page_image(map, "file", scene, name, "flip_ldr");
        report_add_result(map, "p95", report, measured, "ldr.flip.p95");
        report_add_result(map, "worst", report, measured, "ldr.flip.max");
    }
    free(traced);
    free(measured);
}

static void add_choice(cJSON *list, const struct step_scene *scene, const char *name,
                       const char *part, const char *title, const char *side)
{
    cJSON *item = cJSON_CreateObject();
    add_page_image(item, "file", scene, name, part);
    cJSON_AddStringToObject(item, "title", title);
    cJSON_AddBoolToObject(item, "left", strcmp(side, "left") == 0);
    cJSON_AddBoolToObject(item, "right", strcmp(side, "right") == 0);
    cJSON_AddItemToArray(list, item);
}

/* Any two pictures of a scene on each other: first the last picture and the reference. */
static void add_shown(cJSON *item, struct report *report, const struct step_scene *scene)
{
    const cJSON *picture, *last = report_last_picture(report);
    const cJSON *reference = cJSON_GetObjectItem(item, "reference");
    if (!reference)
        return;
    cJSON *shown = cJSON_AddObjectToObject(item, "shown");
    cJSON *list = cJSON_AddArrayToObject(shown, "choices");
    cJSON_ArrayForEach(picture, cJSON_GetObjectItem(report->outline, "pictures"))
    {
        const char *name = step_text(picture, "name");
        char *result = report_file(scene, name, ".json");
        if (result && steps_result(&report->steps, result))
            add_choice(list, scene, name, "test", step_text(picture, "title"),
                       picture == last ? "left" : "");
        free(result);
    }
    add_choice(list, scene, step_text(last, "name"), "reference", step_text(reference, "title"),
               "right");
    add_page_image(shown, "first_file", scene, step_text(last, "name"), "test");
    add_page_image(shown, "second_file", scene, step_text(last, "name"), "reference");
}

/* Whether the backends had the same bits, if there are two. */
static void add_agreement(cJSON *item, struct report *report, const struct step_scene *scene)
{
    char *file = report_file(scene, "compare", ".json");
    const cJSON *result =
        report->steps.sides.count > 1 && file ? steps_result(&report->steps, file) : NULL;
    const cJSON *broken = cJSON_GetObjectItem(result, "first_break");
    const cJSON *guilty = cJSON_GetObjectItem(result, "guilty");
    cJSON_AddBoolToObject(item, "agree", result && cJSON_IsNull(broken));
    cJSON_AddStringToObject(item, "guilty",
                            result && !cJSON_IsNull(broken)
                                ? step_text(cJSON_IsObject(guilty) ? guilty : broken, "pass")
                                : "");
    free(file);
}

/* ---- Plots ----------------------------------------------------------------------------------- */

/* Adds nothing where there was nothing to be seen. */
static void add_plot(cJSON *item, const char *key, const struct report *report, int height,
                     const char *name)
{
    char *path = format_string("%s/plots/%s.svg", report->steps.folder, name);
    char *link = format_string("plots/%s.svg", name);
    if (path && link && file_exists(path)) {
        cJSON *plot = cJSON_AddObjectToObject(item, key);
        report_add_link(plot, "file", link);
        cJSON_AddNumberToObject(plot, "pixels", height);
    }
    free(link);
    free(path);
}

/* The names of the headlines, and their plots. */
static void add_headlines(cJSON *page, const struct report *report)
{
    cJSON *list = cJSON_AddArrayToObject(page, "headlines");
    for (int i = 0; i < IMAGE_HEADLINES; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "what", image_numbers[i].title);
        add_plot(item, "plot", report, PLOT_HEIGHT, image_numbers[i].name);
        cJSON_AddItemToArray(list, item);
    }
}

/* Of what was published: an error at each value. */
static void add_published_error(cJSON *page, const struct report *report, const cJSON *published)
{
    const cJSON *error = cJSON_GetObjectItem(published, "own_error");
    const cJSON *value, *values = cJSON_GetObjectItem(error, "values");
    char buffer[32];
    int i = 0;
    if (!values)
        return;
    cJSON *item = cJSON_AddObjectToObject(page, "published_error");
    cJSON_AddStringToObject(item, "scene", step_text(published, "scene"));
    cJSON_AddStringToObject(item, "by", step_text(published, "by"));
    cJSON_AddStringToObject(item, "metric", step_text(error, "metric"));
    cJSON *points = cJSON_AddArrayToObject(item, "points");
    cJSON_ArrayForEach(value, values)
    {
        cJSON *point = cJSON_CreateObject();
        snprintf(buffer, sizeof buffer, "%g", value->valuedouble);
        cJSON_AddStringToObject(point, "error", buffer);
        cJSON_AddStringToObject(point, "value", report_item(report_values(report), i++, buffer));
        cJSON_AddItemToArray(points, point);
    }
}

/* ---- Motions --------------------------------------------------------------------------------- */

static cJSON *motion_json(struct report *report, const struct step_scene *scene,
                          const cJSON *motion)
{
    const char *name = step_text(motion, "name");
    char *change = format_string("change_%s_%s", scene->name, name);
    char *flicker = format_string("flicker_%s_%s", scene->name, name);
    int height = report_change_plot_height(report);
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "scene", scene->name);
    cJSON_AddStringToObject(item, "motion_title", step_text(motion, "title"));
    add_plot(item, "plot_change", report, height, change ? change : "");
    add_plot(item, "plot_flicker", report, height, flicker ? flicker : "");
    report_add_flicker(item, report, scene, motion);
    free(flicker);
    free(change);
    return item;
}

static void add_motions(cJSON *page, struct report *report)
{
    const cJSON *settings = cJSON_GetObjectItem(report->outline, "motion");
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < report->steps.scene_count; i++) {
        const struct step_scene *scene = &report->steps.scenes[i];
        const cJSON *motion = NULL;
        while (scene->mesh && (motion = report_next_motion(report, scene, motion)))
            cJSON_AddItemToArray(list, motion_json(report, scene, motion));
    }
    if (!cJSON_GetArraySize(list)) {
        cJSON_Delete(list);
        return;
    }
    cJSON *motions = cJSON_AddObjectToObject(page, "motions");
    cJSON_AddNumberToObject(motions, "frames", cJSON_GetObjectItem(settings, "frames")->valueint);
    cJSON_AddStringToObject(motions, "size", step_text(settings, "size"));
    cJSON_AddStringToObject(motions, "show", step_text(settings, "show"));
    int from = report_motion_from_bounce(report);
    char *light =
        from > 1 ? format_string("%s from bounce %d on", report_motion_quantity(report), from)
                 : format_string("%s%s", from ? "indirect " : "", report_motion_quantity(report));
    cJSON_AddStringToObject(motions, "light", light ? light : "");
    free(light);
    cJSON_AddNumberToObject(motions, "block", cJSON_GetObjectItem(settings, "block")->valueint);
    cJSON_AddItemToObject(motions, "list", list);
}

/* ---- How it was made ------------------------------------------------------------------------- */

static cJSON *commands_json(const struct report *report, const struct step_scene *scene, int part)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < report->steps.count; i++) {
        const struct step *step = &report->steps.list[i];
        if (step->scene == scene && step->part == part)
            cJSON_AddItemToArray(list, cJSON_CreateString(step->command));
    }
    return list;
}

static void add_parts(cJSON *item, const struct report *report, const struct step_scene *scene)
{
    static const char *const titles[REPORT_PARTS] = {
        [PART_PICTURES] = "Pictures",
        [PART_ERRORS] = "Errors of the sweep",
        [PART_MOTIONS] = "Temporal coherence",
        [PART_TIMES] = "Times",
        [PART_COMPARISON] = "Comparison of the backends",
    };
    cJSON *parts = cJSON_AddArrayToObject(item, "parts");
    for (int part = 0; part < REPORT_PARTS; part++) {
        if ((part == PART_COMPARISON && report->steps.sides.count < 2) ||
            (part == PART_MOTIONS && !report_next_motion(report, scene, NULL)))
            continue;
        cJSON *one = cJSON_CreateObject();
        cJSON_AddStringToObject(one, "part", titles[part]);
        cJSON_AddItemToObject(one, "commands", commands_json(report, scene, part));
        cJSON_AddItemToArray(parts, one);
    }
}

/* ---- The file -------------------------------------------------------------------------------- */

static cJSON *scene_json(struct report *report, const struct step_scene *scene)
{
    const cJSON *picture, *pictures = cJSON_GetObjectItem(report->outline, "pictures");
    char *times = format_string("times_%s", scene->name);
    cJSON *item = cJSON_CreateObject();
    cJSON_AddNumberToObject(item, "id", (double)(scene - report->steps.scenes));
    cJSON_AddStringToObject(item, "scene", scene->name);
    cJSON *list = cJSON_AddArrayToObject(item, "pictures");
    cJSON_ArrayForEach(picture, pictures)
        cJSON_AddItemToArray(list, picture_json(report, scene, picture));
    add_page_reference(item, report, scene);
    add_shown(item, report, scene);
    add_agreement(item, report, scene);
    add_plot(item, "plot_times", report, PLOT_HEIGHT, times ? times : "");
    report_add_stages(item, report, scene);
    add_parts(item, report, scene);
    free(times);
    return item;
}

/* All that the template names; NULL, reported, when the spec cannot be read. */
static cJSON *page_json(struct report *report)
{
    size_t size;
    char *spec = file_read(report->steps.spec, &size, &report->steps.console->log);
    if (!spec)
        return NULL;
    const cJSON *published = find_published(report);
    cJSON *page = cJSON_CreateObject();
    add_head(page, report);
    add_figures(page, published);
    cJSON_AddNumberToObject(page, "picture_count",
                            cJSON_GetArraySize(cJSON_GetObjectItem(report->outline, "pictures")));
    cJSON *scenes = cJSON_AddArrayToObject(page, "scenes");
    for (uint32_t i = 0; i < report->steps.scene_count; i++)
        if (report->steps.scenes[i].mesh)
            cJSON_AddItemToArray(scenes, scene_json(report, &report->steps.scenes[i]));
    add_headlines(page, report);
    add_plot(page, "plot_own_errors", report, PLOT_HEIGHT, "own_errors");
    add_published_error(page, report, published);
    report_add_errors(page, report);
    add_motions(page, report);
    report_add_published(page, "published", published);
    cJSON_AddStringToObject(page, "command", report->command);
    cJSON_AddStringToObject(page, "spec_text", spec);
    free(spec);
    return page;
}

bool report_write_page(struct report *report)
{
    char *path = format_string("%s/index.html", report->steps.folder);
    cJSON *page = page_json(report);
    bool good = fill_page(report->steps.console, "report.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}
