/* `diptych tune`: finds the fastest of the choices that a spec leaves to the generator and that change
 * no bit: sizes of workgroups, and storage and loops of ranges. Coordinate descent, in all passes at
 * once: a round changes one value in every pass, frames with and without the changes take turns, and
 * each pass keeps its change if that made it faster. At the end, the results of all passes are compared
 * with those of the spec as it is. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "spec/inputs.h"
#include "measure/tune.h"
#include "result/difference.h"
#include "result/rows.h"
#include "run/source.h"

enum { DEFAULT_FRAMES = 9, WARMUP = 2, SWEEPS = 2, PROVEN_FRAMES = 2 };

static struct console *console_of(const struct tuning *tuning)
{
    return tuning->bench.console;
}

/* ---- Pipelines ------------------------------------------------------------------------------- */

static void programme_free(struct programme *programme)
{
    pipeline_unload(&programme->pipeline);
    free(programme->options.setup.sets);
    *programme = (struct programme){0};
}

/* The pipeline with what is kept and with `count` more changes, which win. */
static bool programme_load(const struct tuning *tuning, struct programme *programme,
                           struct choice *const *more, uint32_t count)
{
    const struct options *given = tuning->bench.options;
    const char **sets =
        calloc(given->setup.set_count + tuning->kept_count + count + 1, sizeof *sets);
    uint32_t n = 0;
    *programme = (struct programme){.options = *given};
    programme->options.setup.sets = sets;
    for (uint32_t i = 0; sets && i < given->setup.set_count; i++)
        sets[n++] = given->setup.sets[i];
    for (uint32_t i = 0; sets && i < tuning->kept_count; i++)
        sets[n++] = tuning->kept[i]->set;
    for (uint32_t i = 0; sets && i < count; i++)
        sets[n++] = more[i]->set;
    programme->options.setup.set_count = n;
    if (!sets)
        report_error(&console_of(tuning)->log, "out of memory");
    return sets &&
           pipeline_load(&programme->pipeline, console_of(tuning), &programme->options.setup) &&
           inputs_load(&programme->pipeline, console_of(tuning), &programme->options.setup);
}

/* ---- Choices --------------------------------------------------------------------------------- */

/* A compiler counts any loop as a few turns, so estimates cannot choose between loops and copies. */
static bool take_choice(void *user, uint32_t pass, const char *path, const char *value)
{
    struct tuning *tuning = user;
    uint32_t count = tuning->choice_count, turn = 0;
    const char *last = strrchr(path, '.');
    if (setup_sets(&tuning->bench.options->setup, path) ||
        (tuning->chip && strcmp(last, ".loop") == 0))
        return true;
    struct choice *grown = realloc(tuning->choices, (count + 1) * sizeof *grown);
    if (!grown)
        return false;
    tuning->choices = grown;
    for (uint32_t i = 0; i < count; i++)
        turn += grown[i].pass == pass;
    grown[count] = (struct choice){.pass = pass,
                                   .set = format_string("%s=%s", path, value),
                                   .turn = turn,
                                   .before = NAN,
                                   .after = NAN,
                                   .ratio = NAN};
    tuning->choice_count++;
    return grown[count].set;
}

static bool same_path(const struct choice *a, const struct choice *b)
{
    size_t length = strcspn(a->set, "=") + 1;
    return strncmp(a->set, b->set, length) == 0;
}

void tune_keep(struct tuning *tuning, struct choice *choice)
{
    uint32_t at = 0;
    while (at < tuning->kept_count && !same_path(tuning->kept[at], choice))
        at++;
    if (at < tuning->kept_count)
        tuning->kept[at]->kept = false;
    else
        tuning->kept_count++;
    tuning->kept[at] = choice;
    choice->kept = true;
}

/* ---- Timing ---------------------------------------------------------------------------------- */

static bool run_pair(struct tuning *tuning, struct lane lanes[2], struct programme *const of[2],
                     bool timing)
{
    struct bench *bench = &tuning->bench;
    bool good = true;
    for (int i = 0; i < 2 && good; i++)
        good = lane_start(&lanes[i], bench, &tuning->side, of[i], timing);
    for (uint32_t frame = 0; frame < WARMUP + bench->frames && good; frame++)
        for (int i = 0; i < 2 && good; i++)
            good = lane_advance(&lanes[i], frame >= WARMUP);
    return good;
}

