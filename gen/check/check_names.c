/* Names: each is declared once, none is reserved in GLSL, C or the generated code, and every
 * reference is resolved. */
#include <ctype.h>
#include <string.h>

#include "checks.h"
#include "read/table.h"

/* ---- Reserved names -------------------------------------------------------------------------- */

static const char *const glsl_words =
    /* GLSL 4.60, sections 3.6 and 3.7, and GL_KHR_vulkan_glsl; more of them: is_glsl_type */
    " active asm atomic_uint attribute bool break buffer bvec2 bvec3 bvec4 case cast centroid "
    "class coherent common const continue default discard do double dvec2 dvec3 dvec4 else enum "
    "extern external false filter fixed flat float for fvec2 fvec3 fvec4 goto half highp hvec2 "
    "hvec3 hvec4 if in inline inout input int interface invariant isubpassInput isubpassInputMS "
    "ivec2 ivec3 ivec4 layout long lowp mediump namespace noinline noperspective out output "
    "packed partition patch precise precision public readonly resource restrict return sample "
    "sampler samplerShadow shared short sizeof smooth static struct subpassInput subpassInputMS "
    "subroutine superp switch template this true typedef uint uniform union unsigned using "
    "usubpassInput usubpassInputMS uvec2 uvec3 uvec4 varying vec2 vec3 vec4 void volatile while "
    "writeonly main ";

static const char *const c_words =
    /* C23 */
    " alignas alignof auto char constexpr nullptr register signed static_assert thread_local "
    " typeof typeof_unqual _Alignas _Alignof _Atomic _BitInt _Bool _Complex _Decimal128 "
    " _Decimal32 _Decimal64 _Generic _Imaginary _Noreturn _Static_assert _Thread_local "
    /* C++20: its programs include the generated header */
    " and and_eq bitand bitor catch char16_t char32_t char8_t co_await co_return co_yield compl "
    " concept const_cast consteval constinit decltype delete dynamic_cast explicit export friend "
    " import module mutable new noexcept not not_eq operator or or_eq private protected "
    " reinterpret_cast requires static_cast throw try typeid typename virtual wchar_t xor xor_eq "
    /* names and macros of the headers that generated C includes, and of compilers */
    " NULL int16_t int32_t int64_t int8_t linux offsetof size_t uint16_t uint32_t "
    " uint64_t uint8_t unix ";

/* Functions of GLSL that a declaration would hide. */
static const char *const function_words =
    " abs acos all any asin atan barrier ceil ceil_div clamp cos cross degrees determinant "
    "distance dot equal exp exp2 floor fma fract imageLoad imageSize imageStore inverse "
    "inversesqrt isinf isnan ldexp length lerp log log2 max min mix mod modf normalize not pow "
    "radians reflect refract round roundEven sign sin sqrt step smoothstep tan texelFetch texture "
    "textureLod transpose trunc ";

/* Lower-case macros of <windows.h> and of the headers that it includes. is_windows_macro knows the
 * numbered ones. */
static const char *const windows_words =
    " cdecl ctlFirst ctlLast environ errno exception_info far h_addr h_errno hyper near pascal "
    "pshHelp s_addr s_host s_imp s_impno s_lh s_net small ";

/* What the generator declares in every body. */
static const char *const taken_words =
    " frame camera light light_view view scene_center scene_radius scene_materials scene_texture "
    "scene_textures scene_vertices scene_indices vertex_position vertex_normal vertex_uv "
    "vertex_material vertex_triangle scene_objects scene_object SceneObject dispatch_size "
    "invocation fullscreen_position interleave_class interleave_pixel interleave_split PI EXACT "
    "VERTEX FRAGMENT COMPUTE OPENGL VULKAN View Light Frame Live SceneMaterial SceneVertex ";

static bool in_words(const char *words, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = words; (at = strstr(at, name)); at++)
        if (at[-1] == ' ' && at[length] == ' ')
            return true;
    return false;
}

static bool skip(const char **at, const char *prefix)
{
    size_t length = strlen(prefix);
    bool there = !strncmp(*at, prefix, length);
    *at += there ? length : 0;
    return there;
}

