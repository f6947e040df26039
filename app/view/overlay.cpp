/* Opens Dear ImGui, lays out the panes, and describes the outer ones: the verdict, passes and
 * resources, errors and log; see overlay.h. */
#include "view/overlay_parts.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <unistd.h>

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

struct overlay *overlay_open(void *window)
{
    struct overlay *overlay = new (std::nothrow) struct overlay();
    if (!overlay)
        return nullptr;
    overlay->context = ImGui::CreateContext();
    ImGui::SetCurrentContext(overlay->context);
    ImGui::GetIO().IniFilename = nullptr; /* no imgui.ini */
    ImGui_ImplGlfw_InitForOpenGL(static_cast<GLFWwindow *>(window), true);
    if (ImGui_ImplOpenGL3_Init("#version 410 core")) {
        ImGui_ImplOpenGL3_CreateDeviceObjects();
        return overlay;
    }
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(overlay->context);
    delete overlay;
    return nullptr;
}

void overlay_close(struct overlay *overlay)
{
    ImGui::SetCurrentContext(overlay->context);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(overlay->context);
    delete overlay;
}

/* ---- Fonts ----------------------------------------------------------------------------------- */

/* One of Debian's fonts-dejavu-core; without it, the one that ImGui brings. */
static ImFont *add_font(const char *name, float size)
{
    char path[128];
    std::snprintf(path, sizeof path, "/usr/share/fonts/truetype/dejavu/%s.ttf", name);
    ImFontAtlas *fonts = ImGui::GetIO().Fonts;
    ImFont *font = access(path, R_OK) == 0 ? fonts->AddFontFromFileTTF(path, size) : nullptr;
    ImFontConfig config;
    config.SizePixels = size;
    return font ? font : fonts->AddFontDefault(&config);
}

static void set_style(float size)
{
    ImGuiStyle style;
    ImGui::StyleColorsDark(&style);
    style.WindowRounding = 0;
    style.WindowBorderSize = 0;
    style.WindowPadding = ImVec2(6, 4);
    style.FramePadding = ImVec2(4, 2);
    style.ItemSpacing = ImVec2(6, 4);
    style.FrameRounding = 2;
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.11f, 0.115f, 0.125f, 1);
    style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.6f, 0.6f, 0.62f, 1);
    style.ScaleAllSizes(std::fmax(size / 15, 0.5f));
    style.WindowMinSize = ImVec2(1, 1); // scaled down, it would be 0, at which Dear ImGui aborts
    ImGui::GetStyle() = style;
}

void overlay_fonts(struct overlay *overlay, float size)
{
    ImGui::SetCurrentContext(overlay->context);
    if (size == overlay->font_size)
        return;
    overlay->font_size = size;
    ImFontAtlas *fonts = ImGui::GetIO().Fonts;
    fonts->Clear();
    overlay->text = add_font("DejaVuSans", size);
    overlay->large = add_font("DejaVuSans-Bold", std::round(size * 1.5f));
    overlay->mono = add_font("DejaVuSansMono", size);
    set_style(size);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
}

/* ---- Parts ----------------------------------------------------------------------------------- */

void pane_begin(const char *name, struct box box)
{
    ImGui::SetNextWindowPos(ImVec2(box.x, box.y));
    ImGui::SetNextWindowSize(ImVec2(std::fmax(box.w, 1), std::fmax(box.h, 1)));
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
}

void tip(const char *text)
{
    if (!*text || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 30);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void flow(float width)
{
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x < width)
        ImGui::NewLine();
}

bool button(const char *label, const char *help)
{
    flow(ImGui::CalcTextSize(label, nullptr, true).x + ImGui::GetFontSize());
    bool pressed = ImGui::Button(label);
    tip(help);
    return pressed;
}

bool is_sought(const char *search, const char *text)
{
    return !*search || strcasestr(text, search);
}

/* ---- The verdict ----------------------------------------------------------------------------- */

static ImVec4 mark_color(enum overlay_mark mark)
{
    switch (mark) {
    case OVERLAY_EQUAL:
        return ImVec4(0.45f, 0.85f, 0.5f, 1);
    case OVERLAY_WITHIN:
        return ImVec4(0.95f, 0.8f, 0.35f, 1);
    case OVERLAY_DIFFERS:
        return ImVec4(1, 0.5f, 0.45f, 1);
    default:
        return ImVec4(0.7f, 0.7f, 0.72f, 1);
    }
}