/* Of the second lane to the first, frame by frame: the median, and how many are below 1. */
static double pair_ratio(const struct tuning *tuning, const double *first, const double *second,
                         uint32_t step, uint32_t *faster)
{
    uint32_t frames = tuning->bench.frames;
    double *ratios = calloc(frames, sizeof *ratios), median = NAN;
    *faster = 0;
    for (uint32_t i = 0; ratios && i < frames; i++) {
        ratios[i] = second[(size_t)i * step] / first[(size_t)i * step];
        *faster += ratios[i] < 1;
    }
    if (ratios)
        median = spread_of(ratios, frames, 1).median;
    free(ratios);
    return median;
}

void tune_tell(const struct tuning *tuning, const struct choice *choice)
{
    const char *pass = tuning->first.pipeline.info->passes[choice->pass].name;
    printf("%-20s %-56s ", pass, choice->set);
    if (choice->refused)
        printf("refused: %.*s\n", (int)strcspn(choice->refused, "\n"), choice->refused);
    else
        printf("%9.3f %9.3f %6.2f%s\n", choice->before, choice->after, choice->ratio,
               choice->kept ? "  kept" : "");
    fflush(stdout);
}

static void judge_choice(struct tuning *tuning, const struct lane lanes[2], struct choice *choice)
{
    uint32_t count = lanes[0].info->pass_count, faster;
    const double *first = lanes[0].pass_ms + choice->pass,
                 *second = lanes[1].pass_ms + choice->pass;
    choice->before = bench_pass_ms(&lanes[0], choice->pass).median;
    choice->after = bench_pass_ms(&lanes[1], choice->pass).median;
    choice->ratio = pair_ratio(tuning, first, second, count, &faster);
    if (choice->ratio <= TUNE_MOST_RATIO && 6 * faster >= 5 * tuning->bench.frames)
        tune_keep(tuning, choice);
    tune_tell(tuning, choice);
}

static bool judge_times(struct tuning *tuning, struct programme *trial, struct choice **list,
                        uint32_t count)
{
    struct lane lanes[2] = {0};
    bool good = run_pair(tuning, lanes, (struct programme *[2]){&tuning->now, trial}, true);
    for (uint32_t i = 0; i < count && good; i++)
        judge_choice(tuning, lanes, list[i]);
    for (int i = 0; i < 2; i++)
        lane_free(&lanes[i]);
    return good;
}

/* Loads `now` with what is kept. */
static bool renew(struct tuning *tuning)
{
    programme_free(&tuning->now);
    tune_forget(&tuning->was);
    return programme_load(tuning, &tuning->now, NULL, 0) &&
           (!tuning->chip || tune_estimate(tuning, &tuning->was, &tuning->now));
}

/* Changes of different passes at once. What the generator or the device refuses is found by halves. */
static bool attempt(struct tuning *tuning, struct choice **list, uint32_t count)
{
    struct console *console = console_of(tuning);
    struct programme trial;
    bool captures = console_capture(console);
    bool good = programme_load(tuning, &trial, list, count) &&
                (tuning->chip ? tune_judge_estimates(tuning, &trial, list, count)
                              : judge_times(tuning, &trial, list, count));
    char *said = captures ? console_captured(console) : NULL;
    bool changed = false;
    for (uint32_t i = 0; i < count && good; i++)
        changed |= list[i]->kept;
    programme_free(&trial);
    if (!good && count == 1) {
        list[0]->refused = said ? said : strdup("");
        tune_tell(tuning, list[0]);
        return list[0]->refused;
    }
    free(said);
    if (!good)
        return attempt(tuning, list, count / 2) &&
               attempt(tuning, list + count / 2, count - count / 2);
    return !changed || renew(tuning);
}

/* ---- The search ------------------------------------------------------------------------------ */

/* Milliseconds of each pass of the spec as it is; NAN: not known. */
static bool time_passes(struct tuning *tuning, double *pass_ms)
{
    const struct dt_pipeline *info = tuning->first.pipeline.info;
    struct lane lanes[2] = {0};
    bool good =
        tuning->chip ||
        run_pair(tuning, lanes, (struct programme *[2]){&tuning->first, &tuning->now}, true);
    for (uint32_t i = 0; i < info->pass_count && good; i++)
        pass_ms[i] =
            tuning->chip ? tune_pass_ms(&tuning->was, i) : bench_pass_ms(&lanes[0], i).median;
    for (int i = 0; i < 2; i++)
        lane_free(&lanes[i]);
    return good;
}

