/* One program per pass: shader modules, descriptor set and its layout, compute or graphics
 * pipeline. Called by generated pipelines: create once, bind at every resize. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- Descriptors ----------------------------------------------------------------------------- */

enum { DESCRIPTOR_TYPES = 6 };

struct descriptor_limit {
    const char *name;
    VkDescriptorType type;
    uint32_t limit; /* in one stage */
};

static void descriptor_limits(const struct vk_runtime *rt,
                              struct descriptor_limit limits[DESCRIPTOR_TYPES])
{
    const VkPhysicalDeviceLimits *can = &rt->properties.limits;
    uint32_t sampled = can->maxPerStageDescriptorSampledImages;
    uint32_t samplers = can->maxPerStageDescriptorSamplers;
    const struct descriptor_limit all[DESCRIPTOR_TYPES] = {
        {"uniform buffers", VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
         can->maxPerStageDescriptorUniformBuffers},
        {"storage buffers", VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
         can->maxPerStageDescriptorStorageBuffers},
        {"storage images", VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
         can->maxPerStageDescriptorStorageImages},
        {"textures", VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
         sampled < samplers ? sampled : samplers},
        {"sampled images", VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, sampled},
        {"samplers", VK_DESCRIPTOR_TYPE_SAMPLER, samplers},
    };
    memcpy(limits, all, sizeof all);
}

/* How many slots of each type there are, with the zeros left out, as a descriptor pool wants it. */
static bool count_slots(struct vk_runtime *rt, const struct vk_program_info *info,
                        VkDescriptorPoolSize sizes[DESCRIPTOR_TYPES], uint32_t *size_count)
{
    struct descriptor_limit types[DESCRIPTOR_TYPES];
    descriptor_limits(rt, types);
    *size_count = 0;
    if (info->slot_count > VK_MAX_SLOTS)
        return vk_error(rt, "pass %s: %u resources, but at most %d can be bound; split the pass",
                        info->name, info->slot_count, VK_MAX_SLOTS);
    for (uint32_t t = 0; t < DESCRIPTOR_TYPES; t++) {
        uint32_t count = 0;
        for (uint32_t i = 0; i < info->slot_count; i++)
            count += info->slots[i].type == types[t].type;
        if (count > types[t].limit)
            return vk_error(rt, "pass %s: %u %s, but the device binds at most %u; split the pass",
                            info->name, count, types[t].name, types[t].limit);
        if (count)
            sizes[(*size_count)++] = (VkDescriptorPoolSize){types[t].type, count};
    }
    return true;
}

static bool create_set(struct vk_runtime *rt, struct vk_program *program,
                       const struct vk_program_info *info)
{
    VkDescriptorSetLayoutBinding lines[VK_MAX_SLOTS];
    VkDescriptorPoolSize sizes[DESCRIPTOR_TYPES];
    uint32_t size_count;
    if (!count_slots(rt, info, sizes, &size_count))
        return false;
    VkShaderStageFlags stages = info->compute.size
                                    ? VK_SHADER_STAGE_COMPUTE_BIT
                                    : VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    for (uint32_t i = 0; i < info->slot_count; i++)
        lines[i] = (VkDescriptorSetLayoutBinding){.binding = info->slots[i].binding,
                                                  .descriptorType = info->slots[i].type,
                                                  .descriptorCount = 1,
                                                  .stageFlags = stages};
    VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = info->slot_count,
        .pBindings = lines,
    };
    if (!VK(rt, rt->vk.CreateDescriptorSetLayout(rt->device, &layout, NULL, &program->set_layout),
            info->name))
        return false;
    if (!info->slot_count)
        return true;
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = size_count,
        .pPoolSizes = sizes,
    };
    if (!VK(rt, rt->vk.CreateDescriptorPool(rt->device, &pool, NULL, &program->pool), info->name))
        return false;
    VkDescriptorSetAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = program->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &program->set_layout,
    };
    return VK(rt, rt->vk.AllocateDescriptorSets(rt->device, &allocate, &program->set), info->name);
}

