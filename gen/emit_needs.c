/* What passes need of a Vulkan device beyond what every pipeline does, for NAME_vk.c: told by the
 * capabilities of their SPIR-V and by how they draw. Called by emit_vk.c; the runtime knows the features
 * by their names (runtime_vk/device.c), which are Vulkan's. */
#include <spirv/unified1/spirv.h>

#include "emit_c.h"

/* Vulkan 1.3, appendix "Vulkan Environment for SPIR-V": the capabilities that come with a feature, of
 * those that GLSL 4.60 without extensions leads to. */
static const struct {
    SpvCapability capability;
    const char *feature;
} capabilities[] = {
    {SpvCapabilityGeometry, "geometryShader"}, /* gl_PrimitiveID in a fragment shader */
    {SpvCapabilityFloat64, "shaderFloat64"},
    {SpvCapabilityImageGatherExtended, "shaderImageGatherExtended"},
    {SpvCapabilityStorageImageExtendedFormats, "shaderStorageImageExtendedFormats"},
    {SpvCapabilityClipDistance, "shaderClipDistance"},
    {SpvCapabilityCullDistance, "shaderCullDistance"},
    {SpvCapabilitySampleRateShading, "sampleRateShading"},
    {SpvCapabilityDrawParameters, "shaderDrawParameters"},
    {SpvCapabilityShaderLayer, "shaderOutputLayer"},
};

static bool has_capability(const struct shader *shader, SpvCapability capability)
{
    const uint32_t declaration = 2u << 16 | SpvOpCapability; /* they stand first */

    for (size_t at = 5; at + 1 < shader->word_count && shader->words[at] == declaration; at += 2) {
        if (shader->words[at + 1] == (uint32_t)capability) {
            return true;
        }
    }
    return false;
}

static bool any_has_capability(const struct pass_shaders *shaders, SpvCapability capability)
{
    return has_capability(&shaders->stage[STAGE_IS_COMPUTE], capability) ||
           has_capability(&shaders->stage[STAGE_IS_VERTEX], capability) ||
           has_capability(&shaders->stage[STAGE_IS_FRAGMENT], capability);
}

static bool filters_anisotropic(const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].filter && pass->accesses[i].filter->anisotropy > 1) {
            return true;
        }
    }
    return false;
}

static bool stores(const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].kind & ACCESS_STORAGE_WRITE) {
            return true;
        }
    }
    return false;
}

static void emit_need(const struct c_output *c, const struct pass *pass, const char *feature)
{
    text_add(c->out, "    {");
    c_enumerator(c, "PASS", pass->name);
    text_add(c->out, ", \"%s\"},\n", feature);
}

static void emit_pass_needs(const struct c_output *c, const struct pass *pass)
{
    bool draws_scene = pass->kind == PASS_SCENE;

    for (size_t i = 0; i < DT_ARRAY_COUNT(capabilities); i++) {
        if (any_has_capability(&c->shaders[pass->index], capabilities[i].capability)) {
            emit_need(c, pass, capabilities[i].feature);
        }
    }
    if (filters_anisotropic(pass)) {
        emit_need(c, pass, "samplerAnisotropy");
    }
    if (pass_draws(pass) && stores(pass)) {
        emit_need(c, pass, "fragmentStoresAndAtomics");
    }
    if (draws_scene) {
        emit_need(c, pass, "fullDrawIndexUint32");
    }
    if (draws_scene && pass->indirect_resource) {
        emit_need(c, pass, "multiDrawIndirect");
        emit_need(c, pass, "drawIndirectFirstInstance");
    }
}

static void emit_all(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        emit_pass_needs(c, c->pipeline->order[i]);
    }
}

static bool needs_nothing(const struct c_output *c)
{
    struct text lines = {0};
    struct c_output unheard = *c;

    unheard.out = &lines;
    emit_all(&unheard);
    bool nothing = !lines.length;
    text_free(&lines);
    return nothing;
}

void c_slot_needs(const struct c_output *c)
{
    if (!needs_nothing(c)) {
        text_add(c->out, "static const struct dt_need needs[] = {\n");
        emit_all(c);
        text_add(c->out, "};\n\n");
    }
}

void c_slot_panel_needs(const struct c_output *c)
{
    text_add(c->out, needs_nothing(c) ? ""
                                      : "    .needs = needs,\n"
                                        "    .need_count = DT_ARRAY_COUNT(needs),\n");
}
