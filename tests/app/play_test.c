/* The app plays a planned spec; other programs compile the output of diptych-gen. Both must be the
 * same pipeline. For every shipped or tested spec, this test compares the tables of the spec read
 * here with those of the generated C. It also compares its frame with the generated record, call by
 * call with arguments. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"
#include "spec/play.h"
#include "gen/load.h"
#include "gen/lower/members.h"
#include "gen/spirv/passes.h"
#include "recorder.h"

#define EACH_SPEC(X)                                                                               \
    X("templates/ssvp.yaml", ssvp)                                                                 \
    X("templates/rsm.yaml", rsm)                                                                   \
    X("templates/instant_radiosity.yaml", instant_radiosity)                                       \
    X("templates/ssdo.yaml", ssdo)                                                                 \
    X("templates/deep.yaml", deep)                                                                 \
    X("templates/clustered.yaml", clustered)                                                       \
    X("templates/taa.yaml", taa)                                                                   \
    X("templates/post.yaml", post)                                                                 \
    X("templates/machine.yaml", machine)                                                           \
    X("tests/specs/features.yaml", features)                                                       \
    X("tests/specs/layouts.yaml", layouts)                                                         \
    X("tests/specs/mips.yaml", mips)                                                               \
    X("tests/specs/bloom.yaml", bloom)                                                             \
    X("tests/specs/body.yaml", body)                                                               \
    X("tests/specs/outside.yaml", outside)                                                         \
    X("tests/specs/particles.yaml", particles)                                                     \
    X("tests/specs/cull.yaml", cull)                                                               \
    X("tests/specs/formats.yaml", formats)                                                         \
    X("tests/specs/shapes.yaml", shapes)                                                           \
    X("tests/specs/atomics.yaml", atomics)                                                         \
    X("tests/specs/groups.yaml", groups)

#define DECLARE(spec, name) extern const struct dt_shaders name##_gl, name##_vk;
EACH_SPEC(DECLARE)

#define SUBJECT(spec, name) {spec, {&name##_gl, &name##_vk}},
static const struct subject {
    const char *spec;
    const struct dt_shaders *shaders[2];
} subjects[] = {EACH_SPEC(SUBJECT)};

static const uint32_t sizes[][2] = {{640, 480}, {33, 17}, {1, 1}, {1921, 7}};

static struct pair {
    struct spec spec;
    const struct dt_panel *played, *generated;
} pairs[DT_ARRAY_COUNT(subjects)];

static void open_pair(struct pair *pair, const struct subject *subject)
{
    const struct spec_request request = {.path = subject->spec,
                                         .templates = "templates",
                                         .text = true,
                                         .codes = strstr(subject->spec, "/ssvp.yaml")};
    struct diag *diag = diag_create();
    memset(pair, 0, sizeof *pair);
    if (!spec_load(&pair->spec, &request, true, diag)) {
        diag_print(diag, "diptych-gen", stderr);
        fail_msg("%s: cannot be read", subject->spec);
    }
    diag_free(diag);
    play_prepare(pair->spec.tables);
    pair->played = &pair->spec.tables->panel;
    pair->generated = subject->shaders[0]->panel;
}

/* ---- Tables ---------------------------------------------------------------------------------- */

static const char *members_difference(const struct members *members, const void *a, const void *b);

static bool same_member(const struct member *member, const void *a, const void *b)
{
    const char *x = (const char *)a + member->offset, *y = (const char *)b + member->offset;
    if (member->kind < MEMBER_ROW && member->kind != MEMBER_TEXT)
        return memcmp(x, y, member->size) == 0;
    if (member->kind == MEMBER_ROW)
        return !members_difference(member->rows, x, y);
    memcpy(&x, x, sizeof x);
    memcpy(&y, y, sizeof y);
    uint32_t count = member_count(member, a);
    if (!x || !y || count != member_count(member, b))
        return !x == !y || (member->kind >= MEMBER_ROWS && !count && !member_count(member, b));
    if (member->kind == MEMBER_TEXT)
        return strcmp(x, y) == 0;
    if (member->kind >= MEMBER_RESOURCES)
        return memcmp(x, y, count * sizeof(uint16_t)) == 0;
    for (uint32_t i = 0; i < count; i++)
        if (members_difference(member->rows, x + i * member->rows->size,
                               y + i * member->rows->size))
            return false;
    return true;
}

