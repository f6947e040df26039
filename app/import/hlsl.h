/* HLSL, which glslang makes a module of: a spec names the module, whose lines are those of the HLSL. */
#pragma once

#include "import/texts.h"

/* By the file's ending, or by words that GLSL has not; text: NULL before it is read. */
bool hlsl_is(const char *path, const char *text);
/* The stages that the text has entry points for: a set of bits, 1 << REFLECT_COMPUTE and so on. Attributes and semantics tell the stage
 * of main(). */
unsigned hlsl_stages(const char *text);
enum { HLSL_LINKS = 64 };

/* Where the values between the stages of a draw are, by its vertex shader, which is compiled first; zeros: there is none yet. */
struct hlsl_links {
    struct hlsl_link {
        char semantic[64]; /* with its index: TEXCOORD0 */
        uint32_t location;
    } list[HLSL_LINKS];
    uint32_t count;
};

/* Gives uniforms the values that globals of this stage are initialized with. */
struct reflection;
void hlsl_initials(const struct import_texts *texts, const char *name, int stage,
                   struct reflection *reflection);

/* The module of a stage, *count words; free(). NULL: *why, free(), has glslang's messages; NULL: out of memory. */
uint32_t *hlsl_compile(struct import_texts *texts, const char *name, int stage,
                       struct hlsl_links *links, size_t *count, char **why);
