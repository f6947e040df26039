/* The `diptych` command: finds the verb, reads its options, runs it. Each verb lives in a file of
 * its own. */
#include <cjson/cJSON.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "base/limit.h"
#include "console/options.h"
#include "base/nearest.h"

static int verb_help(struct console *console, const struct options *options);

static const struct verb verbs[] = {
    {"render", VERB_RENDER, "render a scene with one backend into a picture",
     "Exit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.", verb_render,
     EXIT_FAILED},
    {"compare", VERB_COMPARE,
     "run two or more backends, or take dumps, and compare every resource after every pass",
     "Prints a table. Its last line names the guilty pass: the first with an error of its own when "
     "it gets\nthe first side's inputs.\nWith dumps nothing is run: the last line names "
     "the first pass that differs, lines before it say why.\nLines that begin with `elsewhere:` "
     "tell what other devices or runs may do.\nThe verdict `not finite`: both have NaN or infinity "
     "in the same places, which no contract accepts.\nExit status: 0 the backends agree, 1 they "
     "differ, or leave NaN or infinity,\nor --sanitize or --repeat has found something, 2 it could "
     "not run.",
     verb_compare, EXIT_USAGE},
    {"capture", VERB_CAPTURE, "capture a frame of any program that draws with OpenGL or Vulkan",
     "RenderDoc runs the program and writes a frame; compare takes two such files. Needs the "
     "packages\nrenderdoc and python3-renderdoc. The program is ended then.\nExit status: 0 done, "
     "1 it failed (the reason is on stderr), 2 wrong usage.",
     verb_capture, EXIT_FAILED},
    {"import", VERB_IMPORT, "make a spec of shaders, or of a preset of RetroArch",
     "The shaders stay as they are; the spec declares what they read and write. It checks and runs "
     "at once;\ncomments name what a shader does not tell, such as sizes.\nExit status: 0 done, 1 "
     "it failed (the reason is on stderr), 2 wrong usage.",
     verb_import, EXIT_FAILED},
    {"list", VERB_LIST, "name the parameters, resources and passes of a pipeline",
     "Parameters have their type, value and range; resources their format and size; passes what "
     "they\n"
     "call at this size, read and write, in order of execution.\n"
     "Exit status: 0 done, 1 the spec is wrong (the reason is on stderr), 2 wrong usage.",
     verb_list, EXIT_FAILED},
    {"replay", VERB_REPLAY, "run one pass alone, from a folder that compare --bisect wrote",
     "Prints how the results of the pass differ from the expected ones.\nExit status: 0 as "
     "expected, 1 it differs, or --sanitize has found something, 2 it could not run.",
     verb_replay, EXIT_USAGE},
    {"reference", VERB_REFERENCE, "path-trace a scene as ground truth for pipelines",
     "Surfaces are Lambertian; lights, camera and materials are the same as for "
     "pipelines.\nTextures are read from their finest mip, bilinear; --filter box averages them "
     "over pixels.\nThe same options give the same bits, for any number of threads and after "
     "interruptions.\nExit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.",
     verb_reference, EXIT_FAILED},
    {"metrics", VERB_METRICS, "measure how far a picture is from its reference",
     "RMSE, relative MSE, PSNR and FLIP, of linear light and after tone mapping, at one "
     "exposure.\nNeeds Python with NumPy.\nExit status: 0 done, 1 it failed, 2 wrong usage.",
     verb_metrics, EXIT_FAILED},
    {"flicker", VERB_FLICKER, "measure how much pictures of a motion change from frame to frame",
     "Compares pixels where both frames show the same surface, found by casting rays. Change\n"
     "is the mean absolute difference of a pixel between two frames. Flicker is the mean\n"
     "absolute difference between the pictures' and the reference's differences. Percentages\n"
     "are of the mean of the reference, or without one, of the pictures. Needs Python with NumPy.\n"
     "Exit status: 0 done, 1 it failed, 2 wrong usage.",
     verb_flicker, EXIT_FAILED},
    {"bench", VERB_BENCH, "time every pass of one or more backends, frame by frame in turn",
     "Times are the device's, in milliseconds: medians with the 5th and 95th percentile. Rates "
     "count every\nresource of a pass whole and once. The device's best rates are measured by "
     "templates/machine.yaml.\nExit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong "
     "usage.",
     verb_bench, EXIT_FAILED},
    {"cost", VERB_COST, "what a frame costs on a GPU, by its compiler, without the GPU",
     "Compiles every pass for chips of AMD with RADV on its null hardware, and prints registers, "
     "waves, code\nand cycles of each stage. With the plan's counts they make lower bounds of "
     "times: of arithmetic, of one\nwave's latency, and of bytes.\n"
     "Exit status: 0 done, 1 --against: a pass is worse beyond the limit, 2 it could not run.",
     verb_cost, EXIT_USAGE},
    {"report", VERB_REPORT, "one HTML page: pictures beside their reference, errors, times",
     "Runs reference, render, metrics, bench and compare by Snakemake, from a Snakefile in the "
     "folder, and makes\nindex.html from their results. The same command continues an interrupted "
     "report.\nExit status: 0 done, 1 a step failed (the page shows the rest), 2 it could not run.",
     verb_report, EXIT_USAGE},
    {"view", VERB_VIEW, "a window on one to three backends, which says whether they agree",
     "Without options: the Cornell Box, by OpenGL and Vulkan. The bar on top is the verdict: a "
     "click, or G,\n"
     "shows the first difference. Left are passes and what they write, right the parameters, below "
     "errors and log.\n"
     "W A S D and the mouse fly, Q and E go down and up; right button: orbit; wheel: zoom; F: "
     "whole.\n"
     "Tab or Right, Left: the next or previous image; Home: the picture; Up, Down: a layer;\n"
     "Page Up, Page Down: a mip; 0 to 9: the first live parameter that is an integer.\n"
     "C: backends side by side, a part of each, difference; + and -: its amplification; T: false "
     "colour; R: range.\n"
     "Space: pause; . one frame; B: settings A or B; Ctrl+Z: undo; P: save the picture; Ctrl+S: "
     "the camera;\n"
     "F1: keys; F2, F3, F4, H: panes; Esc: end. Sizes of panes are kept in "
     "$XDG_CONFIG_HOME/diptych/view.yaml.\n"
     "Saving the spec or a file that it names reloads the pipeline.\n"
     "Exit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.",
     verb_view, EXIT_FAILED},
    {"sweep", VERB_SWEEP, "compare or measure over many variations of a spec, scenes and sizes",
     "Give --grid. Writes a folder with a Snakefile, its config.json, a folder of results for each "
     "scene,\nindex.html, a page, and summary.json and summary.csv, and starts Snakemake. The same "
     "command continues\nan interrupted sweep. --set fixes a value in every run.\n"
     "--measure takes times and errors instead: the page has a plot of each quantity, rows.csv a "
     "row for\neach combination and backend. A failed run has a row with its reason.\n"
     "On a cluster: --profile, or snakemake -s DIR/Snakefile --cluster ..., then --collect.\n"
     "Exit status: 0 all runs agree, or were measured, 1 some differ, 2 some could not run.",
     verb_sweep, EXIT_USAGE},
    {"tune", VERB_TUNE, "find the fastest choices that change no bit, for one device",
     "Tries other workgroups, and other storage and loops of ranges, which a spec leaves to the "
     "generator.\nA change is kept if it makes its pass faster in frames that take turns; passes "
     "below 1 % of the frame\nare left as they are. --gpu goes by the figures of a GPU's compiler, "
     "as `cost` does, and leaves loops out. --set keeps a value.\nAt the end, all resources of all "
     "passes must have the same bits.\nExit status: 0 done, 1 it failed, 2 wrong usage.",
     verb_tune, EXIT_FAILED},
    {"help", VERB_HELP, "list the verbs, or the options of one",
     "Exit status: 0 done, 2 wrong usage.", verb_help, EXIT_USAGE},
};

