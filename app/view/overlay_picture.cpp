/* The middle of the window: the picture of each side, or a buffer as a table, with what is chosen
 * above and the numbers under the pointer below; see overlay.h. */
#include "view/overlay_parts.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

/* ---- What is shown, and how ------------------------------------------------------------------ */

static const struct dt_resource *shown_resource(const struct overlay_model *model)
{
    return &model->info->resources[model->shown->resource];
}

static void heading(const struct overlay_model *model)
{
    const struct overlay_shown *shown = model->shown;
    const struct dt_resource *resource = shown_resource(model);
    const uint32_t *extent = model->extent;
    if (resource->kind == DT_BUFFER)
        ImGui::Text("%s: %u elements of %u bytes", resource->name, extent[0], resource->stride);
    else if (resource->layered)
        ImGui::Text("%s: %s, %ux%u, %u layers", resource->name, format_info(resource->format)->name,
                    extent[0], extent[1], extent[2]);
    else
        ImGui::Text("%s: %s, %ux%u", resource->name, format_info(resource->format)->name, extent[0],
                    extent[1]);
    tip(resource->doc ? resource->doc : "");
    ImGui::SameLine();
    const double *ms = model->sides[0].pass_ms;
    bool skipped = ms && std::isnan(ms[shown->pass]);
    ImGui::TextDisabled("after %s%s", model->info->passes[shown->pass].name,
                        skipped ? ", which does not run" : "");
}

/* Begins an item of that width, in letters, in the row. */
static void item(const char *label, float letters)
{
    float width = ImGui::GetFontSize() * letters;
    flow(width + ImGui::CalcTextSize(label, nullptr, true).x + ImGui::GetFontSize());
    ImGui::SetNextItemWidth(width);
}

static void choose_part(struct overlay_model *model)
{
    struct overlay_shown *shown = model->shown;
    const struct dt_resource *resource = shown_resource(model);
    int layers = static_cast<int>(model->extent[2]), mip = static_cast<int>(shown->mip);
    if (layers > 1) {
        item("layer", 6);
        if (ImGui::SliderInt("layer", &shown->layer, -1, layers - 1,
                             shown->layer < 0 ? "all" : "%d", ImGuiSliderFlags_AlwaysClamp))
            model->wishes |= OVERLAY_REDRAW;
    }
    if (resource->mips > 1) {
        item("mip", 4);
        if (ImGui::SliderInt("mip", &mip, 0, static_cast<int>(resource->mips) - 1, "%d",
                             ImGuiSliderFlags_AlwaysClamp)) {
            shown->mip = static_cast<uint32_t>(mip);
            shown->marked = false;
            model->wishes |= OVERLAY_STEP;
        }
    }
}

static void choose_look(struct overlay_model *model)
{
    struct picture_look *look = &model->shown->look;
    static const char *const names[] = {"color", "r", "g", "b", "a"};
    int channels = static_cast<int>(format_info(shown_resource(model)->format)->channels);
    int channel = static_cast<int>(look->channel);
    bool changed = false;
    if (channels > 1) {
        item("##channel", 4);
        changed |= ImGui::Combo("##channel", &channel, names, channels + 1);
        look->channel = static_cast<uint32_t>(channel);
    }
    item("exposure", 6);
    changed |= ImGui::SliderFloat("exposure", &look->exposure, -12, 12, "%+.1f");
    item("range", 0);
    changed |= ImGui::Checkbox("range", &look->ranged);
    if (look->ranged) {
        float width = std::fabs(look->range[1] - look->range[0]);
        item("##range", 10);
        changed |= ImGui::DragFloat2("##range", look->range, width > 0 ? width / 200 : 0.01f, 0, 0,
                                     "%.4g");
    }
    if (button("fit", "R: black and white are the least and the largest number of what is shown"))
        model->wishes |= OVERLAY_FIT;
    item("false colour", 0);
    changed |= ImGui::Checkbox("false colour", &look->tinted);
    tip("T: dark blue, cyan, yellow, dark red; NaN and Inf are magenta");
    if (changed)
        model->wishes |= OVERLAY_REDRAW;
}