/* Names such as mat2x3, usampler2DArray, iimageBuffer, textureCube. */
static bool is_glsl_type(const char *name)
{
    static const char *const shapes[] = {"1D",     "2DRect", "2DMS", "2D",
                                         "3DRect", "3D",     "Cube", "Buffer"};
    const char *at = name + (*name == 'd');
    if (skip(&at, "mat") && *at >= '2' && *at <= '4')
        return !at[1] || (at[1] == 'x' && at[2] >= '2' && at[2] <= '4' && !at[3]);
    at = name + (*name == 'i' && strncmp(name, "image", 5) != 0) + (*name == 'u');
    if (!skip(&at, "sampler") && !skip(&at, "image") && !skip(&at, "texture"))
        return false;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        if (skip(&at, shapes[i])) {
            skip(&at, "Array");
            skip(&at, "Shadow");
            return !*at;
        }
    return false;
}

/* Macros of <stdint.h>, <limits.h> and diptych.h, such as INT32_MAX, UINT8_C, DT_ERROR. */
static bool is_macro(const char *name)
{
    static const char *const ends[] = {"_MAX", "_MIN", "_C", "_WIDTH", "_BIT"};
    size_t length = strlen(name);
    if (!strncmp(name, "DT_", 3))
        return true;
    for (const char *at = name; *at; at++)
        if (islower((unsigned char)*at))
            return false;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (length > strlen(ends[i]) && !strcmp(name + length - strlen(ends[i]), ends[i]))
            return true;
    return false;
}

/* <dlgs.h> has numbers for the controls of dialogs, such as rad1, stc32. */
static bool is_windows_macro(const char *name)
{
    static const char *const controls[] = {"chx", "cmb", "ctl", "edt", "frm", "grp", "ico",
                                           "lst", "psh", "rad", "rct", "scr", "stc"};
    for (size_t i = 0; i < sizeof controls / sizeof *controls; i++) {
        const char *at = name;
        if (skip(&at, controls[i]) && isdigit((unsigned char)*at))
            return !at[strspn(at, "0123456789")];
    }
    return in_words(windows_words, name);
}

enum { MOST_NAME = 100 }; /* PIPELINE.PASS.comp.spv is the name of a file */

enum scope {
    EVERYWHERE,
    SCOPED, /* in the scope of another name */
    BODIES  /* no C has it */
};

/* What is wrong with a name, as a format for it; NULL: nothing. */
static const char *refusal_of(const char *name, enum scope scope)
{
    bool c = scope != BODIES, scoped = scope == SCOPED;
    bool counters = !c && !strncmp(name, "gl_AtomicCounterBlock_", 22); /* a buffer, to glslang */
    return !strncmp(name, "gl_", 3) && !counters ? "`%s`: names that start with gl_ belong to GLSL"
           : c && strstr(name, "__")
               ? "`%s`: names with two underscores in a row are reserved in GLSL"
           : in_words(glsl_words, name) || is_glsl_type(name) || (c && in_words(c_words, name))
               ? "`%s` is a reserved word of GLSL, C or C++; choose another name"
           : c && is_macro(name) ? "`%s` may be a macro of a C header; choose another name"
           : c && *name == '_' && isupper((unsigned char)name[1])
               ? "`%s`: C reserves names that start with _ and a capital"
           : !scoped && in_words(function_words, name)
               ? "`%s` is a function of GLSL; choose another name"
           : !scoped && in_words(taken_words, name)
               ? "`%s` is already a name in every pass body; choose another"
               : NULL;
}

bool name_is_free(const char *name)
{
    return strlen(name) <= MOST_NAME && !refusal_of(name, EVERYWHERE) && !is_windows_macro(name);
}

static void check_word(struct checker *c, const char *name, struct loc loc, enum scope scope)
{
    const char *refusal = refusal_of(name, scope);
    if (strlen(name) > MOST_NAME)
        diag_error(c->diag, loc, "the name `%.20s...` has %zu characters; at most %d", name,
                   strlen(name), MOST_NAME);
    else if (refusal)
        diag_error(c->diag, loc, refusal, name);
}

void check_body_words(struct checker *c, const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++)
        if (pass->accesses[i].as)
            check_word(c, pass->accesses[i].as, pass->accesses[i].as_loc, BODIES);
}