bool dt_vk_program_bind(struct vk_runtime *rt, struct vk_program *program,
                        const struct vk_binding *bindings, uint32_t count)
{
    VkWriteDescriptorSet writes[VK_MAX_SLOTS];
    VkDescriptorBufferInfo buffers[VK_MAX_SLOTS];
    VkDescriptorImageInfo images[VK_MAX_SLOTS];
    if (count != program->slot_count) /* a line left unwritten brings some drivers down */
        return vk_error(rt, "pass %s: %u bindings for %u slots; the generated code is at fault",
                        program->name, count, program->slot_count);
    for (uint32_t i = 0; i < count; i++) {
        const struct vk_binding *from = &bindings[i];
        const struct vk_image *image = from->image;
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = program->set,
            .dstBinding = from->binding,
            .descriptorCount = 1,
            .descriptorType = from->type,
        };
        if (from->buffer) {
            bool block = from->buffer->block && from->type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
            buffers[i] = (VkDescriptorBufferInfo){from->buffer->handle, from->buffer->offset,
                                                  block ? from->buffer->block : from->buffer->size};
            writes[i].pBufferInfo = &buffers[i];
        } else {
            images[i] =
                (VkDescriptorImageInfo){.sampler = from->sampler, .imageLayout = from->layout};
            if (image)
                images[i].imageView =
                    from->mip == VK_ALL_MIPS ? image->view : image->mip_views[from->mip];
            writes[i].pImageInfo = &images[i];
        }
    }
    rt->vk.UpdateDescriptorSets(rt->device, count, writes, 0, NULL);
    return true;
}

/* ---- Pipelines ------------------------------------------------------------------------------- */

static bool create_module(struct vk_runtime *rt, const char *name, const struct dt_code *code,
                          VkShaderModule *module)
{
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = code->size,
        .pCode = code->words,
    };
    return code->size == 0 ||
           VK(rt, rt->vk.CreateShaderModule(rt->device, &info, NULL, module), name);
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

static bool create_compute(struct vk_runtime *rt, struct vk_program *program,
                           const struct vk_program_info *info)
{
    VkShaderModule module = VK_NULL_HANDLE;
    if (!create_module(rt, info->name, &info->compute, &module))
        return false;
    VkComputePipelineCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = shader_stage(VK_SHADER_STAGE_COMPUTE_BIT, module),
        .layout = program->layout,
    };
    bool ok = VK(rt,
                 rt->vk.CreateComputePipelines(rt->device, VK_NULL_HANDLE, 1, &create, NULL,
                                               &program->pipeline),
                 info->name);
    rt->vk.DestroyShaderModule(rt->device, module, NULL);
    return ok;
}

static const VkVertexInputBindingDescription vertex_binding = {0, sizeof(struct dt_vertex),
                                                               VK_VERTEX_INPUT_RATE_VERTEX};
static const VkVertexInputAttributeDescription vertex_attributes[] = {
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(struct dt_vertex, position)},
    {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(struct dt_vertex, normal)},
    {2, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(struct dt_vertex, uv)},
    {3, 0, VK_FORMAT_R32_UINT, offsetof(struct dt_vertex, material)},
};

static const VkPipelineInputAssemblyStateCreateInfo triangles = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
    .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
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
static const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT,
                                                VK_DYNAMIC_STATE_SCISSOR};
static const VkPipelineDynamicStateCreateInfo dynamic_state = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
    .dynamicStateCount = DT_ARRAY_COUNT(dynamic_states),
    .pDynamicStates = dynamic_states,
};

