/* The model: one pipeline spec as the stages of diptych-gen see it. read fills it from YAML, check
 * verifies and resolves names, layout and plan add their decisions, the emitters read it const.
 * Every node has its location in the source. All memory is in the model's arena. Arrays are
 * pointer + count. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/diag.h"
#include "base/each.h"
/* enums and structs of generated code, which the model has, too */
#include "panel.h"

/* ---- Places and expressions ------------------------------------------------------------------ */

struct npy;  /* header of an array file (base/npy.h) */
struct expr; /* integer over parameters, constants, frame.width and frame.height (expr.h) */

/* ---- Declarations ---------------------------------------------------------------------------- */

struct param {
    const char *name, *doc;
    struct loc loc, value_loc;
    /* FLOAT, INT, UINT, a vector of these, or BOOL; from `type`, else from the value */
    enum dt_type type;
    uint32_t components;
    double value[4];
    double min, max; /* each component; +-INFINITY when absent */
    double step;     /* for sliders; 0 when absent */
    bool live;
    bool uniform;    /* not live, but in the parameter block, after the live ones */
    uint32_t offset; /* layout: byte offset in the block of live and uniform parameters */
};

struct constant { /* named integer expression */
    const char *name, *doc;
    struct loc loc;
    struct expr *value;
    bool literal; /* a literal in GLSL even when it depends on uniform parameters */
    bool folds;   /* check: depends on baked parameters alone */
    int64_t folded;
    size_t terms; /* check: see expr_terms */
};

struct field {
    const char *name, *doc; /* doc: none */
    struct loc loc;
    enum dt_type type;
    uint32_t array_count;          /* 0: no array */
    uint32_t offset, array_stride; /* layout, std430 */
};

struct structure {
    const char *name, *doc;
    struct loc loc;
    struct field *fields;
    uint32_t field_count;
    uint32_t align, stride; /* layout, std430; stride is the array stride */
};

struct contract {
    struct dt_contract allowed; /* check resolves the margin */
    struct loc loc;
    const char *margin; /* BUFFER or BUFFER.FIELD; NULL: none */
    struct loc margin_loc;
};

struct resource {
    const char *name, *doc;
    struct loc loc;
    enum dt_kind kind;
    bool history;     /* also true for content from outside, which no pass writes */
    bool input;       /* content from outside: from `file`, or from `--input` or a host */
    bool keep;        /* shares no memory */
    bool internal;    /* the generator's own: no list of a pass shows it */
    const char *file; /* as written; NULL: none */
    struct loc file_loc;
    const char *file_path; /* read: where it was found; NULL: it was not, or cannot be read */
    struct contract contract;
    /* buffers */
    const char *of; /* struct or type name */
    struct loc of_loc;
    struct structure *structure; /* check; NULL when of is a type */
    enum dt_type type;           /* when structure is NULL */
    struct expr *count;
    const struct npy *array; /* read: header of the file */
    uint32_t stride;         /* layout */
    uint32_t block;          /* plan: declared bytes of its uniform blocks; 0: count * stride */
    /* images */
    enum dt_format format;
    enum dt_shape shape;
    /* layers: also the depth of a 3D image and the faces of a cube; NULL: a single 2D image. mips
     * NULL: 1 */
    struct expr *width, *height, *layers, *mips;
    double clear[4]; /* `clear`, default 0; depth: 1 */
    unsigned srgb;   /* 1: `encoding: srgb`: pictures from outside hold sRGB codes */
    bool encoding_is_given;
    struct loc encoding_loc;
    bool filter_mips; /* passes of read_copies.c fill the mips */
    /* plan */
    uint32_t index;            /* in pipeline->resources */
    unsigned usage;            /* mask of enum dt_access over all passes */
    int first_pass, last_pass; /* in execution order; -1: unused. History spans the frame. */
    uint32_t slot;             /* Vulkan memory slot */
    int share;                 /* OpenGL: resource whose texture it uses; -1: its own */
    uint64_t bytes;            /* at the reference frame size 1920x1080 */
};

