/* What the shaders of --sanitize get: the checks of templates/glsl/sanitize.glsl with the buffer of reports, and where an
 * invocation stands. spirv/sanitize.c calls the checks. */
#include "plan/sanitize.h"

#include "glsl.h"

static const char *place_function(const struct glsl *glsl)
{
    if (glsl->stage == STAGE_IS_VERTEX)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_VertexIndex, gl_InstanceIndex, "
               "0);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(1048576, 4096, 1);\n}\n\n";
    if (glsl->stage == STAGE_IS_FRAGMENT)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_FragCoord.xy, 0.0);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(65536, 65536, 1);\n}\n\n";
    if (glsl->pass->interleave)
        return "uvec3 diptych_place_at(const uvec3 group, const uvec3 local)\n{\n    return "
               "uvec3(group.yz * gl_WorkGroupSize.xy + local.xy, group.x);\n}\n\n"
               "uvec3 diptych_place()\n{\n    return diptych_place_at(gl_WorkGroupID, "
               "gl_LocalInvocationID);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(gl_NumWorkGroups.yz * "
               "gl_WorkGroupSize.xy, gl_NumWorkGroups.x);\n}\n\n";
    return "uvec3 diptych_place_at(const uvec3 group, const uvec3 local)\n{\n    return group * "
           "gl_WorkGroupSize + local;\n}\n\n"
           "uvec3 diptych_place()\n{\n    return gl_GlobalInvocationID;\n}\n\n"
           "uvec3 diptych_extent()\n{\n    return gl_NumWorkGroups * gl_WorkGroupSize;\n}\n\n";
}

const char *sanitize_layout(const struct glsl *glsl, const char *resource)
{
    const struct access *access = glsl->pass->accesses;
    struct text layout = {0};
    while (strcmp(access->name, resource) != 0)
        access++;
    glsl_binding(access->binding, &layout);
    const char *copy = layout.failed ? NULL : arena_printf(glsl->model->arena, "%s", layout.data);
    text_free(&layout);
    return copy;
}

bool sanitize_library(struct glsl *glsl, const char *name, const char *const *words)
{
    const struct source *source = glsl_library_file(glsl, name);
    if (source)
        glsl_fill(&glsl->parts[PART_CHECKS], source->text, words);
    text_add(&glsl->parts[PART_CHECKS], "\n");
    return source;
}

bool sanitize_glsl(struct glsl *glsl)
{
    if (!glsl->model->sanitize)
        return true;
    uint32_t rooms = SANITIZE_FREE_ROOMS + glsl->pass->allow_count;
    struct text nothing = {0};
    for (uint32_t i = 0; i < rooms; i++)
        text_add(&nothing, "%sDiptych_found(0u, 0u, 0u, 0u, 0u, 0u, 0u)", i ? ", " : "");
    const char *const words[] = {
        "@layout@",  sanitize_layout(glsl, sanitize_buffer),
        "@rooms@",   arena_printf(glsl->model->arena, "%u", rooms),
        "@free@",    arena_printf(glsl->model->arena, "%d", SANITIZE_FREE_ROOMS),
        "@nothing@", nothing.failed ? NULL : nothing.data,
        NULL};
    text_add(&glsl->parts[PART_END],
             "%suint diptych_now()\n{\n    return frame.index + 1u;\n}\n\nuint "
             "diptych_frame_size()\n{\n    return frame.width | frame.height << 16;\n}\n\n",
             place_function(glsl));
    bool good = words[1] && words[3] && words[5] && words[7] &&
                sanitize_library(glsl, "sanitize", words) && shadow_glsl(glsl);
    if (glsl->model->sanitize & SANITIZE_FLOW && glsl->stage == STAGE_IS_FRAGMENT)
        good = good && sanitize_library(glsl, "quads", &(const char *const){NULL});
    text_free(&nothing);
    return good;
}
