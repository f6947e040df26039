/* The OpenGL library in a context of the host's: wrong calls, vertices of another layout, shared
 * programs, inputs, imports, parts of frames, times. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <GL/glcorearb.h>

#include "layouts.h"
#include "library.h"
#include "runtime_gl/diptych_gl.h"
#include "shapes.h"

static _Alignas(16) char geometry[GEOMETRY_BYTES]; /* as of lay_triangle */

static int open_with_triangle(void **state)
{
    lay_triangle(geometry);
    return open_opengl(state);
}

/* What a test leaves: a context without errors. */
static int is_without_error(void **state)
{
    (void)state;
    assert_int_equal(glGetError(), GL_NO_ERROR);
    return 0;
}

static struct dt_gl_host gl_host(void)
{
    return (struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress};
}

/* A runtime; with shaders it has their pipeline, made for a frame. */
static struct dt_gl_runtime *open_gl_runtime(struct dt_gl_host host,
                                             const struct dt_shaders *shaders)
{
    struct dt_gl_runtime *rt = dt_gl_open(&host);
    assert_non_null(rt);
    assert_true(!shaders || (dt_gl_create(rt, shaders) && dt_gl_resize(rt, WIDTH, HEIGHT)));
    return rt;
}

static void (*no_function(const char *name))(void)
{
    (void)name;
    return NULL;
}

static struct dt_gl_scene gl_scene(void)
{
    GLuint buffers[2];
    glCreateBuffers(2, buffers);
    glNamedBufferStorage(buffers[0], GEOMETRY_BYTES, geometry, 0);
    glNamedBufferStorage(buffers[1], 12, geometry + INDICES, 0);
    return (struct dt_gl_scene){
        .vertices = {buffers[0], 0, 3 * sizeof(struct dt_vertex)},
        .indices = {buffers[1], 0, 12},
        .index_count = 3,
        .materials = {buffers[0], MATERIALS, DT_MAX_MATERIALS * sizeof(struct dt_material)},
        .objects = {buffers[0], OBJECTS, sizeof(struct dt_object)},
        .numbered = true};
}

static GLuint texture_of(GLenum format, GLsizei width)
{
    GLuint texture;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, width, HEIGHT);
    return texture;
}

TEST_WITH(opengl_tells_wrong_calls, NULL, is_without_error)
{
    const struct dt_gl_scene right = gl_scene();
    struct dt_gl_scene scene = right;
    struct dt_frame frame = frame_of(0);
    struct dt_gl_resource resource;
    double ms[FEATURES_PASSES];
    REFUSED(dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = no_function}),
            "get_proc_address");
    struct dt_gl_runtime *rt = open_gl_runtime(gl_host(), NULL);
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "import_scene");
    REFUSED(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, 1), "create comes first");
    REFUSED(dt_gl_create(rt, &features_vk), "the shaders are for vk; give features_gl");
    struct dt_panel newer = features_panel;
    newer.version = DT_MAKE_VERSION(DT_VERSION_MAJOR, DT_VERSION_MINOR + 1, 2);
    struct dt_shaders other = features_gl;
    struct dt_program programs[FEATURES_PASSES];
    other.panel = &newer;
    REFUSED(dt_gl_create(rt, &other),
            "the pipeline is from diptych-gen 0.2.2, this library is 0.1");
    newer.version = DT_MAKE_VERSION(DT_VERSION_MAJOR + 1, DT_VERSION_MINOR, 0);
    REFUSED(dt_gl_create(rt, &other), "generate the pipeline again");
    const struct dt_demand much = {FEATURES_PASS_SLICE, DT_LIMIT_SHARED_BYTES, 1 << 30};
    newer = features_panel;
    newer.demands = &much;
    newer.demand_count = 1;
    REFUSED(dt_gl_create(rt, &other),
            "pass slice needs 1,073,741,824 bytes of shared memory; the device ");
    scene.index_count = 4;
    REFUSED(dt_gl_import_scene(rt, &scene), "4 indices");
    scene = right;
    scene.indices.offset = 256;
    REFUSED(dt_gl_import_scene(rt, &scene), "offset 256");
    scene = right;
    scene.materials.size = 32;
    REFUSED(dt_gl_import_scene(rt, &scene), "scene materials");
    scene = right;
    scene.objects.buffer = 0;
    assert_true(dt_gl_import_scene(rt, &scene));
    assert_true(dt_gl_create(rt, &features_gl));
    struct dt_gl_host wants_text = gl_host();
    wants_text.glsl = true;
    struct dt_gl_runtime *text = open_gl_runtime(wants_text, NULL);
    REFUSED(dt_gl_create(text, &features_gl), "generate with diptych-gen --glsl");
    dt_gl_close(text);
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "the pass keep reads scene_objects");
    scene = right;
    scene.numbered = false;
    newer = features_with_numbers(programs);
    assert_true(dt_gl_create(rt, &other) && dt_gl_import_scene(rt, &scene));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "reads vertex_triangle; number the triangles");
    assert_true(dt_gl_create(rt, &features_gl));
    assert_true(dt_gl_import_scene(rt, &right));
    REFUSED(dt_gl_record(rt, &frame, NULL), "call resize first");
    REFUSED(dt_gl_get_resource(rt, 0, &resource), "resize comes first");
    REFUSED(dt_gl_import_image(rt, FEATURES_RESOURCE_MEMORY, 1), "no image");
    assert_true(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, texture_of(GL_RGBA8, WIDTH)));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "image trail: imported");
    assert_true(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, texture_of(GL_RGBA32F, 5)));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "5x16");
    GLuint trail = texture_of(GL_RGBA32F, WIDTH);
    assert_true(dt_gl_import_image(rt, FEATURES_RESOURCE_TRAIL, trail));
    assert_true(dt_gl_resize(rt, WIDTH, HEIGHT));
    REFUSED(dt_gl_timings(rt, 0, ms), "timing");
    REFUSED(dt_gl_record(rt, &(const struct dt_frame){0}, NULL),
            "`camera` of the struct dt_frame is zero");
    assert_true(dt_gl_record(rt, &frame, NULL));
    assert_true(dt_gl_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    assert_int_equal(resource.texture, trail);
    REFUSED(dt_gl_get_resource(rt, FEATURES_RESOURCE_HISTOGRAM, &resource),
            "resource histogram: other passes may reuse its memory; give it `keep: true`");
    dt_gl_close(rt);
    dt_gl_close(NULL);
}