enum sampler_kind { SAMPLER_HAMMERSLEY, SAMPLER_FILTER };
enum sampler_map { MAP_SQUARE, MAP_POLAR_DISK, MAP_CONCENTRIC_DISK };
struct sampler {
    const char *name, *doc;
    struct loc loc;
    enum sampler_kind kind;
    struct expr *count; /* hammersley */
    enum sampler_map map;
    unsigned linear, linear_mip; /* filter: 0 or 1 */
    bool compare;
    enum dt_wrap wrap;
    enum dt_border border; /* DT_WRAP_BORDER */
    double anisotropy;     /* 1 */
};

enum normal_term {
    TERM_ONE_MINUS_DOT,
    TERM_DOT
}; /* w2 (1 - (a.b)+), and Equation 2 as printed: w2 (a.b)+ */
struct weight {
    double value;
    const char *param; /* parameter to use instead of `value`, or NULL */
    struct loc loc;
};

struct metric {
    const char *name, *doc;
    struct loc loc;
    struct weight position, normal;
    const char *position_field, *normal_field; /* default "position", "normal" */
    enum normal_term normal_term;
    const char *scale; /* divides lengths: "scene_radius", or a number as text */
};

struct interleave {
    const char *name, *doc;
    struct loc loc;
    struct expr *x, *y; /* tile size; baked */
    uint32_t tile[2];   /* check */
};

/* ---- Passes ---------------------------------------------------------------------------------- */

enum access_mode { MODE_READ, MODE_WRITE, MODE_UPDATE };
struct access {
    const char *name; /* of the resource; "scene_vertices" etc. are builtins: see builtin */
    struct loc loc;
    const char *as; /* its name in the body; NULL: `name`. See access_word */
    struct loc as_loc;
    enum access_mode mode;
    uint32_t previous;   /* frames back; `name` is then of the image that keeps them */
    struct expr *mip;    /* NULL: mip 0 for storage and targets, all mips for sampling */
    struct expr *layer;  /* one layer of an array, in the body a plain image; NULL: all */
    const char *sampler; /* reads: {name: X, sampler: S}: filtered; NULL: by texel */
    struct loc sampler_loc;
    /* read: colour targets; `blend` is the pass's unless the access has its own */
    const struct dt_blend *blend; /* NULL: off */
    bool own_blend, own_mask;
    bool clears;  /* the pass clears it, before its work */
    bool stores;  /* an image of a draw, whose fragments store texels of it: no target */
    uint8_t keep; /* channels that `mask` leaves out, red in bit 0 */
    struct loc blend_loc, mask_loc;
    struct resource *resource;       /* check; NULL for a builtin */
    uint16_t builtin;                /* enum dt_builtin; 0: none */
    struct sampler *filter;          /* check */
    uint32_t mip_value, layer_value; /* check */
    unsigned kind;                   /* plan: mask of enum dt_access */
    int binding;    /* plan: in the pass's numbering; -1: none (attachment, index, indirect) */
    int attachment; /* plan: colour attachment number; -1 */
    bool codes;     /* plan: of a texture without sRGB, see panel.h */
};
/* The resource's name in the body. */
static inline const char *access_word(const struct access *access)
{
    return access->as ? access->as : access->name;
}

/* Names of the scene's resources, from DT_SCENE_VERTICES on (check_names.c). */
enum { SCENE_RESOURCES = DT_SCENE_TEXTURES - DT_SCENE_VERTICES + 1 };
extern const char *const scene_resources[SCENE_RESOURCES];

/* STORAGE_AUTO, where the plan leaves it: read in place, as the kind of the access says. */
enum storage_class { STORAGE_AUTO, STORAGE_SHARED, STORAGE_BUFFER, STORAGE_UNIFORM };
enum loop_shape { LOOP_AUTO, LOOP_UNROLL, LOOP_ROLL };

/* `count` elements of a buffer, one after the other, the same for all invocations of a workgroup.
 * The body iterates with `for (Type v : name) { ... }`. The plan chooses storage and loop shape. */
struct range {
    const char *name, *doc; /* doc: none */
    struct loc loc, of_loc;
    const char *of;        /* buffer, among the pass's reads */
    struct access *access; /* check */
    const char *first;     /* GLSL int expression, uniform over the workgroup; default "0" */
    struct expr *count;    /* folds at generation */
    int64_t count_value;   /* check */
    enum storage_class storage;
    enum loop_shape loop;
    bool reads_images; /* check: a loop over it reads images */
    int32_t words;     /* check: identifiers in its loops, with those of called functions */
    uint32_t chunk;    /* plan: elements per copy and per unrolled block */
    uint32_t turn;     /* plan: elements per turn of a rolled loop over a chunk; else 1 */
    bool counted;      /* plan: the shader reads the count, so all counts share one shader */
};