/* A member of a struct in the generated header, which has no prefix there. */
static void check_member(struct checker *c, const char *name, struct loc loc)
{
    if (is_windows_macro(name))
        diag_error(c->diag, loc, "`%s` is a macro of <windows.h>; choose another name", name);
}

/* ---- Declarations ---------------------------------------------------------------------------- */

struct declaration {
    const char *name, *word; /* as declared; as bodies and C see it: see word_of */
    enum declared_kind kind;
    struct loc loc;
};

/* The name of an instance's entry as bodies and C see it: second_views. */
static const char *word_of(struct checker *c, const char *name)
{
    struct text word = {0};
    if (!strchr(name, '.'))
        return name;
    text_add_word(&word, name);
    name = arena_strndup(c->model->arena, word.data ? word.data : "?", word.data ? word.length : 1);
    text_free(&word);
    c->out_of_memory |= !name;
    return name ? name : "?";
}

static void collect(struct checker *c, struct declaration *list)
{
    struct declared *of;
    enum declared_kind kind;
    for (size_t i = 0; (of = declared_at(c->pipeline, i, &kind)); i++)
        list[i] = (struct declaration){of->name, word_of(c, of->name), kind, of->loc};
}

static bool comes_before(struct loc a, struct loc b)
{
    return a.source == b.source && (a.line < b.line || (a.line == b.line && a.column < b.column));
}

static void report_twice(struct checker *c, const struct declaration *a,
                         const struct declaration *b)
{
    const struct declaration *first = comes_before(b->loc, a->loc) ? b : a,
                             *second = first == a ? b : a;
    if (second->kind == DECLARED_PASS)
        diag_error(c->diag, second->loc, "two passes are named `%s`", second->name);
    else
        diag_error(c->diag, second->loc, "the %s `%s` has the same name as a %s; rename one",
                   declared_word(second->kind), second->word, declared_word(first->kind));
    diag_note(c->diag, first->loc, "first here");
}

/* Names that the generator derives from a declaration must not be declared as well. */
static void check_derived(struct checker *c, const struct declaration *list, size_t count,
                          const struct declaration *of)
{
    size_t length = strlen(of->word);
    for (size_t i = 0; i < count; i++) {
        const char *name = list[i].word;
        if (strncmp(name, of->name, length))
            continue;
        EACH(derived, derived_words, DERIVED_WORDS)
            if (derived->reserved && of->kind & derived->kinds &&
                !strcmp(name + length, derived->ending))
                diag_error(
                    c->diag, list[i].loc,
                    "`%s` is already a name in pass bodies, made from the %s `%s`; rename one",
                    name, declared_word(of->kind), of->word);
    }
}

/* ---- Names in the generated C ---------------------------------------------------------------- */

/* Parameters, constants, resources and passes become macros and enumerators in capitals, each kind
 * with its own prefix. A vector parameter gives NAME_X, NAME_Y and so on. */
struct capital {
    const char *name, *capitals;
    enum declared_kind kinds; /* of the names with this prefix */
    struct loc loc;
};

static void add_capital(struct checker *c, struct capital *list, size_t *count,
                        const struct declared *of, unsigned kinds, const char *component)
{
    char *capitals = arena_printf(c->model->arena, "%s%s", word_of(c, of->name), component);
    for (char *at = capitals; at && *at; at++)
        *at = (char)toupper((unsigned char)*at);
    if (capitals)
        list[(*count)++] = (struct capital){word_of(c, of->name), capitals, kinds, of->loc};
}

static size_t collect_capitals(struct checker *c, struct capital *list)
{
    static const char *const components[] = {"_x", "_y", "_z", "_w"};
    static const unsigned prefixes[] = {DECLARED_CONSTANT, DECLARED_RESOURCE, DECLARED_PASS};
    enum declared_kind kind;
    struct declared *of;
    size_t count = 0;
    for (size_t i = 0; (of = declared_at(c->pipeline, i, &kind)); i++) {
        uint32_t parts = kind & DECLARED_PARAM ? ((struct param *)of)->components : 0;
        for (uint32_t k = 0; k < parts && k < DT_ARRAY_COUNT(components); k++)
            add_capital(c, list, &count, of, DECLARED_PARAM, parts > 1 ? components[k] : "");
        for (size_t k = 0; k < DT_ARRAY_COUNT(prefixes); k++)
            if (kind & prefixes[k])
                add_capital(c, list, &count, of, prefixes[k], "");
    }
    return count;
}

