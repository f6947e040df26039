/* From the planned model to tables; see lower.h.
 *
 * The model is the spec's: names, expressions, accesses with their places. Tables are the
 * runtime's: structs of templates/c/panel.h and diptych.h, with indices and numbers. Here the
 * latter are made of the former. Printing C (emit_pipeline.c, emit_panel.c) and playing a spec
 * without C (app/spec/play.c) are loops over them, so they cannot decide differently;
 * tests/app/play_test.c compares both.
 *
 * Little is decided here but the form. What a pass touches, binds and waits for is in the model
 * (plan.c); what it calls is in its steps (steps.c). Only facts of the compiled shaders are added:
 * features and limits that a device must have (`needs`, `demands`), and the vertex attributes that
 * are read.
 *
 * Tables point into the model's arena and the shaders' words and own nothing. When memory is out,
 * `table` gives scratch for one element and sets `failed`, so that only the end of lower() asks. */
#include "lower.h"

#include <spirv/unified1/spirv.h>
#include <string.h>

#include "model/names.h"
#include "plan/plan.h"
#include "spirv/passes.h"

struct lowering {
    const struct pipeline *from;
    struct arena *arena;
    bool failed;
};

/* Zeroed; on failure scratch memory for one element, so that callers can go on. */
static void *table(struct lowering *l, size_t count, size_t size)
{
    static _Alignas(16) char scratch[512];
    void *memory = arena_alloc(l->arena, count * size + 1);
    l->failed |= !memory;
    return memory ? memory : scratch;
}

/* ---- Uses ------------------------------------------------------------------------------------ */

/* An image has one layout in a pass, for all accesses of the pass. */
static uint8_t layout_in_pass(const struct pass *pass, const struct resource *resource)
{
    bool buffer = resource->kind == DT_BUFFER;
    return (uint8_t)(buffer ? DT_LAYOUT_NONE : layout_of(pass_use_of(pass, resource).kinds));
}

static struct dt_barrier barrier_of(const struct pass *pass, const struct barrier *barrier)
{
    const unsigned writes = DT_WRITE_STORAGE | DT_WRITE_COLOR | DT_WRITE_DEPTH | DT_WRITE_CLEAR;
    return (struct dt_barrier){
        .resource = (uint16_t)barrier->resource->index,
        .from_stages = (uint16_t)(barrier->from_stages ? barrier->from_stages : barrier->to_stages),
        .from = (uint16_t)(barrier->from_writes ? barrier->from & writes : 0),
        .to_stages = (uint16_t)barrier->to_stages,
        .to = (uint16_t)barrier->to,
        .layout = layout_in_pass(pass, barrier->resource),
        .discard = barrier->discard && barrier->resource->kind == DT_IMAGE,
    };
}

static void lower_steps(struct lowering *l, struct lowered *out)
{
    out->passes = table(l, l->from->pass_count, sizeof *out->passes);
    for (uint32_t p = 0; p < l->from->pass_count && !l->failed; p++) {
        const struct pass *pass = l->from->order[p];
        struct dt_barrier *barriers = table(l, pass->barrier_count, sizeof *barriers);
        for (uint32_t i = 0; i < pass->barrier_count && !l->failed; i++)
            barriers[i] = barrier_of(pass, &pass->barriers[i]);
        out->passes[p] = (struct lowered_pass){
            .steps = pass_steps(pass, l->arena),
            .runs = {pass_runs(pass, 0), pass_runs(pass, 1), pass_runs(pass, 2)},
            .barriers = barriers};
        l->failed |= !out->passes[p].steps.list;
    }
}

/* ---- Storage, samplers ----------------------------------------------------------------------- */

static bool bound_by_layer(const struct pipeline *pipeline, const struct resource *image)
{
    EACH(pass, pipeline->passes, pipeline->pass_count)
        EACH(access, pass->accesses, pass->access_count)
            if (access->resource == image && access->layer)
                return true;
    return false;
}

