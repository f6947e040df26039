/* The option table and its parser; see options.h. */
#include "base/options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/names.h"

enum option_kind {
    OPTION_FLAG,
    OPTION_STRING,
    OPTION_CHOICE,
    OPTION_COUNT,
    OPTION_INDEX,
    OPTION_NUMBER,
    OPTION_SIZE,
    OPTION_LIST,
    OPTION_TEXTS
};

struct option_row {
    const char *name; /* without a dash: an argument that stands alone */
    enum option_kind kind;
    size_t offset;        /* into struct options */
    unsigned verbs;       /* that take it */
    unsigned required;    /* verbs that cannot do without */
    const char *argument; /* as --help shows it; a choice lists its values with | between */
    const char *help;
};

#define ALL       (VERB_RENDER | VERB_COMPARE)
#define SCENE     (ALL | VERB_REFERENCE | VERB_BENCH | VERB_VIEW)
#define SHOWN     (SCENE | VERB_FLICKER)
#define MOVING    (ALL | VERB_REFERENCE | VERB_FLICKER)
#define SPEC      (ALL | VERB_SWEEP | VERB_BENCH | VERB_VIEW)
#define MAKING    (SPEC | VERB_REPORT)
#define TELLING   (SHOWN | VERB_SWEEP | VERB_REPORT | VERB_METRICS | VERB_REPLAY)
#define COMPARING (VERB_COMPARE | VERB_SWEEP)
#define TRACING   (VERB_REFERENCE | VERB_REPORT | VERB_SWEEP)
#define AT(field) offsetof(struct options, field)