struct define { /* a macro of the body */
    const char *name;
    struct loc loc;
    struct expr *value; /* baked, unless `word` */
    bool word;          /* a name of the instance; emitted only if the body uses it */
    const char *param;  /* of an argument: the parameter of any type that it is; then no value */
};

/* What a uniform or an input of a whole shader holds. */
struct value {
    const char *name, *text; /* GLSL: TYPE(...) */
    struct loc loc;          /* of the text */
};

enum pass_size { SIZE_INVOCATIONS, SIZE_GROUPS, SIZE_IMAGE, SIZE_INTERLEAVE, SIZE_INDIRECT };

struct barrier { /* before the pass: the accesses that `resource` waits for */
    struct resource *resource;
    unsigned from; /* mask of enum dt_access of the earlier passes (0: first touch in the frame) */
    unsigned from_stages;   /* enum dt_stage of those accesses */
    bool from_writes;       /* the earlier accesses wrote: memory dependency, not only execution */
    unsigned to, to_stages; /* the accesses that wait */
    bool discard;           /* first touch of a transient: content undefined */
    /* first touch of a slot that another resource used before, else NULL */
    const struct resource *alias;
};

/* Undefined behaviour that a pass means: --sanitize does not tell it. */
struct allow {
    unsigned kind; /* enum sanitize_kind */
    struct loc loc;
};
/* In the order of the key's choices. Of a pass `bounded`: fast, unless the spec is exact. */
enum exactness { EXACTNESS_EXACT, EXACTNESS_BOUNDED, EXACTNESS_FAST };

struct pass {
    const char *name, *doc;
    struct loc loc;
    enum dt_pass_kind kind;
    bool fast;    /* the driver's compiler is free */
    bool bounded; /* its own `exactness` makes it so: judged against its exact twin */
    /* scene draws: "camera" or "light", the View that the body calls `view` */
    const char *view;
    /* layered draw: instances, and layers of the targets; NULL: 1, not layered */
    struct expr *layers;
    struct access *accesses; /* reads, writes, updates in the order of the spec */
    uint32_t access_count;
    const char **uses; /* names of hammersley samplers, metrics, interleaves */
    struct loc *use_locs;
    uint32_t use_count;
    const char *shader; /* path as written */
    const char *more;   /* a second file, which follows; NULL: none */
    struct loc shader_loc;
    const struct source *body;      /* check: the file, read once */
    const struct body_files *files; /* check: it and what it may include */
    struct expr *when;              /* NULL: always */
    const char *when_text;          /* as written */
    const char **after;             /* explicit order */
    struct loc *after_locs;
    uint32_t after_count;
    /* dispatch */
    enum pass_size size;
    struct expr *dispatch[3];       /* invocations or groups */
    const char *dispatch_image;     /* SIZE_IMAGE: one invocation per texel of this image */
    struct resource *size_resource; /* check: of dispatch_image, or the indirect buffer */
    /* `interleave: tile`: one z per class, x and y over the class's pixels */
    const char *interleave_name;
    struct interleave *interleave; /* check */
    const char *indirect;          /* buffer of arguments, for dispatches and scene draws */
    struct resource *indirect_resource;
    const char *indices; /* scene draws: index buffer that a pass writes */
    struct resource *index_resource;
    uint32_t local[3]; /* workgroup size: read sets the default, check the value of local_size */
    struct expr *local_size[3]; /* as written; NULL: not given */
    bool minds_group;           /* check: the body depends on the size of the workgroup */
    bool asks_length;           /* check: the body has a `.length()` */
    struct range *ranges;
    uint32_t range_count;
    struct define *defines;
    uint32_t define_count;
    struct allow *allows;
    uint32_t allow_count;
    struct value *values;
    uint32_t value_count;
    /* draws */
    enum dt_cull cull;
    bool depth_test, depth_write;
    enum dt_compare depth_compare; /* default LESS */
    uint32_t clip_distances;
    struct expr *vertices, *instances; /* draws of vertices; NULL: indirect; instances NULL: 1 */
    enum dt_topology topology;
    struct expr *viewport[4], *scissor[4]; /* x, y, width, height; NULL: all of the targets */
    double bias_constant, bias_slope;
    bool own_vertices;                                      /* check: the body has a vertex part */
    struct loc blend_loc, topology_loc, bias_loc, clip_loc; /* draws: of the keys, if given */
    /* check and plan */
    struct loc size_loc, indirect_loc, indices_loc, interleave_loc;
    bool conditional; /* `when` depends on live parameters */
    struct barrier *barriers;
    uint32_t barrier_count;
    int frame_binding, live_binding;         /* uniform blocks; every pass has both */
    int textures_binding, materials_binding; /* scene draws; -1: none */
    bool uniform_materials;                  /* plan: materials as a uniform block */
    bool codes;     /* plan and shaders.c: reads the codes of scene_textures, see panel.h */
    uint32_t index; /* in order of execution */
};

