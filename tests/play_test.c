/* The app plays a planned spec; other programs compile the output of diptych-gen. Both must be the
 * same pipeline. For every shipped or tested spec, this test compares the tables of the spec read
 * here with those of the generated C. It also compares its frame with the generated record, call by
 * call with arguments. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "spec/play.h"
#include "gen/load.h"
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
    const struct spec_request request = {
        .path = subject->spec, .templates = "templates", .text = true};
    struct diag *diag = diag_create();
    memset(pair, 0, sizeof *pair);
    if (!spec_load(&pair->spec, &request, true, diag)) {
        diag_flush(diag);
        fail_msg("%s: cannot be read", subject->spec);
    }
    diag_free(diag);
    play_prepare(pair->spec.tables);
    pair->played = &pair->spec.tables->panel;
    pair->generated = subject->shaders[0]->panel;
}

/* ---- Tables ---------------------------------------------------------------------------------- */

static void same_double(double a, double b)
{
    assert_memory_equal(&a, &b, sizeof a);
}

static void same_params(const struct dt_pipeline *a, const struct dt_pipeline *b)
{
    assert_int_equal(a->param_count, b->param_count);
    for (uint32_t i = 0; i < a->param_count; i++) {
        const struct dt_param *p = &a->params[i], *q = &b->params[i];
        assert_string_equal(p->name, q->name);
        assert_string_equal(p->doc, q->doc);
        assert_int_equal(p->type, q->type);
        assert_int_equal(p->live, q->live);
        assert_int_equal(p->offset, q->offset);
        for (int k = 0; k < 4; k++)
            same_double(p->value[k], q->value[k]);
        same_double(p->min, q->min);
        same_double(p->max, q->max);
        same_double(p->step, q->step);
    }
    assert_int_equal(a->live_size, b->live_size);
    assert_int_equal(a->block_size, b->block_size);
    assert_memory_equal(a->live_defaults, b->live_defaults, a->block_size);
}

static void same_fields(const struct dt_resource *a, const struct dt_resource *b)
{
    assert_int_equal(a->field_count, b->field_count);
    for (uint32_t i = 0; i < a->field_count; i++) {
        const struct dt_field *f = &a->fields[i], *g = &b->fields[i];
        assert_string_equal(f->name, g->name);
        assert_int_equal(f->type, g->type);
        assert_int_equal(f->offset, g->offset);
        assert_int_equal(f->array_count, g->array_count);
        assert_int_equal(f->array_stride, g->array_stride);
    }
    assert_int_equal(a->stride, b->stride);
    assert_int_equal(a->controls_work, b->controls_work);
}

static void same_resources(const struct dt_pipeline *a, const struct dt_pipeline *b)
{
    assert_int_equal(a->resource_count, b->resource_count);
    for (uint32_t i = 0; i < a->resource_count; i++) {
        const struct dt_resource *r = &a->resources[i], *s = &b->resources[i];
        assert_string_equal(r->name, s->name);
        assert_string_equal(r->doc, s->doc);
        assert_int_equal(r->kind, s->kind);
        assert_int_equal(r->history, s->history);
        assert_int_equal(r->contract.kind, s->contract.kind);
        same_double(r->contract.tolerance, s->contract.tolerance);
        same_double(r->contract.outliers, s->contract.outliers);
        if (r->contract.kind == DT_CONTRACT_FLIPS) {
            assert_int_equal(r->contract.margin_resource, s->contract.margin_resource);
            assert_int_equal(r->contract.margin_field, s->contract.margin_field);
        }
        assert_int_equal(r->format, s->format);
        assert_int_equal(r->shape, s->shape);
        assert_int_equal(r->layered, s->layered);
        assert_int_equal(r->mips, s->mips);
        same_fields(r, s);
    }
    assert_int_equal(a->linear_output, b->linear_output);
    assert_int_equal(a->display_output, b->display_output);
}

static void same_lists(const uint16_t *a, uint32_t a_count, const uint16_t *b, uint32_t b_count)
{
    assert_int_equal(a_count, b_count);
    for (uint32_t i = 0; i < a_count; i++)
        assert_int_equal(a[i], b[i]);
}

static void same_passes(const struct dt_pipeline *a, const struct dt_pipeline *b)
{
    assert_int_equal(a->pass_count, b->pass_count);
    for (uint32_t i = 0; i < a->pass_count; i++) {
        const struct dt_pass *p = &a->passes[i], *q = &b->passes[i];
        assert_string_equal(p->name, q->name);
        assert_string_equal(p->doc, q->doc);
        assert_string_equal(p->shader, q->shader);
        assert_int_equal(p->kind, q->kind);
        assert_int_equal(p->uses_scene, q->uses_scene);
        same_lists(p->reads, p->read_count, q->reads, q->read_count);
        same_lists(p->writes, p->write_count, q->writes, q->write_count);
        for (uint32_t k = 0; k < p->write_count; k++)
            assert_int_equal(p->write_mips ? p->write_mips[k] : 1,
                             q->write_mips ? q->write_mips[k] : 1);
        assert_int_equal(!p->limit, !q->limit);
        assert_int_equal(p->flops[0], q->flops[0]);
        assert_int_equal(p->flops[1], q->flops[1]);
    }
}

