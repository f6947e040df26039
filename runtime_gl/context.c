/* Creates an OpenGL 4.6 core context without a window (EGL surfaceless, zink, OSMesa) or with a
 * hidden one (GLFW). */
#include "internal.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* osmesa.h expects these from Mesa's gl.h, which glad replaces; not every glad defines them. */
#ifndef GLAPI
#define GLAPI extern
#endif
#ifndef GLAPIENTRY
#define GLAPIENTRY
#endif
#include <GL/osmesa.h>

/* Why creating a context failed; the caller decides whether that is an error. */
struct reason {
    char text[256];
};

struct gl_context_kind {
    const char *name;
    bool (*make)(struct gl_context *ctx, int major, int minor, bool debug, struct reason *why);
    bool (*current)(struct gl_context *ctx);
    GLADapiproc (*load)(void *ctx, const char *name);
    void (*destroy)(struct gl_context *ctx);
    const char *driver; /* required in GL_RENDERER; NULL: any driver */
};

/* ---- EGL without a surface ------------------------------------------------------------------- */

static EGLDisplay egl_display(void)
{
    const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (extensions && strstr(extensions, "EGL_MESA_platform_surfaceless"))
        return eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);

    /* Drivers without Mesa's platform have devices instead. */
    PFNEGLQUERYDEVICESEXTPROC query =
        (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    EGLDeviceEXT device;
    EGLint count = 0;
    if (!query || !query(1, &device, &count) || count < 1)
        return EGL_NO_DISPLAY;
    return eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, NULL);
}

static bool egl_make(struct gl_context *ctx, int major, int minor, bool debug, struct reason *why)
{
    ctx->display = egl_display();
    if (ctx->display == EGL_NO_DISPLAY || !eglInitialize(ctx->display, NULL, NULL)) {
        snprintf(why->text, sizeof why->text,
                 "no EGL display without a window system (EGL error 0x%x)",
                 (unsigned)eglGetError());
        return false;
    }
    const char *extensions = eglQueryString(ctx->display, EGL_EXTENSIONS);
    bool robust = extensions && strstr(extensions, "EGL_EXT_create_context_robustness");
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,
        major,
        EGL_CONTEXT_MINOR_VERSION,
        minor,
        EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_CONTEXT_OPENGL_DEBUG,
        debug,
        /* else a device reset goes unnoticed */
        robust ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY : EGL_NONE,
        EGL_LOSE_CONTEXT_ON_RESET,
        EGL_NONE,
    };
    if (eglBindAPI(EGL_OPENGL_API))
        ctx->context =
            eglCreateContext(ctx->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (!ctx->context)
        snprintf(why->text, sizeof why->text, "EGL refuses OpenGL %d.%d core (EGL error 0x%x)",
                 major, minor, (unsigned)eglGetError());
    return ctx->context;
}

/* A thread can have a current GLX or EGL context, not both. */
static void leave_glx(void)
{
    if (glfwGetCurrentContext())
        glfwMakeContextCurrent(NULL);
}