static void verdict(struct overlay *overlay, struct overlay_model *model, struct box box)
{
    ImVec4 color = mark_color(model->mark);
    ImGui::PushStyleColor(ImGuiCol_WindowBg,
                          ImVec4(color.x * 0.25f, color.y * 0.25f, color.z * 0.25f, 1));
    pane_begin("verdict", box);
    ImGui::PushFont(overlay->large);
    color.w = model->stale ? 0.55f : 1;
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
    char label[512];
    std::snprintf(label, sizeof label, "%s%s###verdict", model->verdict,
                  model->stale && *model->verdict ? " ..." : "");
    if (ImGui::Button(label) && model->mark > OVERLAY_EQUAL)
        model->wishes |= OVERLAY_FIRST;
    ImGui::PopStyleColor(2);
    ImGui::PopFont();
    if (model->mark > OVERLAY_EQUAL)
        tip("Click, or G: shows that image at that texel.");
    ImGui::PushFont(overlay->text);
    float width = ImGui::CalcTextSize(model->title).x;
    ImGui::SameLine(std::fmax(box.w - width - overlay->em, 0));
    if (ImGui::GetCursorPosX() + width < box.w &&
        ImGui::GetItemRectMax().x + overlay->em * 2 + width < box.w)
        ImGui::TextDisabled("%s", model->title);
    ImGui::PopFont();
    ImGui::End();
    ImGui::PopStyleColor();
}

/* ---- Passes and resources -------------------------------------------------------------------- */

/* At the right end of the line, in columns of the sides. */
static void side_column(const struct overlay_model *model, uint32_t side)
{
    float width = ImGui::GetFontSize() * 3.4f;
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x -
                    width * static_cast<float>(model->side_count - side));
}

static void times(const struct overlay_model *model, const double ms[OVERLAY_SIDES])
{
    for (uint32_t k = 0; k < model->side_count; k++) {
        side_column(model, k);
        if (std::isnan(ms[k]))
            ImGui::TextDisabled("-");
        else
            ImGui::Text(ms[k] < 100 ? "%.2f" : "%.1f", ms[k]);
    }
}

static void put_mark(enum overlay_mark mark)
{
    static const char *const signs[] = {" ", "=", "~", "!"};
    static const char *const words[] = {"", "equal bits", "other bits, within the contract",
                                        "the sides differ"};
    float start = ImGui::GetCursorPosX();
    ImGui::TextColored(mark_color(mark), "%s", signs[mark]);
    tip(words[mark]);
    ImGui::SameLine(start + ImGui::GetFontSize());
}

static void show_row(struct overlay_model *model, uint32_t pass, uint32_t resource, uint32_t mip)
{
    struct overlay_shown *shown = model->shown;
    if (shown->resource != resource)
        shown->look = {};
    if (shown->resource != resource || shown->mip != mip)
        shown->marked = false;
    shown->layer = shown->resource == resource ? shown->layer : -1;
    shown->pass = pass;
    shown->resource = resource;
    shown->mip = mip;
    model->wishes |= OVERLAY_STEP;
}

static void row(struct overlay *overlay, struct overlay_model *model, uint32_t index)
{
    const struct row *row = &model->rows->outputs.list[index];
    const struct overlay_shown *shown = model->shown;
    const char *doc = model->info->resources[row->resource].doc;
    bool chosen =
        shown->pass == row->pass && shown->resource == row->resource && shown->mip == row->mip;
    char label[160];
    ImGui::Indent(ImGui::GetFontSize());
    put_mark(model->row_mark ? model->row_mark[index] : OVERLAY_UNKNOWN);
    std::snprintf(label, sizeof label, "%s##row%u", row->name, index);
    if (ImGui::Selectable(label, chosen))
        show_row(model, row->pass, row->resource, row->mip);
    tip(doc ? doc : "");
    if (chosen && overlay->listed != index) {
        ImGui::SetScrollHereY();
        overlay->listed = index;
    }
    ImGui::Unindent(ImGui::GetFontSize());
}

