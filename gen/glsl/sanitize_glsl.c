/* What the shaders of --sanitize get: the checks of templates/glsl/sanitize.glsl with the buffer of reports, and where an
 * invocation stands. spirv/sanitize.c calls the checks. */
#include "plan/sanitize.h"

#include "glsl.h"

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
    const char *const words[] = {"@layout@",
                                 sanitize_layout(glsl, sanitize_buffer),
                                 "@rooms@",
                                 arena_printf(glsl->model->arena, "%u", rooms),
                                 "@free@",
                                 arena_printf(glsl->model->arena, "%d", SANITIZE_FREE_ROOMS),
                                 "@nothing@",
                                 nothing.failed ? NULL : nothing.data,
                                 "@place@",
                                 glsl->pass->interleave
                                     ? "uvec3(group.yz * gl_WorkGroupSize.xy + local.xy, group.x)"
                                     : "group * gl_WorkGroupSize + local",
                                 NULL};
    text_add(&glsl->parts[PART_END],
             "uint diptych_now()\n{\n    return frame.index + 1u;\n}\n\nuint "
             "diptych_frame_size()\n{\n    return frame.width | frame.height << 16;\n}\n\n");
    bool good = words[1] && words[3] && words[5] && words[7] &&
                sanitize_library(glsl, "sanitize", words) && shadow_glsl(glsl);
    if (glsl->model->sanitize & SANITIZE_FLOW && glsl->stage == STAGE_IS_FRAGMENT)
        good = good && sanitize_library(glsl, "quads", &(const char *const){NULL});
    text_free(&nothing);
    return good;
}
