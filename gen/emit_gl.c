/* NAME_gl.c: the OpenGL panel. Fills the slots of templates/c/panel_gl.c.in from the planned model;
 * the text around the slots is the scaffold's. Called by main. */
#include <inttypes.h>

#include "emit_c.h"

/* ---- State ----------------------------------------------------------------------------------- */

static void emit_state(const struct c_output *c)
{
    const struct pipeline *pipeline = c->pipeline;
    bool any = false;

    c_resource_members(c);
    c_sampler_members(c, "GLuint");
    c_program_members(c);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        if (pass_draws(pipeline->order[i])) {
            text_add(c->out, any ? "" : "    struct {\n");
            text_add(c->out, "        GLuint %s;\n", pipeline->order[i]->name);
            any = true;
        }
    }
    text_add(c->out, any ? "    } framebuffers;\n" : "");
}

/* ---- Samplers and programs ------------------------------------------------------------------- */

static void emit_samplers(const struct c_output *c)
{
    static const char *const wraps[] = {[WRAP_CLAMP] = "GL_CLAMP_TO_EDGE",
                                        [WRAP_REPEAT] = "GL_REPEAT",
                                        [WRAP_MIRROR] = "GL_MIRRORED_REPEAT"};

    for (uint32_t i = 0; i < c->pipeline->sampler_count; i++) {
        const struct sampler *sampler = &c->pipeline->samplers[i];

        if (sampler->kind != SAMPLER_FILTER) {
            continue;
        }
        text_add(
            c->out,
            "static bool create_sampler_%s(struct gl_runtime *rt, struct %s_gl_state *state)\n{\n"
            "    const struct gl_sampler_info info = {\n"
            "        .name = \"%s\",\n        .filter = %s,\n        .mip_filter = %s,\n        "
            ".wrap = %s,\n"
            "        .compare = %s,\n        .anisotropy = ",
            sampler->name, c->pipeline->name, sampler->name,
            sampler->linear ? "GL_LINEAR" : "GL_NEAREST",
            sampler->linear_mip ? "GL_LINEAR" : "GL_NEAREST", wraps[sampler->wrap],
            sampler->compare ? "true" : "false");
        c_float(c->out, sampler->anisotropy);
        text_add(
            c->out,
            ",\n    };\n\n    return dt_gl_sampler_create(rt, &state->samplers.%s, &info);\n}\n\n",
            sampler->name);
    }
}

static void emit_draw_state(const struct c_output *c, const struct pass *pass)
{
    static const char *const compares[] = {[COMPARE_OFF] = "GL_ALWAYS",
                                           [COMPARE_LESS] = "GL_LESS",
                                           [COMPARE_LESS_EQUAL] = "GL_LEQUAL",
                                           [COMPARE_GREATER] = "GL_GREATER",
                                           [COMPARE_ALWAYS] = "GL_ALWAYS"};
    static const char *const culls[] = {
        [CULL_NONE] = "GL_NONE", [CULL_BACK] = "GL_BACK", [CULL_FRONT] = "GL_FRONT"};
    bool depth = pass_has_depth(pass) && pass->depth_compare != COMPARE_OFF;

    text_add(c->out, "        .scene_vertices = %s,\n",
             pass->kind == PASS_SCENE ? "true" : "false");
    if (depth) {
        text_add(c->out,
                 "        .depth_test = true,\n        .depth_write = %s,\n        .depth_compare "
                 "= %s,\n",
                 pass->depth_write ? "true" : "false", compares[pass->depth_compare]);
    }
    text_add(c->out, "        .cull = %s,\n        .blend_add = %s,\n", culls[pass->cull],
             pass->blend_add ? "true" : "false");
    if (pass->clip_distances) {
        text_add(c->out, "        .clip_distances = %" PRIu32 ",\n", pass->clip_distances);
    }
}

