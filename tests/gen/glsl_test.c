/* GLSL of one small pipeline, compiled for both backends; what glslang gets is compared with
 * tests/gen/golden/glsl_*: the model is built by hand, so that only emit_glsl and spirv are under
 * test. Run from the root of the tree. DIPTYCH_UPDATE_GOLDENS=1 writes the goldens anew; look at
 * the difference before it is kept. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <spirv/unified1/spirv.h>

#include "read/body_files.h"
#include "model/expr.h"
#include "model/cross.h"
#include "load.h"
#include "spirv/compile.h"

#define COUNT(a) (uint32_t)(sizeof(a) / sizeof((a)[0]))

struct fixture {
    struct model model;
    struct diag *diag;
    struct field fields[4], cell_fields[2];
    struct structure structs[2];
    struct param params[3];
    struct constant constants[2];
    struct resource resources[8];
    struct sampler samplers[2];
    struct metric metrics[1];
    struct interleave interleaves[1];
    struct pass passes[3];
    struct access shade_accesses[5], scene_accesses[3], tone_accesses[3];
    struct range ranges[1];
    const char *shade_uses[3];
    struct source body;
};
enum { LIGHTS, CELLS, NORMALS, SHADOWS, RESULT, DEPTH, DISPLAY, COLOR };
enum { SHADE, SCENE, TONE };

static const char shade_body[] =
    "void main()\n"
    "{\n"
    "    ivec2 p = interleave_pixel();\n"
    "    vec3 n = normals(p).xyz;\n"
    "    vec3 sum = vec3(0.0);\n"
    "    for (Light2 v : subset) {\n"
    "        sum += v.flux * max(dot(n, v.position), 0.0) * float(subset_index + 1);\n"
    "    }\n"
    "    sum += vec3(points(0), float(points_count)) * exposure;\n"
    "    int k = nearest % cells_count;\n"
    "    sum.x += apart(cells[k].position, cells[k].normal, n, n) + apart(lights[k], cells[k]);\n"
    "    sum.y += shadows_compare(vec3(0.5, 0.5, 1.0), sum.z) + float(half_width);\n"
    "    result_store(p, vec4(sum, float(tile_class(p) + result_size().x)));\n"
    "}\n";
static const char scene_body[] =
    "#ifdef VERTEX\n"
    "layout(location = 0) out vec3 normal;\n"
    "void main()\n"
    "{\n"
    "    normal = vertex_normal;\n"
    "    gl_Layer = gl_InstanceIndex;\n"
    "    gl_Position = view.view_projection * vec4(vertex_position, 1.0);\n"
    "    gl_ClipDistance[0] = dot(vertex_normal, view.direction);\n"
    "}\n"
    "#else\n"
    "layout(location = 0) in vec3 normal;\n"
    "void main()\n"
    "{\n"
    "    color = scene_texture(normal.xy, scene_materials[0].texture_layer);\n"
    "}\n"
    "#endif\n";
static const char tone_body[] =
    "void main()\n"
    "{\n"
    "    display = result(ivec2(gl_FragCoord.xy)) * depth_sample(gl_FragCoord.xy);\n"
    "}\n";

static struct expr *expression(struct fixture *f, const char *text)
{
    struct expr *expr = expr_parse(&f->model, text, (struct loc){0}, NULL, f->diag);
    assert_non_null(expr);
    assert_true(expr_resolve(expr, &f->model.pipeline, f->diag));
    return expr;
}

static struct access access_to(struct resource *resource, enum access_mode mode, unsigned kind,
                               int binding)
{
    return (struct access){.name = resource->name,
                           .mode = mode,
                           .resource = resource,
                           .kind = kind,
                           .binding = binding,
                           .attachment = -1};
}

static void set_body(struct fixture *f, int pass, const char *path, const char *text)
{
    f->body = (struct source){.path = path, .text = text, .length = strlen(text)};
    f->passes[pass].body = &f->body;
    f->passes[pass].files = body_files_read(&f->model, &f->body);
    f->passes[pass].shader_loc = (struct loc){&f->body, 1, 1, 1};
}

static void fill_declarations(struct fixture *f)
{
    f->fields[0] = (struct field){.name = "position", .type = DT_TYPE_VEC3};
    f->fields[1] = (struct field){.name = "kind", .type = DT_TYPE_UINT};
    f->fields[2] = (struct field){.name = "normal", .type = DT_TYPE_VEC3};
    f->fields[3] = (struct field){.name = "flux", .type = DT_TYPE_VEC3};
    f->cell_fields[0] = f->fields[0];
    f->cell_fields[1] = f->fields[2];
    f->structs[0] =
        (struct structure){.name = "Light2", .fields = f->fields, .field_count = 4, .stride = 48};
    f->structs[1] = (struct structure){
        .name = "Cell", .fields = f->cell_fields, .field_count = 2, .stride = 32};
    f->params[0] =
        (struct param){.name = "nearest", .type = DT_TYPE_INT, .components = 1, .value = {3}};
    f->params[1] = (struct param){
        .name = "exposure", .type = DT_TYPE_FLOAT, .components = 1, .value = {1}, .live = true};
    f->params[2] =
        (struct param){.name = "unused", .type = DT_TYPE_IVEC2, .components = 2, .value = {4, 4}};
    f->resources[LIGHTS] = (struct resource){.name = "lights", .structure = &f->structs[0]};
    f->resources[CELLS] = (struct resource){.name = "cells", .structure = &f->structs[1]};
    f->resources[NORMALS] =
        (struct resource){.name = "normals", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA16F};
    f->resources[SHADOWS] =
        (struct resource){.name = "shadows", .kind = DT_IMAGE, .format = DT_FORMAT_D32F};
    f->resources[RESULT] =
        (struct resource){.name = "result", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA32F};
    f->resources[DEPTH] =
        (struct resource){.name = "depth", .kind = DT_IMAGE, .format = DT_FORMAT_D32F};
    f->resources[DISPLAY] =
        (struct resource){.name = "display", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8_SRGB};
    f->resources[COLOR] =
        (struct resource){.name = "color", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA16F};
    f->samplers[0] = (struct sampler){.name = "points", .map = MAP_CONCENTRIC_DISK};
    f->samplers[1] =
        (struct sampler){.name = "shadow", .kind = SAMPLER_FILTER, .linear = true, .compare = true};
    f->metrics[0] = (struct metric){.name = "apart",
                                    .position = {.value = 0.6},
                                    .normal = {.value = 0.4},
                                    .position_field = "position",
                                    .normal_field = "normal",
                                    .scale = "scene_radius"};
    f->interleaves[0] = (struct interleave){.name = "tile", .tile = {4, 2}};
}

static void fill_passes(struct fixture *f)
{
    static struct sampler nearest = {.name = "nearest_filter", .kind = SAMPLER_FILTER};
    f->shade_uses[0] = "points";
    f->shade_uses[1] = "apart";
    f->shade_uses[2] = "tile";
    f->shade_accesses[0] = access_to(&f->resources[NORMALS], MODE_READ, DT_READ_STORAGE, 0);
    f->shade_accesses[1] = access_to(&f->resources[RESULT], MODE_WRITE, DT_WRITE_STORAGE, 1);
    f->shade_accesses[2] = access_to(&f->resources[LIGHTS], MODE_READ, DT_READ_STORAGE, 2);
    f->shade_accesses[3] =
        access_to(&f->resources[CELLS], MODE_UPDATE, DT_READ_STORAGE | DT_WRITE_STORAGE, 3);
    f->shade_accesses[4] = access_to(&f->resources[SHADOWS], MODE_READ, DT_READ_TEXTURE, 6);
    f->shade_accesses[4].filter = &f->samplers[1];
    f->ranges[0] = (struct range){.name = "subset",
                                  .of = "lights",
                                  .access = &f->shade_accesses[2],
                                  .count_value = 5,
                                  .first = "interleave_class() * 5",
                                  .storage = STORAGE_SHARED,
                                  .loop = LOOP_UNROLL,
                                  .chunk = 2};
    f->passes[SHADE] = (struct pass){.name = "shade",
                                     .kind = DT_PASS_DISPATCH,
                                     .accesses = f->shade_accesses,
                                     .access_count = 5,
                                     .uses = f->shade_uses,
                                     .use_count = 3,
                                     .size = SIZE_INTERLEAVE,
                                     .interleave = &f->interleaves[0],
                                     .local = {8, 8, 1},
                                     .ranges = f->ranges,
                                     .range_count = 1,
                                     .frame_binding = 4,
                                     .live_binding = 5,
                                     .textures_binding = -1,
                                     .materials_binding = -1};
    f->scene_accesses[0] = access_to(&f->resources[COLOR], MODE_WRITE, DT_WRITE_COLOR, -1);
    f->scene_accesses[0].attachment = 0;
    f->passes[SCENE] = (struct pass){.name = "scene",
                                     .kind = DT_PASS_DRAW_SCENE,
                                     .view = "light",
                                     .accesses = f->scene_accesses,
                                     .access_count = 1,
                                     .clip_distances = 1,
                                     .materials_binding = 0,
                                     .frame_binding = 1,
                                     .live_binding = 2,
                                     .textures_binding = 3};
    f->tone_accesses[0] = access_to(&f->resources[RESULT], MODE_READ, DT_READ_TEXTURE, 2);
    f->tone_accesses[1] = access_to(&f->resources[DEPTH], MODE_READ, DT_READ_TEXTURE, 3);
    f->tone_accesses[1].filter = &nearest;
    f->tone_accesses[2] = access_to(&f->resources[DISPLAY], MODE_WRITE, DT_WRITE_COLOR, -1);
    f->tone_accesses[2].attachment = 0;
    f->passes[TONE] = (struct pass){.name = "tone",
                                    .kind = DT_PASS_DRAW_FULLSCREEN,
                                    .accesses = f->tone_accesses,
                                    .access_count = 3,
                                    .frame_binding = 0,
                                    .live_binding = 1,
                                    .textures_binding = -1,
                                    .materials_binding = -1};
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model.arena = arena_create();
    f->model.templates_dir = "templates";
    f->diag = diag_create();
    fill_declarations(f);
    f->model.pipeline = (struct pipeline){.name = "small",
                                          .params = f->params,
                                          .param_count = COUNT(f->params),
                                          .constants = f->constants,
                                          .structs = f->structs,
                                          .struct_count = COUNT(f->structs),
                                          .resources = f->resources,
                                          .resource_count = COUNT(f->resources),
                                          .samplers = f->samplers,
                                          .sampler_count = COUNT(f->samplers),
                                          .metrics = f->metrics,
                                          .metric_count = 1,
                                          .interleaves = f->interleaves,
                                          .interleave_count = 1,
                                          .passes = f->passes,
                                          .pass_count = COUNT(f->passes)};
    f->constants[0] =
        (struct constant){.name = "half_width", .value = expression(f, "frame.width / 2")};
    f->constants[1] = (struct constant){
        .name = "folded", .value = expression(f, "nearest * 2"), .folds = true, .folded = 6};
    f->model.pipeline.constant_count = 2;
    f->resources[LIGHTS].count = expression(f, "40");
    f->resources[CELLS].count = expression(f, "ceil_div(frame.width, 8)");
    f->resources[SHADOWS].layers = expression(f, "4");
    f->samplers[0].count = expression(f, "64");
    fill_passes(f);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    arena_free(f->model.arena);
    diag_free(f->diag);
    free(f);
    return 0;
}

/* The text without blanks: glslang's preprocessor, which a body with ranges goes through, sets them
 * otherwise in each version. free() */
