/* The OpenGL library in a context of the host's: wrong calls, vertices of another layout, shared
 * programs, inputs, caches, imports, parts of frames, times. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include "layouts.h"
#include "library.h"
#include "runtime_gl/diptych_gl.h"
#include "shapes.h"

static _Alignas(16) char geometry[GEOMETRY_BYTES]; /* as of lay_triangle */

static PFNGLCREATEBUFFERSPROC create_buffers;
static PFNGLNAMEDBUFFERSTORAGEPROC buffer_storage;
static PFNGLCREATETEXTURESPROC create_textures;
static PFNGLTEXTURESTORAGE2DPROC texture_storage;
static PFNGLGETERRORPROC get_error;
static PFNGLENABLEPROC enable;

static int open_opengl(void **state)
{
    (void)state;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    EGLDisplay display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    assert_true(eglInitialize(display, NULL, NULL) && eglBindAPI(EGL_OPENGL_API));
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    assert_true(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context));
    create_buffers = (PFNGLCREATEBUFFERSPROC)eglGetProcAddress("glCreateBuffers");
    buffer_storage = (PFNGLNAMEDBUFFERSTORAGEPROC)eglGetProcAddress("glNamedBufferStorage");
    create_textures = (PFNGLCREATETEXTURESPROC)eglGetProcAddress("glCreateTextures");
    texture_storage = (PFNGLTEXTURESTORAGE2DPROC)eglGetProcAddress("glTextureStorage2D");
    get_error = (PFNGLGETERRORPROC)eglGetProcAddress("glGetError");
    enable = (PFNGLENABLEPROC)eglGetProcAddress("glEnable");
    lay_triangle(geometry);
    return 0;
}

static void (*no_function(const char *name))(void)
{
    (void)name;
    return NULL;
}

static struct dt_gl_scene gl_scene(void)
{
    GLuint buffers[2];
    create_buffers(2, buffers);
    buffer_storage(buffers[0], GEOMETRY_BYTES, geometry, 0);
    buffer_storage(buffers[1], 12, geometry + INDICES, 0);
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
    create_textures(GL_TEXTURE_2D, 1, &texture);
    texture_storage(texture, 1, format, width, HEIGHT);
    return texture;
}

static void opengl_tells_wrong_calls(void **state)
{
    (void)state;
    const struct dt_gl_scene right = gl_scene();
    struct dt_gl_scene scene = right;
    struct dt_frame frame = frame_of(0);
    struct dt_gl_resource resource;
    double ms[FEATURES_PASSES];
    REFUSED(dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = no_function}),
            "get_proc_address");
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_non_null(rt);
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
    struct dt_gl_runtime *text = dt_gl_open(
        &(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress, .glsl = true});
    assert_non_null(text);
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
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_tells_errors_that_were_there(void **state)
{
    (void)state;
    enable(GL_RGBA8); /* no capability: GL_INVALID_ENUM */
    heard.warnings = heard.errors = 0;
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_non_null(rt);
    assert_int_equal(heard.warnings, 1);
    assert_int_equal(heard.errors, 0);
    assert_non_null(strstr(heard.text, "0x500"));
    dt_gl_close(rt);
}

static void opengl_needs_no_scene_that_nobody_sees(void **state)
{
    (void)state;
    struct dt_frame frame = frame_of(0);
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &layouts_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    assert_true(dt_gl_record(rt, &frame, NULL));
    REFUSED(!dt_gl_create(rt, &features_gl) || dt_gl_resize(rt, WIDTH, HEIGHT), "import_scene");
    dt_gl_close(rt);
}

static void opengl_draw(const struct dt_gl_scene *scene, uint8_t trail[TRAIL_BYTES])
{
    PFNGLGETTEXTUREIMAGEPROC get = (PFNGLGETTEXTUREIMAGEPROC)eglGetProcAddress("glGetTextureImage");
    struct dt_frame frame = frame_of(0);
    struct dt_gl_resource resource = {0};
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_import_scene(rt, scene) && dt_gl_create(rt, &features_gl) &&
                dt_gl_resize(rt, WIDTH, HEIGHT) && dt_gl_record(rt, &frame, NULL) &&
                dt_gl_get_resource(rt, FEATURES_RESOURCE_TRAIL, &resource));
    get(resource.texture, 0, GL_RGBA, GL_FLOAT, TRAIL_BYTES, trail);
    dt_gl_close(rt);
}