/* Skips identical names, which check_names reports. */
static void check_capitals(struct checker *c, size_t declarations)
{
    struct capital *list = arena_alloc(c->model->arena, (4 * declarations + 1) * sizeof *list);
    size_t count = list ? collect_capitals(c, list) : 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i; k++) {
            const struct capital *first = &list[k], *second = &list[i];
            if (first->kinds != second->kinds || strcmp(first->capitals, second->capitals) ||
                !strcmp(first->name, second->name))
                continue;
            if (comes_before(second->loc, first->loc)) {
                first = &list[i];
                second = &list[k];
            }
            diag_error(c->diag, second->loc,
                       "`%s` and `%s` become one name in the generated C, which writes them in "
                       "capitals; rename one",
                       second->name, first->name);
            diag_note(c->diag, first->loc, "`%s` is declared here", first->name);
            k = i; /* once for each name */
        }
}

/* The generated C has a struct NAME_live beside `struct NAME_Vpl`. */
static void check_structure(struct checker *c, const struct structure *structure)
{
    if (!strcmp(structure->name, "live"))
        diag_error(c->diag, structure->loc,
                   "`%s` is taken: the generated C has a struct of that name", structure->name);
    EACH(field, structure->fields, structure->field_count) {
        check_word(c, field->name, field->loc, SCOPED);
        check_member(c, field->name, field->loc);
    }
}

/* ---- Words of one pass ----------------------------------------------------------------------- */

/* Checks the `as` name of an access against the pass's other accesses and its ranges. Mips and
 * layers of an image may have a name each. */
static void check_word_once(struct checker *c, const struct pass *pass, uint32_t index)
{
    const struct access *access = &pass->accesses[index];
    const struct resource *resource = declared_find(c->pipeline, DECLARED_RESOURCE, access->name);
    bool image = resource && resource->kind == DT_IMAGE;
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *other = &pass->accesses[i];
        bool same_word = !strcmp(access_word(other), access->as),
             same_resource = !strcmp(other->name, access->name);
        if (same_word == same_resource || (i > index && other->as) || (!same_word && image))
            continue;
        if (same_word)
            diag_error(c->diag, access->as_loc, "the pass `%s` calls both `%s` and `%s` `%s`",
                       pass->name, other->name, access->name, access->as);
        else
            diag_error(c->diag, access->as_loc,
                       "the pass `%s` lists `%s` under two names, `%s` and `%s`; use one",
                       pass->name, access->name, access_word(other), access->as);
        return;
    }
}

/* Reports a name in a pass that is one of the declarations, or of the pass's ranges. */
static void refuse_taken(struct checker *c, const struct pass *pass, const char *name,
                         struct loc loc, const struct declaration *list, size_t count,
                         const char *what)
{
    for (size_t i = 0; i < count; i++)
        if (!strcmp(list[i].word, name)) {
            diag_error(c->diag, loc, "`%s` is already a %s; choose an unused name%s", name,
                       declared_word(list[i].kind), what);
            diag_note(c->diag, list[i].loc, "declared here");
        }
    for (uint32_t i = 0; i < pass->range_count; i++)
        if (!strcmp(pass->ranges[i].name, name))
            diag_error(c->diag, loc, "`%s` is a range of the pass `%s`", name, pass->name);
}

/* A macro replaces its name everywhere in the body, so nothing else may have this name. */
static void check_defines(struct checker *c, const struct pass *pass, struct declaration *list,
                          size_t count)
{
    EACH(define, pass->defines, pass->define_count) {
        const char *name = define->name;
        const struct declaration macro = {name, name, 0, define->loc};
        check_word(c, name, macro.loc, EVERYWHERE);
        for (size_t k = 0; k < count; k++)
            check_derived(c, &macro, 1, &list[k]);
        refuse_taken(c, pass, name, macro.loc, list, count, "");
        for (uint32_t s = 0; !define->word && s < c->pipeline->struct_count; s++)
            for (uint32_t k = 0; k < c->pipeline->structs[s].field_count; k++)
                if (!strcmp(c->pipeline->structs[s].fields[k].name, name))
                    diag_error(c->diag, macro.loc,
                               "`%s` is a field of `%s`, which the macro would replace", name,
                               c->pipeline->structs[s].name);
    }
}

