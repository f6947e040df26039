/* --needs: what the passes need of a Vulkan device, against what profiles promise. Called by
 * main.c. */
#include "lower.h"

#include <string.h>

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
enum limit { BLOCK_BYTES, TARGETS, GROUP, UNIFORMS, STORAGES, TEXTURES, IMAGES, LIMITS };
static const struct {
    const char *name;
    uint32_t most[PROFILES];
} limits[LIMITS] = {
    [BLOCK_BYTES] = {"maxUniformBufferRange", {65536, 16384, 65536}},
    [TARGETS] = {"maxColorAttachments", {7, 4, 8}},
    [GROUP] = {"maxComputeWorkGroupInvocations", {256, 128, 1024}},
    [UNIFORMS] = {"maxPerStageDescriptorUniformBuffers", {15, 12, 31}},
    [STORAGES] = {"maxPerStageDescriptorStorageBuffers", {30, 4, 31}},
    [TEXTURES] = {"maxPerStageDescriptorSampledImages", {200, 16, 128}},
    [IMAGES] = {"maxPerStageDescriptorStorageImages", {16, 4, 128}},
};

static uint32_t block_bytes(const struct pass *pass)
{
    const uint64_t materials = DT_MAX_MATERIALS * sizeof(struct dt_material);
    uint64_t most = pass->uniform_materials ? materials : 0;
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct resource *resource = pass->accesses[i].resource;
        if (!(pass->accesses[i].kind & ACCESS_UNIFORM))
            continue;
        uint64_t bytes = !resource         ? materials
                         : resource->block ? resource->block
                                           : resource->bytes;
        most = bytes > most ? bytes : most;
    }
    return most > UINT32_MAX ? UINT32_MAX : (uint32_t)most;
}

/* What one pass needs of each limit. */
static void count_limits(const struct pass *pass, const struct dt_program *program,
                         uint32_t needs[LIMITS])
{
    static const enum limit kinds[] = {[DT_BIND_UNIFORM] = UNIFORMS,
                                       [DT_BIND_STORAGE] = STORAGES,
                                       [DT_BIND_TEXELS] = TEXTURES,
                                       [DT_BIND_TEXTURE] = TEXTURES,
                                       [DT_BIND_IMAGE] = IMAGES};
    memset(needs, 0, LIMITS * sizeof *needs);
    needs[BLOCK_BYTES] = block_bytes(pass);
    needs[TARGETS] = program->color_count;
    if (!pass_draws(pass))
        needs[GROUP] = pass->local[0] * pass->local[1] * pass->local[2];
    for (uint32_t i = 0; i < program->binding_count; i++)
        needs[kinds[program->bindings[i].kind]]++;
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

static void emit_limits(const struct lowered *tables, struct text *out)
{
    const struct pipeline *pipeline = &tables->model->pipeline;
    for (int limit = 0; limit < LIMITS; limit++) {
        const uint32_t *most = limits[limit].most;
        struct text passes = {0};
        uint32_t needed = 0, needs[LIMITS];
        for (uint32_t p = 0; p < pipeline->pass_count; p++) {
            count_limits(pipeline->order[p], &tables->panel.programs[p], needs);
            if (needs[limit] > most[ANDROID])
                add_pass(&passes, pipeline->order[p]->name);
            needed = needs[limit] > needed ? needs[limit] : needed;
        }
        if (passes.length) {
            text_add(out, "| %s: %u | %s |", limits[limit].name, needed, passes.data);
            for (int profile = 0; profile < PROFILES; profile++)
                text_add(out, needed > most[profile] ? " %u |" : " yes |", most[profile]);
            text_add(out, "\n");
        }
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