static void lower_storage(struct lowering *l, struct dt_panel *panel)
{
    struct dt_storage *storage = table(l, l->from->resource_count, sizeof *storage);
    for (uint32_t i = 0; i < l->from->resource_count && !l->failed; i++) {
        const struct resource *resource = &l->from->resources[i];
        unsigned usage = resource->usage;
        bool image = resource->kind == DT_IMAGE;
        storage[i] = (struct dt_storage){
            .usage = (uint16_t)(usage   ? usage
                                : image ? DT_READ_TEXTURE
                                        : DT_READ_STORAGE),
            .slot = (uint16_t)resource->slot,
            .share = (int16_t)resource->share,
            .block = resource->block,
            .by_layer = bound_by_layer(l->from, resource),
        };
        for (int c = 0; c < 4 && image; c++)
            storage[i].clear[c] = format_round(resource->format, c, resource->clear[c]);
    }
    panel->storage = storage;
    panel->slot_count = l->from->slot_count;
}

static void lower_samplers(struct lowering *l, struct dt_panel *panel)
{
    struct dt_sampler *samplers = table(l, l->from->sampler_count, sizeof *samplers);
    for (uint32_t i = 0; i < l->from->sampler_count && !l->failed; i++) {
        const struct sampler *sampler = &l->from->samplers[i];
        if (sampler->kind == SAMPLER_FILTER)
            samplers[panel->sampler_count++] = (struct dt_sampler){
                .name = sampler->name,
                .linear = sampler->linear,
                .linear_mip = sampler->linear_mip,
                .wrap = sampler->wrap,
                .border = sampler->border,
                .compare = sampler->compare,
                .anisotropy = (float)sampler->anisotropy,
            };
    }
    panel->samplers = samplers;
}

static int16_t sampler_index(const struct pipeline *pipeline, const struct sampler *sampler)
{
    int16_t index = 0;
    if (!sampler)
        return -1;
    for (const struct sampler *at = pipeline->samplers; at != sampler; at++)
        index = (int16_t)(index + (at->kind == SAMPLER_FILTER));
    return index;
}

/* ---- Programs -------------------------------------------------------------------------------- */

static bool binds_image(const struct access *access)
{
    return access->resource ? access->resource->kind == DT_IMAGE
                            : access->builtin == DT_SCENE_TEXTURES;
}

static uint16_t object_of(const struct access *access)
{
    return access->resource ? (uint16_t)access->resource->index : access->builtin;
}

static struct dt_binding binding_of(const struct pipeline *pipeline, const struct pass *pass,
                                    const struct access *access)
{
    bool texture = access->kind & DT_READ_TEXTURE;
    struct dt_binding binding = {
        .binding = (uint16_t)access->binding,
        .resource = object_of(access),
        .kind = !binds_image(access) ? access->kind & DT_READ_UNIFORM ? DT_BIND_UNIFORM
                                       : texture                      ? DT_BIND_TEXELS
                                                                      : DT_BIND_STORAGE
                : texture            ? DT_BIND_TEXTURE
                                     : DT_BIND_IMAGE,
    };
    if (!binds_image(access))
        return binding;
    bool all_mips = texture && !access->layer && !access_sees_one_mip(access);
    binding.mip = all_mips ? DT_ALL_MIPS : (uint8_t)access->mip_value;
    binding.one_layer = access->layer;
    binding.layer = (uint16_t)access->layer_value;
    binding.layout = access->resource ? layout_in_pass(pass, access->resource) : DT_LAYOUT_READ;
    binding.codes = access->codes;
    if (texture)
        binding.sampler = sampler_index(pipeline, access->filter);
    else
        binding.access = (uint16_t)access->kind;
    return binding;
}

static struct dt_binding block_of(int binding, enum dt_builtin block, bool uniform)
{
    return (struct dt_binding){.binding = (uint16_t)binding,
                               .resource = (uint16_t)block,
                               .kind = uniform ? DT_BIND_UNIFORM : DT_BIND_STORAGE};
}