/* An `as` name must be unique among the declared names, or a body could confuse the resource with
 * another declaration. */
static void check_words(struct checker *c, const struct pass *pass, struct declaration *list,
                        size_t count)
{
    size_t all = count;
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
        const struct resource *resource =
            declared_find(c->pipeline, DECLARED_RESOURCE, access->name);
        if (!access->as || !strcmp(access->as, word_of(c, access->name)))
            continue;
        check_word_once(c, pass, i);
        refuse_taken(c, pass, access->as, access->as_loc, list, count, " for `as`");
        for (size_t k = 0; k < count; k++)
            check_derived(c, &(struct declaration){access->as, access->as, 0, access->as_loc}, 1,
                          &list[k]);
        list[all++] = (struct declaration){access->as, access->as,
                                           resource && resource->kind == DT_BUFFER ? DECLARED_BUFFER
                                                                                   : DECLARED_IMAGE,
                                           access->as_loc};
        unsigned errors = diag_error_count(c->diag);
        check_derived(c, list, all - 1, &list[all - 1]);
        if (diag_error_count(c->diag) > errors)
            diag_note(c->diag, access->as_loc, "the pass `%s` lists `%s` under this name",
                      pass->name, access->name);
    }
    check_defines(c, pass, list, all);
}

void check_names(struct checker *c)
{
    const struct pipeline *p = c->pipeline;
    enum declared_kind kind;
    size_t all = 0, words = 0; /* most accesses of one pass */
    while (declared_at(p, all, &kind))
        all++;
    EACH(pass, p->passes, p->pass_count)
        words = pass->access_count > words ? pass->access_count : words;
    struct declaration *list = arena_alloc(c->model->arena, (all + words + 1) * sizeof *list);
    if (!list)
        return;
    collect(c, list);
    size_t count = all - p->pass_count; /* passes have a scope of their own */
    if (p->name)
        check_word(c, p->name, p->loc, SCOPED);
    for (size_t i = 0; i < all; i++) {
        check_word(c, list[i].word, list[i].loc, i >= count ? SCOPED : EVERYWHERE);
        check_derived(c, list, count, &list[i]);
        for (size_t k = i < count ? 0 : count; k < i; k++)
            if (!strcmp(list[i].word, list[k].word)) {
                report_twice(c, &list[k], &list[i]);
                break;
            }
    }
    EACH(param, p->params, p->param_count)
        check_member(c, param->name, param->loc);
    EACH(structure, p->structs, p->struct_count)
        check_structure(c, structure);
    EACH(pass, p->passes, p->pass_count)
        check_words(c, pass, list, count);
    check_capitals(c, all);
}

/* ---- References ------------------------------------------------------------------------------ */

static void report_unknown_resource(struct checker *c, struct loc loc, const char *what,
                                    const char *name, unsigned kinds)
{
    if (declared_find(c->pipeline, DECLARED_FUNCTION, name))
        diag_error(c->diag, loc, "`%s` is no buffer or image; list it in `uses`", name);
    else if (declared_find(c->pipeline, DECLARED_RESOURCE & ~kinds, name))
        diag_error(c->diag, loc, "`%s` is %s, not %s", name,
                   kinds & DECLARED_IMAGE ? "a buffer" : "an image",
                   kinds & DECLARED_IMAGE ? "an image" : "a buffer");
    else
        report_missing(c, loc, what, name, kinds);
}

static void resolve_element(struct checker *c, struct resource *buffer)
{
    if (!buffer->of)
        return;
    buffer->structure = declared_find(c->pipeline, DECLARED_STRUCT, buffer->of);
    int type = table_choice(table_find(SECTION_STRUCT, "*")->choices, buffer->of);
    if (type >= 0 && type != DT_TYPE_BOOL && !buffer->structure)
        buffer->type = (enum dt_type)type;
    else if (!buffer->structure)
        report_missing(c, buffer->of_loc, "struct or type", buffer->of,
                       DECLARED_STRUCT | DECLARED_TYPE);
}

