/* --needs: what the passes need of a Vulkan device, against what profiles promise. */
#include "print.h"

#include <inttypes.h>
#include <string.h>

#include "device_needs.h"
#include "plan/plan.h"

/* Sources: the profiles VP_KHR_roadmap_2022 and VP_ANDROID_vulkan_profile_2022 of
 * KhronosGroup/Vulkan-Profiles; for MoltenVK, its MVKDevice.mm on GPUs of Apple, version 1.4.3. */
enum profile { ROADMAP, ANDROID, MOLTENVK, PROFILES };
enum { IN_ROADMAP = 1 << ROADMAP, IN_ANDROID = 1 << ANDROID, IN_MOLTENVK = 1 << MOLTENVK };

static const struct {
    const char *name;
    unsigned profiles; /* that have the feature */
} known[] = {
    {"Vulkan 1.3", IN_ROADMAP | IN_MOLTENVK},
    {"drawIndirectFirstInstance", IN_ROADMAP | IN_MOLTENVK},
    {"fragmentStoresAndAtomics", IN_ROADMAP | IN_ANDROID | IN_MOLTENVK},
    {"fullDrawIndexUint32", IN_ROADMAP | IN_ANDROID | IN_MOLTENVK},
    {"imageCubeArray", IN_ROADMAP | IN_ANDROID | IN_MOLTENVK},
    {"independentBlend", IN_ROADMAP | IN_ANDROID | IN_MOLTENVK},
    {"largePoints", IN_ANDROID | IN_MOLTENVK},
    {"multiDrawIndirect", IN_MOLTENVK},
    {"sampleRateShading", IN_ROADMAP | IN_ANDROID | IN_MOLTENVK},
    {"samplerAnisotropy", IN_ROADMAP | IN_MOLTENVK},
    {"shaderClipDistance", IN_MOLTENVK},
    {"shaderDrawParameters", IN_ANDROID | IN_MOLTENVK},
    {"shaderImageGatherExtended", IN_MOLTENVK},
    {"shaderOutputLayer", IN_MOLTENVK},
    {"shaderStorageImageExtendedFormats", IN_ROADMAP | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_BASIC_BIT", IN_ROADMAP | IN_ANDROID | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_VOTE_BIT", IN_ROADMAP | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_ARITHMETIC_BIT", IN_ROADMAP | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_BALLOT_BIT", IN_ROADMAP | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_SHUFFLE_BIT", IN_ROADMAP | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_SHUFFLE_RELATIVE_BIT", IN_ROADMAP | IN_MOLTENVK},
    {"VK_SUBGROUP_FEATURE_QUAD_BIT", IN_ROADMAP | IN_MOLTENVK},
};

