/* The recorder; see tape.h. Each kind of object has a table; a destroyed one leaves a free place.
 * Parameters have names of this project's style, not of Vulkan's headers:
 * NOLINTBEGIN(readability-inconsistent-declaration-parameter-name) */
#include "tape.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "spirv_uses.h"

enum { MAX_OBJECTS = 1024, MAX_ENTRIES = 8192, MAX_ATTACHMENTS = 9, NONE = UINT32_MAX };

#define STAGE(name)  VK_PIPELINE_STAGE_2_##name##_BIT
#define ACCESS(name) VK_ACCESS_2_##name##_BIT

/* The loader's function `name`. */
#define REAL(function)                                                                             \
    PFN_##function real;                                                                           \
    *(void **)&real = dlsym(RTLD_NEXT, #function)

struct view {
    uint64_t handle;
    uint32_t resource, mips;
};

struct module {
    uint64_t handle;
    uint8_t uses[SPIRV_BINDINGS];
};

struct program {
    uint64_t handle;
    bool compute, vertices, depth_test, depth_write;
    bool blends[MAX_ATTACHMENTS];
    uint8_t vertex[SPIRV_BINDINGS], fragment[SPIRV_BINDINGS]; /* vertex: also compute */
};

struct descriptor {
    uint64_t set;
    uint32_t binding, resource, mips;
    VkDescriptorType type;
    VkImageLayout layout;
};

static struct {
    struct tape_resource resources[MAX_OBJECTS];
    struct view views[MAX_OBJECTS];
    struct module modules[MAX_OBJECTS];
    struct program programs[MAX_OBJECTS];
    struct descriptor descriptors[MAX_OBJECTS];
    struct tape_entry entries[MAX_ENTRIES];
    struct tape tape;
    const char *problem; /* with an object, for good */
    const char *copy;    /* in the present command buffer */
    char pass[64];
    uint32_t command, call;
    const struct program *program[2]; /* bound: graphics, compute */
    uint64_t set[2];
    uint32_t index_buffer, vertex_buffer;
    bool rendering; /* all of one rendering is one command */
    VkRenderingAttachmentInfo color[MAX_ATTACHMENTS], depth;
    uint32_t color_count;
    VkImageLayout layouts[MAX_OBJECTS]; /* of the resources, by all that was recorded */
} tape = {.tape = {.resources = tape.resources, .entries = tape.entries}};

const struct tape *tape_last(void)
{
    return &tape.tape;
}

const char *tape_problem(void)
{
    return tape.problem ? tape.problem : tape.copy;
}

void tape_pass(const char *name)
{
    snprintf(tape.pass, sizeof tape.pass, "%s", name);
}

/* ---- Objects --------------------------------------------------------------------------------- */

/* Index of a handle in a table whose elements begin with it, or NONE. */
static uint32_t place_of(const void *table, size_t size, uint64_t handle)
{
    for (uint32_t i = 0; i < MAX_OBJECTS; i++)
        if (*(const uint64_t *)((const char *)table + i * size) == handle)
            return i;
    return NONE;
}

static uint32_t free_place(const void *table, size_t size)
{
    uint32_t place = place_of(table, size, 0);

    if (place == NONE) {
        fprintf(stderr, "the recorder holds %d objects of a kind; raise MAX_OBJECTS\n",
                MAX_OBJECTS);
        abort();
    }
    return place;
}

static void forget(void *table, size_t size, uint64_t handle)
{
    uint32_t place = handle ? place_of(table, size, handle) : NONE;

    if (place != NONE)
        memset((char *)table + place * size, 0, size);
}

#define PLACE_OF(table, handle) place_of(table, sizeof *(table), (uint64_t)(handle))
#define FREE_PLACE(table)       free_place(table, sizeof *(table))
#define FORGET(table, handle)   forget(table, sizeof *(table), (uint64_t)(handle))

static uint32_t resource_of(uint64_t handle)
{
    uint32_t place = PLACE_OF(tape.resources, handle);

    if (place == NONE)
        tape.problem = "a buffer or image that was not seen being created";
    return place;
}

void tape_name(uint64_t handle, const char *name)
{
    uint32_t resource = resource_of(handle);

    if (resource != NONE)
        snprintf(tape.resources[resource].name, sizeof tape.resources[resource].name, "%s", name);
}

static struct tape_resource *new_resource(void)
{
    uint32_t place = FREE_PLACE(tape.resources);

    if (place >= tape.tape.resource_count)
        tape.tape.resource_count = place + 1;
    tape.layouts[place] = VK_IMAGE_LAYOUT_UNDEFINED;
    return &tape.resources[place];
}

VkResult vkCreateBuffer(VkDevice device, const VkBufferCreateInfo *info,
                        const VkAllocationCallbacks *allocator, VkBuffer *buffer)
{
    REAL(vkCreateBuffer);
    VkResult result = real(device, info, allocator, buffer);

    if (result == VK_SUCCESS)
        *new_resource() = (struct tape_resource){
            .name = "a buffer", .handle = (uint64_t)*buffer, .mips = 1, .size = info->size};
    return result;
}

VkResult vkCreateImage(VkDevice device, const VkImageCreateInfo *info,
                       const VkAllocationCallbacks *allocator, VkImage *image)
{
    REAL(vkCreateImage);
    VkResult result = real(device, info, allocator, image);

    if (result == VK_SUCCESS)
        *new_resource() = (struct tape_resource){
            .name = "an image", .handle = (uint64_t)*image, .image = true, .mips = info->mipLevels};
    return result;
}

static void bind_memory(uint64_t handle, VkDeviceMemory memory, VkDeviceSize offset)
{
    uint32_t resource = resource_of(handle);

    if (resource == NONE)
        return;
    tape.resources[resource].memory = (uint64_t)memory;
    tape.resources[resource].offset = offset;
}

VkResult vkBindBufferMemory(VkDevice device, VkBuffer buffer, VkDeviceMemory memory,
                            VkDeviceSize offset)
{
    REAL(vkBindBufferMemory);

    bind_memory((uint64_t)buffer, memory, offset);
    return real(device, buffer, memory, offset);
}

VkResult vkBindImageMemory(VkDevice device, VkImage image, VkDeviceMemory memory,
                           VkDeviceSize offset)
{
    REAL(vkBindImageMemory);
    VkMemoryRequirements needs;
    uint32_t resource = resource_of((uint64_t)image);

    vkGetImageMemoryRequirements(device, image, &needs);
    bind_memory((uint64_t)image, memory, offset);
    if (resource != NONE)
        tape.resources[resource].size = needs.size;
    return real(device, image, memory, offset);
}

static uint32_t mip_mask(uint32_t resource, uint32_t first, uint32_t count)
{
    uint32_t mips = resource == NONE ? 1 : tape.resources[resource].mips;
    uint32_t end = count == VK_REMAINING_MIP_LEVELS ? mips : first + count;

    return (end < 32 ? (1u << end) - 1 : UINT32_MAX) & ~((1u << first) - 1);
}

VkResult vkCreateImageView(VkDevice device, const VkImageViewCreateInfo *info,
                           const VkAllocationCallbacks *allocator, VkImageView *view)
{
    REAL(vkCreateImageView);
    VkResult result = real(device, info, allocator, view);

    if (result == VK_SUCCESS) {
        uint32_t resource = resource_of((uint64_t)info->image);

        tape.views[FREE_PLACE(tape.views)] =
            (struct view){.handle = (uint64_t)*view,
                          .resource = resource,
                          .mips = mip_mask(resource, info->subresourceRange.baseMipLevel,
                                           info->subresourceRange.levelCount)};
    }
    return result;
}

VkResult vkCreateBufferView(VkDevice device, const VkBufferViewCreateInfo *info,
                            const VkAllocationCallbacks *allocator, VkBufferView *view)
{
    REAL(vkCreateBufferView);
    VkResult result = real(device, info, allocator, view);

    if (result == VK_SUCCESS)
        tape.views[FREE_PLACE(tape.views)] = (struct view){
            .handle = (uint64_t)*view, .resource = resource_of((uint64_t)info->buffer), .mips = 1};
    return result;
}

static const struct view *view_of(uint64_t view)
{
    static const struct view none = {.resource = NONE};
    uint32_t place = PLACE_OF(tape.views, view);

    if (place == NONE)
        tape.problem = "a view that was not seen being created";
    return place == NONE ? &none : &tape.views[place];
}

/* ---- Programs -------------------------------------------------------------------------------- */

VkResult vkCreateShaderModule(VkDevice device, const VkShaderModuleCreateInfo *info,
                              const VkAllocationCallbacks *allocator, VkShaderModule *module)
{
    REAL(vkCreateShaderModule);
    VkResult result = real(device, info, allocator, module);

    if (result == VK_SUCCESS) {
        struct module *place = &tape.modules[FREE_PLACE(tape.modules)];
        const char *problem = NULL;

        place->handle = (uint64_t)*module;
        if (!spirv_uses(info->pCode, info->codeSize / 4, place->uses, &problem))
            tape.problem = problem;
    }
    return result;
}

static void take_uses(uint8_t uses[SPIRV_BINDINGS], const VkPipelineShaderStageCreateInfo *stage)
{
    uint32_t place = PLACE_OF(tape.modules, stage->module);

    if (place == NONE)
        tape.problem = "a shader module that was not seen being created";
    else
        memcpy(uses, tape.modules[place].uses, SPIRV_BINDINGS);
}

static struct program *new_program(VkPipeline pipeline)
{
    struct program *place = &tape.programs[FREE_PLACE(tape.programs)];

    *place = (struct program){.handle = (uint64_t)pipeline};
    return place;
}

VkResult vkCreateComputePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                  const VkComputePipelineCreateInfo *infos,
                                  const VkAllocationCallbacks *allocator, VkPipeline *pipelines)
{
    REAL(vkCreateComputePipelines);
    VkResult result = real(device, cache, count, infos, allocator, pipelines);

    for (uint32_t i = 0; i < count && result == VK_SUCCESS; i++) {
        struct program *program = new_program(pipelines[i]);

        program->compute = true;
        take_uses(program->vertex, &infos[i].stage);
    }
    return result;
}

