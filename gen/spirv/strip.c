/* Leaves out names, sources and lines; see passes.h. */
#include <spirv/unified1/spirv.h>
#include <string.h>

#include "passes.h"

/* Of the debug instructions: names and sources up to OpLine, and two later ones. */
static bool is_debug(uint32_t opcode)
{
    return (opcode >= SpvOpSourceContinued && opcode <= SpvOpLine) || opcode == SpvOpNoLine ||
           opcode == SpvOpModuleProcessed;
}

size_t spirv_strip(uint32_t *words, size_t count)
{
    size_t kept = count < SPIRV_HEADER ? count : SPIRV_HEADER;
    for (size_t at = SPIRV_HEADER, length; at < count; at += length) {
        length = words[at] >> 16;
        if (!is_debug(words[at] & 0xffff)) {
            memmove(words + kept, words + at, length * sizeof *words);
            kept += length;
        }
    }
    return kept;
}
