/* The OpenGL runtime, driven as the app and generated code drive it, by a small pipeline written
 * by hand: scene draws, a layered draw, compute, indirect work, a skipped pass, history. What it
 * must give follows from the geometry: a quad over the left half of the frame at depth 0.25.
 * Every test runs with the debug callback on, which must stay silent. */
#include <EGL/egl.h>
#include <dlfcn.h>
#include <glob.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

#include "runtime_gl/runtime.h"

enum { LAYERS = 3 };

/* ---- Shaders --------------------------------------------------------------------------------- */

static const char draw_vert[] =
    "#version 460\n"
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 2) in vec2 uv;\n"
    "layout(location = 3) in uint material;\n"
    "layout(location = 0) out vec2 out_uv;\n"
    "layout(location = 1) flat out uint out_material;\n"
    "void main() { gl_Position = vec4(position, 1.0); out_uv = uv; out_material = material; }\n";
static const char draw_frag[] =
    "#version 460\n"
    "struct Material { vec4 albedo_texture; vec4 emission_cutoff; };\n"
    "layout(std430, binding = 2) readonly buffer Materials { Material materials[]; };\n"
    "layout(binding = 0) uniform sampler2DArray textures;\n"
    "layout(location = 0) in vec2 uv;\n"
    "layout(location = 1) flat in uint material;\n"
    "layout(location = 0) out vec4 color;\n"
    "void main() {\n"
    "    vec4 texel = textureLod(textures, vec3(uv, 1.0), 0.0);\n"
    "    color = vec4(materials[material].albedo_texture.rgb, texel.r);\n"
    "}\n";
static const char layers_vert[] = "#version 460\n"
                                  "#extension GL_ARB_shader_viewport_layer_array : require\n"
                                  "layout(location = 0) in vec3 position;\n"
                                  "layout(location = 0) flat out uint layer;\n"
                                  "void main() {\n"
                                  "    gl_Position = vec4(position, 1.0);\n"
                                  "    gl_Layer = gl_InstanceID + gl_BaseInstance;\n"
                                  "    layer = uint(gl_InstanceID + gl_BaseInstance * 6);\n"
                                  "}\n";
static const char layers_frag[] = "#version 460\n"
                                  "layout(location = 0) flat in uint layer;\n"
                                  "layout(location = 0) out uvec4 value;\n"
                                  "void main() { value = uvec4(layer + 10u); }\n";
static const char compute_comp[] =
    "#version 460\n"
    "layout(local_size_x = 8, local_size_y = 8) in;\n"
    "layout(binding = 0, rgba32f) readonly uniform image2D color;\n"
    "layout(binding = 1) uniform sampler2D depth;\n"
    "layout(std140, binding = 1) uniform Live { float factor; };\n"
    "layout(std430, binding = 0) writeonly buffer Result { vec4 result[]; };\n"
    "layout(std430, binding = 1) buffer Arguments { uint groups[3]; uint frames; };\n"
    "void main() {\n"
    "    ivec2 p = ivec2(gl_GlobalInvocationID.xy), size = imageSize(color);\n"
    "    if (p == ivec2(0)) {\n"
    "        groups[0] = 1u; groups[1] = 1u; groups[2] = 1u;\n"
    "        frames++;\n"
    "    }\n"
    "    if (p.x >= size.x || p.y >= size.y) return;\n"
    "    vec4 c = imageLoad(color, p);\n"
    "    result[p.y * size.x + p.x] = vec4(c.rgb * factor, texelFetch(depth, p, 0).r);\n"
    "}\n";
static const char indirect_comp[] =
    "#version 460\n"
    "layout(local_size_x = 1) in;\n"
    "layout(std430, binding = 0) writeonly buffer Command { uint command[]; };\n"
    "void main() { /* the first triangle, one instance, base instance 2 */\n"
    "    command[0] = 3u; command[1] = 1u; command[2] = 0u; command[3] = 0u; command[4] = 2u;\n"
    "}\n";
static const char full_vert[] =
    "#version 460\n"
    "void main() {\n"
    "    vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
    "    gl_Position = vec4(p, 0.0, 1.0);\n"
    "}\n";
static const char full_frag[] = "#version 460\n"
                                "layout(location = 0) out vec4 color;\n"
                                "void main() { color = vec4(0.5, 0.0, 1.0, 0.5); }\n";

static const char idle_comp[] = "#version 460\nlayout(local_size_x = 1) in;\nvoid main() {}\n";

static struct dt_code compile_anew(glslang_stage_t stage, const char *text)
{
    const glslang_input_t input = {
        .language = GLSLANG_SOURCE_GLSL,
        .stage = stage,
        .client = GLSLANG_CLIENT_OPENGL,
        .client_version = GLSLANG_TARGET_OPENGL_450,
        .target_language = GLSLANG_TARGET_SPV,
        .target_language_version = GLSLANG_TARGET_SPV_1_0,
        .code = text,
        .default_version = 460,
        .default_profile = GLSLANG_CORE_PROFILE,
        .messages = GLSLANG_MSG_SPV_RULES_BIT,
        .resource = glslang_default_resource(),
    };
    glslang_initialize_process();
    glslang_shader_t *shader = glslang_shader_create(&input);
    bool ok = glslang_shader_preprocess(shader, &input) && glslang_shader_parse(shader, &input);
    if (!ok)
        print_error("%s\n", glslang_shader_get_info_log(shader));
    assert_true(ok);
    glslang_program_t *program = glslang_program_create();
    glslang_program_add_shader(program, shader);
    assert_true(glslang_program_link(program, GLSLANG_MSG_SPV_RULES_BIT));
    glslang_program_SPIRV_generate(program, stage);
    size_t size = glslang_program_SPIRV_get_size(program) * sizeof(uint32_t);
    uint32_t *words = malloc(size);
    assert_non_null(words);
    glslang_program_SPIRV_get(program, words);
    glslang_program_delete(program);
    glslang_shader_delete(shader);
    glslang_finalize_process();
    return (struct dt_code){words, size, text};
}

