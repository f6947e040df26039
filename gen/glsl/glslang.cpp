/* See glslang.h. */
extern "C" {
#include "glslang.h"
}

#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#define ENABLE_HLSL // as the library was built
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

namespace
{

enum { VERSION_GLSL = 460 };

void set_targets(glslang::TShader &shader, EShLanguage stage, const glslang_job &job)
{
    if (job.opengl) {
        shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientOpenGL, VERSION_GLSL);
        shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
    } else {
        shader.setEnvInput(job.hlsl ? glslang::EShSourceHlsl : glslang::EShSourceGlsl, stage,
                           glslang::EShClientVulkan, VERSION_GLSL);
        shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    }
    shader.setEnvTarget(glslang::EShTargetSpv, job.minor == 5   ? glslang::EShTargetSpv_1_5
                                               : job.minor == 3 ? glslang::EShTargetSpv_1_3
                                                                : glslang::EShTargetSpv_1_0);
}

/* The author's files, as the job finds them. */
class Files : public glslang::TShader::Includer
{
  public:
    explicit Files(const glslang_job &job) : job(job)
    {
    }

    IncludeResult *includeLocal(const char *name, const char *from, size_t depth) override
    {
        glslang_file file = {};
        if (depth > MOST_DEPTH || !job.include || !job.include(job.user, from, name, &file))
            return nullptr;
        return new IncludeResult(file.number, file.text, file.length, nullptr);
    }
    IncludeResult *includeSystem(const char *, const char *, size_t) override
    {
        return nullptr;
    }
    void releaseInclude(IncludeResult *result) override
    {
        delete result;
    }

  private:
    enum { MOST_DEPTH = 64 };
    const glslang_job &job;
};

const EShLanguage stages[] = {EShLangCompute, EShLangVertex, EShLangFragment};

/* All functions stay, also those that only a pass over the module calls. */
const EShMessages rules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgCascadingErrors |
                                                   EShMsgVulkanRules | EShMsgKeepUncalled);

const EShMessages rules_of_hlsl = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules |
                                                           EShMsgReadHlsl | EShMsgHlslLegalization);

/* Behind #version: default precisions, by which the pass `exact` knows the author's operations. They
 * mean nothing else to it. */
const char *const precisions = "precision mediump float;\nprecision mediump int;\n#line 2 0\n";

/* In front of a shader of Vulkan that is read for OpenGL: words that OpenGL's GLSL does not have. */
const char *const included = "#extension GL_GOOGLE_include_directive : require\n";
const char *const with_structs = "#extension GL_GOOGLE_include_directive : require\n"
                                 "#define VULKAN 100\n";
const char *const as_opengl = "#extension GL_GOOGLE_include_directive : require\n"
                              "#extension GL_EXT_spirv_intrinsics : enable\n"
                              "#define VULKAN 100\n#define set binding\n"
                              "#define push_constant std140\n#define std430 std140\n"
                              "#define gl_VertexIndex gl_VertexID\n"
                              "#define gl_InstanceIndex gl_InstanceID\n";

struct Text { /* its pieces must stay until the shader is parsed */
    const char *pieces[3];
    int lengths[3];
};

/* HLSL's resources have classes of registers, each from 0 on; locations are in the order of declarations. */
void set_hlsl(glslang::TShader &shader, const glslang_job &job)
{
    shader.setStringsWithLengthsAndNames(&job.code, nullptr, &job.name, 1);
    shader.setEntryPoint(job.hlsl);
    shader.setSourceEntryPoint(job.hlsl);
    shader.setPreamble(job.more ? job.more : "");
    shader.setShiftBinding(glslang::EResTexture, 64);
    shader.setShiftBinding(glslang::EResSampler, 128);
    shader.setShiftBinding(glslang::EResSsbo, 192);
    shader.setShiftBinding(glslang::EResUav, 256);
    shader.setShiftBinding(glslang::EResImage, 256);
    shader.setAutoMapBindings(true);
    shader.setAutoMapLocations(true);
    set_targets(shader, stages[job.stage], job);
    shader.setEnvTargetHlslFunctionality1(); // names of semantics
}

