/* Modules of SPIR-V that others made, in the form of glslang's, which the passes of gen/spirv know. */
#pragma once

#include "module.h"

/* foreign.c. Takes *count words that spirv_check took; the result has: lines, of the source or else of spirv-dis's
 * output for the file `path`; decorations without groups; no
 * debug instructions but names and lines; combined textures; storage buffers as SPIR-V 1.0 has them; the lowest
 * version that fits; a name for every variable, member and constant that a spec can name:
 *     input_LOCATION, output_LOCATION, binding_N (set_S_binding_N), BLOCK_MEMBER, constant_ID.
 * free(). NULL: out of memory. */
uint32_t *spirv_take_in(const uint32_t *words, size_t *count, const char *path);
/* Files that lines are of: each becomes the number that `number` gives for its name and text (NULL: unknown), as glslang
 * writes them for the passes. free(). NULL: out of memory. */
uint32_t *spirv_number_files(const uint32_t *words, size_t *count,
                             uint32_t (*number)(void *user, const char *name, const char *text),
                             void *user);
/* Whether a function takes a texture or a sampler, so that its loads name no variable. */
bool spirv_passes_textures(const struct spirv *module);
/* The module behind some passes of spirv-opt (spirv_check.h). False: out of memory. */
bool spirv_reread(struct spirv *module, unsigned passes);
/* Whether a module has an entry point for an execution model. */
bool spirv_has_entry(const uint32_t *words, size_t count, uint32_t model);
/* The entry point for an execution model becomes the only one, main. False: out of memory. */
bool spirv_choose_entry(struct spirv *module, uint32_t model);

/* memory.c, for texts as well: Vulkan's memory model becomes GLSL's. False: out of memory. */
bool spirv_lower_memory(struct spirv *module);
/* demote.c, likewise: demoted invocations are marked, and discarded at the end; where one could write a buffer or an image, the module
 * stays. False: out of memory. */
bool spirv_demote(struct spirv *module);
/* Whether it would do so with a module. */
bool spirv_can_demote(const struct spirv *module);
/* Phis become variables, as glslang has them: --sanitize puts branches between blocks. False: out of memory. */
bool spirv_lower_phis(struct spirv *module);

/* combine.c, for texts as well: textures and samplers as passes have them. split.c, textures in structs, and spread.c, arrays
 * of resources, texel_buffers.c, which combine.c calls. False: out of memory. */
bool spirv_combine(struct spirv *module);
bool spirv_split(struct spirv *module);
bool spirv_spread(struct spirv *module);
bool spirv_texel_buffers(struct spirv *module);
