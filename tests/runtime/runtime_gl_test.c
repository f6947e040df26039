/* The OpenGL runtime's own parts: its contexts and drivers, GLSL text, KHR_debug, the loss of a
 * device. runtime_test.c has the parts in common with Vulkan. */
#include <EGL/egl.h>
#include <dlfcn.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/lib/unit.h"
#include "formats.h"
#include "probe.h"
#include "runtime_gl/internal.h"

static void expect_error(const char *part)
{
    if (probe_heard.errors != 1 || !strstr(probe_heard.last, part))
        fail_msg("%u errors, the last: %s", probe_heard.errors, probe_heard.last);
    probe_heard.errors = 0;
}

static struct dt_runtime_options options(const char *context, bool debug)
{
    probe_heard.errors = 0;
    return (struct dt_runtime_options){.log = {.message = probe_hear},
                                       .context = context,
                                       .debug = debug,
                                       .timing = true,
                                       .poison = 0xab};
}

static void *open_context(const char *context, bool debug)
{
    const struct dt_runtime_options wanted = options(context, debug);
    void *rt = runtime_gl.open(&wanted);
    if (!rt)
        fail_msg("%s", probe_heard.last);
    return rt;
}

static void *open_ready(void)
{
    void *rt = open_context("egl", true);
    assert_true(runtime_gl.set_scene(rt, &probe_scene) && runtime_gl.create(rt, &probe_gl) &&
                runtime_gl.resize(rt, 16, 8));
    return rt;
}

/* ---- Contexts -------------------------------------------------------------------------------- */

static void run_all(const char *context, bool glsl)
{
    struct dt_runtime_options wanted = options(context, true);
    wanted.glsl = glsl;
    probe_run(&runtime_gl, &wanted, glsl ? probe_glsl() : &probe_gl, &probe_heard.errors);
}

TEST(frames_from_glsl_text)
{
    run_all("egl", true);
}

TEST(frames_of_osmesa)
{
    const struct dt_runtime_options wanted = options("osmesa", true);
    run_all("osmesa", false);
    run_all("osmesa", true);
    formats_prepare();
    formats_run(&runtime_gl, &wanted, &formats_gl, &probe_heard.errors);
}

TEST(frames_of_a_window)
{
    if (!getenv("DISPLAY"))
        skip();
    run_all("window", false);
}

/* Another context takes over in the middle of a frame. */
static bool render_other(void *user, uint32_t pass)
{
    const struct dt_frame frame = probe_frame(0);
    (void)pass;
    return runtime_gl.render(user, &frame, NULL, NULL);
}

TEST(contexts_live_side_by_side)
{
    const struct dt_frame frame = probe_frame(0);
    void *all[] = {open_context("egl", true), open_context("osmesa", true),
                   open_context("egl", true)};
    const struct dt_observer observer = {.after_pass = render_other, .user = all[1]};
    for (size_t i = 0; i < DT_ARRAY_COUNT(all); i++)
        assert_true(runtime_gl.set_scene(all[i], &probe_scene) &&
                    runtime_gl.create(all[i], &probe_gl) && runtime_gl.resize(all[i], 16, 8));
    assert_true(runtime_gl.render(all[0], &frame, NULL, &observer));
    probe_check_color(&runtime_gl, all[0], 16, 8);
    runtime_gl.close(all[0]); /* the others live on when their neighbour is gone */
    assert_true(runtime_gl.render(all[2], &frame, NULL, &observer));
    for (size_t i = 1; i < DT_ARRAY_COUNT(all); i++) {
        probe_check_color(&runtime_gl, all[i], 16, 8);
        probe_check_stack(&runtime_gl, all[i]);
        runtime_gl.close(all[i]);
    }
    assert_int_equal(probe_heard.errors, 0);
}

TEST(unknown_contexts_are_named)
{
    struct dt_runtime_options wanted = options("telepathy", false);
    assert_null(runtime_gl.open(&wanted));
    expect_error("there is no OpenGL context 'telepathy': choose egl, zink, osmesa or window");
    /* With MESA_NO_ERROR, Mesa reports no errors, so a run would prove nothing. */
    wanted = options(NULL, false);
    setenv("MESA_NO_ERROR", "1", 1);
    assert_null(runtime_gl.open(&wanted));
    unsetenv("MESA_NO_ERROR");
    expect_error("unset MESA_NO_ERROR");
}

/* ---- zink: Mesa has one driver in a process, so it runs in one of its own, with an argument --- */

static bool zink_is_installed(void)
{
    glob_t found;
    bool installed = glob("/usr/lib/*/dri/zink_dri.so", 0, NULL, &found) == 0;
    globfree(&found);
    return installed;
}