static void emit_program(const struct c_output *c, const struct pass *pass)
{
    text_add(c->out,
             "static bool create_program_%s(struct gl_runtime *rt, struct %s_gl_state *state)\n{\n"
             "    const struct gl_program_info info = {\n        .name = \"%s\",\n",
             pass->name, c->pipeline->name, pass->name);
    c_stages(c, pass);
    if (pass_draws(pass)) {
        emit_draw_state(c, pass);
    }
    text_add(c->out,
             "    };\n\n    return dt_gl_program_create(rt, &state->programs.%s, &info);\n}\n\n",
             pass->name);
}

static void emit_programs(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        emit_program(c, c->pipeline->order[i]);
    }
}

/* ---- Resources ------------------------------------------------------------------------------- */

static void emit_buffer(const struct c_output *c, const struct resource *buffer)
{
    text_add(c->out,
             "    const struct gl_buffer_info info = {\n        .name = \"%s\",\n"
             "        .size = (GLsizeiptr)extent[0] * ",
             buffer->name);
    c_element(c, c->out, buffer);
    if (buffer->block) {
        text_add(c->out, ",\n        .block = %" PRIu32, buffer->block);
    }
    text_add(c->out,
             ",\n    };\n\n    return dt_gl_buffer_create(rt, &state->buffers.%s, &info) &&\n"
             "           dt_gl_initialise(rt, &state->buffers.%s, NULL, %s);\n}\n\n",
             buffer->name, buffer->name, buffer->history ? "true" : "false");
}

static void emit_image(const struct c_output *c, const struct resource *image)
{
    text_add(
        c->out,
        "    const struct gl_image_info info = {\n        .name = \"%s\",\n        .format = %s,\n"
        "        .width = extent[0],\n        .height = extent[1],\n        .layers = extent[2],\n"
        "        .mips = %" PRIu32 ",\n        .layered = %s,\n",
        image->name, format_info(image->format)->dt,
        expr_value(image->mips, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1),
        image->layers ? "true" : "false");
    if (image->share >= 0) {
        text_add(c->out,
                 "        .share = &state->images.%s, /* is done when this one begins, or the "
                 "reverse */\n",
                 c->pipeline->resources[image->share].name);
    }
    text_add(c->out,
             "    };\n\n    return dt_gl_image_create(rt, &state->images.%s, &info) &&\n"
             "           dt_gl_initialise(rt, NULL, &state->images.%s, %s);\n}\n\n",
             image->name, image->name, image->history ? "true" : "false");
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
}

static void emit_release(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        if (pass_draws(c->pipeline->order[i])) {
            text_add(c->out, "    dt_gl_framebuffer_destroy(rt, &state->framebuffers.%s);\n",
                     c->pipeline->order[i]->name);
        }
    }
    for (uint32_t i = c->pipeline->resource_count; i-- > 0;) {
        const struct resource *resource = &c->pipeline->resources[i];

        text_add(c->out, "    %s(rt, &state->%s.%s);\n",
                 resource->kind == DT_BUFFER ? "dt_gl_buffer_destroy" : "dt_gl_image_destroy",
                 c_group(resource), resource->name);
    }
}

/* Owners of shared textures come first: an image borrows from an earlier one of the spec. */
static void emit_resize(const struct c_output *c)
{
    c_create_resources(c);
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const char *pass = c->pipeline->order[i]->name;

        if (pass_draws(c->pipeline->order[i])) {
            text_add(c->out, "    ok = ok && create_framebuffer_%s(rt, state);\n", pass);
        }
    }
}

static void emit_framebuffers(const struct c_output *c)
{
    c_targets(c);
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const char *pass = c->pipeline->order[i]->name;

        if (pass_draws(c->pipeline->order[i])) {
            text_add(c->out,
                     "static bool create_framebuffer_%s(struct gl_runtime *rt, struct %s_gl_state "
                     "*state)\n{\n"
                     "    const struct gl_targets targets = targets_%s(state);\n\n"
                     "    return dt_gl_framebuffer_create(rt, &state->framebuffers.%s, "
                     "&targets);\n}\n\n",
                     pass, c->pipeline->name, pass, pass);
        }
    }
}