static void resolve_filter(struct checker *c, struct access *access)
{
    const char *name = access->sampler;
    access->filter = declared_find(c->pipeline, DECLARED_FILTER, name);
    if (access->filter)
        return;
    if (declared_find(c->pipeline, DECLARED_POINTS, name))
        diag_error(c->diag, access->sampler_loc,
                   "`%s` is a point set; an image is read through a sampler of kind filter", name);
    else
        report_missing(c, access->sampler_loc, "sampler", name, DECLARED_FILTER);
}

/* A builtin is read as a whole, under its own name. */
static void refuse_scene_keys(struct checker *c, const struct access *access)
{
    const struct loc nowhere = {0};
    const struct {
        const char *key;
        bool given;
        struct loc loc;
    } keys[] = {{"sampler", access->sampler, access->sampler_loc},
                {"mip", access->mip, access->mip ? expr_loc(access->mip) : nowhere},
                {"layer", access->layer, access->layer ? expr_loc(access->layer) : nowhere},
                {"blend", access->own_blend, access->blend_loc},
                {"mask", access->own_mask, access->mask_loc}};
    if (access->as)
        diag_error(c->diag, access->as_loc, "`%s` has one name in every body; leave `as` out",
                   access->name);
    for (size_t i = 0; i < DT_ARRAY_COUNT(keys); i++)
        if (keys[i].given)
            diag_error(c->diag, keys[i].loc, "`%s` is the scene's and has no `%s`", access->name,
                       keys[i].key);
    if (access->mode != MODE_READ)
        diag_error(c->diag, access->loc, "`%s` belongs to the scene and can only be read",
                   access->name);
}

static void resolve_access(struct checker *c, struct access *access)
{
    access->resource = declared_find(c->pipeline, DECLARED_RESOURCE, access->name);
    for (int i = 0; !access->resource && i < SCENE_RESOURCES; i++)
        if (!strcmp(scene_resources[i], access->name))
            access->builtin = (uint16_t)(DT_SCENE_VERTICES + i);
    if (!access->resource && !access->builtin)
        report_unknown_resource(c, access->loc, "buffer or image", access->name,
                                DECLARED_RESOURCE | DECLARED_SCENE);
    if (access->builtin)
        refuse_scene_keys(c, access);
    else if (access->sampler)
        resolve_filter(c, access);
}

static void resolve_use(struct checker *c, const char *name, struct loc loc)
{
    const struct pipeline *p = c->pipeline;
    if (declared_find(p, DECLARED_FILTER, name))
        diag_error(c->diag, loc,
                   "`%s` filters images: name it in `reads`, {name: IMAGE, sampler: %s}", name,
                   name);
    else if (declared_find(p, DECLARED_RESOURCE, name))
        diag_error(c->diag, loc,
                   "`%s` is a buffer or image; list it in `reads`, `writes` or `updates`", name);
    else if (!declared_find(p, DECLARED_FUNCTION, name))
        report_missing(c, loc, "point set, metric or interleave", name, DECLARED_FUNCTION);
}

/* Adds the interleave of a dispatch to `uses`, unless the pass lists it. */
static void add_use(struct checker *c, struct pass *pass, const char *name)
{
    for (uint32_t i = 0; i < pass->use_count; i++)
        if (!strcmp(pass->uses[i], name))
            return;
    const char **uses = arena_alloc(c->model->arena, (pass->use_count + 1) * sizeof *uses);
    struct loc *locs = arena_alloc(c->model->arena, (pass->use_count + 1) * sizeof *locs);
    if (!uses || !locs) {
        c->out_of_memory = true;
        return;
    }
    for (uint32_t i = 0; i < pass->use_count; i++) {
        uses[i] = pass->uses[i];
        locs[i] = pass->use_locs[i];
    }
    uses[pass->use_count] = name;
    locs[pass->use_count] = pass->interleave_loc;
    pass->uses = uses;
    pass->use_locs = locs;
    pass->use_count++;
}