static void opengl_draws_vertices_of_another_layout(void **state)
{
    (void)state;
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
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_shares_programs(void **state)
{
    (void)state;
    const struct dt_gl_host host = {.log = test_log, .get_proc_address = eglGetProcAddress};
    const struct dt_gl_host text = {
        .log = test_log, .get_proc_address = eglGetProcAddress, .glsl = true};
    const struct dt_gl_scene scene = gl_scene();
    struct dt_frame frame = frame_of(0);
    struct dt_gl_runtime *rt = dt_gl_open(&host), *other = dt_gl_open(&host);
    REFUSED(dt_gl_create_from(other, rt), "create_from: the other runtime has no pipeline");
    assert_true(dt_gl_create(rt, &features_gl) && dt_gl_import_scene(other, &scene) &&
                dt_gl_create_from(other, rt) && dt_gl_resize(other, WIDTH, HEIGHT));
    dt_gl_close(rt);
    assert_true(dt_gl_record(other, &frame, NULL));
    rt = dt_gl_open(&text);
    REFUSED(dt_gl_create_from(rt, other), "one runtime has GLSL text");
    dt_gl_close(rt);
    dt_gl_close(other);
    assert_int_equal(get_error(), GL_NO_ERROR);
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
    PFNGLGETTEXTUREIMAGEPROC get = (PFNGLGETTEXTUREIMAGEPROC)eglGetProcAddress("glGetTextureImage");
    static uint8_t texels[4 * WIDTH * HEIGHT];
    struct dt_gl_resource picture = {0};
    assert_true(dt_gl_get_resource(outside_gl_runtime, OUTSIDE_RESOURCE_PICTURE, &picture));
    get(picture.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, sizeof texels, texels);
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

static void opengl_records_parts(void **state)
{
    (void)state;
    PFNGLCLEARTEXIMAGEPROC clear = (PFNGLCLEARTEXIMAGEPROC)eglGetProcAddress("glClearTexImage");
    const float one[4] = {1, 1, 1, 1};
    struct dt_gl_resource blurred = {0}, picture;
    struct dt_gl_runtime *rt = outside_gl_runtime =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &outside_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    write_for_blurred(opengl_writes);
    REFUSED(opengl_records_passes(1, 2), "begins with pass 1, but the frame goes on with pass 0");
    opengl_paints(black);
    assert_true(opengl_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_gl_get_resource(rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    REFUSED(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_PICTURE, &picture),
            "resource picture: a later part of this frame writes it");
    REFUSED(opengl_records(),
            "record: begins with pass 0, but the frame goes on with pass 1, grade");
    clear(blurred.texture, 0, GL_RGBA, GL_FLOAT, one);
    assert_true(opengl_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES));
    opengl_painted(white);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
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
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_takes_inputs(void **state)
{
    (void)state;
    take_inputs(false);
}

static void opengl_takes_text(void **state)
{
    (void)state;
    take_inputs(true);
}

static int links; /* programs that the runtime links itself */

static void APIENTRY count_link(GLuint program)
{
    links++;
    ((PFNGLLINKPROGRAMPROC)eglGetProcAddress("glLinkProgram"))(program);
}

static void (*address_of(const char *name))(void)
{
    return strcmp(name, "glLinkProgram") == 0 ? (void (*)(void))count_link
                                              : eglGetProcAddress(name);
}

/* Renders a frame with a cache. Returns how many programs were linked. */
static int links_with(struct dt_bytes cache)
{
    outside_gl_runtime = dt_gl_open(&(struct dt_gl_host){
        .log = test_log, .get_proc_address = address_of, .glsl = true, .cache = cache});
    links = 0;
    assert_true(outside_gl_runtime && dt_gl_create(outside_gl_runtime, &outside_gl) &&
                dt_gl_resize(outside_gl_runtime, WIDTH, HEIGHT));
    hand_in(opengl_writes, opengl_records, first_color);
    opengl_paints(first_color);
    dt_gl_close(outside_gl_runtime);
    return links;
}

static void opengl_takes_and_gives_a_cache(void **state)
{
    (void)state;
    struct dt_bytes cache;
    for (int text = 0; text < 2; text++) {
        struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
            .log = test_log, .get_proc_address = eglGetProcAddress, .glsl = text});
        REFUSED(dt_gl_get_cache(rt, &cache), "get_cache: no pipeline yet");
        assert_true(dt_gl_create(rt, &outside_gl) && dt_gl_get_cache(rt, &cache));
        dt_gl_close(rt);
        if (!text)
            free(cache.data);
    }
    assert_int_equal(links_with((struct dt_bytes){0}), OUTSIDE_PASSES);
    if (cache.size > 64) { /* the driver gives binaries */
        assert_int_equal(links_with(cache), 0);
        cache.data[cache.size / 2] ^= 1; /* each damage costs what it hits */
        assert_int_equal(links_with(cache), 1);
        assert_in_range(links_with((struct dt_bytes){cache.data, cache.size / 3, {0}}), 1,
                        OUTSIDE_PASSES);
    }
    assert_int_equal(links_with((struct dt_bytes){cache.data, 7, {0}}), OUTSIDE_PASSES);
    cache.data[8] ^= 1; /* of another driver */
    assert_int_equal(links_with(cache), OUTSIDE_PASSES);
    free(cache.data);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_takes_buffers_and_describes_all(void **state)
{
    (void)state;
    PFNGLNAMEDBUFFERSUBDATAPROC update =
        (PFNGLNAMEDBUFFERSUBDATAPROC)eglGetProcAddress("glNamedBufferSubData");
    struct dt_gl_range weights = {.offset = 1024, .size = 16};
    struct dt_gl_resource found;
    create_buffers(1, &weights.buffer);
    buffer_storage(weights.buffer, 4096, NULL, GL_DYNAMIC_STORAGE_BIT);
    update(weights.buffer, 1024, sizeof graded_alone, graded_alone);
    struct dt_gl_runtime *rt = outside_gl_runtime =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &outside_gl));
    REFUSED(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_PHOTO, &weights), "has no buffer");
    assert_true(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "weights: 16 bytes at offset 1024 given; at least 32");
    weights.size = 3072;
    assert_true(dt_gl_import_buffer(rt, OUTSIDE_RESOURCE_WEIGHTS, &weights) &&
                dt_gl_resize(rt, WIDTH, HEIGHT));
    write_inputs(opengl_writes, OUTSIDE_RESOURCE_WEIGHTS);
    write_grade(opengl_writes, first_color);
    opengl_paints(first_color);
    update(weights.buffer, 1024, sizeof nothing, nothing);
    opengl_paints(black);
    assert_true(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_WEIGHTS, &found));
    assert_true(found.buffer == weights.buffer && found.offset == 1024 && found.size == 32 &&
                found.stride == 16 && !found.texture);
    assert_true(dt_gl_get_resource(rt, OUTSIDE_RESOURCE_SOFT, &found));
    assert_true(found.texture && found.target == GL_TEXTURE_2D && found.format == GL_RGBA16F &&
                found.layers == 1 && found.mips == 3 && !found.buffer);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

