/* Vulkan's memory model becomes GLSL's, since drivers of OpenGL crash of the other one. See foreign.h. */
#include <spirv/unified1/spirv.h>
#include <string.h>

#include "foreign.h"
#include "leaves.h"

enum {
    TEXEL_MORE = 0xf00,     /* MakeTexelAvailable to VolatileTexel */
    SEMANTICS_MORE = 0xf000 /* OutputMemory to Volatile */
};

static bool has_vulkan_model(const struct spirv *module)
{
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations)
        if (spirv_is(i, SpvOpMemoryModel))
            return i[2] == SpvMemoryModelVulkan;
    return false;
}

static void copy_head(struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    edit->front.count = SPIRV_HEADER;
    SPIRV_EACH(from, i, SPIRV_HEADER, edit->failed ? 0 : from->annotations) {
        bool capability =
            spirv_is(i, SpvOpCapability) && (i[1] == SpvCapabilityVulkanMemoryModel ||
                                             i[1] == SpvCapabilityVulkanMemoryModelDeviceScope);
        bool extension = spirv_is(i, SpvOpExtension) &&
                         !strcmp((const char *)(i + 1), "SPV_KHR_vulkan_memory_model");
        if (spirv_is(i, SpvOpMemoryModel))
            SPIRV_PUT(edit, &edit->front, SpvOpMemoryModel, i[1], SpvMemoryModelGLSL450);
        else if (!capability && !extension)
            spirv_copy(edit, &edit->front, i);
    }
}

/* The word of an image's operands. */
static uint32_t image_word(const uint32_t *i)
{
    return spirv_is(i, SpvOpImageWrite) ? 4 : 5;
}

/* Words of an instruction without operands of memory, which stand behind all others. Images keep those of GLSL's model. */
static uint32_t words_kept(const uint32_t *i)
{
    uint32_t length = spirv_length(i), word = image_word(i);
    switch (spirv_opcode(i)) {
    case SpvOpLoad:
        return 4;
    case SpvOpStore:
    case SpvOpCopyMemory:
        return 3;
    case SpvOpImageRead:
    case SpvOpImageWrite:
        return word < length && i[word] & TEXEL_MORE
                   ? word + 1 + (uint32_t)__builtin_popcount(i[word] & 0xff)
                   : length;
    default:
        return length;
    }
}

/* The word of the scope of memory, before the semantics; 0: no atomic and no barrier. */
static uint32_t scope_word(const uint32_t *i)
{
    uint32_t opcode = spirv_opcode(i);
    return opcode == SpvOpControlBarrier || opcode == SpvOpAtomicStore ? 2
           : opcode == SpvOpMemoryBarrier                              ? 1
           : opcode >= SpvOpAtomicLoad && opcode <= SpvOpAtomicXor     ? 4
                                                                       : 0;
}

/* In the copy of an instruction: a scope without families of queues, and semantics that GLSL's model has. */
static void lower_scope(struct spirv_edit *edit, const uint32_t *i, size_t start, uint32_t scope)
{
    bool compares = spirv_is(i, SpvOpAtomicCompareExchange); /* has semantics twice */
    for (uint32_t word = scope; word < scope + 2 + compares; word++) {
        const uint32_t *was = spirv_definition(edit->from, i[word]);
        uint32_t value = word > scope                    ? was[3] & ~(uint32_t)SEMANTICS_MORE
                         : was[3] == SpvScopeQueueFamily ? SpvScopeDevice
                                                         : was[3];
        uint32_t id = spirv_is(was, SpvOpConstant)
                          ? spirv_declare(edit, SpvOpConstant, was[1], &value, 1)
                          : i[word];
        if (!edit->failed)
            edit->code.data[start + word] = id;
    }
}

/* Whether an access said something of its own. */
static bool copy_code(struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    bool said = false;
    SPIRV_EACH(from, i, edit->failed ? from->count : from->code, from->count) {
        uint32_t kept = words_kept(i), length = spirv_length(i), scope = scope_word(i);
        size_t start = edit->code.count;
        spirv_append(edit, &edit->code, i, kept);
        if (edit->failed)
            return said;
        said |= kept < length;
        edit->code.data[start] = kept << 16 | spirv_opcode(i);
        if (kept < length && (spirv_is(i, SpvOpImageRead) || spirv_is(i, SpvOpImageWrite)))
            edit->code.data[start + image_word(i)] &= ~(uint32_t)TEXEL_MORE;
        if (scope)
            lower_scope(edit, i, start, scope);
    }
    return said;
}

/* Buffers and images, since an access of GLSL's model says nothing of itself. */
static void share_all(struct spirv_edit *edit)
{
    const struct spirv *from = edit->from;
    SPIRV_EACH(from, i, from->declarations, from->code) {
        const uint32_t *type;
        if (!spirv_is(i, SpvOpVariable))
            continue;
        type = spirv_definition(from, spirv_element_type(from, spirv_pointee(from, i)));
        bool buffer = i[3] == SpvStorageClassStorageBuffer ||
                      spirv_decoration(from, type[1], SpvDecorationBufferBlock) != UINT32_MAX;
        bool image = spirv_is(type, SpvOpTypeImage) && type[7] == 2;
        if (buffer || image)
            SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, i[2], SpvDecorationCoherent);
        if (buffer || image)
            SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, i[2], SpvDecorationVolatile);
    }
}

bool spirv_lower_memory(struct spirv *module)
{
    struct spirv_edit edit;
    if (!has_vulkan_model(module))
        return true;
    spirv_edit_begin(&edit, module);
    spirv_edit_annotations(&edit);
    copy_head(&edit);
    if (copy_code(&edit))
        share_all(&edit);
    return spirv_edit_end(&edit, module);
}