static VkPipelineColorBlendAttachmentState blend_state(const struct vk_program_info *info)
{
    bool over = info->blend_over;
    return (VkPipelineColorBlendAttachmentState){
        .blendEnable = info->blend_add || over,
        .srcColorBlendFactor = over ? VK_BLEND_FACTOR_SRC_ALPHA : VK_BLEND_FACTOR_ONE,
        .dstColorBlendFactor = over ? VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA : VK_BLEND_FACTOR_ONE,
        .colorBlendOp = VK_BLEND_OP_ADD,
        .srcAlphaBlendFactor = over ? VK_BLEND_FACTOR_ZERO : VK_BLEND_FACTOR_ONE,
        .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
        .alphaBlendOp = VK_BLEND_OP_ADD,
        .colorWriteMask = 0xf,
    };
}

static bool create_graphics_pipeline(struct vk_runtime *rt, struct vk_program *program,
                                     const struct vk_program_info *info,
                                     const VkPipelineShaderStageCreateInfo stages[2])
{
    VkPipelineVertexInputStateCreateInfo vertex_input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = info->scene_vertices,
        .pVertexBindingDescriptions = &vertex_binding,
        .vertexAttributeDescriptionCount =
            info->scene_vertices ? DT_ARRAY_COUNT(vertex_attributes) : 0,
        .pVertexAttributeDescriptions = vertex_attributes,
    };
    VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = info->cull,
        .frontFace = VK_FRONT_FACE_CLOCKWISE,
        .lineWidth = 1,
    };
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = info->depth_test,
        .depthWriteEnable = info->depth_write,
        .depthCompareOp = info->depth_compare,
    };
    VkPipelineColorBlendAttachmentState blends[VK_MAX_COLOR_TARGETS];
    for (uint32_t i = 0; i < info->color_count; i++)
        blends[i] = blend_state(info);
    VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = info->color_count,
        .pAttachments = blends,
    };
    VkPipelineRenderingCreateInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = info->color_count,
        .pColorAttachmentFormats = info->color_formats,
        .depthAttachmentFormat = info->depth_format,
    };
    VkGraphicsPipelineCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .stageCount = info->fragment.size ? 2 : 1,
        .pStages = stages,
        .pVertexInputState = &vertex_input,
        .pInputAssemblyState = &triangles,
        .pViewportState = &one_viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &one_sample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic_state,
        .layout = program->layout,
    };
    return VK(rt,
              rt->vk.CreateGraphicsPipelines(rt->device, VK_NULL_HANDLE, 1, &create, NULL,
                                             &program->pipeline),
              info->name);
}

static bool create_graphics(struct vk_runtime *rt, struct vk_program *program,
                            const struct vk_program_info *info)
{
    VkShaderModule vertex = VK_NULL_HANDLE, fragment = VK_NULL_HANDLE;
    uint32_t limit = rt->properties.limits.maxColorAttachments;
    if (info->color_count > limit || info->color_count > VK_MAX_COLOR_TARGETS)
        return vk_error(rt, "pass %s: %u color targets, but the limit is %u; split the pass",
                        info->name, info->color_count,
                        limit < VK_MAX_COLOR_TARGETS ? limit : VK_MAX_COLOR_TARGETS);
    bool ok = create_module(rt, info->name, &info->vertex, &vertex) &&
              create_module(rt, info->name, &info->fragment, &fragment);
    if (ok) {
        VkPipelineShaderStageCreateInfo stages[2] = {
            shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertex),
            shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment),
        };
        ok = create_graphics_pipeline(rt, program, info, stages);
    }
    rt->vk.DestroyShaderModule(rt->device, vertex, NULL);
    rt->vk.DestroyShaderModule(rt->device, fragment, NULL);
    return ok;
}

/* ---- Programs of the panel before ------------------------------------------------------------ */

static bool same_code(const struct dt_code *a, const struct dt_code *b)
{
    return a->size == b->size && (!a->size || memcmp(a->words, b->words, a->size) == 0);
}