TEST(frames_of_zink)
{
    if (!zink_is_installed()) {
        print_message("# no /usr/lib/*/dri/zink_dri.so: install libgl1-mesa-dri\n");
        skip();
    }
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setenv("CMOCKA_MESSAGE_OUTPUT", "STDOUT", 1); /* its results are one of ours */
        setenv("GALLIUM_DRIVER", "zink", 1);
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
        setenv("NODEVICE_SELECT", "1", 0);
        execl("/proc/self/exe", "runtime_gl_test", "zink", NULL);
        _exit(127);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void zink_itself(void **state)
{
    (void)state;
    const struct dt_runtime_options wanted = options("zink", true);
    run_all("zink", false);
    run_all("zink", true);
    formats_prepare();
    formats_run(&runtime_gl, &wanted, &formats_gl, &probe_heard.errors);
    void *rt = open_context("zink", true);
    assert_non_null(strstr(runtime_gl.device(rt)->name, "zink"));
    runtime_gl.close(rt);
}

/* Opening zink after another driver fails, since Mesa keeps the first one. */
TEST(zink_may_come_too_late)
{
    void *rt = open_context("egl", true);
    const struct dt_runtime_options wanted = options("zink", true);
    assert_null(runtime_gl.open(&wanted));
    expect_error("set GALLIUM_DRIVER=zink");
    setenv("GALLIUM_DRIVER", "zink", 1);
    assert_null(runtime_gl.open(&wanted));
    unsetenv("GALLIUM_DRIVER");
    assert_non_null(strstr(probe_heard.last, runtime_gl.device(rt)->name));
    expect_error("context zink: the driver is ");
    runtime_gl.close(rt);
}

/* ---- Errors of the driver -------------------------------------------------------------------- */

TEST(broken_text_is_told_with_its_pass)
{
    struct dt_runtime_options wanted = options(NULL, false);
    struct dt_stages stages[PROBE_PASSES];
    const struct dt_shaders shaders = {"gl", &probe_panel, stages};
    wanted.glsl = true;
    void *rt = runtime_gl.open(&wanted);
    assert_non_null(rt);
    memcpy(stages, probe_glsl()->stages, sizeof stages);
    stages[PROBE_COUNT].compute.glsl = "#version 450\nvoid main() { x = 1; }\n";
    assert_false(runtime_gl.create(rt, &shaders));
    expect_error("pass count: compiling the compute shader");
    memcpy(stages, probe_glsl()->stages, sizeof stages);
    stages[PROBE_SHOW].fragment.glsl =
        "#version 450\nin vec4 c; out vec4 d; void main() { d = c; }\n";
    assert_false(runtime_gl.create(rt, &shaders));
    expect_error("pass show: linking");
    assert_true(runtime_gl.create(rt, probe_glsl()));
    runtime_gl.close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

/* The limit holds for the number of each binding, not only for their count. */
TEST(bindings_have_numbers_below_the_limit)
{
    static const struct dt_binding far = {
        .binding = 60000, .resource = PROBE_MASK, .kind = DT_BIND_IMAGE};
    struct dt_program programs[PROBE_PASSES];
    struct dt_panel panel = probe_panel;
    const struct dt_shaders shaders = {"gl", &panel, probe_gl_stages};
    void *rt = open_context(NULL, false);
    memcpy(programs, probe_panel.programs, sizeof programs);
    programs[PROBE_MASK_PASS].bindings = &far;
    programs[PROBE_MASK_PASS].binding_count = 1;
    panel.programs = programs;
    assert_false(runtime_gl.create(rt, &shaders));
    expect_error("pass mask: binding 60000, but ");
    runtime_gl.close(rt);
}

/* The callback and the failing call both report a misuse that only the driver can see. The runtime
 * counts the message. */
TEST(the_driver_speaks)
{
    void *rt = open_context(NULL, true);
    const struct gl_buffer ghost = {.name = "ghost", .handle = 12345, .size = 16};
    assert_false(gl_buffer_fill(rt, &ghost, 0));
    assert_non_null(strstr(probe_heard.last, "ghost: glClearNamedBuffer"));
    assert_int_equal(runtime_gl.device(rt)->messages, 1);
    assert_int_equal(probe_heard.errors, 2);
    runtime_gl.close(rt);
}

/* OpenGL cannot share memory, but an image can share the texture of an earlier image of the same
 * kind. */
TEST(images_share_a_texture)
{
    static struct dt_resource resources[PROBE_RESOURCES];
    static struct dt_storage storage[PROBE_RESOURCES];
    struct dt_pipeline pipeline = probe_pipeline;
    struct dt_panel panel = probe_panel;
    const struct dt_shaders shaders = {"gl", &panel, probe_gl_stages};
    const struct dt_frame frame = probe_frame(0);
    void *rt = open_ready();
    memcpy(resources, probe_pipeline.resources, sizeof resources);
    memcpy(storage, probe_panel.storage, sizeof storage);
    pipeline.resources = resources;
    panel.pipeline = &pipeline;
    panel.storage = storage;
    resources[PROBE_GLOW].format = DT_FORMAT_RGBA8; /* as of the display, which no pass reads */
    storage[PROBE_GLOW].share = PROBE_DISPLAY;
    storage[PROBE_MASK].share = PROBE_COLOR; /* color has another format */
    assert_true(runtime_gl.create(rt, &shaders) && runtime_gl.resize(rt, 16, 8));
    assert_int_equal(gl_image_of(rt, PROBE_GLOW)->handle, gl_image_of(rt, PROBE_DISPLAY)->handle);
    assert_int_not_equal(gl_image_of(rt, PROBE_MASK)->handle, gl_image_of(rt, PROBE_COLOR)->handle);
    assert_true(runtime_gl.render(rt, &frame, NULL, NULL));
    probe_check_stack(&runtime_gl, rt);
    assert_true(runtime_gl.resize(rt, 8, 8)); /* frees the texture once, with its owner */
    assert_true(runtime_gl.render(rt, &frame, NULL, NULL));
    assert_true(runtime_gl.create(rt, &probe_gl));
    runtime_gl.close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

/* ---- A lost device --------------------------------------------------------------------------- */

/* A simulated loss. The driver reports it by the status alone, as Mesa does, or by every call's
 * error as well. */
static struct {
    GLenum status; /* GL_NO_ERROR: none was lost */
    bool errors;
    PFNGLGETERRORPROC error;
    PFNGLGETGRAPHICSRESETSTATUSPROC reset_status;
} lost;

static GLenum GLAD_API_PTR lost_error(void)
{
    return lost.status && lost.errors ? GL_CONTEXT_LOST : lost.error();
}

static GLenum GLAD_API_PTR lost_status(void)
{
    return lost.status ? lost.status : lost.reset_status();
}

/* Replaces the function of libEGL, through which glad loads OpenGL's functions. */
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
        {{GL_GUILTY_CONTEXT_RESET, PROBE_COUNT}, "pass count: gl", "because of this program"},
        {{GL_INNOCENT_CONTEXT_RESET, PROBE_PLAN}, "pass plan: gl", "because of another program"},
        {{GL_UNKNOWN_CONTEXT_RESET, PROBE_SKIP}, "pass skip: gl", "does not say why"},
    };
    const struct dt_frame frame = probe_frame(0);
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        void *rt = open_ready();
        struct loss loss = cases[i].loss;
        const struct dt_observer observer = {.before_pass = lose, .user = &loss};
        lost.errors = errors;
        assert_false(runtime_gl.device(rt)->lost);
        assert_false(runtime_gl.render(rt, &frame, NULL, &observer));
        assert_true(runtime_gl.device(rt)->lost);
        assert_non_null(strstr(probe_heard.last, cases[i].pass));
        expect_error(cases[i].why);
        assert_false(runtime_gl.render(rt, &frame, NULL, NULL)); /* it stays lost */
        assert_int_equal(probe_heard.errors, 1);
        assert_false(runtime_gl.resize(rt, 8, 8));
        assert_int_equal(probe_heard.errors, 2);
        runtime_gl.close(rt);
        lost.status = GL_NO_ERROR;
    }
}