static void opengl_takes_3d_images_and_cubes(void **state)
{
    (void)state;
    PFNGLTEXTURESTORAGE3DPROC storage =
        (PFNGLTEXTURESTORAGE3DPROC)eglGetProcAddress("glTextureStorage3D");
    PFNGLGETTEXTURESUBIMAGEPROC get =
        (PFNGLGETTEXTURESUBIMAGEPROC)eglGetProcAddress("glGetTextureSubImage");
    struct dt_frame frame = frame_of(0);
    uint16_t texel[4];
    GLuint fog, sky, probes, flat = texture_of(GL_RGBA16F, 8);
    create_textures(GL_TEXTURE_3D, 1, &fog);
    storage(fog, 3, GL_RGBA16F, 8, 6, 5);
    create_textures(GL_TEXTURE_CUBE_MAP, 1, &sky);
    texture_storage(sky, 2, GL_RGBA16F, 8, 8);
    create_textures(GL_TEXTURE_CUBE_MAP_ARRAY, 1, &probes);
    storage(probes, 1, GL_RGBA8, 4, 4, 12);
    struct dt_gl_runtime *rt =
        dt_gl_open(&(struct dt_gl_host){.log = test_log, .get_proc_address = eglGetProcAddress});
    assert_true(rt && dt_gl_create(rt, &shapes_gl));
    assert_true(dt_gl_import_image(rt, SHAPES_RESOURCE_FOG, flat));
    REFUSED(dt_gl_resize(rt, WIDTH, HEIGHT), "image fog: imported");
    assert_true(dt_gl_import_image(rt, SHAPES_RESOURCE_FOG, fog) &&
                dt_gl_import_image(rt, SHAPES_RESOURCE_SKY, sky) &&
                dt_gl_import_image(rt, SHAPES_RESOURCE_PROBES, probes) &&
                dt_gl_resize(rt, WIDTH, HEIGHT) && dt_gl_record(rt, &frame, NULL));
    get(fog, 0, 7, 5, 4, 1, 1, 1, GL_RGBA, GL_HALF_FLOAT, sizeof texel, texel);
    is_last_fog(texel);
    dt_gl_close(rt);
    assert_int_equal(get_error(), GL_NO_ERROR);
}

