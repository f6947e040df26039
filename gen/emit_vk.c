/* NAME_vk.c: the Vulkan panel. Fills the slots of templates/c/panel_vk.c.in from the planned model;
 * the text around the slots is the scaffold's. Called by main. */
#include <inttypes.h>

#include "emit_c.h"

struct flag {
    unsigned bit;
    const char *name;
};

/* "A | B", or `none`. */
static void emit_flags(struct text *out, unsigned mask, const struct flag *flags, size_t count,
                       const char *none)
{
    bool any = false;

    for (size_t i = 0; i < count; i++) {
        if (mask & flags[i].bit) {
            text_add(out, "%s%s", any ? " | " : "", flags[i].name);
            any = true;
        }
    }
    text_add(out, "%s", any ? "" : none);
}

static const char *layout_name(unsigned kind)
{
    static const char *const names[] = {
        [LAYOUT_GENERAL] = "VK_IMAGE_LAYOUT_GENERAL",
        [LAYOUT_READ] = "VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL",
        [LAYOUT_COLOR] = "VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL",
        [LAYOUT_DEPTH] = "VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL",
    };

    return names[layout_of(kind)];
}

/* Everything that one pass does to one resource: an image has one layout in a pass. */
static unsigned kinds_in_pass(const struct pass *pass, const struct resource *resource)
{
    unsigned kinds = 0;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        kinds |= pass->accesses[i].resource == resource ? pass->accesses[i].kind : 0;
    }
    return kinds;
}

/* ---- State ----------------------------------------------------------------------------------- */

static void emit_state(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;

    c_resource_members(c);
    if (pipeline->slot_count) {
        text_add(c->out, "    struct vk_slot slots[%" PRIu32 "];\n", pipeline->slot_count);
    }
    if (has_fetch(pipeline)) {
        text_add(c->out,
                 "    VkSampler texel_sampler; /* for texelFetch, which filters nothing */\n");
    }
    c_sampler_members(c, "VkSampler");
    c_program_members(c);
}

/* ---- Samplers -------------------------------------------------------------------------------- */

static void emit_samplers(const struct c_output *c)
{
    static const char *const wraps[] = {[WRAP_CLAMP] = "VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE",
                                        [WRAP_REPEAT] = "VK_SAMPLER_ADDRESS_MODE_REPEAT",
                                        [WRAP_MIRROR] = "VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT"};

    if (has_fetch(c->pipeline)) {
        text_add(c->out,
                 "static bool create_texel_sampler(struct vk_runtime *rt, struct %s_vk_state "
                 "*state)\n{\n"
                 "    const struct vk_sampler_info info = {\n        .name = \"texel\",\n"
                 "        .filter = VK_FILTER_NEAREST,\n"
                 "        .mip_filter = VK_SAMPLER_MIPMAP_MODE_NEAREST,\n"
                 "        .wrap = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,\n        .anisotropy = "
                 "1.0f,\n    };\n\n"
                 "    return dt_vk_sampler_create(rt, &state->texel_sampler, &info);\n}\n\n",
                 c->pipeline->name);
    }
    for (uint32_t i = 0; i < c->pipeline->sampler_count; i++) {
        const struct sampler *sampler = &c->pipeline->samplers[i];

        if (sampler->kind != SAMPLER_FILTER) {
            continue;
        }
        text_add(
            c->out,
            "static bool create_sampler_%s(struct vk_runtime *rt, struct %s_vk_state *state)\n{\n"
            "    const struct vk_sampler_info info = {\n"
            "        .name = \"%s\",\n        .filter = %s,\n        .mip_filter = %s,\n        "
            ".wrap = %s,\n"
            "        .compare = %s,\n        .anisotropy = ",
            sampler->name, c->pipeline->name, sampler->name,
            sampler->linear ? "VK_FILTER_LINEAR" : "VK_FILTER_NEAREST",
            sampler->linear_mip ? "VK_SAMPLER_MIPMAP_MODE_LINEAR"
                                : "VK_SAMPLER_MIPMAP_MODE_NEAREST",
            wraps[sampler->wrap], sampler->compare ? "true" : "false");
        c_float(c->out, sampler->anisotropy);
        text_add(
            c->out,
            ",\n    };\n\n    return dt_vk_sampler_create(rt, &state->samplers.%s, &info);\n}\n\n",
            sampler->name);
    }
}

/* ---- Programs -------------------------------------------------------------------------------- */

