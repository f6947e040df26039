/* The option table; see options.h. */
#include "console/options.h"

#include <cjson/cJSON.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console/python.h"
#include "model/sanitize_kinds.h"

#define ALL    (VERB_RENDER | VERB_COMPARE)
#define SCENE  (ALL | VERB_REFERENCE | VERB_BENCH | VERB_VIEW | VERB_TUNE | VERB_COST)
#define SHOWN  (SCENE | VERB_FLICKER)
#define MOVING (ALL | VERB_REFERENCE | VERB_FLICKER | VERB_VIEW)
#define SPEC   (ALL | VERB_SWEEP | VERB_BENCH | VERB_VIEW | VERB_TUNE)
#define MAKING (SPEC | VERB_REPORT | VERB_LIST | VERB_COST)
#define TELLING                                                                                    \
    (SHOWN | VERB_IMPORT | VERB_SWEEP | VERB_REPORT | VERB_METRICS | VERB_REPLAY | VERB_LIST |     \
     VERB_CAPTURE)
#define COMPARING (VERB_COMPARE | VERB_SWEEP)
#define TRACING   (VERB_REFERENCE | VERB_REPORT | VERB_SWEEP)
#define AT(field) offsetof(struct options, field)

static const struct option_row rows[] = {
    {"DIR", OPTION_STRING, AT(folder), VERB_REPLAY, VERB_REPLAY, NULL,
     "folder that compare --bisect wrote"},
    {"A B...", OPTION_TEXTS, AT(dumps), VERB_COMPARE, 0, NULL,
     "folders with dumps of any renderers (diptych_tap.h, render --dump, or PASS.RESOURCE.png, "
     ".exr, .npy), or captures of RenderDoc (.rdc; with --measure several, like a1.rdc,a2.rdc); "
     "the first is compared with each of the others, and nothing is run"},
    {"COMMAND...", OPTION_TEXTS, AT(dumps), VERB_CAPTURE, 0, NULL,
     "the program and its arguments, behind --"},
    {"-o", OPTION_STRING, AT(output), VERB_CAPTURE, VERB_CAPTURE, "FILE.rdc", "capture to write"},
    {"--frame", OPTION_INDEX, AT(frame), VERB_CAPTURE, 0, "N", "frame to capture, from 1"},
    {"--after", OPTION_NUMBER, AT(after), VERB_CAPTURE, 0, "SECONDS",
     "instead: the next frame after this time (default: 3)"},
    {"--env", OPTION_SET, AT(environment), VERB_CAPTURE, 0, "NAME=VALUE",
     "variable of the program's environment; may be repeated"},
    {"FILE", OPTION_STRING, AT(files[0]), VERB_IMPORT, VERB_IMPORT, NULL,
     "a preset of RetroArch (.slangp), or a shader of GLSL, HLSL or SPIR-V: .comp, .frag, .vert, "
     ".hlsl, .spv"},
    {"FRAGMENT", OPTION_STRING, AT(files[1]), VERB_IMPORT, 0, NULL,
     "the fragment shader, if FILE is a vertex shader"},
    {"-o", OPTION_STRING, AT(output), VERB_IMPORT, VERB_IMPORT, "DIR",
     "folder to write: a spec, and copies of the shaders and pictures"},
    {"--picture", OPTION_STRING, AT(picture), VERB_IMPORT, 0, "FILE",
     "picture that the shaders read (default: a test card)"},
    {"--contracts", OPTION_STRING, AT(contracts), VERB_COMPARE, 0, "FILE",
     "how far resources may differ (YAML), like `radiance: {rel: 1e-3}`, in place of the spec's "
     "contracts (A B: default: integers not at all, others 1 ulp)"},
    {"--measure", OPTION_COUNT, AT(repeats), VERB_COMPARE, 0, "N",
     "run each side N times, and show how far runs of a side, and of both sides, are apart; A B: "
     "each folder holds N dumps in folders of their own"},
    {"--write-contracts", OPTION_STRING, AT(write_contracts), VERB_COMPARE, 0, "FILE",
     "--measure: write contracts that all these runs keep, and that are as tight as that"},
    {"DIR", OPTION_STRING, AT(folder), VERB_REPORT, 0, NULL,
     "with --collect: folder that a bundle's `run` left; the page goes there"},
    {"VERB", OPTION_STRING, AT(topic), VERB_HELP, 0, NULL, "verb to describe (default: list all)"},
    {"--scene", OPTION_STRING, AT(setup.scene), VERB_REFERENCE | VERB_FLICKER,
     VERB_REFERENCE | VERB_FLICKER, "FILE",
     "scene file (YAML): mesh, camera, light; or the name of a shipped one: cornell"},
    {"--scene", OPTION_STRING, AT(setup.scene), SPEC & ~VERB_SWEEP, 0, "FILE",
     "scene file (YAML): mesh, camera, light; or cornell, which is shipped; needed if the pipeline "
     "draws or reads the scene"},
    {"--scene", OPTION_STRING, AT(setup.scene), VERB_COST, 0, "FILE",
     "scene file, whose triangles are counted"},
    {"--gpu", OPTION_STRING, AT(gpu), VERB_COST, 0, "LIST",
     "chips, like navi21,polaris10 (default: navi21)"},
    {"--motion", OPTION_STRING, AT(setup.motion), MOVING, 0, "FILE",
     "keyframes (YAML) that move camera and light from frame to frame"},
    {"--backend", OPTION_STRING, AT(setup.backend), VERB_RENDER | VERB_REPLAY | VERB_TUNE,
     VERB_RENDER | VERB_REPLAY, "NAME",
     "gl (OpenGL 4.6), vk (Vulkan 1.3), osmesa or zink; gl+glsl: from GLSL text; vk@DEVICE"},
    {"--backend", OPTION_STRING, AT(setup.backend), COMPARING, 0, "LIST",
     "backends; the first is compared with each of the others, like gl,vk,zink (default: gl,vk)"},
    {"--backend", OPTION_STRING, AT(setup.backend), VERB_BENCH | VERB_REPORT, 0, "LIST",
     "backends to measure in turn, like gl,vk,zink (default: gl,vk)"},
    {"--backend", OPTION_STRING, AT(setup.backend), VERB_VIEW, 0, "NAME|both",
     "one to three backends, like gl,vk,vk@NAME; the first is compared with "
     "each of the others (default: both, gl,vk)"},
    {"-o", OPTION_STRING, AT(output), VERB_RENDER, 0, "FILE",
     "picture: .exr linear, .png tone-mapped; with %04d in the name, one for each frame; not "
     "needed with --dump, --timings or --capture"},
    {"--gpu", OPTION_STRING, AT(gpu), VERB_TUNE, 0, "NAME",
     "estimate for this chip, as `cost` does, instead of timing; --backend, if given, says where "
     "the bits are compared (default: vk)"},
    {"--spec", OPTION_STRING, AT(setup.spec), MAKING, 0, "SPEC",
     "pipeline: a file, or the name of a shipped one, like rsm (default: ssvp)"},
    {"--set", OPTION_SET, AT(setup.set_list), MAKING, 0, "PATH=VALUE",
     "override a parameter by name or any value by its dotted path; may be repeated"},
    {"--with", OPTION_STRING, AT(with), MAKING, 0, "FILE",
     "overrides from a file, before those of --set: lines `- PATH=VALUE`, as `tune` writes them"},
    {"--input", OPTION_SET, AT(setup.inputs), SPEC | VERB_REPORT | VERB_COST | VERB_LIST, 0,
     "NAME=FILE",
     "content of an input of the pipeline: a picture (PNG, JPEG, OpenEXR, HDR) for an image, a "
     ".npy array for a buffer; may be repeated"},
    {"--size", OPTION_SIZE, AT(setup.size), (SCENE & ~VERB_VIEW) | VERB_REPORT | VERB_LIST, 0,
     "WxH",
     "frame size in pixels (default: that of an --input that fills the frame, else 1920x1080)"},
    {"--size", OPTION_SIZE, AT(setup.size), VERB_VIEW, 0, "WxH",
     "frame size in pixels (default: the room in the window)"},
    {"--window", OPTION_SIZE, AT(window), VERB_VIEW, 0, "WxH",
     "size of the window (default: as it was the last time, at first 1280x720)"},
    {"--present", OPTION_STRING, AT(present), VERB_VIEW, 0, "FILE.png",
     "photograph the window as it is at the end, panes and all"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_VIEW, 0, "N",
     "frames to run (default: until the window is closed)"},
    {"--screenshot", OPTION_STRING, AT(screenshot), VERB_VIEW, 0, "FILE.png",
     "write the last picture shown, without the panes"},
    {"--frames", OPTION_COUNT, AT(setup.frames), ALL, 0, "N",
     "frames to run; the result is the last one (default: 1; with --motion all of it)"},
    {"--frames", OPTION_COUNT, AT(setup.frames), VERB_FLICKER, 0, "N",
     "frames to compare, at least 2 (default: all of the motion)"},
    {"--frame", OPTION_INDEX, AT(frame), VERB_REFERENCE, 0, "K",
     "frame of the motion, from 0 (default: 0)"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_BENCH | VERB_REPORT, 0, "N",
     "frames to measure (default: 20)"},
    {"--warmup", OPTION_COUNT, AT(warmup), VERB_BENCH | VERB_REPORT | VERB_SWEEP, 0, "N",
     "frames to run before, not measured (default: 3)"},
    {"--dump", OPTION_STRING, AT(dump), VERB_RENDER, 0, "DIR",
     "write what every pass of the last frame produced: manifest.json and raw files"},
    {"--timings", OPTION_STRING, AT(timings), VERB_RENDER, 0, "FILE.json",
     "write milliseconds per pass"},
    {"--capture", OPTION_STRING, AT(setup.capture), VERB_RENDER, 0, "FILE.rdc",
     "write the last frame for RenderDoc, with names of passes; without -o and --dump nothing else "
     "is in it; needs librenderdoc.so"},
    {"--show", OPTION_STRING, AT(show), VERB_RENDER | VERB_SWEEP, 0, "RESOURCE",
     "image to make the picture of, instead of the output"},
    {"--reference", OPTION_STRING, AT(reference), VERB_METRICS, VERB_METRICS, "FILE",
     "the reference picture: .exr (linear), or .png"},
    {"--test", OPTION_STRING, AT(test), VERB_METRICS, VERB_METRICS, "FILE",
     "the picture to measure; with %04d in the name, pictures of --frames frames"},
    {"--frames", OPTION_COUNT, AT(setup.frames), VERB_METRICS, 0, "N",
     "frames to measure, from 0: means over them, and standard errors (default: 1)"},
    {"-o", OPTION_STRING, AT(output), VERB_METRICS, 0, "DIR",
     "folder for the error maps flip_ldr.png, flip_hdr.png and the tone-mapped reference.png, "
     "test.png"},
    {"--test", OPTION_STRING, AT(test), VERB_FLICKER, VERB_FLICKER, "PATTERN",
     "linear pictures of all frames, like frame_%04d.exr, of irradiance (render --show)"},
    {"--reference", OPTION_STRING, AT(reference), VERB_FLICKER, 0, "PATTERN",
     "reference pictures of the same frames (reference --quantity irradiance --frame)"},
    {"--block", OPTION_COUNT, AT(block), VERB_FLICKER, 0, "N",
     "average changes over N x N pixels first, which reduces noise of the reference (default: 1)"},
    {"--exposure", OPTION_NUMBER, AT(exposure), VERB_METRICS, 0, "FACTOR",
     "exposure of both pictures (default: log-average luminance of the reference becomes 0.18)"},
    {"--flip", OPTION_CHOICE, AT(flip), VERB_METRICS, 0, "all|ldr",
     "ldr: no FLIP over all exposures, which takes most of the time (default: all)"},
    {"--pixels-per-degree", OPTION_NUMBER, AT(pixels_per_degree), VERB_METRICS, 0, "N",
     "pixels per degree of visual angle (default: 67.02, a 0.7 m wide 4K monitor at 0.7 m)"},
    {"--pictures", OPTION_STRING, AT(pictures), VERB_COMPARE, 0, "DIR",
     "write a PNG strip of each image that differs: first side, second side, difference"},
    {"--html", OPTION_STRING, AT(html), VERB_COMPARE, 0, "DIR",
     "write a page: of each image both sides, by slider and in turn, and their difference"},
    {"--junit", OPTION_STRING, AT(junit), VERB_COMPARE, 0, "FILE",
     "write a test case per resource, as JUnit's XML"},
    {"--golden", OPTION_STRING, AT(golden), VERB_COMPARE, 0, "DIR",
     "also compare the first side with the hashes in this folder, which set size and frames"},
    {"--update", OPTION_FLAG, AT(update), VERB_COMPARE, 0, NULL,
     "--golden: write the folder, with hashes and pictures, if the sides agree"},
    {"--json", OPTION_STRING, AT(json), TELLING, 0, "FILE",
     "also write the result, or the errors, as JSON"},
    {"--against", OPTION_STRING, AT(setup.against), VERB_COMPARE, 0, "DIR",
     "use a dump, of any machine or driver, as the first side; it sets size and frame"},
    {"--scenes", OPTION_STRING, AT(setup.scenes), SHOWN | VERB_SWEEP | VERB_REPORT, 0, "DIR",
     "folder with meshes (default: DIPTYCH_SCENES); a file has at most 4 GiB, a texture 67 million "
     "pixels"},
    {"--device", OPTION_STRING, AT(setup.device), SPEC | VERB_REPLAY, 0, "NAME|INDEX",
     "Vulkan device by part of its name or by index"},
    {"--device", OPTION_STRING, AT(setup.device), VERB_COST, 0, "NAME|INDEX",
     "instead: what the compiler of this Vulkan device tells"},
    {"--against", OPTION_STRING, AT(earlier), VERB_COST, 0, "FILE.json",
     "tell what has changed since an earlier --json"},
    {"--bench", OPTION_STRING, AT(bench), VERB_COST, 0, "FILE.json",
     "times that `bench --json` measured on this device, or on one with this chip, beside the "
     "bounds"},
    {"--limit", OPTION_STRING, AT(limit), VERB_COST, 0, "PERCENT",
     "--against: growth of cycles and spills, or loss of waves, that ends with status 1 (default: "
     "5%)"},
    {"--context", OPTION_CHOICE, AT(setup.context), (SPEC & ~VERB_VIEW) | VERB_REPLAY, 0,
     "egl|zink|osmesa|window", "OpenGL context (default: egl)"},
    {"--glsl", OPTION_FLAG, AT(setup.glsl), SPEC | VERB_REPLAY, 0, NULL,
     "give OpenGL the GLSL text instead of SPIR-V"},
    {"--trust", OPTION_FLAG, AT(trust), VERB_REPLAY, 0, NULL,
     "without a sandbox: the folder's shaders are yours"},
    {"--trust", OPTION_FLAG, AT(trust), VERB_COMPARE, 0, NULL,
     "captures: without a sandbox, on this machine's drivers: the captures are yours"},
    {"--match", OPTION_STRING, AT(match), VERB_COMPARE, 0, "FILE",
     "captures: which passes and resources belong together, as JSON; written if it is not there, "
     "else read"},
    {"--draws", OPTION_STRING, AT(draws), VERB_COMPARE, 0, "PASS",
     "captures: compare after every draw of the pass that the table shows with this number"},
    {"--save", OPTION_STRING, AT(save), VERB_COMPARE, 0, "DIR",
     "captures: write the shaders and inputs of the first pass that differs, of both sides"},
    {"--debug", OPTION_FLAG, AT(setup.debug), ALL | VERB_SWEEP | VERB_REPLAY | VERB_VIEW, 0, NULL,
     "validation layers and KHR_debug; any message fails the run"},
    {"--bisect", OPTION_STRING, AT(bisect), VERB_COMPARE, 0, "DIR",
     "on a difference, write a folder from which `replay` runs the guilty pass alone"},
    {"--sanitize", OPTION_WORDS, AT(setup.sanitize), ALL | VERB_REPLAY | VERB_VIEW, 0, "KINDS",
     "report undefined behaviour of shaders, in file and line; --sanitize=KINDS: some "
     "of " SANITIZE_WORDS},
    {"--repeat", OPTION_COUNT, AT(repeat), VERB_COMPARE, 0, "N",
     "run each backend N times more, Mesa's software drivers with other numbers of threads, and "
     "count the distinct results of each pass"},
    {"-o", OPTION_STRING, AT(output), VERB_REFERENCE, VERB_REFERENCE, "FILE.exr",
     "picture, linear, as render writes it"},
    {"--spp", OPTION_COUNT, AT(spp), TRACING, 0, "N",
     "samples per pixel, with --noise at most (default: 256)"},
    {"--noise", OPTION_STRING, AT(noise), TRACING, 0, "TARGET",
     "stop at this standard error of a pixel, relative to the picture's mean, like 0.01"},
    {"--bounces", OPTION_STRING, AT(bounces), VERB_REFERENCE | VERB_SWEEP, 0, "N|unlimited",
     "most bounces of indirect light, 0: direct light only (default: 2)"},
    {"--from-bounce", OPTION_STRING, AT(from_bounce), VERB_REFERENCE | VERB_SWEEP, 0, "N",
     "leave out light of fewer bounces, 1: indirect light only (default: 0)"},
    {"--quantity", OPTION_CHOICE, AT(quantity), VERB_REFERENCE | VERB_SWEEP, 0,
     "radiance|irradiance",
     "radiance towards the eye, or irradiance at the surface, without its albedo (default: "
     "radiance)"},
    {"--filter", OPTION_CHOICE, AT(filter), VERB_REFERENCE, 0, "centre|box",
     "sample the centre of a pixel, as the rasterizer does, or its area (default: box for radiance "
     "of a scene with textures, which rasterizers filter; else centre)"},
    {"--vpls", OPTION_STRING, AT(vpls), VERB_REFERENCE, 0, "FILE.npy",
     "exact rays from these virtual point lights in place of paths: a structured array with "
     "position, normal, flux, disk, eye, near_square (app/truth/vpls.h)"},
    {"--emission", OPTION_FLAG, AT(emission), VERB_REFERENCE, 0, NULL,
     "include emission of materials, which the shipped pipelines leave out"},
    {"--sampler", OPTION_CHOICE, AT(sampler), VERB_REFERENCE, 0, "sobol|random",
     "scrambled Sobol points, or independent numbers (default: sobol)"},
    {"--seed", OPTION_COUNT, AT(seed), VERB_REFERENCE, 0, "N", "seed of the noise (default: 1)"},
    {"--threads", OPTION_COUNT, AT(threads), VERB_REFERENCE, 0, "N",
     "number of threads; does not change the picture (default: one per processor)"},
    {"--checkpoint", OPTION_STRING, AT(checkpoint), VERB_REFERENCE, 0, "FILE",
     "save the state there; continue from the file if it exists"},
    {"-o", OPTION_STRING, AT(output), VERB_SWEEP, VERB_SWEEP, "DIR",
     "folder of the sweep; one that holds a sweep is brought up to date"},
    {"--scene", OPTION_TEXTS, AT(scene_list), VERB_SWEEP, 0, "FILE",
     "scene file; may be repeated: the grid runs on each; needed by --measure error, and if the "
     "pipeline draws or reads the scene"},
    {"--grid", OPTION_TEXTS, AT(grid), VERB_SWEEP, 0, "PATH=V1,V2,...",
     "run each of these values; may be repeated: runs every combination"},
    {"--size", OPTION_TEXTS, AT(size_list), VERB_SWEEP, 0, "WxH",
     "frame size; may be repeated (default: that of an --input; else 64x64; --measure: 1920x1080)"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_SWEEP, 0, "N",
     "frames of each run (default: 1); times are of all of them, errors of the last"},
    {"--every-frame", OPTION_FLAG, AT(every_frame), VERB_SWEEP, 0, NULL,
     "--measure error: errors are means over all frames, with standard errors"},
    {"--measure", OPTION_STRING, AT(measure), VERB_SWEEP, 0, "LIST",
     "one or more of agree, time (bench), error (against a path-traced reference), own (against "
     "the picture with the last value); writes rows.csv and plots (default: agree)"},
    {"--x", OPTION_STRING, AT(x), VERB_SWEEP, 0, "PATH",
     "--measure: the --grid on the x axis of plots; the others become lines (default: the first)"},
    {"--jobs", OPTION_COUNT, AT(jobs), VERB_SWEEP | VERB_REPORT, 0, "J",
     "runs at a time; what is timed runs alone (default: comparisons: one per processor; else 1)"},
    {"--profile", OPTION_STRING, AT(profile), VERB_SWEEP | VERB_REPORT, 0, "NAME",
     "run on a cluster: Snakemake's profile of the site"},
    {"--collect", OPTION_FLAG, AT(collect), VERB_SWEEP, 0, NULL,
     "do not run; summarise the finished runs of the sweep in DIR"},
    {"-o", OPTION_STRING, AT(output), VERB_REPORT, 0, "DIR",
     "folder of the report; one that holds a report is brought up to date"},
    {"--scene", OPTION_TEXTS, AT(scene_list), VERB_REPORT, 0, "FILE",
     "scene file; may be repeated (default: those of the outline)"},
    {"--collect", OPTION_FLAG, AT(collect), VERB_REPORT, 0, NULL,
     "make the page from the results that are there and run nothing; another process may still "
     "be measuring; with DIR: from the results of a bundle"},
    {"--outline", OPTION_STRING, AT(outline), VERB_REPORT, 0, "FILE",
     "what the page shows (default: NAME/report.yaml beside the spec NAME.yaml)"},
    {"-o", OPTION_STRING, AT(output), VERB_TUNE, VERB_TUNE, "FILE.yaml",
     "what was found, for --with of diptych and of diptych-gen"},
    {"--frames", OPTION_COUNT, AT(run_frames), VERB_TUNE, 0, "N",
     "frames to measure each change with (default: 9)"},
    {"--help", OPTION_FLAG, AT(help), TELLING | VERB_HELP, 0, NULL, "show this"},
};