struct assertion {
    struct loc loc;
    struct expr *that;
    enum { LEVEL_WARNING, LEVEL_ERROR } level;
    const char *message;
};

struct pipeline {
    const char *spec; /* path of the document; NULL: a model without one */
    const char *name, *doc;
    struct loc loc;
    enum exactness exactness;
    /* Whether storage classes, loop shapes and workgroups are chosen for GPUs: by `target`, and by
     * model.gpu where that is `auto`. */
    bool gpu, automatic;
    bool top; /* origin: top; default bottom */
    struct param *params;
    uint32_t param_count;
    struct constant *constants;
    uint32_t constant_count;
    struct structure *structs;
    uint32_t struct_count;
    struct resource *resources;
    uint32_t resource_count; /* buffers, then images, in the order of the spec */
    struct sampler *samplers;
    uint32_t sampler_count;
    struct metric *metrics;
    uint32_t metric_count;
    struct interleave *interleaves;
    uint32_t interleave_count;
    struct pass *passes;
    uint32_t pass_count;         /* spec order; without passes whose `when` folds to false */
    const struct pass **dropped; /* check: passes whose `when` folds to false, in spec order */
    uint32_t dropped_count;
    struct value *values; /* of every pass that has none of the name */
    uint32_t value_count;
    struct assertion *assertions;
    uint32_t assertion_count;
    struct expr *jitter;                        /* points of the camera's jitter; NULL: none */
    const char *linear_output, *display_output; /* names, or NULL */
    struct loc linear_loc, display_loc;
    /* plan */
    struct pass **order; /* pass_count pointers, in order of execution */
    uint32_t slot_count;
    uint64_t transient_bytes, aliased_bytes; /* at 1920x1080: sum without, with aliasing */
    uint32_t live_size, block_size; /* bytes of the live parameters; of live and uniform ones */
};

/* A value of the spec that --set replaced. */
struct replaced {
    const char *text; /* as YAML */
    struct replaced *next;
};

struct arena;
struct model {
    struct arena *arena;
    struct pipeline pipeline;
    const char **inputs; /* every file that was read, for the depfile */
    uint32_t input_count;
    /* folder with glsl/, for library pieces and included files */
    const char *templates_dir;
    const char *root; /* real path of the folder that holds all files to read; NULL: no limit */
    /* emit_glsl: the file of each source-string number in #line; the numbers start at 1 */
    const struct source **glsl_sources;
    uint32_t glsl_source_count;
    bool text;                    /* also OpenGL's GLSL, which glslang does not compile */
    bool codes;                   /* exact passes read the codes of sRGB textures */
    bool exact_twin;              /* of every pass: none is fast */
    struct cache *cache;          /* of what glslang's preprocessor made; NULL: none */
    bool gpu;                     /* what `target: auto` is: the choices for GPUs */
    struct diag *prove;           /* --prove: reports every open operation of exact passes, and
                                     here the forms of all; NULL: it does not */
    unsigned sanitize;            /* mask of enum sanitize_kind; 0: off */
    struct sanitize_sites *sites; /* sanitize.h */
    struct replaced *replaced;    /* read: a list, or NULL; names in these values count as used */
};

/* format.c: the number nearest to `value` that the channel, 0 to 3, of the format can hold. Drivers
 * round others to either side. */
float format_round(enum dt_format format, int channel, double value);