static const struct option_row rows[] = {
    {"DIR", OPTION_STRING, AT(folder), VERB_REPLAY, VERB_REPLAY, NULL,
     "folder that compare --bisect wrote"},
    {"--scene", OPTION_STRING, AT(scene), SHOWN, SHOWN, "FILE",
     "scene file (YAML): mesh, camera, light"},
    {"--motion", OPTION_STRING, AT(motion), MOVING, 0, "FILE",
     "camera and light move from frame to frame, by keyframes (YAML)"},
    {"--backend", OPTION_STRING, AT(backend), VERB_RENDER | VERB_REPLAY, VERB_RENDER | VERB_REPLAY,
     "NAME",
     "gl (OpenGL 4.6), vk (Vulkan 1.3), osmesa or zink; gl+glsl: from GLSL text; vk@DEVICE"},
    {"--backend", OPTION_STRING, AT(backend), COMPARING, 0, "LIST",
     "the first is held against each of the others, like gl,vk,zink (default: gl,vk)"},
    {"--backend", OPTION_STRING, AT(backend), VERB_BENCH | VERB_REPORT, 0, "LIST",
     "which to measure, turn by turn, like gl,vk,zink (default: gl,vk)"},
    {"--backend", OPTION_STRING, AT(backend), VERB_VIEW, 0, "NAME|both",
     "gl or vk; both, or two with a comma: side by side, the first draws the window (default: gl)"},
    {"-o", OPTION_STRING, AT(output), VERB_RENDER, 0, "FILE",
     "picture: .exr linear, .png tone-mapped, of every frame where it has a %04d; --dump or "
     "--timings may stand alone"},
    {"--spec", OPTION_STRING, AT(spec), MAKING, 0, "SPEC",
     "pipeline (default: templates/ssvp.yaml)"},
    {"--set", OPTION_LIST, AT(sets), MAKING, 0, "PATH=VALUE",
     "override a parameter by name or any value by its dotted path; may be repeated"},
    {"--size", OPTION_SIZE, AT(size), (SCENE & ~VERB_VIEW) | VERB_REPORT, 0, "WxH",
     "frame size in pixels (default: 1920x1080)"},
    {"--size", OPTION_SIZE, AT(size), VERB_VIEW, 0, "WxH",
     "pixels of the window, for each backend (default: 960x540)"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_VIEW, 0, "N",
     "end after so many (default: when the window is closed)"},
    {"--screenshot", OPTION_STRING, AT(screenshot), VERB_VIEW, 0, "FILE.png",
     "write what is shown at the end"},
    {"--frames", OPTION_COUNT, AT(frames), ALL, 0, "N",
     "frames to run, the last one is kept (default: 1; with --motion all of it)"},
    {"--frames", OPTION_COUNT, AT(frames), VERB_FLICKER, 0, "N",
     "frames to look at, 2 and up (default: all of the motion)"},
    {"--frame", OPTION_INDEX, AT(frame), VERB_REFERENCE, 0, "K",
     "of the motion, from 0 on (default: 0)"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_BENCH | VERB_REPORT, 0, "N",
     "frames to measure (default: 20)"},
    {"--warmup", OPTION_COUNT, AT(warmup), VERB_BENCH | VERB_REPORT | VERB_SWEEP, 0, "N",
     "frames before these, which are not measured (default: 3)"},
    {"--dump", OPTION_STRING, AT(dump), VERB_RENDER, 0, "DIR",
     "write what every pass of the last frame produced: manifest.json and raw files"},
    {"--timings", OPTION_STRING, AT(timings), VERB_RENDER, 0, "FILE.json",
     "write milliseconds per pass"},
    {"--show", OPTION_STRING, AT(show), VERB_RENDER | VERB_SWEEP, 0, "RESOURCE",
     "make the picture of this image instead"},
    {"--reference", OPTION_STRING, AT(reference), VERB_METRICS, VERB_METRICS, "FILE",
     "the picture that is right: .exr (linear), or .png"},
    {"--test", OPTION_STRING, AT(test), VERB_METRICS, VERB_METRICS, "FILE",
     "the picture to measure"},
    {"-o", OPTION_STRING, AT(output), VERB_METRICS, 0, "DIR",
     "write there flip_ldr.png, flip_hdr.png and what they compare: reference.png, test.png"},
    {"--test", OPTION_STRING, AT(test), VERB_FLICKER, VERB_FLICKER, "PATTERN",
     "linear pictures of all frames, like frame_%04d.exr, of irradiance (render --show)"},
    {"--reference", OPTION_STRING, AT(reference), VERB_FLICKER, 0, "PATTERN",
     "what is right in each of them (reference --quantity irradiance --frame)"},
    {"--block", OPTION_COUNT, AT(block), VERB_FLICKER, 0, "N",
     "average the changes over N x N pixels first, against noise of the reference (default: 1)"},
    {"--exposure", OPTION_NUMBER, AT(exposure), VERB_METRICS, 0, "FACTOR",
     "of both pictures (default: log-average luminance of the reference to 0.18)"},
    {"--flip", OPTION_CHOICE, AT(flip), VERB_METRICS, 0, "all|ldr",
     "leave out FLIP over all exposures, which takes most of the time (default: all)"},
    {"--pixels-per-degree", OPTION_NUMBER, AT(pixels_per_degree), VERB_METRICS, 0, "N",
     "of visual angle (default: 67.02, a 0.7 m wide 4K monitor at 0.7 m)"},
    {"--pictures", OPTION_STRING, AT(pictures), VERB_COMPARE, 0, "DIR",
     "write a PNG strip of each image that differs: one side, the other, the difference"},
    {"--json", OPTION_STRING, AT(json), TELLING, 0, "FILE",
     "also write what was found out, or the errors, as JSON"},
    {"--against", OPTION_STRING, AT(against), VERB_COMPARE, 0, "DIR",
     "a dump, of another machine or driver, is the first side; size and frame are its own"},
    {"--scenes", OPTION_STRING, AT(scenes), SHOWN | VERB_SWEEP | VERB_REPORT, 0, "DIR",
     "where meshes are found (default: DIPTYCH_SCENES)"},
    {"--device", OPTION_STRING, AT(device), SPEC | VERB_REPLAY, 0, "NAME|INDEX",
     "Vulkan device by part of its name or by index"},
    {"--context", OPTION_CHOICE, AT(context), (SPEC & ~VERB_VIEW) | VERB_REPLAY, 0,
     "egl|zink|osmesa|window", "OpenGL context (default: egl)"},
    {"--glsl", OPTION_FLAG, AT(glsl), SPEC | VERB_REPLAY, 0, NULL,
     "give OpenGL the GLSL text instead of SPIR-V"},
    {"--debug", OPTION_FLAG, AT(debug), ALL | VERB_SWEEP | VERB_REPLAY | VERB_VIEW, 0, NULL,
     "validation and KHR_debug; any message fails the run"},
    {"--drop-barrier", OPTION_COUNT, AT(drop_barrier), VERB_RENDER | VERB_COMPARE, 0, "N",
     "leave out the N-th barrier of Vulkan's frame, to see whether --debug misses it; render runs "
     "a "
     "frame more, since looking at passes hides it"},
    {"--drop-dependency", OPTION_COUNT, AT(drop_dependency), VERB_RENDER | VERB_COMPARE, 0, "N",
     "let it change its image's layout, but wait for nothing"},
    {"--bisect", OPTION_STRING, AT(bisect), VERB_COMPARE, 0, "DIR",
     "on a difference, write a folder with all that it takes to run the guilty pass alone"},
    {"--fault", OPTION_STRING, AT(fault), ALL | VERB_SWEEP | VERB_REPLAY, 0,
     "SIDE:PASS:KIND[:SEED][@FRAME]",
     "spoil what a pass of one side writes, to see it found: bit|texel|sign|missing"},
    {"--poison", OPTION_COUNT, AT(poison), VERB_RENDER, 0, "BYTE",
     "1 to 255: fill all memory with it first, to see that no pass reads what nobody wrote"},
    {"-o", OPTION_STRING, AT(output), VERB_REFERENCE, VERB_REFERENCE, "FILE.exr",
     "picture, linear, as render writes it"},
    {"--spp", OPTION_COUNT, AT(spp), TRACING, 0, "N",
     "samples per pixel (default: 256), or the most of them with --noise"},
    {"--noise", OPTION_STRING, AT(noise), TRACING, 0, "TARGET",
     "stop when a pixel's standard error is that part of the picture's mean, like 0.01"},
    {"--bounces", OPTION_STRING, AT(bounces), VERB_REFERENCE | VERB_SWEEP, 0, "N|unlimited",
     "most bounces of indirect light, 0: direct light only (default: 2)"},
    {"--from-bounce", OPTION_STRING, AT(from_bounce), VERB_REFERENCE | VERB_SWEEP, 0, "N",
     "leave out light of fewer bounces, 1: indirect light only (default: 0)"},
    {"--quantity", OPTION_CHOICE, AT(quantity), VERB_REFERENCE | VERB_SWEEP, 0,
     "radiance|irradiance",
     "towards the eye, or at the surface, before its albedo (default: radiance)"},
    {"--filter", OPTION_CHOICE, AT(filter), VERB_REFERENCE, 0, "centre|box",
     "of a pixel: its centre alone, as the rasterizer sees it, or its area (default: centre)"},
    {"--emission", OPTION_FLAG, AT(emission), VERB_REFERENCE, 0, NULL,
     "count the light that materials emit; the shipped pipelines do not"},
    {"--sampler", OPTION_CHOICE, AT(sampler), VERB_REFERENCE, 0, "sobol|random",
     "scrambled Sobol points, or independent numbers (default: sobol)"},
    {"--seed", OPTION_COUNT, AT(seed), VERB_REFERENCE, 0, "N",
     "another number, other noise (default: 1)"},
    {"--threads", OPTION_COUNT, AT(threads), VERB_REFERENCE, 0, "N",
     "they do not change the picture (default: one per processor)"},
    {"--checkpoint", OPTION_STRING, AT(checkpoint), VERB_REFERENCE, 0, "FILE",
     "keep the sums there; where the file exists, go on from it"},
    {"-o", OPTION_STRING, AT(output), VERB_SWEEP, VERB_SWEEP, "DIR",
     "folder of the sweep; one that holds the same sweep is continued"},
    {"--scene", OPTION_TEXTS, AT(scene_list), VERB_SWEEP, 0, "FILE",
     "scene file; may be repeated, random runs take turns, a grid runs on each"},
    {"--random", OPTION_COUNT, AT(random), VERB_SWEEP, 0, "N",
     "N random variations of the spec that are valid"},
    {"--seed", OPTION_COUNT, AT(seed), VERB_SWEEP, 0, "S",
     "--random: the same seed, the same variations, on any machine (default: 1)"},
    {"--memory", OPTION_COUNT, AT(memory), VERB_SWEEP, 0, "MIB",
     "--random: most that the resources of one run may take (default: 64)"},
    {"--grid", OPTION_TEXTS, AT(grid), VERB_SWEEP, 0, "PATH=V1,V2,...",
     "every one of these values; repeated, every combination"},
    {"--size", OPTION_TEXTS, AT(size_list), VERB_SWEEP, 0, "WxH",
     "frame size; may be repeated (default: drawn, of a grid 64x64, to measure 1920x1080)"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_SWEEP, 0, "N",
     "frames of every run (default: drawn, of a grid 1); of times so many are measured, errors are "
     "of the last"},
    {"--measure", OPTION_STRING, AT(measure), VERB_SWEEP, 0, "LIST",
     "agree, time (bench), error (against a path-traced reference), own (against the picture with "
     "the last value), or some of them; rows.csv and plots (default: agree)"},
    {"--x", OPTION_STRING, AT(x), VERB_SWEEP, 0, "PATH",
     "--measure: the grid along the plots, the others make lines (default: the first)"},
    {"--verb", OPTION_CHOICE, AT(verb), VERB_SWEEP, 0, "compare", "what every run does"},
    {"--jobs", OPTION_COUNT, AT(jobs), VERB_SWEEP, 0, "J",
     "runs at a time (default: one per processor)"},
    {"--slurm", OPTION_FLAG, AT(slurm), VERB_SWEEP, 0, NULL,
     "run nothing, write a Slurm job array over the runs and submit.sh"},
    {"--collect", OPTION_FLAG, AT(collect), VERB_SWEEP, 0, NULL,
     "run nothing, sum up the runs of the sweep in DIR that are over"},
    {"-o", OPTION_STRING, AT(output), VERB_REPORT, VERB_REPORT, "DIR",
     "folder of the report; one that holds a report is brought up to date"},
    {"--scene", OPTION_TEXTS, AT(scene_list), VERB_REPORT, 0, "FILE",
     "scene file; may be repeated (default: those of the outline)"},
    {"--collect", OPTION_FLAG, AT(collect), VERB_REPORT, 0, NULL,
     "run nothing, make the page of what there is, while another process goes on, say"},
    {"--outline", OPTION_STRING, AT(outline), VERB_REPORT, 0, "FILE",
     "what to show (default: NAME/report.yaml beside the spec NAME.yaml)"},
    {"--help", OPTION_FLAG, AT(help), SHOWN | VERB_SWEEP | VERB_REPORT | VERB_METRICS | VERB_REPLAY,
     0, NULL, "show this"},
};

