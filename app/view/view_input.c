/* Keys and mouse of the window: held keys move the camera, pressed keys become wishes that view.c
 * carries out between frames. */
#include "view/view.h"

#include <math.h>

#include "run/camera.h"

static struct view *view_of(GLFWwindow *window)
{
    return glfwGetWindowUserPointer(window);
}

/* The next image that can be shown, forwards or backwards. */
static void cycle(struct view *view, int way)
{
    const struct dt_pipeline *info = view->pipeline.info;
    uint32_t count = info->resource_count, next = view->shown.resource;
    do {
        next = (next + count + (uint32_t)way) % count;
    } while (next != view->shown.resource &&
             !(info->resources[next].kind == DT_IMAGE && view_can_show(info, next)));
    view_show(view, next);
}

static void change_layer(struct view *view, int way)
{
    int layers = (int)view_layers(view), *layer = &view->shown.layer;
    *layer += way;
    *layer = *layer < -1 ? layers - 1 : *layer >= layers ? -1 : *layer;
}

static void change_mip(struct view *view, int way)
{
    uint32_t mips = view_mips(view);
    struct overlay_shown *shown = &view->shown;
    if (mips < 2)
        return;
    shown->mip = (shown->mip + mips + (uint32_t)way) % mips;
    uint32_t pass = view_last_writer(view->pipeline.info, shown->resource, shown->mip);
    shown->pass = pass < view->pipeline.info->pass_count ? pass : shown->pass;
    shown->marked = false;
    if (shown->layer >= (int)view_layers(view)) /* mips of a 3D image have fewer */
        shown->layer = -1;
}

static void change_font(struct view *view, int by)
{
    view->settings.font = fminf(fmaxf(view->settings.font + (float)by, 8), 48);
}

static void change_gain(struct view *view, int way)
{
    float *gain = &view->shown.gain;
    *gain = fminf(fmaxf(way > 0 ? *gain * 2 : *gain / 2, 1), 65536);
}

static void change_mode(struct view *view, int by)
{
    view->shown.mode = (view->shown.mode + (unsigned)by) % OVERLAY_MODES;
}

static void change_tint(struct view *view, int unused)
{
    (void)unused;
    view->shown.look.tinted = !view->shown.look.tinted;
}

static void go_home(struct view *view, int unused)
{
    (void)unused;
    view_show(view, view->home);
}

static void wish(struct view *view, int wishes)
{
    if (wishes == OVERLAY_SWAP)
        view->wishes ^= OVERLAY_SWAP; /* twice between two frames is none */
    else
        view->wishes |= (unsigned)wishes;
}

/* The panes, and the window itself. */
static void press_window(struct view *view, int key)
{
    struct overlay_settings *settings = &view->settings;
    bool *const folds[] = {&settings->left_folded, &settings->right_folded,
                           &settings->bottom_folded};
    if (key == GLFW_KEY_ESCAPE)
        view->quit = true;
    else if (key == GLFW_KEY_SPACE)
        view->paused = !view->paused;
    else if (key == GLFW_KEY_H)
        settings->hidden = !settings->hidden;
    else if (key == GLFW_KEY_F)
        overlay_whole_picture(view->overlay);
    else if (key >= GLFW_KEY_F2 && key <= GLFW_KEY_F4)
        *folds[key - GLFW_KEY_F2] = !*folds[key - GLFW_KEY_F2];
    if (key != GLFW_KEY_F1)
        return;
    settings->hidden = settings->bottom_folded = false;
    overlay_keys(view->overlay);
}

/* `draws`: what is shown needs a frame, since resources share memory. The first row that fits counts. */
static const struct binding {
    int key, modifiers;
    void (*act)(struct view *view, int argument);
    int argument;
    bool draws;
} bindings[] = {
    {GLFW_KEY_S, GLFW_MOD_CONTROL, wish, OVERLAY_SAVE_CAMERA, false},
    {GLFW_KEY_Z, GLFW_MOD_CONTROL, wish, OVERLAY_UNDO, false},
    {GLFW_KEY_EQUAL, GLFW_MOD_CONTROL, change_font, 1, false},
    {GLFW_KEY_KP_ADD, GLFW_MOD_CONTROL, change_font, 1, false},
    {GLFW_KEY_MINUS, GLFW_MOD_CONTROL, change_font, -1, false},
    {GLFW_KEY_KP_SUBTRACT, GLFW_MOD_CONTROL, change_font, -1, false},
    {GLFW_KEY_TAB, GLFW_MOD_SHIFT, cycle, -1, true},
    {GLFW_KEY_TAB, 0, cycle, 1, true},
    {GLFW_KEY_RIGHT, 0, cycle, 1, true},
    {GLFW_KEY_LEFT, 0, cycle, -1, true},
    {GLFW_KEY_HOME, 0, go_home, 0, true},
    {GLFW_KEY_UP, 0, change_layer, 1, true},
    {GLFW_KEY_DOWN, 0, change_layer, -1, true},
    {GLFW_KEY_PAGE_UP, 0, change_mip, 1, true},
    {GLFW_KEY_PAGE_DOWN, 0, change_mip, -1, true},
    {GLFW_KEY_C, 0, change_mode, 1, true},
    {GLFW_KEY_EQUAL, 0, change_gain, 1, true},
    {GLFW_KEY_KP_ADD, 0, change_gain, 1, true},
    {GLFW_KEY_MINUS, 0, change_gain, -1, true},
    {GLFW_KEY_KP_SUBTRACT, 0, change_gain, -1, true},
    {GLFW_KEY_T, 0, change_tint, 0, true},
    {GLFW_KEY_G, 0, wish, OVERLAY_FIRST, false},
    {GLFW_KEY_R, 0, wish, OVERLAY_FIT, false},
    {GLFW_KEY_B, 0, wish, OVERLAY_SWAP, false},
    {GLFW_KEY_P, 0, wish, OVERLAY_SAVE_PNG, false},
    {GLFW_KEY_PERIOD, 0, wish, OVERLAY_STEP | OVERLAY_ALONE, false},
    {GLFW_KEY_SPACE, 0, press_window, GLFW_KEY_SPACE, true},
};

