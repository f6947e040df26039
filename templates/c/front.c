/* Checks above every backend, and the walk over a panel's tables; see front.h. Compiled into each
 * runtime. */
#include "front.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device_needs.h"
#include "formats.h"

/* ---- Messages -------------------------------------------------------------------------------- */

static void log_list(const struct dt_core *core, enum dt_level level, const char *format,
                     va_list list)
{
    va_list again;
    char line[1024], *text = line;
    va_copy(again, list);
    int length = vsnprintf(line, sizeof line, format, list);
    if (length >= (int)sizeof line && (text = malloc((size_t)length + 1)))
        vsnprintf(text, (size_t)length + 1, format, again);
    if (core->log.message)
        core->log.message(core->log.user, level, text ? text : line);
    if (text != line)
        free(text);
    va_end(again);
}

void dt_log(const struct dt_core *core, enum dt_level level, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    log_list(core, level, format, list);
    va_end(list);
}

bool dt_error(const struct dt_core *core, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    log_list(core, DT_ERROR, format, list);
    va_end(list);
    return false;
}

/* ---- Around every verb ----------------------------------------------------------------------- */

static bool enter(struct dt_core *core)
{
    return !core->backend->enter || core->backend->enter(core);
}

/* Restores a host's state. True if that and the verb succeeded. */
static bool leave(struct dt_core *core, bool good)
{
    return (!core->backend->leave || core->backend->leave(core)) && good;
}

/* ---- Limits ---------------------------------------------------------------------------------- */

static const char *const limit_words[DT_LIMITS] = {
#define ROW(name, words, ...) [DT_LIMIT_##name] = (words),
    DT_DEVICE_LIMITS(ROW)
#undef ROW
};

/* 80000 as "80,000". */
static const char *grouped(uint64_t number, char text[32])
{
    char *at = text + 31;
    *at = '\0';
    for (int digits = 0; digits == 0 || number; digits++, number /= 10) {
        if (digits && digits % 3 == 0)
            *--at = ',';
        *--at = (char)('0' + number % 10);
    }
    return at;
}

static void describe_lack(const char *pass, enum dt_device_limit limit, uint64_t needed,
                          uint64_t most, const char *device, char *text, size_t size)
{
    char numbers[2][32];
    snprintf(text, size, "pass %s needs %s %s; the device %s has %s", pass,
             grouped(needed, numbers[0]), limit_words[limit], device, grouped(most, numbers[1]));
}

bool dt_front_suits(const struct dt_panel *panel, const struct dt_limits *limits,
                    const char *device, char *text, size_t size)
{
    for (uint32_t pass = 0; pass < panel->pipeline->pass_count; pass++)
        for (int i = 0; i < DT_LIMITS; i++) {
            uint64_t needed = dt_demand_of(panel, pass, (enum dt_device_limit)i);
            if (needed <= limits->most[i])
                continue;
            describe_lack(panel->pipeline->passes[pass].name, (enum dt_device_limit)i, needed,
                          limits->most[i], device, text, size);
            return false;
        }
    return true;
}

/* Whether the device has as much as a pass needs; if not, logs it. */
static bool has_limit(const struct dt_core *core, uint32_t pass, enum dt_device_limit limit,
                      uint64_t needed)
{
    char text[512];
    if (needed <= core->limits.most[limit])
        return true;
    describe_lack(dt_pass_name(core, pass), limit, needed, core->limits.most[limit],
                  core->device.name, text, sizeof text);
    return dt_error(core, "%s", text);
}

static bool check_program(const struct dt_core *core, const struct dt_panel *panel, uint32_t pass)
{
    const struct dt_program *program = &panel->programs[pass];
    const char *name = panel->pipeline->passes[pass].name;
    if (program->color_count > DT_MAX_COLOR_TARGETS)
        return dt_error(core, "pass %s: %u color targets, but the limit is %d; split the pass",
                        name, program->color_count, DT_MAX_COLOR_TARGETS);
    return program->binding_count <= DT_MAX_BINDINGS ||
           dt_error(core, "pass %s: %u resources, but at most %d can be bound; split the pass",
                    name, program->binding_count, DT_MAX_BINDINGS);
}

static bool check_sampler(const struct dt_core *core, const struct dt_sampler *sampler)
{
    return sampler->anisotropy <= core->limits.anisotropy ||
           dt_error(core, "sampler %s: anisotropy %g, but %s allows up to %g; use less",
                    sampler->name, (double)sampler->anisotropy, core->device.name,
                    (double)core->limits.anisotropy);
}

/* Before create changes anything: on false the pipeline before stays. */
static bool check_panel(struct dt_core *core, const struct dt_panel *panel)
{
    char text[512];
    for (uint32_t i = 0; i < panel->pipeline->pass_count; i++)
        if (!check_program(core, panel, i))
            return false;
    for (uint32_t i = 0; i < panel->sampler_count; i++)
        if (!check_sampler(core, &panel->samplers[i]))
            return false;
    if (!dt_front_suits(panel, &core->limits, core->device.name, text, sizeof text))
        return dt_error(core, "%s", text);
    return core->backend->suits(core, panel);
}

static uint32_t full_mips(const struct dt_resource *image, const uint32_t extent[3])
{
    uint32_t mips = 1;
    uint32_t size = extent[0] > extent[1] ? extent[0] : extent[1];
    if (image->shape == DT_SHAPE_3D && extent[2] > size)
        size = extent[2];
    for (; size > 1; size /= 2)
        mips++;
    return mips;
}

static bool check_image(const struct dt_core *core, const struct dt_resource *image, unsigned usage,
                        const uint32_t extent[3])
{
    const uint64_t *most = core->limits.most;
    bool volume = image->shape == DT_SHAPE_3D;
    uint32_t side = (uint32_t)most[volume                        ? DT_LIMIT_VOLUME_SIDE
                                   : image->shape != DT_SHAPE_2D ? DT_LIMIT_CUBE_SIDE
                                                                 : DT_LIMIT_IMAGE_SIDE];
    uint32_t layers = volume ? side : image->layered ? (uint32_t)most[DT_LIMIT_IMAGE_LAYERS] : 1;
    uint32_t width = (uint32_t)most[DT_LIMIT_TARGET_WIDTH];
    uint32_t height = (uint32_t)most[DT_LIMIT_TARGET_HEIGHT];
    if (extent[0] > side || extent[1] > side)
        return dt_error(core,
                        "image %s: %ux%u texels, but %s allows 1x1 to %ux%u; choose another size",
                        image->name, extent[0], extent[1], core->device.name, side, side);
    if (extent[2] > layers)
        return dt_error(core, "image %s: %u layers, but %s allows 1 to %u; choose another number",
                        image->name, extent[2], core->device.name, layers);
    if (image->mips < 1 || image->mips > full_mips(image, extent))
        return dt_error(core, "image %s: %u mips, but %ux%u texels have 1 to %u", image->name,
                        image->mips, extent[0], extent[1], full_mips(image, extent));
    if (usage & (DT_WRITE_COLOR | DT_WRITE_DEPTH) && (extent[0] > width || extent[1] > height))
        return dt_error(core,
                        "image %s: %ux%u texels, but %s draws into at most %ux%u; choose "
                        "another size",
                        image->name, extent[0], extent[1], core->device.name, width, height);
    return true;
}

