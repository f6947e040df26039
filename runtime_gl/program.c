/* Programs: one per pass, linked from the SPIR-V or the GLSL text that the generator embedded.
 * Called by generated code at create. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

struct stage {
    GLenum kind;
    const char *name;
    const struct dt_code *code;
};

/* Logs what the driver says about a shader (or program) that it refuses. */
static void log_refusal(struct gl_runtime *rt, const char *program, const char *what, GLuint handle,
                        bool linking)
{
    GLint size = 0;
    if (linking)
        rt->gl.GetProgramiv(handle, GL_INFO_LOG_LENGTH, &size);
    else
        rt->gl.GetShaderiv(handle, GL_INFO_LOG_LENGTH, &size);
    char *text = size > 1 ? calloc((size_t)size, 1) : NULL;
    if (text && linking)
        rt->gl.GetProgramInfoLog(handle, size, NULL, text);
    else if (text)
        rt->gl.GetShaderInfoLog(handle, size, NULL, text);
    gl_log(rt, DT_ERROR, "pass %s: %s failed on %s:\n%s", program, what, rt->device_name,
           text ? text : "(the driver gives no reason)");
    free(text);
}

static bool load_code(struct gl_runtime *rt, const char *program, GLuint shader,
                      const struct dt_code *code)
{
    if (rt->options.glsl || !code->size)
        return GL(rt, program, ShaderSource(shader, 1, &code->glsl, NULL)) &&
               GL(rt, program, CompileShader(shader));
    return GL(rt, program,
              ShaderBinary(1, &shader, GL_SHADER_BINARY_FORMAT_SPIR_V, code->words,
                           (GLsizei)code->size)) &&
           GL(rt, program, SpecializeShader(shader, "main", 0, NULL, NULL));
}

/* Compiles one stage and attaches it; the shader object lives on as long as the program needs
 * it. */
static bool attach_stage(struct gl_runtime *rt, const struct gl_program *program,
                         const struct stage *stage)
{
    GLuint shader = rt->gl.CreateShader(stage->kind);
    if (!shader)
        return gl_check(rt, "CreateShader", program->name);
    bool ok = load_code(rt, program->name, shader, stage->code);
    GLint status = GL_FALSE;
    if (ok) {
        rt->gl.GetShaderiv(shader, GL_COMPILE_STATUS, &status);
        if (!status)
            log_refusal(rt, program->name, stage->name, shader, false);
        ok = status && GL(rt, program->name, AttachShader(program->handle, shader));
    }
    rt->gl.DeleteShader(shader);
    return ok;
}

static bool attach_all(struct gl_runtime *rt, const struct gl_program *program,
                       const struct gl_program_info *info)
{
    const struct stage stages[] = {
        {GL_COMPUTE_SHADER, "compiling the compute shader", &info->compute},
        {GL_VERTEX_SHADER, "compiling the vertex shader", &info->vertex},
        {GL_FRAGMENT_SHADER, "compiling the fragment shader", &info->fragment},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(stages); i++) {
        const struct dt_code *code = stages[i].code;
        bool present = code->size != 0 || code->glsl != NULL; /* the runtime's own have only text */
        if (present && !attach_stage(rt, program, &stages[i]))
            return false;
    }
    return true;
}

static bool link_program(struct gl_runtime *rt, const struct gl_program *program)
{
    GLint status = GL_FALSE;
    if (!GL(rt, program->name, LinkProgram(program->handle)))
        return false;
    rt->gl.GetProgramiv(program->handle, GL_LINK_STATUS, &status);
    if (!status)
        log_refusal(rt, program->name, "linking", program->handle, true);
    return status;
}

/* ---- Programs of the panel before ------------------------------------------------------------ */

static bool same_code(const struct gl_runtime *rt, const struct dt_code *a, const struct dt_code *b)
{
    if (a->size != b->size || !a->size)
        return a->size == b->size && a->glsl == b->glsl;
    return rt->options.glsl ? strcmp(a->glsl, b->glsl) == 0
                            : memcmp(a->words, b->words, a->size) == 0;
}

static bool keep(struct gl_spare *spare, const struct gl_program *program)
{
    struct gl_program *grown =
        program->handle ? realloc(spare->programs, (spare->count + 1) * sizeof *grown) : NULL;
    if (!grown)
        return false;
    spare->programs = grown;
    spare->programs[spare->count++] = *program;
    return true;
}

static bool take_spare(struct gl_runtime *rt, struct gl_program *program,
                       const struct gl_program_info *info)
{
    struct gl_spare *spare = &rt->spare;
    for (uint32_t i = 0; i < spare->count; i++) {
        const struct gl_program_info *was = &spare->programs[i].info;
        if (!same_code(rt, &was->compute, &info->compute) ||
            !same_code(rt, &was->vertex, &info->vertex) ||
            !same_code(rt, &was->fragment, &info->fragment))
            continue;
        *program = (struct gl_program){
            .name = info->name, .handle = spare->programs[i].handle, .info = *info};
        spare->programs[i] = spare->programs[--spare->count];
        return true;
    }
    return false;
}

void gl_programs_forget(struct gl_runtime *rt)
{
    struct gl_spare spare = rt->spare;
    rt->spare = (struct gl_spare){0};
    for (uint32_t i = 0; i < spare.count; i++)
        dt_gl_program_destroy(rt, &spare.programs[i]);
    free(spare.programs);
}

/* ---- Programs -------------------------------------------------------------------------------- */

bool dt_gl_program_create(struct gl_runtime *rt, struct gl_program *program,
                          const struct gl_program_info *info)
{
    if (info->clip_distances > (uint32_t)rt->limits.clip_distances) {
        gl_log(rt, DT_ERROR, "pass %s: %u clip distances, and %s allows %d", info->name,
               info->clip_distances, rt->device_name, rt->limits.clip_distances);
        return false;
    }
    if (take_spare(rt, program, info))
        return true;
    *program = (struct gl_program){.name = info->name, .info = *info};
    program->handle = rt->gl.CreateProgram();
    if (!program->handle)
        return gl_check(rt, "CreateProgram", info->name);
    return attach_all(rt, program, info) && link_program(rt, program);
}

void dt_gl_program_destroy(struct gl_runtime *rt, struct gl_program *program)
{
    bool kept = rt->spare.keeps && keep(&rt->spare, program);
    if (program->handle && !kept)
        rt->gl.DeleteProgram(program->handle);
    *program = (struct gl_program){0};
}