/* A scene draw always binds materials and textures, so accesses to them are skipped. */
static void lower_bindings(struct lowering *l, const struct pass *pass, struct dt_program *program)
{
    struct dt_binding *bindings = table(l, pass->access_count + 4, sizeof *bindings);
    uint32_t count = 0;
    for (uint32_t i = 0; i < pass->access_count && !l->failed; i++) {
        const struct access *access = &pass->accesses[i];
        if (access->binding >= 0 && access->binding != pass->materials_binding &&
            access->binding != pass->textures_binding)
            bindings[count++] = binding_of(l->from, pass, access);
    }
    if (!l->failed) {
        bindings[count++] = block_of(pass->frame_binding, DT_FRAME, true);
        bindings[count++] = block_of(pass->live_binding, DT_LIVE, true);
    }
    if (pass->kind == DT_PASS_DRAW_SCENE && !l->failed) {
        bindings[count++] =
            block_of(pass->materials_binding, DT_SCENE_MATERIALS, pass->uniform_materials);
        bindings[count++] = (struct dt_binding){.binding = (uint16_t)pass->textures_binding,
                                                .resource = DT_SCENE_TEXTURES,
                                                .kind = DT_BIND_TEXTURE,
                                                .mip = DT_ALL_MIPS,
                                                .layout = DT_LAYOUT_READ,
                                                .codes = pass->codes,
                                                .sampler = -1};
    }
    program->bindings = bindings;
    program->binding_count = count;
}

static void lower_targets(struct lowering *l, const struct pass *pass, struct dt_program *program)
{
    struct dt_target *colors = table(l, pass->access_count, sizeof *colors);
    for (uint32_t i = 0; i < pass->access_count && !l->failed; i++) {
        const struct access *access = &pass->accesses[i];
        struct dt_target *depth = access->kind & DT_WRITE_DEPTH ? table(l, 1, sizeof *depth) : NULL;
        struct dt_target *target =
            access->kind & DT_WRITE_COLOR ? &colors[access->attachment] : depth;
        if (!target)
            continue;
        *target = (struct dt_target){.resource = (uint16_t)access->resource->index,
                                     .mip = (uint8_t)access->mip_value,
                                     .load = access->mode == MODE_UPDATE,
                                     .one_layer = access->layer,
                                     .layer = (uint16_t)access->layer_value};
        if (!depth) {
            target->blend = access->blend;
            target->keep = access->keep;
        }
        program->color_count += access->kind & DT_WRITE_COLOR ? 1 : 0;
        program->depth = depth ? depth : program->depth;
    }
    program->colors = colors;
}

/* Bits of the locations of a vertex shader's inputs. */
static uint8_t input_locations(const struct shader *vertex)
{
    const uint32_t *words = vertex->words;
    uint8_t locations = 0;
    for (size_t at = SPIRV_HEADER; at < vertex->word_count; at += words[at] >> 16) {
        if (!spirv_is(words + at, SpvOpDecorate) || words[at + 2] != SpvDecorationLocation)
            continue;
        for (size_t i = at; i < vertex->word_count; i += words[i] >> 16)
            if (spirv_is(words + i, SpvOpVariable) && words[i + 2] == words[at + 1] &&
                words[i + 3] == SpvStorageClassInput)
                locations |= (uint8_t)(1u << words[at + 3]);
    }
    return locations;
}

static void lower_program(struct lowering *l, const struct pass *pass, const struct shader *vertex,
                          struct dt_program *program)
{
    *program = (struct dt_program){0};
    lower_bindings(l, pass, program);
    if (!pass_draws(pass))
        return;
    lower_targets(l, pass, program);
    program->cull = pass->cull;
    program->layered = pass->layers != NULL;
    program->clip_distances = pass->clip_distances;
    program->attributes = input_locations(vertex);
    program->topology = pass->topology;
    program->bias_constant = (float)pass->bias_constant;
    program->bias_slope = (float)pass->bias_slope;
    if (program->depth && pass->depth_test) {
        program->depth_test = true;
        program->depth_write = pass->depth_write;
        program->compare = pass->depth_compare;
    }
}