static bool check_buffer(const struct dt_core *core, const struct dt_resource *buffer,
                         const struct dt_storage *storage, uint32_t count)
{
    uint64_t storage_bytes = core->limits.most[DT_LIMIT_STORAGE_BYTES];
    uint64_t uniform_bytes = core->limits.most[DT_LIMIT_UNIFORM_BYTES];
    uint64_t bytes = (uint64_t)count * buffer->stride;
    uint64_t block = storage->block > bytes ? storage->block : bytes;
    if (storage->usage & (DT_READ_STORAGE | DT_WRITE_STORAGE) && bytes > storage_bytes)
        return dt_error(core,
                        "buffer %s: %llu bytes, but %s binds at most %llu; use fewer elements",
                        buffer->name, (unsigned long long)bytes, core->device.name,
                        (unsigned long long)storage_bytes);
    if (storage->usage & DT_READ_UNIFORM && block > uniform_bytes)
        return dt_error(core,
                        "buffer %s: %llu bytes, but %s allows %llu in a uniform block; make it a "
                        "storage buffer",
                        buffer->name, (unsigned long long)block, core->device.name,
                        (unsigned long long)uniform_bytes);
    return true;
}

/* ---- The pipeline ---------------------------------------------------------------------------- */

/* The previous panel's programs, kept while the next panel is created. */
struct made {
    struct dt_shaders shaders;
    void *programs;
};

const uint32_t *dt_front_words(const struct dt_code *code, uint32_t **own)
{
    *own = NULL;
    if (code->words)
        return code->words;
    const uint8_t *at = code->packed;
    if (!(*own = malloc(code->size)))
        return NULL;
    for (size_t i = 0; i < code->size / sizeof **own; i++) {
        (*own)[i] = 0;
        for (unsigned shift = 0, more = 1; more; shift += 7) {
            (*own)[i] |= (*at & 0x7fU) << shift;
            more = *at++ & 0x80;
        }
    }
    return *own;
}

/* Bytes of packed words. */
static size_t packed_size(const struct dt_code *code)
{
    size_t size = 0;
    for (size_t words = code->size / sizeof *code->words; words > 0; size++)
        words -= !(code->packed[size] & 0x80);
    return size;
}

static bool same_words(const struct dt_code *a, const struct dt_code *b)
{
    if (!a->size || a->words || b->words)
        return !a->size || (a->words && b->words && memcmp(a->words, b->words, a->size) == 0);
    size_t size = packed_size(a);
    return packed_size(b) == size && memcmp(a->packed, b->packed, size) == 0;
}

static bool same_code(const struct dt_code *a, const struct dt_code *b)
{
    if (a->size != b->size || !a->glsl != !b->glsl)
        return false;
    return same_words(a, b) && (!a->glsl || strcmp(a->glsl, b->glsl) == 0);
}

static bool same_bindings(const struct dt_program *a, const struct dt_program *b)
{
    bool same = a->binding_count == b->binding_count;
    for (uint32_t i = 0; same && i < a->binding_count; i++)
        same = a->bindings[i].binding == b->bindings[i].binding &&
               a->bindings[i].kind == b->bindings[i].kind;
    return same;
}

static bool same_state(const struct dt_program *a, const struct dt_program *b)
{
    return a->compare == b->compare && a->cull == b->cull && a->depth_test == b->depth_test &&
           a->depth_write == b->depth_write && a->clip_distances == b->clip_distances &&
           a->topology == b->topology && a->bias_constant == b->bias_constant &&
           a->bias_slope == b->bias_slope;
}

static enum dt_format format_of(const struct dt_panel *panel, const struct dt_target *target)
{
    return panel->pipeline->resources[target->resource].format;
}

static bool same_blend(const struct dt_target *a, const struct dt_target *b)
{
    return a->keep == b->keep && !a->blend == !b->blend &&
           (!a->blend || memcmp(a->blend, b->blend, sizeof *a->blend) == 0);
}

static bool same_targets(const struct dt_panel *a, const struct dt_program *pa,
                         const struct dt_panel *b, const struct dt_program *pb)
{
    bool same = pa->color_count == pb->color_count && !pa->depth == !pb->depth;
    for (uint32_t i = 0; same && i < pa->color_count; i++)
        same = format_of(a, &pa->colors[i]) == format_of(b, &pb->colors[i]) &&
               same_blend(&pa->colors[i], &pb->colors[i]);
    return same && (!pa->depth || format_of(a, pa->depth) == format_of(b, pb->depth));
}

static bool same_program(const struct dt_shaders *a, uint32_t pa, const struct dt_shaders *b,
                         uint32_t pb)
{
    const struct dt_program *first = &a->panel->programs[pa], *second = &b->panel->programs[pb];
    const struct dt_stages *one = &a->stages[pa], *other = &b->stages[pb];
    return a->panel->pipeline->passes[pa].kind == b->panel->pipeline->passes[pb].kind &&
           same_bindings(first, second) && same_state(first, second) &&
           same_targets(a->panel, first, b->panel, second) &&
           same_code(&one->compute, &other->compute) && same_code(&one->vertex, &other->vertex) &&
           same_code(&one->fragment, &other->fragment);
}

static bool is_zero(const void *bytes, size_t size)
{
    const char *at = bytes;
    for (size_t i = 0; i < size; i++)
        if (at[i])
            return false;
    return true;
}

/* Moves an equal program from the previous panel to the new one, since most edits change few
 * programs. */
static bool take_program(struct dt_core *core, const struct made *before, uint32_t pass)
{
    size_t size = core->backend->program_size;
    uint32_t count = before->programs ? before->shaders.panel->pipeline->pass_count : 0;
    for (uint32_t i = 0; i < count; i++) {
        char *old = (char *)before->programs + i * size;
        if (is_zero(old, size) || !same_program(&before->shaders, i, &core->shaders, pass))
            continue;
        memcpy(dt_program(core, pass), old, size);
        memset(old, 0, size);
        if (core->backend->adopt_program)
            core->backend->adopt_program(core, dt_program(core, pass), pass);
        return true;
    }
    return false;
}

static void release_resources(struct dt_core *core)
{
    if (core->resources)
        dt_history_keep(core);
    bool connected = core->programs && core->backend->disconnect_program;
    for (uint32_t i = 0; connected && i < core->pipeline->pass_count; i++)
        core->backend->disconnect_program(core, dt_program(core, i));
    for (uint32_t i = core->pipeline->resource_count; core->resources && i-- > 0;)
        core->backend->destroy_resource(core, dt_resource(core, i));
    if (core->backend->release_memory)
        core->backend->release_memory(core);
    core->width = core->height = 0;
    core->next_pass = core->recorded = 0;
    core->sized = core->rendered = core->has_camera = false;
}

