/* One program: shader modules, descriptor set and its layout, compute or graphics pipeline. panel.c
 * creates one for every pass. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* Numbers of the SPIR-V specification; its header is not there for every compiler. */
enum {
    SPIRV_CAPABILITY = 17,
    SPIRV_TYPE_POINTER = 32,
    SPIRV_VARIABLE = 59,
    SPIRV_DECORATE = 71,
    SPIRV_SHADER_LAYER = 69, /* capability */
    SPIRV_BUILTIN = 11,      /* decoration */
    SPIRV_LAYER = 9,         /* built-in */
    SPIRV_PRIVATE = 6        /* storage class */
};

/* ---- Descriptors ----------------------------------------------------------------------------- */

static const VkDescriptorType descriptor_types[] = {
    [DT_BIND_UNIFORM] = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
    [DT_BIND_STORAGE] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
    [DT_BIND_TEXELS] = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
    [DT_BIND_TEXTURE] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
    [DT_BIND_IMAGE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
};
enum { KINDS = DT_ARRAY_COUNT(descriptor_types) };

static bool create_layouts(struct dt_vk_runtime *rt, struct vk_program *program,
                           const struct vk_program_info *info)
{
    const struct dt_program *state = info->state;
    VkDescriptorSetLayoutBinding lines[DT_MAX_BINDINGS];
    const VkShaderStageFlags draws = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    for (uint32_t i = 0; i < state->binding_count; i++)
        lines[i] = (VkDescriptorSetLayoutBinding){
            .binding = state->bindings[i].binding,
            .descriptorType = descriptor_types[state->bindings[i].kind],
            .descriptorCount = 1,
            .stageFlags = info->stages->compute.size ? VK_SHADER_STAGE_COMPUTE_BIT : draws,
        };
    VkDescriptorSetLayoutCreateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = state->binding_count,
        .pBindings = lines,
    };
    if (!VK(rt,
            rt->vk.CreateDescriptorSetLayout(rt->device, &set, rt->callbacks, &program->set_layout),
            info->name))
        return false;
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &program->set_layout,
        .pushConstantRangeCount = state->layered,
        .pPushConstantRanges = &vk_layer_range,
    };
    return VK(rt, rt->vk.CreatePipelineLayout(rt->device, &layout, rt->callbacks, &program->layout),
              info->name);
}

/* The set has its own pool; without bindings there is no set. */
static bool create_set(struct dt_vk_runtime *rt, struct vk_program *program,
                       const struct vk_program_info *info)
{
    uint32_t counts[KINDS] = {0}, size_count = 0;
    VkDescriptorPoolSize sizes[KINDS];
    for (uint32_t i = 0; i < info->state->binding_count; i++)
        counts[info->state->bindings[i].kind]++;
    for (uint32_t kind = 0; kind < KINDS; kind++)
        if (counts[kind])
            sizes[size_count++] = (VkDescriptorPoolSize){descriptor_types[kind], counts[kind]};
    if (!size_count)
        return true;
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = size_count,
        .pPoolSizes = sizes,
    };
    if (!VK(rt, rt->vk.CreateDescriptorPool(rt->device, &pool, rt->callbacks, &program->pool),
            info->name))
        return false;
    VkDescriptorSetAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = program->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &program->set_layout,
    };
    return VK(rt, rt->vk.AllocateDescriptorSets(rt->device, &allocate, &program->set), info->name);
}

static VkDescriptorBufferInfo buffer_descriptor(struct dt_vk_runtime *rt,
                                                const struct dt_binding *binding)
{
    const struct vk_buffer *buffer = vk_buffer_at(rt, binding->resource);
    bool block = binding->kind == DT_BIND_UNIFORM && buffer->block;
    return (VkDescriptorBufferInfo){buffer->handle, buffer->offset,
                                    block ? buffer->block : buffer->size};
}

static struct vk_image *image_of(struct dt_vk_runtime *rt, const struct dt_binding *binding)
{
    return binding->resource == DT_SCENE_TEXTURES ? &rt->builtin.textures
                                                  : &vk_resource_at(rt, binding->resource)->image;
}