static void lower_programs(struct lowering *l, const struct pass_shaders *shaders,
                           struct dt_panel *panel)
{
    struct dt_program *programs = table(l, l->from->pass_count, sizeof *programs);
    for (uint32_t i = 0; i < l->from->pass_count && !l->failed; i++)
        lower_program(l, l->from->order[i], &shaders[i].stage[STAGE_IS_VERTEX], &programs[i]);
    panel->programs = programs;
}

/* ---- Features of a device -------------------------------------------------------------------- */

/* Vulkan 1.3, appendix "Vulkan Environment for SPIR-V": the capabilities that need a feature, if
 * GLSL 4.60 with the generator's extensions can lead to them. */
static const struct {
    SpvCapability capability;
    const char *feature;
} capabilities[] = {
    {SpvCapabilityGeometry, "geometryShader"}, /* gl_PrimitiveID in a fragment shader */
    {SpvCapabilityFloat64, "shaderFloat64"},
    {SpvCapabilityFloat16, "shaderFloat16"},
    {SpvCapabilityInt64, "shaderInt64"},
    {SpvCapabilityInt64Atomics, "shaderBufferInt64Atomics"},
    {SpvCapabilityInt16, "shaderInt16"},
    {SpvCapabilityInt8, "shaderInt8"},
    {SpvCapabilityStorageBuffer16BitAccess, "storageBuffer16BitAccess"},
    {SpvCapabilityUniformAndStorageBuffer16BitAccess, "uniformAndStorageBuffer16BitAccess"},
    {SpvCapabilityStoragePushConstant16, "storagePushConstant16"},
    {SpvCapabilityStorageInputOutput16, "storageInputOutput16"},
    {SpvCapabilityStorageBuffer8BitAccess, "storageBuffer8BitAccess"},
    {SpvCapabilityUniformAndStorageBuffer8BitAccess, "uniformAndStorageBuffer8BitAccess"},
    {SpvCapabilityStoragePushConstant8, "storagePushConstant8"},
    {SpvCapabilitySampledCubeArray, "imageCubeArray"},
    {SpvCapabilityImageCubeArray, "imageCubeArray"},
    {SpvCapabilityImageGatherExtended, "shaderImageGatherExtended"},
    {SpvCapabilityStorageImageExtendedFormats, "shaderStorageImageExtendedFormats"},
    {SpvCapabilityClipDistance, "shaderClipDistance"},
    {SpvCapabilityCullDistance, "shaderCullDistance"},
    {SpvCapabilitySampleRateShading, "sampleRateShading"},
    {SpvCapabilityDrawParameters, "shaderDrawParameters"},
    {SpvCapabilityShaderLayer, "shaderOutputLayer"},
    /* not features, but VkSubgroupFeatureFlagBits */
    {SpvCapabilityGroupNonUniform, "VK_SUBGROUP_FEATURE_BASIC_BIT"},
    {SpvCapabilityGroupNonUniformVote, "VK_SUBGROUP_FEATURE_VOTE_BIT"},
    {SpvCapabilityGroupNonUniformArithmetic, "VK_SUBGROUP_FEATURE_ARITHMETIC_BIT"},
    {SpvCapabilityGroupNonUniformBallot, "VK_SUBGROUP_FEATURE_BALLOT_BIT"},
    {SpvCapabilityGroupNonUniformShuffle, "VK_SUBGROUP_FEATURE_SHUFFLE_BIT"},
    {SpvCapabilityGroupNonUniformShuffleRelative, "VK_SUBGROUP_FEATURE_SHUFFLE_RELATIVE_BIT"},
    {SpvCapabilityGroupNonUniformClustered, "VK_SUBGROUP_FEATURE_CLUSTERED_BIT"},
    {SpvCapabilityGroupNonUniformQuad, "VK_SUBGROUP_FEATURE_QUAD_BIT"},
};