/* If the host has bound a query buffer, OpenGL would write the times into this buffer. */
static void opengl_takes_times_beside_a_query_buffer(void **state)
{
    (void)state;
    PFNGLGENBUFFERSPROC generate = (PFNGLGENBUFFERSPROC)eglGetProcAddress("glGenBuffers");
    PFNGLBINDBUFFERPROC bind = (PFNGLBINDBUFFERPROC)eglGetProcAddress("glBindBuffer");
    PFNGLGETINTEGERVPROC get = (PFNGLGETINTEGERVPROC)eglGetProcAddress("glGetIntegerv");
    struct dt_frame frame = frame_of(0);
    double ms[LAYOUTS_PASSES];
    GLuint buffer = 0;
    GLint bound = 0;
    PFNGLFINISHPROC finish = (PFNGLFINISHPROC)eglGetProcAddress("glFinish");
    struct dt_gl_runtime *rt = dt_gl_open(&(struct dt_gl_host){
        .log = test_log, .get_proc_address = eglGetProcAddress, .timing = true, .frames = 2});
    assert_true(rt && dt_gl_create(rt, &layouts_gl) && dt_gl_resize(rt, WIDTH, HEIGHT));
    assert_true(dt_gl_record(rt, &frame, NULL));
    REFUSED(dt_gl_timings(rt, 1, ms), "timings: none of the frame 1 before the last");
    assert_true(dt_gl_record(rt, &frame, NULL) && dt_gl_timings(rt, 1, ms));
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0 || isnan(ms[i])); /* never waits */
    finish();
    assert_true(dt_gl_timings(rt, 1, ms));
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0);
    generate(1, &buffer);
    bind(GL_QUERY_BUFFER, buffer);
    heard.errors = 0;
    assert_true(dt_gl_timings(rt, 0, ms));
    assert_int_equal(heard.errors, 0);
    for (int i = 0; i < LAYOUTS_PASSES; i++)
        assert_true(ms[i] >= 0);
    get(GL_QUERY_BUFFER_BINDING, &bound);
    assert_int_equal(bound, buffer);
    bind(GL_QUERY_BUFFER, 0);
    dt_gl_close(rt);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opengl_tells_wrong_calls),
        cmocka_unit_test(opengl_tells_errors_that_were_there),
        cmocka_unit_test(opengl_needs_no_scene_that_nobody_sees),
        cmocka_unit_test(opengl_draws_vertices_of_another_layout),
        cmocka_unit_test(opengl_takes_times_beside_a_query_buffer),
        cmocka_unit_test(opengl_shares_programs),
        cmocka_unit_test(opengl_takes_and_gives_a_cache),
        cmocka_unit_test(opengl_takes_inputs),
        cmocka_unit_test(opengl_takes_text),
        cmocka_unit_test(opengl_takes_buffers_and_describes_all),
        cmocka_unit_test(opengl_records_parts),
        cmocka_unit_test(opengl_takes_3d_images_and_cubes),
    };
    return cmocka_run_group_tests_name("opengl", tests, open_opengl, NULL);
}