static void choose_mode(struct overlay *overlay, struct overlay_model *model)
{
    struct overlay_shown *shown = model->shown;
    static const char *const modes[] = {"side by side", "curtain", "difference"};
    int mode = shown->mode;
    if (model->side_count > 1) {
        item("##mode", 8);
        if (ImGui::Combo("##mode", &mode, modes, OVERLAY_MODES))
            model->wishes |= OVERLAY_REDRAW;
        tip("C");
        shown->mode = static_cast<enum overlay_mode>(mode);
    }
    if (model->side_count > 1 && mode == OVERLAY_DIFFERENCE) {
        item("times", 5);
        if (ImGui::SliderFloat("times", &shown->gain, 1, 65536, "%.0f",
                               ImGuiSliderFlags_Logarithmic))
            model->wishes |= OVERLAY_REDRAW;
    }
    if (button("whole", "F: as large as fits"))
        overlay->zoom = 0;
    if (button("1:1", "a pixel of the screen for each"))
        overlay->zoom = 1;
}

static void toolbar(struct overlay *overlay, struct overlay_model *model)
{
    bool image = shown_resource(model)->kind == DT_IMAGE;
    heading(model);
    ImGui::Dummy(ImVec2(0, 0));
    if (image) {
        choose_part(model);
        choose_look(model);
        choose_mode(overlay, model);
        if (button("PNG", "P: save what is seen"))
            model->wishes |= OVERLAY_SAVE_PNG;
        if (button("EXR", "save the numbers of the first three channels"))
            model->wishes |= OVERLAY_SAVE_EXR;
    }
    if (button(".npy", "save all numbers, for NumPy; of each side"))
        model->wishes |= OVERLAY_SAVE_NPY;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static bool shows_integers(enum number_kind kind)
{
    return !number_is_float(kind) && !number_one(kind);
}

static void number_text(char *text, size_t size, enum number_kind kind, uint32_t bits)
{
    double value = number_of_bits(kind, bits);
    if (shows_integers(kind))
        std::snprintf(text, size, "%.0f 0x%x", value, bits);
    else if (number_one(kind))
        std::snprintf(text, size, "%.5g (%u)", value, bits);
    else
        std::snprintf(text, size, kind == NUMBER_FLOAT ? "%.9g" : "%.5g", value);
}

/* The bits of a number of an element; false: that side was not read. */
static bool read_bits(const struct overlay_model *model, uint32_t side, uint64_t element,
                      const struct component *component, uint32_t *bits)
{
    const struct dt_bytes *bytes = model->sides[side].bytes;
    size_t at = element * resource_stride(shown_resource(model)) + component->offset;
    if (!bytes->data || at + number_size(component->kind) > bytes->size)
        return false;
    *bits = number_bits(component->kind, bytes->data + at);
    return true;
}

static const ImVec4 red(1, 0.5f, 0.45f, 1);

/* A row of the distances of one side from the first. */
static void distances(const struct overlay_model *model, uint32_t side, uint64_t element,
                      const struct component *list, uint32_t count)
{
    ImGui::TableNextColumn();
    bool ulp = number_is_float(list[0].kind);
    ImGui::TextDisabled("%s - %s, %s", model->sides[0].label, model->sides[side].label,
                        ulp                        ? "ulp"
                        : number_one(list[0].kind) ? "codes"
                                                   : "apart");
    for (uint32_t i = 0; i < count; i++) {
        uint32_t bits[2];
        ImGui::TableNextColumn();
        if (!read_bits(model, 0, element, &list[i], &bits[0]) ||
            !read_bits(model, side, element, &list[i], &bits[1]))
            continue;
        double apart = difference_distance(list[i].kind, bits);
        if (apart > 0)
            ImGui::TextColored(red, "%.0f", apart);
        else
            ImGui::TextDisabled("0");
    }
}

static void numbers_of_texel(const struct overlay_model *model, uint64_t element)
{
    const struct dt_resource *resource = shown_resource(model);
    struct component *list = nullptr;
    uint32_t count = resource_components(resource, &list);
    char *place = element_place(resource, model->extent, element);
    if (count && place &&
        ImGui::BeginTable("texel", 1 + static_cast<int>(count),
                          ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_BordersInnerV)) {
        ImGui::TableSetupColumn(place);
        for (uint32_t i = 0; i < count; i++)
            ImGui::TableSetupColumn(list[i].name, 0, ImGui::GetFontSize() * 9);
        ImGui::TableHeadersRow();
        for (uint32_t k = 0; k < model->side_count; k++) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(model->sides[k].label);
            for (uint32_t i = 0; i < count; i++) {
                uint32_t bits;
                char text[64] = "";
                if (read_bits(model, k, element, &list[i], &bits))
                    number_text(text, sizeof text, list[i].kind, bits);
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(text);
            }
        }
        for (uint32_t k = 1; k < model->side_count; k++)
            distances(model, k, element, list, count);
        ImGui::EndTable();
    }
    free(place);
    free(list);
}