static bool has_capability(const struct pass_shaders *shaders, SpvCapability capability)
{
    const uint32_t declaration = 2u << 16 | SpvOpCapability; /* first in a module */
    for (size_t stage = 0; stage < DT_ARRAY_COUNT(shaders->stage); stage++) {
        const struct shader *shader = &shaders->stage[stage];
        for (size_t at = SPIRV_HEADER;
             at + 1 < shader->word_count && shader->words[at] == declaration; at += 2)
            if (shader->words[at + 1] == (uint32_t)capability)
                return true;
    }
    return false;
}

static bool filters_anisotropic(const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->filter && access->filter->anisotropy > 1)
            return true;
    return false;
}

static bool stores(const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->kind & DT_WRITE_STORAGE)
            return true;
    return false;
}

/* Whether colour targets of the pass differ in blending or in masks. */
static bool blends_apart(const struct pass *pass)
{
    const struct access *first = NULL;
    bool apart = false;
    EACH(access, pass->accesses, pass->access_count) {
        if (!(access->kind & DT_WRITE_COLOR))
            continue;
        if (!first)
            first = access;
        apart |= access->keep != first->keep || !access->blend != !first->blend ||
                 (first->blend && memcmp(access->blend, first->blend, sizeof *first->blend) != 0);
    }
    return apart;
}

/* Whether all its stages write the buffer of --sanitize. */
static bool reports(const struct pass *pass)
{
    const struct access *last = pass->access_count ? &pass->accesses[pass->access_count - 1] : NULL;
    return last && last->resource && last->resource->internal;
}

static void lower_needs(struct lowering *l, const struct pass_shaders *shaders,
                        struct dt_panel *panel)
{
    const size_t most = DT_ARRAY_COUNT(capabilities) + 8;
    struct dt_need *needs = table(l, l->from->pass_count * most, sizeof *needs);
    for (uint32_t p = 0; p < l->from->pass_count && !l->failed; p++) {
        const struct pass *pass = l->from->order[p];
        bool scene = pass->kind == DT_PASS_DRAW_SCENE;
        bool indirect = pass_draws(pass) && pass->indirect_resource;
        const struct {
            const char *feature;
            bool needed;
        } others[] = {
            {"samplerAnisotropy", filters_anisotropic(pass)},
            {"fragmentStoresAndAtomics", pass_draws(pass) && stores(pass)},
            {"vertexPipelineStoresAndAtomics", pass_draws(pass) && reports(pass)},
            {"independentBlend", blends_apart(pass)},
            {"fullDrawIndexUint32", scene},
            {"largePoints", pass->topology == DT_POINTS},
            {"multiDrawIndirect", indirect},
            {"drawIndirectFirstInstance", indirect},
        };
        for (size_t i = 0; i < DT_ARRAY_COUNT(capabilities); i++)
            if (has_capability(&shaders[p], capabilities[i].capability))
                needs[panel->need_count++] = (struct dt_need){p, capabilities[i].feature};
        for (size_t i = 0; i < DT_ARRAY_COUNT(others); i++)
            if (others[i].needed)
                needs[panel->need_count++] = (struct dt_need){p, others[i].feature};
    }
    panel->needs = needs;
}

static void lower_demands(struct lowering *l, const struct pass_shaders *shaders,
                          struct dt_panel *panel)
{
    struct dt_demand *demands = table(l, (size_t)l->from->pass_count * DT_LIMITS, sizeof *demands);
    uint64_t amounts[DT_LIMITS];
    for (uint32_t p = 0; p < l->from->pass_count && !l->failed; p++) {
        l->failed |= !find_demands(l->from->order[p], &shaders[p], amounts);
        for (int i = 0; i < DT_LIMITS && !l->failed; i++)
            if (amounts[i])
                demands[panel->demand_count++] =
                    (struct dt_demand){p, (enum dt_device_limit)i, amounts[i]};
    }
    panel->demands = demands;
}

/* ---- Code ------------------------------------------------------------------------------------ */

static struct dt_code code_of(const struct shader *shader, enum backend backend)
{
    return (struct dt_code){
        .words = shader->words,
        .size = shader->word_count * sizeof *shader->words,
        .glsl = backend == BACKEND_GL && shader->word_count ? shader->glsl.data : NULL,
    };
}