VkResult vkCreateGraphicsPipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                   const VkGraphicsPipelineCreateInfo *infos,
                                   const VkAllocationCallbacks *allocator, VkPipeline *pipelines)
{
    REAL(vkCreateGraphicsPipelines);
    VkResult result = real(device, cache, count, infos, allocator, pipelines);

    for (uint32_t i = 0; i < count && result == VK_SUCCESS; i++) {
        const VkGraphicsPipelineCreateInfo *info = &infos[i];
        const VkPipelineColorBlendStateCreateInfo *blend = info->pColorBlendState;
        struct program *program = new_program(pipelines[i]);

        program->vertices = info->pVertexInputState->vertexBindingDescriptionCount > 0;
        program->depth_test = info->pDepthStencilState->depthTestEnable;
        program->depth_write = info->pDepthStencilState->depthWriteEnable;
        for (uint32_t j = 0; j < blend->attachmentCount && j < MAX_ATTACHMENTS; j++)
            program->blends[j] = blend->pAttachments[j].blendEnable;
        for (uint32_t j = 0; j < info->stageCount; j++)
            take_uses(info->pStages[j].stage == VK_SHADER_STAGE_VERTEX_BIT ? program->vertex
                                                                           : program->fragment,
                      &info->pStages[j]);
    }
    return result;
}