enum { ROWS = DT_ARRAY_COUNT(rows) };

static const struct option_row *find_row(const struct verb *verb, const char *name, size_t length)
{
    for (size_t i = 0; i < ROWS; i++) {
        if (!(rows[i].verbs & verb->id) || rows[i].name[0] != '-')
            continue;
        if (strlen(rows[i].name) == length && strncmp(rows[i].name, name, length) == 0)
            return &rows[i];
    }
    if (length == 2 && strncmp(name, "-h", 2) == 0)
        return find_row(verb, "--help", 6);
    return NULL;
}

/* The row of an argument that stands alone and has not been given yet, or NULL. */
static const struct option_row *find_alone(const struct options *options, const struct verb *verb,
                                           const char *argument)
{
    for (size_t i = 0; i < ROWS && argument[0] != '-'; i++) {
        const char *place = (const char *)options + rows[i].offset;
        if ((rows[i].verbs & verb->id) && rows[i].name[0] != '-' &&
            !*(const char *const *)(const void *)place)
            return &rows[i];
    }
    return NULL;
}

static bool unknown_option(const struct verb *verb, const char *argument, size_t length,
                           const struct dt_log *log)
{
    const char *names[ROWS];
    uint32_t count = 0;
    for (size_t i = 0; i < ROWS; i++) {
        if (rows[i].verbs & verb->id)
            names[count++] = rows[i].name;
    }
    char *word = strndup(argument, length);
    const char *hint = word ? closest_name(word, names, count) : NULL;
    if (argument[0] != '-')
        report_error(log, "%s: unexpected argument \"%s\"; see diptych %s --help", verb->name,
                     argument, verb->name);
    else if (hint)
        report_error(log, "%s: unknown option \"%s\"; did you mean \"%s\"?", verb->name, word,
                     hint);
    else
        report_error(log, "%s: unknown option \"%s\"; see diptych %s --help", verb->name, word,
                     verb->name);
    free(word);
    return false;
}