static void destroy_programs(struct dt_core *core, const struct made *made)
{
    uint32_t count = made->programs ? made->shaders.panel->pipeline->pass_count : 0;
    for (uint32_t i = 0; i < count; i++)
        core->backend->destroy_program(core,
                                       (char *)made->programs + i * core->backend->program_size);
    free(made->programs);
}

/* Destroys everything except the programs, which it returns. */
static struct made take_apart(struct dt_core *core)
{
    struct made made = {core->shaders, core->programs};
    if (!core->panel)
        return made;
    core->backend->rest(core, "create"); /* a lost device logs an error; go on */
    release_resources(core);
    for (uint32_t i = 0; core->samplers && i < core->panel->sampler_count; i++)
        core->backend->destroy_sampler(core, dt_sampler(core, i));
    core->backend->end_panel(core);
    free(core->resources);
    free(core->samplers);
    free(core->choices);
    free(core->ran);
    free(core->written);
    free(core->imported);
    free(core->resumed);
    free(core->live);
    core->live = NULL;
    core->slot = 0;
    core->resources = core->programs = core->samplers = core->choices = NULL;
    core->ran = core->imported = core->resumed = NULL;
    core->written = NULL;
    core->shaders = (struct dt_shaders){0};
    core->panel = NULL;
    core->pipeline = NULL;
    return made;
}

static void destroy_pipeline(struct dt_core *core)
{
    struct made made = take_apart(core);
    destroy_programs(core, &made);
}

void dt_front_destroy(struct dt_core *core)
{
    core->keep_history = false;
    destroy_pipeline(core);
    dt_history_drop(core);
}

static bool allocate(struct dt_core *core)
{
    enum { MOST_FRAMES = 16 };
    const struct dt_backend *backend = core->backend;
    core->frames = core->frames ? core->frames : 1;
    if (core->frames > MOST_FRAMES)
        return dt_error(core, "pipeline %s: opened for %u frames in flight; use at most %d",
                        core->pipeline->name, core->frames, MOST_FRAMES);
    core->resources = calloc(core->pipeline->resource_count + 1, backend->resource_size);
    core->programs = calloc(core->pipeline->pass_count + 1, backend->program_size);
    core->samplers = calloc(core->panel->sampler_count + 1, backend->sampler_size);
    core->choices = calloc(core->pipeline->resource_count + 1, backend->choice_size);
    core->ran = calloc(dt_run(core, core->frames, 1), sizeof *core->ran);
    core->written = calloc(core->pipeline->resource_count + 1, sizeof *core->written);
    core->imported = calloc(core->pipeline->resource_count + 1, sizeof *core->imported);
    core->resumed = calloc(core->pipeline->resource_count + 1, sizeof *core->resumed);
    core->live = calloc(1, core->pipeline->block_size + 1);
    return (core->resources && core->programs && core->samplers && core->choices && core->ran &&
            core->written && core->imported && core->resumed && core->live) ||
           dt_error(core, "pipeline %s: out of memory; free some", core->pipeline->name);
}

static bool make(struct dt_core *core, const struct made *before)
{
    bool good = allocate(core) && core->backend->begin_panel(core);
    for (uint32_t i = 0; good && i < core->panel->sampler_count; i++)
        good = core->backend->create_sampler(core, dt_sampler(core, i), &core->panel->samplers[i]);
    for (uint32_t i = 0; good && i < core->pipeline->pass_count; i++)
        good = take_program(core, before, i) ||
               core->backend->create_program(core, dt_program(core, i), i);
    return good && (!core->backend->compile_programs || core->backend->compile_programs(core));
}

bool dt_front_given(const struct dt_core *core, const void *pointer, const char *what)
{
    return core && (pointer || dt_error(core, "%s is NULL; give one", what));
}

bool dt_front_takes(const struct dt_core *core, const struct dt_panel *panel)
{
    uint32_t version = panel->version;
    return DT_TAKES(version) ||
           dt_error(core,
                    "the pipeline is from diptych-gen %u.%u.%u, this library is %d.%d.%d; "
                    "generate the pipeline again, with the generator of the library",
                    version / 1000000, version / 1000 % 1000, version % 1000, DT_VERSION_MAJOR,
                    DT_VERSION_MINOR, DT_VERSION_PATCH);
}

/* Elements of the longest texel buffer of the scene that the pipeline binds; 0: no scene yet. */
static uint64_t longest_texels(const struct dt_core *core, const struct dt_panel *panel)
{
    uint64_t longest = 0;
    for (uint32_t pass = 0; pass < panel->pipeline->pass_count; pass++)
        for (uint32_t i = 0; i < panel->programs[pass].binding_count; i++) {
            const struct dt_binding *binding = &panel->programs[pass].bindings[i];
            uint64_t count = binding->kind != DT_BIND_TEXELS ? 0
                             : binding->resource == DT_SCENE_VERTICES
                                 ? core->vertex_bytes / DT_VERTEX_TEXEL
                                 : core->index_count;
            longest = count > longest ? count : longest;
        }
    return longest;
}

bool dt_front_takes_gpu(const struct dt_core *core, const struct dt_panel *panel)
{
    if (core->target != DT_TARGET_AUTO || !core->device.software)
        return core->target != DT_TARGET_SOFTWARE;
    uint64_t elements = longest_texels(core, panel), most = core->limits.most[DT_LIMIT_TEXELS];
    if (elements > most)
        dt_log(core, DT_INFO,
               "the scene has %llu elements, but texel buffers of %s at most %llu: the shaders for "
               "GPUs read it from storage buffers",
               (unsigned long long)elements, core->device.name, (unsigned long long)most);
    return elements > most;
}

bool dt_front_create(struct dt_core *core, const struct dt_shaders *shaders)
{
    if (!dt_front_given(core, shaders, "create: the struct dt_shaders") ||
        !dt_front_takes(core, shaders->panel))
        return false;
    const struct dt_pipeline *pipeline = shaders->panel->pipeline;
    struct dt_shaders chosen = *shaders;
    if (chosen.panel->gpu && dt_front_takes_gpu(core, chosen.panel)) {
        chosen.panel = chosen.panel->gpu;
        chosen.stages += pipeline->pass_count;
    }
    if (strcmp(shaders->backend, core->backend->name) != 0)
        return dt_error(core, "pipeline %s: the shaders are for %s; give %s_%s", pipeline->name,
                        shaders->backend, pipeline->name, core->backend->name);
    bool good = enter(core) && check_panel(core, chosen.panel);
    if (good) {
        struct made before = take_apart(core);
        core->shaders = chosen;
        core->panel = chosen.panel;
        core->pipeline = pipeline;
        good = make(core, &before);
        destroy_programs(core, &before);
        if (!good)
            destroy_pipeline(core);
    }
    return leave(core, good);
}

/* ---- Resources ------------------------------------------------------------------------------- */

static void extent_of(const struct dt_core *core, uint32_t resource, uint32_t extent[3])
{
    core->pipeline->extent(core->pipeline, resource, core->width, core->height, extent);
}