static void write_descriptor(const VkWriteDescriptorSet *write)
{
    struct descriptor descriptor = {.set = (uint64_t)write->dstSet,
                                    .binding = write->dstBinding,
                                    .type = write->descriptorType};
    uint32_t place = 0;

    if (write->pBufferInfo) {
        descriptor.resource = resource_of((uint64_t)write->pBufferInfo->buffer);
        descriptor.mips = 1;
    } else if (write->pTexelBufferView) {
        const struct view *view = view_of((uint64_t)*write->pTexelBufferView);
        descriptor.resource = view->resource;
        descriptor.mips = view->mips;
    } else {
        const struct view *view = view_of((uint64_t)write->pImageInfo->imageView);
        descriptor.resource = view->resource;
        descriptor.mips = view->mips;
        descriptor.layout = write->pImageInfo->imageLayout;
    }
    while (place < MAX_OBJECTS && (tape.descriptors[place].set != descriptor.set ||
                                   tape.descriptors[place].binding != descriptor.binding))
        place++;
    if (place == MAX_OBJECTS)
        place = FREE_PLACE(tape.descriptors);
    tape.descriptors[place] = descriptor;
}

void vkUpdateDescriptorSets(VkDevice device, uint32_t count, const VkWriteDescriptorSet *writes,
                            uint32_t copy_count, const VkCopyDescriptorSet *copies)
{
    REAL(vkUpdateDescriptorSets);

    for (uint32_t i = 0; i < count; i++)
        write_descriptor(&writes[i]);
    if (copy_count)
        tape.problem = "a copy of descriptors";
    real(device, count, writes, copy_count, copies);
}