/* A whole number from least to max, ended by `end`; returns what follows it, or NULL. */
static const char *read_count(const char *text, char end, uint32_t least, uint32_t max,
                              uint32_t *value)
{
    if (*text < '0' || *text > '9')
        return NULL;
    char *rest = NULL;
    errno = 0;
    unsigned long number = strtoul(text, &rest, 10);
    if (errno || *rest != end || number < least || number > max)
        return NULL;
    *value = (uint32_t)number;
    return end ? rest + 1 : rest;
}

static bool read_number(const char *text, double *value)
{
    char *rest = NULL;
    double number = strtod(text, &rest);
    if (rest == text || *rest || !(number > 0 && number < HUGE_VAL))
        return false;
    *value = number;
    return true;
}

static bool is_choice(const char *choices, const char *value)
{
    size_t length = strlen(value);
    for (const char *at = choices; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL) {
        if (strcspn(at, "|") == length && strncmp(at, value, length) == 0)
            return true;
    }
    return false;
}

bool option_size(const char *text, uint32_t size[2], const struct dt_log *log)
{
    const char *height = read_count(text, 'x', 1, OPTIONS_MAX_SIZE, &size[0]);
    if (height && read_count(height, 0, 1, OPTIONS_MAX_SIZE, &size[1]))
        return true;
    report_error(log, "--size %s: must be WIDTHxHEIGHT, each from 1 to %d, like 1920x1080", text,
                 OPTIONS_MAX_SIZE);
    return false;
}