static VkDescriptorImageInfo image_descriptor(struct dt_vk_runtime *rt,
                                              const struct dt_binding *binding)
{
    bool scene = binding->resource == DT_SCENE_TEXTURES;
    const struct vk_image *image = image_of(rt, binding);
    bool cube = vk_is_cube(image->shape) && !binding->one_layer &&
                (binding->kind == DT_BIND_IMAGE || binding->sampler >= 0);
    VkDescriptorImageInfo info = {
        .imageView = binding->codes                ? image->codes
                     : binding->mip == DT_ALL_MIPS ? image->view
                     : cube
                         ? image->cube_views[binding->mip]
                         : vk_image_view(image, binding->mip, binding->one_layer, binding->layer),
        .imageLayout = vk_layout(binding->layout),
    };
    if (scene)
        info.sampler = rt->builtin.texture_sampler;
    else if (binding->kind == DT_BIND_TEXTURE)
        info.sampler = binding->sampler < 0
                           ? rt->builtin.texel_sampler
                           : *(VkSampler *)dt_sampler(&rt->core, (uint32_t)binding->sampler);
    return info;
}

/* What a binding has: a buffer, or an image with or without sampler. */
static bool fill_write(struct dt_vk_runtime *rt, const struct dt_binding *binding,
                       VkWriteDescriptorSet *write, VkDescriptorBufferInfo *range,
                       VkDescriptorImageInfo *image)
{
    if (binding->kind == DT_BIND_TEXELS) {
        struct vk_buffer *buffer = vk_buffer_at(rt, binding->resource);
        write->pTexelBufferView = &buffer->texels;
        return vk_buffer_texels(rt, buffer, binding->resource);
    }
    if (binding->kind == DT_BIND_UNIFORM || binding->kind == DT_BIND_STORAGE) {
        *range = buffer_descriptor(rt, binding);
        write->pBufferInfo = range;
        return true;
    }
    if (binding->codes && !vk_image_codes(rt, image_of(rt, binding)))
        return false;
    *image = image_descriptor(rt, binding);
    write->pImageInfo = image;
    return true;
}

bool vk_program_connect(struct dt_core *core, void *made, uint32_t pass)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    const struct vk_program *program = made;
    const struct dt_program *state = &core->panel->programs[pass];
    VkWriteDescriptorSet writes[DT_MAX_BINDINGS];
    VkDescriptorBufferInfo ranges[DT_MAX_BINDINGS];
    VkDescriptorImageInfo images[DT_MAX_BINDINGS];
    for (uint32_t i = 0; i < state->binding_count; i++) {
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = program->set,
            .dstBinding = state->bindings[i].binding,
            .descriptorCount = 1,
            .descriptorType = descriptor_types[state->bindings[i].kind],
        };
        if (!fill_write(rt, &state->bindings[i], &writes[i], &ranges[i], &images[i]))
            return false;
    }
    rt->vk.UpdateDescriptorSets(rt->device, state->binding_count, writes, 0, NULL);
    return true;
}

/* ---- Pipelines ------------------------------------------------------------------------------- */

const VkPushConstantRange vk_layer_range = {VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(int32_t)};

/* The type that a pointer type points to. */
static uint32_t pointed_type(const uint32_t *words, size_t count, uint32_t pointer)
{
    size_t at = 5;
    while (at < count && !((words[at] & 0xffff) == SPIRV_TYPE_POINTER && words[at + 1] == pointer))
        at += words[at] >> 16;
    return at < count ? words[at + 3] : 0;
}

/* The module for a device without shaderOutputLayer: gl_Layer becomes a private variable. free();
 * NULL: out of memory. */
static uint32_t *without_layer(const uint32_t *words, size_t *size)
{
    size_t count = *size / sizeof *words, length = 5;
    uint32_t layer = 0, *out = malloc(*size + 4 * sizeof *out);
    if (!out)
        return NULL;
    memcpy(out, words, length * sizeof *out);
    for (size_t at = 5, next; at < count; at = next) {
        uint32_t opcode = words[at] & 0xffff;
        next = at + (words[at] >> 16);
        if (opcode == SPIRV_CAPABILITY && words[at + 1] == SPIRV_SHADER_LAYER)
            continue;
        if (opcode == SPIRV_DECORATE && words[at + 2] == SPIRV_BUILTIN &&
            words[at + 3] == SPIRV_LAYER) {
            layer = words[at + 1];
            continue;
        }
        memcpy(out + length, words + at, (next - at) * sizeof *out);
        if (opcode == SPIRV_VARIABLE && words[at + 2] == layer) {
            const uint32_t type = out[3]++;
            const uint32_t private[] = {4u << 16 | SPIRV_TYPE_POINTER,
                                        type,
                                        SPIRV_PRIVATE,
                                        pointed_type(words, count, words[at + 1]),
                                        4u << 16 | SPIRV_VARIABLE,
                                        type,
                                        layer,
                                        SPIRV_PRIVATE};
            memcpy(out + length, private, sizeof private);
            length += 4;
        }
        length += next - at;
    }
    *size = length * sizeof *out;
    return out;
}