/* Told only where the least of the three profiles is not enough. */
static const struct {
    const char *name;
    uint64_t most[PROFILES];
} limits[DT_LIMITS] = {
#define ROW(name, words, vk, gl, gl_draw, index, roadmap, vulkan, moltenvk, opengl)                \
    [DT_LIMIT_##name] = {#vk, {roadmap, vulkan, moltenvk}},
    DT_DEVICE_LIMITS(ROW)
#undef ROW
};

static uint64_t larger(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

static void add_image_needs(const struct access *access, uint64_t needs[DT_LIMITS])
{
    const struct resource *image = access->resource;
    uint64_t width = expr_at_reference(image->width, 1),
             height = expr_at_reference(image->height, 1);
    uint64_t layers = expr_at_reference(image->layers, 1), side = larger(width, height);
    bool volume = image->shape == DT_SHAPE_3D;
    enum dt_device_limit limit = volume                        ? DT_LIMIT_VOLUME_SIDE
                                 : image->shape != DT_SHAPE_2D ? DT_LIMIT_CUBE_SIDE
                                                               : DT_LIMIT_IMAGE_SIDE;
    needs[limit] = larger(needs[limit], volume ? larger(side, layers) : side);
    if (!volume)
        needs[DT_LIMIT_IMAGE_LAYERS] = larger(needs[DT_LIMIT_IMAGE_LAYERS], layers);
    if (access->kind & (DT_WRITE_COLOR | DT_WRITE_DEPTH)) {
        needs[DT_LIMIT_TARGET_WIDTH] = larger(needs[DT_LIMIT_TARGET_WIDTH], width);
        needs[DT_LIMIT_TARGET_HEIGHT] = larger(needs[DT_LIMIT_TARGET_HEIGHT], height);
    }
}

static void add_buffer(const struct access *access, uint64_t needs[DT_LIMITS])
{
    const struct resource *buffer = access->resource;
    enum dt_device_limit limit =
        access->kind & DT_READ_UNIFORM ? DT_LIMIT_UNIFORM_BYTES : DT_LIMIT_STORAGE_BYTES;
    uint64_t block = access->kind & DT_READ_UNIFORM ? buffer->block : 0;
    if (access->binding >= 0)
        needs[limit] = larger(needs[limit], block ? block : buffer->bytes);
}

/* What one pass needs of each limit, at the reference size of the frame. */
static void count_limits(const struct lowered *tables, uint32_t index, uint64_t needs[DT_LIMITS])
{
    const struct pass *pass = tables->model->pipeline.order[index];
    for (int i = 0; i < DT_LIMITS; i++)
        needs[i] = dt_demand_of(&tables->panel, index, (enum dt_device_limit)i);
    EACH(access, pass->accesses, pass->access_count) {
        if (!access->resource)
            continue;
        if (access->resource->kind == DT_IMAGE)
            add_image_needs(access, needs);
        else
            add_buffer(access, needs);
    }
    if (pass->layers)
        needs[DT_LIMIT_TARGET_LAYERS] = expr_at_reference(pass->layers, 1);
    const struct step *work = steps_work(&tables->passes[index].steps);
    for (int axis = 0; axis < 3 && work->verb == DT_VERB_DISPATCH; axis++)
        needs[DT_LIMIT_GROUPS_X + axis] =
            (uint64_t)amount_value(&work->arguments[axis], REFERENCE_WIDTH, REFERENCE_HEIGHT, NULL);
    if (pass_draws(pass) && pass->indirect_resource)
        needs[DT_LIMIT_DRAWS] =
            pass->indirect_resource->bytes /
            (pass->kind == DT_PASS_DRAW_VERTICES ? DT_VERTEX_DRAW_BYTES : DT_DRAW_BYTES);
}

/* The passes of a row, comma between them. */
static void add_pass(struct text *passes, const char *name)
{
    text_add(passes, "%s%s", passes->length ? ", " : "", name);
}

/* Appends the profiles of a feature. One that the table does not have is promised by none. */
static void emit_profiles(const char *feature, struct text *out)
{
    size_t k = 0;
    while (k < DT_ARRAY_COUNT(known) && strcmp(feature, known[k].name) != 0)
        k++;
    unsigned profiles = k < DT_ARRAY_COUNT(known) ? known[k].profiles : 0;
    const char *otherwise = strcmp(feature, "shaderOutputLayer") ? "no" : "a draw for each layer";
    for (int profile = 0; profile < PROFILES; profile++)
        text_add(out, " %s |", profiles >> profile & 1 ? "yes" : otherwise);
    text_add(out, "\n");
}

static void emit_features(const struct lowered *tables, struct text *out)
{
    const struct dt_panel *panel = &tables->panel;
    text_add(out, "| Vulkan 1.3 | all |");
    emit_profiles("Vulkan 1.3", out);
    for (uint32_t first = 0; first < panel->need_count; first++) {
        const char *feature = panel->needs[first].feature;
        uint32_t i = 0;
        while (strcmp(panel->needs[i].feature, feature) != 0)
            i++;
        if (i < first)
            continue; /* it has a row */
        struct text passes = {0};
        for (; i < panel->need_count; i++)
            if (!strcmp(panel->needs[i].feature, feature))
                add_pass(&passes, tables->pipeline.passes[panel->needs[i].pass].name);
        text_add(out, "| %s | %s |", feature, passes.data ? passes.data : "");
        emit_profiles(feature, out);
        out->failed |= passes.failed;
        text_free(&passes);
    }
}

static void emit_limit_row(int limit, uint64_t needed, const struct text *passes, struct text *out)
{
    text_add(out, "| %s: %" PRIu64 " | %s |", limits[limit].name, needed, passes->data);
    for (int profile = 0; profile < PROFILES; profile++) {
        uint64_t most = limits[limit].most[profile];
        if (needed > most)
            text_add(out, " %" PRIu64 " |", most);
        else
            text_add(out, " yes |");
    }
    text_add(out, "\n");
}

static void emit_limits(const struct lowered *tables, struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    for (int limit = 0; limit < DT_LIMITS; limit++) {
        struct text passes = {0};
        uint64_t needed = 0, needs[DT_LIMITS];
        for (uint32_t p = 0; p < pipeline->pass_count; p++) {
            count_limits(tables, p, needs);
            if (needs[limit] > limits[limit].most[ANDROID])
                add_pass(&passes, pipeline->order[p]->name);
            needed = larger(needed, needs[limit]);
        }
        if (passes.length)
            emit_limit_row(limit, needed, &passes, out);
        out->failed |= passes.failed;
        text_free(&passes);
    }
}

void emit_device_needs(const struct lowered *tables, struct text *out)
{
    text_add(out, "| need | passes | Roadmap 2022 | Android baseline 2022 | MoltenVK |\n"
                  "|---|---|---|---|---|\n");
    emit_features(tables, out);
    emit_limits(tables, out);
}