/* A pass, and what it writes that is sought. */
static void pass(struct overlay *overlay, struct overlay_model *model, uint32_t index)
{
    const struct dt_pass *pass = &model->info->passes[index];
    const uint32_t *first = model->rows->outputs.first;
    bool whole = is_sought(overlay->search, pass->name), any = whole, skipped = true;
    enum overlay_mark worst = OVERLAY_UNKNOWN;
    double ms[OVERLAY_SIDES];
    for (uint32_t i = first[index]; i < first[index + 1]; i++) {
        any |= is_sought(overlay->search, model->rows->outputs.list[i].name);
        if (model->row_mark && model->row_mark[i] > worst)
            worst = model->row_mark[i];
    }
    for (uint32_t k = 0; k < model->side_count; k++) {
        const double *all = model->sides[k].pass_ms;
        ms[k] = all ? all[index] : static_cast<double>(NAN);
        skipped &= all && std::isnan(ms[k]);
    }
    if (!any)
        return;
    if (skipped)
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    put_mark(worst);
    ImGui::SetNextItemOpen(true, ImGuiCond_Once);
    bool open = ImGui::TreeNodeEx(pass->name, ImGuiTreeNodeFlags_NoTreePushOnOpen |
                                                  ImGuiTreeNodeFlags_SpanAvailWidth);
    tip(skipped ? "skipped in this frame" : pass->doc ? pass->doc : "");
    if (overlay->seek && overlay->guilty == index + 1)
        ImGui::SetScrollHereY();
    times(model, ms);
    for (uint32_t i = first[index]; open && i < first[index + 1]; i++)
        if (whole || is_sought(overlay->search, model->rows->outputs.list[i].name))
            row(overlay, model, i);
    if (skipped)
        ImGui::PopStyleColor();
}

static bool is_written(const struct overlay_model *model, uint32_t resource)
{
    for (uint32_t i = 0; i < model->rows->outputs.count; i++)
        if (model->rows->outputs.list[i].resource == resource)
            return true;
    return false;
}

/* Inputs, and what no pass of this pipeline uses. */
static void unwritten(struct overlay *overlay, struct overlay_model *model)
{
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::PushID("unwritten"); /* passes may have the same names */
    for (uint32_t i = 0; i < model->info->resource_count; i++) {
        const struct dt_resource *resource = &model->info->resources[i];
        if (is_written(model, i) || !is_sought(overlay->search, resource->name))
            continue;
        ImGui::Indent(ImGui::GetFontSize());
        if (ImGui::Selectable(resource->name, model->shown->resource == i) && resource->input)
            show_row(model, model->info->pass_count - 1, i, 0);
        tip(resource->input ? "an input" : "No pass writes it.");
        ImGui::Unindent(ImGui::GetFontSize());
    }
    ImGui::PopID();
    ImGui::PopStyleColor();
}

/* The first pass that differs comes into sight when it becomes another. */
static void find_guilty(struct overlay *overlay, const struct overlay_model *model)
{
    const struct row_list *outputs = &model->rows->outputs;
    uint32_t row = 0, was = overlay->guilty;
    while (model->row_mark && row < outputs->count && model->row_mark[row] != OVERLAY_DIFFERS)
        row++;
    overlay->guilty = model->row_mark && row < outputs->count ? outputs->list[row].pass + 1 : 0;
    overlay->seek = overlay->guilty && overlay->guilty != was;
}

static void passes(struct overlay *overlay, struct overlay_model *model)
{
    double ms[OVERLAY_SIDES];
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##search", "search passes and resources", overlay->search,
                             sizeof overlay->search);
    ImGui::TextDisabled("milliseconds");
    for (uint32_t k = 0; k < model->side_count; k++) {
        side_column(model, k);
        ImGui::TextDisabled("%.6s", model->sides[k].label);
        tip(model->sides[k].label);
        ms[k] = model->sides[k].frame_ms;
    }
    ImGui::TextUnformatted("frame");
    times(model, ms);
    ImGui::BeginChild("passes");
    find_guilty(overlay, model);
    for (uint32_t i = 0; i < model->info->pass_count; i++)
        pass(overlay, model, i);
    unwritten(overlay, model);
    ImGui::EndChild();
}

/* ---- Errors, log, keys ----------------------------------------------------------------------- */

static const char key_text[] =
    "mouse         left: look around; right: orbit; middle: move the picture; wheel: zoom about "
    "the pointer\n"
    "W A S D Q E   fly, down and up; Shift: faster; Ctrl and the wheel: how fast\n"
    "Tab <- ->     next, previous image; Home: the picture again; F: whole\n"
    "Up Down       layer; PgUp PgDn: mip\n"
    "C  + -        sides: whole, parts of one, difference; its gain\n"
    "G             the first difference, at its texel\n"
    "T  R          false colour; range of what is shown\n"
    "B  Ctrl+Z     settings A or B; undo\n"
    "Space  .      pause; one frame\n"
    "0..9          the first live parameter that is an integer\n"
    "P  Ctrl+S     save the picture; the camera, for --motion\n"
    "F2 F3 F4 H    left, right, lower pane; all of them\n"
    "Ctrl + -      larger, smaller letters\n"
    "Esc           end";