TEST_WITH(opengl_tells_errors_that_were_there, NULL, is_without_error)
{
    glEnable(GL_RGBA8); /* no capability: GL_INVALID_ENUM */
    heard.warnings = heard.errors = 0;
    struct dt_gl_runtime *rt = open_gl_runtime(gl_host(), NULL);
    assert_int_equal(heard.warnings, 1);
    assert_int_equal(heard.errors, 0);
    assert_non_null(strstr(heard.text, "0x500"));
    dt_gl_close(rt);
}

TEST_WITH(opengl_needs_no_scene_that_nobody_sees, NULL, is_without_error)
{
    struct dt_frame frame = frame_of(0);
    struct dt_gl_runtime *rt = open_gl_runtime(gl_host(), &layouts_gl);
    assert_true(dt_gl_record(rt, &frame, NULL));
    REFUSED(!dt_gl_create(rt, &features_gl) || dt_gl_resize(rt, WIDTH, HEIGHT), "import_scene");
    dt_gl_close(rt);
}

static void opengl_draw(const struct dt_gl_scene *scene, uint8_t trail[TRAIL_BYTES])
{
    struct dt_frame frame = frame_of(0);
    struct dt_gl_resource resource = {0};
    struct dt_gl_runtime *rt = open_gl_runtime(gl_host(), NULL);
    assert_true(dt_gl_import_scene(rt, scene) && dt_gl_create(rt, &features_gl) &&
                dt_gl_resize(rt, WIDTH, HEIGHT) && dt_gl_record(rt, &frame, NULL) &&
                dt_gl_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    glGetTextureImage(resource.texture, 0, GL_RGBA, GL_FLOAT, TRAIL_BYTES, trail);
    dt_gl_close(rt);
}

TEST_WITH(opengl_draws_vertices_of_another_layout, NULL, is_without_error)
{
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    for (int turned = 0; turned < 2; turned++) {
        lay_out(geometry, (float)turned);
        struct dt_gl_scene scene = gl_scene();
        unsigned buffer = scene.vertices.buffer;
        opengl_draw(&scene, wanted);
        scene.vertices.buffer = 0;
        scene.attributes[DT_POSITION] = (struct dt_gl_attribute){buffer, OWN_POSITIONS, 16};
        for (int i = DT_NORMAL; i <= DT_MATERIAL; i++)
            scene.attributes[i] =
                (struct dt_gl_attribute){buffer, OWN_REST + own_places[i], OWN_BYTES};
        opengl_draw(&scene, found);
        assert_int_equal(memcmp(wanted, found, TRAIL_BYTES) != 0, turned);
    }
}

static struct dt_gl_runtime *outside_gl_runtime;

static bool opengl_writes(uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    return dt_gl_write(outside_gl_runtime, resource, mip, bytes);
}

static bool opengl_records(void)
{
    struct dt_frame frame = frame_of(0);
    return dt_gl_record(outside_gl_runtime, &frame, NULL);
}

/* The picture of the last frame must have this colour. */
static void opengl_painted(const uint8_t color[4])
{
    static uint8_t texels[4 * WIDTH * HEIGHT];
    struct dt_gl_resource picture = {0};
    assert_true(dt_gl_get_resource(outside_gl_runtime, OUTSIDE_RESOURCE_PICTURE, &picture));
    glGetTextureImage(picture.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, sizeof texels, texels);
    is_painted(texels, color);
}

static void opengl_paints(const uint8_t color[4])
{
    assert_true(opengl_records());
    opengl_painted(color);
}

static bool opengl_records_passes(uint32_t first, uint32_t end)
{
    const struct dt_frame frame = frame_of(0);
    return dt_gl_record_passes(outside_gl_runtime, first ? NULL : &frame, NULL, first, end);
}

TEST_WITH(opengl_records_parts, NULL, is_without_error)
{
    const float one[4] = {1, 1, 1, 1};
    struct dt_gl_resource blurred = {0}, picture;
    struct dt_gl_runtime *rt = outside_gl_runtime = open_gl_runtime(gl_host(), &outside_gl);
    write_for_blurred(opengl_writes);
    REFUSED(opengl_records_passes(1, 2), "begins with pass 1, but the frame goes on with pass 0");
    opengl_paints(black);
    assert_true(opengl_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_gl_get_resource(rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    REFUSED(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_PICTURE, &picture),
            "resource picture: a later part of this frame writes it");
    REFUSED(opengl_records(),
            "record: begins with pass 0, but the frame goes on with pass 1, grade");
    glClearTexImage(blurred.texture, 0, GL_RGBA, GL_FLOAT, one);
    assert_true(opengl_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES));
    opengl_painted(white);
    dt_gl_close(rt);
}

/* `glsl`: uses the GLSL text in the generated C, not the SPIR-V. */
static void take_inputs(bool glsl)
{
    struct dt_gl_runtime *rt = dt_gl_open(
        &(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress, .glsl = glsl});
    outside_gl_runtime = rt;
    assert_true(rt && dt_gl_create(rt, &outside_gl));
    for (int turn = 0; turn < 2; turn++) { /* a resize drops all content */
        assert_true(dt_gl_resize(rt, WIDTH, HEIGHT));
        REFUSED(opengl_records(), "mip 0 of the input kernel has no content");
        hand_in(opengl_writes, opengl_records, first_color);
        opengl_paints(first_color);
        write_grade(opengl_writes, second_color);
        opengl_paints(second_color);
    }
    /* an imported image needs no content, and refuses content */
    struct dt_bytes photo = bytes_of(OUTSIDE_RESOURCE_PHOTO, 0);
    assert_true(
        dt_gl_import_image(rt, OUTSIDE_RESOURCE_PHOTO, texture_of(GL_SRGB8_ALPHA8, WIDTH)) &&
        dt_gl_resize(rt, WIDTH, HEIGHT));
    REFUSED(opengl_writes(OUTSIDE_RESOURCE_PHOTO, 0, &photo),
            "write photo: it is imported; write the host's own object");
    assert_true(dt_gl_import_image(rt, OUTSIDE_RESOURCE_PHOTO, 0)); /* canceled */
    REFUSED(opengl_writes(OUTSIDE_RESOURCE_PHOTO, 0, &photo), "write: call resize first");
    free(photo.data);
    dt_gl_close(rt);
}

TEST_WITH(opengl_takes_inputs, NULL, is_without_error)
{
    take_inputs(false);
}

TEST_WITH(opengl_takes_text, NULL, is_without_error)
{
    take_inputs(true);
}

TEST_WITH(opengl_takes_buffers_and_describes_all, NULL, is_without_error)
{
    struct dt_gl_range weights = {.offset = 1024, .size = 16};
    struct dt_gl_resource found;
    glCreateBuffers(1, &weights.buffer);
    glNamedBufferStorage(weights.buffer, 4096, NULL, GL_DYNAMIC_STORAGE_BIT);
    glNamedBufferSubData(weights.buffer, 1024, sizeof graded_alone, graded_alone);
    struct dt_gl_runtime *rt = outside_gl_runtime = open_gl_runtime(gl_host(), NULL);
    assert_true(dt_gl_create(rt, &outside_gl));
    REFUSED(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_PHOTO, &weights), "has no buffer");
    assert_true(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "weights: 16 bytes at offset 1024 given; at least 32");
    weights.size = 3072;
    assert_true(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_gl_resize(rt, WIDTH, HEIGHT));
    write_inputs(opengl_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(opengl_writes, first_color);
    opengl_paints(first_color);
    glNamedBufferSubData(weights.buffer, 1024, sizeof nothing, nothing);
    opengl_paints(black);
    assert_true(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_WEIGHTS, &found));
    assert_true(found.buffer == weights.buffer && found.offset == 1024 && found.size == 32 &&
                found.stride == 16 && !found.texture);
    assert_true(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_SOFT, &found));
    assert_true(found.texture && found.target == GL_TEXTURE_2D && found.format == GL_RGBA16F &&
                found.layers == 1 && found.mips == 3 && !found.buffer);
    dt_gl_close(rt);
}

