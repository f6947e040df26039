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
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, VERSION_GLSL);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    shader.setEnvTarget(glslang::EShTargetSpv, job.minor == 5   ? glslang::EShTargetSpv_1_5
                                               : job.minor == 3 ? glslang::EShTargetSpv_1_3
                                                                : glslang::EShTargetSpv_1_0);
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
    EShMessages rules =
        static_cast<EShMessages>(EShMsgSpvRules | EShMsgCascadingErrors | EShMsgVulkanRules);
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