/* The module of one stage. It lives as long as the program: glslang takes longer than all else. */
static struct dt_code compile(glslang_stage_t stage, const char *text)
{
    static struct dt_code made[16];
    size_t i = 0;
    while (made[i].glsl && made[i].glsl != text)
        i++;
    assert_true(i + 1 < DT_ARRAY_COUNT(made));
    if (!made[i].glsl)
        made[i] = compile_anew(stage, text);
    return made[i];
}

/* ---- The panel ------------------------------------------------------------------------------- */

enum {
    COLOR,
    DEPTH,
    STACK,
    STACK_DEPTH,
    RESULT,
    ARGUMENTS,
    COMMAND,
    DISPLAY,
    SKIPPED,
    POISONED,
    RESOURCES
};
enum { DRAW, LAYERED, COMPUTE, INDIRECT, AGAIN, FULLSCREEN, SKIP, PASSES };

struct state {
    struct gl_program draw, layers, compute, indirect, full;
    struct gl_image images[RESOURCES];
    struct gl_buffer buffers[RESOURCES];
    GLuint framebuffers[4];
    struct gl_targets targets[4];
};

static void frame_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    extent[0] = width, extent[1] = height, extent[2] = 1;
}
static void stack_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent[0] = 16, extent[1] = 8, extent[2] = LAYERS;
}
static void pixels_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    extent[0] = width * height, extent[1] = 1, extent[2] = 1;
}
static void arguments_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent[0] = 4, extent[1] = 1, extent[2] = 1;
}
static void command_extent(uint32_t width, uint32_t height, uint32_t extent[3])
{
    (void)width, (void)height;
    extent[0] = 5, extent[1] = 1, extent[2] = 1;
}

static const struct dt_resource resources[RESOURCES] = {
    [COLOR] = {.name = "color",
               .kind = DT_IMAGE,
               .format = DT_FORMAT_RGBA32F,
               .mips = 1,
               .extent = frame_extent},
    [DEPTH] = {.name = "depth",
               .kind = DT_IMAGE,
               .format = DT_FORMAT_D32F,
               .mips = 1,
               .extent = frame_extent},
    [STACK] = {.name = "stack",
               .kind = DT_IMAGE,
               .format = DT_FORMAT_R32UI,
               .mips = 1,
               .layered = true,
               .extent = stack_extent},
    [STACK_DEPTH] = {.name = "stack_depth",
                     .kind = DT_IMAGE,
                     .format = DT_FORMAT_D32F,
                     .mips = 1,
                     .layered = true,
                     .extent = stack_extent},
    [RESULT] = {.name = "result", .kind = DT_BUFFER, .stride = 16, .extent = pixels_extent},
    [ARGUMENTS] = {.name = "arguments",
                   .kind = DT_BUFFER,
                   .stride = 4,
                   .history = true,
                   .extent = arguments_extent},
    [COMMAND] = {.name = "command", .kind = DT_BUFFER, .stride = 4, .extent = command_extent},
    [DISPLAY] = {.name = "display",
                 .kind = DT_IMAGE,
                 .format = DT_FORMAT_RGBA8_SRGB,
                 .mips = 1,
                 .extent = frame_extent},
    [SKIPPED] = {.name = "skipped",
                 .kind = DT_IMAGE,
                 .format = DT_FORMAT_RGBA16F,
                 .mips = 1,
                 .extent = frame_extent},
    [POISONED] = {.name = "poisoned",
                  .kind = DT_IMAGE,
                  .format = DT_FORMAT_RG16F,
                  .mips = 3,
                  .layered = true,
                  .extent = stack_extent},
};
static const struct dt_pass passes[PASSES] = {
    [DRAW] = {.name = "draw"},       [LAYERED] = {.name = "layered"},
    [COMPUTE] = {.name = "compute"}, [INDIRECT] = {.name = "indirect"},
    [AGAIN] = {.name = "again"},     [FULLSCREEN] = {.name = "fullscreen"},
    [SKIP] = {.name = "skip"},
};
static const float live_defaults[4] = {2.0f};
static const struct dt_pipeline pipeline = {
    .name = "test",
    .resources = resources,
    .resource_count = RESOURCES,
    .passes = passes,
    .pass_count = PASSES,
    .live_defaults = live_defaults,
    .live_size = sizeof live_defaults,
    .block_size = sizeof live_defaults,
    .linear_output = COLOR,
    .display_output = DISPLAY,
};

static bool create_draws(struct gl_runtime *rt, struct state *s)
{
    return dt_gl_program_create(
               rt, &s->draw,
               &(struct gl_program_info){.name = "draw",
                                         .vertex = compile(GLSLANG_STAGE_VERTEX, draw_vert),
                                         .fragment = compile(GLSLANG_STAGE_FRAGMENT, draw_frag),
                                         .scene_vertices = true,
                                         .depth_test = true,
                                         .depth_write = true,
                                         .depth_compare = GL_LESS,
                                         .cull = GL_BACK}) &&
           dt_gl_program_create(
               rt, &s->layers,
               &(struct gl_program_info){.name = "layered",
                                         .vertex = compile(GLSLANG_STAGE_VERTEX, layers_vert),
                                         .fragment = compile(GLSLANG_STAGE_FRAGMENT, layers_frag),
                                         .scene_vertices = true,
                                         .depth_test = true,
                                         .depth_write = true,
                                         .depth_compare = GL_LEQUAL,
                                         .cull = GL_NONE}) &&
           dt_gl_program_create(
               rt, &s->full,
               &(struct gl_program_info){.name = "fullscreen",
                                         .vertex = compile(GLSLANG_STAGE_VERTEX, full_vert),
                                         .fragment = compile(GLSLANG_STAGE_FRAGMENT, full_frag),
                                         .cull = GL_NONE,
                                         .blend_add = true});
}

static bool other_indirect; /* in the panel that is created next */
static GLuint created[3];   /* by the last: draw, compute, indirect */