static void resolve_interleave(struct checker *c, struct pass *pass)
{
    const char *name = pass->interleave_name;
    pass->interleave = declared_find(c->pipeline, DECLARED_INTERLEAVE, name);
    if (pass->interleave)
        add_use(c, pass, name);
    else
        report_missing(c, pass->interleave_loc, "interleave", name, DECLARED_INTERLEAVE);
}

static void resolve_after(struct checker *c, const struct pass *pass, uint32_t index)
{
    const char *name = pass->after[index];
    struct loc loc = pass->after_locs[index];
    if (!strcmp(name, pass->name))
        diag_error(c->diag, loc, "the pass `%s` cannot run after itself", name);
    else if (!declared_find(c->pipeline, DECLARED_PASS, name))
        report_missing(c, loc, "pass", name, DECLARED_PASS);
}

static struct resource *resolve_buffer(struct checker *c, const char *name, struct loc loc)
{
    struct resource *buffer = declared_find(c->pipeline, DECLARED_BUFFER, name);
    if (!buffer)
        report_unknown_resource(c, loc, "buffer", name, DECLARED_BUFFER);
    return buffer;
}

static void resolve_ranges(struct checker *c, struct pass *pass)
{
    CHANGE_EACH(range, pass->ranges, pass->range_count) {
        check_word(c, range->name, range->loc, EVERYWHERE);
        if (!range->of || !resolve_buffer(c, range->of, range->of_loc))
            continue;
        for (uint32_t k = 0; k < pass->access_count; k++)
            if (pass->accesses[k].mode == MODE_READ && !strcmp(pass->accesses[k].name, range->of))
                range->access = &pass->accesses[k];
        if (!range->access)
            diag_error(c->diag, range->of_loc,
                       "the range `%s` runs over `%s`, which the pass `%s` does not list in reads",
                       range->name, range->of, pass->name);
    }
}

static void resolve_pass(struct checker *c, struct pass *pass)
{
    CHANGE_EACH(access, pass->accesses, pass->access_count)
        resolve_access(c, access);
    for (uint32_t i = 0; i < pass->use_count; i++)
        resolve_use(c, pass->uses[i], pass->use_locs[i]);
    for (uint32_t i = 0; i < pass->after_count; i++)
        resolve_after(c, pass, i);
    if (pass->interleave_name)
        resolve_interleave(c, pass);
    if (pass->dispatch_image)
        pass->size_resource = declared_find(c->pipeline, DECLARED_RESOURCE, pass->dispatch_image);
    if (pass->indirect)
        pass->indirect_resource = resolve_buffer(c, pass->indirect, pass->indirect_loc);
    if (pass->indices)
        pass->index_resource = resolve_buffer(c, pass->indices, pass->indices_loc);
    resolve_ranges(c, pass);
}

static void resolve_output(struct checker *c, const char *name, struct loc loc)
{
    if (name && !declared_find(c->pipeline, DECLARED_IMAGE, name))
        report_unknown_resource(c, loc, "image", name, DECLARED_IMAGE);
}

static void resolve_weight(struct checker *c, const struct weight *weight)
{
    const struct param *param =
        weight->param ? declared_find(c->pipeline, DECLARED_PARAM, weight->param) : NULL;
    if (param && param->type != DT_TYPE_FLOAT)
        diag_error(c->diag, weight->loc, "a weight must be a float; `%s` is not", param->name);
    else if (param && (param->live ? param->min : param->value[0]) < 0)
        diag_error(c->diag, weight->loc, "a weight cannot be negative: give `%s` a min of 0",
                   param->name);
    else if (weight->param && !param)
        report_missing(c, weight->loc, "parameter", weight->param, DECLARED_FLOAT);
}

void check_references(struct checker *c)
{
    EACH(metric, c->pipeline->metrics, c->pipeline->metric_count) {
        resolve_weight(c, &metric->position);
        resolve_weight(c, &metric->normal);
    }
    CHANGE_EACH(resource, c->pipeline->resources, c->pipeline->resource_count)
        if (resource->kind == DT_BUFFER)
            resolve_element(c, resource);
    CHANGE_EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        resolve_pass(c, pass);
    resolve_output(c, c->pipeline->linear_output, c->pipeline->linear_loc);
    resolve_output(c, c->pipeline->display_output, c->pipeline->display_loc);
}
