/* The C scaffolds of templates/c, carried inside the generator so that it needs no file to find.
 * Assembled with the repository's root as the working directory; build.ninja lists the two files as
 * inputs of this one. */
#include "emit_c.h"

#define CARRY(symbol, path)                                                                        \
    __asm__(".pushsection .rodata\n"                                                               \
            ".global " #symbol "\n" #symbol ":\n"                                                  \
            ".incbin \"" path "\"\n"                                                               \
            ".byte 0\n"                                                                            \
            ".popsection\n")

CARRY(scaffold_panel_gl, "templates/c/panel_gl.c.in");
CARRY(scaffold_panel_vk, "templates/c/panel_vk.c.in");
