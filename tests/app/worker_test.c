/* Worker processes and the blame, with runtimes that are made here and go wrong on demand: they
 * crash, leave out a pass, write something else on every run, begin with the wrong history. The
 * test puts the fault in, so the expected result is known. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/lib/unit.h"
#include "app/spec/inputs.h"
#include "app/compare/blame.h"

/* ---- A pipeline: numbers[i] = 10 * frame + i; doubled = 2 * numbers; kept += doubled ---------- */

enum { NUMBERS, DOUBLED, KEPT, RESOURCES };
enum { COUNT, DOUBLE, KEEP, PASSES };
enum { ELEMENTS = 4 };

static void four(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                 uint32_t height, uint32_t extent[3])
{
    (void)pipeline, (void)resource, (void)width, (void)height;
    extent[0] = ELEMENTS;
    extent[1] = extent[2] = 1;
}

static const struct dt_field number[] = {{"", DT_TYPE_UINT, 0, 0, 0}};
static struct dt_resource resources[] = {
    {.name = "numbers", .fields = number, .field_count = 1, .stride = 4},
    {.name = "doubled", .fields = number, .field_count = 1, .stride = 4},
    {.name = "kept", .fields = number, .field_count = 1, .stride = 4, .history = true}};
static const uint16_t lists[RESOURCES] = {NUMBERS, DOUBLED, KEPT};
static const struct dt_pass passes[] = {
    {.name = "count", .writes = &lists[NUMBERS], .write_count = 1},
    {.name = "double",
     .reads = &lists[NUMBERS],
     .read_count = 1,
     .writes = &lists[DOUBLED],
     .write_count = 1},
    {.name = "keep",
     .reads = &lists[DOUBLED],
     .read_count = 1,
     .writes = &lists[KEPT],
     .write_count = 1}};
static const struct dt_pipeline pipeline_info = {.name = "made",
                                                 .extent = four,
                                                 .resources = resources,
                                                 .resource_count = RESOURCES,
                                                 .passes = passes,
                                                 .pass_count = PASSES};

static const struct dt_program made_programs[PASSES];
static const struct dt_panel made_panel = {.pipeline = &pipeline_info, .programs = made_programs};
static const struct dt_shaders made_shaders = {.panel = &made_panel};

/* ---- Two runtimes ------------------------------------------------------------------------------- */

enum trouble {
    NO_TROUBLE,
    CRASH,  /* in the pass */
    EXIT,   /* in the pass */
    KILLED, /* in the pass */
    CRASH_OPEN,
    CRASH_CLOSE,
    REFUSE_OPEN, /* with an error */
    REFUSE_READ,
    LEAVE_OUT, /* the pass */
    WRONG,     /* the pass adds one to its first number */
    STRAY,     /* the pass adds the process's number */
    WRONG_START
};

struct script {
    enum trouble trouble;
    uint32_t pass, frame; /* from this frame on */
};

static struct script scripts[2]; /* of gl and vk; a worker has them as they were when it started */

struct made {
    struct dt_log log;
    const struct script *script;
    uint32_t data[RESOURCES][ELEMENTS];
};

static _Noreturn void end_by(int number)
{
    signal(number, SIG_DFL);
    raise(number);
    abort();
}

static void say(const struct made *made, const char *text)
{
    made->log.message(made->log.user, DT_ERROR, text);
}

static void *open_as(const struct dt_runtime_options *options, const struct script *script)
{
    struct made *made = calloc(1, sizeof *made);
    made->log = options->log;
    made->script = script;
    memset(made->data[NUMBERS], options->poison, sizeof made->data[NUMBERS]);
    memset(made->data[DOUBLED], options->poison, sizeof made->data[DOUBLED]);
    if (script->trouble == CRASH_OPEN)
        end_by(SIGSEGV);
    if (script->trouble == REFUSE_OPEN) {
        say(made, "no such device");
        free(made);
        return NULL;
    }
    if (script->trouble == WRONG_START)
        made->data[KEPT][0] = 5;
    return made;
}

static void *open_gl(const struct dt_runtime_options *options)
{
    return open_as(options, &scripts[0]);
}