/* For --help and the manual page. */
static const struct {
    const char *name, *text;
} environment[] = {
    {"DIPTYCH_SCENES", "folder where meshes are found, when --scenes names none"},
    {"DIPTYCH_CACHE_MIB", "most that compiled shaders take on the disk (default: 64)"},
    {"XDG_CACHE_HOME", "where an installed diptych keeps them (default: ~/.cache)"},
    {"DIPTYCH_QUIET", "if set, only warnings and errors are printed"},
};

static void help(FILE *stream)
{
    fprintf(stream, "diptych: one description of a GPU pipeline, run by OpenGL and by Vulkan\n\n"
                    "usage: diptych VERB [options]\n\n");
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
        fprintf(stream, "  %-11s%s\n", verbs[i].name, verbs[i].summary);
    fprintf(stream,
            "\ndiptych help VERB, or diptych VERB --help, lists the verb's options; diptych "
            "--version prints the version.\n\nEnvironment:\n");
    for (size_t i = 0; i < DT_ARRAY_COUNT(environment); i++)
        fprintf(stream, "  %-19s%s\n", environment[i].name, environment[i].text);
}

static int unknown_verb(const struct console *console, const char *word)
{
    const char *names[DT_ARRAY_COUNT(verbs)];
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
        names[i] = verbs[i].name;
    report_error(&console->log, "unknown verb \"%s\"%s", word,
                 name_hint('"', word, names, DT_ARRAY_COUNT(verbs), "; see diptych --help").text);
    return EXIT_USAGE;
}

static const struct verb *find_verb(const char *name)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
        if (strcmp(name, verbs[i].name) == 0)
            return &verbs[i];
    return NULL;
}

static int verb_help(struct console *console, const struct options *options)
{
    const struct verb *verb = options->topic ? find_verb(options->topic) : NULL;
    if (options->topic && !verb)
        return unknown_verb(console, options->topic);
    if (verb)
        options_help(verb);
    else
        help(stdout);
    return EXIT_FINE;
}

