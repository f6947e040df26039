/* Frames of generated pipelines, seen by a table of verbs that takes notes: the order of calls, the
 * resources and layouts of barriers, and the clears of passes that are switched off. */
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"
#include "features.h"
#include "layouts.h"
#include "recorder.h"
#include "rsm.h"
#include "ssvp.h"

static const struct dt_panel *const panels[] = {&features_panel, &layouts_panel, &rsm_panel,
                                                &ssvp_panel};
static const uint32_t sizes[][2] = {{640, 480}, {33, 17}, {1, 1}};

enum { MAX_RESOURCES = 256 };

/* The walk through the notes of one frame. */
struct walk {
    const struct recorder *recorder;
    const struct dt_panel *panel;
    const struct dt_pipeline *pipeline;
    uint32_t at;
    uint8_t layouts
        [MAX_RESOURCES]; /* enum dt_layout as the barriers so far left it; 0: as the frame found it */
};

static void fail_at(const struct walk *walk, const char *what)
{
    char line[256] = "the end";
    if (walk->at < walk->recorder->count)
        recorder_line(walk->recorder, walk->at, line, sizeof line);
    fail_msg("%s, note %u, %s: %s", walk->pipeline->name, walk->at, line, what);
}
#define HOLDS(walk, condition)                                                                     \
    do {                                                                                           \
        if (!(condition))                                                                          \
            fail_at(walk, #condition);                                                             \
    } while (0)

static const struct recorder_note *peek(const struct walk *walk)
{
    static const struct recorder_note none = {.verb = RECORDER_BARRIER, .pass = UINT32_MAX};
    return walk->at < walk->recorder->count ? &walk->recorder->notes[walk->at] : &none;
}

static const struct recorder_note *take(struct walk *walk, uint32_t verb, uint32_t pass)
{
    const struct recorder_note *note = peek(walk);
    HOLDS(walk, note->verb == verb);
    HOLDS(walk, note->pass == pass);
    walk->at++;
    return note;
}

/* ---- Resources of a pass --------------------------------------------------------------------- */

static bool lists(const uint16_t *list, uint32_t count, uint32_t resource)
{
    for (uint32_t i = 0; i < count; i++)
        if (list[i] == resource)
            return true;
    return false;
}

static bool touches(const struct walk *walk, uint32_t pass, uint32_t resource)
{
    const struct dt_pass *p = &walk->pipeline->passes[pass];
    return lists(p->reads, p->read_count, resource) || lists(p->writes, p->write_count, resource);
}

static bool is_image(const struct walk *walk, uint32_t resource)
{
    return resource < walk->pipeline->resource_count &&
           walk->pipeline->resources[resource].kind == DT_IMAGE;
}

/* The pass's reflection lists every resource that its program binds. */
static void check_program(const struct walk *walk, uint32_t pass)
{
    const struct dt_program *program = &walk->panel->programs[pass];
    for (uint32_t i = 0; i < program->binding_count; i++) {
        const struct dt_binding *binding = &program->bindings[i];
        bool image = binding->kind == DT_BIND_TEXTURE || binding->kind == DT_BIND_IMAGE;
        if (binding->resource >= DT_FRAME)
            continue;
        HOLDS(walk, touches(walk, pass, binding->resource));
        HOLDS(walk, is_image(walk, binding->resource) == image);
        if (image && walk->layouts[binding->resource])
            HOLDS(walk, binding->layout == walk->layouts[binding->resource]);
    }
}

static void check_target(const struct walk *walk, uint32_t pass, const struct dt_target *target,
                         enum dt_layout layout)
{
    uint8_t found = walk->layouts[target->resource];
    HOLDS(walk, touches(walk, pass, target->resource));
    HOLDS(walk, is_image(walk, target->resource));
    HOLDS(walk, target->mip < walk->pipeline->resources[target->resource].mips);
    HOLDS(walk, found == layout || found == DT_LAYOUT_GENERAL || (!found && target->load));
}

static void check_targets(const struct walk *walk, uint32_t pass)
{
    const struct dt_program *program = &walk->panel->programs[pass];
    HOLDS(walk, program->color_count || program->depth);
    for (uint32_t i = 0; i < program->color_count; i++)
        check_target(walk, pass, &program->colors[i], DT_LAYOUT_COLOR);
    if (program->depth)
        check_target(walk, pass, program->depth, DT_LAYOUT_DEPTH);
}

/* ---- The calls of a pass --------------------------------------------------------------------- */

static void check_barrier(struct walk *walk, const struct recorder_note *note)
{
    const struct dt_barrier *barrier = &note->barrier;
    HOLDS(walk, barrier->resource < walk->pipeline->resource_count);
    const struct dt_storage *storage = &walk->panel->storage[barrier->resource];
    HOLDS(walk, touches(walk, note->pass, barrier->resource));
    HOLDS(walk, barrier->from_stages && barrier->to_stages && barrier->to);
    HOLDS(walk, is_image(walk, barrier->resource) == (barrier->layout != DT_LAYOUT_NONE));
    HOLDS(walk, !barrier->discard || !walk->pipeline->resources[barrier->resource].history);
    HOLDS(walk, !(barrier->to & ~(storage->usage | DT_WRITE_CLEAR | DT_READ_COLOR)));
    walk->layouts[barrier->resource] = barrier->layout;
}

static void check_barriers(struct walk *walk, uint32_t pass)
{
    bool seen[MAX_RESOURCES] = {false};
    if (peek(walk)->verb != DT_VERB_BARRIERS)
        return;
    uint32_t count = take(walk, DT_VERB_BARRIERS, pass)->arguments[0];
    HOLDS(walk, count > 0);
    for (uint32_t i = 0; i < count; i++) {
        const struct recorder_note *note = peek(walk);
        HOLDS(walk, note->verb == RECORDER_BARRIER);
        check_barrier(walk, note);
        HOLDS(walk, !seen[note->barrier.resource]);
        seen[note->barrier.resource] = true;
        take(walk, RECORDER_BARRIER, pass);
    }
}

static void check_work(struct walk *walk, uint32_t pass)
{
    enum dt_pass_kind kind = walk->pipeline->passes[pass].kind;
    check_program(walk, pass);
    take(walk, DT_VERB_BIND, pass);
    const struct recorder_note *work = peek(walk);
    if (kind == DT_PASS_DISPATCH) {
        HOLDS(walk, work->verb == DT_VERB_DISPATCH || work->verb == DT_VERB_DISPATCH_INDIRECT);
        if (work->verb == DT_VERB_DISPATCH_INDIRECT)
            HOLDS(walk, touches(walk, pass, work->arguments[0]));
    } else {
        bool layered = walk->panel->programs[pass].layered;
        HOLDS(walk, kind == DT_PASS_DRAW_FULLSCREEN
                        ? work->verb == DT_VERB_DRAW_FULLSCREEN
                        : work->verb == DT_VERB_DRAW_SCENE || work->verb == DT_VERB_DRAW_INDIRECT);
        HOLDS(walk, layered ? work->arguments[0] >= 1 : work->arguments[0] == 1);
        if (work->verb == DT_VERB_DRAW_INDIRECT)
            HOLDS(walk, work->arguments[1] == DT_SCENE_INDICES ||
                            touches(walk, pass, work->arguments[1]));
        if (work->verb == DT_VERB_DRAW_INDIRECT)
            HOLDS(walk, touches(walk, pass, work->arguments[2]));
        check_targets(walk, pass);
    }
    take(walk, work->verb, pass);
}

static bool is_target(const struct walk *walk, uint32_t pass, uint32_t resource)
{
    const struct dt_program *program = &walk->panel->programs[pass];
    bool found = program->depth && program->depth->resource == resource;
    for (uint32_t i = 0; i < program->color_count; i++)
        found |= program->colors[i].resource == resource;
    return found;
}

/* A pass that does not run clears the resources that it would write, but not those that it
 * updates. */
static void check_clears(struct walk *walk, uint32_t pass)
{
    const struct dt_pass *p = &walk->pipeline->passes[pass];
    bool cleared[MAX_RESOURCES] = {false}, targets = false;
    if (peek(walk)->verb == DT_VERB_CLEAR_TARGETS) {
        check_targets(walk, pass);
        take(walk, DT_VERB_CLEAR_TARGETS, pass);
        targets = true;
    }
    while (peek(walk)->verb == DT_VERB_CLEAR_BUFFER || peek(walk)->verb == DT_VERB_CLEAR_IMAGE) {
        uint32_t resource = peek(walk)->arguments[0];
        HOLDS(walk, lists(p->writes, p->write_count, resource) && !is_target(walk, pass, resource));
        HOLDS(walk, is_image(walk, resource) == (peek(walk)->verb == DT_VERB_CLEAR_IMAGE));
        HOLDS(walk, !is_image(walk, resource) || walk->layouts[resource] == DT_LAYOUT_GENERAL);
        cleared[resource] = true;
        take(walk, peek(walk)->verb, pass);
    }
    for (uint32_t i = 0; i < p->write_count; i++) {
        uint32_t resource = p->writes[i];
        bool updates =
            walk->pipeline->resources[resource].history || lists(p->reads, p->read_count, resource);
        HOLDS(walk, updates || (is_target(walk, pass, resource) ? targets : cleared[resource]));
    }
}

/* Whether each pass ran, as a bit. */
static uint64_t check_frame(struct walk *walk)
{
    uint64_t ran = 0;
    for (uint32_t pass = 0; pass < walk->pipeline->pass_count; pass++) {
        bool runs = take(walk, DT_VERB_BEGIN, pass)->arguments[0];
        check_barriers(walk, pass);
        if (runs)
            check_work(walk, pass);
        else
            check_clears(walk, pass);
        take(walk, DT_VERB_END, pass);
        ran |= (uint64_t)runs << pass;
    }
    HOLDS(walk, walk->at == walk->recorder->count);
    return ran;
}

/* Two frames: the second one finds the layouts that the first one left, and does the same. */
static uint64_t check_panel(const struct dt_panel *panel, const uint32_t size[2], const void *live)
{
    struct recorder recorder = {0}, again = {0};
    struct walk walk = {.recorder = &recorder, .panel = panel, .pipeline = panel->pipeline};
    assert_true(panel->pipeline->resource_count <= MAX_RESOURCES);
    assert_true(recorder_run(&recorder, panel, size[0], size[1], live));
    assert_true(recorder_run(&again, panel, size[0], size[1], live));
    assert_int_equal(recorder_difference(&recorder, &again), UINT32_MAX);
    uint64_t ran = check_frame(&walk);
    walk.at = 0;
    assert_true(check_frame(&walk) == ran);
    recorder_free(&recorder);
    recorder_free(&again);
    return ran;
}

/* ---- Tests ----------------------------------------------------------------------------------- */

TEST(passes_follow_the_order_of_calls)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(panels); i++)
        for (size_t k = 0; k < DT_ARRAY_COUNT(sizes); k++)
            check_panel(panels[i], sizes[k], NULL);
}