static void *open_vk(const struct dt_runtime_options *options)
{
    return open_as(options, &scripts[1]);
}

static const struct dt_device *device(void *runtime)
{
    static const struct dt_device made = {
        .name = "a made device", .driver = "a made device", .software = true};
    (void)runtime;
    return &made;
}

static bool takes_gpu(void *runtime, const struct dt_panel *panel)
{
    (void)runtime;
    (void)panel;
    return false;
}

static bool set_scene(void *runtime, const struct dt_scene *scene)
{
    (void)runtime;
    (void)scene;
    return true;
}

static bool create(void *runtime, const struct dt_shaders *shaders)
{
    (void)runtime;
    (void)shaders;
    return true;
}

static bool resize(void *runtime, uint32_t width, uint32_t height)
{
    (void)runtime;
    (void)width;
    (void)height;
    return true;
}

static void work(struct made *made, uint32_t pass, uint32_t frame)
{
    for (uint32_t i = 0; i < ELEMENTS; i++)
        if (pass == COUNT)
            made->data[NUMBERS][i] = 10 * frame + i;
        else if (pass == DOUBLE)
            made->data[DOUBLED][i] = 2 * made->data[NUMBERS][i];
        else
            made->data[KEPT][i] += made->data[DOUBLED][i];
}

static void go_wrong(struct made *made, uint32_t pass)
{
    switch (made->script->trouble) {
    case CRASH:
        end_by(SIGSEGV);
    case EXIT:
        _exit(3);
    case KILLED:
        end_by(SIGKILL);
    case WRONG:
        made->data[pass][0]++; /* each pass writes the resource of its number */
        break;
    case STRAY:
        made->data[pass][0] += (uint32_t)getpid();
        break;
    default:
        break;
    }
}

static bool render(void *runtime, const struct dt_frame *frame, const void *live,
                   const struct dt_observer *observer)
{
    struct made *made = runtime;
    (void)live;
    for (uint32_t pass = 0; pass < PASSES; pass++) {
        bool due = pass == made->script->pass && frame->index >= made->script->frame;
        if (due && made->script->trouble == LEAVE_OUT)
            continue;
        enum dt_action action = observer && observer->before_pass
                                    ? observer->before_pass(observer->user, pass)
                                    : DT_RUN;
        if (action == DT_STOP)
            return false;
        if (action == DT_RUN)
            work(made, pass, frame->index);
        if (due)
            go_wrong(made, pass);
        if (observer && !observer->after_pass(observer->user, pass))
            return false;
    }
    return true;
}

static bool read_resource(void *runtime, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct made *made = runtime;
    (void)mip;
    if (made->script->trouble == REFUSE_READ) {
        say(made, "nothing to read");
        return false;
    }
    *out = (struct dt_bytes){.size = sizeof made->data[resource], .extent = {ELEMENTS, 1, 1}};
    out->data = malloc(out->size);
    memcpy(out->data, made->data[resource], out->size);
    return true;
}

static bool write_resource(void *runtime, uint32_t resource, uint32_t mip,
                           const struct dt_bytes *bytes)
{
    struct made *made = runtime;
    (void)mip;
    if (bytes->size != sizeof made->data[resource] || bytes->extent[0] != ELEMENTS)
        return false;
    memcpy(made->data[resource], bytes->data, bytes->size);
    return true;
}

static bool timings(void *runtime, double *pass_ms)
{
    (void)runtime;
    (void)pass_ms;
    return false;
}

static void close_runtime(void *runtime)
{
    struct made *made = runtime;
    if (made && made->script->trouble == CRASH_CLOSE)
        end_by(SIGABRT);
    free(made);
}

#define MADE_RUNTIME(label, opening)                                                               \
    {                                                                                              \
        .name = (label), .open = (opening), .device = device, .takes_gpu = takes_gpu,              \
        .set_scene = set_scene, .create = create, .resize = resize, .render = render,              \
        .read = read_resource, .write = write_resource, .timings = timings, .close = close_runtime \
    }
const struct dt_runtime runtime_gl = MADE_RUNTIME("gl", open_gl);
const struct dt_runtime runtime_vk = MADE_RUNTIME("vk", open_vk);