/* For app/manual.awk. */
static int describe_verbs(void)
{
    printf("program\tdiptych\tone description of a GPU pipeline, run by OpenGL and by Vulkan\t\n");
    for (size_t i = 0; i < DT_ARRAY_COUNT(environment); i++)
        printf("environment\t%s\t%s\n", environment[i].name, environment[i].text);
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
        options_describe(&verbs[i]);
    return EXIT_FINE;
}

/* ---- The run ---------------------------------------------------------------------------------- */

enum { OUTCOME_FORMAT = 1 };

static cJSON *outcome_json(const struct console *console, const char *verb, int status)
{
    char *errors = format_string("[%s\n  ]", console->kept.data ? console->kept.data : "");
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "verb", verb);
    cJSON_AddNumberToObject(root, "format", OUTCOME_FORMAT);
    cJSON_AddNumberToObject(root, "exit_status", status);
    cJSON_AddRawToObject(root, "errors", errors ? errors : "[]");
    free(errors);
    while (console->result && console->result->child) {
        cJSON *item = cJSON_DetachItemViaPointer(console->result, console->result->child);
        cJSON_AddItemToObject(root, item->string, item);
    }
    return root;
}

/* --json: the result of a verb, or its errors, in one shape: {"verb", "format": 1, "exit_status",
 * "errors": [...]} and the verb's own keys. An error, warning or note has "severity" and
 * "message", and if it has a place, "file", "line" and "column". Logs its error. */
static bool outcome_write(struct console *console, const char *verb, const char *path, int status)
{
    cJSON *root = outcome_json(console, verb, status);
    console_hold(console);
    bool good = file_write_json(path, root, &console->log);
    console_release(console);
    cJSON_Delete(root);
    return good;
}

/* Asked before hours of work whether the file can be written, and after them with all that is known. */
static int run_and_tell(struct console *console, const struct verb *verb,
                        const struct options *options)
{
    if (options->json && !file_can_write(options->json, &console->log))
        return verb->failed;
    const char *folders[] = {options->html, options->pictures};
    bool given[] = {!options->html || access(options->html, F_OK) == 0,
                    !options->pictures || access(options->pictures, F_OK) == 0};
    int status;
    status = verb->run(console, options);
    for (size_t i = 0; i < 2 && status == EXIT_USAGE; i++)
        if (!given[i]) /* made by the run: if it is empty, for nothing */
            (void)rmdir(folders[i]);
    if (options->json && !outcome_write(console, verb->name, options->json, status))
        status = verb->failed;
    return status;
}

/* An option that is wrong is told in the file as well, wherever that stands among the others. */
static void tell_usage(struct console *console, const struct verb *verb, int argc, char **argv)
{
    for (int i = 0; i < argc && argv[i]; i++) {
        const char *path = strncmp(argv[i], "--json=", 7) == 0              ? argv[i] + 7
                           : strcmp(argv[i], "--json") == 0 && i + 1 < argc ? argv[i + 1]
                                                                            : NULL;
        if (path)
            outcome_write(console, verb->name, path, EXIT_USAGE);
    }
}

static bool asks_for_json(int argc, char **argv)
{
    for (int i = 0; i < argc && argv[i]; i++)
        if (strncmp(argv[i], "--json", 6) == 0)
            return true;
    return false;
}

static int run_verb(struct console *console, const struct verb *verb, int argc, char **argv)
{
    struct options options;
    int status = EXIT_USAGE;
    console->failed = verb->failed;
    console->keeps = asks_for_json(argc, argv);
    bool good = options_parse(&options, verb, argc, argv, &console->log);
    if (good && options.help) {
        options_help(verb);
        status = EXIT_FINE;
    } else if (good) {
        status = run_and_tell(console, verb, &options);
    } else if (console->keeps) {
        tell_usage(console, verb, argc, argv);
    }
    cJSON_Delete(console->result);
    options_free(&options);
    return status;
}

static int run_command(struct console *console, int argc, char **argv)
{
    if (argc < 2) {
        help(stderr);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        help(stdout);
        return EXIT_FINE;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("diptych " VERSION "\n"); /* as build.ninja has it */
        return EXIT_FINE;
    }
    if (strcmp(argv[1], "--describe") == 0)
        return describe_verbs();
    const struct verb *verb = find_verb(argv[1]);
    return verb ? run_verb(console, verb, argc - 2, argv + 2) : unknown_verb(console, argv[1]);
}

int main(int argc, char **argv)
{
    struct console console;
    /* Vulkan drivers may keep each command of a frame in a block of malloc's: recording ssvp takes a
     * tenth less with lavapipe where blocks of this size are reused as they are. No harm if refused. */
    mallopt(M_MXFAST, 160);
    limit_memory(0);
    int status = console_open(&console) ? run_command(&console, argc, argv) : EXIT_FAILED;
    console_close(&console);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "diptych: error: standard output cannot be written\n");
        return EXIT_USAGE;
    }
    return status;
}