/* Drops the choices of passes that take too little of a frame. */
static bool choose_passes(struct tuning *tuning)
{
    const uint32_t passes = tuning->first.pipeline.info->pass_count;
    double *pass_ms = calloc(passes + 1, sizeof *pass_ms), sum = 0;
    uint32_t left = 0;
    bool good = pass_ms && time_passes(tuning, pass_ms);
    for (uint32_t i = 0; i < passes && good; i++)
        sum += isnan(pass_ms[i]) ? 0 : pass_ms[i];
    for (uint32_t i = 0; i < tuning->choice_count && good; i++) {
        struct choice *choice = &tuning->choices[i];
        if (pass_ms[choice->pass] >= TUNE_LEAST_SHARE * sum)
            tuning->choices[left++] = *choice;
        else
            free(choice->set);
    }
    if (good)
        tuning->choice_count = left;
    free(pass_ms);
    return good;
}

static bool has_kept(const struct tuning *tuning, uint32_t pass)
{
    for (uint32_t i = 0; i < tuning->kept_count; i++)
        if (tuning->kept[i]->pass == pass)
            return true;
    return false;
}

/* Each pass changes one value in a round; the next round begins with what was kept. Passes that have kept
 * something are searched again. */
static bool search(struct tuning *tuning)
{
    struct choice **round = calloc(tuning->choice_count + 1, sizeof *round);
    uint32_t most = 0, kept = UINT32_MAX;
    bool good = round;
    tuning->kept = calloc(tuning->choice_count + 1, sizeof *tuning->kept);
    good = good && tuning->kept;
    for (uint32_t i = 0; i < tuning->choice_count; i++)
        most = tuning->choices[i].turn >= most ? tuning->choices[i].turn + 1 : most;
    for (int sweep = 0; sweep < SWEEPS && kept && good; sweep++) {
        kept = 0;
        for (uint32_t turn = 0; turn < most && good; turn++) {
            uint32_t count = 0;
            for (uint32_t i = 0; i < tuning->choice_count; i++) {
                struct choice *choice = &tuning->choices[i];
                if (choice->turn == turn && !choice->kept && !choice->refused &&
                    (sweep == 0 || has_kept(tuning, choice->pass)))
                    round[count++] = choice;
            }
            console_status(console_of(tuning), "sweep %d, round %u of %u", sweep + 1, turn + 1,
                           most);
            good = !count || attempt(tuning, round, count);
            for (uint32_t i = 0; i < count; i++)
                kept += round[i]->kept;
        }
    }
    free(round);
    return good;
}

/* ---- The proof ------------------------------------------------------------------------------- */

static bool same_row(struct tuning *tuning, struct row_source sources[2], const struct row *row,
                     uint32_t frame)
{
    const struct dt_resource *resource = &tuning->first.pipeline.info->resources[row->resource];
    struct dt_bytes copies[2];
    struct difference found;
    for (int i = 0; i < 2; i++)
        if (!source_ask(&sources[i], row) || !source_take(&sources[i], row, &copies[i]))
            return false;
    if (!difference_measure(&found, resource, frame, copies)) {
        report_error(&console_of(tuning)->log, "out of memory");
        return false;
    }
    if (!found.differing && !found.size_differs)
        return true;
    report_error(&console_of(tuning)->log,
                 "%s differs after pass %s: a choice changes bits, which none should; the spec is "
                 "not exact on this device",
                 row->name, tuning->first.pipeline.info->passes[row->pass].name);
    return false;
}

static bool same_frames(struct tuning *tuning, struct row_source sources[2],
                        const struct rows *rows)
{
    uint32_t passes = tuning->first.pipeline.info->pass_count;
    bool good = true;
    for (uint32_t at = 0; at < PROVEN_FRAMES * passes && good; at++) {
        const struct worker_place place = {WORKER_AFTER_PASS, at / passes, at % passes};
        for (int i = 0; i < 2 && good; i++)
            good = source_resume(&sources[i]) && source_reach(&sources[i], place);
        for (uint32_t i = rows->outputs.first[place.pass];
             i < rows->outputs.first[place.pass + 1] && good; i++)
            good = same_row(tuning, sources, &rows->outputs.list[i], place.frame);
        if (place.pass + 1 < passes)
            continue;
        for (int i = 0; i < 2 && good; i++)
            good =
                source_resume(&sources[i]) &&
                source_reach(&sources[i], (struct worker_place){WORKER_FRAME_DONE, place.frame, 0});
    }
    return good;
}