static bool create(void *rt, void *memory)
{
    struct state *s = memory;
    const char *indirect = other_indirect ? idle_comp : indirect_comp;
    bool good =
        create_draws(rt, s) &&
        dt_gl_program_create(
            rt, &s->compute,
            &(struct gl_program_info){.name = "compute",
                                      .compute = compile(GLSLANG_STAGE_COMPUTE, compute_comp)}) &&
        dt_gl_program_create(
            rt, &s->indirect,
            &(struct gl_program_info){.name = "indirect",
                                      .compute = compile(GLSLANG_STAGE_COMPUTE, indirect)});
    created[0] = s->draw.handle;
    created[1] = s->compute.handle;
    created[2] = s->indirect.handle;
    return good;
}

static void release(struct gl_runtime *rt, struct state *s)
{
    for (uint32_t i = 0; i < 4; i++)
        dt_gl_framebuffer_destroy(rt, &s->framebuffers[i]);
    for (uint32_t i = 0; i < RESOURCES; i++) {
        dt_gl_buffer_destroy(rt, &s->buffers[i]);
        dt_gl_image_destroy(rt, &s->images[i]);
    }
}

static bool make_resources(struct gl_runtime *rt, struct state *s, uint32_t width, uint32_t height)
{
    for (uint32_t i = 0; i < RESOURCES; i++) {
        const struct dt_resource *r = &resources[i];
        uint32_t e[3];
        r->extent(width, height, e);
        bool image = r->kind == DT_IMAGE;
        const struct gl_image_info info = {r->name, r->format, e[0],       e[1],
                                           e[2],    r->mips,   r->layered, NULL};
        const struct gl_buffer_info bytes = {.name = r->name, .size = (GLsizeiptr)e[0] * r->stride};
        if (!(image ? dt_gl_image_create(rt, &s->images[i], &info)
                    : dt_gl_buffer_create(rt, &s->buffers[i], &bytes)) ||
            !dt_gl_initialise(rt, image ? NULL : &s->buffers[i], image ? &s->images[i] : NULL,
                              r->history))
            return false;
    }
    return true;
}

static bool resize(void *rt, void *memory, uint32_t width, uint32_t height)
{
    struct state *s = memory;
    release(rt, s);
    if (!make_resources(rt, s, width, height))
        return false;
    struct gl_image *image = s->images;
    s->targets[0] = (struct gl_targets){.color = {{.image = &image[COLOR], .clear = {0, 0, 0, 1}}},
                                        .color_count = 1,
                                        .depth = {.image = &image[DEPTH], .clear = {1}},
                                        .layers = 1};
    s->targets[1] = (struct gl_targets){.color = {{.image = &image[STACK], .clear = {5}}},
                                        .color_count = 1,
                                        .depth = {.image = &image[STACK_DEPTH], .clear = {1}},
                                        .layers = LAYERS};
    s->targets[2] =
        (struct gl_targets){.color = {{.image = &image[DISPLAY]}}, .color_count = 1, .layers = 1};
    s->targets[3] = (struct gl_targets){.color = {{.image = &image[STACK], .load = true}},
                                        .color_count = 1,
                                        .depth = {.image = &image[STACK_DEPTH], .load = true},
                                        .layers = LAYERS};
    for (uint32_t i = 0; i < 4; i++)
        if (!dt_gl_framebuffer_create(rt, &s->framebuffers[i], &s->targets[i]))
            return false;
    return true;
}

static bool record_draws(struct gl_runtime *rt, struct state *s)
{
    const struct gl_builtin *b = dt_gl_builtin(rt);
    const struct gl_binding draw[] = {
        {.binding = 2, .kind = GL_BIND_STORAGE, .buffer = &b->materials},
        {.binding = 0,
         .kind = GL_BIND_TEXTURE,
         .image = &b->textures,
         .sampler = b->texture_sampler},
    };
    return dt_gl_pass_begin(rt, DRAW, true) && dt_gl_bind(rt, draw, DT_ARRAY_COUNT(draw)) &&
           dt_gl_draw_scene(rt, &s->draw, s->framebuffers[0], &s->targets[0], 1) &&
           dt_gl_pass_end(rt, DRAW) && dt_gl_pass_begin(rt, LAYERED, true) &&
           dt_gl_draw_scene(rt, &s->layers, s->framebuffers[1], &s->targets[1], LAYERS) &&
           dt_gl_pass_end(rt, LAYERED);
}

static bool record_compute(struct gl_runtime *rt, struct state *s)
{
    const struct gl_image *color = &s->images[COLOR];
    const struct gl_binding compute[] = {
        {.binding = 0, .kind = GL_BIND_IMAGE, .image = color, .access = GL_READ_ONLY},
        {.binding = 1, .kind = GL_BIND_TEXTURE, .image = &s->images[DEPTH]},
        {.binding = 1, .kind = GL_BIND_UNIFORM, .buffer = &dt_gl_builtin(rt)->live},
        {.binding = 0, .kind = GL_BIND_STORAGE, .buffer = &s->buffers[RESULT]},
        {.binding = 1, .kind = GL_BIND_STORAGE, .buffer = &s->buffers[ARGUMENTS]},
    };
    const struct gl_binding indirect[] = {
        {.binding = 0, .kind = GL_BIND_STORAGE, .buffer = &s->buffers[COMMAND]}};
    return dt_gl_pass_begin(rt, COMPUTE, true) &&
           dt_gl_bind(rt, compute, DT_ARRAY_COUNT(compute)) &&
           dt_gl_barrier(rt, GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT) &&
           dt_gl_dispatch(rt, &s->compute, (color->width + 7) / 8, (color->height + 7) / 8, 1) &&
           dt_gl_pass_end(rt, COMPUTE) && dt_gl_pass_begin(rt, INDIRECT, true) &&
           dt_gl_barrier(rt, GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT) &&
           dt_gl_bind(rt, indirect, DT_ARRAY_COUNT(indirect)) &&
           dt_gl_dispatch_indirect(rt, &s->indirect, &s->buffers[ARGUMENTS]) &&
           dt_gl_pass_end(rt, INDIRECT) && dt_gl_pass_begin(rt, AGAIN, true) &&
           dt_gl_barrier(rt, GL_COMMAND_BARRIER_BIT) &&
           dt_gl_draw_scene_indirect(rt, &s->layers, s->framebuffers[3], &s->targets[3], NULL,
                                     &s->buffers[COMMAND], 1) &&
           dt_gl_pass_end(rt, AGAIN);
}

