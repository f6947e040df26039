/* What the fixed functions of a draw leave open: the standards let a driver blend, cover and
 * encode in more than one way. The part of --prove that no shader has.
 *
 * Sources: Vulkan 1.3, chapters "The Framebuffer" (blending; sRGB conversion may err by 0.6 of a
 * code), "Rasterization" (points, lines, depth bias), "Primitive Clipping"; OpenGL 4.6, chapters 14
 * and 17. Left out are draws of the scene where the contract `raster` covers the difference: edges,
 * depth and clipped triangles. Clear values are rounded by lower.c. */
#include <spirv/unified1/spirv.h>

#include "model/source.h"
#include "plan/plan.h"
#include "model/module.h"
#include "compile.h"

const char prove_assumptions[] =
    "exact where sums and products round to nearest even; no NaN, infinity or denormal number "
    "arises; zeros keep their signs; no index, shift or conversion is out of range; no integer is "
    "divided by 0, no negative one taken by %; no variable and no memory is read before it has a "
    "value; invocations do not race; no edge of a triangle meets the centre of a texel";

static bool is_exact(const struct access *access)
{
    return access->mode != MODE_READ && access->resource &&
           access->resource->contract.allowed.kind == DT_CONTRACT_EXACT;
}

/* Whether the draw can change a channel of the format, red is 0. */
static bool draws_channel(const struct access *access, uint32_t channel)
{
    return channel < format_info(access->resource->format)->channels &&
           !(access->keep >> channel & 1);
}

/* Why one equation of blending is open; NULL: it is not. */
static const char *open_equation(enum dt_format format, enum dt_factor src, enum dt_factor dst,
                                 enum dt_blend_op op)
{
    enum number_kind kind = format_info(format)->kind;
    bool single = kind == NUMBER_FLOAT;
    if (op == DT_BLEND_MIN || op == DT_BLEND_MAX)
        return single || kind == NUMBER_HALF ? "of -0.0 and 0.0 it may keep either" : NULL;
    if (src > DT_FACTOR_ZERO || dst > DT_FACTOR_ZERO)
        return "the driver rounds products with a factor, or fuses them with the sum";
    bool sum = src == DT_FACTOR_ONE && dst == DT_FACTOR_ONE;
    return sum && !single ? "the driver rounds or truncates the sum to the format" : NULL;
}

static void prove_blend(const struct pass *pass, const struct access *target, struct diag *diag)
{
    const struct dt_blend *blend = target->blend;
    enum dt_format format = target->resource->format;
    bool color = draws_channel(target, 0) || draws_channel(target, 1) || draws_channel(target, 2);
    const char *why = color ? open_equation(format, blend->src, blend->dst, blend->op) : NULL;
    if (!why && draws_channel(target, 3))
        why = open_equation(format, blend->alpha_src, blend->alpha_dst, blend->alpha_op);
    if (why)
        diag_error(diag, target->own_blend ? target->blend_loc : pass->blend_loc,
                   "`blend` of `%s` is not exact: %s", target->name, why);
}

static void prove_target(const struct pass *pass, const struct access *target, bool own_depth,
                         struct diag *diag)
{
    bool makes_vertices = pass->kind == DT_PASS_DRAW_VERTICES ||
                          (pass->kind == DT_PASS_DRAW_FULLSCREEN && pass->own_vertices);
    if (target->kind & DT_WRITE_COLOR && target->blend)
        prove_blend(pass, target, diag);
    if (target->kind & DT_WRITE_COLOR && target->resource->format == DT_FORMAT_RGBA8_SRGB)
        diag_error(diag, target->loc,
                   "`%s` is not exact: the driver encodes sRGB, and may miss by a code; draw codes "
                   "into rgba8",
                   target->name);
    if (target->kind & DT_WRITE_DEPTH && makes_vertices && pass->depth_write && pass->depth_test &&
        !own_depth)
        diag_error(diag, target->loc,
                   "`%s` is not exact: interpolation of depth depends on the driver; write "
                   "gl_FragDepth",
                   target->name);
}

/* Whether the shader writes gl_FragDepth. */
static bool replaces_depth(const struct shader *fragment)
{
    const uint32_t *words = fragment->words;
    for (size_t at = SPIRV_HEADER; at < fragment->word_count; at += words[at] >> 16)
        if (spirv_is(words + at, SpvOpExecutionMode) &&
            words[at + 2] == SpvExecutionModeDepthReplacing)
            return true;
    return false;
}

void prove_fixed(const struct pass *pass, const struct shader *fragment, struct diag *diag)
{
    bool exact = false, own_depth = replaces_depth(fragment);
    EACH(access, pass->accesses, pass->access_count) {
        exact |= is_exact(access);
        if (is_exact(access))
            prove_target(pass, access, own_depth, diag);
    }
    if (exact && pass->topology != DT_TRIANGLES)
        diag_error(diag, pass->topology_loc,
                   "`topology: %s` is not exact: which texels %s covers depends on the driver",
                   pass->topology == DT_LINES ? "lines" : "points",
                   pass->topology == DT_LINES ? "a line" : "a point");
    if (exact && (pass->bias_constant != 0 || pass->bias_slope != 0))
        diag_error(diag, pass->bias_loc,
                   "`depth_bias` is not exact: its unit, and the slope, depend on the driver");
    if (exact && pass->clip_distances && pass->kind != DT_PASS_DRAW_SCENE)
        diag_error(diag, pass->clip_loc,
                   "`clip_distances` are not exact: where they cut a triangle, the driver rounds");
}