TEST_WITH(opengl_takes_3d_images_and_cubes, NULL, is_without_error)
{
    struct dt_frame frame = frame_of(0);
    uint16_t texel[4];
    GLuint fog, sky, probes, flat = texture_of(GL_RGBA16F, 8);
    glCreateTextures(GL_TEXTURE_3D, 1, &fog);
    glTextureStorage3D(fog, 3, GL_RGBA16F, 8, 6, 5);
    glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &sky);
    glTextureStorage2D(sky, 2, GL_RGBA16F, 8, 8);
    glCreateTextures(GL_TEXTURE_CUBE_MAP_ARRAY, 1, &probes);
    glTextureStorage3D(probes, 1, GL_RGBA8, 4, 4, 12);
    struct dt_gl_runtime *rt = open_gl_runtime(gl_host(), NULL);
    assert_true(dt_gl_create(rt, &shapes_gl));
    assert_true(dt_gl_import_image(rt, SHAPES_RESOURCE_FOG, flat));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "image fog: imported");
    assert_true(dt_gl_import_image(rt, SHAPES_RESOURCE_FOG, fog) &&
                dt_gl_import_image(rt, SHAPES_RESOURCE_SKY, sky) &&
                dt_gl_import_image(rt, SHAPES_RESOURCE_PROBES, probes) &&
                dt_gl_resize(rt, WIDTH, HEIGHT) && dt_gl_record(rt, &frame, NULL));
    glGetTextureSubImage(fog, 0, 7, 5, 4, 1, 1, 1, GL_RGBA, GL_HALF_FLOAT, sizeof texel, texel);
    is_last_fog(texel);
    dt_gl_close(rt);
}