void scene_frame_at(const struct scene *scene, uint32_t index, uint32_t width, uint32_t height,
                    struct dt_frame *frame)
{
    (void)scene;
    (void)width;
    (void)height;
    frame->index = index;
}

bool scene_load(struct scene *scene, const char *path, const char *scenes_dir, bool apart,
                const struct dt_log *log)
{
    (void)apart;
    (void)scene;
    (void)path;
    (void)scenes_dir;
    (void)log;
    return false;
}

bool scene_load_motion(struct scene *scene, const char *path, const struct dt_log *log)
{
    (void)scene;
    (void)path;
    (void)log;
    return false;
}

bool scene_none(struct scene *scene, const struct dt_log *log)
{
    (void)scene;
    (void)log;
    return false;
}

bool inputs_write(const struct pipeline *pipeline, const struct dt_runtime *runtime, void *handle,
                  const uint32_t size[2])
{
    (void)pipeline;
    (void)runtime;
    (void)handle;
    (void)size;
    return true;
}

uint32_t motion_frames(const struct motion *motion)
{
    (void)motion;
    return 1;
}

/* ---- Fixture --------------------------------------------------------------------------------- */

struct bench {
    struct console console;
    char last[512]; /* error */
    int errors;
    struct setup setup;
    struct pipeline pipeline;
    struct scene scene;
    struct side sides[2];
    struct rows rows;
};

static void hear(void *user, enum dt_level level, const char *message)
{
    struct bench *bench = user;
    if (level != DT_ERROR)
        return;
    bench->errors++;
    snprintf(bench->last, sizeof bench->last, "%s", message);
}

static int set_up(void **state)
{
    struct bench *bench = calloc(1, sizeof *bench);
    *state = bench;
    bench->console.log = (struct dt_log){.message = hear, .user = bench};
    pthread_mutex_init(&bench->console.lock, NULL);
    pthread_mutex_init(&bench->console.writing, NULL);
    bench->setup = (struct setup){.size = {8, 8}, .frames = 3};
    bench->pipeline.info = &pipeline_info;
    bench->pipeline.gl = bench->pipeline.vk = &made_shaders;
    bench->sides[0] = (struct side){.label = (char *)"gl", .backend = "gl"};
    bench->sides[1] = (struct side){.label = (char *)"vk", .backend = "vk"};
    memset(scripts, 0, sizeof scripts);
    memset(&resources[NUMBERS].contract, 0, sizeof resources[NUMBERS].contract);
    return rows_make(&bench->rows, &pipeline_info, &bench->console.log) ? 0 : -1;
}

static int tear_down(void **state)
{
    struct bench *bench = *state;
    rows_free(&bench->rows);
    pthread_mutex_destroy(&bench->console.lock);
    pthread_mutex_destroy(&bench->console.writing);
    free(bench);
    return 0;
}

static struct worker_info info_of(struct bench *bench, int side)
{
    return (struct worker_info){.session = {.side = &bench->sides[side],
                                            .console = &bench->console,
                                            .setup = &bench->setup,
                                            .pipeline = &bench->pipeline,
                                            .scene = &bench->scene,
                                            .poison = side ? 0xa5 : 0x5a},
                                .frames = bench->setup.frames};
}

static void assert_stop(struct worker *worker, enum worker_stop stop, uint32_t frame, uint32_t pass)
{
    struct worker_place place;
    assert_true(worker_wait(worker, &place));
    assert_int_equal(place.stop, stop);
    if (stop != WORKER_READY && stop != WORKER_FINISHED)
        assert_int_equal(place.frame, frame);
    if (stop == WORKER_BEFORE_PASS || stop == WORKER_AFTER_PASS)
        assert_int_equal(place.pass, pass);
}

static void assert_go(struct worker *worker, enum worker_stop stop, uint32_t frame, uint32_t pass)
{
    assert_true(worker_resume(worker, DT_RUN));
    assert_stop(worker, stop, frame, pass);
}

static void assert_holds(struct worker *worker, uint32_t resource, const uint32_t *expected)
{
    struct dt_bytes bytes;
    assert_true(worker_read(worker, resource, 0, &bytes));
    assert_int_equal(bytes.size, ELEMENTS * 4);
    assert_int_equal(bytes.extent[0], ELEMENTS);
    assert_memory_equal(bytes.data, expected, bytes.size);
}