static bool record(void *rt, void *memory, const void *live)
{
    struct state *s = memory;
    const float clear[4] = {1, 2, 3, 4};
    (void)live;
    return record_draws(rt, s) && record_compute(rt, s) && dt_gl_pass_begin(rt, FULLSCREEN, true) &&
           dt_gl_clear_targets(rt, s->framebuffers[2], &s->targets[2]) &&
           dt_gl_draw_fullscreen(rt, &s->full, s->framebuffers[2], &s->targets[2]) &&
           dt_gl_pass_end(rt, FULLSCREEN) && dt_gl_pass_begin(rt, SKIP, false) &&
           dt_gl_clear_image(rt, &s->images[SKIPPED], 0, clear) &&
           dt_gl_clear_buffer(rt, &s->buffers[COMMAND]) && dt_gl_pass_end(rt, SKIP);
}

static void *resource(void *memory, uint32_t index)
{
    struct state *s = memory;
    return resources[index].kind == DT_IMAGE ? (void *)&s->images[index]
                                             : (void *)&s->buffers[index];
}

static void destroy(void *rt, void *memory)
{
    struct state *s = memory;
    release(rt, s);
    dt_gl_program_destroy(rt, &s->draw);
    dt_gl_program_destroy(rt, &s->layers);
    dt_gl_program_destroy(rt, &s->compute);
    dt_gl_program_destroy(rt, &s->indirect);
    dt_gl_program_destroy(rt, &s->full);
}

static const struct dt_panel panel = {
    .backend = "gl",
    .pipeline = &pipeline,
    .state_size = sizeof(struct state),
    .create = create,
    .resize = resize,
    .record = record,
    .resource = resource,
    .destroy = destroy,
};

/* ---- Scene: a quad over x in -1..0, counter-clockwise ---------------------------------------- */

#define VERTEX(x, y, z, m)                                                                         \
    {                                                                                              \
        {x, y, z}, {0, 0, 1}, {0.25f, 0.5f}, m                                                     \
    }
static const struct dt_vertex vertices[] = {VERTEX(-1, -1, 0.25f, 1), VERTEX(0, -1, 0.25f, 1),
                                            VERTEX(0, 1, 0.25f, 1), VERTEX(-1, 1, 0.25f, 1)};
static const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
static const struct dt_material materials[] = {{.albedo = {1, 1, 1}, .texture = -1},
                                               {.albedo = {0.5f, 0.25f, 0.125f}, .texture = 1}};
static const uint8_t texels[] = {/* 2x1, two layers; then 1x1, two layers */
                                 0, 0, 0, 255, 0, 0, 0, 255, 188, 0, 0, 255,
                                 0, 0, 0, 255, 0, 0, 0, 255, 0,   0, 0, 255};
static const struct dt_scene scene = {vertices, 4, indices, 6, materials, 2, texels, 2, 1, 2, 2};

/* ---- Tests ----------------------------------------------------------------------------------- */

struct messages {
    uint32_t errors, infos;
    char last[1024];
};

static void on_message(void *user, enum dt_level level, const char *message)
{
    struct messages *m = user;
    m->errors += level == DT_ERROR;
    m->infos += level == DT_INFO;
    snprintf(m->last, sizeof m->last, "%s", message);
    if (getenv("DIPTYCH_TEST_VERBOSE"))
        print_message("[%d] %s\n", level, message);
}

static struct dt_runtime_options options_for(struct messages *m, const char *context)
{
    return (struct dt_runtime_options){
        .log = {on_message, m}, .context = context, .debug = true, .timing = true, .poison = 0xab};
}

static struct dt_bytes read_back(void *rt, uint32_t index)
{
    struct dt_bytes bytes;
    assert_true(runtime_gl.read(rt, index, 0, &bytes));
    return bytes;
}

static void check_pixels(void *rt, uint32_t width, uint32_t height, float factor)
{
    struct dt_bytes color = read_back(rt, COLOR), depth = read_back(rt, DEPTH),
                    result = read_back(rt, RESULT);
    assert_int_equal(color.size, (size_t)width * height * 16);
    const float *c = (const float *)color.data, *d = (const float *)depth.data,
                *r = (const float *)result.data;
    for (uint32_t i = 0; i < width * height; i++) {
        bool inside = (float)(i % width) + 0.5f < (float)width * 0.5f;
        float red = inside ? 0.5f : 0.0f;
        assert_true(c[4 * i] == red && c[4 * i + 1] == red / 2 && c[4 * i + 2] == red / 4);
        /* sRGB code 188 decodes to 0.5029; its neighbours 187 and 189 to 0.4969 and 0.5089 */
        assert_true(inside ? fabsf(c[4 * i + 3] - 0.5029f) < 1e-3f : c[4 * i + 3] == 1.0f);
        assert_true(d[i] == (inside ? 0.25f : 1.0f));
        assert_true(r[4 * i] == red * factor && r[4 * i + 3] == d[i]);
    }
    free(color.data);
    free(depth.data);
    free(result.data);
}

/* Texel x, y of a layer after the layered draw of the quad, 10 + layer, and the indirect one of
 * its lower right triangle with base instance 2: 22, in layer 2 only. The diagonal belongs to
 * one of the two. */
static bool stack_value_ok(uint32_t x, uint32_t y, uint32_t layer, uint32_t value)
{
    if (x >= 8)
        return value == 5;
    bool again = layer == 2 && value == 22;
    return layer != 2 || x == y ? value == layer + 10 || again : value == (y < x ? 22u : 12u);
}