/* ---- Destruction ----------------------------------------------------------------------------- */

/* vkDestroyKIND() forgets the object. */
#define DESTROYED(kind, objects)                                                                   \
    void vkDestroy##kind(VkDevice device, Vk##kind object, const VkAllocationCallbacks *allocator) \
    {                                                                                              \
        REAL(vkDestroy##kind);                                                                     \
        FORGET(objects, object);                                                                   \
        real(device, object, allocator);                                                           \
    }
DESTROYED(Buffer, tape.resources)
DESTROYED(Image, tape.resources)
DESTROYED(ImageView, tape.views)
DESTROYED(BufferView, tape.views)
DESTROYED(ShaderModule, tape.modules)
DESTROYED(Pipeline, tape.programs)

/* ---- Entries --------------------------------------------------------------------------------- */

static struct tape_entry *new_entry(void)
{
    if (tape.tape.entry_count == MAX_ENTRIES) {
        fprintf(stderr, "a tape holds %d entries; raise MAX_ENTRIES\n", MAX_ENTRIES);
        abort();
    }
    struct tape_entry *entry = &tape.entries[tape.tape.entry_count++];
    memset(entry, 0, sizeof *entry);
    memcpy(entry->pass, tape.pass, sizeof entry->pass);
    return entry;
}

static void touch(uint32_t resource, uint32_t mips, VkImageLayout layout,
                  VkPipelineStageFlags2 stage, VkAccessFlags2 access, bool writes)
{
    if (resource == NONE)
        return;
    new_entry()->access = (struct tape_access){.command = tape.command,
                                               .resource = resource,
                                               .mips = mips,
                                               .layout = layout,
                                               .stage = stage,
                                               .access = access,
                                               .writes = writes};
}

static void touch_descriptor(const struct descriptor *descriptor, uint8_t uses,
                             VkPipelineStageFlags2 stage)
{
    VkAccessFlags2 read = descriptor->type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                              ? ACCESS(UNIFORM_READ)
                          : descriptor->type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER ||
                                  descriptor->type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                              ? ACCESS(SHADER_SAMPLED_READ)
                              : ACCESS(SHADER_STORAGE_READ);

    if (uses & SPIRV_READS)
        touch(descriptor->resource, descriptor->mips, descriptor->layout, stage, read, false);
    if (uses & SPIRV_WRITES)
        touch(descriptor->resource, descriptor->mips, descriptor->layout, stage,
              ACCESS(SHADER_STORAGE_WRITE), true);
}

static void touch_bound(VkPipelineBindPoint point)
{
    const struct program *program = tape.program[point];

    for (uint32_t i = 0; i < MAX_OBJECTS; i++) {
        const struct descriptor *descriptor = &tape.descriptors[i];

        if (!descriptor->set || descriptor->set != tape.set[point] ||
            descriptor->binding >= SPIRV_BINDINGS)
            continue;
        touch_descriptor(descriptor, program->vertex[descriptor->binding],
                         program->compute ? STAGE(COMPUTE_SHADER) : STAGE(VERTEX_SHADER));
        touch_descriptor(descriptor, program->fragment[descriptor->binding],
                         STAGE(FRAGMENT_SHADER));
    }
}

/* ---- Command buffers ------------------------------------------------------------------------- */

VkResult vkBeginCommandBuffer(VkCommandBuffer commands, const VkCommandBufferBeginInfo *info)
{
    REAL(vkBeginCommandBuffer);

    for (uint32_t i = 0; i < tape.tape.resource_count; i++)
        tape.resources[i].layout = tape.layouts[i];
    tape.tape.entry_count = 0;
    tape.command = tape.call = 0;
    tape.program[0] = tape.program[1] = NULL;
    tape.set[0] = tape.set[1] = 0;
    tape.index_buffer = tape.vertex_buffer = NONE;
    tape.copy = NULL;
    tape.rendering = false;
    return real(commands, info);
}

void vkCmdPipelineBarrier2(VkCommandBuffer commands, const VkDependencyInfo *info)
{
    REAL(vkCmdPipelineBarrier2);

    tape.call++;
    for (uint32_t i = 0; i < info->memoryBarrierCount; i++) {
        const VkMemoryBarrier2 *barrier = &info->pMemoryBarriers[i];
        struct tape_entry *entry = new_entry();

        entry->is_barrier = true;
        entry->barrier = (struct tape_barrier){tape.call,
                                               TAPE_ALL_MEMORY,
                                               UINT32_MAX,
                                               barrier->srcStageMask,
                                               barrier->dstStageMask,
                                               barrier->srcAccessMask,
                                               barrier->dstAccessMask,
                                               0,
                                               0};
    }
    for (uint32_t i = 0; i < info->bufferMemoryBarrierCount; i++) {
        const VkBufferMemoryBarrier2 *barrier = &info->pBufferMemoryBarriers[i];
        struct tape_entry *entry = new_entry();

        entry->is_barrier = true;
        entry->barrier = (struct tape_barrier){tape.call,
                                               resource_of((uint64_t)barrier->buffer),
                                               1,
                                               barrier->srcStageMask,
                                               barrier->dstStageMask,
                                               barrier->srcAccessMask,
                                               barrier->dstAccessMask,
                                               0,
                                               0};
        if (barrier->offset != 0 || barrier->size != VK_WHOLE_SIZE)
            tape.problem = "a barrier for a part of a buffer";
    }
    for (uint32_t i = 0; i < info->imageMemoryBarrierCount; i++) {
        const VkImageMemoryBarrier2 *barrier = &info->pImageMemoryBarriers[i];
        uint32_t resource = resource_of((uint64_t)barrier->image);
        struct tape_entry *entry = new_entry();

        if (resource == NONE)
            continue;
        tape.layouts[resource] = barrier->newLayout;
        if (barrier->subresourceRange.baseMipLevel != 0 ||
            barrier->subresourceRange.levelCount != tape.resources[resource].mips)
            tape.problem = "a barrier for some mips";
        entry->is_barrier = true;
        entry->barrier = (struct tape_barrier){
            tape.call,
            resource,
            mip_mask(resource, barrier->subresourceRange.baseMipLevel,
                     barrier->subresourceRange.levelCount),
            barrier->srcStageMask,
            barrier->dstStageMask,
            barrier->srcAccessMask,
            barrier->dstAccessMask,
            barrier->oldLayout,
            barrier->newLayout,
        };
    }
    real(commands, info);
}

void vkCmdBindPipeline(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipeline pipeline)
{
    REAL(vkCmdBindPipeline);
    static const struct program none;
    uint32_t place = PLACE_OF(tape.programs, pipeline);

    tape.program[point] = place == NONE ? &none : &tape.programs[place];
    tape.set[point] = 0; /* a program without descriptors binds none */
    if (place == NONE)
        tape.problem = "a pipeline that was not seen being created";
    real(commands, point, pipeline);
}

void vkCmdBindDescriptorSets(VkCommandBuffer commands, VkPipelineBindPoint point,
                             VkPipelineLayout layout, uint32_t first, uint32_t count,
                             const VkDescriptorSet *sets, uint32_t offset_count,
                             const uint32_t *offsets)
{
    REAL(vkCmdBindDescriptorSets);

    tape.set[point] = (uint64_t)sets[0];
    if (first != 0 || count != 1)
        tape.problem = "a second descriptor set";
    real(commands, point, layout, first, count, sets, offset_count, offsets);
}

void vkCmdBindIndexBuffer(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                          VkIndexType type)
{
    REAL(vkCmdBindIndexBuffer);

    tape.index_buffer = resource_of((uint64_t)buffer);
    real(commands, buffer, offset, type);
}

void vkCmdBindVertexBuffers2(VkCommandBuffer commands, uint32_t first, uint32_t count,
                             const VkBuffer *buffers, const VkDeviceSize *offsets,
                             const VkDeviceSize *sizes, const VkDeviceSize *strides)
{
    REAL(vkCmdBindVertexBuffers2);

    tape.vertex_buffer = resource_of((uint64_t)buffers[0]);
    for (uint32_t i = 0; i < count; i++)
        if (first != 0 || buffers[i] != buffers[0])
            tape.problem = "a second vertex buffer";
    real(commands, first, count, buffers, offsets, sizes, strides);
}

/* ---- Work ------------------------------------------------------------------------------------ */

static void touch_buffer(uint32_t buffer, VkPipelineStageFlags2 stage, VkAccessFlags2 access,
                         bool writes)
{
    touch(buffer, 1, VK_IMAGE_LAYOUT_UNDEFINED, stage, access, writes);
}

static void touch_arguments(VkBuffer buffer)
{
    touch_buffer(resource_of((uint64_t)buffer), STAGE(DRAW_INDIRECT), ACCESS(INDIRECT_COMMAND_READ),
                 false);
}

void vkCmdDispatch(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z)
{
    REAL(vkCmdDispatch);

    tape.command++;
    touch_bound(VK_PIPELINE_BIND_POINT_COMPUTE);
    real(commands, x, y, z);
}

void vkCmdDispatchIndirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset)
{
    REAL(vkCmdDispatchIndirect);

    tape.command++;
    touch_arguments(buffer);
    touch_bound(VK_PIPELINE_BIND_POINT_COMPUTE);
    real(commands, buffer, offset);
}