static struct command_line command_of(const struct verb *verb)
{
    return (struct command_line){.program = "diptych",
                                 .verb = verb->name,
                                 .bit = verb->id,
                                 .summary = verb->summary,
                                 .details = verb->details,
                                 .rows = rows,
                                 .row_count = DT_ARRAY_COUNT(rows)};
}

/* Defaults of options that a dump of --against, or --golden, would set. */
static void fill_in(struct options *options, const struct verb *verb)
{
    if (!options->setup.size[0]) {
        options->setup.default_size = true;
        options->setup.size[0] = verb->id == VERB_VIEW ? 960 : 1920;
        options->setup.size[1] = verb->id == VERB_VIEW ? 540 : 1080;
    }
    if (!options->setup.motion && !options->setup.frames)
        options->setup.frames = 1;
}

bool options_parse(struct options *options, const struct verb *verb, int argc, char **argv,
                   const struct dt_log *log)
{
    *options = (struct options){.bounces = "2", .from_bounce = "0", .seed = 1};
    const struct command_line command = command_of(verb);
    if (!command_parse(&command, options, argc, argv, log) ||
        (options->with && !options->help &&
         !command_overlay(&options->setup.set_list, options->with, &options->with_text, log)))
        return false;
    if (!options->setup.against && (!options->golden || options->update))
        fill_in(options, verb);
    return options->help || command_is_complete(&command, options, log);
}

