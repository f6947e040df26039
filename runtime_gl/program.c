/* Links programs from the embedded SPIR-V or GLSL. */
#include "internal.h"

#include <stdlib.h>

/* Logs the driver's message about a shader or program that it refuses. */
static bool log_refusal(struct dt_gl_runtime *rt, const char *program, const char *what,
                        GLuint handle, bool linking)
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
    dt_error(&rt->core, "pass %s: %s failed on %s:\n%s", program, what, rt->core.device.name,
             text ? text : "(the driver gives no reason)");
    free(text);
    return false;
}

static bool load_code(struct dt_gl_runtime *rt, const char *name, GLuint shader,
                      const struct dt_code *code)
{
    if (rt->glsl && !code->glsl)
        return dt_error(&rt->core, "pass %s: no GLSL text; generate with diptych-gen --glsl", name);
    if (rt->glsl || !code->size)
        return GL(rt, name, ShaderSource(shader, 1, &code->glsl, NULL)) &&
               GL(rt, name, CompileShader(shader));
    uint32_t *own;
    const uint32_t *words = dt_front_words(code, &own);
    if (!words)
        return dt_error(&rt->core, "pass %s: no memory for %zu bytes of SPIR-V; free some", name,
                        code->size);
    bool ok =
        GL(rt, name,
           ShaderBinary(1, &shader, GL_SHADER_BINARY_FORMAT_SPIR_V, words, (GLsizei)code->size)) &&
        GL(rt, name, SpecializeShader(shader, "main", 0, NULL, NULL));
    free(own);
    return ok;
}

/* Compiles one stage, if present, and attaches it. OpenGL keeps a deleted shader while it is
 * attached. */
static bool attach_stage(struct dt_gl_runtime *rt, GLuint program, const char *name, GLenum kind,
                         const char *what, const struct dt_code *code)
{
    if (!code->size && !code->glsl) /* absent */
        return true;
    GLuint shader = rt->gl.CreateShader(kind);
    GLint status = GL_FALSE;
    bool good = gl_check(rt, "CreateShader", name) && load_code(rt, name, shader, code);
    if (good) {
        rt->gl.GetShaderiv(shader, GL_COMPILE_STATUS, &status);
        good = (status || log_refusal(rt, name, what, shader, false)) &&
               GL(rt, name, AttachShader(program, shader));
    }
    rt->gl.DeleteShader(shader);
    return good;
}

static bool link_program(struct dt_gl_runtime *rt, GLuint program, const char *name)
{
    GLint status = GL_FALSE;
    if (!GL(rt, name, LinkProgram(program)))
        return false;
    rt->gl.GetProgramiv(program, GL_LINK_STATUS, &status);
    return status || log_refusal(rt, name, "linking", program, true);
}

bool gl_program_create(struct dt_gl_runtime *rt, GLuint *program, const char *name,
                       const struct dt_stages *stages)
{
    *program = rt->gl.CreateProgram();
    if (!gl_check(rt, "CreateProgram", name))
        return false;
    return attach_stage(rt, *program, name, GL_COMPUTE_SHADER, "compiling the compute shader",
                        &stages->compute) &&
           attach_stage(rt, *program, name, GL_VERTEX_SHADER, "compiling the vertex shader",
                        &stages->vertex) &&
           attach_stage(rt, *program, name, GL_FRAGMENT_SHADER, "compiling the fragment shader",
                        &stages->fragment) &&
           link_program(rt, *program, name);
}

void gl_program_destroy(struct dt_gl_runtime *rt, GLuint *program)
{
    if (*program)
        rt->gl.DeleteProgram(*program);
    *program = 0;
}