static void touch_target(const VkRenderingAttachmentInfo *target, VkPipelineStageFlags2 stage,
                         VkAccessFlags2 access, bool writes)
{
    const struct view *view = view_of((uint64_t)target->imageView);

    touch(view->resource, view->mips, target->imageLayout, stage, access, writes);
}

static void touch_color(const VkRenderingAttachmentInfo *target, bool writes)
{
    touch_target(target, STAGE(COLOR_ATTACHMENT_OUTPUT),
                 writes ? ACCESS(COLOR_ATTACHMENT_WRITE) : ACCESS(COLOR_ATTACHMENT_READ), writes);
}

static void touch_depth(VkPipelineStageFlags2 stage, bool writes)
{
    touch_target(&tape.depth, stage,
                 writes ? ACCESS(DEPTH_STENCIL_ATTACHMENT_WRITE)
                        : ACCESS(DEPTH_STENCIL_ATTACHMENT_READ),
                 writes);
}

/* Load operations read or clear, colour in the output stage and depth in the early tests; store
 * operations write, whatever was drawn, depth in the late tests (specification, 8.1 and 8.7). */
void vkCmdBeginRendering(VkCommandBuffer commands, const VkRenderingInfo *info)
{
    REAL(vkCmdBeginRendering);

    tape.command++;
    tape.rendering = true;
    tape.color_count = 0;
    tape.depth = (VkRenderingAttachmentInfo){0};
    for (uint32_t i = 0; i < info->colorAttachmentCount && i < MAX_ATTACHMENTS; i++) {
        const VkRenderingAttachmentInfo *target = &info->pColorAttachments[i];

        tape.color[tape.color_count++] = *target;
        touch_color(target, target->loadOp != VK_ATTACHMENT_LOAD_OP_LOAD);
        if (target->storeOp != VK_ATTACHMENT_STORE_OP_NONE)
            touch_color(target, true);
    }
    if (info->pDepthAttachment) {
        tape.depth = *info->pDepthAttachment;
        touch_depth(STAGE(EARLY_FRAGMENT_TESTS), tape.depth.loadOp != VK_ATTACHMENT_LOAD_OP_LOAD);
        if (tape.depth.storeOp != VK_ATTACHMENT_STORE_OP_NONE)
            touch_depth(STAGE(LATE_FRAGMENT_TESTS), true);
    }
    real(commands, info);
}