static bool append_text(struct text_list *list, const char *text)
{
    const char **grown = realloc(list->items, (list->count + 1) * sizeof *grown);
    if (!grown)
        return false;
    list->items = grown;
    list->items[list->count++] = text;
    return true;
}

static bool append_set(struct options *options, const char *value)
{
    const char **grown = realloc(options->sets, (options->set_count + 1) * sizeof *grown);
    if (!grown)
        return false;
    options->sets = grown;
    options->sets[options->set_count++] = value;
    return true;
}

static bool store(struct options *options, const struct option_row *row, const char *value,
                  const struct dt_log *log)
{
    char *place = (char *)options + row->offset;
    uint32_t *numbers = (uint32_t *)(void *)place;
    switch (row->kind) {
    case OPTION_FLAG:
        *(bool *)place = true;
        return true;
    case OPTION_STRING:
        *(const char **)(void *)place = value;
        return true;
    case OPTION_CHOICE:
        *(const char **)(void *)place = value;
        if (is_choice(row->argument, value))
            return true;
        report_error(log, "%s %s: must be one of %s", row->name, value, row->argument);
        return false;
    case OPTION_COUNT:
    case OPTION_INDEX: {
        uint32_t least = row->kind == OPTION_COUNT ? 1 : 0;
        if (read_count(value, 0, least, OPTIONS_MAX_FRAMES, numbers))
            return true;
        report_error(log, "%s %s: must be a whole number from %u to %d", row->name, value, least,
                     OPTIONS_MAX_FRAMES);
        return false;
    }
    case OPTION_NUMBER:
        if (read_number(value, (double *)(void *)place))
            return true;
        report_error(log, "%s %s: must be a number above 0", row->name, value);
        return false;
    case OPTION_SIZE:
        return option_size(value, numbers, log);
    case OPTION_LIST:
        if (!strchr(value, '=') || value[0] == '=') {
            report_error(log, "%s %s: must be PATH=VALUE, like clusters=16", row->name, value);
            return false;
        }
        if (append_set(options, value))
            return true;
        report_error(log, "out of memory");
        return false;
    case OPTION_TEXTS:
        if (append_text((struct text_list *)(void *)place, value))
            return true;
        report_error(log, "out of memory");
        return false;
    }
    return false;
}