static void check_stack(void *rt)
{
    struct dt_bytes stack = read_back(rt, STACK), poisoned = read_back(rt, POISONED);
    for (uint32_t i = 0; i < 16 * 8 * LAYERS; i++)
        assert_true(stack_value_ok(i % 16, i / 16 % 8, i / 128, ((const uint32_t *)stack.data)[i]));
    for (size_t i = 0; i < poisoned.size; i++)
        assert_int_equal(poisoned.data[i], 0xab);
    free(stack.data);
    free(poisoned.data);
}

/* Mips 1 and 2 of the 16 x 8 layers. */
static void check_mips(void *rt)
{
    for (uint32_t mip = 1; mip < 3; mip++) {
        struct dt_bytes bytes;
        assert_true(runtime_gl.read(rt, POISONED, mip, &bytes));
        assert_int_equal(bytes.extent[0], 16 >> mip);
        assert_int_equal(bytes.extent[1], 8 >> mip);
        assert_int_equal(bytes.extent[2], LAYERS);
        assert_int_equal(bytes.size, (16 >> mip) * (8 >> mip) * LAYERS * 4);
        for (size_t i = 0; i < bytes.size; i++)
            assert_int_equal(bytes.data[i], 0xab);
        free(bytes.data);
    }
}

static void check_rest(void *rt, uint32_t frames)
{
    struct dt_bytes arguments = read_back(rt, ARGUMENTS);
    struct dt_bytes display = read_back(rt, DISPLAY), skipped = read_back(rt, SKIPPED);
    assert_int_equal(((const uint32_t *)arguments.data)[3], frames);
    /* sRGB codes of 0.5, 0, 1 are 187.5, 0, 255, and alpha is linear: 127.5; the encoder may
     * round either way */
    assert_in_range(display.data[0], 187, 188);
    assert_int_equal(display.data[1], 0);
    assert_int_equal(display.data[2], 255);
    assert_in_range(display.data[3], 127, 128);
    const uint16_t halves[4] = {0x3c00, 0x4000, 0x4200, 0x4400}; /* 1 2 3 4 */
    assert_memory_equal(skipped.data, halves, 8);
    free(arguments.data);
    free(display.data);
    free(skipped.data);
}

static void check_timings(void *rt)
{
    double ms[PASSES];
    assert_true(runtime_gl.timings(rt, ms));
    for (uint32_t i = 0; i < PASSES; i++)
        assert_true(i == SKIP ? isnan(ms[i]) : ms[i] > 0.0 && ms[i] < 60e3);
}

static void run_all(const char *context, bool glsl)
{
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, context);
    options.glsl = glsl;
    void *rt = runtime_gl.open(&options);
    if (!rt)
        print_error("%s\n", m.last);
    assert_non_null(rt);
    assert_true(runtime_gl.set_scene(rt, &scene) && runtime_gl.create(rt, &panel));
    static const uint32_t sizes[][2] = {{64, 32}, {33, 17}, {1, 1}};
    const struct dt_frame frame = {.index = 0};
    for (size_t i = 0; i < DT_ARRAY_COUNT(sizes); i++) {
        assert_true(runtime_gl.resize(rt, sizes[i][0], sizes[i][1]));
        const float live[4] = {4.0f};
        assert_true(runtime_gl.render(rt, &frame, NULL, NULL) &&
                    runtime_gl.render(rt, &frame, live, NULL));
        check_pixels(rt, sizes[i][0], sizes[i][1], 4.0f);
        check_stack(rt);
        check_mips(rt);
        check_rest(rt, 2);
        check_timings(rt);
    }
    assert_int_equal(runtime_gl.messages(rt), 0);
    assert_int_equal(m.errors, 0);
    runtime_gl.close(rt);
    assert_int_equal(m.errors, 0);
}

static void test_spirv(void **state)
{
    (void)state;
    run_all(NULL, false);
}
static void test_glsl(void **state)
{
    (void)state;
    run_all("egl", true);
}
static void test_osmesa(void **state)
{
    (void)state;
    run_all("osmesa", false);
}

/* Mesa has one driver in a process: zink runs in one of its own, this program with an argument. */
static bool zink_is_installed(void)
{
    glob_t found;
    bool installed = glob("/usr/lib/*/dri/zink_dri.so", 0, NULL, &found) == 0;
    globfree(&found);
    return installed;
}

static void test_zink(void **state)
{
    (void)state;
    if (!zink_is_installed()) {
        print_message("# no /usr/lib/*/dri/zink_dri.so: install libgl1-mesa-dri\n");
        skip();
    }
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setenv("CMOCKA_MESSAGE_OUTPUT", "STDOUT", 1); /* its results are one of ours */
        execl("/proc/self/exe", "runtime_gl_test", "zink", NULL);
        _exit(127);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void test_zink_frames(void **state)
{
    (void)state;
    run_all("zink", false);
    run_all("zink", true);
}

static void test_zink_is_told(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, "zink");
    void *rt = runtime_gl.open(&options);
    assert_non_null(rt);
    assert_non_null(strstr(runtime_gl.device_name(rt), "zink"));
    runtime_gl.close(rt);
}

static void test_window(void **state)
{
    (void)state;
    if (!getenv("DISPLAY"))
        skip();
    run_all("window", false);
}

/* ---- Several at once, observers -------------------------------------------------------------- */

struct watcher {
    void *rt, *other;
    uint32_t calls, stop_at;
};

/* Renders with the other runtime in the middle of this one's frame. */
static bool after_pass(void *user, uint32_t pass)
{
    struct watcher *w = user;
    const struct dt_frame frame = {.index = 0};
    assert_int_equal(pass, w->calls);
    w->calls++;
    assert_true(runtime_gl.render(w->other, &frame, NULL, NULL));
    struct dt_bytes bytes = read_back(w->rt, COLOR);
    assert_true(*(const float *)bytes.data == 0.5f);
    free(bytes.data);
    return w->calls != w->stop_at;
}