static struct vk_outcome create_module(const struct dt_vk_runtime *rt, const struct dt_code *code,
                                       VkShaderModule *module)
{
    struct vk_outcome outcome = {VK_SUCCESS, "vkCreateShaderModule"};
    if (code->size == 0)
        return outcome;
    uint32_t *own, *changed = NULL;
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = code->size,
        .pCode = dt_front_words(code, &own),
    };
    if (info.pCode && !vk_has_layers(rt))
        info.pCode = changed = without_layer(info.pCode, &info.codeSize);
    outcome.result = info.pCode
                         ? rt->vk.CreateShaderModule(rt->device, &info, rt->callbacks, module)
                         : VK_ERROR_OUT_OF_HOST_MEMORY;
    free(changed);
    free(own);
    return outcome;
}

static VkPipelineShaderStageCreateInfo shader_stage(VkShaderStageFlagBits stage,
                                                    VkShaderModule module)
{
    return (VkPipelineShaderStageCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
        .stage = stage,
        .module = module,
        .pName = "main",
    };
}

static VkPipelineCreateFlags creation_flags(const struct dt_vk_runtime *rt)
{
    return rt->captures ? VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR : 0;
}

static struct vk_outcome compile_compute(const struct dt_vk_runtime *rt, struct vk_program *program,
                                         const struct vk_program_info *info)
{
    VkShaderModule module = VK_NULL_HANDLE;
    struct vk_outcome outcome = create_module(rt, &info->stages->compute, &module);
    if (outcome.result != VK_SUCCESS)
        return outcome;
    VkComputePipelineCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .flags = creation_flags(rt),
        .stage = shader_stage(VK_SHADER_STAGE_COMPUTE_BIT, module),
        .layout = program->layout,
    };
    outcome.call = "vkCreateComputePipelines";
    outcome.result = rt->vk.CreateComputePipelines(rt->device, rt->cache, 1, &create, rt->callbacks,
                                                   &program->handle);
    rt->vk.DestroyShaderModule(rt->device, module, rt->callbacks);
    return outcome;
}

/* Every attribute has a binding of its own, whose stride comes with the scene. */
static const VkVertexInputAttributeDescription vertex_attributes[DT_ATTRIBUTES] = {
    {DT_POSITION, DT_POSITION, VK_FORMAT_R32G32B32_SFLOAT, 0},
    {DT_NORMAL, DT_NORMAL, VK_FORMAT_R32G32B32_SFLOAT, 0},
    {DT_UV, DT_UV, VK_FORMAT_R32G32_SFLOAT, 0},
    {DT_MATERIAL, DT_MATERIAL, VK_FORMAT_R32_UINT, 0},
    {DT_TRIANGLE, DT_TRIANGLE, VK_FORMAT_R32_UINT, 0},
};

/* Those that the vertex shader reads: the validation layer names every other. */
static uint32_t read_attributes(VkVertexInputAttributeDescription *attributes,
                                VkVertexInputBindingDescription *bindings, uint8_t read)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < DT_ATTRIBUTES; i++) {
        if (!(read >> i & 1))
            continue;
        bindings[count] = (VkVertexInputBindingDescription){i, 0, VK_VERTEX_INPUT_RATE_VERTEX};
        attributes[count++] = vertex_attributes[i];
    }
    return count;
}

static const VkCullModeFlags culls[] = {
    [DT_CULL_NONE] = VK_CULL_MODE_NONE,
    [DT_CULL_BACK] = VK_CULL_MODE_BACK_BIT,
    [DT_CULL_FRONT] = VK_CULL_MODE_FRONT_BIT,
};
static const VkCompareOp compares[] = {
    [DT_COMPARE_LESS] = VK_COMPARE_OP_LESS,
    [DT_COMPARE_LESS_EQUAL] = VK_COMPARE_OP_LESS_OR_EQUAL,
    [DT_COMPARE_GREATER] = VK_COMPARE_OP_GREATER,
    [DT_COMPARE_ALWAYS] = VK_COMPARE_OP_ALWAYS,
};

