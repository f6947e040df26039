/* equal-inputs --dump FOLDER [options of render]: runs the last frame of an exact pipeline, and each pass of
 * the same pipeline in fast mode on the exact one's inputs. Writes what the passes left to FOLDER/exact
 * and FOLDER/fast, as `render --dump` does. Exit status 0: written, 2: could not run. Called by
 * exact_fast.py. */
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "app/console/options.h"
#include "app/spec/inputs.h"
#include "app/compare/blame.h"
#include "app/result/dump.h"

enum { EXACT, FAST, MODES };
static const char *const mode_names[MODES] = {"exact", "fast"};

struct mode {
    struct setup setup; /* of the command, with another exactness */
    struct side side;
    struct pipeline pipeline;
    struct dump dump;
    char *folder;
};

static struct {
    struct console console;
    struct options options;
    struct mode modes[MODES];
    struct rows rows;
    struct scene scene;
} run;

/* ---- Pipelines ------------------------------------------------------------------------------- */

static bool load(struct mode *mode, const char *exactness)
{
    const struct dt_log *log = &run.console.log;
    uint32_t count = run.options.setup.set_count;
    mode->setup = run.options.setup;
    mode->setup.sets = calloc(count + 1, sizeof *mode->setup.sets);
    if (!mode->setup.sets)
        return false;
    if (count)
        memcpy(mode->setup.sets, run.options.setup.sets, count * sizeof *run.options.setup.sets);
    mode->setup.sets[count] = exactness;
    mode->setup.set_count = count + 1;
    return side_read(&mode->side, mode->setup.backend, &mode->setup, log) &&
           pipeline_load(&mode->pipeline, &run.console, &mode->setup) &&
           inputs_load(&mode->pipeline, &run.console, &mode->setup);
}

/* The rows of the exact pipeline stand for those of the fast one. */
static bool have_same_rows(void)
{
    const struct dt_pipeline *a = run.modes[EXACT].pipeline.info,
                             *b = run.modes[FAST].pipeline.info;
    bool same = a->pass_count == b->pass_count && a->resource_count == b->resource_count;
    for (uint32_t i = 0; same && i < a->pass_count; i++)
        same = !strcmp(a->passes[i].name, b->passes[i].name) &&
               a->passes[i].write_count == b->passes[i].write_count;
    for (uint32_t i = 0; same && i < a->resource_count; i++)
        same = !strcmp(a->resources[i].name, b->resources[i].name);
    if (!same)
        report_error(&run.console.log, "%s: fast mode has other passes or resources", a->name);
    return same;
}

static bool prepare(void)
{
    struct mode *exact = &run.modes[EXACT];
    if (!load(exact, "exactness=exact") || !load(&run.modes[FAST], "exactness=fast") ||
        !have_same_rows() || !rows_make(&run.rows, exact->pipeline.info, &run.console.log) ||
        !session_load_scene(&run.scene, &run.console, exact->pipeline.info, &exact->setup))
        return false;
    for (int i = 0; i < MODES; i++) {
        struct mode *mode = &run.modes[i];
        mode->setup.frames = session_frames(&mode->setup, &run.scene);
        mode->folder = format_string("%s/%s", run.options.dump, mode_names[i]);
        if (!mode->folder ||
            !dump_begin(&mode->dump, &run.console, exact->pipeline.info, mode->folder))
            return false;
    }
    return true;
}

/* ---- The run --------------------------------------------------------------------------------- */

static bool keep_output(void *user, uint32_t index, const struct dt_bytes copies[2])
{
    const struct row *row = &run.rows.outputs.list[index];
    (void)user;
    for (int i = 0; i < MODES; i++) {
        struct dt_bytes bytes = copies[i];
        if (!dump_add(&run.modes[i].dump, row->pass, row->resource, row->mip, &bytes))
            return false;
    }
    return true;
}

static bool play(void)
{
    struct replay replay = {
        .console = &run.console, .rows = &run.rows, .frame = run.modes[EXACT].setup.frames - 1};
    for (int i = 0; i < MODES; i++) {
        struct mode *mode = &run.modes[i];
        replay.workers[i].session = (struct session_info){.side = &mode->side,
                                                          .console = &run.console,
                                                          .setup = &mode->setup,
                                                          .pipeline = &mode->pipeline,
                                                          .scene = &run.scene,
                                                          .poison = 0x5a};
    }
    return replay_run(&replay, &(struct replay_viewer){.output = keep_output});
}

static void release(bool good)
{
    for (int i = 0; i < MODES; i++) {
        struct mode *mode = &run.modes[i];
        good = dump_end(&mode->dump, good) && good;
        pipeline_unload(&mode->pipeline);
        side_free(&mode->side);
        free(mode->setup.sets);
        free(mode->folder);
    }
    rows_free(&run.rows);
    scene_free(&run.scene);
}

int main(int argc, char **argv)
{
    static const struct verb verb = {.name = "equal-inputs", .id = VERB_RENDER};
    bool good = console_open(&run.console) &&
                options_parse(&run.options, &verb, argc - 1, argv + 1, &run.console.log);
    if (good && !run.options.dump) {
        report_error(&run.console.log, "--dump FOLDER is missing");
        good = false;
    }
    good = good && file_make_folders(run.options.dump, &run.console.log) && prepare() && play();
    release(good);
    options_free(&run.options);
    console_close(&run.console);
    return good && !atomic_load(&run.console.errors) ? EXIT_FINE : EXIT_USAGE;
}