/* An edit takes over what it leaves as it was, and nothing else. */
static void test_programs_go_on(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, NULL);
    const struct dt_frame frame = {.index = 0};
    void *rt = runtime_gl.open(&options);
    assert_true(rt && runtime_gl.set_scene(rt, &scene) && runtime_gl.create(rt, &panel));
    const GLuint before[3] = {created[0], created[1], created[2]};
    other_indirect = true;
    bool good = runtime_gl.create(rt, &panel);
    other_indirect = false;
    assert_true(good);
    assert_true(created[0] == before[0] && created[1] == before[1]);
    assert_true(created[2] != before[0] && created[2] != before[1] && created[2] != before[2]);
    assert_true(runtime_gl.create(rt, &panel) && runtime_gl.resize(rt, 20, 10) &&
                runtime_gl.render(rt, &frame, NULL, NULL));
    assert_int_equal(created[1], before[1]);
    check_pixels(rt, 20, 10, 2.0f);
    runtime_gl.close(rt);
}

static void test_two_runtimes(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options first = options_for(&m, "egl"), second = options_for(&m, "osmesa");
    void *a = runtime_gl.open(&first), *b = runtime_gl.open(&second), *c = runtime_gl.open(&first);
    void *const all[] = {a, b, c};
    for (size_t i = 0; i < DT_ARRAY_COUNT(all); i++)
        assert_true(all[i] && runtime_gl.set_scene(all[i], &scene) &&
                    runtime_gl.create(all[i], &panel) && runtime_gl.resize(all[i], 20, 10));
    const struct dt_frame frame = {.index = 0};
    struct watcher watcher = {.rt = a, .other = b};
    const struct dt_observer observer = {.after_pass = after_pass, .user = &watcher};
    assert_true(runtime_gl.render(a, &frame, NULL, &observer));
    assert_int_equal(watcher.calls, PASSES);
    runtime_gl.close(a);
    assert_true(runtime_gl.render(c, &frame, NULL, NULL)); /* lives on when its neighbour is gone */
    watcher = (struct watcher){.rt = c, .other = b, .stop_at = 2};
    assert_false(runtime_gl.render(c, &frame, NULL, &observer));
    assert_int_equal(watcher.calls, 2);
    assert_true(runtime_gl.render(c, &frame, NULL, NULL)); /* and a stopped frame leaves no trace */
    check_pixels(b, 20, 10, 2.0f);
    check_pixels(c, 20, 10, 2.0f);
    assert_int_equal(m.errors, 0);
    runtime_gl.close(c);
    runtime_gl.close(b);
}

/* Decides about passes before they run, and may paint what `compute` reads. */
struct director {
    void *rt;
    uint32_t calls, stop_at;
    enum dt_action action; /* for every pass but the one to stop at */
    const struct dt_bytes *color;
};

static enum dt_action before_pass(void *user, uint32_t pass)
{
    struct director *d = user;
    assert_int_equal(pass, d->calls++);
    if (pass == COMPUTE && d->color)
        assert_true(runtime_gl.write(d->rt, COLOR, 0, d->color));
    return pass == d->stop_at ? DT_STOP : d->action;
}

static void *open_ready(struct messages *m, uint32_t width, uint32_t height)
{
    struct dt_runtime_options options = options_for(m, "egl");
    void *rt = runtime_gl.open(&options);
    assert_non_null(rt);
    assert_true(runtime_gl.set_scene(rt, &scene) && runtime_gl.create(rt, &panel) &&
                runtime_gl.resize(rt, width, height));
    return rt;
}

/* What is written before a pass is what the pass reads: result is color times the factor 2. */
static void test_write_before_pass(void **state)
{
    (void)state;
    struct messages m = {0};
    const struct dt_frame frame = {.index = 0};
    void *rt = open_ready(&m, 20, 10);
    assert_true(runtime_gl.render(rt, &frame, NULL, NULL));
    struct dt_bytes color = read_back(rt, COLOR);
    for (uint32_t i = 0; i < color.size / 4; i++)
        ((float *)color.data)[i] = (float)i;
    struct director director = {.rt = rt, .stop_at = UINT32_MAX, .color = &color};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    assert_true(runtime_gl.render(rt, &frame, NULL, &observer));
    assert_int_equal(director.calls, PASSES);
    struct dt_bytes result = read_back(rt, RESULT);
    for (uint32_t i = 0; i < result.size / 4; i++)
        if (i % 4 != 3) /* the depth */
            assert_true(((float *)result.data)[i] == 2.0f * (float)i);
    check_stack(rt); /* the other passes ran as ever */
    check_rest(rt, 2);
    free(color.data);
    free(result.data);
    assert_int_equal(m.errors, 0);
    runtime_gl.close(rt);
}

/* Passes that are skipped leave every resource as it was, their clears included. */
static void test_skipped_passes(void **state)
{
    (void)state;
    struct messages m = {0};
    const struct dt_frame frame = {.index = 0};
    void *rt = open_ready(&m, 20, 10);
    for (uint32_t i = 0; i < POISONED; i++) { /* which no pass writes */
        struct dt_bytes bytes = read_back(rt, i);
        memset(bytes.data, 0x3e, bytes.size); /* as float 0.19, which a depth may be */
        assert_true(runtime_gl.write(rt, i, 0, &bytes));
        free(bytes.data);
    }
    struct director director = {.stop_at = UINT32_MAX, .action = DT_SKIP};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    assert_true(runtime_gl.render(rt, &frame, NULL, &observer));
    assert_int_equal(director.calls, PASSES);
    for (uint32_t i = 0; i < POISONED; i++) {
        struct dt_bytes bytes = read_back(rt, i);
        for (size_t k = 0; k < bytes.size; k++)
            assert_int_equal(bytes.data[k], 0x3e);
        free(bytes.data);
    }
    double ms[PASSES];
    assert_true(runtime_gl.timings(rt, ms));
    for (uint32_t i = 0; i < PASSES; i++)
        assert_true(isnan(ms[i]));
    assert_true(runtime_gl.render(rt, &frame, NULL, NULL)); /* the next frame skips nothing */
    check_pixels(rt, 20, 10, 2.0f);
    check_stack(rt);
    check_rest(rt, 0x3e3e3e3e + 1);
    assert_int_equal(m.errors, 0);
    runtime_gl.close(rt);
}

