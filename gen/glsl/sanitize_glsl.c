/* What the shaders of --sanitize get: the checks of templates/glsl/sanitize.glsl with the buffer of reports, and where an
 * invocation stands. spirv/sanitize.c calls the checks. */
#include "glsl.h"

static const char *place_of(const struct glsl *glsl)
{
    if (glsl->stage == STAGE_IS_VERTEX)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_VertexIndex, gl_InstanceIndex, "
               "0);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(1048576, 4096, 1);\n}\n\n";
    if (glsl->stage == STAGE_IS_FRAGMENT)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_FragCoord.xy, 0.0);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(65536, 65536, 1);\n}\n\n";
    if (glsl->pass->interleave)
        return "uvec3 diptych_place()\n{\n    return uvec3(gl_WorkGroupID.yz * gl_WorkGroupSize.xy "
               "+ "
               "gl_LocalInvocationID.xy, gl_WorkGroupID.x);\n}\n\n"
               "uvec3 diptych_extent()\n{\n    return uvec3(gl_NumWorkGroups.yz * "
               "gl_WorkGroupSize.xy, gl_NumWorkGroups.x);\n}\n\n";
    return "uvec3 diptych_place()\n{\n    return gl_GlobalInvocationID;\n}\n\n"
           "uvec3 diptych_extent()\n{\n    return gl_NumWorkGroups * gl_WorkGroupSize;\n}\n\n";
}

bool sanitize_glsl(struct glsl *glsl)
{
    struct model *model = glsl->model;
    static const char slot[] = "@layout@";
    if (!model->sanitize)
        return true;
    const char *path = arena_printf(model->arena, "%s/glsl/sanitize.glsl", model->templates_dir);
    const struct source *source = path ? glsl_source(model, path) : NULL;
    const char *at = source ? strstr(source->text, slot) : NULL;
    if (!at) {
        diag_error(glsl->diag, glsl->pass->shader_loc, "cannot read the library file %s",
                   path ? path : "sanitize.glsl");
        return false;
    }
    struct text *out = &glsl->parts[PART_END];
    text_add(out, "%s", place_of(glsl));
    text_add_bytes(out, source->text, (size_t)(at - source->text));
    glsl_binding(glsl->pass->accesses[glsl->pass->access_count - 1].binding, out);
    text_add(out, "%s\n", at + strlen(slot));
    return true;
}
