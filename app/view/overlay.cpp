/* Describes the overlay to Dear ImGui; see overlay.h. */
#include "view/overlay.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <vector>

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/imgui.h>

struct overlay {
    ImGuiContext *context;
    std::vector<dt_window_vertex> vertices;
    std::vector<dt_window_draw> draws;
};

struct overlay *overlay_open(void *window)
{
    struct overlay *overlay = new (std::nothrow) struct overlay;
    if (!overlay)
        return nullptr;
    overlay->context = ImGui::CreateContext();
    ImGui::SetCurrentContext(overlay->context);
    ImGui::GetIO().IniFilename = nullptr; /* no imgui.ini */
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 0;
    ImGui_ImplGlfw_InitForOther(static_cast<GLFWwindow *>(window), true);
    return overlay;
}

void overlay_close(struct overlay *overlay)
{
    if (!overlay)
        return;
    ImGui::SetCurrentContext(overlay->context);
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(overlay->context);
    delete overlay;
}

const uint8_t *overlay_atlas(struct overlay *overlay, uint32_t *width, uint32_t *height)
{
    unsigned char *pixels = nullptr;
    int size[2];
    ImGui::SetCurrentContext(overlay->context);
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &size[0], &size[1]);
    *width = static_cast<uint32_t>(size[0]);
    *height = static_cast<uint32_t>(size[1]);
    return pixels;
}

/* ---- Parts ----------------------------------------------------------------------------------- */

static void tip(const char *text)
{
    if (!*text || !ImGui::IsItemHovered())
        return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 30);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

static void cell(double ms)
{
    ImGui::TableNextColumn();
    if (std::isnan(ms))
        ImGui::TextDisabled("-");
    else
        ImGui::Text("%.2f", ms);
}

static void times(const struct overlay_model *model)
{
    const ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit;
    if (!ImGui::BeginTable("times", 1 + static_cast<int>(model->side_count), flags))
        return;
    ImGui::TableSetupColumn("ms", ImGuiTableColumnFlags_WidthStretch);
    for (uint32_t i = 0; i < model->side_count; i++)
        ImGui::TableSetupColumn(model->sides[i]);
    ImGui::TableHeadersRow();
    for (uint32_t i = 0; i < model->pass_count; i++) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(model->passes[i].name);
        tip(model->passes[i].doc);
        for (uint32_t j = 0; j < model->side_count; j++)
            cell(model->passes[i].ms[j]);
    }
    ImGui::TableNextColumn();
    ImGui::TextUnformatted("frame");
    for (uint32_t j = 0; j < model->side_count; j++)
        cell(model->frame_ms[j]);
    ImGui::EndTable();
}

/* To the nearest step from the smallest value. */
static void snap(struct overlay_param *param)
{
    double step = param->is_whole && param->step <= 0 ? 1 : param->step;
    double origin = std::isinf(param->min) ? 0 : param->min;
    for (uint32_t i = 0; i < param->count; i++) {
        double &value = param->value[i];
        if (step > 0)
            value = origin + std::round((value - origin) / step) * step;
        value = std::fmin(std::fmax(value, param->min), param->max);
    }
}

/* A slider between two ends, logarithmic where they are far apart; else a field with buttons. */
static bool edit_numbers(struct overlay_param *param)
{
    const char *format = param->is_whole ? "%.0f" : "%.4g";
    const int count = static_cast<int>(param->count);
    if (std::isinf(param->min) || std::isinf(param->max)) {
        double step = param->step > 0 ? param->step : 1;
        return ImGui::InputScalarN(param->name, ImGuiDataType_Double, param->value, count, &step,
                                   nullptr, format);
    }
    bool wide = param->min > 0 && param->max / param->min >= 1000;
    return ImGui::SliderScalarN(param->name, ImGuiDataType_Double, param->value, count, &param->min,
                                &param->max, format, wide ? ImGuiSliderFlags_Logarithmic : 0);
}

static void edit(struct overlay_param *param)
{
    if (param->is_bool && param->count == 1) {
        bool on = param->value[0] != 0;
        param->changed = ImGui::Checkbox(param->name, &on);
        param->value[0] = on;
    } else {
        param->changed = edit_numbers(param);
    }
    if (param->changed)
        snap(param);
    tip(param->doc);
    if (std::memcmp(param->value, param->initial, param->count * sizeof *param->value) != 0) {
        char label[128];
        std::snprintf(label, sizeof label, "x##%s", param->name);
        ImGui::SameLine();
        if (ImGui::SmallButton(label)) {
            std::memcpy(param->value, param->initial, sizeof param->value);
            param->changed = true;
        }
        tip("as in the spec");
    }
}