static bool tab(struct overlay *overlay, const char *name)
{
    bool wanted = overlay->tab && std::strcmp(overlay->tab, name) == 0;
    if (wanted)
        overlay->tab = nullptr;
    return ImGui::BeginTabItem(name, nullptr, wanted ? ImGuiTabItemFlags_SetSelected : 0);
}

static void scrolled(struct overlay *overlay, const char *name, const char *text, bool to_end)
{
    ImGui::BeginChild(name, ImVec2(0, 0), false, ImGuiWindowFlags_HorizontalScrollbar);
    ImGui::PushFont(overlay->mono);
    ImGui::TextUnformatted(text);
    ImGui::PopFont();
    if (to_end)
        ImGui::SetScrollHereY(1);
    ImGui::EndChild();
    ImGui::EndTabItem();
}

static void lower(struct overlay *overlay, struct overlay_model *model)
{
    if (model->error && model->error != overlay->error)
        overlay->tab = "errors";
    overlay->error = model->error;
    if (!ImGui::BeginTabBar("lower"))
        return;
    if (model->error)
        ImGui::PushStyleColor(ImGuiCol_Tab, ImVec4(0.6f, 0.12f, 0.1f, 1));
    bool errors = tab(overlay, "errors");
    if (model->error)
        ImGui::PopStyleColor();
    if (errors) {
        bool why = !model->error && model->why && *model->why;
        ImGui::TextColored(mark_color(model->error ? OVERLAY_DIFFERS : OVERLAY_UNKNOWN), "%s",
                           model->error ? model->error_title
                           : why        ? "The sides differ, without an error:"
                                        : "none of the spec, its shaders and the devices");
        scrolled(overlay, "error text", model->error ? model->error : why ? model->why : "", false);
    }
    bool found = model->undefined && *model->undefined;
    if (found)
        ImGui::PushStyleColor(ImGuiCol_Tab, ImVec4(0.6f, 0.12f, 0.1f, 1));
    bool undefined = model->undefined && tab(overlay, "undefined");
    if (found)
        ImGui::PopStyleColor();
    if (undefined)
        scrolled(overlay, "undefined text", found ? model->undefined : "nothing was found", false);
    if (tab(overlay, "log")) {
        scrolled(overlay, "log text", model->log, model->log_size != overlay->log_size);
        overlay->log_size = model->log_size;
    }
    if (tab(overlay, "keys"))
        scrolled(overlay, "key text", key_text, false);
    ImGui::EndTabBar();
}

/* At the bottom of a picture alone, in a fixed-width font, so that carets stand at their column. */
static void error_alone(struct overlay *overlay, const char *title, const char *text)
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    float height = std::fmin(ImGui::CalcTextSize(text).y + 40, screen.y * 0.6f);
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.25f, 0.02f, 0.02f, 0.92f));
    ImGui::SetNextWindowPos(ImVec2(8, screen.y - height - 8));
    ImGui::SetNextWindowSize(ImVec2(screen.x - 16, height));
    ImGui::Begin(title, nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_HorizontalScrollbar);
    ImGui::PushFont(overlay->mono);
    ImGui::TextUnformatted(text);
    ImGui::PopFont();
    ImGui::End();
    ImGui::PopStyleColor();
}

static void status(struct overlay_model *model, struct box box)
{
    pane_begin("status", box);
    if (*model->state) {
        ImGui::TextColored(mark_color(OVERLAY_WITHIN), "%s", model->state);
        ImGui::SameLine(0, ImGui::GetFontSize() * 2);
    }
    ImGui::TextDisabled("Tab next image    G first difference    C compare    wheel zoom    "
                        "Space pause    F1 all keys");
    ImGui::End();
}

/* ---- Layout ---------------------------------------------------------------------------------- */

/* A bar between two panes: dragging it changes the size of one; `sign` says which way it grows. */
static void splitter(const char *name, struct box box, float *size, float sign, bool upright)
{
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    pane_begin(name, box);
    ImGui::InvisibleButton(name, ImVec2(std::fmax(box.w, 1), std::fmax(box.h, 1)));
    if (ImGui::IsItemHovered() || ImGui::IsItemActive())
        ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
    if (ImGui::IsItemActive()) {
        const ImVec2 way = ImGui::GetIO().MouseDelta;
        *size += sign * (upright ? way.x : way.y);
    }
    ImGui::End();
    ImGui::PopStyleVar();
}