static bool check_resource(const struct dt_core *core, uint32_t index)
{
    const struct dt_resource *resource = &core->pipeline->resources[index];
    const struct dt_storage *storage = &core->panel->storage[index];
    uint32_t extent[3];
    extent_of(core, index, extent);
    return resource->kind == DT_IMAGE ? check_image(core, resource, storage->usage, extent)
                                      : check_buffer(core, resource, storage, extent[0]);
}

static bool create_resource(struct dt_core *core, uint32_t index)
{
    uint32_t extent[3];
    extent_of(core, index, extent);
    return dt_history_take(core, index, extent) ||
           core->backend->create_resource(core, index, extent);
}

/* With zero if it has history; else with core->poison, if set. */
static bool fill_resource(struct dt_core *core, uint32_t index)
{
    bool history = core->pipeline->resources[index].history;
    int byte = history ? 0 : core->poison;
    return core->imported[index] || (!history && !byte) ||
           core->backend->fill_resource(core, index, byte);
}

static bool create_resources(struct dt_core *core)
{
    const struct dt_backend *backend = core->backend;
    uint32_t count = core->pipeline->resource_count;
    bool good = true;
    for (uint32_t i = 0; good && i < count; i++)
        good = create_resource(core, i);
    good = good && (!backend->place_resources || backend->place_resources(core));
    for (uint32_t i = 0; good && i < count; i++)
        good = core->resumed[i] || fill_resource(core, i);
    for (uint32_t i = 0; good && i < core->pipeline->pass_count; i++)
        good = backend->connect_program(core, dt_program(core, i), i);
    return good;
}

static bool lacks_scene(const struct dt_core *core)
{
    for (uint32_t i = 0; i < core->pipeline->pass_count && !core->has_scene; i++)
        if (core->pipeline->passes[i].uses_scene)
            return true;
    return false;
}

const struct dt_field_place dt_attributes[DT_ATTRIBUTES] = {
    [DT_POSITION] = {"vertex_position", offsetof(struct dt_vertex, position), 12},
    [DT_NORMAL] = {"vertex_normal", offsetof(struct dt_vertex, normal), 12},
    [DT_UV] = {"vertex_uv", offsetof(struct dt_vertex, uv), 8},
    [DT_MATERIAL] = {"vertex_material", offsetof(struct dt_vertex, material), 4},
    [DT_TRIANGLE] = {"vertex_triangle", offsetof(struct dt_vertex, triangle), 4},
};

bool dt_front_attribute(struct dt_core *core, int attribute, uint64_t offset, uint32_t stride)
{
    enum { MOST_STRIDE = 2048 }; /* of every OpenGL 4.6 and Vulkan 1.3 */
    const struct dt_field_place *place = &dt_attributes[attribute];
    core->attributes |= (uint8_t)(1u << attribute);
    return (offset % 4 == 0 && stride % 4 == 0 && stride >= place->size && stride <= MOST_STRIDE) ||
           dt_error(core,
                    "%s: offset %llu and stride %u given; both are multiples of 4, the stride %u "
                    "to %d",
                    place->name, (unsigned long long)offset, stride, place->size, MOST_STRIDE);
}

/* A host's scene may be without objects and, as struct dt_vertex, without vertices. */
static bool check_geometry(const struct dt_core *core, uint32_t pass)
{
    const struct dt_program *program = &core->panel->programs[pass];
    for (uint32_t b = 0; b < program->binding_count; b++) {
        uint16_t resource = program->bindings[b].resource;
        bool objects = resource == DT_SCENE_OBJECTS;
        if ((objects && !core->has_objects) ||
            (resource == DT_SCENE_VERTICES && !core->has_vertices))
            return dt_error(core, "resize: the pass %s reads scene_%s; give `%s` to import_scene",
                            dt_pass_name(core, pass), objects ? "objects" : "vertices",
                            objects ? "objects" : "vertices");
    }
    for (int i = 0; i < DT_ATTRIBUTES; i++)
        if ((program->attributes & ~core->attributes) >> i & 1)
            return dt_error(core, "resize: the pass %s reads %s; give it to import_scene",
                            dt_pass_name(core, pass), dt_attributes[i].name);
    return core->numbered || !(program->attributes >> DT_TRIANGLE & 1) ||
           dt_error(core,
                    "resize: the pass %s reads vertex_triangle; number the triangles by "
                    "dt_number_triangles, and tell import_scene that they are `numbered`",
                    dt_pass_name(core, pass));
}

static bool check_work(struct dt_core *core);

/* What depends on the size of the frame, before anything is created for it. */
static bool check_sizes(struct dt_core *core)
{
    for (uint32_t i = 0; i < core->pipeline->resource_count; i++)
        if (!check_resource(core, i))
            return false;
    return check_work(core);
}

bool dt_front_resize(struct dt_core *core, uint32_t width, uint32_t height)
{
    uint32_t limit = (uint32_t)core->limits.most[DT_LIMIT_IMAGE_SIDE];
    if (!core->panel || lacks_scene(core))
        return dt_error(core, "resize: no pipeline or no scene yet; create and %s come first",
                        core->hosted ? "import_scene" : "set_scene");
    for (uint32_t i = 0; i < core->pipeline->pass_count; i++)
        if (!check_geometry(core, i))
            return false;
    if (width < 1 || height < 1 || width > limit || height > limit)
        return dt_error(core, "frame of %ux%u: %s takes 1x1 to %ux%u; choose another size", width,
                        height, core->device.name, limit, limit);
    bool good = enter(core) && core->backend->rest(core, "resize");
    if (good) {
        release_resources(core);
        core->width = width;
        core->height = height;
        memset(core->written, 0, core->pipeline->resource_count * sizeof *core->written);
        memset(core->resumed, 0, core->pipeline->resource_count * sizeof *core->resumed);
        good = check_sizes(core) && create_resources(core);
        if (!good)
            release_resources(core);
        else
            dt_history_drop(core);
        core->has_camera =
            good && core->keep_history && core->kept_camera && dt_history_goes_on(core);
        core->sized = good;
    }
    return leave(core, good);
}

bool dt_front_choose(struct dt_core *core, const char *verb, enum dt_kind kind, uint32_t resource)
{
    if (!core->pipeline || resource >= core->pipeline->resource_count ||
        core->pipeline->resources[resource].kind != kind)
        return dt_error(core, "%s: the pipeline has no %s %u; create comes first", verb,
                        kind == DT_IMAGE ? "image" : "buffer", resource);
    core->sized = false; /* until the next resize */
    return true;
}

bool dt_front_texels(const struct dt_core *core, const char *name, uint64_t elements)
{
    return elements <= core->limits.most[DT_LIMIT_TEXELS] ||
           dt_error(core,
                    "%s: %llu elements, but %s has at most %llu in a texel buffer; take `target: "
                    "gpu`, or `auto` and give the scene before create",
                    name, (unsigned long long)elements, core->device.name,
                    (unsigned long long)core->limits.most[DT_LIMIT_TEXELS]);
}