/* -o is "output", --from-bounce "from_bounce", DIR "dir", "A B..." "a_b". */
static void key_of(const struct option_row *row, char key[32])
{
    const char *name = row->name + strspn(row->name, "-");
    snprintf(key, 32, "%s", strcmp(row->name, "-o") == 0 ? "output" : name);
    key[strcspn(key, ".")] = 0;
    for (; *key; key++)
        *key = (char)(*key == '-' || *key == ' ' ? '_' : tolower((unsigned char)*key));
}

/* The value of an option; NULL: it was not given and has no default. */
static cJSON *value_of(const struct option_row *row, const void *field)
{
    const struct text_list *list = field;
    const uint32_t *numbers = field;
    char text[32];
    switch (row->kind) {
    case OPTION_FLAG:
        return *(const bool *)field ? cJSON_CreateTrue() : NULL;
    case OPTION_COUNT:
    case OPTION_INDEX:
        return *numbers ? cJSON_CreateNumber(*numbers) : NULL;
    case OPTION_NUMBER:
        return *(const double *)field ? cJSON_CreateNumber(*(const double *)field) : NULL;
    case OPTION_SIZE:
        snprintf(text, sizeof text, "%ux%u", numbers[0], numbers[1]);
        return numbers[0] ? cJSON_CreateString(text) : NULL;
    case OPTION_SET:
    case OPTION_TEXTS:
        return list->count ? cJSON_CreateStringArray(list->items, (int)list->count) : NULL;
    default:
        return *(const char *const *)field ? cJSON_CreateString(*(const char *const *)field) : NULL;
    }
}

cJSON *options_json(const struct options *options, enum verb_id verb)
{
    cJSON *root = cJSON_CreateObject();
    for (size_t i = 0; i < DT_ARRAY_COUNT(rows); i++) {
        char key[32];
        bool is_default = rows[i].offset == AT(setup.size) && options->setup.default_size;
        cJSON *value = (rows[i].verbs & verb) && !is_default
                           ? value_of(&rows[i], (const char *)options + rows[i].offset)
                           : NULL;
        key_of(&rows[i], key);
        if (value)
            cJSON_AddItemToObject(root, key, value);
    }
    return root;
}

void options_free(struct options *options)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(rows); i++) {
        struct text_list *list = (void *)((char *)options + rows[i].offset);
        if (rows[i].kind != OPTION_SET && rows[i].kind != OPTION_TEXTS)
            continue;
        free(list->items);
        *list = (struct text_list){0};
    }
    free(options->with_text);
}

void options_help(const struct verb *verb)
{
    const struct command_line command = command_of(verb);
    command_help(&command);
}

void options_describe(const struct verb *verb)
{
    const struct command_line command = command_of(verb);
    command_describe(&command);
}
