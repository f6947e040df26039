/* The `diptych` command: finds the verb, reads its options, runs it. Each verb lives in a file of
 * its own. */
#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>

#include "base/files.h"
#include "base/names.h"
#include "base/options.h"
#include "base/outcome.h"

static const struct verb verbs[] = {
    {"render", VERB_RENDER, "render a scene with one backend into a picture",
     "Exit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.", verb_render,
     EXIT_FAILED},
    {"compare", VERB_COMPARE,
     "run two or more backends and compare every resource after every pass",
     "Prints a table; its last line names the pass that is to blame: the first that errs on its "
     "own,\n"
     "given the inputs that the first side had.\n"
     "Exit status: 0 the backends agree, 1 they differ, 2 it could not run.",
     verb_compare, EXIT_USAGE},
    {"replay", VERB_REPLAY, "run one pass alone, from a folder that compare --bisect wrote",
     "Prints how what the pass leaves differs from what was expected of it.\n"
     "Exit status: 0 as expected, 1 it differs, 2 it could not run.",
     verb_replay, EXIT_USAGE},
    {"reference", VERB_REFERENCE, "path-trace a scene: what the pipelines should come near to",
     "Surfaces are Lambertian; lights, camera and materials are those that the pipelines get.\n"
     "Textures are read from their finest mip, bilinear; --filter box averages them over pixels.\n"
     "The same options give the same bits, whatever the threads and however often interrupted.\n"
     "Exit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.",
     verb_reference, EXIT_FAILED},
    {"metrics", VERB_METRICS, "measure how far a picture is from its reference",
     "RMSE, relative MSE, PSNR and FLIP, of the linear light and after tone mapping, both at one\n"
     "exposure; OpenImageIO's version of Yee's metric, which misses differences of lightness "
     "alone.\n"
     "Exit status: 0 done, 1 it failed, 2 wrong usage.",
     verb_metrics, EXIT_FAILED},
    {"flicker", VERB_FLICKER, "measure how much pictures of a motion change from frame to frame",
     "Only where both frames show the same surface, found by casting rays, and beside what the\n"
     "reference changes there: flicker is the mean difference of both changes. Percentages are of\n"
     "the reference's mean, or without one, of the pictures' own.\n"
     "app/truth/change.h has the formulas.\n"
     "Exit status: 0 done, 1 it failed, 2 wrong usage.",
     verb_flicker, EXIT_FAILED},
    {"bench", VERB_BENCH, "time every pass of one or more backends, frame by frame in turn",
     "Milliseconds are those of the device, medians with the 5th and 95th percentile. Rates count "
     "every\n"
     "resource of a pass whole and once; a device's own, of templates/machine.yaml, are measured "
     "in turn\n"
     "with them. A pass that names C by `limit` is told in times of that, on this processor.\n"
     "Exit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.",
     verb_bench, EXIT_FAILED},
    {"report", VERB_REPORT, "one HTML page: pictures beside their reference, errors, times",
     "Runs reference, render, metrics, bench and compare by a ninja file in the folder, so that it "
     "goes\n"
     "on where it was interrupted, and makes index.html of what they wrote.\n"
     "Exit status: 0 done, 1 a step failed (the page shows the rest), 2 it could not run.",
     verb_report, EXIT_USAGE},
    {"view", VERB_VIEW, "a window on one backend, or on two beside each other",
     "W A S D and the mouse fly, Q and E go down and up; Shift: faster, the wheel: how fast.\n"
     "Tab or Right, Left: the next or previous image; Home: the picture; Up, Down: a layer;\n"
     "Page Up, Page Down: a mip; V: points; 0 to 9: the parameter that view.yaml beside the spec "
     "names.\n"
     "C: two backends side by side, half of each, their difference; + and -: its amplification.\n"
     "Space: pause; H: the panel; P: screenshot; Ctrl+S: camera into the scene file; Esc: end.\n"
     "Saving the spec or a file that it names makes the pipeline anew.\n"
     "Exit status: 0 done, 1 it failed (the reason is on stderr), 2 wrong usage.",
     verb_view, EXIT_FAILED},
    {"sweep", VERB_SWEEP, "compare or measure over many variations of a spec, scenes and sizes",
     "Give --random N or --grid. Writes one folder: build.ninja with an edge per run, and starts "
     "ninja,\n"
     "so that a sweep goes on where it was interrupted; commands, a line per run to paste; runs/, "
     "what\n"
     "each run said; summary.json and summary.csv. --set fixes a value in every run.\n"
     "--measure takes times and errors instead: rows.csv, a row for each combination and backend, "
     "and a\n"
     "plot of each quantity; what failed is a row with its reason.\n"
     "Exit status: 0 all runs agree, or were measured, 1 some differ, 2 some could not run.",
     verb_sweep, EXIT_USAGE},
};

static void help(FILE *stream)
{
    fprintf(stream, "diptych: one description of a GPU pipeline, run by OpenGL and by Vulkan\n\n"
                    "usage: diptych VERB [options]\n\n");
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
        fprintf(stream, "  %-11s%s\n", verbs[i].name, verbs[i].summary);
    fprintf(
        stream,
        "\ndiptych VERB --help lists the verb's options, diptych --version tells the version.\n\n"
        "Environment: DIPTYCH_SCENES, where meshes are found; CC, what compiles generated "
        "C;\nDIPTYCH_CACHE_MIB, most that compiled pipelines take on the disk (default: 512); "
        "DIPTYCH_QUIET, if\nset: warnings and errors only.\n");
}

static int unknown_verb(const struct console *console, const char *word)
{
    const char *names[DT_ARRAY_COUNT(verbs)];
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
        names[i] = verbs[i].name;
    const char *hint = closest_name(word, names, DT_ARRAY_COUNT(verbs));
    if (hint)
        report_error(&console->log, "unknown verb \"%s\"; did you mean \"%s\"?", word, hint);
    else
        report_error(&console->log, "unknown verb \"%s\"; see diptych --help", word);
    return EXIT_USAGE;
}

/* Asked before hours of work whether the file can be written, and after them with all that is known. */
static int run_and_tell(struct console *console, const struct verb *verb,
                        const struct options *options)
{
    if (options->json && !file_can_write(options->json, &console->log))
        return verb->failed;
    int status = verb->run(console, options);
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
    for (int i = 0; i < argc && argv[i]; i++) {
        if (strncmp(argv[i], "--json", 6) == 0)
            return true;
    }
    return false;
}

static int run_verb(struct console *console, const struct verb *verb, int argc, char **argv)
{
    struct options options;
    int status = EXIT_USAGE;
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

static int run(struct console *console, int argc, char **argv)
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
    if (strcmp(argv[1], "--describe") == 0) { /* for the manual page, and for the shell */
        printf(
            "program\tdiptych\tone description of a GPU pipeline, run by OpenGL and by Vulkan\n");
        for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++)
            options_describe(&verbs[i]);
        return EXIT_FINE;
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(verbs); i++) {
        if (strcmp(argv[1], verbs[i].name) == 0)
            return run_verb(console, &verbs[i], argc - 2, argv + 2);
    }
    return unknown_verb(console, argv[1]);
}

int main(int argc, char **argv)
{
    struct console console;
    int status = console_open(&console) ? run(&console, argc, argv) : EXIT_FAILED;
    console_close(&console);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "diptych: error: standard output cannot be written\n");
        return EXIT_USAGE;
    }
    return status;
}