/* If the host has bound a query buffer, OpenGL would write the times into this buffer. */
TEST_WITH(opengl_takes_times_beside_a_query_buffer, NULL, is_without_error)
{
    struct dt_frame frame = frame_of(0);
    double ms[LAYOUTS_PASSES];
    GLuint buffer = 0;
    GLint bound = 0;
    struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
        .log = test_log, .get_proc_address = eglGetProcAddress, .timing = true, .frames = 2});
    assert_true(rt && dt_gl_create(rt, &layouts_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    assert_true(dt_gl_record(rt, &frame, NULL));
    REFUSED(dt_gl_timings(rt, 1, ms), "timings: none of the frame 1 before the last");
    assert_true(dt_gl_record(rt, &frame, NULL) && dt_gl_timings(rt, 1, ms));
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0 || isnan(ms[i])); /* never waits */
    glFinish();
    assert_true(dt_gl_timings(rt, 1, ms));
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0);
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_QUERY_BUFFER, buffer);
    heard.errors = 0;
    assert_true(dt_gl_timings(rt, 0, ms));
    assert_int_equal(heard.errors, 0);
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0);
    glGetIntegerv(GL_QUERY_BUFFER_BINDING, &bound);
    assert_int_equal(bound, buffer);
    glBindBuffer(GL_QUERY_BUFFER, 0);
    dt_gl_close(rt);
}

RUN_TESTS("opengl", open_with_triangle, close_opengl)