static const char *descriptor_type(const struct access *access)
{
    if (access->kind & (ACCESS_FETCH | ACCESS_SAMPLED)) {
        return "VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER";
    }
    if (access->kind & ACCESS_UNIFORM) {
        return "VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER";
    }
    return access_is_image(access) ? "VK_DESCRIPTOR_TYPE_STORAGE_IMAGE"
                                   : "VK_DESCRIPTOR_TYPE_STORAGE_BUFFER";
}

static const char *materials_type(const struct pass *pass)
{
    return pass->uniform_materials ? "VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER"
                                   : "VK_DESCRIPTOR_TYPE_STORAGE_BUFFER";
}

/* A scene draw always binds materials and textures, also when its reads name them. */
static bool has_own_binding(const struct pass *pass, const struct access *access)
{
    return access->binding >= 0 && access->binding != pass->materials_binding &&
           access->binding != pass->textures_binding;
}

static void emit_binding_slots(const struct c_output *c, const struct pass *pass)
{
    text_add(c->out, "    static const struct vk_binding_slot slots[] = {\n");
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (has_own_binding(pass, access)) {
            text_add(c->out, "        {%d, %s},\n", access->binding, descriptor_type(access));
        }
    }
    text_add(c->out, "        {%d, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},\n", pass->frame_binding);
    text_add(c->out, "        {%d, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},\n", pass->live_binding);
    if (pass->kind == PASS_SCENE) {
        text_add(c->out, "        {%d, %s},\n", pass->materials_binding, materials_type(pass));
        text_add(c->out, "        {%d, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER},\n",
                 pass->textures_binding);
    }
    text_add(c->out, "    };\n");
}

static void emit_formats(const struct c_output *c, const struct pass *pass)
{
    uint32_t colors = 0;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (access->kind & ACCESS_COLOR) {
            text_add(c->out, "        .color_formats[%d] = %s,\n", access->attachment,
                     format_info(access->resource->format)->vk);
            colors++;
        } else if (access->kind & ACCESS_DEPTH) {
            text_add(c->out, "        .depth_format = %s,\n",
                     format_info(access->resource->format)->vk);
        }
    }
    text_add(c->out, "        .color_count = %" PRIu32 ",\n", colors);
}

static void emit_draw_state(const struct c_output *c, const struct pass *pass)
{
    static const char *const compares[] = {[COMPARE_OFF] = "VK_COMPARE_OP_ALWAYS",
                                           [COMPARE_LESS] = "VK_COMPARE_OP_LESS",
                                           [COMPARE_LESS_EQUAL] = "VK_COMPARE_OP_LESS_OR_EQUAL",
                                           [COMPARE_GREATER] = "VK_COMPARE_OP_GREATER",
                                           [COMPARE_ALWAYS] = "VK_COMPARE_OP_ALWAYS"};
    static const char *const culls[] = {[CULL_NONE] = "VK_CULL_MODE_NONE",
                                        [CULL_BACK] = "VK_CULL_MODE_BACK_BIT",
                                        [CULL_FRONT] = "VK_CULL_MODE_FRONT_BIT"};

    text_add(c->out, "        .scene_vertices = %s,\n",
             pass->kind == PASS_SCENE ? "true" : "false");
    emit_formats(c, pass);
    if (pass_has_depth(pass) && pass->depth_compare != COMPARE_OFF) {
        text_add(c->out,
                 "        .depth_test = true,\n        .depth_write = %s,\n        .depth_compare "
                 "= %s,\n",
                 pass->depth_write ? "true" : "false", compares[pass->depth_compare]);
    }
    text_add(c->out, "        .cull = %s,\n        .blend_add = %s,\n", culls[pass->cull],
             pass->blend_add ? "true" : "false");
}

static void emit_program(const struct c_output *c, const struct pass *pass)
{
    text_add(c->out,
             "static bool create_program_%s(struct vk_runtime *rt, struct %s_vk_state *state)\n{\n",
             pass->name, c->pipeline->name);
    emit_binding_slots(c, pass);
    text_add(c->out, "    const struct vk_program_info info = {\n        .name = \"%s\",\n",
             pass->name);
    c_stages(c, pass);
    text_add(c->out, "        .slots = slots,\n        .slot_count = DT_ARRAY_COUNT(slots),\n");
    if (pass_draws(pass)) {
        emit_draw_state(c, pass);
    }
    text_add(c->out,
             "    };\n\n    return dt_vk_program_create(rt, &state->programs.%s, &info);\n}\n\n",
             pass->name);
}