static void emit_destroy(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        text_add(c->out, "    dt_gl_program_destroy(rt, &state->programs.%s);\n",
                 c->pipeline->order[i]->name);
    }
    for (uint32_t i = 0; i < c->pipeline->sampler_count; i++) {
        if (c->pipeline->samplers[i].kind == SAMPLER_FILTER) {
            text_add(c->out, "    dt_gl_sampler_destroy(rt, &state->samplers.%s);\n",
                     c->pipeline->samplers[i].name);
        }
    }
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static void emit_binding(const struct c_output *c, const struct access *access)
{
    text_add(c->out, "        {.binding = %d, ", access->binding);
    if (!access_is_image(access)) {
        text_add(c->out, ".kind = %s, .buffer = &",
                 access->kind & ACCESS_UNIFORM ? "GL_BIND_UNIFORM" : "GL_BIND_STORAGE");
        c_object(c->out, access);
    } else if (access->kind & (ACCESS_FETCH | ACCESS_SAMPLED)) {
        text_add(c->out, ".kind = GL_BIND_TEXTURE, .image = &");
        c_object(c->out, access);
        if (!access->resource) {
            text_add(c->out, ", .sampler = builtin->texture_sampler");
        } else if (access->filter) {
            text_add(c->out, ", .sampler = state->samplers.%s", access->filter->name);
        }
    } else {
        bool reads = access->kind & ACCESS_STORAGE_READ,
             writes = access->kind & ACCESS_STORAGE_WRITE;

        text_add(c->out, ".kind = GL_BIND_IMAGE, .image = &");
        c_object(c->out, access);
        if (access->mip_value) {
            text_add(c->out, ", .mip = %" PRIu32, access->mip_value);
        }
        text_add(c->out, ", .access = %s",
                 reads && writes ? "GL_READ_WRITE"
                 : writes        ? "GL_WRITE_ONLY"
                                 : "GL_READ_ONLY");
    }
    text_add(c->out, "},\n");
}

static void emit_bindings(const struct c_output *c, const struct pass *pass)
{
    text_add(c->out, "    const struct gl_binding bindings[] = {\n");
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (access->binding >= 0 && access->binding != pass->materials_binding &&
            access->binding != pass->textures_binding) {
            emit_binding(c, access);
        }
    }
    text_add(c->out,
             "        {.binding = %d, .kind = GL_BIND_UNIFORM, .buffer = &builtin->frame},\n",
             pass->frame_binding);
    text_add(c->out,
             "        {.binding = %d, .kind = GL_BIND_UNIFORM, .buffer = &builtin->live},\n",
             pass->live_binding);
    if (pass->kind == PASS_SCENE) {
        text_add(c->out,
                 "        {.binding = %d, .kind = GL_BIND_%s, .buffer = &builtin->materials},\n",
                 pass->materials_binding, pass->uniform_materials ? "UNIFORM" : "STORAGE");
        text_add(c->out,
                 "        {.binding = %d, .kind = GL_BIND_TEXTURE, .image = &builtin->textures, "
                 ".sampler = builtin->texture_sampler},\n",
                 pass->textures_binding);
    }
    text_add(c->out, "    };\n");
}

