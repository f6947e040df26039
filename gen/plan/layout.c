/* Byte offsets by the rules of the OpenGL specification, section 7.6.2.2: std430 for structs in
 * storage buffers, std140 for the uniform block of the parameters. */
#include "plan.h"
#include "formats.h"

static uint32_t align_up(uint32_t value, uint32_t alignment)
{
    return (value + alignment - 1) / alignment * alignment;
}

/* Rules 1 to 5 and 10 of std430: as std140, but neither arrays nor structs are rounded up to 16
 * bytes. */
static void layout_struct(struct structure *structure)
{
    uint32_t offset = 0, align = 4;

    CHANGE_EACH(field, structure->fields, structure->field_count) {
        const struct type_info *info = type_info(field->type);

        field->array_stride = field->array_count ? align_up(info->size, info->align) : 0;
        field->offset = align_up(offset, info->align);
        offset = field->offset +
                 (field->array_count ? field->array_count * field->array_stride : info->size);
        align = info->align > align ? info->align : align;
    }
    structure->align = align;
    structure->stride = align_up(offset, align);
}

/* Elements, and elements of arrays in them, must be multiples of 16 bytes. */
bool std140_equals_std430(const struct resource *buffer)
{
    const struct structure *structure = buffer->structure;

    for (uint32_t i = 0; structure && i < structure->field_count; i++)
        if (structure->fields[i].array_stride % 16)
            return false;
    return buffer->stride % 16 == 0 && (!structure || structure->align == 16);
}

/* Places live or uniform parameters from `offset` on; returns the offset after them. */
static uint32_t layout_params(struct pipeline *pipeline, bool live, uint32_t offset)
{
    CHANGE_EACH(param, pipeline->params, pipeline->param_count) {
        const struct type_info *info = type_info(param->type);

        if (live ? param->live : param->uniform) {
            param->offset = align_up(offset, info->align);
            offset = param->offset + info->size;
        }
    }
    return align_up(offset, 16);
}

/* A block without live parameters still has 16 bytes, because an empty uniform buffer cannot be
 * bound. */
static void layout_block(struct pipeline *pipeline)
{
    uint32_t live_size = layout_params(pipeline, true, 0);

    pipeline->live_size = live_size ? live_size : 16;
    pipeline->block_size = layout_params(pipeline, false, pipeline->live_size);
}

void layout_model(struct model *model)
{
    struct pipeline *pipeline = &model->pipeline;

    CHANGE_EACH(structure, pipeline->structs, pipeline->struct_count)
        layout_struct(structure);
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        struct resource *resource = &pipeline->resources[i];

        resource->index = i;
        if (resource->kind == DT_BUFFER && resource->structure)
            resource->stride = resource->structure->stride;
        else if (resource->kind == DT_BUFFER)
            resource->stride =
                align_up(type_info(resource->type)->size, type_info(resource->type)->align);
    }
    layout_block(pipeline);
}
