/* See spirv_check.h. C++, since SPIRV-Tools throws where memory runs out. */
extern "C" {
#include "spirv_check.h"
}

#include <cstring>
#include <exception>
#include <string>

#include <spirv-tools/libspirv.hpp>

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
    if (why && !valid)
        *why = strdup(("spirv-val says: " + one_line(said)).c_str());
    return valid;
} catch (const std::exception &exception) {
    if (why)
        *why = strdup(exception.what());
    return false;
}