static void emit_programs(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        emit_program(c, c->pipeline->order[i]);
    }
}

/* ---- Resources ------------------------------------------------------------------------------- */

static void emit_usage(struct text *out, const struct resource *resource)
{
    static const struct flag buffer_flags[] = {
        {ACCESS_STORAGE_READ | ACCESS_STORAGE_WRITE, "VK_BUFFER_USAGE_STORAGE_BUFFER_BIT"},
        {ACCESS_UNIFORM, "VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT"},
        {ACCESS_INDIRECT, "VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT"},
        {ACCESS_INDEX, "VK_BUFFER_USAGE_INDEX_BUFFER_BIT"},
    };
    static const struct flag image_flags[] = {
        {ACCESS_STORAGE_READ | ACCESS_STORAGE_WRITE, "VK_IMAGE_USAGE_STORAGE_BIT"},
        {ACCESS_FETCH | ACCESS_SAMPLED, "VK_IMAGE_USAGE_SAMPLED_BIT"},
        {ACCESS_COLOR, "VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT"},
        {ACCESS_DEPTH, "VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT"},
    };

    if (resource->kind == DT_BUFFER) {
        emit_flags(out, resource->usage, buffer_flags, DT_ARRAY_COUNT(buffer_flags),
                   "VK_BUFFER_USAGE_STORAGE_BUFFER_BIT");
    } else {
        emit_flags(out, resource->usage, image_flags, DT_ARRAY_COUNT(image_flags),
                   "VK_IMAGE_USAGE_SAMPLED_BIT");
    }
}

static void emit_buffer(const struct c_output *c, const struct resource *buffer)
{
    text_add(c->out,
             "    const struct vk_buffer_info info = {\n        .name = \"%s\",\n"
             "        .size = (VkDeviceSize)extent[0] * ",
             buffer->name);
    c_element(c, c->out, buffer);
    if (buffer->block) {
        text_add(c->out, ",\n        .block = %" PRIu32, buffer->block);
    }
    text_add(c->out, ",\n        .usage = ");
    emit_usage(c->out, buffer);
    text_add(c->out,
             ",\n    };\n\n    return dt_vk_buffer_create(rt, &state->buffers.%s, &info);\n}\n\n",
             buffer->name);
}

static void emit_image(const struct c_output *c, const struct resource *image)
{
    text_add(
        c->out,
        "    const struct vk_image_info info = {\n        .name = \"%s\",\n        .format = %s,\n"
        "        .usage = ",
        image->name, format_info(image->format)->dt);
    emit_usage(c->out, image);
    text_add(c->out,
             ",\n        .width = extent[0],\n        .height = extent[1],\n        .layers = "
             "extent[2],\n"
             "        .mips = %" PRIu32 ",\n        .layered = %s,\n    };\n\n"
             "    return dt_vk_image_create(rt, &state->images.%s, &info);\n}\n\n",
             expr_value(image->mips, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1),
             image->layers ? "true" : "false", image->name);
}

static void emit_user(const struct c_output *c, const struct resource *resource)
{
    text_add(c->out, "{.%s = &state->%s.%s}", c_kind(resource), c_group(resource), resource->name);
}

static void emit_memory(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;

    text_add(c->out, "/* Resources of one slot are never alive in the same pass. */\n");
    for (uint32_t slot = 0; slot < pipeline->slot_count; slot++) {
        text_add(c->out,
                 "static bool bind_slot_%" PRIu32
                 "(struct vk_runtime *rt, struct %s_vk_state *state)\n{\n"
                 "    const struct vk_slot_user users[] = {\n",
                 slot, pipeline->name);
        for (uint32_t i = 0; i < pipeline->resource_count; i++) {
            if (pipeline->resources[i].slot == slot) {
                text_add(c->out, "        ");
                emit_user(c, &pipeline->resources[i]);
                text_add(c->out, ",\n");
            }
        }
        text_add(c->out,
                 "    };\n\n    return dt_vk_slot_bind(rt, &state->slots[%" PRIu32
                 "], users, DT_ARRAY_COUNT(users));\n}\n\n",
                 slot);
    }
    text_add(c->out,
             "static bool initialise(struct vk_runtime *rt, struct %s_vk_state *state)\n{\n    "
             "bool ok = true;\n\n",
             pipeline->name);
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        text_add(c->out, "    ok = ok && dt_vk_initialise(rt, &(struct vk_slot_user)");
        emit_user(c, &pipeline->resources[i]);
        text_add(c->out, ", %s);\n", pipeline->resources[i].history ? "true" : "false");
    }
    text_add(c->out, "    return ok;\n}\n\n");
}

