/* Keys and mouse of the window: held keys move the camera, pressed keys become wishes that view.c
 * carries out between frames. */
#include "view/view.h"

#include <math.h>

#include "console/live.h"
#include "console/texels.h"
#include "view/camera.h"

static struct view *view_of(GLFWwindow *window)
{
    return glfwGetWindowUserPointer(window);
}

/* The next image that can be shown, forwards or backwards. */
static void cycle(struct view *view, int way)
{
    const struct dt_pipeline *info = view->pipeline.info;
    uint32_t count = info->resource_count, next = view->resource;
    do {
        next = (next + count + (uint32_t)way) % count;
    } while (next != view->resource && !view_can_show(info, next));
    view_show(view, next);
}

static void change_layer(struct view *view, int way)
{
    int layers = (int)view_layers(view);
    view->layer += way;
    view->layer = view->layer < -1 ? layers - 1 : view->layer >= layers ? -1 : view->layer;
}

static void change_mip(struct view *view, int way)
{
    uint32_t mips = view_mips(view);
    view->mip = (view->mip + mips + (uint32_t)way) % mips;
    if (view->layer >= (int)view_layers(view)) /* mips of a 3D image have fewer */
        view->layer = -1;
}

/* Sets the outline's live parameter, if the number is valid for it. */
static void set_digit(struct view *view, int digit)
{
    const struct dt_param *param = view->digits;
    char text[2] = {(char)('0' + digit), 0};
    if (param && type_components(param->type) == 1 && digit >= param->min && digit <= param->max)
        live_set(view->pipeline.info, view->pipeline.live, param, text, &view->console->log);
}

static void press(struct view *view, int key, int modifiers)
{
    bool shift = modifiers & GLFW_MOD_SHIFT;
    view->step = true; /* most of them change the picture */
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9)
        set_digit(view, key - GLFW_KEY_0);
    switch (key) {
    case GLFW_KEY_ESCAPE:
        view->quit = true;
        break;
    case GLFW_KEY_TAB:
        cycle(view, shift ? -1 : 1);
        break;
    case GLFW_KEY_RIGHT:
        cycle(view, 1);
        break;
    case GLFW_KEY_LEFT:
        cycle(view, -1);
        break;
    case GLFW_KEY_HOME:
        view_show(view, view->home);
        break;
    case GLFW_KEY_UP:
        change_layer(view, 1);
        break;
    case GLFW_KEY_DOWN:
        change_layer(view, -1);
        break;
    case GLFW_KEY_PAGE_UP:
        change_mip(view, 1);
        break;
    case GLFW_KEY_PAGE_DOWN:
        change_mip(view, -1);
        break;
    case GLFW_KEY_SPACE:
        view->paused = !view->paused;
        break;
    case GLFW_KEY_V:
        view->shown_points = (view->shown_points + 1) % (view->points_count + 1);
        break;
    case GLFW_KEY_C:
        view->mode = (view->mode + 1) % VIEW_MODES;
        break;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
        view->gain = fminf(view->gain * 2, 256);
        break;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
        view->gain = fmaxf(view->gain / 2, 1);
        break;
    case GLFW_KEY_H:
        view->overlay_hidden = !view->overlay_hidden;
        break;
    case GLFW_KEY_P:
        view->screenshot = true;
        break;
    case GLFW_KEY_S:
        view->save_camera |= modifiers & GLFW_MOD_CONTROL;
        break;
    default:
        view->step = key >= GLFW_KEY_0 && key <= GLFW_KEY_9;
        break;
    }
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
    (void)button;
    (void)modifiers;
    view->looking = action == GLFW_PRESS && !overlay_takes_mouse(view->overlay);
}

/* Half a turn across the window. */
static void on_motion(GLFWwindow *window, double x, double y)
{
    struct view *view = view_of(window);
    double scale = M_PI / (view->window_size[0] ? view->window_size[0] : 1);
    double way[2] = {x - view->mouse[0], y - view->mouse[1]};
    view->mouse[0] = x;
    view->mouse[1] = y;
    if (!view->looking)
        return;
    camera_turn(&view->scene.camera, (float)(way[0] * scale), (float)(-way[1] * scale));
    view->step = true;
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    struct view *view = view_of(window);
    (void)x;
    if (overlay_takes_mouse(view->overlay))
        return;
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
    camera_move(&view->scene.camera, right * way, up * way, forward * way);
    view->step = true;
}
