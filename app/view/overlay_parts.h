/* Shared by the files that describe the window to Dear ImGui; see overlay.h. */
#pragma once

#include <imgui/imgui.h>

extern "C" {
#include "picture/texels.h"
#include "result/difference.h"
}
#include "view/overlay.h"

/* A rectangle of the window. */
struct box {
    float x, y, w, h;
};

struct overlay {
    ImGuiContext *context;
    float font_size;
    ImFont *text, *large, *mono;
    float em; /* height of a line of text */
    /* of the picture */
    float zoom;    /* pixels of the window per pixel of the picture; 0: as large as fits */
    ImVec2 centre; /* pixel of the picture in the middle of its room */
    ImVec2 room;   /* of each side */
    float toolbar; /* height of the controls above it */
    bool pointing;
    uint64_t pointed; /* texel under the pointer */
    bool marked;      /* as it was in the last build, like the next two */
    uint64_t texel;
    uint32_t resource;
    const double *typing; /* number that is being typed; NULL: none */
    double typed;
    uint32_t listed; /* row of the list that is shown */
    uint32_t guilty; /* first pass that differs, + 1; 0: none */
    bool seek;       /* it is another: the list goes there */
    char search[64], param_search[64];
    const char *tab; /* to be shown next in the lower pane; NULL: as it is */
    const char *error;
    uint32_t log_size;
};

/* Begins a window without decoration in that place. Always end it with ImGui::End. */
void pane_begin(const char *name, struct box box);
void tip(const char *text); /* of the last item, while the pointer is over it */
/* On the same line if so much fits there. */
void flow(float width);
bool button(const char *label, const char *help);
/* Whether the text has the sought one, in any case. */
bool is_sought(const char *search, const char *text);

void picture_pane(struct overlay *overlay, struct overlay_model *model, struct box box);
/* The picture alone. */
void picture_alone(struct overlay *overlay, struct overlay_model *model, struct box box);
void params_pane(struct overlay *overlay, struct overlay_model *model, struct box box, bool narrow);