/* The name of a member in which two rows differ; NULL: they are the same. */
static const char *members_difference(const struct members *members, const void *a, const void *b)
{
    for (size_t i = 0; i < members->count; i++)
        if (!same_member(&members->list[i], a, b))
            return members->list[i].name;
    return NULL;
}

static void same_rows(const struct pair *pair, const struct members *members, const void *a,
                      const void *b, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        size_t at = i * members->size;
        const char *name = members_difference(members, (const char *)a + at, (const char *)b + at);
        if (name)
            fail_msg("%s: %s[%u].%s differs", pair->spec.tables->pipeline.name, members->tag, i,
                     name);
    }
}

static void same_pipelines(const struct pair *pair)
{
    const struct dt_pipeline *a = pair->played->pipeline, *b = pair->generated->pipeline;
    assert_string_equal(a->name, b->name);
    assert_string_equal(a->doc, b->doc);
    assert_int_equal(a->param_count, b->param_count);
    same_rows(pair, &param_members, a->params, b->params, a->param_count);
    assert_int_equal(a->live_size, b->live_size);
    assert_int_equal(a->block_size, b->block_size);
    assert_memory_equal(a->live_defaults, b->live_defaults, a->block_size);
    assert_int_equal(a->resource_count, b->resource_count);
    same_rows(pair, &resource_members, a->resources, b->resources, a->resource_count);
    assert_int_equal(a->pass_count, b->pass_count);
    same_rows(pair, &pass_members, a->passes, b->passes, a->pass_count);
    assert_int_equal(a->linear_output, b->linear_output);
    assert_int_equal(a->display_output, b->display_output);
}

static void same_panels(const struct pair *pair)
{
    const struct dt_panel *a = pair->played, *b = pair->generated;
    same_rows(pair, &storage_members, a->storage, b->storage, a->pipeline->resource_count);
    same_rows(pair, &program_members, a->programs, b->programs, a->pipeline->pass_count);
    assert_int_equal(a->slot_count, b->slot_count);
    assert_int_equal(a->sampler_count, b->sampler_count);
    same_rows(pair, &sampler_members, a->samplers, b->samplers, a->sampler_count);
    assert_int_equal(a->need_count, b->need_count);
    same_rows(pair, &need_members, a->needs, b->needs, a->need_count);
    assert_int_equal(a->demand_count, b->demand_count);
    same_rows(pair, &demand_members, a->demands, b->demands, a->demand_count);
}

/* The member that begins at `at` or next behind it. */
static const struct member *member_from(const struct members *members, size_t at)
{
    const struct member *next = NULL;
    for (size_t i = 0; i < members->count; i++)
        if (members->list[i].offset >= at && (!next || members->list[i].offset < next->offset))
            next = &members->list[i];
    return next;
}

/* Between the members of a struct is only padding: less than the member behind it needs. */
static void check_complete(const struct members *members)
{
    for (size_t at = 0; at < members->size;) {
        const struct member *next = member_from(members, at);
        size_t end = next ? next->offset : members->size;
        size_t align = next && next->kind == MEMBER_FLOATS ? sizeof(float)
                       : next && next->size < 8            ? next->size
                                                           : 8;
        if (end - at >= align)
            fail_msg("members.c: %s has another member at byte %zu", members->tag, at);
        at = next ? end + next->size : end;
    }
    for (size_t i = 0; i < members->count; i++)
        if (members->list[i].rows)
            check_complete(members->list[i].rows);
}

TEST(members_are_complete)
{
    check_complete(&storage_members);
    check_complete(&sampler_members);
    check_complete(&program_members);
    check_complete(&need_members);
    check_complete(&demand_members);
    check_complete(&barrier_members);
    check_complete(&param_members);
    check_complete(&resource_members);
    check_complete(&pass_members);
}

/* Generated code is packed, without names, and with GLSL only where it was asked for. */
static void same_code(const struct dt_code *a, const struct dt_code *b)
{
    size_t count = a->size / sizeof *a->words;
    uint32_t *words = malloc(a->size + 1);
    assert_non_null(words);
    if (count)
        memcpy(words, a->words, a->size);
    count = spirv_strip(words, count);
    assert_int_equal(count * sizeof *words, b->size);
    const uint8_t *at = b->packed;
    for (size_t i = 0; i < count; i++) {
        uint64_t word = 0;
        unsigned bytes = 0;
        do
            word |= (uint64_t)(*at & 0x7f) << 7 * bytes++;
        while (*at++ & 0x80);
        assert_int_equal(word, words[i]);
    }
    if (b->glsl)
        assert_string_equal(a->glsl, b->glsl);
    free(words);
}