static void emit_create_resources(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        const struct resource *resource = &c->pipeline->resources[i];

        c_create_head(c, resource);
        if (resource->kind == DT_BUFFER) {
            emit_buffer(c, resource);
        } else {
            emit_image(c, resource);
        }
    }
    if (c->pipeline->resource_count) {
        emit_memory(c);
    }
}

/* ---- Descriptors ----------------------------------------------------------------------------- */

static void emit_binding(const struct c_output *c, const struct pass *pass,
                         const struct access *access)
{
    bool texture = access->kind & (ACCESS_FETCH | ACCESS_SAMPLED);

    text_add(c->out, "        {.binding = %d,\n         .type = %s,\n         .%s = &",
             access->binding, descriptor_type(access),
             access_is_image(access) ? "image" : "buffer");
    c_object(c->out, access);
    if (!access_is_image(access)) {
        text_add(c->out, "},\n");
        return;
    }
    if (texture && !access_sees_one_mip(access)) {
        text_add(c->out, ",\n         .mip = VK_ALL_MIPS");
    } else if (access->mip_value) {
        text_add(c->out, ",\n         .mip = %" PRIu32, access->mip_value);
    }
    text_add(
        c->out, ",\n         .layout = %s",
        layout_name(access->resource ? kinds_in_pass(pass, access->resource) : ACCESS_SAMPLED));
    if (!access->resource) {
        text_add(c->out, ",\n         .sampler = builtin->texture_sampler");
    } else if (texture && access->filter) {
        text_add(c->out, ",\n         .sampler = state->samplers.%s", access->filter->name);
    } else if (texture) {
        text_add(c->out, ",\n         .sampler = state->texel_sampler");
    }
    text_add(c->out, "},\n");
}

static void emit_bind(const struct c_output *c, const struct pass *pass)
{
    static const char *const block =
        "        {.binding = %d,\n         .type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,\n"
        "         .buffer = &builtin->%s},\n";

    text_add(
        c->out,
        "static bool bind_program_%s(struct vk_runtime *rt, struct %s_vk_state *state)\n{\n"
        "    const struct vk_builtin *builtin = dt_vk_builtin(rt);\n    const struct vk_binding "
        "bindings[] = {\n",
        pass->name, c->pipeline->name);
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (has_own_binding(pass, &pass->accesses[i])) {
            emit_binding(c, pass, &pass->accesses[i]);
        }
    }
    text_add(c->out, block, pass->frame_binding, "frame");
    text_add(c->out, block, pass->live_binding, "live");
    if (pass->kind == PASS_SCENE) {
        text_add(c->out,
                 "        {.binding = %d,\n         .type = %s,\n"
                 "         .buffer = &builtin->materials},\n",
                 pass->materials_binding, materials_type(pass));
        text_add(
            c->out,
            "        {.binding = %d,\n         .type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,\n"
            "         .image = &builtin->textures,\n         .mip = VK_ALL_MIPS,\n"
            "         .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,\n"
            "         .sampler = builtin->texture_sampler},\n",
            pass->textures_binding);
    }
    text_add(c->out,
             "    };\n\n    return dt_vk_program_bind(rt, &state->programs.%s, bindings, "
             "DT_ARRAY_COUNT(bindings));\n}\n\n",
             pass->name);
}

static void emit_binds(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        emit_bind(c, c->pipeline->order[i]);
    }
}

/* ---- Calls in create, resize and destroy ----------------------------------------------------- */

static void emit_release(const struct c_output *c)
{
    for (uint32_t i = c->pipeline->resource_count; i-- > 0;) {
        const struct resource *resource = &c->pipeline->resources[i];

        text_add(c->out, "    %s(rt, &state->%s.%s);\n",
                 resource->kind == DT_BUFFER ? "dt_vk_buffer_destroy" : "dt_vk_image_destroy",
                 c_group(resource), resource->name);
    }
    if (c->pipeline->slot_count) {
        text_add(c->out, "    for (size_t i = 0; i < DT_ARRAY_COUNT(state->slots); i++)\n"
                         "        dt_vk_slot_destroy(rt, &state->slots[i]);\n");
    }
}

