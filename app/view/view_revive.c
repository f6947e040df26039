/* Reopens a lost device: a pass ran too long, or another program's work brought the driver down.
 * A window whose context is lost closes, and reopens at its place. */
#include "view/view.h"

/* Fewest frames between two unrelated losses; with fewer, the pipeline is the likely cause. */
enum { PATIENCE = 60 };

struct window_place {
    int left, top, width, height;
};

static struct window_place find_window_place(GLFWwindow *window)
{
    struct window_place place;
    glfwGetWindowPos(window, &place.left, &place.top);
    glfwGetWindowSize(window, &place.width, &place.height);
    return place;
}

static bool is_lost(const struct view_side *side)
{
    const struct session *session = &side->session;
    return session->handle && session->runtime->device(session->handle)->lost;
}

static bool reopen(struct view *view, uint32_t index)
{
    report_message(&view->side[index].session.log, DT_WARNING,
                   "reopening the device; resources with history start from zero");
    view_close_side(view, index);
    return view_open_side(view, index);
}

static bool reopen_window(struct view *view)
{
    struct window_place place = find_window_place(view->window);
    report_message(&view->console->log, DT_WARNING, "reopening the window");
    view_close_window(view);
    if (!view_open_window(view, place.width, place.height))
        return false;
    glfwSetWindowPos(view->window, place.left, place.top);
    return true;
}

/* The lost side lost the pipeline's content; the other sides reset theirs to agree. */
static bool start_over(struct view *view)
{
    view->frame = 0;
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!session_resize(&view->side[i].session, view->size))
            return false;
    return true;
}

/* False when no user could act, or no frame finished since the last loss. */
static bool has_patience(struct view *view)
{
    bool soon = view->losses && view->frames - view->loss_frames < PATIENCE;
    bool hopeless = view->gave_up && view->frames == view->loss_frames;
    view->losses++;
    view->loss_frames = view->frames;
    if (!soon)
        return true;
    view->paused = view->gave_up = true;
    view->settings.hidden = false;
    view->step = false;
    if (hopeless || view->options->run_frames)
        return report_error(
            &view->console->log,
            "the device was lost again at once: the window ends; try a smaller --size, or "
            "another --device");
    report_error(&view->console->log,
                 "the device was lost again within %d frames: paused; Space, or "
                 "a change of the pipeline, tries once more",
                 PATIENCE);
    return true;
}

bool view_revive(struct view *view)
{
    bool lost[VIEW_SIDES] = {false}, window = gl_window_is_lost(view->screen), any = window;
    for (uint32_t i = 0; i < view->side_count; i++)
        any = (lost[i] = is_lost(&view->side[i])) || any;
    if (!any || !has_patience(view))
        return false;
    for (uint32_t i = 0; i < view->side_count; i++)
        if (lost[i] && !reopen(view, i))
            return false;
    if (window && !reopen_window(view))
        return false;
    view->time = glfwGetTime();
    return start_over(view);
}