static void emit_bits(struct text *out, unsigned bits)
{
    static const struct {
        unsigned bit;
        const char *name;
    } names[] = {
        {GLB_ELEMENT_ARRAY, "GL_ELEMENT_ARRAY_BARRIER_BIT"},
        {GLB_UNIFORM, "GL_UNIFORM_BARRIER_BIT"},
        {GLB_TEXTURE_FETCH, "GL_TEXTURE_FETCH_BARRIER_BIT"},
        {GLB_SHADER_IMAGE_ACCESS, "GL_SHADER_IMAGE_ACCESS_BARRIER_BIT"},
        {GLB_COMMAND, "GL_COMMAND_BARRIER_BIT"},
        {GLB_TEXTURE_UPDATE, "GL_TEXTURE_UPDATE_BARRIER_BIT"},
        {GLB_BUFFER_UPDATE, "GL_BUFFER_UPDATE_BARRIER_BIT"},
        {GLB_FRAMEBUFFER, "GL_FRAMEBUFFER_BARRIER_BIT"},
        {GLB_SHADER_STORAGE, "GL_SHADER_STORAGE_BARRIER_BIT"},
    };
    bool any = false;

    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++) {
        if (bits & names[i].bit) {
            text_add(out, "%s%s", any ? " | " : "", names[i].name);
            any = true;
        }
    }
}

/* What the pass does when it runs, and instead when it does not, as conditions. */
static void emit_run(const struct c_output *c, const struct pass *pass)
{
    const char *bind = "ok = ok && dt_gl_bind(rt, bindings, DT_ARRAY_COUNT(bindings));\n";
    struct text skip = {0};
    struct c_output inner = *c;

    inner.out = &skip;
    if (!pass->conditional) {
        text_add(c->out, "    %s    ok = ok && ", bind);
        c_work(c, pass);
        text_add(c->out, ";\n");
        return;
    }
    text_add(c->out, "    if (runs) {\n        %s        ok = ok && ", bind);
    c_work(c, pass);
    c_skip(&inner, pass, " &&\n             ");
    text_add(c->out, skip.data ? ";\n    } else {\n        ok = ok && %s;\n    }\n" : ";\n    }\n",
             skip.data);
    text_free(&skip);
}

static void emit_pass(const struct c_output *c, const struct pass *pass, unsigned bits)
{
    struct text locals = {0}, body = {0};
    struct c_output top = *c, inner = *c;

    top.out = &locals;
    text_add(&locals, "    const struct gl_builtin *builtin = dt_gl_builtin(rt);\n");
    emit_bindings(&top, pass);

    inner.out = &body;
    text_add(&body, "    bool ok = dt_gl_pass_begin(rt, ");
    c_enumerator(&inner, "PASS", pass->name);
    text_add(&body, ", %s);\n\n", pass->conditional ? "runs" : "true");
    if (bits) {
        text_add(&body, "    ok = ok && dt_gl_barrier(rt, ");
        emit_bits(&body, bits);
        text_add(&body, ");\n");
    }
    emit_run(&inner, pass);
    text_add(&body, "    return ok && dt_gl_pass_end(rt, ");
    c_enumerator(&inner, "PASS", pass->name);
    text_add(&body, ");\n");

    c_pass(c, pass, &locals, &body);
    text_free(&locals);
    text_free(&body);
}

static void emit_passes(const struct c_output *c)
{
    uint32_t count = c->pipeline->pass_count;
    unsigned *bits = arena_alloc(c->model->arena, count * sizeof *bits + 1);

    if (!bits) {
        c->out->failed = true;
        return;
    }
    plan_gl_bits(c->model, bits);
    for (uint32_t i = 0; i < count; i++) {
        emit_pass(c, c->pipeline->order[i], bits[i]);
    }
}

void emit_c_gl(const struct model *model, const struct pass_shaders *shaders, struct text *out)
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
        {"targets", emit_framebuffers},
        {"release", emit_release},
        {"resize", emit_resize},
        {"resources", c_slot_resources},
        {"destroy", emit_destroy},
        {"passes", emit_passes},
        {"record", c_slot_record},
    };
    struct c_output c = {.model = model,
                         .pipeline = &model->pipeline,
                         .shaders = shaders,
                         .backend = BACKEND_GL,
                         .out = out};

    c_scaffold(&c, scaffold_panel_gl, slots, DT_ARRAY_COUNT(slots));
}