static void leave_egl(void)
{
    EGLDisplay display = eglGetCurrentDisplay();
    if (display != EGL_NO_DISPLAY)
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static bool egl_current(struct gl_context *ctx)
{
    leave_glx();
    eglMakeCurrent(ctx->display, EGL_NO_SURFACE, EGL_NO_SURFACE,
                   EGL_NO_CONTEXT); /* see gl_context_current */
    return eglMakeCurrent(ctx->display, EGL_NO_SURFACE, EGL_NO_SURFACE, ctx->context);
}

static GLADapiproc egl_load(void *ctx, const char *name)
{
    (void)ctx;
    return (GLADapiproc)eglGetProcAddress(name);
}

/* A process has one display; terminating it would break every other runtime. */
static void egl_destroy(struct gl_context *ctx)
{
    if (!ctx->display)
        return;
    eglMakeCurrent(ctx->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (ctx->context)
        eglDestroyContext(ctx->display, ctx->context);
    eglReleaseThread();
}

/* ---- zink: EGL without a surface, OpenGL by way of Vulkan ------------------------------------ */

/* Mesa reads its environment once per process, when the first display is initialised: a process
 * that opens zink can use no other OpenGL driver. The environment belongs to the process, so the
 * caller sets it. */
static bool zink_make(struct gl_context *ctx, int major, int minor, bool debug, struct reason *why)
{
    const char *driver = getenv("GALLIUM_DRIVER");
    if (!driver || strcmp(driver, "zink") != 0) {
        snprintf(why->text, sizeof why->text,
                 "Mesa takes its driver from the environment: set GALLIUM_DRIVER=zink");
        return false;
    }
    return egl_make(ctx, major, minor, debug, why);
}

/* ---- OSMesa: no EGL, no window system; loaded on demand -------------------------------------- */

#define OSMESA(ctx, function) ((__typeof__(&(function)))dlsym((ctx)->library, #function))

static bool osmesa_make(struct gl_context *ctx, int major, int minor, bool debug,
                        struct reason *why)
{
    /* OSMesa has no debug contexts; GL_DEBUG_OUTPUT alone enables messages */
    (void)debug;
    ctx->library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (!ctx->library) {
        snprintf(why->text, sizeof why->text, "OSMesa is not there: %s (Debian: libosmesa6)",
                 dlerror());
        return false;
    }
    const int attributes[] = {
        OSMESA_FORMAT,
        OSMESA_RGBA,
        OSMESA_PROFILE,
        OSMESA_CORE_PROFILE,
        OSMESA_CONTEXT_MAJOR_VERSION,
        major,
        OSMESA_CONTEXT_MINOR_VERSION,
        minor,
        0,
    };
    __typeof__(&OSMesaCreateContextAttribs) create = OSMESA(ctx, OSMesaCreateContextAttribs);
    ctx->context = create ? create(attributes, NULL) : NULL;
    if (!ctx->context)
        snprintf(why->text, sizeof why->text, "OSMesa refuses OpenGL %d.%d core", major, minor);
    return ctx->context;
}

static bool osmesa_current(struct gl_context *ctx)
{
    return OSMESA(ctx, OSMesaMakeCurrent)(ctx->context, ctx->pixels, GL_UNSIGNED_BYTE, 16, 16);
}

static GLADapiproc osmesa_load(void *ctx, const char *name)
{
    return (GLADapiproc)OSMESA((struct gl_context *)ctx, OSMesaGetProcAddress)(name);
}

static void osmesa_destroy(struct gl_context *ctx)
{
    if (ctx->context) {
        OSMESA(ctx, OSMesaMakeCurrent)(NULL, NULL, 0, 0, 0);
        OSMESA(ctx, OSMesaDestroyContext)(ctx->context);
    }
    if (ctx->library)
        dlclose(ctx->library);
}

/* ---- GLFW: a hidden window ------------------------------------------------------------------- */

/* GLFW is global to the process. The runtime that initialises GLFW also terminates it, and must be
 * closed last. */
static bool window_initialise(struct gl_context *ctx)
{
    glfwGetError(NULL);
    glfwGetTime();
    ctx->owns_glfw = glfwGetError(NULL) == GLFW_NOT_INITIALIZED;
    return glfwInit();
}

static bool window_make(struct gl_context *ctx, int major, int minor, bool debug,
                        struct reason *why)
{
    const char *text = "no window system";
    leave_egl(); /* GLFW makes a new window's context current for a while */
    bool system = window_initialise(ctx);
    if (system) {
        glfwDefaultWindowHints();
        glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
        glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, debug);
        glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET); /* if supported */
        ctx->window = glfwCreateWindow(64, 64, "diptych", NULL, NULL);
    }
    if (!ctx->window) {
        glfwGetError(&text);
        text = text ? text : "no window system";
        if (system)
            snprintf(why->text, sizeof why->text,
                     "GLFW gives no window with OpenGL %d.%d core (%s)", major, minor, text);
        else
            snprintf(why->text, sizeof why->text, "there is no display to open a window on (%s)",
                     text);
    }
    return ctx->window;
}

static bool window_current(struct gl_context *ctx)
{
    leave_egl();
    glfwMakeContextCurrent(NULL); /* see gl_context_current */
    glfwMakeContextCurrent(ctx->window);
    return glfwGetCurrentContext() == ctx->window;
}

static GLADapiproc window_load(void *ctx, const char *name)
{
    (void)ctx;
    return (GLADapiproc)glfwGetProcAddress(name);
}

static void window_destroy(struct gl_context *ctx)
{
    if (ctx->window)
        glfwDestroyWindow(ctx->window);
    if (ctx->owns_glfw)
        glfwTerminate();
}

static const struct gl_context_kind kinds[] = {
    {"egl", egl_make, egl_current, egl_load, egl_destroy, NULL},
    {"zink", zink_make, egl_current, egl_load, egl_destroy, "zink"},
    {"osmesa", osmesa_make, osmesa_current, osmesa_load, osmesa_destroy, NULL},
    {"window", window_make, window_current, window_load, window_destroy, NULL},
};