/* Draws read colour to blend; the depth test reads and writes early or late, as the shader has
 * it. */
static void touch_targets(const struct program *program)
{
    for (uint32_t i = 0; i < tape.color_count; i++) {
        if (program->blends[i])
            touch_color(&tape.color[i], false);
        touch_color(&tape.color[i], true);
    }
    for (int late = 0; late < 2; late++) {
        VkPipelineStageFlags2 stage =
            late ? STAGE(LATE_FRAGMENT_TESTS) : STAGE(EARLY_FRAGMENT_TESTS);

        if (program->depth_test)
            touch_depth(stage, false);
        if (program->depth_write)
            touch_depth(stage, true);
    }
}

static void touch_draw(bool indexed)
{
    const struct program *program = tape.program[VK_PIPELINE_BIND_POINT_GRAPHICS];

    if (!tape.rendering)
        tape.problem = "a draw outside a rendering";
    if (indexed)
        touch_buffer(tape.index_buffer, STAGE(INDEX_INPUT), ACCESS(INDEX_READ), false);
    if (program->vertices)
        touch_buffer(tape.vertex_buffer, STAGE(VERTEX_ATTRIBUTE_INPUT),
                     ACCESS(VERTEX_ATTRIBUTE_READ), false);
    touch_bound(VK_PIPELINE_BIND_POINT_GRAPHICS);
    touch_targets(program);
}