/* Every switch off and on, one at a time. */
TEST(passes_that_are_off_clear)
{
    uint32_t offs = 0;
    for (size_t i = 0; i < DT_ARRAY_COUNT(panels); i++) {
        const struct dt_pipeline *pipeline = panels[i]->pipeline;
        uint64_t usual = check_panel(panels[i], sizes[0], NULL);
        uint8_t *live = malloc(pipeline->live_size);
        assert_non_null(live);
        for (uint32_t p = 0; p < pipeline->param_count; p++) {
            const struct dt_param *param = &pipeline->params[p];
            uint32_t value = param->value[0] == 0;
            memcpy(live, pipeline->live_defaults, pipeline->live_size);
            if (!param->live || param->type != DT_TYPE_BOOL)
                continue;
            memcpy(live + param->offset, &value, sizeof value);
            offs += check_panel(panels[i], sizes[1], live) != usual;
        }
        free(live);
    }
    assert_true(offs > 0); /* features has one at least */
}

/* After a failed verb the record calls no other. */
TEST(nothing_is_called_after_a_failure)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(panels); i++) {
        struct recorder recorder = {0};
        assert_true(recorder_run(&recorder, panels[i], 64, 48, NULL));
        uint32_t calls = recorder.calls;
        for (recorder.fail_at = 1; recorder.fail_at <= calls; recorder.fail_at++) {
            assert_false(recorder_run(&recorder, panels[i], 64, 48, NULL));
            assert_int_equal(recorder.calls, recorder.fail_at);
        }
        recorder_free(&recorder);
    }
}

/* The notes can tell pipelines and frames apart. */
TEST(notes_differ_where_calls_do)
{
    struct recorder a = {0}, b = {0};
    char line[256];
    assert_true(recorder_run(&a, &features_panel, 64, 48, NULL));
    assert_true(recorder_run(&b, &features_panel, 64, 49, NULL));
    uint32_t at = recorder_difference(&a, &b);
    assert_in_range(at, 1, a.count - 1);
    assert_int_equal(a.notes[at].verb, DT_VERB_DISPATCH);
    recorder_line(&a, 0, line, sizeof line);
    assert_string_equal(line, "begin scene (0), runs 1");
    recorder_line(&a, 2, line, sizeof line);
    assert_string_equal(
        line, "  barrier color (7): stages 0x8 to 0x8, accesses 0x0 to 0x20, layout 3, discard");
    b.notes[2].barrier.to_stages ^= 1;
    assert_int_equal(recorder_difference(&a, &b), 2);
    assert_true(recorder_run(&b, &features_panel, 64, 48, NULL));
    b.count--;
    assert_int_equal(recorder_difference(&a, &b), b.count);
    recorder_free(&a);
    recorder_free(&b);
}

RUN_TESTS("record", NULL, NULL)