static bool same_slots(const struct vk_program_info *a, const struct vk_program_info *b)
{
    bool same = a->slot_count == b->slot_count;
    for (uint32_t i = 0; same && i < a->slot_count; i++)
        same = a->slots[i].binding == b->slots[i].binding && a->slots[i].type == b->slots[i].type;
    return same;
}

static bool same_state(const struct vk_program_info *a, const struct vk_program_info *b)
{
    bool same = a->color_count == b->color_count && a->depth_format == b->depth_format &&
                a->depth_compare == b->depth_compare && a->cull == b->cull &&
                a->depth_test == b->depth_test && a->depth_write == b->depth_write &&
                a->blend_add == b->blend_add && a->blend_over == b->blend_over &&
                a->scene_vertices == b->scene_vertices;
    for (uint32_t i = 0; same && i < a->color_count; i++)
        same = a->color_formats[i] == b->color_formats[i];
    return same;
}

static bool same_program(const struct vk_program_info *a, const struct vk_program_info *b)
{
    return same_code(&a->compute, &b->compute) && same_code(&a->vertex, &b->vertex) &&
           same_code(&a->fragment, &b->fragment) && same_slots(a, b) && same_state(a, b);
}

static bool keep(struct vk_spare *spare, const struct vk_program *program)
{
    struct vk_program *grown =
        program->pipeline ? realloc(spare->programs, (spare->count + 1) * sizeof *grown) : NULL;
    if (!grown)
        return false;
    spare->programs = grown;
    spare->programs[spare->count++] = *program;
    return true;
}

static bool take_spare(struct vk_runtime *rt, struct vk_program *program,
                       const struct vk_program_info *info)
{
    struct vk_spare *spare = &rt->spare;
    for (uint32_t i = 0; i < spare->count; i++) {
        if (!same_program(&spare->programs[i].info, info))
            continue;
        *program = spare->programs[i];
        program->name = info->name;
        program->info = *info;
        spare->programs[i] = spare->programs[--spare->count];
        vk_set_name(rt, VK_OBJECT_TYPE_PIPELINE, (uint64_t)program->pipeline, info->name);
        return true;
    }
    return false;
}

void vk_programs_forget(struct vk_runtime *rt)
{
    struct vk_spare spare = rt->spare;
    rt->spare = (struct vk_spare){0};
    for (uint32_t i = 0; i < spare.count; i++)
        dt_vk_program_destroy(rt, &spare.programs[i]);
    free(spare.programs);
}

/* ---- Programs -------------------------------------------------------------------------------- */

bool dt_vk_program_create(struct vk_runtime *rt, struct vk_program *program,
                          const struct vk_program_info *info)
{
    if (take_spare(rt, program, info))
        return true;
    *program =
        (struct vk_program){.name = info->name, .info = *info, .slot_count = info->slot_count};
    if (!create_set(rt, program, info))
        return false;
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &program->set_layout,
    };
    if (!VK(rt, rt->vk.CreatePipelineLayout(rt->device, &layout, NULL, &program->layout),
            info->name))
        return false;
    bool ok =
        info->compute.size ? create_compute(rt, program, info) : create_graphics(rt, program, info);
    if (ok)
        vk_set_name(rt, VK_OBJECT_TYPE_PIPELINE, (uint64_t)program->pipeline, info->name);
    return ok;
}

void dt_vk_program_destroy(struct vk_runtime *rt, struct vk_program *program)
{
    if (rt->spare.keeps && keep(&rt->spare, program)) {
        *program = (struct vk_program){0};
        return;
    }
    rt->vk.DestroyPipeline(rt->device, program->pipeline, NULL);
    rt->vk.DestroyPipelineLayout(rt->device, program->layout, NULL);
    rt->vk.DestroyDescriptorPool(rt->device, program->pool, NULL); /* frees the set */
    rt->vk.DestroyDescriptorSetLayout(rt->device, program->set_layout, NULL);
    *program = (struct vk_program){0};
}