static bool check_required(const struct options *options, const struct verb *verb,
                           const struct dt_log *log)
{
    for (size_t i = 0; i < ROWS; i++) {
        if (!(rows[i].required & verb->id))
            continue;
        if (*(const char *const *)(const void *)((const char *)options + rows[i].offset))
            continue;
        report_error(log, "%s: %s%s%s is missing; see diptych %s --help", verb->name, rows[i].name,
                     rows[i].argument ? " " : "", rows[i].argument ? rows[i].argument : "",
                     verb->name);
        return false;
    }
    return true;
}

/* What a dump would tell. */
static void fill_in(struct options *options, const struct verb *verb)
{
    if (!options->size[0]) {
        options->size[0] = verb->id == VERB_VIEW ? 960 : 1920;
        options->size[1] = verb->id == VERB_VIEW ? 540 : 1080;
    }
    if (!options->motion && !options->frames)
        options->frames = 1;
}

bool options_parse(struct options *options, const struct verb *verb, int argc, char **argv,
                   const struct dt_log *log)
{
    *options = (struct options){.bounces = "2", .from_bounce = "0", .seed = 1};
    for (int i = 0; i < argc; i++) {
        size_t length = argv[i][0] == '-' ? strcspn(argv[i], "=") : strlen(argv[i]);
        const struct option_row *alone = find_alone(options, verb, argv[i]);
        if (alone) {
            if (!store(options, alone, argv[i], log))
                return false;
            continue;
        }
        const struct option_row *row = find_row(verb, argv[i], length);
        if (!row)
            return unknown_option(verb, argv[i], length, log);
        const char *value = argv[i][length] ? argv[i] + length + 1 : NULL;
        if (row->kind == OPTION_FLAG && value) {
            report_error(log, "%s: takes no value", row->name);
            return false;
        }
        if (row->kind != OPTION_FLAG && !value) {
            if (i + 1 == argc) {
                report_error(log, "%s: %s is missing", row->name, row->argument);
                return false;
            }
            value = argv[++i];
        }
        if (!store(options, row, value, log))
            return false;
    }
    if (!options->against)
        fill_in(options, verb);
    return options->help || check_required(options, verb, log);
}

void options_free(struct options *options)
{
    free(options->sets);
    free(options->scene_list.items);
    free(options->size_list.items);
    free(options->grid.items);
    options->sets = NULL;
    options->set_count = 0;
    options->scene_list = options->size_list = options->grid = (struct text_list){0};
}

void options_help(const struct verb *verb)
{
    printf("diptych %s: %s\n\nusage: diptych %s", verb->name, verb->summary, verb->name);
    for (size_t i = 0; i < ROWS; i++) {
        if (rows[i].required & verb->id)
            printf(" %s%s%s", rows[i].name, rows[i].argument ? " " : "",
                   rows[i].argument ? rows[i].argument : "");
    }
    printf(" [options]\n\n");
    for (size_t i = 0; i < ROWS; i++) {
        if (!(rows[i].verbs & verb->id))
            continue;
        int used = printf("  %s %s", rows[i].name, rows[i].argument ? rows[i].argument : "");
        printf("%*s%s\n", used < 30 ? 30 - used : 1, "", rows[i].help);
    }
    printf("\n%s\n", verb->details);
}

static void print_line(const char *text)
{
    for (; *text; text++)
        fputs(*text == '\n' ? "\\n" : (char[]){*text, 0}, stdout);
}

void options_describe(const struct verb *verb)
{
    printf("verb\t%s\t%s\t", verb->name, verb->summary);
    print_line(verb->details);
    putchar('\n');
    for (size_t i = 0; i < ROWS; i++)
        if (rows[i].verbs & verb->id)
            printf("option\t%s\t%s\t%s\t%s\n", rows[i].name,
                   rows[i].argument ? rows[i].argument : "",
                   rows[i].required & verb->id ? "required" : "", rows[i].help);
}