/* Every resource after every pass, with the choices and without. */
static bool prove(struct tuning *tuning)
{
    struct console *console = console_of(tuning);
    struct programme *const of[2] = {&tuning->first, &tuning->now};
    struct row_source sources[2] = {0};
    struct rows rows = {0};
    bool good = rows_make(&rows, tuning->first.pipeline.info, &console->log);
    console_status(console, "comparing the results");
    for (int i = 0; i < 2 && good; i++) {
        const struct worker_info info = {.session = {.side = &tuning->side,
                                                     .console = console,
                                                     .setup = &of[i]->options.setup,
                                                     .pipeline = &of[i]->pipeline,
                                                     .scene = &tuning->bench.scene},
                                         .frames = PROVEN_FRAMES};
        good = source_start(&sources[i], &info, NULL) &&
               source_reach(&sources[i], (struct worker_place){.stop = WORKER_READY});
    }
    good = good && same_frames(tuning, sources, &rows);
    if (good)
        printf("all %u resources of %u passes have the same bits as before, in %d frames\n",
               rows.outputs.count, tuning->first.pipeline.info->pass_count, PROVEN_FRAMES);
    for (int i = 0; i < 2; i++)
        source_close(&sources[i]);
    rows_free(&rows);
    return good;
}

/* ---- The result ------------------------------------------------------------------------------ */

struct whole {
    double before, after, ratio; /* of whole frames; medians, ms */
    char *device;                /* owned */
};

static bool estimate_whole(struct tuning *tuning, struct whole *whole)
{
    struct estimate first = {0};
    bool good = tune_estimate(tuning, &first, &tuning->first);
    if (good) {
        whole->before = tune_frame_ms(&first);
        whole->after = tune_frame_ms(&tuning->was);
        whole->ratio = whole->after / whole->before;
        whole->device = strdup(tuning->chip->product);
        printf(
            "estimates of all passes, one after another: %.3f ms before, %.3f after, %.3f of it\n",
            whole->before, whole->after, whole->ratio);
    }
    tune_forget(&first);
    return good;
}

/* Without timestamps, which can slow a frame down. */
static bool time_whole(struct tuning *tuning, struct whole *whole)
{
    if (tuning->chip)
        return estimate_whole(tuning, whole);
    struct lane lanes[2] = {0};
    uint32_t frames = tuning->bench.frames, faster;
    bool good =
        run_pair(tuning, lanes, (struct programme *[2]){&tuning->first, &tuning->now}, false);
    if (good) {
        whole->before = spread_of(lanes[0].frame_ms, frames, 1).median;
        whole->after = spread_of(lanes[1].frame_ms, frames, 1).median;
        whole->ratio = pair_ratio(tuning, lanes[0].frame_ms, lanes[1].frame_ms, 1, &faster);
        whole->device = strdup(lanes[0].worker.device);
        printf("frame: %.3f ms before, %.3f after, %.3f of it, medians of %u frames in turn\n",
               whole->before, whole->after, whole->ratio, frames);
    }
    for (int i = 0; i < 2; i++)
        lane_free(&lanes[i]);
    return good;
}

/* Changes that noise has kept do not make the whole frame faster. */
static void drop_noise(struct tuning *tuning, const struct whole *whole)
{
    if (!tuning->kept_count || whole->ratio < 1 || tuning->chip)
        return;
    printf("no faster: nothing is kept; give more --frames, or a quieter machine\n");
    for (uint32_t i = 0; i < tuning->kept_count; i++)
        tuning->kept[i]->kept = false;
    tuning->kept_count = 0;
}

static bool write_overlay(const struct tuning *tuning, const struct whole *whole)
{
    const struct options *options = tuning->bench.options;
    struct file_draft draft;
    if (file_draft_begin(&draft, &console_of(tuning)->log)) {
        fprintf(draft.out, "# For --with. By diptych tune: %s on %s, %ux%u pixels: ",
                tuning->first.pipeline.info->name, whole->device ? whole->device : "",
                options->setup.size[0], options->setup.size[1]);
        if (tuning->kept_count)
            fprintf(draft.out, "a frame takes %.3f of its time.\n", whole->ratio);
        else
            fprintf(draft.out, "nothing was faster.\n");
        for (uint32_t i = 0; i < tuning->kept_count; i++)
            fprintf(draft.out, "- %s\n", tuning->kept[i]->set);
    }
    return file_draft_end(&draft, options->output, &console_of(tuning)->log);
}