static void numbers(struct overlay *overlay, const struct overlay_model *model, struct box box)
{
    const struct overlay_shown *shown = model->shown;
    pane_begin("numbers", box);
    ImGui::PushFont(overlay->mono);
    if (overlay->pointing || shown->marked)
        numbers_of_texel(model, overlay->pointing ? overlay->pointed : shown->texel);
    else
        ImGui::TextDisabled("Point at a texel to read its numbers.");
    ImGui::PopFont();
    ImGui::End();
}

/* ---- Buffers --------------------------------------------------------------------------------- */

static void element_cell(const struct overlay_model *model, uint64_t element,
                         const struct component *component)
{
    char text[OVERLAY_SIDES][64] = {}, tips[512] = "";
    uint32_t bits[OVERLAY_SIDES] = {};
    bool same = true;
    size_t used = 0;
    for (uint32_t k = 0; k < model->side_count; k++) {
        if (!read_bits(model, k, element, component, &bits[k]))
            return;
        const uint32_t pair[2] = {bits[0], bits[k]};
        number_text(text[k], sizeof text[k], component->kind, bits[k]);
        used += static_cast<size_t>(std::snprintf(
            tips + used, sizeof tips - used, "%s%.40s: %s, 0x%08x; %.0f apart", k ? "\n" : "",
            model->sides[k].label, text[k], bits[k], difference_distance(component->kind, pair)));
        same &= bits[k] == bits[0];
    }
    if (same)
        ImGui::TextUnformatted(text[0]);
    for (uint32_t k = 0; !same && k < model->side_count; k++) {
        ImGui::TextColored(red, "%s%s", k ? "| " : "", text[k]);
        tip(tips);
        if (k + 1 < model->side_count)
            ImGui::SameLine();
    }
}

static void buffer_table(struct overlay *overlay, struct overlay_model *model, bool jump)
{
    static const uint32_t most = 60; /* columns */
    const ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit |
                                  ImGuiTableFlags_ScrollX | ImGuiTableFlags_ScrollY |
                                  ImGuiTableFlags_BordersInnerV | ImGuiTableFlags_Resizable;
    struct component *list = nullptr;
    uint32_t count = resource_components(shown_resource(model), &list);
    count = count < most ? count : most;
    ImGui::PushFont(overlay->mono);
    if (count && ImGui::BeginTable("elements", 1 + static_cast<int>(count), flags)) {
        ImGui::TableSetupScrollFreeze(1, 1);
        ImGui::TableSetupColumn("");
        for (uint32_t i = 0; i < count; i++)
            ImGui::TableSetupColumn(*list[i].name ? list[i].name : "value");
        ImGui::TableHeadersRow();
        if (jump)
            ImGui::SetScrollY(static_cast<float>(model->shown->texel) *
                              ImGui::GetTextLineHeightWithSpacing());
        ImGuiListClipper clipper;
        clipper.Begin(static_cast<int>(model->extent[0]));
        while (clipper.Step())
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; i++) {
                uint64_t element = static_cast<uint64_t>(i);
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                bool marked = model->shown->marked && model->shown->texel == element;
                ImGui::TextColored(marked ? ImVec4(1, 0.9f, 0.3f, 1)
                                          : ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled),
                                   "[%d]", i);
                for (uint32_t c = 0; c < count; c++) {
                    ImGui::TableNextColumn();
                    element_cell(model, element, &list[c]);
                }
            }
        ImGui::EndTable();
    }
    ImGui::PopFont();
    free(list);
}

/* ---- Pictures -------------------------------------------------------------------------------- */

/* Where the picture lies in a room: left, top, and pixels of the window per pixel. */
struct place {
    float x, y, factor;
};

static struct place place_in(struct overlay *overlay, const uint32_t size[2], struct box room)
{
    float w = static_cast<float>(size[0]), h = static_cast<float>(size[1]);
    struct place place;
    if (overlay->zoom <= 0) {
        place.factor = std::fmin(room.w / w, room.h / h);
        place.x = room.x + std::floor((room.w - w * place.factor) / 2);
        place.y = room.y + std::floor((room.h - h * place.factor) / 2);
        overlay->centre = ImVec2(w / 2, h / 2);
    } else {
        overlay->centre.x = std::fmin(std::fmax(overlay->centre.x, 0), w);
        overlay->centre.y = std::fmin(std::fmax(overlay->centre.y, 0), h);
        place.factor = overlay->zoom;
        place.x = std::round(room.x + room.w / 2 - overlay->centre.x * place.factor);
        place.y = std::round(room.y + room.h / 2 - overlay->centre.y * place.factor);
    }
    return place;
}