static void lower_shaders(struct lowering *l, const struct pass_shaders *from, enum backend backend,
                          struct lowered *out)
{
    struct dt_stages *stages = table(l, l->from->pass_count, sizeof *stages);
    for (uint32_t i = 0; i < l->from->pass_count && !l->failed; i++)
        stages[i] = (struct dt_stages){code_of(&from[i].stage[STAGE_IS_COMPUTE], backend),
                                       code_of(&from[i].stage[STAGE_IS_VERTEX], backend),
                                       code_of(&from[i].stage[STAGE_IS_FRAGMENT], backend)};
    out->shaders[backend] = (struct dt_shaders){
        .backend = backend == BACKEND_GL ? "gl" : "vk", .panel = &out->panel, .stages = stages};
}

/* ---- Reflection ------------------------------------------------------------------------------ */

static void lower_params(struct lowering *l, struct dt_pipeline *pipeline)
{
    struct dt_param *params = table(l, l->from->param_count, sizeof *params);
    for (uint32_t i = 0; i < l->from->param_count && !l->failed; i++) {
        const struct param *param = &l->from->params[i];
        params[i] = (struct dt_param){.name = param->name,
                                      .doc = param->doc ? param->doc : "",
                                      .type = param->type,
                                      .live = param->live,
                                      .offset = param->live ? param->offset : 0,
                                      .min = param->min,
                                      .max = param->max,
                                      .step = param->step > 0 ? param->step : 0};
        memcpy(params[i].value, param->value, param->components * sizeof *param->value);
    }
    pipeline->params = params;
    pipeline->param_count = l->from->param_count;
}