void set_text(glslang::TShader &shader, const glslang_job &job, Text &text)
{
    if (job.hlsl) {
        set_hlsl(shader, job);
        return;
    }
    const char *behind = std::strchr(job.code, '\n') + 1; /* #version */
    text = {{job.code, precisions, behind}, {static_cast<int>(behind - job.code), -1, -1}};
    if (job.marked)
        shader.setStringsWithLengths(text.pieces, text.lengths, 3);
    else
        shader.setStrings(&job.code, 1);
    shader.setPreamble(job.structs ? with_structs : job.opengl ? as_opengl : included);
    set_targets(shader, stages[job.stage], job);
    if (job.whole) {
        if (!job.opengl)
            shader.setEnvInputVulkanRulesRelaxed();
        shader.setAutoMapBindings(true);
        shader.setAutoMapLocations(true);
    }
}

/* glslang makes its tables of built-in functions with the first shader, under a lock that stays locked
 * when memory runs out there: every later call would wait for ever. So nothing else is called before a
 * first shader has succeeded. */
bool start(bool whole)
try {
    glslang_job job = {};
    size_t count;
    char *log = nullptr;
    job.whole = whole;
    job.code = "#version 460\nlayout(local_size_x = 1) in;\nvoid main() {}\n";
    uint32_t *words = glslang::InitializeProcess() ? glslang_compile(&job, &count, &log) : nullptr;
    std::free(words);
    std::free(log);
    return words;
} catch (const std::exception &) {
    return false;
}

} // namespace

/* glslang keeps its tables until the process ends. Each takes as long as reading some thousand lines. */
extern "C" bool glslang_start(bool whole)
{
    if (whole) {
        static const bool started = start(true);
        return started;
    }
    static const bool started = start(false);
    return started;
}

extern "C" uint32_t *glslang_compile(const glslang_job *job, size_t *count, char **log)
try {
    EShLanguage stage = stages[job->stage];
    const EShMessages own = job->hlsl     ? rules_of_hlsl
                            : job->opengl ? static_cast<EShMessages>(EShMsgSpvRules)
                                          : rules;
    glslang::TShader shader(stage);
    glslang::TProgram program;
    Files files(*job);
    Text text;
    *log = nullptr;
    set_text(shader, *job, text);
    if (!shader.parse(GetDefaultResources(), VERSION_GLSL, ECoreProfile, false, false, own,
                      files)) {
        *log = strdup(shader.getInfoLog());
        return nullptr;
    }
    program.addShader(&shader);
    bool places = (job->opengl && !job->structs) || job->hlsl;
    if (!program.link(own) || (places && !program.mapIO())) {
        *log = strdup(program.getInfoLog());
        return nullptr;
    }
    std::vector<unsigned int> words;
    glslang::SpvOptions options;
    options.generateDebugInfo = job->lines;
    options.disableOptimizer = true;
    glslang::GlslangToSpv(*program.getIntermediate(stage), words, &options);
    *count = words.size();
    void *copy = std::malloc(words.size() * sizeof words[0]);
    if (copy)
        std::memcpy(copy, words.data(), words.size() * sizeof words[0]);
    return static_cast<uint32_t *>(copy);
} catch (const std::bad_alloc &) {
    return nullptr;
} catch (const std::exception &exception) {
    *log = strdup(exception.what());
    return nullptr;
}

extern "C" char *glslang_preprocess(const glslang_job *job, char **log)
try {
    glslang::TShader shader(stages[job->stage]);
    Files files(*job);
    Text text;
    std::string out;
    *log = nullptr;
    set_text(shader, *job, text);
    if (!shader.preprocess(GetDefaultResources(), VERSION_GLSL, ECoreProfile, false, false, rules,
                           &out, files)) {
        *log = strdup(shader.getInfoLog());
        return nullptr;
    }
    out.resize((out.size() / 4 + 1) * 4);
    char *copy = static_cast<char *>(std::malloc(out.size()));
    if (copy)
        out.copy(copy, out.size());
    return copy;
} catch (const std::bad_alloc &) {
    return nullptr;
} catch (const std::exception &exception) {
    *log = strdup(exception.what());
    return nullptr;
}