static void keys(void)
{
    ImGui::TextUnformatted("W A S D, Q E   fly, down and up; Shift: faster\n"
                           "mouse, wheel   look, speed\n"
                           "Tab  <- ->     next, previous image\n"
                           "Home           the picture again\n"
                           "Up Down        layer; PgUp PgDn: mip\n"
                           "V              points; 0..9: see the outline\n"
                           "C  + -         compare two sides; gain\n"
                           "Space          pause\n"
                           "P              screenshot\n"
                           "Ctrl+S         camera into the scene file\n"
                           "H              this panel\n"
                           "Esc            end");
}

static void panel(struct overlay_model *model)
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(340, screen.y - 16), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowBgAlpha(0.75f);
    if (ImGui::Begin(model->title)) {
        ImGui::TextUnformatted(model->shown);
        if (*model->doc)
            ImGui::TextWrapped("%s", model->doc);
        if (*model->points)
            ImGui::TextWrapped("+ %s", model->points);
        if (*model->state)
            ImGui::TextColored(ImVec4(1, 0.8f, 0.3f, 1), "%s", model->state);
        if (ImGui::CollapsingHeader("times", ImGuiTreeNodeFlags_DefaultOpen))
            times(model);
        if (ImGui::CollapsingHeader("live parameters", ImGuiTreeNodeFlags_DefaultOpen)) {
            ImGui::PushItemWidth(140);
            for (uint32_t i = 0; i < model->param_count; i++)
                edit(&model->params[i]);
            ImGui::PopItemWidth();
        }
        if (ImGui::CollapsingHeader("keys"))
            keys();
    }
    ImGui::End();
}

/* At the bottom, in a fixed-width font, so that carets stand at their column. */
static void error(const char *title, const char *text)
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const ImVec2 size = ImGui::CalcTextSize(text);
    float height = std::fmin(size.y + 40, screen.y * 0.6f);
    ImGui::SetNextWindowPos(ImVec2(8, screen.y - height - 8));
    ImGui::SetNextWindowSize(ImVec2(screen.x - 16, height));
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.25f, 0.02f, 0.02f, 0.92f));
    ImGui::Begin(title, nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_HorizontalScrollbar);
    ImGui::TextUnformatted(text);
    ImGui::End();
    ImGui::PopStyleColor();
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* ImGui's indexed lists as plain triangles. */
static void take_triangles(struct overlay *overlay, const ImDrawData *data)
{
    static_assert(sizeof(ImDrawVert) == sizeof(dt_window_vertex), "the same layout");
    const ImVec2 scale = data->FramebufferScale;
    overlay->vertices.clear();
    overlay->draws.clear();
    for (int i = 0; i < data->CmdListsCount; i++) {
        const ImDrawList *list = data->CmdLists[i];
        for (const ImDrawCmd &command : list->CmdBuffer) {
            dt_window_draw draw = {};
            const ImVec4 &clip = command.ClipRect;
            const float edges[4] = {clip.x * scale.x, clip.y * scale.y, clip.z * scale.x,
                                    clip.w * scale.y};
            for (int k = 0; k < 4; k++)
                draw.clip[k] = static_cast<int32_t>(edges[k]);
            draw.first = static_cast<uint32_t>(overlay->vertices.size());
            draw.count = command.ElemCount;
            overlay->draws.push_back(draw);
            for (unsigned k = 0; k < command.ElemCount; k++) {
                const ImDrawIdx index = list->IdxBuffer[static_cast<int>(command.IdxOffset + k)];
                const ImDrawVert &from =
                    list->VtxBuffer[static_cast<int>(command.VtxOffset + index)];
                dt_window_vertex vertex;
                std::memcpy(&vertex, &from, sizeof vertex);
                vertex.position[0] *= scale.x;
                vertex.position[1] *= scale.y;
                overlay->vertices.push_back(vertex);
            }
        }
    }
}

void overlay_build(struct overlay *overlay, struct overlay_model *model)
{
    ImGui::SetCurrentContext(overlay->context);
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    if (!model->hidden)
        panel(model);
    if (model->error)
        error(model->error_title, model->error);
    ImGui::Render();
    take_triangles(overlay, ImGui::GetDrawData());
}

struct dt_window_frame overlay_frame(const struct overlay *overlay)
{
    struct dt_window_frame frame = {};
    frame.vertices = overlay->vertices.data();
    frame.vertex_count = static_cast<uint32_t>(overlay->vertices.size());
    frame.draws = overlay->draws.data();
    frame.draw_count = static_cast<uint32_t>(overlay->draws.size());
    return frame;
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