/* Whoever stops a frame has said why: the runtime adds nothing, and lives on. */
static void test_stopped_before_pass(void **state)
{
    (void)state;
    struct messages m = {0};
    const struct dt_frame frame = {.index = 0};
    void *rt = open_ready(&m, 20, 10);
    struct director director = {.stop_at = COMPUTE};
    const struct dt_observer observer = {.before_pass = before_pass, .user = &director};
    assert_false(runtime_gl.render(rt, &frame, NULL, &observer));
    assert_int_equal(director.calls, COMPUTE + 1);
    struct dt_bytes arguments = read_back(rt, ARGUMENTS);
    assert_int_equal(((const uint32_t *)arguments.data)[3], 0); /* compute did not run */
    free(arguments.data);
    assert_true(runtime_gl.resize(rt, 33, 17));
    assert_true(runtime_gl.render(rt, &frame, NULL, NULL));
    check_pixels(rt, 33, 17, 2.0f);
    check_rest(rt, 1);
    assert_int_equal(m.errors, 0);
    runtime_gl.close(rt);
}

/* ---- A lost device --------------------------------------------------------------------------- */

/* The driver says so by the status alone, as Mesa does, or by every call's error as well. */
static struct {
    GLenum status; /* GL_NO_ERROR: none was lost */
    bool errors;
    PFNGLGETERRORPROC error;
    PFNGLGETGRAPHICSRESETSTATUSPROC reset_status;
} lost;

static GLenum APIENTRY lost_error(void)
{
    return lost.status && lost.errors ? GL_CONTEXT_LOST : lost.error();
}

static GLenum APIENTRY lost_status(void)
{
    return lost.status ? lost.status : lost.reset_status();
}

/* Stands before the function of libEGL, through which glad loads OpenGL's. */
__eglMustCastToProperFunctionPointerType eglGetProcAddress(const char *name)
{
    __typeof__(&eglGetProcAddress) real;
    *(void **)&real = dlsym(RTLD_NEXT, "eglGetProcAddress");
    __eglMustCastToProperFunctionPointerType function = real(name);
    if (strcmp(name, "glGetError") == 0) {
        lost.error = (PFNGLGETERRORPROC)function;
        return (__eglMustCastToProperFunctionPointerType)lost_error;
    }
    if (strcmp(name, "glGetGraphicsResetStatus") == 0) {
        lost.reset_status = (PFNGLGETGRAPHICSRESETSTATUSPROC)function;
        return (__eglMustCastToProperFunctionPointerType)lost_status;
    }
    return function;
}

struct loss {
    GLenum status;
    uint32_t pass;
};

static enum dt_action lose(void *user, uint32_t pass)
{
    const struct loss *loss = user;
    if (pass == loss->pass)
        lost.status = loss->status;
    return DT_RUN;
}

static void check_loss(bool errors)
{
    static const struct {
        struct loss loss;
        const char *pass, *why;
    } cases[] = {
        {{GL_GUILTY_CONTEXT_RESET, COMPUTE}, "pass compute: gl", "because of this program"},
        {{GL_INNOCENT_CONTEXT_RESET, DRAW}, "pass draw: gl", "because of another program"},
        {{GL_UNKNOWN_CONTEXT_RESET, SKIP}, "pass skip: gl", "does not say why"},
    };
    const struct dt_frame frame = {.index = 0};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        struct messages m = {0};
        void *rt = open_ready(&m, 20, 10);
        struct loss loss = cases[i].loss;
        const struct dt_observer observer = {.before_pass = lose, .user = &loss};
        lost.errors = errors;
        assert_false(runtime_gl.render(rt, &frame, NULL, &observer));
        assert_int_equal(m.errors, 1);
        assert_non_null(strstr(m.last, cases[i].pass));
        assert_non_null(strstr(m.last, cases[i].why));
        assert_false(runtime_gl.render(rt, &frame, NULL, NULL)); /* it stays lost */
        assert_int_equal(m.errors, 2);
        runtime_gl.close(rt);
        lost.status = GL_NO_ERROR;
    }
}

static void test_lost_device(void **state)
{
    (void)state;
    check_loss(false);
    check_loss(true);
}

/* What is lost can only be told by a context that was made to tell. */
static void test_loss_is_told(void **state)
{
    (void)state;
    struct messages m = {0};
    void *rt = open_ready(&m, 20, 10);
    const char *extensions = eglQueryString(eglGetCurrentDisplay(), EGL_EXTENSIONS);
    if (!strstr(extensions, "EGL_EXT_create_context_robustness")) {
        print_message("# EGL has no EGL_EXT_create_context_robustness\n");
        runtime_gl.close(rt);
        skip();
    }
    PFNGLGETINTEGERVPROC get = (PFNGLGETINTEGERVPROC)eglGetProcAddress("glGetIntegerv");
    GLint strategy = 0;
    get(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
    assert_int_equal(strategy, GL_LOSE_CONTEXT_ON_RESET);
    runtime_gl.close(rt);
    assert_int_equal(m.errors, 0);
}

/* ---- Errors ---------------------------------------------------------------------------------- */

static void expect_error(struct messages *m, const char *part)
{
    if (m->errors != 1 || !strstr(m->last, part))
        print_error("%u errors, the last: %s\n", m->errors, m->last);
    assert_int_equal(m->errors, 1);
    assert_non_null(strstr(m->last, part));
    m->errors = 0;
}

static void test_errors(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, "telepathy");
    assert_null(runtime_gl.open(&options));
    expect_error(&m, "telepathy");

    options = options_for(&m, NULL);
    options.debug = options.timing = false;
    void *rt = runtime_gl.open(&options);
    assert_non_null(rt);
    const struct dt_frame frame = {.index = 0};
    struct dt_bytes bytes;
    double ms[PASSES];
    assert_false(runtime_gl.render(rt, &frame, NULL, NULL));
    expect_error(&m, "resize");
    assert_false(runtime_gl.read(rt, COLOR, 0, &bytes));
    expect_error(&m, "resize");
    assert_true(runtime_gl.create(rt, &panel));
    assert_false(runtime_gl.resize(rt, 1u << 20, 4));
    expect_error(&m, "color: 1048576x4");
    assert_false(runtime_gl.resize(rt, 0, 4));
    expect_error(&m, "color: 0x4");
    assert_true(runtime_gl.resize(rt, 8, 8));
    assert_false(runtime_gl.read(rt, POISONED, 3, &bytes));
    expect_error(&m, "read poisoned: mip 3, and it has 3");
    assert_false(runtime_gl.timings(rt, ms));
    expect_error(&m, "without timing");
    assert_false(runtime_gl.render(rt, &frame, NULL, NULL));
    expect_error(&m, "draw");
    assert_true(runtime_gl.set_scene(rt, &scene) && runtime_gl.render(rt, &frame, NULL, NULL));
    runtime_gl.close(rt);
    runtime_gl.close(NULL);
}