static char *squeezed(const char *text)
{
    char *copy = strdup(text), *to = copy;
    assert_non_null(copy);
    for (; *text; text++)
        if (*text != ' ')
            *to++ = *text;
    *to = '\0';
    return copy;
}

/* Compares with the golden, or writes it. */
static void assert_golden(const char *name, const char *text)
{
    char path[256], *golden;
    snprintf(path, sizeof path, "tests/gen/golden/%s", name);
    FILE *file = fopen(path, getenv("DIPTYCH_UPDATE_GOLDENS") ? "w" : "r");
    assert_non_null(file);
    if (getenv("DIPTYCH_UPDATE_GOLDENS")) {
        fputs(text, file);
        fclose(file);
        return;
    }
    assert_non_null(golden = calloc(1, 1 << 20));
    assert_true(fread(golden, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    char *found = squeezed(text), *wanted = squeezed(golden);
    assert_string_equal(found, wanted);
    free(found);
    free(wanted);
    free(golden);
}

static void shader_free(struct shader *shader)
{
    text_free(&shader->glsl);
    text_free(&shader->code);
    free(shader->words);
}

/* As shaders.c does. */
static struct shader build(struct fixture *f, int pass, enum backend backend, enum stage stage)
{
    struct shader shader = {0}, vulkan = {0};
    if (backend == BACKEND_GL)
        vulkan = build(f, pass, BACKEND_VK, stage);
    shader.own = vulkan.own;
    bool ok = emit_glsl(&f->model, &f->passes[pass], backend, stage, &shader, f->diag);
    if (ok && backend == BACKEND_GL && !shader.own) {
        shader.words = vulkan.words;
        shader.word_count = vulkan.word_count;
        vulkan.words = NULL;
        ok = spirv_make_opengl(&f->passes[pass], &shader);
    } else {
        char *log = NULL;
        ok = ok && spirv_compile(&f->model, &f->passes[pass], backend, &shader, &log, f->diag);
        if (!ok && log)
            glsl_report(&f->model, &f->passes[pass], log, f->diag);
        free(log);
    }
    char *why = NULL;
    if (ok && backend == BACKEND_GL)
        ok = spirv_cross(shader.words, shader.word_count, &shader.glsl, &why);
    diag_print(f->diag, "diptych-gen", stderr);
    assert_true(ok);
    assert_true(shader.word_count > 5 && shader.words[0] == SpvMagicNumber);
    shader_free(&vulkan);
    return shader;
}

static void test_goldens(void **state)
{
    static const struct {
        int pass;
        enum stage stage;
        const char *name, *body_path, *body;
    } cases[] = {{SHADE, STAGE_IS_COMPUTE, "shade.comp", "shade.glsl", shade_body},
                 {SCENE, STAGE_IS_VERTEX, "scene.vert", "scene.glsl", scene_body},
                 {SCENE, STAGE_IS_FRAGMENT, "scene.frag", "scene.glsl", scene_body},
                 {TONE, STAGE_IS_VERTEX, "tone.vert", "tone.glsl", tone_body},
                 {TONE, STAGE_IS_FRAGMENT, "tone.frag", "tone.glsl", tone_body}};
    struct fixture *f = *state;
    for (uint32_t i = 0; i < COUNT(cases); i++) {
        char name[64];
        f->model.glsl_source_count = 0; /* each golden counts its files from 1 */
        set_body(f, cases[i].pass, cases[i].body_path, cases[i].body);
        struct shader shader = build(f, cases[i].pass, BACKEND_VK, cases[i].stage);
        snprintf(name, sizeof name, "glsl_%s", cases[i].name);
        assert_golden(name, shader.glsl.data);
        shader_free(&shader);
    }
}

/* Every float operation of the module carries NoContraction in exact mode, and only then. */
static void test_no_contraction(void **state)
{
    struct fixture *f = *state;
    for (int fast = 0; fast < 2; fast++) {
        f->passes[TONE].fast = fast;
        set_body(f, TONE, "tone.glsl", "void main() { display = result(ivec2(0)) * 2.0 + 1.0; }\n");
        struct shader shader = build(f, TONE, BACKEND_VK, STAGE_IS_FRAGMENT);
        uint32_t decorated = 0, operations = 0;
        for (size_t at = 5; at < shader.word_count; at += shader.words[at] >> 16) {
            uint32_t opcode = shader.words[at] & 0xffff;
            decorated +=
                opcode == SpvOpDecorate && shader.words[at + 2] == SpvDecorationNoContraction;
            operations += opcode == SpvOpFAdd || opcode == SpvOpVectorTimesScalar;
        }
        assert_int_equal(operations, 2);
        assert_int_equal(decorated, fast ? 0 : 2);
        shader_free(&shader);
    }
}

/* Products with matrices have an order of their own in each driver: exact mode writes them out. */
static void test_products_are_written_out(void **state)
{
    struct fixture *f = *state;
    for (int fast = 0; fast < 2; fast++)
        for (int backend = BACKEND_GL; backend <= BACKEND_VK; backend++) {
            f->passes[TONE].fast = fast;
            set_body(f, TONE, "tone.glsl",
                     "void main()\n{\n"
                     "    vec4 v = result(ivec2(0));\n"
                     "    mat4x3 m = mat4x3(v.xyz, v.yzw, v.zwx, v.wxy);\n"
                     "    mat3x4 n = transpose(m);\n"
                     "    display = (n * m) * v + n * (m * v) + (v.xyz * m) * (n * m);\n}\n");
            struct shader shader = build(f, TONE, (enum backend)backend, STAGE_IS_FRAGMENT);
            uint32_t products = 0;
            for (size_t at = 5; at < shader.word_count; at += shader.words[at] >> 16) {
                uint32_t opcode = shader.words[at] & 0xffff;
                products += opcode >= SpvOpVectorTimesMatrix && opcode <= SpvOpMatrixTimesMatrix;
            }
            assert_int_equal(products, fast ? 7 : 0);
            shader_free(&shader);
        }
}

/* Division by component: no driver gets a division of its own to do. */
static void test_matrices_are_divided(void **state)
{
    static const char *const bodies[] = {
        "void main() { mat2 m = mat2(result(ivec2(0))); display = vec4((m / m)[0], (1.0 / m)[1]); "
        "}\n",
        "void main() { mat4x3 m = mat4x3(result(ivec2(0)).x); display = (m / 7.0)[0].xyzz; }\n",
    };
    struct fixture *f = *state;
    for (int fast = 0; fast < 2; fast++)
        for (uint32_t i = 0; i < COUNT(bodies); i++) {
            uint32_t divisions = 0;
            f->passes[TONE].fast = fast;
            set_body(f, TONE, "tone.glsl", bodies[i]);
            struct shader shader = build(f, TONE, BACKEND_VK, STAGE_IS_FRAGMENT);
            for (size_t at = 5; at < shader.word_count; at += shader.words[at] >> 16)
                divisions += (shader.words[at] & 0xffff) == SpvOpFDiv;
            assert_int_equal(divisions > 0, fast);
            shader_free(&shader);
        }
}

/* A disk sampler also has a function that maps points of the unit square, points of the body's own:
 * DISK_map(u). The function exists on disks alone, and only for bodies that call it. */
static void test_map_of_a_sampler(void **state)
{
    static const struct {
        enum sampler_map map;
        const char *calls; /* NULL: there is no map */
    } cases[] = {{MAP_POLAR_DISK, "polar_disk(u)"},
                 {MAP_CONCENTRIC_DISK, "concentric_disk(u)"},
                 {MAP_SQUARE, NULL}};
    static const char map[] = "vec2 points_map(vec2 u)\n{\n    return ";
    struct fixture *f = *state;
    for (uint32_t i = 0; i < COUNT(cases); i++)
        for (int used = 0; used < 2; used++) {
            f->samplers[0].map = cases[i].map;
            set_body(f, SHADE, "shade.glsl",
                     used && cases[i].calls
                         ? "void main() { result_store(ivec2(0), points_map(vec2(0.5)).xyxy); }\n"
                         : "void main() { result_store(ivec2(0), points(1).xyxy); }\n");
            struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
            const char *at = strstr(shader.glsl.data, map);
            assert_int_equal(!!at, used && cases[i].calls);
            assert_true(!at || !strncmp(at + strlen(map), cases[i].calls, strlen(cases[i].calls)));
            assert_int_equal(!strstr(shader.glsl.data, "vec2 points(int k)"), at != NULL);
            shader_free(&shader);
        }
}

/* `text` with every `from` replaced by `to`; free() */
static char *replaced(const char *text, const char *from, const char *to)
{
    struct text out = {0};
    for (const char *at; (at = strstr(text, from)); text = at + strlen(from)) {
        text_add_bytes(&out, text, (size_t)(at - text));
        text_add(&out, "%s", to);
    }
    text_add(&out, "%s", text);
    return out.data;
}

/* Other words for the accesses of `shade`, in their order. */
static const struct {
    const char *name, *as;
} words[] = {{"normals", "surface"},
             {"result", "sum_of"},
             {"lights", "heap"},
             {"cells", "places"},
             {"shadows", "darkness"}};

/* `text` with other words for the resources. Frees `text`; free() the result. */
static char *in_other_words(char *text)
{
    for (uint32_t i = 0; i < COUNT(words); i++) {
        char *next = replaced(text, words[i].name, words[i].as);
        free(text);
        text = next;
    }
    return text;
}

/* The GLSL behind the library, from the first resource on; free() */
static char *resources_and_body(struct fixture *f, enum backend backend, const char *body)
{
    f->model.glsl_source_count = 0;
    set_body(f, SHADE, "shade.glsl", body);
    struct shader shader = build(f, SHADE, backend, STAGE_IS_COMPUTE);
    const char *at = strstr(shader.glsl.data, "binding = 0");
    assert_non_null(at);
    char *text = strdup(at);
    shader_free(&shader);
    return text;
}

/* A pass may list resources `as` other words. If the body uses these words, the shader stays the
 * same but for the words. */
static void test_words_of_a_pass(void **state)
{
    struct fixture *f = *state;
    char *body = in_other_words(strdup(shade_body));
    f->passes[SHADE].fast = true; /* exact mode has a `result` of its own */
    for (int storage = STORAGE_SHARED; storage <= STORAGE_BUFFER; storage++)
        for (int backend = BACKEND_GL; backend <= BACKEND_VK; backend++) {
            f->ranges[0].storage = (enum storage_class)storage;
            for (uint32_t i = 0; i < COUNT(words); i++)
                f->shade_accesses[i].as = NULL;
            char *wanted = resources_and_body(f, (enum backend)backend, shade_body);
            for (uint32_t i = 0; i < COUNT(words); i++)
                f->shade_accesses[i].as = words[i].as;
            char *found = resources_and_body(f, (enum backend)backend, body);
            assert_non_null(strstr(found, "heap["));
            wanted = in_other_words(wanted);
            assert_string_equal(found, wanted);
            free(found);
            free(wanted);
        }
    free(body);
}

static const char *emit_shade(struct fixture *f, const char *body, struct shader *shader)
{
    *shader = (struct shader){0};
    set_body(f, SHADE, "shade.glsl", body);
    bool ok =
        emit_glsl(&f->model, &f->passes[SHADE], BACKEND_VK, STAGE_IS_COMPUTE, shader, f->diag);
    return ok ? shader->glsl.data : NULL;
}

static uint32_t occurrences(const char *text, const char *what)
{
    uint32_t count = 0;
    char *in = squeezed(text), *word = squeezed(what);
    for (const char *at = in; (at = strstr(at, word)); at += strlen(word))
        count++;
    free(in);
    free(word);
    return count;
}

/* Shapes of a loop over five elements: the copies of the body, the barriers and the caches. */
static void test_range_shapes(void **state)
{
    static const char body[] =
        "void main() { for (Light2 v : subset) { result_store(ivec2(v.kind), vec4(0)); } }\n";
    static const struct {
        enum storage_class storage;
        enum loop_shape loop;
        uint32_t chunk, copies, barriers;
    } cases[] = {{STORAGE_SHARED, LOOP_UNROLL, 5, 5, 1}, {STORAGE_SHARED, LOOP_UNROLL, 2, 5, 6},
                 {STORAGE_SHARED, LOOP_ROLL, 5, 1, 1},   {STORAGE_SHARED, LOOP_ROLL, 2, 2, 4},
                 {STORAGE_BUFFER, LOOP_ROLL, 2, 1, 0},   {STORAGE_BUFFER, LOOP_UNROLL, 8, 5, 0}};
    struct fixture *f = *state;
    for (uint32_t i = 0; i < COUNT(cases); i++) {
        f->ranges[0].storage = cases[i].storage;
        f->ranges[0].loop = cases[i].loop;
        f->ranges[0].chunk = cases[i].chunk;
        f->ranges[0].turn = 1;
        set_body(f, SHADE, "shade.glsl", body);
        struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
        assert_int_equal(occurrences(shader.glsl.data, "result_store(ivec2(v.kind)"),
                         cases[i].copies);
        assert_int_equal(occurrences(shader.glsl.data, "barrier();"), cases[i].barriers);
        bool caches = cases[i].storage == STORAGE_SHARED; /* of the one field that the body names */
        assert_int_equal(occurrences(shader.glsl.data, "shared uint subset_kind["), caches);
        assert_int_equal(occurrences(shader.glsl.data, "shared "), caches);
        assert_true(cases[i].loop == LOOP_ROLL || cases[i].storage == STORAGE_BUFFER ||
                    !strstr(shader.glsl.data, "for ("));
        shader_free(&shader);
    }
    f->model.pipeline.gpu = true; /* a loop over full blocks of two, then the last */
    f->ranges[0].storage = STORAGE_SHARED;
    f->ranges[0].chunk = 2;
    set_body(f, SHADE, "shade.glsl", body);
    struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    assert_int_equal(occurrences(shader.glsl.data, "result_store(ivec2(v.kind)"), 3);
    assert_int_equal(occurrences(shader.glsl.data, "for ("), 1);
    shader_free(&shader);
    f->ranges[0].loop = LOOP_ROLL; /* a loop with two per turn, then the last */
    f->ranges[0].chunk = 5;
    f->ranges[0].turn = 2;
    shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    assert_int_equal(occurrences(shader.glsl.data, "result_store(ivec2(v.kind)"), 3);
    assert_int_equal(occurrences(shader.glsl.data, "for (int subset_k = 0; subset_k < 4;"), 1);
    assert_int_equal(occurrences(shader.glsl.data, "subset_kind[(subset_k + 1)]"), 1);
    assert_int_equal(occurrences(shader.glsl.data, "subset_kind[4]"), 1);
    shader_free(&shader);
}

/* The shader reads the number of elements, so the shader has no literal of this number. */
static void test_counted_range(void **state)
{
    struct fixture *f = *state;
    f->params[0].uniform = true;
    f->params[0].offset = 4; /* behind the live one */
    f->ranges[0].storage = STORAGE_BUFFER;
    f->ranges[0].loop = LOOP_ROLL;
    f->ranges[0].turn = 1;
    f->ranges[0].counted = true;
    f->ranges[0].count = expression(f, "nearest + 2");
    set_body(f, SHADE, "shade.glsl",
             "void main() { for (Light2 v : subset) { result_store(ivec2(v.kind), vec4(0)); } }\n");
    struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    assert_non_null(strstr(shader.glsl.data, "int subset_count = nearest + 2;"));
    assert_non_null(strstr(shader.glsl.data, "subset_index < subset_count;"));
    assert_int_equal(occurrences(shader.glsl.data, "result_store(ivec2(v.kind)"), 1);
    char *text = strdup(shader.glsl.data);
    shader_free(&shader);
    f->ranges[0].count_value = 7;
    shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    assert_string_equal(shader.glsl.data, text);
    free(text);
    shader_free(&shader);
}

/* If main() computes the first element of a range, the copy follows this computation. */
static void test_copy_follows_its_first_element(void **state)
{
    struct fixture *f = *state;
    f->ranges[0].chunk = 5;
    f->ranges[0].first = "start";
    set_body(f, SHADE, "shade.glsl",
             "void main() { int start = nearest; for (Light2 v : subset)\n"
             "{ result_store(ivec2(v.kind), vec4(0)); } }\n");
    struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    const char *start = strstr(shader.glsl.data, "int start = nearest;");
    assert_non_null(start);
    assert_non_null(strstr(start, "int subset_first = start;"));
    assert_int_equal(occurrences(start, "barrier();"), 2);
    shader_free(&shader);
}

/* Elements of a uniform block are copied 16 bytes at a time. A Light2 has three such parts:
 * position and kind share the first. The flux of the second light is in the sixth. */
static void test_range_by_words(void **state)
{
    struct fixture *f = *state;
    f->ranges[0].chunk = 5;
    f->shade_accesses[2].kind = DT_READ_UNIFORM;
    f->fields[1].offset = 12;
    f->fields[2].offset = 16;
    f->fields[3].offset = 32;
    f->structs[0].align = 16;
    f->resources[LIGHTS].stride = 48;
    f->resources[LIGHTS].count = expression(f, "40");
    set_body(f, SHADE, "shade.glsl",
             "void main() { for (Light2 v : subset)\n"
             "{ result_store(ivec2(v.kind), vec4(v.flux, v.position.x)); } }\n");
    struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    const char *text = shader.glsl.data;
    assert_non_null(strstr(text, "shared uint subset_words[60];"));
    assert_non_null(strstr(text, "if (gl_LocalInvocationIndex < 60u)"));
    assert_non_null(strstr(text, "v.position = vec3(uintBitsToFloat(subset_words[0]), "
                                 "uintBitsToFloat(subset_words[1]), "
                                 "uintBitsToFloat(subset_words[2]));"));
    assert_non_null(strstr(text, "v.kind = uint(subset_words[3]);"));
    assert_non_null(strstr(text, "v.flux = vec3(uintBitsToFloat(subset_words[20]), "
                                 "uintBitsToFloat(subset_words[21]), "
                                 "uintBitsToFloat(subset_words[22]));"));
    assert_null(strstr(text, "v.normal"));
    assert_int_equal(occurrences(text, "barrier();"), 1);
    shader_free(&shader);
    /* OpenGL takes one block for a binding: elements, where the body reads one by its index */
    set_body(
        f, SHADE, "shade.glsl",
        "void main() { float sum = lights[3].flux.x; for (Light2 v : subset) { sum += v.flux.x; }\n"
        "result_store(ivec2(0), vec4(sum)); }\n");
    shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    text = shader.glsl.data;
    assert_null(strstr(text, "_quads"));
    assert_int_equal(occurrences(text, "uniform lights_block"), 1);
    assert_non_null(strstr(text, "subset_flux[i] = lights[subset_first + i].flux;"));
    shader_free(&shader);
}

static void test_whole_element(void **state)
{
    struct fixture *f = *state;
    set_body(f, SHADE, "shade.glsl",
             "void take(Light2 l) { result_store(ivec2(0), vec4(l.flux, 1)); }\n"
             "void main() { for (Light2 v : subset) { take(v); } }\n");
    struct shader shader = build(f, SHADE, BACKEND_VK, STAGE_IS_COMPUTE);
    assert_non_null(strstr(shader.glsl.data, "shared Light2 subset_cache[2];"));
    shader_free(&shader);
}

/* Forbidden uses of a range in a body, each with exactly one error. */
static void test_range_errors(void **state)
{
    static const char *const bodies[] = {
        "void main() { for (Light2 v : subset) { if (v.kind > 0u) break; } }\n",
        "void main() { for (Light2 v : subset) { if (v.kind > 0u) continue; } }\n",
        "void main() { for (Light2 v : subset) { return; } }\n",
        "void main() { if (true) { for (Light2 v : subset) { } } }\n",
        "void f() { for (Light2 v : subset) { } } void main() { f(); }\n",
        "void main() { for (Light2 v : subsett) { } }\n",
        "void main() { for (Cell v : subset) { } }\n",
        "void main() { for (Light2 v : subset) ; }\n",
    };
    struct fixture *f = *state;
    for (uint32_t i = 0; i < COUNT(bodies); i++) {
        struct shader shader;
        unsigned before = diag_error_count(f->diag);
        assert_null(emit_shade(f, bodies[i], &shader));
        assert_int_equal(diag_error_count(f->diag), before + 1);
    }
}

/* One character for each loop of the fragment shader `body`, in the order of the module: '1' if the
 * driver must not unroll the loop, else '0'. */
static void loops_of(struct fixture *f, const char *body, enum backend backend, char *loops)
{
    set_body(f, TONE, "tone.glsl", body);
    struct shader shader = build(f, TONE, backend, STAGE_IS_FRAGMENT);
    for (size_t at = 5; at < shader.word_count; at += shader.words[at] >> 16)
        if ((shader.words[at] & 0xffff) == SpvOpLoopMerge)
            *loops++ = shader.words[at + 3] & SpvLoopControlDontUnrollMask ? '1' : '0';
    *loops = '\0';
    shader_free(&shader);
}

/* A loop with many reads in each turn is not unrolled. The driver decides about an inner loop,
 * since its limit counts the turns of both loops. The driver also decides about a loop whose
 * counter indexes a local array. */
static void test_long_loops_stay_loops(void **state)
{
    static const char start[] =
        "vec4 near(int i)\n{\n"
        "    return result(ivec2(i)) * result(ivec2(0, i)) + result(ivec2(i, 0));\n}\n"
        "void main()\n{\n    vec4 sum = vec4(0.0), kept[4];\n"
        "    for (int i = 0; i < 4; i++)";
    static const struct {
        const char *body, *loops;
    } cases[] = {
        {"sum += near(i);", "1"},
        {"sum += float(i) * exposure;", "0"},
        {"sum += near(i);\n    for (int i = 0; i < 4; i++) sum += float(i);", "10"},
        {"for (int k = 0; k < 4; k++) sum += near(i + k);", "10"},
        {"{ kept[i] = near(i); sum += kept[i]; }", "0"},
        {"{ kept[1] = near(i); sum += kept[1]; }", "1"},
    };
    struct fixture *f = *state;
    for (int gpu = 0; gpu < 2; gpu++)
        for (uint32_t i = 0; i < COUNT(cases); i++)
            for (int backend = BACKEND_GL; backend <= BACKEND_VK; backend++) {
                char body[1024], loops[8];
                f->model.pipeline.gpu = gpu;
                snprintf(body, sizeof body, "%s %s\n    display = sum;\n}\n", start, cases[i].body);
                loops_of(f, body, (enum backend)backend, loops);
                assert_int_equal(strlen(loops), strlen(cases[i].loops));
                if (gpu)
                    assert_null(strchr(loops, '1'));
                else
                    assert_string_equal(loops, cases[i].loops);
            }
}

/* A global variable that is `precise`: glslang declares it inside a function, where it may not be. */
static void test_global_variables(void **state)
{
    struct fixture *f = *state;
    set_body(f, TONE, "tone.glsl",
             "precise float total = 0.5, other;\n"
             "void add(float a) { other = a; total += a * other; }\n"
             "void main() { add(2.0); display = result(ivec2(0)) * total; }\n");
    struct shader shader = build(f, TONE, BACKEND_VK, STAGE_IS_FRAGMENT);
    shader_free(&shader);
}

/* Errors of the GLSL compiler name the author's line and column. */
static void test_compile_error_place(void **state)
{
    struct fixture *f = *state;
    struct shader shader;
    assert_non_null(emit_shade(
        f, "#ifdef FRAGMENT\nnonsense\n#endif\nvoid main()\n{\n    int a = wrong;\n}\n", &shader));
    char *log = NULL;
    assert_false(spirv_compile(&f->model, &f->passes[SHADE], BACKEND_VK, &shader, &log, f->diag));
    glsl_report(&f->model, &f->passes[SHADE], log, f->diag);
    free(log);
    char *text = diag_text(f->diag, "diptych-gen");
    assert_non_null(strstr(text, "shade.glsl:6:13: error: 'wrong' : undeclared identifier"));
    free(text);
    shader_free(&shader);
}

static int start(void **state)
{
    (void)state;
    return spirv_init() ? 0 : 1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_goldens, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_no_contraction, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_matrices_are_divided, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_products_are_written_out, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_words_of_a_pass, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_map_of_a_sampler, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_range_shapes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_counted_range, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_copy_follows_its_first_element, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_range_by_words, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_whole_element, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_range_errors, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_long_loops_stay_loops, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_global_variables, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_compile_error_place, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, start, NULL);
}