TEST(a_lost_device_is_told_with_the_pass)
{
    check_loss(false);
    check_loss(true);
}

/* Only a context that was created with reset notification can report a loss. */
TEST(contexts_tell_when_they_are_lost)
{
    void *rt = open_ready();
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
    assert_int_equal(probe_heard.errors, 0);
}

/* Shaders compute length() from the bytes that are bound. */
TEST(of_a_range_only_the_indices_are_bound)
{
    struct dt_gl_runtime *rt = open_context("egl", true);
    struct gl_buffer whole = {.name = "whole", .size = 1 << 20};
    assert_true(gl_buffer_create(rt, &whole, NULL));
    const struct dt_gl_scene scene = {
        .vertices = {whole.handle, 0, 4 * sizeof(struct dt_vertex)},
        .indices = {whole.handle, 0, 1 << 20},
        .index_count = 3,
        .materials = {whole.handle, 4096, DT_MAX_MATERIALS * sizeof(struct dt_material)},
    };
    assert_true(dt_gl_import_scene(rt, &scene));
    assert_int_equal(gl_buffer_of(rt, DT_SCENE_INDICES)->size, 3 * sizeof(uint32_t));
    assert_int_equal(gl_buffer_of(rt, DT_SCENE_VERTICES)->size, 4 * sizeof(struct dt_vertex));
    struct gl_buffer small = {.name = "small", .size = 4};
    assert_true(gl_buffer_create(rt, &small, NULL));
    assert_int_equal(small.size, 4);
    gl_buffer_destroy(rt, &small);
    gl_buffer_destroy(rt, &whole);
    runtime_gl.close(rt);
    assert_int_equal(probe_heard.errors, 0);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest zink[] = {cmocka_unit_test(zink_itself)};
    if (count > 1 && strcmp(arguments[1], "zink") == 0)
        return cmocka_run_group_tests_name("runtime_gl, zink", zink, NULL, NULL);
    return unit_run("runtime_gl", NULL, NULL);
}