/* ---- The version ----------------------------------------------------------------------------- */

static void destroy(struct gl_context *ctx)
{
    if (ctx->kind)
        ctx->kind->destroy(ctx);
    *ctx = (struct gl_context){0};
}

/* glad asks for functions of the context's own version alone. OSMesa lacks those of robust access,
 * glGetn..., which this runtime does not call. */
static GLADapiproc context_load(void *user, const char *name)
{
    struct gl_context *ctx = user;
    GLADapiproc function = ctx->kind->load(ctx, name);
    if (!function && !ctx->missing && strncmp(name, "glGetn", 6) != 0)
        ctx->missing = name;
    return function;
}

static bool make(struct dt_gl_runtime *rt, const struct gl_context_kind *kind, int major, int minor,
                 struct reason *why)
{
    struct gl_context *ctx = &rt->context;
    ctx->kind = kind;
    bool made = kind->make(ctx, major, minor, rt->debug, why);
    if (made && kind->current(ctx) && gladLoadGLContextUserPtr(&rt->gl, context_load, ctx) &&
        !ctx->missing)
        return true;
    if (made && ctx->missing)
        snprintf(why->text, sizeof why->text, "the driver does not give %s", ctx->missing);
    else if (made)
        snprintf(why->text, sizeof why->text, "the context cannot be made current");
    destroy(ctx);
    return false;
}

/* Mesa's software drivers have all of 4.6, but report 4.5. */
static bool make_any(struct dt_gl_runtime *rt, const struct gl_context_kind *kind)
{
    struct reason why = {""};
    return make(rt, kind, 4, 6, &why) || make(rt, kind, 4, 5, &why) ||
           dt_error(&rt->core, "context %s: OpenGL 4.6 core is needed, and there is none: %s",
                    kind->name, why.text);
}

/* ---- Messages -------------------------------------------------------------------------------- */

/* Logs all messages except notifications and performance advice, which do not concern
 * correctness. */
static void GLAD_API_PTR on_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                    GLsizei length, const GLchar *message, const void *user)
{
    struct dt_gl_runtime *rt = (struct dt_gl_runtime *)user;
    (void)source;
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION || type == GL_DEBUG_TYPE_PERFORMANCE)
        return;
    while (length > 0 && message[length - 1] == '\n')
        length--;
    rt->core.device.messages++;
    dt_error(&rt->core, "OpenGL debug message %u: %.*s", id, (int)length, message);
}

static void hear_messages(struct dt_gl_runtime *rt)
{
    rt->gl.Enable(GL_DEBUG_OUTPUT);
    rt->gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    rt->gl.DebugMessageCallback(on_message, rt);
}

/* ---- Open and close -------------------------------------------------------------------------- */

/* Unbinds the current context first (EGL, GLFW), to force a real switch. OSMesa, EGL and GLX share
 * Mesa's dispatch table but track the current context separately; each skips a switch to a context
 * that it believes current. */
bool gl_context_current(struct dt_gl_runtime *rt)
{
    return rt->context.kind->current(&rt->context) ||
           dt_error(&rt->core, "%s: the OpenGL context cannot be made current",
                    rt->core.device.name);
}

bool gl_context_open(struct dt_gl_runtime *rt, const char *name)
{
    const struct gl_context_kind *kind = NULL;
    for (size_t i = 0; i < DT_ARRAY_COUNT(kinds); i++)
        if (strcmp(kinds[i].name, name ? name : "egl") == 0)
            kind = &kinds[i];
    if (!kind)
        return dt_error(
            &rt->core, "there is no OpenGL context '%s': choose egl, zink, osmesa or window", name);
    if (!make_any(rt, kind))
        return false;

    const char *renderer = (const char *)rt->gl.GetString(GL_RENDERER);
    if (kind->driver && !strstr(renderer, kind->driver))
        return dt_error(
            &rt->core,
            "context %s: the driver is %s, not Mesa's %s; install it (Debian: libgl1-mesa-dri, "
            "mesa-vulkan-drivers). A process can use only one OpenGL driver",
            name, renderer, kind->driver);
    if (rt->debug)
        hear_messages(rt);
    return gl_context_suits(rt, context_load, &rt->context) && gl_state_fix(rt);
}

void gl_context_close(struct dt_gl_runtime *rt)
{
    destroy(&rt->context);
}