bool dt_front_range(const struct dt_core *core, const char *name, uint64_t offset, uint64_t size,
                    uint64_t least, uint64_t alignment)
{
    uint64_t most = core->limits.most[DT_LIMIT_STORAGE_BYTES];
    alignment = alignment < 4 ? 4 : alignment; /* of indirect draws and fills */
    if (size < least || offset % alignment)
        return dt_error(core,
                        "%s: %llu bytes at offset %llu given; at least %llu bytes at a multiple of "
                        "%llu are needed",
                        name, (unsigned long long)size, (unsigned long long)offset,
                        (unsigned long long)least, (unsigned long long)alignment);
    return size <= most ||
           dt_error(core, "%s: %llu bytes, but %s binds at most %llu; import fewer", name,
                    (unsigned long long)size, core->device.name, (unsigned long long)most);
}

bool dt_front_import_scene(struct dt_core *core, uint64_t vertex_bytes, uint32_t index_count,
                           bool numbered)
{
    core->vertex_bytes = vertex_bytes;
    core->numbered = numbered;
    core->index_count = index_count;
    core->sized = false; /* programs are connected with the former scene until the next resize */
    return (index_count && index_count % 3 == 0) ||
           dt_error(core, "import_scene: %u indices, but triangles have three each", index_count);
}

enum dt_type dt_front_scalar(enum dt_format format)
{
    enum number_kind kind = format_info(format)->kind;
    return !number_is_integer(kind)         ? DT_TYPE_FLOAT
           : number_is_signed_integer(kind) ? DT_TYPE_INT
                                            : DT_TYPE_UINT;
}

bool dt_front_find(const struct dt_core *core, const char *verb, uint32_t resource, uint32_t mip,
                   struct dt_bytes *shape)
{
    if (!core->pipeline || resource >= core->pipeline->resource_count)
        return dt_error(core, "%s: the pipeline has no resource %u", verb, resource);
    const struct dt_resource *what = &core->pipeline->resources[resource];
    bool image = what->kind == DT_IMAGE;
    uint32_t mips = image ? what->mips : 1, *extent = shape->extent;
    if (!core->width)
        return dt_error(core, "%s %s: it does not exist yet; resize comes first", verb, what->name);
    if (mip >= mips)
        return dt_error(core, "%s %s: mip %u, and it has %u", verb, what->name, mip, mips);
    extent_of(core, resource, extent);
    if (image) {
        for (int axis = 0; axis < (what->shape == DT_SHAPE_3D ? 3 : 2); axis++)
            extent[axis] = extent[axis] >> mip ? extent[axis] >> mip : 1;
        shape->size = (size_t)extent[0] * extent[1] * extent[2] * format_info(what->format)->bytes;
    } else {
        shape->size = (size_t)extent[0] * what->stride;
    }
    return true;
}

/* Whether a pass before `end` writes the resource. */
static bool is_written(const struct dt_core *core, uint32_t end, uint32_t resource)
{
    for (uint32_t pass = 0; pass < end; pass++)
        if (dt_writes(core, pass, resource))
            return true;
    return false;
}