static void same_target(const struct dt_target *a, const struct dt_target *b)
{
    assert_int_equal(!a, !b);
    if (!a || !b)
        return;
    assert_int_equal(a->resource, b->resource);
    assert_int_equal(a->mip, b->mip);
    assert_int_equal(a->load, b->load);
    assert_int_equal(a->one_layer, b->one_layer);
    assert_int_equal(a->layer, b->layer);
    assert_int_equal(a->keep, b->keep);
    assert_int_equal(!a->blend, !b->blend);
    if (a->blend)
        assert_memory_equal(a->blend, b->blend, sizeof *a->blend);
}

static void same_program(const struct dt_program *a, const struct dt_program *b)
{
    assert_int_equal(a->binding_count, b->binding_count);
    for (uint32_t i = 0; i < a->binding_count; i++) {
        const struct dt_binding *x = &a->bindings[i], *y = &b->bindings[i];
        assert_int_equal(x->binding, y->binding);
        assert_int_equal(x->resource, y->resource);
        assert_int_equal(x->kind, y->kind);
        assert_int_equal(x->mip, y->mip);
        assert_int_equal(x->one_layer, y->one_layer);
        assert_int_equal(x->layer, y->layer);
        assert_int_equal(x->layout, y->layout);
        assert_int_equal(x->access, y->access);
        assert_int_equal(x->sampler, y->sampler);
    }
    assert_int_equal(a->color_count, b->color_count);
    for (uint32_t i = 0; i < a->color_count; i++)
        same_target(&a->colors[i], &b->colors[i]);
    same_target(a->depth, b->depth);
    assert_int_equal(a->compare, b->compare);
    assert_int_equal(a->cull, b->cull);
    assert_int_equal(a->depth_test, b->depth_test);
    assert_int_equal(a->depth_write, b->depth_write);
    assert_int_equal(a->layered, b->layered);
    assert_int_equal(a->clip_distances, b->clip_distances);
    assert_int_equal(a->attributes, b->attributes);
    assert_int_equal(a->topology, b->topology);
    assert_true(a->bias_constant == b->bias_constant && a->bias_slope == b->bias_slope);
}

static void same_panels(const struct dt_panel *a, const struct dt_panel *b)
{
    for (uint32_t i = 0; i < a->pipeline->resource_count; i++) {
        const struct dt_storage *s = &a->storage[i], *t = &b->storage[i];
        assert_int_equal(s->usage, t->usage);
        assert_int_equal(s->slot, t->slot);
        assert_int_equal(s->share, t->share);
        assert_int_equal(s->block, t->block);
        assert_int_equal(s->by_layer, t->by_layer);
        assert_memory_equal(s->clear, t->clear, sizeof s->clear);
    }
    for (uint32_t i = 0; i < a->pipeline->pass_count; i++)
        same_program(&a->programs[i], &b->programs[i]);
    assert_int_equal(a->slot_count, b->slot_count);
    assert_int_equal(a->sampler_count, b->sampler_count);
    for (uint32_t i = 0; i < a->sampler_count; i++) {
        assert_string_equal(a->samplers[i].name, b->samplers[i].name);
        assert_int_equal(a->samplers[i].linear, b->samplers[i].linear);
        assert_int_equal(a->samplers[i].linear_mip, b->samplers[i].linear_mip);
        assert_int_equal(a->samplers[i].wrap, b->samplers[i].wrap);
        assert_int_equal(a->samplers[i].compare, b->samplers[i].compare);
        assert_true(a->samplers[i].anisotropy == b->samplers[i].anisotropy);
    }
    assert_int_equal(a->need_count, b->need_count);
    for (uint32_t i = 0; i < a->need_count; i++) {
        assert_int_equal(a->needs[i].pass, b->needs[i].pass);
        assert_string_equal(a->needs[i].feature, b->needs[i].feature);
    }
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

static void tables_are_the_same(void **state)
{
    (void)state;
    for (size_t i = 0; i < DT_ARRAY_COUNT(subjects); i++) {
        const struct pair *pair = &pairs[i];
        const struct dt_pipeline *a = pair->played->pipeline, *b = pair->generated->pipeline;
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->doc, b->doc);
        same_params(a, b);
        same_resources(a, b);
        same_passes(a, b);
        same_panels(pair->played, pair->generated);
        for (int backend = 0; backend < 2; backend++) {
            const struct dt_shaders *s = &pair->spec.tables->shaders[backend];
            const struct dt_shaders *t = subjects[i].shaders[backend];
            assert_string_equal(s->backend, t->backend);
            for (uint32_t pass = 0; pass < a->pass_count; pass++) {
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

static void frames_are_the_same(void **state)
{
    (void)state;
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

static void frames_are_the_same_with_other_live_parameters(void **state)
{
    (void)state;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_are_the_same),
        cmocka_unit_test(frames_are_the_same),
        cmocka_unit_test(frames_are_the_same_with_other_live_parameters),
    };
    return cmocka_run_group_tests(tests, open_pairs, free_pairs);
}