TEST(tables_are_the_same)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(subjects); i++) {
        const struct pair *pair = &pairs[i];
        same_pipelines(pair);
        same_panels(pair);
        for (int backend = 0; backend < 2; backend++) {
            const struct dt_shaders *s = &pair->spec.tables->shaders[backend];
            const struct dt_shaders *t = subjects[i].shaders[backend];
            assert_string_equal(s->backend, t->backend);
            for (uint32_t pass = 0; pass < pair->played->pipeline->pass_count; pass++) {
                same_code(&s->stages[pass].compute, &t->stages[pass].compute);
                same_code(&s->stages[pass].vertex, &t->stages[pass].vertex);
                same_code(&s->stages[pass].fragment, &t->stages[pass].fragment);
            }
        }
    }
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static void same_frame(const struct pair *pair, const uint32_t size[2], const void *live)
{
    const struct dt_pipeline *a = pair->played->pipeline, *b = pair->generated->pipeline;
    struct recorder played = {0}, generated = {0};
    char line[256];
    assert_true(recorder_run(&played, pair->played, size[0], size[1], live));
    assert_true(recorder_run(&generated, pair->generated, size[0], size[1], live));
    uint32_t at = recorder_difference(&played, &generated);
    if (at != UINT32_MAX) {
        recorder_line(at < played.count ? &played : &generated, at, line, sizeof line);
        fail_msg("%s at %ux%u: %s", a->name, size[0], size[1], line);
    }
    assert_true(played.count > 2 * a->pass_count);
    recorder_free(&played);
    recorder_free(&generated);
    for (uint32_t i = 0; i < a->resource_count; i++) {
        uint32_t x[3], y[3];
        a->extent(a, i, size[0], size[1], x);
        b->extent(b, i, size[0], size[1], y);
        assert_memory_equal(x, y, sizeof x);
    }
    for (uint32_t i = 0; i < a->pass_count; i++)
        assert_int_equal(a->runs(a, i, size[0], size[1], live),
                         b->runs(b, i, size[0], size[1], live));
    assert_int_equal(!a->jitter, !b->jitter);
    if (a->jitter && b->jitter)
        assert_int_equal(a->jitter(a, live), b->jitter(b, live));
}

TEST(frames_are_the_same)
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(subjects); i++) {
        const struct pair *pair = &pairs[i];
        for (size_t s = 0; s < DT_ARRAY_COUNT(sizes); s++)
            same_frame(pair, sizes[s], pair->generated->pipeline->live_defaults);
    }
}

/* One component of a live parameter at one end of its range. */
static void set_live(char *live, const struct dt_param *param, double value)
{
    float number = (float)value;
    int32_t whole = (int32_t)value;
    memcpy(live + param->offset, param->type <= DT_TYPE_VEC4 ? (void *)&number : (void *)&whole, 4);
}

TEST(frames_are_the_same_with_other_live_parameters)
{
    int tried = 0;
    for (size_t i = 0; i < DT_ARRAY_COUNT(subjects); i++) {
        const struct pair *pair = &pairs[i];
        const struct dt_pipeline *info = pair->generated->pipeline;
        char *live = malloc(info->block_size);
        assert_non_null(live);
        for (uint32_t p = 0; p < info->param_count; p++) {
            const struct dt_param *param = &info->params[p];
            const bool truth = param->type == DT_TYPE_BOOL;
            for (int end = 0; end < 2 && param->live; end++) {
                double value = truth ? end : end ? param->max : param->min;
                if (isinf(value))
                    continue;
                memcpy(live, info->live_defaults, info->block_size);
                set_live(live, param, value);
                same_frame(pair, sizes[1], live);
                tried++;
            }
        }
        free(live);
    }
    assert_true(tried > 20);
}

/* Opens the pairs once for all tests, since each pair compiles every shader. */
static int open_pairs(void **state)
{
    (void)state;
    for (size_t i = 0; i < DT_ARRAY_COUNT(subjects); i++)
        open_pair(&pairs[i], &subjects[i]);
    return 0;
}

static int free_pairs(void **state)
{
    (void)state;
    for (size_t i = 0; i < DT_ARRAY_COUNT(subjects); i++)
        spec_free(&pairs[i].spec);
    return 0;
}

RUN_TESTS("play", open_pairs, free_pairs)