bool dt_front_take(const struct dt_core *core, uint32_t resource, struct dt_bytes *shape)
{
    const struct dt_pipeline *pipeline = core->pipeline;
    if (!dt_front_find(core, "resource", resource, 0, shape))
        return false;
    const struct dt_resource *what = &pipeline->resources[resource];
    if (what->history || what->keep || core->imported[resource])
        return true;
    if ((int)resource != pipeline->linear_output && (int)resource != pipeline->display_output)
        return dt_error(core,
                        "resource %s: other passes may reuse its memory; give it `keep: true` in "
                        "the spec, or import it",
                        what->name);
    return !core->next_pass || is_written(core, core->next_pass, resource) ||
           dt_error(core,
                    "resource %s: a later part of this frame writes it, and earlier passes use its "
                    "memory; take it after that part, or give it `keep: true` in the spec",
                    what->name);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool is_sized(const struct dt_core *core, const char *verb)
{
    return core->sized ||
           dt_error(core,
                    "%s: call resize first (also after a new scene, an import or a failed frame)",
                    verb);
}

static bool has_inputs(const struct dt_core *core, const char *verb)
{
    for (uint32_t i = 0; i < core->pipeline->resource_count; i++) {
        const struct dt_resource *input = &core->pipeline->resources[i];
        uint32_t mips = input->kind == DT_IMAGE ? input->mips : 1, mip = 0;
        while (core->written[i] >> mip & 1)
            mip++;
        if (input->input && !core->imported[i] && mip < mips)
            return dt_error(core,
                            "%s: mip %u of the input %s has no content; write it after resize",
                            verb, mip, input->name);
    }
    return true;
}

/* Halton's sequence, 0 to 1: the digits of the index in this base, mirrored at the point. */
static double halton(uint32_t index, uint32_t base)
{
    double value = 0;
    for (double digit = 1.0 / base; index; index /= base, digit /= base)
        value += digit * (index % base);
    return value;
}

void dt_front_jitter(const struct dt_pipeline *pipeline, const void *live, struct dt_frame *frame)
{
    struct dt_view *camera = &frame->camera;
    int64_t count = pipeline->jitter ? pipeline->jitter(pipeline, live) : 0;
    if (count < 1)
        return;
    uint32_t k = (uint32_t)(frame->index % count) + 1; /* point 0 is a corner */
    frame->jitter[0] = (float)(halton(k, 2) - 0.5);
    frame->jitter[1] = (float)(halton(k, 3) - 0.5);
    const float move[2] = {2 * frame->jitter[0] / (float)frame->width,
                           2 * frame->jitter[1] / (float)frame->height};
    for (int i = 0; i < 4; i++)
        for (int axis = 0; axis < 2; axis++) {
            camera->projection[i][axis] += move[axis] * camera->projection[i][3];
            camera->view_projection[i][axis] += move[axis] * camera->view_projection[i][3];
            camera->inverse_view_projection[3][i] -=
                move[axis] * camera->inverse_view_projection[axis][i];
        }
}

struct dt_frame dt_front_frame(struct dt_core *core, const struct dt_frame *frame, const void *live)
{
    struct dt_frame block = *frame;
    bool given = frame->previous_camera.far_plane != 0;
    block.width = core->width;
    block.height = core->height;
    block.first = !given && (frame->index == 0 || !core->has_camera);
    if (!given)
        block.previous_camera = block.first ? frame->camera : core->camera;
    core->camera = frame->camera;
    core->has_camera = true;
    block.jitter[0] = block.jitter[1] = 0;
    dt_front_jitter(core->pipeline, live, &block);
    return block;
}

static enum dt_action ask_observer(struct dt_core *core, uint32_t pass)
{
    const struct dt_observer *observer = core->observer;
    if (!observer || !observer->before_pass)
        return DT_RUN;
    enum dt_action action = observer->before_pass(observer->user, pass);
    return enter(core) ? action : DT_STOP; /* the observer may have used other contexts */
}

/* Whether a frame uses the resource from this pass on, which discards what its memory held. */
static bool is_discarded(const struct dt_core *core, uint32_t pass, uint32_t resource)
{
    return !core->pipeline->resources[resource].history && dt_writes(core, pass, resource) &&
           !is_written(core, pass, resource);
}

static bool resume(struct dt_core *core)
{
    return !core->backend->resume || core->backend->resume(core);
}

/* With core->poison: fills the memory that the pass discards. An observer has let all earlier work finish. */
static bool poison(struct dt_core *core, uint32_t pass)
{
    bool good = true, paused = core->observer;
    for (uint32_t i = 0; i < core->pipeline->resource_count && core->poison && good; i++) {
        if (!is_discarded(core, pass, i))
            continue;
        good = (paused || core->backend->pause(core)) && fill_resource(core, i);
        good = good && (paused || resume(core));
    }
    return good;
}

static bool begin(void *runtime, uint32_t pass, bool runs)
{
    struct dt_core *core = runtime;
    core->outside = core->measures || pass < core->first_pass || pass >= core->end_pass;
    core->skips = core->outside && !core->measures;
    if (core->outside)
        return true;
    core->pass = pass;
    if (!poison(core, pass))
        return false;
    enum dt_action action = ask_observer(core, pass);
    core->has_viewport = core->has_scissor = false;
    core->skips = action == DT_SKIP;
    runs = runs && action == DT_RUN;
    core->ran[dt_run(core, core->slot, pass)] = runs;
    return action != DT_STOP && core->backend->commands->begin(core, pass, runs);
}

static bool end(void *runtime, uint32_t pass)
{
    struct dt_core *core = runtime;
    const struct dt_observer *observer = core->observer;
    if (core->outside)
        return true;
    if (!core->backend->commands->end(core, pass))
        return false;
    return !observer || (core->backend->pause(core) &&
                         (!observer->after_pass || observer->after_pass(observer->user, pass)) &&
                         enter(core) && resume(core));
}

static bool barriers(void *runtime, uint32_t pass, const struct dt_barrier *list, uint32_t count)
{
    struct dt_core *core = runtime;
    return core->outside || core->backend->commands->barriers(core, pass, list, count);
}

/* Whether the backend records nothing of the pass. */
static bool is_idle(const struct dt_core *core)
{
    return core->skips || core->measures;
}

static bool bind(void *runtime, uint32_t pass)
{
    struct dt_core *core = runtime;
    return is_idle(core) || core->backend->commands->bind(core, pass);
}

static bool check_groups(const struct dt_core *core, uint32_t pass, uint32_t x, uint32_t y,
                         uint32_t z)
{
    return has_limit(core, pass, DT_LIMIT_GROUPS_X, x) &&
           has_limit(core, pass, DT_LIMIT_GROUPS_Y, y) &&
           has_limit(core, pass, DT_LIMIT_GROUPS_Z, z);
}

static bool dispatch(void *runtime, uint32_t pass, uint32_t x, uint32_t y, uint32_t z)
{
    struct dt_core *core = runtime;
    return core->skips ||
           (check_groups(core, pass, x, y, z) &&
            (core->measures || core->backend->commands->dispatch(core, pass, x, y, z)));
}

static bool dispatch_indirect(void *runtime, uint32_t pass, uint32_t arguments)
{
    struct dt_core *core = runtime;
    return is_idle(core) || core->backend->commands->dispatch_indirect(core, pass, arguments);
}

static bool check_target(const struct dt_core *core, uint32_t pass, const struct dt_target *target,
                         uint32_t layers)
{
    uint32_t extent[3];
    extent_of(core, target->resource, extent);
    return (layers >= 1 && layers <= extent[2]) ||
           dt_error(core, "pass %s: draws into %u layers, and image %s has %u",
                    dt_pass_name(core, pass), layers,
                    core->pipeline->resources[target->resource].name, extent[2]);
}

static bool check_layers(const struct dt_core *core, uint32_t pass, uint32_t layers)
{
    const struct dt_program *program = &core->panel->programs[pass];
    if (layers == 1) /* every image has one */
        return true;
    if (!has_limit(core, pass, DT_LIMIT_TARGET_LAYERS, layers))
        return false;
    for (uint32_t i = 0; i < program->color_count; i++)
        if (!check_target(core, pass, &program->colors[i], layers))
            return false;
    return !program->depth || check_target(core, pass, program->depth, layers);
}

static bool check_draws(const struct dt_core *core, uint32_t pass, const struct dt_draw *draw)
{
    uint32_t extent[3], bytes = DT_VERTEX_DRAW_BYTES;
    if (draw->arguments == DT_NO_BUFFER)
        return true;
    if (draw->indices != DT_NO_BUFFER)
        bytes = DT_DRAW_BYTES;
    extent_of(core, draw->arguments, extent);
    uint64_t draws =
        (uint64_t)extent[0] * core->pipeline->resources[draw->arguments].stride / bytes;
    return has_limit(core, pass, DT_LIMIT_DRAWS, draws);
}

static bool draw_checked(struct dt_core *core, uint32_t pass, const struct dt_draw *draw)
{
    return core->skips ||
           (check_draws(core, pass, draw) && check_layers(core, pass, draw->layers) &&
            (core->measures || core->backend->commands->draw(core, pass, draw)));
}

static bool draw_scene(void *runtime, uint32_t pass, uint32_t layers)
{
    struct dt_core *core = runtime;
    return draw_checked(
        core, pass,
        &(struct dt_draw){layers, DT_SCENE_INDICES, DT_NO_BUFFER, core->index_count, layers});
}

static bool draw_indirect(void *runtime, uint32_t pass, uint32_t layers, uint32_t indices,
                          uint32_t arguments)
{
    return draw_checked(runtime, pass, &(struct dt_draw){layers, indices, arguments, 0, 0});
}

/* One triangle that covers all. */
static bool draw_fullscreen(void *runtime, uint32_t pass, uint32_t layers)
{
    return draw_checked(runtime, pass,
                        &(struct dt_draw){layers, DT_NO_BUFFER, DT_NO_BUFFER, 3, layers});
}

static bool draw_vertices(void *runtime, uint32_t pass, uint32_t layers, uint32_t vertices,
                          uint32_t instances)
{
    return draw_checked(runtime, pass,
                        &(struct dt_draw){layers, DT_NO_BUFFER, DT_NO_BUFFER, vertices, instances});
}

static bool draw_vertices_indirect(void *runtime, uint32_t pass, uint32_t layers,
                                   uint32_t arguments)
{
    return draw_checked(runtime, pass, &(struct dt_draw){layers, DT_NO_BUFFER, arguments, 0, 0});
}

static bool check_viewport(const struct dt_core *core, uint32_t pass, struct dt_rect rect)
{
    return has_limit(core, pass, DT_LIMIT_TARGET_WIDTH, rect.width) &&
           has_limit(core, pass, DT_LIMIT_TARGET_HEIGHT, rect.height);
}

static bool viewport(void *runtime, uint32_t pass, struct dt_rect rect)
{
    struct dt_core *core = runtime;
    if (!check_viewport(core, pass, rect))
        return false;
    core->has_viewport = true;
    core->viewport = rect;
    return true;
}

static bool scissor(void *runtime, uint32_t pass, struct dt_rect rect)
{
    struct dt_core *core = runtime;
    (void)pass;
    core->has_scissor = true;
    core->scissor = rect;
    return true;
}

/* Clips one axis of a rectangle to 0 to `size`. */
static void clip_axis(int32_t *start, uint32_t *length, uint32_t size)
{
    int64_t first = *start < 0 ? 0 : *start, end = (int64_t)*start + *length;
    end = end > size ? size : end;
    *start = (int32_t)(first < end ? first : 0);
    *length = first < end ? (uint32_t)(end - first) : 0;
}

void dt_front_area(const struct dt_core *core, uint32_t width, uint32_t height,
                   struct dt_rect *viewport, struct dt_rect *scissor)
{
    const struct dt_rect all = {0, 0, width, height};
    *viewport = core->has_viewport ? core->viewport : all;
    *scissor = core->has_scissor ? core->scissor : all;
    clip_axis(&scissor->x, &scissor->width, width);
    clip_axis(&scissor->y, &scissor->height, height);
    if (viewport->width && viewport->height)
        return;
    *viewport = all; /* the APIs have no empty one */
    scissor->width = scissor->height = 0;
}

static bool clear_targets(void *runtime, uint32_t pass, uint32_t layers)
{
    struct dt_core *core = runtime;
    return core->skips ||
           (check_layers(core, pass, layers) &&
            (core->measures || core->backend->commands->clear_targets(core, pass, layers)));
}

static bool clear_buffer(void *runtime, uint32_t pass, uint32_t resource)
{
    struct dt_core *core = runtime;
    (void)pass;
    return is_idle(core) || core->backend->commands->clear_buffer(core, resource);
}

static bool clear_image(void *runtime, uint32_t pass, uint32_t resource, uint32_t mip)
{
    struct dt_core *core = runtime;
    (void)pass;
    return is_idle(core) || core->backend->commands->clear_image(core, resource, mip);
}

static const struct dt_verbs checked = {
    .begin = begin,
    .barriers = barriers,
    .bind = bind,
    .dispatch = dispatch,
    .dispatch_indirect = dispatch_indirect,
    .draw_scene = draw_scene,
    .draw_indirect = draw_indirect,
    .draw_fullscreen = draw_fullscreen,
    .draw_vertices = draw_vertices,
    .draw_vertices_indirect = draw_vertices_indirect,
    .viewport = viewport,
    .scissor = scissor,
    .clear_targets = clear_targets,
    .clear_buffer = clear_buffer,
    .clear_image = clear_image,
    .end = end,
};

bool dt_front_record(struct dt_core *core, const void *live)
{
    const struct dt_recording recording = {.verbs = &checked,
                                           .runtime = core,
                                           .width = core->width,
                                           .height = core->height,
                                           .live = live,
                                           .panel = core->panel};
    return core->panel->record(&recording);
}

/* Checks the work of a frame with the default live parameters against the limits; other parameters
 * are checked when the frame is recorded. */
static bool check_work(struct dt_core *core)
{
    core->measures = true;
    bool good = dt_front_record(core, core->pipeline->live_defaults);
    core->measures = false;
    return good;
}

static bool check_part(const struct dt_core *core, const char *verb, uint32_t first, uint32_t end)
{
    if (!is_sized(core, verb) || !has_inputs(core, verb))
        return false;
    uint32_t count = core->pipeline->pass_count;
    if (first != core->next_pass)
        return dt_error(core, "%s: begins with pass %u, but the frame goes on with pass %u, %s",
                        verb, first, core->next_pass, dt_pass_name(core, core->next_pass));
    return (end <= count && (first < end || !count)) ||
           dt_error(core, "%s: passes %u to %u, but the pipeline has %u, and a part at least one",
                    verb, first, end, count);
}

/* A host may forget to fill the frame; then it would see an empty picture, and no reason. */
static bool check_frame(const struct dt_core *core, const char *verb, const struct dt_frame *frame)
{
    static const struct dt_view none;
    if (!frame)
        return dt_error(core, "%s: the frame is NULL; give a struct dt_frame", verb);
    bool empty = core->hosted && !memcmp(&frame->camera, &none, sizeof none);
    for (uint32_t i = 0; empty && i < core->pipeline->pass_count; i++)
        if (core->pipeline->passes[i].uses_scene)
            return dt_error(core,
                            "%s: `camera` of the struct dt_frame is zero, and the pass %s uses the "
                            "scene; dt_scene_compose of diptych_scene.h fills the frame",
                            verb, dt_pass_name(core, i));
    return true;
}

bool dt_front_render(struct dt_core *core, const char *verb, const struct dt_frame *frame,
                     const void *live, uint32_t first, uint32_t end)
{
    struct dt_frame block = {0};
    if (!check_part(core, verb, first, end) || (!first && !check_frame(core, verb, frame)))
        return false;
    const struct dt_pipeline *pipeline = core->pipeline;
    core->first_pass = first;
    core->end_pass = end;
    if (!first) {
        memcpy(core->live, live ? live : pipeline->live_defaults, pipeline->live_size);
        core->slot = (core->slot + 1) % core->frames;
        core->recorded += core->recorded < core->frames;
        memset(&core->ran[dt_run(core, core->slot, 0)], 0,
               pipeline->pass_count * sizeof *core->ran);
        block = dt_front_frame(core, frame, core->live);
    }
    bool good = leave(core, enter(core) && core->backend->render(core, &block, core->live));
    core->next_pass = good && end < pipeline->pass_count ? end : 0;
    core->rendered = good && end == pipeline->pass_count;
    core->sized = good; /* else the recorded layouts may never take effect */
    memset(core->resumed, 0, pipeline->resource_count * sizeof *core->resumed);
    return good;
}

bool dt_front_timings(struct dt_core *core, uint32_t age, double *pass_ms)
{
    if (!core->timing || !core->rendered)
        return dt_error(core,
                        "timings: none of a whole frame; open with timing and %s all passes first",
                        core->hosted ? "record" : "render");
    if (!dt_front_given(core, pass_ms, "timings: the array of milliseconds"))
        return false;
    if (age >= core->recorded)
        return dt_error(core,
                        "timings: none of the frame %u before the last; record more frames, up to "
                        "the %u that the runtime was opened for",
                        age, core->frames);
    uint32_t slot = (core->slot + core->frames - age) % core->frames;
    bool good = enter(core);
    for (uint32_t i = 0; good && i < core->pipeline->pass_count; i++) {
        uint32_t run = dt_run(core, slot, i);
        pass_ms[i] = (double)NAN;
        good =
            !core->ran[run] || core->backend->timing(core, run, dt_pass_name(core, i), &pass_ms[i]);
    }
    return leave(core, good);
}

/* ---- The app's verbs ------------------------------------------------------------------------- */

const struct dt_device *dt_verb_device(void *runtime)
{
    return &((struct dt_core *)runtime)->device;
}

bool dt_verb_takes_gpu(void *runtime, const struct dt_panel *panel)
{
    return dt_front_takes_gpu(runtime, panel);
}

static bool check_scene(const struct dt_core *core, const struct dt_scene *scene,
                        const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS])
{
    uint32_t side = (uint32_t)core->limits.most[DT_LIMIT_IMAGE_SIDE];
    uint32_t layers = (uint32_t)core->limits.most[DT_LIMIT_IMAGE_LAYERS];
    if (scene->material_count > DT_MAX_MATERIALS)
        return dt_error(core, "the scene has %u materials, but shaders see %d; merge some",
                        scene->material_count, DT_MAX_MATERIALS);
    if (scene->texture_width > side || scene->texture_height > side ||
        scene->texture_layers > layers)
        return dt_error(core,
                        "scene textures: %u of %ux%u texels, but %s allows %u of %ux%u; use fewer "
                        "or smaller ones",
                        scene->texture_layers, scene->texture_width, scene->texture_height,
                        core->device.name, layers, side, side);
    uint64_t most = core->limits.most[DT_LIMIT_STORAGE_BYTES];
    for (int i = 0; i < DT_SCENE_BUFFERS; i++)
        if (buffers[i].size > most)
            return dt_error(core, "%s: %llu bytes, but %s binds at most %llu; use a smaller scene",
                            buffers[i].name, (unsigned long long)buffers[i].size, core->device.name,
                            (unsigned long long)most);
    return true;
}