/* Sets the first live parameter that is an integer. */
static void press_digit(struct view *view, int digit)
{
    const struct dt_pipeline *info = view->pipeline.info;
    uint32_t i = 0;
    while (i < info->param_count && !(info->params[i].live && info->params[i].type == DT_TYPE_INT))
        i++;
    if (i < info->param_count)
        view_params_set(view, info->params[i].name, digit);
}

static void press(struct view *view, int key, int modifiers)
{
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) {
        press_digit(view, key - GLFW_KEY_0);
        return;
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(bindings); i++) {
        const struct binding *binding = &bindings[i];
        if (binding->key != key || (modifiers & binding->modifiers) != binding->modifiers)
            continue;
        binding->act(view, binding->argument);
        view->step |= binding->draws;
        return;
    }
    press_window(view, key);
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int modifiers)
{
    (void)scancode;
    struct view *view = view_of(window);
    unsigned letter = key >= GLFW_KEY_A && key <= GLFW_KEY_Z ? 1u << (key - GLFW_KEY_A) : 0;
    if (action == GLFW_RELEASE)
        view->commanded &= ~letter;
    if (action == GLFW_RELEASE || overlay_takes_keys(view->overlay))
        return;
    if (action == GLFW_PRESS && modifiers & GLFW_MOD_CONTROL)
        view->commanded |= letter;
    else if (action == GLFW_PRESS)
        view->tapped |= letter;
    press(view, key, modifiers);
}

static void on_button(GLFWwindow *window, int button, int action, int modifiers)
{
    struct view *view = view_of(window);
    (void)modifiers;
    bool begins = action == GLFW_PRESS && !overlay_takes_mouse(view->overlay);
    view->looking = begins && button == GLFW_MOUSE_BUTTON_LEFT;
    view->orbiting = begins && button == GLFW_MOUSE_BUTTON_RIGHT;
}

/* Half a turn across the window. */
static void on_motion(GLFWwindow *window, double x, double y)
{
    struct view *view = view_of(window);
    double scale = M_PI / (view->window_size[0] ? view->window_size[0] : 1);
    float right = (float)((x - view->mouse[0]) * scale);
    float up = (float)((view->mouse[1] - y) * scale);
    view->mouse[0] = x;
    view->mouse[1] = y;
    if (view->looking)
        camera_turn(&view->scene.camera, right, up);
    else if (view->orbiting)
        camera_orbit(&view->scene.camera, -right, -up);
    else
        return;
    view->moving = false;
    view->step = true;
}

/* Without Ctrl, it zooms: see point of overlay_picture.cpp. */
static void on_scroll(GLFWwindow *window, double x, double y)
{
    struct view *view = view_of(window);
    (void)x;
    bool control =
        glfwGetKey(window, GLFW_KEY_LEFT_CONTROL) || glfwGetKey(window, GLFW_KEY_RIGHT_CONTROL);
    if (control && !overlay_takes_mouse(view->overlay))
        view->speed = fminf(fmaxf(view->speed * powf(1.2f, (float)y), 0.001f), 100);
}

void view_input_open(struct view *view)
{
    glfwSetWindowUserPointer(view->window, view);
    glfwSetKeyCallback(view->window, on_key);
    glfwSetMouseButtonCallback(view->window, on_button);
    glfwSetCursorPosCallback(view->window, on_motion);
    glfwSetScrollCallback(view->window, on_scroll);
}

/* A letter pressed with Ctrl is a command until it is released, even if Ctrl is released first. */
static bool is_held(const struct view *view, int key)
{
    unsigned letter = 1u << (key - GLFW_KEY_A);
    return (glfwGetKey(view->window, key) && !(view->commanded & letter)) || view->tapped & letter;
}

static float held(const struct view *view, int forth, int back)
{
    return (float)is_held(view, forth) - (float)is_held(view, back);
}

void view_input_fly(struct view *view, double seconds)
{
    static const double longest = 0.25; /* limits the step after a slow frame */
    bool fast = glfwGetKey(view->window, GLFW_KEY_LEFT_SHIFT) ||
                glfwGetKey(view->window, GLFW_KEY_RIGHT_SHIFT);
    float right = held(view, GLFW_KEY_D, GLFW_KEY_A), up = held(view, GLFW_KEY_E, GLFW_KEY_Q),
          forward = held(view, GLFW_KEY_W, GLFW_KEY_S);
    view->tapped = 0;
    if (overlay_takes_keys(view->overlay) || (right == 0 && up == 0 && forward == 0))
        return;
    float way = view->scene.radius * view->speed * (fast ? 4 : 1) * (float)fmin(seconds, longest);
    view->moving = false;
    camera_move(&view->scene.camera, right * way, up * way, forward * way);
    view->step = true;
}