static const VkPrimitiveTopology topologies[] = {
    [DT_TRIANGLES] = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
    [DT_LINES] = VK_PRIMITIVE_TOPOLOGY_LINE_LIST,
    [DT_POINTS] = VK_PRIMITIVE_TOPOLOGY_POINT_LIST,
};
static const VkPipelineViewportStateCreateInfo one_viewport = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
    .viewportCount = 1,
    .scissorCount = 1,
};
static const VkPipelineMultisampleStateCreateInfo one_sample = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
    .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT,
};
/* The last one only with attributes. */
static const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                                VK_DYNAMIC_STATE_VERTEX_INPUT_BINDING_STRIDE};

static VkPipelineColorBlendAttachmentState blend_state(const struct dt_target *target)
{
    static const VkBlendFactor factors[] = {
        [DT_FACTOR_ONE] = VK_BLEND_FACTOR_ONE,
        [DT_FACTOR_ZERO] = VK_BLEND_FACTOR_ZERO,
        [DT_FACTOR_SRC_COLOR] = VK_BLEND_FACTOR_SRC_COLOR,
        [DT_FACTOR_ONE_MINUS_SRC_COLOR] = VK_BLEND_FACTOR_ONE_MINUS_SRC_COLOR,
        [DT_FACTOR_DST_COLOR] = VK_BLEND_FACTOR_DST_COLOR,
        [DT_FACTOR_ONE_MINUS_DST_COLOR] = VK_BLEND_FACTOR_ONE_MINUS_DST_COLOR,
        [DT_FACTOR_SRC_ALPHA] = VK_BLEND_FACTOR_SRC_ALPHA,
        [DT_FACTOR_ONE_MINUS_SRC_ALPHA] = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        [DT_FACTOR_DST_ALPHA] = VK_BLEND_FACTOR_DST_ALPHA,
        [DT_FACTOR_ONE_MINUS_DST_ALPHA] = VK_BLEND_FACTOR_ONE_MINUS_DST_ALPHA,
    };
    static const VkBlendOp ops[] = {[DT_BLEND_ADD] = VK_BLEND_OP_ADD,
                                    [DT_BLEND_SUBTRACT] = VK_BLEND_OP_SUBTRACT,
                                    [DT_BLEND_REVERSE_SUBTRACT] = VK_BLEND_OP_REVERSE_SUBTRACT,
                                    [DT_BLEND_MIN] = VK_BLEND_OP_MIN,
                                    [DT_BLEND_MAX] = VK_BLEND_OP_MAX};
    static const struct dt_blend off = {0};
    const struct dt_blend *blend = target->blend ? target->blend : &off;
    return (VkPipelineColorBlendAttachmentState){
        .blendEnable = target->blend != NULL,
        .srcColorBlendFactor = factors[blend->src],
        .dstColorBlendFactor = factors[blend->dst],
        .colorBlendOp = ops[blend->op],
        .srcAlphaBlendFactor = factors[blend->alpha_src],
        .dstAlphaBlendFactor = factors[blend->alpha_dst],
        .alphaBlendOp = ops[blend->alpha_op],
        .colorWriteMask = 0xf & ~(VkColorComponentFlags)target->keep,
    };
}