bool dt_verb_set_scene(void *runtime, const struct dt_scene *scene)
{
    struct dt_core *core = runtime;
#define BUFFER(resource, name, list, count, least)                                                 \
    {                                                                                              \
        resource, name, (uint64_t)((count) > (least) ? (count) : (least)) * sizeof *scene->list,   \
            scene->list, (uint64_t)(count) * sizeof *scene->list                                   \
    }
    const struct dt_scene_buffer buffers[DT_SCENE_BUFFERS] = {
        BUFFER(DT_SCENE_VERTICES, "scene vertices", vertices, scene->vertex_count, 0),
        BUFFER(DT_SCENE_OBJECTS, "scene objects", objects, scene->object_count, 1),
        BUFFER(DT_SCENE_INDICES, "scene indices", indices, scene->index_count, 0),
        BUFFER(DT_SCENE_MATERIALS, "scene materials", materials, scene->material_count,
               DT_MAX_MATERIALS),
    };
#undef BUFFER
    core->sized = false; /* programs are connected with the former scene until the next resize */
    core->numbered = true;
    if (!check_scene(core, scene, buffers))
        return false;
    core->vertex_bytes = buffers[0].size;
    core->index_count = scene->index_count;
    core->has_scene = enter(core) && core->backend->upload_scene(core, scene, buffers);
    core->has_objects = core->has_scene;
    return leave(core, core->has_scene);
}

