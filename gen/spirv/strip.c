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

static bool is_line(uint32_t opcode)
{
    return opcode == SpvOpLine || opcode == SpvOpNoLine;
}

/* From an offset on. */
static size_t drop(uint32_t *words, size_t from, size_t count, bool (*drops)(uint32_t opcode))
{
    size_t kept = count < from ? count : from;
    for (size_t at = from, length; at < count; at += length) {
        length = words[at] >> 16;
        if (!drops(words[at] & 0xffff)) {
            memmove(words + kept, words + at, length * sizeof *words);
            kept += length;
        }
    }
    return kept;
}

size_t spirv_strip(uint32_t *words, size_t count)
{
    return drop(words, SPIRV_HEADER, count, is_debug);
}

size_t spirv_strip_lines(uint32_t *words, size_t from, size_t count)
{
    return drop(words, from, count, is_line);
}
