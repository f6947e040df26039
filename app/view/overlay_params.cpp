/* The right of the window: parameters, settings A and B, the camera and time; see overlay.h. */
#include "view/overlay_parts.h"

#include <cmath>
#include <cstdio>
#include <cstring>

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

/* A box with a button for less and one for more. Counts when the button is released or the box left. */
static bool number_box(struct overlay *overlay, struct overlay_param *param, uint32_t index,
                       float width)
{
    const char *format = param->is_whole ? "%.0f" : "%.6g";
    double step = param->step > 0 ? param->step : param->is_whole ? 1 : 0.05;
    double large = step * 10, *value = &param->value[index];
    double shown = overlay->typing == value ? overlay->typed : *value;
    ImGui::SetNextItemWidth(width);
    ImGui::PushID(static_cast<int>(index));
    if (ImGui::InputScalar("##box", ImGuiDataType_Double, &shown, &step, &large, format)) {
        overlay->typing = value;
        overlay->typed = shown;
    }
    bool done = ImGui::IsItemDeactivatedAfterEdit() && overlay->typing == value;
    ImGui::PopID();
    if (done) {
        *value = overlay->typed;
        overlay->typing = nullptr;
    }
    return done;
}

/* Between two ends, logarithmic where they are far apart. */
static bool slider(struct overlay_param *param, float width)
{
    const char *format = param->is_whole ? "%.0f" : "%.4g";
    bool wide = param->min > 0 && param->max / param->min >= 1000;
    ImGui::SetNextItemWidth(width);
    return ImGui::SliderScalarN("##slider", ImGuiDataType_Double, param->value,
                                static_cast<int>(param->count), &param->min, &param->max, format,
                                wide ? ImGuiSliderFlags_Logarithmic : 0);
}

static bool edit_numbers(struct overlay *overlay, struct overlay_param *param)
{
    bool ranged = !std::isinf(param->min) && !std::isinf(param->max), changed = false;
    float width = ImGui::GetContentRegionAvail().x - ImGui::GetFontSize() * 1.8f;
    float gap = ImGui::GetStyle().ItemSpacing.x;
    if (param->count == 1) {
        changed |= number_box(overlay, param, 0, ranged ? width * 0.5f : width);
        if (ranged) {
            ImGui::SameLine();
            changed |= slider(param, width * 0.5f - gap);
        }
        return changed;
    }
    if (ranged)
        return slider(param, width);
    for (uint32_t i = 0; i < param->count; i++)
        changed |= number_box(overlay, param, i, width);
    return changed;
}

static void edit(struct overlay *overlay, struct overlay_param *param)
{
    bool changed,
        other = std::memcmp(param->value, param->initial, param->count * sizeof *param->value) != 0;
    ImGui::PushID(param->name);
    if (param->is_bool && param->count == 1) {
        bool on = param->value[0] != 0;
        changed = ImGui::Checkbox(param->name, &on);
        param->value[0] = on;
        tip(param->doc);
    } else {
        ImGui::TextColored(other ? ImVec4(1, 0.9f, 0.5f, 1)
                                 : ImGui::GetStyleColorVec4(ImGuiCol_Text),
                           "%s", param->name);
        tip(param->doc);
        changed = edit_numbers(overlay, param);
    }
    if (changed)
        snap(param);
    if (other) {
        ImGui::SameLine();
        if (ImGui::SmallButton("x"))
            std::memcpy(param->value, param->initial, sizeof param->value);
        tip("as it was given");
    }
    ImGui::PopID();
}

static void group(struct overlay *overlay, struct overlay_model *model, const char *name, bool live)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < model->param_count; i++)
        count += model->params[i].live == live;
    if (!count || !ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen))
        return;
    for (uint32_t i = 0; i < model->param_count; i++)
        if (model->params[i].live == live &&
            is_sought(overlay->param_search, model->params[i].name))
            edit(overlay, &model->params[i]);
}

static void changes(struct overlay_model *model)
{
    char label[32];
    std::snprintf(label, sizeof label, "settings %c", model->slot);
    ImGui::Dummy(ImVec2(0, 0));
    if (button(label, "B: changes between two settings, A and B"))
        model->wishes |= OVERLAY_SWAP;
    if (button("undo", "Ctrl+Z"))
        model->wishes |= OVERLAY_UNDO;
    if (!*model->changes)
        return;
    if (button("copy", "what you changed, as options of the command line"))
        ImGui::SetClipboardText(model->changes);
    if (button("save", "what you changed, as a file for --with"))
        model->wishes |= OVERLAY_SAVE_SETS;
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("%s", model->changes);
    ImGui::PopTextWrapPos();
}

static void time_bar(struct overlay_model *model)
{
    if (!ImGui::CollapsingHeader("time and camera", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    ImGui::Dummy(ImVec2(0, 0));
    if (button(model->paused ? "run" : "pause", "Space"))
        model->wishes |= OVERLAY_PAUSE;
    if (button("one frame", "the . key"))
        model->wishes |= OVERLAY_STEP | OVERLAY_ALONE;
    if (button("save camera", "Ctrl+S: as a file for --motion"))
        model->wishes |= OVERLAY_SAVE_CAMERA;
    if (model->moments) {
        const uint32_t least = 0, most = model->moments - 1;
        ImGui::Checkbox("moves", model->moving);
        tip("camera and light follow the motion");
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-1);
        if (ImGui::SliderScalar("##moment", ImGuiDataType_U32, model->moment, &least, &most,
                                "frame %u", ImGuiSliderFlags_AlwaysClamp))
            model->wishes |= OVERLAY_STEP;
    }
    if (model->side_count > 1 &&
        button("bisect here", "compares these settings from this camera in a process of its own, "
                              "and writes a folder for `diptych replay`"))
        model->wishes |= OVERLAY_BISECT;
}

void params_pane(struct overlay *overlay, struct overlay_model *model, struct box box, bool narrow)
{
    bool *folded = &model->settings->right_folded;
    pane_begin("right", box);
    if (ImGui::ArrowButton("##fold right", *folded ? ImGuiDir_Left : ImGuiDir_Right))
        *folded = !*folded;
    tip("F3");
    if (!*folded && !narrow) {
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-1);
        ImGui::InputTextWithHint("##search", "search parameters", overlay->param_search,
                                 sizeof overlay->param_search);
        changes(model);
        ImGui::BeginChild("all", ImVec2(0, 0));
        time_bar(model);
        group(overlay, model, "live parameters", true);
        group(overlay, model, "baked: an edit makes the plan again", false);
        ImGui::EndChild();
    }
    ImGui::End();
}