/* The head of a pane, with the arrow that folds it. */
static bool head(const char *name, const char *help, bool *folded, ImGuiDir open, ImGuiDir shut)
{
    char label[64];
    std::snprintf(label, sizeof label, "##fold %s", name);
    if (ImGui::ArrowButton(label, *folded ? shut : open))
        *folded = !*folded;
    tip(help);
    return !*folded;
}

static float clamp(float value, float least, float most)
{
    return std::fmax(std::fmin(value, most), least);
}

static void panes(struct overlay *overlay, struct overlay_model *model)
{
    struct overlay_settings *s = model->settings;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float em = overlay->em, strip = em * 2, bar = std::round(em * 0.35f);
    const float unit = overlay->font_size / 15; /* settings are for letters of 15 pixels */
    float top = std::round(em * 2.4f), bottom = std::round(em * 1.7f);
    float middle = screen.y - top - bottom;
    /* a third side has its column; small windows have room for the picture alone */
    float more = model->side_count > 2 ? em * 3.4f : 0;
    bool narrow = screen.x < em * 40, flat = middle < em * 24;
    float left =
        s->left_folded || narrow ? strip : clamp(s->left * unit + more, em * 8, screen.x * 0.4f);
    float right =
        s->right_folded || narrow ? strip : clamp(s->right * unit, em * 8, screen.x * 0.4f);
    float low = s->bottom_folded || flat ? strip : clamp(s->bottom * unit, em * 4, middle * 0.6f);
    verdict(overlay, model, {0, 0, screen.x, top});
    status(model, {0, screen.y - bottom, screen.x, bottom});
    splitter("left bar", {left, top, bar, middle}, &left, 1, true);
    splitter("right bar", {screen.x - right - bar, top, bar, middle}, &right, -1, true);
    float inner = screen.x - left - right - 2 * bar;
    splitter("lower bar", {left + bar, top + middle - low - bar, inner, bar}, &low, -1, false);

    pane_begin("left", {0, top, left, middle});
    if (head("left", "F2", &s->left_folded, ImGuiDir_Left, ImGuiDir_Right) && !narrow) {
        ImGui::SameLine();
        passes(overlay, model);
        s->left = (left - more) / unit;
    }
    ImGui::End();
    params_pane(overlay, model, {screen.x - right, top, right, middle}, narrow);
    if (!s->right_folded && !narrow)
        s->right = right / unit;
    pane_begin("lower", {left + bar, top + middle - low, inner, low});
    if (model->error && model->error != overlay->error)
        s->bottom_folded = false;
    if (head("lower", "F4", &s->bottom_folded, ImGuiDir_Down, ImGuiDir_Up) && !flat) {
        ImGui::SameLine();
        ImGui::BeginGroup();
        lower(overlay, model);
        ImGui::EndGroup();
        s->bottom = low / unit;
    }
    ImGui::End();
    picture_pane(overlay, model, {left + bar, top, inner, middle - low - bar});
}

/* ---- Frames ---------------------------------------------------------------------------------- */

void overlay_build(struct overlay *overlay, struct overlay_model *model)
{
    ImGui::SetCurrentContext(overlay->context);
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    overlay->em = ImGui::GetFontSize();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    if (!model->settings->hidden)
        panes(overlay, model);
    else
        picture_alone(overlay, model, {0, 0, screen.x, screen.y});
    if (model->settings->hidden && model->error)
        error_alone(overlay, model->error_title, model->error);
    ImGui::Render();
}

void overlay_draw(const struct overlay *overlay)
{
    ImGui::SetCurrentContext(overlay->context);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void overlay_room(const struct overlay *overlay, uint32_t size[2])
{
    size[0] = overlay->room.x >= 1 ? static_cast<uint32_t>(overlay->room.x) : 1;
    size[1] = overlay->room.y >= 1 ? static_cast<uint32_t>(overlay->room.y) : 1;
}

void overlay_whole_picture(struct overlay *overlay)
{
    overlay->zoom = 0;
}

void overlay_keys(struct overlay *overlay)
{
    overlay->tab = "keys";
}

bool overlay_takes_mouse(const struct overlay *overlay)
{
    ImGui::SetCurrentContext(overlay->context);
    return ImGui::GetIO().WantCaptureMouse;
}

bool overlay_takes_keys(const struct overlay *overlay)
{
    ImGui::SetCurrentContext(overlay->context);
    return ImGui::GetIO().WantTextInput;
}

bool overlay_is_editing(const struct overlay *overlay)
{
    ImGui::SetCurrentContext(overlay->context);
    return ImGui::IsAnyItemActive();
}

bool overlay_is_pointing(const struct overlay *overlay)
{
    return overlay->pointing;
}