static void emit_resize(const struct c_output *c)
{
    c_create_resources(c);
    for (uint32_t slot = 0; slot < c->pipeline->slot_count; slot++) {
        text_add(c->out, "    ok = ok && bind_slot_%" PRIu32 "(rt, state);\n", slot);
    }
    if (c->pipeline->resource_count) {
        text_add(c->out, "    ok = ok && initialise(rt, state);\n");
    }
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        text_add(c->out, "    ok = ok && bind_program_%s(rt, state);\n",
                 c->pipeline->order[i]->name);
    }
}

static void emit_destroy(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        text_add(c->out, "    dt_vk_program_destroy(rt, &state->programs.%s);\n",
                 c->pipeline->order[i]->name);
    }
    for (uint32_t i = 0; i < c->pipeline->sampler_count; i++) {
        if (c->pipeline->samplers[i].kind == SAMPLER_FILTER) {
            text_add(c->out, "    dt_vk_sampler_destroy(rt, &state->samplers.%s);\n",
                     c->pipeline->samplers[i].name);
        }
    }
    if (has_fetch(c->pipeline)) {
        text_add(c->out, "    dt_vk_sampler_destroy(rt, &state->texel_sampler);\n");
    }
}

/* ---- Barriers -------------------------------------------------------------------------------- */

/* Clears: vkCmdFillBuffer runs in the stage of clears or in that of copies, depending on whom one asks
 * (validation layers 1.3.239: copies). */
static void emit_stages(struct text *out, unsigned stages)
{
    static const struct flag flags[] = {
        {STAGE_COMPUTE, "VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT"},
        {STAGE_VERTEX, "VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT"},
        {STAGE_FRAGMENT, "VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT"},
        {STAGE_COLOR, "VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT"},
        {STAGE_DEPTH, "VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT"},
        {STAGE_DEPTH, "VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT"},
        {STAGE_INDIRECT, "VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT"},
        {STAGE_INDEX, "VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT"},
        {STAGE_CLEAR, "VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT"},
    };

    emit_flags(out, stages, flags, DT_ARRAY_COUNT(flags), "VK_PIPELINE_STAGE_2_NONE");
}

static const struct flag write_flags[] = {
    {ACCESS_STORAGE_WRITE, "VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT"},
    {ACCESS_COLOR, "VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT"},
    {ACCESS_DEPTH, "VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT"},
    {ACCESS_CLEAR, "VK_ACCESS_2_TRANSFER_WRITE_BIT"},
};

/* A colour target is read when its content is kept or blended with; the depth test reads always. */
static void emit_accesses(struct text *out, const struct barrier *barrier, const struct pass *pass)
{
    enum { COLOR_READ = 1 << 30 };
    static const struct flag flags[] = {
        {ACCESS_STORAGE_READ, "VK_ACCESS_2_SHADER_STORAGE_READ_BIT"},
        {ACCESS_STORAGE_WRITE, "VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT"},
        {ACCESS_FETCH | ACCESS_SAMPLED, "VK_ACCESS_2_SHADER_SAMPLED_READ_BIT"},
        {ACCESS_UNIFORM, "VK_ACCESS_2_UNIFORM_READ_BIT"},
        {COLOR_READ, "VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT"},
        {ACCESS_COLOR, "VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT"},
        {ACCESS_DEPTH, "VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT"},
        {ACCESS_DEPTH, "VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT"},
        {ACCESS_INDIRECT, "VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT"},
        {ACCESS_INDEX, "VK_ACCESS_2_INDEX_READ_BIT"},
        {ACCESS_CLEAR, "VK_ACCESS_2_TRANSFER_WRITE_BIT"},
    };
    unsigned kinds = barrier->to;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (access->resource == barrier->resource && access->kind & barrier->to & ACCESS_COLOR &&
            (access->mode == MODE_UPDATE || pass->blend_add)) {
            kinds |= COLOR_READ;
        }
    }
    emit_flags(out, kinds, flags, DT_ARRAY_COUNT(flags), "VK_ACCESS_2_NONE");
}