/* ImGui's name of a texture is a pointer, or a number in later versions. */
static ImTextureID texture_of(const struct overlay_side *side)
{
    const uintptr_t number = side->texture;
    ImTextureID texture;
    static_assert(sizeof texture == sizeof number, "of one size");
    std::memcpy(&texture, &number, sizeof texture);
    return texture;
}

/* From `from` to `to`, parts of the picture's width. */
static void draw_part(const struct overlay_model *model, uint32_t side, const uint32_t size[2],
                      struct box room, struct place place, float from, float to)
{
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    float w = static_cast<float>(size[0]) * place.factor;
    float h = static_cast<float>(size[1]) * place.factor;
    bool flipped = model->sides[side].flipped;
    list->PushClipRect(ImVec2(room.x, room.y), ImVec2(room.x + room.w, room.y + room.h));
    list->AddImage(texture_of(&model->sides[side]), ImVec2(place.x + w * from, place.y),
                   ImVec2(place.x + w * to, place.y + h), ImVec2(from, flipped ? 1.0f : 0.0f),
                   ImVec2(to, flipped ? 0.0f : 1.0f));
    list->PopClipRect();
}

/* A frame around the marked texel. */
static void draw_mark(const struct overlay_model *model, const uint32_t extent[3], struct box room,
                      struct place place)
{
    const struct overlay_shown *shown = model->shown;
    uint64_t area = static_cast<uint64_t>(extent[0]) * extent[1], texel = shown->texel;
    uint32_t at[2];
    if (!shown->marked ||
        (shown->layer >= 0 && texel / area != static_cast<uint64_t>(shown->layer)))
        return;
    picture_place(extent, shown->layer >= 0 ? texel % area : texel, at);
    float half = std::fmax(place.factor, 6) / 2;
    float x = place.x + (static_cast<float>(at[0]) + 0.5f) * place.factor;
    float y = place.y + (static_cast<float>(at[1]) + 0.5f) * place.factor;
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->PushClipRect(ImVec2(room.x, room.y), ImVec2(room.x + room.w, room.y + room.h));
    list->AddRect(ImVec2(x - half - 2, y - half - 2), ImVec2(x + half + 2, y + half + 2),
                  IM_COL32(0, 0, 0, 255), 0, 0, 2);
    list->AddRect(ImVec2(x - half, y - half), ImVec2(x + half, y + half),
                  IM_COL32(255, 225, 60, 255), 0, 0, 2);
    list->PopClipRect();
}

/* The pointer in one room: the texel, and what wheel and middle button do. */
static void point(struct overlay *overlay, const struct overlay_model *model,
                  const uint32_t extent[3], struct box room, struct place place)
{
    const ImGuiIO &io = ImGui::GetIO();
    const struct overlay_shown *shown = model->shown;
    ImVec2 mouse = io.MousePos;
    if (io.WantCaptureMouse || mouse.x < room.x || mouse.y < room.y || mouse.x >= room.x + room.w ||
        mouse.y >= room.y + room.h)
        return;
    ImVec2 at((mouse.x - place.x) / place.factor, (mouse.y - place.y) / place.factor);
    const uint32_t pixel[2] = {static_cast<uint32_t>(at.x), static_cast<uint32_t>(at.y)};
    if (at.x >= 0 && at.y >= 0 && picture_texel(extent, pixel, &overlay->pointed)) {
        overlay->pointing = true;
        if (shown->layer > 0)
            overlay->pointed +=
                static_cast<uint64_t>(extent[0]) * extent[1] * static_cast<uint64_t>(shown->layer);
    }
    if (io.MouseWheel != 0 && !io.KeyCtrl) {
        overlay->zoom =
            std::fmin(std::fmax(place.factor * std::pow(1.25f, io.MouseWheel), 0.05f), 256.0f);
        overlay->centre.x = at.x + (room.x + room.w / 2 - mouse.x) / overlay->zoom;
        overlay->centre.y = at.y + (room.y + room.h / 2 - mouse.y) / overlay->zoom;
    }
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0)) {
        overlay->zoom = place.factor;
        overlay->centre.x -= io.MouseDelta.x / place.factor;
        overlay->centre.y -= io.MouseDelta.y / place.factor;
    }
}