static cJSON *tuning_json(const struct tuning *tuning, const struct whole *whole)
{
    const struct dt_pipeline *info = tuning->first.pipeline.info;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", info->name);
    cJSON_AddStringToObject(root, "device", whole->device ? whole->device : "");
    bench_add_number(root, "before_ms", whole->before);
    bench_add_number(root, "after_ms", whole->after);
    bench_add_number(root, "ratio", whole->ratio);
    cJSON *tried = cJSON_AddArrayToObject(root, "tried");
    for (uint32_t i = 0; i < tuning->choice_count; i++) {
        const struct choice *choice = &tuning->choices[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "pass", info->passes[choice->pass].name);
        cJSON_AddStringToObject(item, "set", choice->set);
        bench_add_number(item, "before_ms", choice->before);
        bench_add_number(item, "after_ms", choice->after);
        bench_add_number(item, "ratio", choice->ratio);
        cJSON_AddBoolToObject(item, "kept", choice->kept);
        if (choice->refused)
            cJSON_AddStringToObject(item, "refused", choice->refused);
        cJSON_AddItemToArray(tried, item);
    }
    return root;
}

/* ---- The verb -------------------------------------------------------------------------------- */

static bool tune_prepare(struct tuning *tuning, struct options *options)
{
    struct console *console = console_of(tuning);
    if (!file_can_write(options->output, &console->log) ||
        !programme_load(tuning, &tuning->first, NULL, 0))
        return false;
    memcpy(options->setup.size, tuning->first.options.setup.size,
           sizeof options->setup.size); /* of an input */
    if (!session_load_scene(&tuning->bench.scene, console, tuning->first.pipeline.info,
                            &options->setup) ||
        !renew(tuning))
        return false;
    if (plan_choices(tuning->first.pipeline.plan, take_choice, tuning))
        return true;
    report_error(&console->log, "out of memory");
    return false;
}

static void tune_release(struct tuning *tuning)
{
    for (uint32_t i = 0; i < tuning->choice_count; i++) {
        free(tuning->choices[i].set);
        free(tuning->choices[i].refused);
    }
    free(tuning->choices);
    free(tuning->kept);
    tune_forget(&tuning->was);
    scene_free(&tuning->bench.scene);
    programme_free(&tuning->now);
    programme_free(&tuning->first);
    side_free(&tuning->side);
}

/* A device to time frames on; with --gpu, one to prove the bits on. */
static bool choose_side(struct tuning *tuning, const struct options *options)
{
    const struct dt_log *log = &console_of(tuning)->log;
    const char *backend = options->setup.backend;
    if (!backend && !options->gpu)
        report_error(log,
                     "--backend NAME is missing: what to tune for; or --gpu NAME, to estimate");
    else if (!options->gpu ||
             ((tuning->chip = cost_chip(options->gpu, strlen(options->gpu), log)) &&
              cost_has_radv(log)))
        return side_read(&tuning->side, backend ? backend : "vk", &options->setup, log);
    return false;
}

int verb_tune(struct console *console, const struct options *options)
{
    struct options own = *options;
    struct tuning tuning = {
        .bench = {.console = console,
                  .options = &own,
                  .frames = options->run_frames ? options->run_frames : DEFAULT_FRAMES}};
    struct whole whole = {0};
    own.setup.frames = WARMUP + tuning.bench.frames;
    own.setup.for_gpu = options->gpu;
    if (!choose_side(&tuning, &own)) {
        side_free(&tuning.side);
        return EXIT_USAGE;
    }
    bool good = tune_prepare(&tuning, &own) && choose_passes(&tuning);
    if (good)
        printf("%-20s %-56s %9s %9s %6s\n", "pass", "change", "ms before", "after", "ratio");
    good = good && search(&tuning) && prove(&tuning) && time_whole(&tuning, &whole);
    if (good)
        drop_noise(&tuning, &whole);
    good = good && write_overlay(&tuning, &whole);
    if (good)
        console->result = tuning_json(&tuning, &whole);
    free(whole.device);
    tune_release(&tuning);
    return good ? EXIT_FINE : EXIT_FAILED;
}