static void emit_barrier(const struct c_output *c, const struct pass *pass,
                         const struct barrier *barrier)
{
    const struct resource *resource = barrier->resource;

    text_add(c->out, "        {.%s = &state->%s.%s,", c_kind(resource), c_group(resource),
             resource->name);
    if (barrier->alias) {
        text_add(c->out, " /* in the memory of %s */", barrier->alias->name);
    }
    text_add(c->out, "\n         .src_stage = ");
    emit_stages(c->out, barrier->from_stages);
    text_add(c->out, ",\n         .src_access = ");
    emit_flags(c->out, barrier->from_writes ? barrier->from : 0, write_flags,
               DT_ARRAY_COUNT(write_flags), "VK_ACCESS_2_NONE");
    text_add(c->out, ",\n         .dst_stage = ");
    emit_stages(c->out, barrier->to_stages);
    text_add(c->out, ",\n         .dst_access = ");
    emit_accesses(c->out, barrier, pass);
    if (resource->kind == DT_IMAGE) {
        text_add(c->out, ",\n         .layout = %s", layout_name(kinds_in_pass(pass, resource)));
        text_add(c->out, barrier->discard ? ",\n         .discard = true" : "");
    }
    text_add(c->out, "},\n");
}

static void emit_barriers(const struct c_output *c, const struct pass *pass)
{
    if (!pass->barrier_count) {
        return;
    }
    text_add(c->out, "    const struct vk_barrier barriers[] = {\n");
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        emit_barrier(c, pass, &pass->barriers[i]);
    }
    text_add(c->out, "    };\n");
}

/* ---- Passes ---------------------------------------------------------------------------------- */

/* What the pass does when it runs, and instead when it does not. */
static void emit_run(const struct c_output *c, const struct pass *pass)
{
    struct text skip = {0};
    struct c_output inner = *c;

    inner.out = &skip;
    if (!pass->conditional) {
        text_add(c->out, "    ");
        c_work(c, pass);
        text_add(c->out, ";\n");
        return;
    }
    text_add(c->out, "    if (runs) {\n        ");
    c_work(c, pass);
    c_skip(&inner, pass, ";\n        ");
    text_add(c->out, skip.data ? ";\n    } else {\n        %s;\n    }\n" : ";\n    }\n", skip.data);
    text_free(&skip);
}

static void emit_pass(const struct c_output *c, const struct pass *pass)
{
    struct text locals = {0}, body = {0};
    struct c_output top = *c, inner = *c;

    top.out = &locals;
    emit_barriers(&top, pass);

    inner.out = &body;
    text_add(&body, "\n    if (!dt_vk_pass_begin(rt, ");
    c_enumerator(&inner, "PASS", pass->name);
    text_add(&body, ", %s))\n        return false;\n", pass->conditional ? "runs" : "true");
    if (pass->barrier_count) {
        text_add(&body, "    dt_vk_barriers(rt, barriers, DT_ARRAY_COUNT(barriers));\n");
    }
    emit_run(&inner, pass);
    text_add(&body, "    return dt_vk_pass_end(rt, ");
    c_enumerator(&inner, "PASS", pass->name);
    text_add(&body, ");\n");

    c_pass(c, pass, &locals, &body);
    text_free(&locals);
    text_free(&body);
}

static void emit_passes(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        emit_pass(c, c->pipeline->order[i]);
    }
}

static void emit_targets_and_binds(const struct c_output *c)
{
    c_targets(c);
    emit_binds(c);
}

void emit_c_vk(const struct model *model, const struct pass_shaders *shaders, struct text *out)
{
    static const struct c_slot slots[] = {
        {"name", c_slot_name},
        {"spec", c_slot_spec},
        {"doc", c_slot_doc},
        {"state", emit_state},
        {"shaders", c_slot_shaders},
        {"samplers", emit_samplers},
        {"programs", emit_programs},
        {"create", c_slot_create},
        {"create_resources", emit_create_resources},
        {"targets", emit_targets_and_binds},
        {"release", emit_release},
        {"resize", emit_resize},
        {"resources", c_slot_resources},
        {"destroy", emit_destroy},
        {"passes", emit_passes},
        {"record", c_slot_record},
        {"needs", c_slot_needs},
        {"panel_needs", c_slot_panel_needs},
    };
    struct c_output c = {.model = model,
                         .pipeline = &model->pipeline,
                         .shaders = shaders,
                         .backend = BACKEND_VK,
                         .out = out};

    c_scaffold(&c, scaffold_panel_vk, slots, DT_ARRAY_COUNT(slots));
}