static uint32_t scalar_bits(enum dt_type type, double value)
{
    float number = (float)value;
    uint32_t bits;
    if (type > DT_TYPE_VEC4)
        return value < 0 ? (uint32_t)(int32_t)value : (uint32_t)value;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static void lower_block(struct lowering *l, struct dt_pipeline *pipeline)
{
    char *block = table(l, l->from->block_size, 1);
    for (uint32_t i = 0; i < l->from->param_count && !l->failed; i++) {
        const struct param *param = &l->from->params[i];
        for (uint32_t c = 0; c < param->components && (param->live || param->uniform); c++) {
            uint32_t bits = scalar_bits(param->type, param->value[c]);
            memcpy(block + param->offset + 4 * c, &bits, sizeof bits);
        }
    }
    pipeline->live_defaults = block;
    pipeline->live_size = l->from->live_size;
    pipeline->block_size = l->from->block_size;
}

static void lower_fields(struct lowering *l, const struct resource *from, struct dt_resource *to)
{
    const struct structure *structure = from->structure;
    uint32_t count = structure ? structure->field_count : 1;
    struct dt_field *fields = table(l, count, sizeof *fields);
    if (l->failed)
        return;
    if (!structure)
        fields[0] = (struct dt_field){.name = "", .type = from->type};
    for (uint32_t i = 0; structure && i < count; i++) {
        const struct field *field = &structure->fields[i];
        fields[i] = (struct dt_field){field->name, field->type, field->offset, field->array_count,
                                      field->array_stride};
    }
    to->fields = fields;
    to->field_count = count;
    to->stride = from->stride;
    to->controls_work = from->usage & (DT_READ_INDIRECT | DT_READ_INDEX);
}

static void lower_resources(struct lowering *l, struct dt_pipeline *pipeline)
{
    struct dt_resource *resources = table(l, l->from->resource_count, sizeof *resources);
    for (uint32_t i = 0; i < l->from->resource_count && !l->failed; i++) {
        const struct resource *from = &l->from->resources[i];
        resources[i] = (struct dt_resource){.name = from->name,
                                            .doc = from->doc ? from->doc : "",
                                            .kind = from->kind,
                                            .history = from->history,
                                            .keep = from->keep,
                                            .input = from->input,
                                            .file = from->file,
                                            .contract = from->contract.allowed};
        if (from->contract.allowed.kind != DT_CONTRACT_FLIPS)
            resources[i].contract.margin_field = 0;
        if (from->kind == DT_BUFFER) {
            lower_fields(l, from, &resources[i]);
            continue;
        }
        resources[i].format = from->format;
        resources[i].shape = from->shape;
        resources[i].layered = from->layers;
        resources[i].top = l->from->top;
        resources[i].mips = expr_at_reference(from->mips, 1);
    }
    pipeline->resources = resources;
    pipeline->resource_count = l->from->resource_count;
}

static void lower_uses(struct lowering *l, const struct pass *from, struct dt_pass *to)
{
    uint32_t count = l->from->resource_count;
    uint16_t *read = table(l, count, sizeof *read), *written = table(l, count, sizeof *written);
    uint16_t *mips = table(l, count, sizeof *mips);
    bool any_mip = false;
    for (uint16_t i = 0; i < count && !l->failed; i++) {
        if (l->from->resources[i].internal)
            continue;
        struct pass_use use = pass_use_of(from, &l->from->resources[i]);
        uint16_t write = (uint16_t)use.changed_mips;
        if (use.reads)
            read[to->read_count++] = i;
        if (!write)
            continue;
        any_mip |= write != 1;
        mips[to->write_count] = write;
        written[to->write_count++] = i;
    }
    to->reads = read;
    to->writes = written;
    to->write_mips = any_mip ? mips : NULL;
}

static bool uses_scene(const struct pass *pass)
{
    bool uses = pass->kind == DT_PASS_DRAW_SCENE;
    EACH(access, pass->accesses, pass->access_count)
        uses |= access->builtin;
    return uses;
}

static void lower_passes(struct lowering *l, struct dt_pipeline *pipeline)
{
    struct dt_pass *passes = table(l, l->from->pass_count, sizeof *passes);
    for (uint32_t i = 0; i < l->from->pass_count && !l->failed; i++) {
        const struct pass *from = l->from->order[i];
        passes[i] = (struct dt_pass){.name = from->name,
                                     .doc = from->doc ? from->doc : "",
                                     .shader = from->shader,
                                     .kind = from->kind,
                                     .uses_scene = uses_scene(from)};
        lower_uses(l, from, &passes[i]);
    }
    pipeline->passes = passes;
    pipeline->pass_count = l->from->pass_count;
}

static int output_index(const struct pipeline *pipeline, const char *name)
{
    const struct resource *image = name ? declared_find(pipeline, DECLARED_RESOURCE, name) : NULL;
    return image ? (int)image->index : -1;
}

struct lowered *lower(const struct model *model, struct pass_shaders *const shaders[2])
{
    const struct pipeline *from = &model->pipeline;
    struct lowering l = {.from = from, .arena = model->arena};
    struct lowered *out = arena_alloc(model->arena, sizeof *out);
    if (!out)
        return NULL;
    *out = (struct lowered){.model = model};
    out->pipeline = (struct dt_pipeline){
        .name = from->name,
        .doc = from->doc ? from->doc : "",
        .linear_output = output_index(from, from->linear_output),
        .display_output = output_index(from, from->display_output),
    };
    lower_params(&l, &out->pipeline);
    lower_block(&l, &out->pipeline);
    lower_resources(&l, &out->pipeline);
    lower_passes(&l, &out->pipeline);
    out->panel.version = DT_VERSION;
    out->panel.pipeline = &out->pipeline;
    lower_storage(&l, &out->panel);
    lower_samplers(&l, &out->panel);
    lower_programs(&l, shaders[BACKEND_VK], &out->panel);
    lower_needs(&l, shaders[BACKEND_VK], &out->panel);
    lower_demands(&l, shaders[BACKEND_VK], &out->panel);
    lower_steps(&l, out);
    for (enum backend backend = BACKEND_GL; backend <= BACKEND_VK; backend++)
        lower_shaders(&l, shaders[backend], backend, out);
    return l.failed ? NULL : out;
}