void vkCmdDraw(VkCommandBuffer commands, uint32_t vertices, uint32_t instances, uint32_t vertex,
               uint32_t instance)
{
    REAL(vkCmdDraw);

    touch_draw(false);
    real(commands, vertices, instances, vertex, instance);
}

void vkCmdDrawIndexed(VkCommandBuffer commands, uint32_t indices, uint32_t instances,
                      uint32_t index, int32_t vertex, uint32_t instance)
{
    REAL(vkCmdDrawIndexed);

    touch_draw(true);
    real(commands, indices, instances, index, vertex, instance);
}

void vkCmdDrawIndirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                       uint32_t count, uint32_t stride)
{
    REAL(vkCmdDrawIndirect);

    touch_arguments(buffer);
    touch_draw(false);
    real(commands, buffer, offset, count, stride);
}

void vkCmdDrawIndexedIndirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                              uint32_t count, uint32_t stride)
{
    REAL(vkCmdDrawIndexedIndirect);

    touch_arguments(buffer);
    touch_draw(true);
    real(commands, buffer, offset, count, stride);
}

void vkCmdEndRendering(VkCommandBuffer commands)
{
    REAL(vkCmdEndRendering);

    tape.rendering = false;
    real(commands);
}

void vkCmdClearColorImage(VkCommandBuffer commands, VkImage image, VkImageLayout layout,
                          const VkClearColorValue *color, uint32_t count,
                          const VkImageSubresourceRange *ranges)
{
    REAL(vkCmdClearColorImage);
    uint32_t resource = resource_of((uint64_t)image);

    tape.command++;
    for (uint32_t i = 0; i < count; i++)
        touch(resource, mip_mask(resource, ranges[i].baseMipLevel, ranges[i].levelCount), layout,
              STAGE(CLEAR), ACCESS(TRANSFER_WRITE), true);
    real(commands, image, layout, color, count, ranges);
}

void vkCmdFillBuffer(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                     VkDeviceSize size, uint32_t data)
{
    REAL(vkCmdFillBuffer);

    tape.command++;
    touch_buffer(resource_of((uint64_t)buffer), STAGE(CLEAR), ACCESS(TRANSFER_WRITE), true);
    real(commands, buffer, offset, size, data);
}

/* ---- Copies: uploads and read-backs, never a part of a frame --------------------------------- */

void vkCmdCopyBuffer(VkCommandBuffer commands, VkBuffer from, VkBuffer to, uint32_t count,
                     const VkBufferCopy *regions)
{
    REAL(vkCmdCopyBuffer);

    tape.copy = "a copy";
    real(commands, from, to, count, regions);
}

void vkCmdCopyBufferToImage(VkCommandBuffer commands, VkBuffer from, VkImage to,
                            VkImageLayout layout, uint32_t count, const VkBufferImageCopy *regions)
{
    REAL(vkCmdCopyBufferToImage);

    tape.copy = "a copy";
    real(commands, from, to, layout, count, regions);
}

void vkCmdCopyImageToBuffer(VkCommandBuffer commands, VkImage from, VkImageLayout layout,
                            VkBuffer to, uint32_t count, const VkBufferImageCopy *regions)
{
    REAL(vkCmdCopyImageToBuffer);

    tape.copy = "a copy";
    real(commands, from, layout, to, count, regions);
}

/* NOLINTEND(readability-inconsistent-declaration-parameter-name) */