static void assert_childless(void)
{
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

/* ---- Workers ------------------------------------------------------------------------------------ */

TEST_WITH(workers_go_from_stop_to_stop, set_up, tear_down)
{
    struct bench *bench = *state;
    struct worker_info info = info_of(bench, 0);
    struct worker worker;
    info.frames = 2;
    info.stops_before = 2;
    assert_true(worker_start(&worker, &info));
    assert_stop(&worker, WORKER_READY, 0, 0);
    assert_string_equal(worker.device, "a made device");
    assert_holds(&worker, NUMBERS, (uint32_t[]){0x5a5a5a5a, 0x5a5a5a5a, 0x5a5a5a5a, 0x5a5a5a5a});
    assert_go(&worker, WORKER_BEFORE_PASS, 0, COUNT);
    assert_go(&worker, WORKER_AFTER_PASS, 0, COUNT);
    assert_holds(&worker, NUMBERS, (uint32_t[]){0, 1, 2, 3});
    assert_go(&worker, WORKER_BEFORE_PASS, 0, DOUBLE);
    uint32_t other[ELEMENTS] = {5, 6, 7, 8};
    const struct dt_bytes bytes = {
        .data = (uint8_t *)other, .size = sizeof other, .extent = {ELEMENTS, 1, 1}};
    assert_true(worker_write(&worker, NUMBERS, 0, &bytes));
    assert_go(&worker, WORKER_AFTER_PASS, 0, DOUBLE);
    assert_holds(&worker, DOUBLED, (uint32_t[]){10, 12, 14, 16});
    assert_go(&worker, WORKER_AFTER_PASS, 0, KEEP); /* no stop before the third */
    assert_go(&worker, WORKER_FRAME_DONE, 0, 0);
    assert_go(&worker, WORKER_BEFORE_PASS, 1, COUNT);
    assert_true(worker_resume(&worker, DT_SKIP));
    assert_stop(&worker, WORKER_AFTER_PASS, 1, COUNT);
    assert_holds(&worker, NUMBERS, other); /* the skipped pass wrote nothing */
    assert_go(&worker, WORKER_BEFORE_PASS, 1, DOUBLE);
    assert_go(&worker, WORKER_AFTER_PASS, 1, DOUBLE);
    assert_go(&worker, WORKER_AFTER_PASS, 1, KEEP);
    assert_holds(&worker, KEPT, (uint32_t[]){20, 24, 28, 32});
    assert_go(&worker, WORKER_FRAME_DONE, 1, 0);
    assert_go(&worker, WORKER_FINISHED, 0, 0);
    worker_close(&worker);
    assert_int_equal(bench->errors, 0);
    assert_childless();
}

TEST_WITH(earlier_frames_run_without_a_stop, set_up, tear_down)
{
    struct bench *bench = *state;
    struct worker_info info = info_of(bench, 1);
    struct worker worker;
    info.first_observed = 2;
    assert_true(worker_start(&worker, &info));
    assert_stop(&worker, WORKER_READY, 0, 0);
    assert_go(&worker, WORKER_AFTER_PASS, 2, COUNT);
    assert_go(&worker, WORKER_AFTER_PASS, 2, DOUBLE);
    assert_go(&worker, WORKER_AFTER_PASS, 2, KEEP);
    assert_holds(&worker, KEPT, (uint32_t[]){60, 66, 72, 78}); /* 2 (0 + 10 + 20) + 6 i */
    worker_close(&worker);                                     /* in the middle */
    assert_childless();

    info.session.first_frame = 2; /* earlier frames do not run at all */
    assert_true(worker_start(&worker, &info));
    assert_stop(&worker, WORKER_READY, 0, 0);
    assert_go(&worker, WORKER_AFTER_PASS, 2, COUNT);
    assert_holds(&worker, NUMBERS, (uint32_t[]){20, 21, 22, 23});
    assert_true(worker_resume(&worker, DT_RUN));
    worker_close(&worker); /* while it runs */
    assert_childless();
    assert_int_equal(bench->errors, 0);
}

/* Runs the worker until it finishes or fails. */
static void run_out(struct worker *worker, const struct worker_info *info)
{
    struct worker_place place;
    bool good = worker_start(worker, info) && worker_wait(worker, &place);
    while (good && place.stop != WORKER_FINISHED)
        good = worker_resume(worker, DT_RUN) && worker_wait(worker, &place);
    worker_close(worker);
}

TEST_WITH(what_happened_to_a_worker_is_told_once, set_up, tear_down)
{
    struct bench *bench = *state;
    static const struct {
        struct script script;
        const char *said;
    } cases[] = {
        {{CRASH, COUNT, 0}, "vk: the driver crashed (SIGSEGV) in pass count of frame 0"},
        {{CRASH, DOUBLE, 0}, "vk: the driver crashed (SIGSEGV) in pass double of frame 0"},
        {{CRASH, COUNT, 1}, "vk: the driver crashed (SIGSEGV) in pass count of frame 1"},
        {{CRASH, KEEP, 2}, "vk: the driver crashed (SIGSEGV) in pass keep of frame 2"},
        {{KILLED, DOUBLE, 1}, "vk: the process was ended (SIGKILL) in pass double of frame 1"},
        {{EXIT, KEEP, 0},
         "vk: the process ended by itself, with exit status 3, in pass keep of frame 0"},
        {{CRASH_OPEN, 0, 0}, "vk: the driver crashed (SIGSEGV) while it opened the device"},
        {{CRASH_CLOSE, 0, 0}, "vk: the driver crashed (SIGABRT) while it closed the device"},
        {{REFUSE_OPEN, 0, 0}, "vk: no such device"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        for (uint32_t stops_before = 0; stops_before <= PASSES; stops_before += PASSES) {
            struct worker worker;
            struct worker_info info = info_of(bench, 1);
            info.stops_before = stops_before;
            scripts[1] = cases[i].script;
            bench->errors = 0;
            run_out(&worker, &info);
            assert_string_equal(bench->last, cases[i].said);
            assert_int_equal(bench->errors, 1);
            assert_childless();
        }
    }
}

TEST_WITH(a_crash_before_the_observed_frame_is_told, set_up, tear_down)
{
    struct bench *bench = *state;
    struct worker_info info = info_of(bench, 0);
    struct worker worker;
    info.first_observed = 2;
    scripts[0] = (struct script){CRASH, DOUBLE, 1};
    run_out(&worker, &info);
    assert_string_equal(bench->last, "gl: the driver crashed (SIGSEGV) before frame 2");
    assert_int_equal(bench->errors, 1);
}

TEST_WITH(a_refused_read_is_an_error, set_up, tear_down)
{
    struct bench *bench = *state;
    const struct worker_info info = info_of(bench, 1);
    struct worker worker;
    struct dt_bytes bytes;
    scripts[1].trouble = REFUSE_READ;
    assert_true(worker_start(&worker, &info));
    assert_stop(&worker, WORKER_READY, 0, 0);
    assert_false(worker_read(&worker, NUMBERS, 0, &bytes));
    assert_string_equal(bench->last, "vk: nothing to read");
    assert_int_equal(bench->errors, 1);
    worker_close(&worker);
    assert_childless();
}

TEST_WITH(a_pass_that_was_left_out_is_an_error, set_up, tear_down)
{
    struct bench *bench = *state;
    const struct worker_info info = info_of(bench, 0);
    struct row_source source;
    scripts[0] = (struct script){LEAVE_OUT, DOUBLE, 0};
    assert_true(source_start(&source, &info, NULL));
    assert_true(source_reach(&source, (struct worker_place){.stop = WORKER_READY}));
    assert_true(source_resume(&source));
    assert_true(source_reach(&source, (struct worker_place){WORKER_AFTER_PASS, 0, COUNT}));
    assert_true(source_resume(&source));
    assert_false(source_reach(&source, (struct worker_place){WORKER_AFTER_PASS, 0, DOUBLE}));
    assert_string_equal(bench->last, "gl: the runtime left out pass double of frame 0");
    source_close(&source);
    assert_childless();
}

/* ---- Blame ------------------------------------------------------------------------------------ */

TEST_WITH(rows_know_where_inputs_come_from, set_up, tear_down)
{
    const struct bench *bench = *state;
    const struct rows *rows = &bench->rows;
    static const uint32_t found[][2] = {{DOUBLE, NUMBERS}, {KEEP, DOUBLED}, {KEEP, KEPT}};
    uint32_t index;
    assert_int_equal(rows->outputs.count, 3);
    assert_int_equal(rows->inputs.count, DT_ARRAY_COUNT(found));
    for (uint32_t i = 0; i < DT_ARRAY_COUNT(found); i++) {
        assert_int_equal(rows->inputs.list[i].pass, found[i][0]);
        assert_int_equal(rows->inputs.list[i].resource, found[i][1]);
    }
    assert_true(rows_origin(rows, &rows->inputs.list[1], &index));
    assert_int_equal(index, 1);
    assert_false(rows_origin(rows, &rows->inputs.list[2], &index));
    assert_int_equal(rows->history.list[index].resource, KEPT);
}

/* The values that gl writes in frame 2, row by row: see the pipeline. */
static const uint32_t right[3][ELEMENTS] = {{20, 21, 22, 23}, {40, 42, 44, 46}, {60, 66, 72, 78}};

enum {
    BEFORE,
    FIRST_OUTPUT,
    ROWS = FIRST_OUTPUT + PASSES
}; /* of a sheet: KEPT before the frame, then outputs */

/* What the first run has left of frame 2, the blame for `broken`, and what is found on the way: per pass, whether its
 * inputs differed, and elements with an own error. */
static const struct case_of_blame {
    struct script scripts[2];
    bool swapped; /* vk is the first side */
    bool differ[ROWS];
    uint32_t broken;
    enum blame_outcome outcome;
    uint32_t row;
    int side;
    bool inputs[PASSES];
    uint64_t own[PASSES];
} blames[] = {
    /* own errors are told from inherited ones, */
    {.scripts = {{0}, {WRONG, DOUBLE, 2}},
     .differ = {false, false, true, true},
     .broken = FIRST_OUTPUT + DOUBLE,
     .outcome = BLAME_GUILTY,
     .row = FIRST_OUTPUT + DOUBLE,
     .inputs = {false, false, true},
     .own = {0, 1, 0}},
    /* those of the first side, too */
    {.scripts = {{0}, {WRONG, KEEP, 2}},
     .swapped = true,
     .differ = {false, false, false, true},
     .broken = FIRST_OUTPUT + KEEP,
     .outcome = BLAME_GUILTY,
     .row = FIRST_OUTPUT + KEEP,
     .own = {0, 0, 1}},
    /* errors within the contract of `numbers` may add up */
    {.scripts = {{0}, {WRONG, COUNT, 0}},
     .differ = {true, true, true, true},
     .broken = FIRST_OUTPUT + DOUBLE,
     .outcome = BLAME_INHERITED,
     .row = FIRST_OUTPUT + DOUBLE,
     .inputs = {false, true, true},
     .own = {1, 0, 0}},
    /* what differed before is no pass's fault */
    {.scripts = {{0}, {WRONG_START, 0, 0}},
     .differ = {true, false, false, true},
     .broken = BEFORE,
     .outcome = BLAME_EARLIER,
     .row = BEFORE,
     .inputs = {false, false, true}},
    /* sides that stray are named: gl, */
    {.scripts = {{STRAY, DOUBLE, 0}},
     .differ = {true, false, true, true},
     .broken = FIRST_OUTPUT + DOUBLE,
     .outcome = BLAME_NOT_REPEATABLE,
     .row = FIRST_OUTPUT + DOUBLE,
     .inputs = {false, false, true},
     .own = {0, 1, 0}},
    /* and vk, which the first run found wrong on equal inputs, and which now is right */
    {.differ = {false, false, true, true},
     .broken = FIRST_OUTPUT + DOUBLE,
     .outcome = BLAME_NOT_REPEATABLE,
     .row = FIRST_OUTPUT + DOUBLE,
     .side = 1,
     .inputs = {false, false, true}}};

TEST_WITH(blame_is_found, set_up, tear_down)
{
    struct bench *bench = *state;
    for (size_t i = 0; i < DT_ARRAY_COUNT(blames); i++) {
        const struct case_of_blame *it = &blames[i];
        struct sheet_row rows[ROWS] = {{.differs = it->differ[BEFORE]}};
        struct sheet sheet = {.rows = rows, .count = ROWS, .early = FIRST_OUTPUT};
        struct blame blame;
        for (int k = 0; k < PASSES; k++) {
            struct sheet_row *row = &rows[FIRST_OUTPUT + k];
            uint32_t copy[ELEMENTS];
            memcpy(copy, right[k], sizeof copy);
            copy[0] += it->swapped && k == KEEP;
            struct dt_bytes bytes = {
                .data = (uint8_t *)copy, .size = sizeof copy, .extent = {ELEMENTS, 1, 1}};
            assert_true(fingerprint(&resources[k], &bytes, &row->hash));
            row->differs = it->differ[FIRST_OUTPUT + k];
        }
        memcpy(scripts, it->scripts, sizeof scripts);
        resources[NUMBERS].contract = (struct dt_contract){0};
        if (it->outcome == BLAME_INHERITED)
            resources[NUMBERS].contract =
                (struct dt_contract){.kind = DT_CONTRACT_ABS, .tolerance = 1};
        const struct replay replay = {
            .console = &bench->console,
            .rows = &bench->rows,
            .workers = {info_of(bench, it->swapped), info_of(bench, !it->swapped)},
            .frame = 2};
        assert_true(blame_find(&blame, &replay, &sheet, &rows[it->broken]));
        assert_int_equal(blame.frame, 2);
        assert_int_equal(blame.outcome, it->outcome);
        assert_ptr_equal(blame.row, &rows[it->row]);
        if (it->outcome == BLAME_NOT_REPEATABLE)
            assert_ptr_equal(blame.side, &bench->sides[it->side]);
        for (int k = 0; k < PASSES; k++) {
            const struct sheet_row *row = &rows[FIRST_OUTPUT + k];
            assert_string_equal(row->inputs, it->inputs[k] ? "differ" : "equal");
            assert_int_equal(row->own->elements, ELEMENTS);
            assert_int_equal(row->own->differing, it->own[k]);
            if (i == 0 && k == DOUBLE)
                assert_true(row->own->worst.values[0] == 40 && row->own->worst.values[1] == 41);
        }
        blame_free(&blame);
        assert_int_equal(bench->errors, 0);
        assert_childless();
    }
}

TEST_WITH(a_crash_in_the_second_run_is_an_error, set_up, tear_down)
{
    struct bench *bench = *state;
    struct blame blame;
    struct sheet_row rows[ROWS] = {{0}};
    struct sheet sheet = {.rows = rows, .count = ROWS, .early = FIRST_OUTPUT};
    const struct replay replay = {.console = &bench->console,
                                  .rows = &bench->rows,
                                  .workers = {info_of(bench, 0), info_of(bench, 1)},
                                  .frame = 2};
    scripts[1] = (struct script){CRASH, DOUBLE, 0};
    assert_false(blame_find(&blame, &replay, &sheet, &rows[FIRST_OUTPUT]));
    assert_string_equal(bench->last, "vk: the driver crashed (SIGSEGV) in pass double of frame 2");
    assert_int_equal(bench->errors, 1);
    blame_free(&blame);
    assert_childless();
}

TEST_WITH(fingerprints_see_every_number_and_no_padding, set_up, tear_down)
{
    static const struct dt_field vector[] = {{"v", DT_TYPE_VEC3, 0, 0, 0}};
    const struct dt_resource resource = {
        .kind = DT_BUFFER, .fields = vector, .field_count = 1, .stride = 16};
    uint8_t bytes[48];
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)(i * 7);
    struct dt_bytes whole = {.data = bytes, .size = sizeof bytes, .extent = {3, 1, 1}};
    uint64_t first, hash;
    assert_true(fingerprint(&resource, &whole, &first));
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] ^= 1;
        assert_true(fingerprint(&resource, &whole, &hash));
        assert_int_equal(hash == first, i % 16 >= 12);
        bytes[i] ^= 1;
    }
}

RUN_TESTS("worker", NULL, NULL)
