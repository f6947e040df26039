/* Small passes over modules; those with files of their own to read have headers of their own. */
#pragma once

#include "model/module.h"

/* strip.c: removes names, sources and lines in place, which no result depends on. Returns the new
 * count. */
size_t spirv_strip(uint32_t *words, size_t count);
/* The same of lines alone, from an offset on. */
size_t spirv_strip_lines(uint32_t *words, size_t from, size_t count);

/* opengl.c: makes a module for Vulkan one for OpenGL. indirect: for draws with a base instance.
 * False when out of memory, as for all that follow. */
bool spirv_for_opengl(struct spirv *module, bool indirect);

/* entry.c: the entry point also calls diptych_end(), if the module has it. */
bool spirv_end_entry(struct spirv *module);

/* globals.c: globals that only main sets, to constants, become those; branches that they decide go. */
bool spirv_settle_globals(struct spirv *module);

/* texels.c: reads of the storage buffer `name` become calls of name_at() and name_length(). */
bool spirv_texels(struct spirv *module, const char *name);

/* reach.c: leaves out what the entry point does not reach. */
bool spirv_reach(struct spirv *module);

/* loops.c: marks long loops DontUnroll: those in no other loop of their function, with many operations
 * per iteration. Many of them get a loop of one turn each around them. */
bool spirv_keep_loops(struct spirv *module);

/* The same file: what a driver compiles of a shader once it has put functions in place of their calls: operations, and
 * loops that stay loops. */
uint64_t spirv_operations(const struct spirv *module, uint64_t *loops);

/* join.c: `more`, which the generator wrote, joins a whole shader's module. Ids of `more`
 * that the shader has not are at least the shader's former bound. */
bool spirv_join(struct spirv *module, const struct spirv *more);