static VkResult create_graphics(const struct dt_vk_runtime *rt, struct vk_program *program,
                                const struct vk_program_info *info,
                                const VkPipelineShaderStageCreateInfo stages[2])
{
    const struct dt_program *state = info->state;
    VkVertexInputAttributeDescription attributes[DT_ATTRIBUTES];
    VkVertexInputBindingDescription bindings[DT_ATTRIBUTES];
    uint32_t attribute_count = read_attributes(attributes, bindings, state->attributes);
    VkPipelineVertexInputStateCreateInfo vertex_input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = attribute_count,
        .pVertexBindingDescriptions = bindings,
        .vertexAttributeDescriptionCount = attribute_count,
        .pVertexAttributeDescriptions = attributes,
    };
    VkPipelineDynamicStateCreateInfo dynamic_state = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = DT_ARRAY_COUNT(dynamic_states) - !attribute_count,
        .pDynamicStates = dynamic_states,
    };
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = topologies[state->topology],
    };
    VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = culls[state->cull],
        .frontFace = VK_FRONT_FACE_CLOCKWISE, /* equals GL_CCW: window y points down */
        .depthBiasEnable = state->bias_constant != 0 || state->bias_slope != 0,
        .depthBiasConstantFactor = state->bias_constant,
        .depthBiasSlopeFactor = state->bias_slope,
        .lineWidth = 1,
    };
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = state->depth_test || state->depth_write, /* depth writes need the test */
        .depthWriteEnable = state->depth_write,
        .depthCompareOp = state->depth_test ? compares[state->compare] : VK_COMPARE_OP_ALWAYS,
    };
    VkPipelineColorBlendAttachmentState blends[DT_MAX_COLOR_TARGETS];
    for (uint32_t i = 0; i < state->color_count; i++)
        blends[i] = blend_state(&state->colors[i]);
    VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = state->color_count,
        .pAttachments = blends,
    };
    VkPipelineRenderingCreateInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = state->color_count,
        .pColorAttachmentFormats = info->color_formats,
        .depthAttachmentFormat = info->depth_format,
    };
    VkGraphicsPipelineCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .flags = creation_flags(rt),
        .stageCount = info->stages->fragment.size ? 2 : 1,
        .pStages = stages,
        .pVertexInputState = &vertex_input,
        .pInputAssemblyState = &assembly,
        .pViewportState = &one_viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &one_sample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic_state,
        .layout = program->layout,
    };
    return rt->vk.CreateGraphicsPipelines(rt->device, rt->cache, 1, &create, rt->callbacks,
                                          &program->handle);
}

static struct vk_outcome compile_graphics(const struct dt_vk_runtime *rt,
                                          struct vk_program *program,
                                          const struct vk_program_info *info)
{
    VkShaderModule vertex = VK_NULL_HANDLE, fragment = VK_NULL_HANDLE;
    struct vk_outcome outcome = create_module(rt, &info->stages->vertex, &vertex);
    if (outcome.result == VK_SUCCESS)
        outcome = create_module(rt, &info->stages->fragment, &fragment);
    if (outcome.result == VK_SUCCESS) {
        VkPipelineShaderStageCreateInfo stages[2] = {
            shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertex),
            shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment),
        };
        outcome.call = "vkCreateGraphicsPipelines";
        outcome.result = create_graphics(rt, program, info, stages);
    }
    rt->vk.DestroyShaderModule(rt->device, vertex, rt->callbacks);
    rt->vk.DestroyShaderModule(rt->device, fragment, rt->callbacks);
    return outcome;
}

/* ---- Programs -------------------------------------------------------------------------------- */

bool vk_program_begin(struct dt_vk_runtime *rt, struct vk_program *program,
                      const struct vk_program_info *info)
{
    *program = (struct vk_program){0};
    return create_layouts(rt, program, info) && create_set(rt, program, info);
}

struct vk_outcome vk_program_compile(const struct dt_vk_runtime *rt, struct vk_program *program,
                                     const struct vk_program_info *info)
{
    return info->stages->compute.size ? compile_compute(rt, program, info)
                                      : compile_graphics(rt, program, info);
}

bool vk_program_create(struct dt_vk_runtime *rt, struct vk_program *program,
                       const struct vk_program_info *info)
{
    if (vk_program_begin(rt, program, info)) {
        struct vk_outcome outcome = vk_program_compile(rt, program, info);
        if (vk_check(rt, outcome.result, outcome.call, info->name))
            return true;
    }
    vk_program_destroy(&rt->core, program);
    return false;
}

void vk_program_destroy(struct dt_core *core, void *made)
{
    struct dt_vk_runtime *rt = vk_runtime_of(core);
    struct vk_program *program = made;
    rt->vk.DestroyDescriptorPool(rt->device, program->pool, rt->callbacks); /* frees the set */
    rt->vk.DestroyPipeline(rt->device, program->handle, rt->callbacks);
    rt->vk.DestroyPipelineLayout(rt->device, program->layout, rt->callbacks);
    rt->vk.DestroyDescriptorSetLayout(rt->device, program->set_layout, rt->callbacks);
    *program = (struct vk_program){0};
}
