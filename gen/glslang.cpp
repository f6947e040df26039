/* See glslang.h. */
extern "C" {
#include "glslang.h"
}

#include <cstdlib>
#include <cstring>
#include <exception>
#include <vector>

#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

namespace
{

enum { VERSION_GLSL = 460 };

void set_targets(glslang::TShader &shader, EShLanguage stage, const glslang_job &job)
{
    glslang::EShTargetLanguageVersion opengl =
        job.subgroups ? glslang::EShTargetSpv_1_3 : glslang::EShTargetSpv_1_0;
    shader.setEnvInput(glslang::EShSourceGlsl, stage,
                       job.vulkan ? glslang::EShClientVulkan : glslang::EShClientOpenGL,
                       VERSION_GLSL);
    if (job.vulkan)
        shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    else
        shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
    shader.setEnvTarget(glslang::EShTargetSpv, job.vulkan ? glslang::EShTargetSpv_1_5 : opengl);
}

} // namespace

extern "C" bool glslang_start(void)
{
    return glslang::InitializeProcess();
}

extern "C" uint32_t *glslang_compile(const glslang_job *job, size_t *count, char **log)
try {
    static const EShLanguage stages[] = {EShLangCompute, EShLangVertex, EShLangFragment};
    EShLanguage stage = stages[job->stage];
    EShMessages language = job->vulkan ? EShMsgVulkanRules : EShMsgDefault;
    EShMessages rules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgCascadingErrors | language);
    glslang::TShader shader(stage);
    glslang::TProgram program;
    shader.setStrings(&job->code, 1);
    set_targets(shader, stage, *job);
    *log = nullptr;
    if (!shader.parse(GetDefaultResources(), VERSION_GLSL, ECoreProfile, false, false, rules)) {
        *log = strdup(shader.getInfoLog());
        return nullptr;
    }
    program.addShader(&shader);
    if (!program.link(rules)) {
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
} catch (const std::exception &exception) {
    *log = strdup(exception.what());
    return nullptr;
}