bool dt_verb_create(void *runtime, const struct dt_shaders *shaders)
{
    return dt_front_create(runtime, shaders);
}

bool dt_verb_resize(void *runtime, uint32_t width, uint32_t height)
{
    return dt_front_resize(runtime, width, height);
}

bool dt_verb_render(void *runtime, const struct dt_frame *frame, const void *live,
                    const struct dt_observer *observer)
{
    struct dt_core *core = runtime;
    const char *verb = core->hosted ? "record" : "render";
    if (!is_sized(core, verb))
        return false;
    core->observer = observer;
    bool good = dt_front_render(core, verb, frame, live, 0, core->pipeline->pass_count);
    core->observer = NULL;
    return good;
}

bool dt_verb_read(void *runtime, uint32_t resource, uint32_t mip, struct dt_bytes *out)
{
    struct dt_core *core = runtime;
    *out = (struct dt_bytes){0};
    if (!dt_front_find(core, "read", resource, mip, out))
        return false;
    bool good = (out->data = malloc(out->size ? out->size : 1));
    if (!good)
        dt_error(core, "read %s: no memory for %zu bytes; free some, or use a smaller frame",
                 core->pipeline->resources[resource].name, out->size);
    good = good && leave(core, enter(core) && core->backend->read(core, resource, mip, out));
    if (!good) {
        free(out->data);
        *out = (struct dt_bytes){0};
    }
    return good;
}

/* OpenGL clamps other depths; Vulkan leaves them undefined. */
static bool check_depth(const struct dt_core *core, const struct dt_resource *image,
                        const struct dt_bytes *bytes)
{
    bool depth = image->kind == DT_IMAGE && image->format == DT_FORMAT_D32F;
    for (size_t i = 0; depth && i < bytes->size / sizeof(float); i++) {
        float texel;
        memcpy(&texel, bytes->data + i * sizeof texel, sizeof texel);
        if (!(texel >= 0 && texel <= 1))
            return dt_error(core, "write %s: texel %zu is %.9g, but a depth is 0 to 1", image->name,
                            i, (double)texel);
    }
    return true;
}

bool dt_front_fits(const struct dt_core *core, uint32_t resource, uint32_t mip,
                   const struct dt_bytes *bytes)
{
    struct dt_bytes own = {0};
    if (!dt_front_given(core, bytes, "write: the struct dt_bytes") ||
        !dt_front_find(core, "write", resource, mip, &own) ||
        (core->hosted && !is_sized(core, "write")))
        return false;
    const struct dt_resource *to = &core->pipeline->resources[resource];
    if (core->hosted && (!to->input || core->imported[resource]))
        return dt_error(core, "write %s: %s", to->name,
                        to->input ? "it is imported; write the host's own object"
                                  : "a host writes inputs only; give it `input: true` in the spec");
    const uint32_t *given = bytes->extent;
    if (bytes->size != own.size || memcmp(given, own.extent, sizeof own.extent) != 0)
        return dt_error(core,
                        "write %s: %zu bytes of %ux%ux%u given, but the resource has %zu bytes of "
                        "%ux%ux%u; give these",
                        to->name, bytes->size, given[0], given[1], given[2], own.size,
                        own.extent[0], own.extent[1], own.extent[2]);
    return dt_front_given(core, bytes->data, "write: `data` of the struct dt_bytes") &&
           check_depth(core, to, bytes);
}

bool dt_verb_write(void *runtime, uint32_t resource, uint32_t mip, const struct dt_bytes *bytes)
{
    struct dt_core *core = runtime;
    bool good = dt_front_fits(core, resource, mip, bytes) &&
                leave(core, enter(core) && core->backend->write(core, resource, mip, bytes));
    if (good)
        core->written[resource] |= 1u << mip;
    return good;
}

bool dt_verb_timings(void *runtime, double *pass_ms)
{
    return dt_front_timings(runtime, 0, pass_ms);
}