/* Mesa can be told to find no errors; a run under it would prove nothing. */
static void test_no_error_context(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, NULL);
    options.debug = false;
    setenv("MESA_NO_ERROR", "1", 1);
    assert_null(runtime_gl.open(&options));
    unsetenv("MESA_NO_ERROR");
    expect_error(&m, "unset MESA_NO_ERROR");
}

static void test_bad_resources(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, NULL);
    options.debug = false;
    options.glsl = true;
    void *rt = runtime_gl.open(&options);
    assert_non_null(rt);
    struct gl_program program = {0};
    const struct gl_program_info text = {
        .name = "broken", .compute = {.glsl = "#version 460\nvoid main() { x = 1; }\n"}};
    assert_false(dt_gl_program_create(rt, &program, &text));
    expect_error(&m, "pass broken: compiling the compute shader");
    dt_gl_program_destroy(rt, &program);

    struct gl_buffer buffer = {0};
    assert_false(dt_gl_buffer_create(
        rt, &buffer, &(struct gl_buffer_info){.name = "huge", .size = (GLsizeiptr)1 << 50}));
    expect_error(&m, "huge");
    dt_gl_buffer_destroy(rt, &buffer);
    /* what shaders declare counts, not what is written */
    const struct gl_buffer wide = {.name = "wide", .size = 16, .block = (GLsizeiptr)1 << 50};
    const struct gl_binding binding = {.kind = GL_BIND_UNIFORM, .buffer = &wide};
    assert_false(dt_gl_bind(rt, &binding, 1));
    expect_error(&m, "wide: 1125899906842624 bytes");
    struct gl_image image = {0};
    const struct gl_image_info deep = {"deep", DT_FORMAT_R8, 4, 4, 1u << 20, 1, true, NULL};
    assert_false(dt_gl_image_create(rt, &image, &deep));
    expect_error(&m, "deep");
    dt_gl_image_destroy(rt, &image);

    struct gl_image owner = {0};
    struct gl_image_info small = {"small", DT_FORMAT_R8, 4, 4, 1, 1, false, NULL};
    assert_true(dt_gl_image_create(rt, &owner, &small));
    struct gl_image_info borrower = {"borrower", DT_FORMAT_R8, 4, 4, 1, 1, false, &owner};
    assert_true(dt_gl_image_create(rt, &image, &borrower));
    assert_int_equal(image.handle, owner.handle);
    dt_gl_image_destroy(rt, &image); /* leaves the texture to its owner */
    assert_true(dt_gl_initialise(rt, NULL, &owner, true));
    borrower.width = 8;
    assert_false(dt_gl_image_create(rt, &image, &borrower));
    expect_error(&m, "borrower");
    dt_gl_image_destroy(rt, &image);
    dt_gl_image_destroy(rt, &owner);
    runtime_gl.close(rt);
}

/* A misuse that only the driver can see is told by the callback and by the failing call, and
 * counted. */
static void test_debug_messages(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options options = options_for(&m, NULL);
    void *rt = runtime_gl.open(&options);
    assert_non_null(rt);
    const struct gl_buffer ghost = {.name = "ghost", .handle = 12345, .size = 16};
    assert_false(dt_gl_clear_buffer(rt, &ghost));
    assert_non_null(strstr(m.last, "ghost: glClearNamedBufferData"));
    assert_int_equal(runtime_gl.messages(rt), 1);
    assert_int_equal(m.errors, 2);
    runtime_gl.close(rt);
}

/* ---- zink, after another driver: that one stays ---------------------------------------------- */

static void test_zink_too_late(void **state)
{
    (void)state;
    struct messages m = {0};
    struct dt_runtime_options first = options_for(&m, "egl"), second = options_for(&m, "zink");
    void *rt = runtime_gl.open(&first);
    assert_non_null(rt);
    assert_null(runtime_gl.open(&second));
    assert_int_equal(m.errors, 1);
    assert_non_null(strstr(m.last, "context zink: the driver that came up is "));
    assert_non_null(strstr(m.last, runtime_gl.device_name(rt)));
    runtime_gl.close(rt);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest zink[] = {
        cmocka_unit_test(test_zink_frames),
        cmocka_unit_test(test_zink_is_told),
    };
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_zink),
        cmocka_unit_test(test_spirv),
        cmocka_unit_test(test_glsl),
        cmocka_unit_test(test_osmesa),
        cmocka_unit_test(test_window),
        cmocka_unit_test(test_programs_go_on),
        cmocka_unit_test(test_two_runtimes),
        cmocka_unit_test(test_write_before_pass),
        cmocka_unit_test(test_skipped_passes),
        cmocka_unit_test(test_stopped_before_pass),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_bad_resources),
        cmocka_unit_test(test_debug_messages),
        cmocka_unit_test(test_lost_device),
        cmocka_unit_test(test_no_error_context),
        cmocka_unit_test(test_loss_is_told),
        cmocka_unit_test(test_zink_too_late),
    };
    if (count > 1 && strcmp(arguments[1], "zink") == 0)
        return cmocka_run_group_tests_name("runtime_gl, zink", zink, NULL, NULL);
    return cmocka_run_group_tests_name("runtime_gl", tests, NULL, NULL);
}