/* Another resource is seen whole, a newly marked texel from near. True: it is newly marked. */
static bool follow_window(struct overlay *overlay, const struct overlay_model *model,
                          const uint32_t extent[3])
{
    static const float near = 12;
    const struct overlay_shown *shown = model->shown;
    bool other = shown->resource != overlay->resource;
    bool jump = shown->marked && (!overlay->marked || other || shown->texel != overlay->texel);
    if (other)
        overlay->zoom = 0;
    if (jump && shown_resource(model)->kind == DT_IMAGE) {
        uint64_t area = static_cast<uint64_t>(extent[0]) * extent[1];
        uint32_t at[2];
        picture_place(extent, shown->layer >= 0 ? shown->texel % area : shown->texel, at);
        overlay->zoom = near;
        overlay->centre =
            ImVec2(static_cast<float>(at[0]) + 0.5f, static_cast<float>(at[1]) + 0.5f);
    }
    overlay->resource = shown->resource;
    overlay->marked = shown->marked;
    overlay->texel = shown->texel;
    return jump;
}

static void label(struct overlay *overlay, const struct overlay_model *model, uint32_t side,
                  struct box box)
{
    const struct overlay_shown *shown = model->shown;
    char text[256];
    if (shown->mode == OVERLAY_DIFFERENCE && model->side_count > 1)
        std::snprintf(text, sizeof text, "|%s - %s| x %g", model->sides[0].label,
                      model->sides[side].label, static_cast<double>(shown->gain));
    else
        std::snprintf(text, sizeof text, "%s   %s", model->sides[side].label,
                      model->sides[side].device);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->PushClipRect(ImVec2(box.x, box.y), ImVec2(box.x + box.w, box.y + box.h));
    list->AddText(overlay->text, overlay->font_size, ImVec2(box.x + overlay->em * 0.4f, box.y),
                  IM_COL32(215, 215, 220, 255), text);
    list->PopClipRect();
}

static void pictures(struct overlay *overlay, struct overlay_model *model, struct box box,
                     float label_height)
{
    const struct overlay_shown *shown = model->shown;
    bool several = model->side_count > 1;
    bool curtain = several && shown->mode == OVERLAY_CURTAIN;
    uint32_t first = several && shown->mode == OVERLAY_DIFFERENCE ? 1 : 0;
    uint32_t last = curtain ? 1 : model->side_count;
    uint32_t size[2],
        extent[3] = {model->extent[0], model->extent[1], shown->layer >= 0 ? 1 : model->extent[2]};
    picture_sheet(extent, size);
    float width = std::floor(box.w / static_cast<float>(last - first));
    overlay->room = ImVec2(width, std::fmax(box.h - label_height, 1));
    for (uint32_t i = first; i < last; i++) {
        float x = box.x + width * static_cast<float>(i - first);
        struct box room = {x, box.y + label_height, width, overlay->room.y};
        struct place place = place_in(overlay, size, room);
        float parts = curtain ? static_cast<float>(model->side_count) : 1;
        for (uint32_t k = 0; k < static_cast<uint32_t>(parts); k++) {
            float from = static_cast<float>(k) / parts, to = static_cast<float>(k + 1) / parts;
            draw_part(model, i + k, size, room, place, from, to);
            if (label_height > 0)
                label(overlay, model, i + k,
                      {x + width * from, box.y, width * (to - from), label_height});
        }
        draw_mark(model, extent, room, place);
        point(overlay, model, extent, room, place);
    }
}

void picture_alone(struct overlay *overlay, struct overlay_model *model, struct box box)
{
    overlay->pointing = false;
    if (shown_resource(model)->kind == DT_IMAGE) {
        follow_window(overlay, model, model->extent);
        pictures(overlay, model, box, 0);
    }
}

void picture_pane(struct overlay *overlay, struct overlay_model *model, struct box box)
{
    bool image = shown_resource(model)->kind == DT_IMAGE;
    float rows = static_cast<float>(2 * model->side_count);
    float low = image ? std::round(overlay->em * (1.5f * rows + 0.5f)) : 0;
    float high = overlay->toolbar > 0 ? overlay->toolbar : overlay->em * 3.4f;
    pane_begin("toolbar", {box.x, box.y, box.w, high});
    toolbar(overlay, model);
    overlay->toolbar = ImGui::GetCursorPosY() + ImGui::GetStyle().WindowPadding.y;
    ImGui::End();
    const uint32_t extent[3] = {model->extent[0], model->extent[1],
                                model->shown->layer >= 0 ? 1 : model->extent[2]};
    bool jump = follow_window(overlay, model, extent);
    struct box middle = {box.x, box.y + high, box.w, box.h - high - low};
    overlay->pointing = false;
    if (image) {
        pictures(overlay, model, middle, std::round(overlay->em * 1.3f));
        numbers(overlay, model, {box.x, box.y + box.h - low, box.w, low});
        return;
    }
    pane_begin("elements of a buffer", middle);
    buffer_table(overlay, model, jump);
    ImGui::End();
}
