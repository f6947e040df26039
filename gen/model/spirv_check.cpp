/* See spirv_check.h. C++, since SPIRV-Tools throws where memory runs out, and its optimizer has no other interface. */
extern "C" {
#include "spirv_check.h"
}

#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>

namespace
{

enum { MOST_WORDS = 4 << 20 }; /* 16 MiB, which is a hundred times the largest shader of ours */

/* One line of the message, which may show an instruction behind a line break. */
std::string one_line(std::string said)
{
    for (size_t at; (at = said.find_last_of('\n')) != std::string::npos;)
        said.replace(at, said.find_first_not_of(" \n", at) - at, at + 1 < said.size() ? ": " : "");
    return said;
}

} // namespace

extern "C" bool spirv_check(const uint32_t *words, size_t count, char **why)
try {
    std::string said = "more than 16 MiB";
    spvtools::SpirvTools tools(SPV_ENV_UNIVERSAL_1_6);
    spvtools::ValidatorOptions options;
    options.SetFriendlyNames(why != nullptr);
    tools.SetMessageConsumer([&said](spv_message_level_t, const char *, const spv_position_t &,
                                     const char *message) { said = message; });
    bool valid = count <= MOST_WORDS && tools.Validate(words, count, options);
    std::string names; /* of entry points; which one is meant, nobody says */
    unsigned entries = 0;
    for (size_t at = 5; valid && at < count; at += words[at] >> 16)
        if ((words[at] & 0xffff) == 15) /* OpEntryPoint */
            names += (entries++ ? ", " : "") + std::string((const char *)(words + at + 3));
    if (why && entries > 1)
        *why = strdup(("a module of one entry point is needed; this one has " + names).c_str());
    if (why && !valid)
        *why = strdup(("spirv-val says: " + one_line(said)).c_str());
    valid &= entries < 2;
    return valid;
} catch (const std::exception &exception) {
    if (why)
        *why = strdup(exception.what());
    return false;
}

extern "C" uint32_t *spirv_optimize(const uint32_t *words, size_t *count, unsigned passes)
try {
    spvtools::Optimizer optimizer(SPV_ENV_UNIVERSAL_1_6);
    spvtools::OptimizerOptions options;
    std::vector<uint32_t> out;
    /* A fault of glslang's HLSL would end the passes by a signal. */
    spvtools::ValidatorOptions early;
    early.SetBeforeHlslLegalization(true);
    early.SetRelaxStructStore(true);
    early.SetSkipBlockLayout(true);
    options.set_validator_options(early);
    options.set_run_validator(passes & SPIRV_LEGALIZE);
    /* Without one, a pass that has something to say throws. */
    optimizer.SetMessageConsumer(
        [](spv_message_level_t, const char *, const spv_position_t &, const char *) {});
    if (passes & SPIRV_FLATTEN)
        optimizer.RegisterPass(spvtools::CreateFlattenDecorationPass())
            .RegisterPass(spvtools::CreateStripNonSemanticInfoPass());
    if (passes & SPIRV_LEGALIZE)
        optimizer.RegisterLegalizationPasses();
    if (passes & SPIRV_INLINE)
        optimizer.RegisterPass(spvtools::CreateMergeReturnPass())
            .RegisterPass(spvtools::CreateInlineExhaustivePass());
    if (passes & SPIRV_CHAINS)
        optimizer.RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
            .RegisterPass(spvtools::CreateCombineAccessChainsPass())
            .RegisterPass(spvtools::CreateAggressiveDCEPass());
    if (passes & SPIRV_FREEZE)
        optimizer.RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
            .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass());
    if (passes & SPIRV_PRUNE)
        optimizer.RegisterPass(spvtools::CreateLocalSingleStoreElimPass())
            .RegisterPass(spvtools::CreateCCPPass())
            .RegisterPass(spvtools::CreateDeadBranchElimPass());
    if (!optimizer.Run(words, *count, &out, options))
        return nullptr;
    *count = out.size();
    void *copy = std::malloc(out.size() * sizeof out[0]);
    if (copy)
        std::memcpy(copy, out.data(), out.size() * sizeof out[0]);
    return static_cast<uint32_t *>(copy);
} catch (const std::exception &) {
    return nullptr;
}

extern "C" char *spirv_disassemble(const uint32_t *words, size_t count)
try {
    spvtools::SpirvTools tools(SPV_ENV_UNIVERSAL_1_6);
    std::string text;
    bool good = tools.Disassemble(words, count, &text,
                                  SPV_BINARY_TO_TEXT_OPTION_INDENT |
                                      SPV_BINARY_TO_TEXT_OPTION_FRIENDLY_NAMES);
    return good ? strdup(text.c_str()) : nullptr;
} catch (const std::exception &) {
    return nullptr;
}
