/* The table of the spec language's keys, and look-ups in it. */
#include "table.h"

#include <string.h>

static const char param_types[] = /* no matrices */
#define COLUMNS_1(name) "|" name
#define COLUMNS_4(name)
#define DT_TYPE(ENUMERATOR, name, components, columns, ...) COLUMNS_##columns(name)
#include "types.def"
    ;
/* Bool keeps the numbering of enum dt_type; set_type rejects it. */
static const char field_types[] =
#define DT_TYPE(ENUMERATOR, name, ...) "|" name
#include "types.def"
    ;
static const char formats[] =
#define DT_FORMAT(ENUMERATOR, name, ...) "|" name
#include "formats.def"
    ;
#define BLENDS "off|add|over|premultiplied|min|max|multiply"
#define FACTORS                                                                                    \
    "one|zero|src_color|one_minus_src_color|dst_color|one_minus_dst_color|src_alpha|"              \
    "one_minus_src_alpha|dst_alpha|one_minus_dst_alpha"
#define OPERATIONS "add|subtract|reverse_subtract|min|max"

#define INPUT_DOC                                                                                  \
    "true: the content comes from outside, by `--input NAME=FILE` or from the host that runs the " \
    "pipeline, and stays from frame to frame. No pass writes it."
#define KEEP_DOC                                                                                   \
    "true: shares no memory with other resources, so a host may read the content after the frame."

const struct section_info table_sections[SECTION_COUNT] = {
    [SECTION_TOP] = {"the spec", "", "spec", "The top level of a spec.", NULL},
    [SECTION_PARAMS] = {"`params`", "params", "params",
                        "Values to turn. A baked parameter is a literal in the generated code; a "
                        "live one may change at run "
                        "time without regenerating. `--set NAME=VALUE` overrides either.",
                        "clusters: {value: 8, min: 1, max: 64, doc: \"centres of k-means\"}"},
    [SECTION_PARAM] = {"a parameter", "params.NAME", "param",
                       "One parameter. `NAME: VALUE` is short for `NAME: {value: VALUE}`.",
                       "{value: 2, min: 0, max: 2, live: true}"},
    [SECTION_CONSTANTS] =
        {"`constants`", "constants", "constants",
         "Named integer expressions. Those over baked parameters alone become literals.",
         "per_cluster: second_vpls / clusters"},
    [SECTION_CONSTANT] = {"a constant", "constants.NAME", "constant",
                          "One constant. `NAME: EXPR` is short for `NAME: {value: EXPR}`.",
                          "{value: first_vpls / 2, doc: \"half of them\"}"},
    [SECTION_STRUCTS] =
        {"`structs`", "structs", "structs",
         "Element types of buffers, laid out by the rules of std430; the same in GLSL and C.",
         "Vpl: {position: vec3, cluster: uint, normal: vec3, flux: vec3}"},
    [SECTION_STRUCT] = {"a struct", "structs.NAME", "struct",
                        "One struct: a map of field names to types, in the order of memory.",
                        "{position: vec3, weights: \"float[4]\"}"},
    [SECTION_FIELD] = {"a field", "structs.NAME.FIELD", "field",
                       "One field. `FIELD: TYPE` is short for `FIELD: {type: TYPE}`, `FIELD: "
                       "TYPE[N]` for an array.",
                       "{type: float, count: 4}"},
    [SECTION_BUFFERS] =
        {"`buffers`", "buffers", "buffers",
         "Arrays of structs, scalars or vectors. A pass body sees `NAME[i]` and `NAME_count`.",
         "vpls: {of: Vpl, count: first_vpls + second_vpls}"},
    [SECTION_BUFFER] = {"a buffer", "buffers.NAME", "buffer", "One buffer.",
                        "{of: Vpl, count: 512}"},
    [SECTION_IMAGES] =
        {"`images`", "images", "images",
         "Images of two or three dimensions, cube maps, and arrays. A pass body sees `NAME(p)`, "
         "`NAME_size()`, `NAME_store(p, v)`, `NAME_sample(uv)`, or assigns to `NAME` as a target.",
         "gbuffer_normal: {format: rgba16f, size: frame}"},
    [SECTION_IMAGE] = {"an image", "images.NAME", "image", "One image.",
                       "{format: d32f, size: [256, 256], layers: clusters}"},
    [SECTION_SAMPLERS] = {"`samplers`", "samplers", "samplers",
                          "Point sets (`kind: hammersley`: `vec2 NAME(int k)` in passes that list "
                          "it in `uses`; on a disk also `vec2 NAME_map(vec2 u)`, from the unit "
                          "square) and filtering "
                          "state (`kind: filter`: named by a pass's `reads`).",
                          "disk_points: {kind: hammersley, count: 32, map: concentric_disk}"},
    [SECTION_SAMPLER] = {"a sampler", "samplers.NAME", "sampler",
                         "One point set or filtering state.",
                         "{kind: filter, filter: linear, wrap: clamp}"},
    [SECTION_METRICS] =
        {"`metrics`", "metrics", "metrics",
         "Distances between points with normals: `float NAME(pa, na, pb, nb)`, and `NAME(a, b)` "
         "for structs that "
         "have both fields, in passes that list the metric in `uses`. The distance is "
         "position * |pa - pb| / scale + normal * term(na, nb).",
         "vpl_distance: {position: 0.6, normal: 0.4, scale: scene_radius}"},
    [SECTION_METRIC] = {"a metric", "metrics.NAME", "metric", "One metric.",
                        "{position: 0.6, normal: 0.4}"},
    [SECTION_INTERLEAVES] =
        {"`interleaves`", "interleaves", "interleaves",
         "Tiles of interleaved sampling: a tile of x by y splits an image into x * y classes of "
         "pixels. Passes "
         "that use one see `NAME_tile`, `NAME_classes`, `NAME_class`, `NAME_split`, `NAME_gather`, "
         "`NAME_class_size`.",
         "tile: {x: 4, y: 4}"},
    [SECTION_INTERLEAVE] = {"an interleave", "interleaves.NAME", "interleave", "One tile.",
                            "{x: 4, y: 4}"},
    [SECTION_PASS] =
        {"a pass", "passes[]", "pass",
         "One pass: a draw of the scene, of vertices, fullscreen, or a dispatch. It has exactly "
         "one of "
         "`draw`, `dispatch`, "
         "`groups`, `interleave`, or `indirect` alone. Passes run in the order of the list as far "
         "as what they "
         "read and write allows.",
         "{name: tone, dispatch: picture, reads: [light], writes: [picture], shader: tone.glsl}"},
    [SECTION_PASS_INCLUDE] =
        {"an include", "passes[].include", "pass_include",
         "In place of a pass: all that a file declares, with its passes in this place. A file is "
         "looked for beside the including one, then in the templates. Names are unique in all "
         "files together. `pipeline`, `exactness` and `target` stand in the spec alone.",
         "{include: shared/tonemap.yaml}"},
    [SECTION_GROUPS] =
        {"`groups`", "groups", "groups",
         "Passes, resources and constants that belong together, written once and used several "
         "times. "
         "An element {group: NAME} of `passes` makes an instance.",
         "maps: {args: [points], passes: [{name: fill, dispatch: 64, writes: [points], shader: "
         "fill.glsl}]}"},
    [SECTION_GROUP] =
        {"a group", "groups.NAME", "group",
         "One group. Inside, a name means an argument, constant, buffer, image or pass of the "
         "group, "
         "else one of the whole spec. Bodies of its passes use the names that the spec uses there; "
         "only point sets, metrics and interleaves keep their own names in bodies. Parameters, "
         "structs, samplers, metrics, interleaves, contracts and includes stand outside of groups, "
         "since all instances share them: a group names them, or gets them as arguments.",
         "{args: [source, radius], images: {half: {format: rgba16f, size: frame}}, passes: []}"},
    [SECTION_USE] =
        {"a use of a group", "passes[].group", "use",
         "In place of a pass: the passes of a group in this place. What the group declares has the "
         "name INSTANCE.NAME: `second.views` in the spec, in messages and in paths of `--set` "
         "(`passes.second.place.local`), `second_views` in C and in bodies outside of the group.",
         "{group: maps, as: second, with: {points: second_vpls, count: 2 * clusters}}"},
    [SECTION_WITH] = {"`with`", "passes[].with", "with",
                      "A value for each argument of the group: the name of a resource, struct, "
                      "sampler or parameter, an integer expression, or the file of a body.",
                      "{points: second_vpls, count: 2 * clusters}"},
    [SECTION_REPEAT] =
        {"a repeat", "passes[].repeat", "repeat",
         "In place of a pass: the passes of a list, for each number of a range. A pass or a use of "
         "a group may have the key `repeat` itself. The names end in the number: `down.0`, "
         "`down.1`. Expressions and bodies use the number by its name; other texts have it in "
         "braces, as `\"keys_{(k + 1) % 2}\"`. A repeat declares no resources; a repeated group "
         "has "
         "its own for each number. A resource that each number writes again is in `updates`.",
         "{repeat: k in 0 .. levels - 2, passes: [{name: down, dispatch: 64, updates: [{name: "
         "glow, "
         "mip: k}], shader: down.glsl}]}"},
    [SECTION_DRAW] =
        {"a draw of vertices", "passes[].draw", "draw",
         "A draw without a vertex buffer: the vertex part of the body makes each vertex from "
         "`gl_VertexIndex` and `gl_InstanceIndex`, and may read buffers and images. With "
         "`indirect`, the buffer has four numbers for each draw in place of `vertices` and "
         "`instances`: vertices, instances, first vertex, first instance. Which texels a triangle "
         "covers is the same on both backends of one driver, as with the scene. Lines are not: "
         "Vulkan "
         "devices may draw rectangles, where OpenGL has lines of Bresenham. All agree on rows and "
         "columns through centres of texels. `gl_PointSize` may be rounded and clamped. For other "
         "lines give a contract, or draw triangles.",
         "{vertices: 6, instances: particles_alive}"},
    [SECTION_CULL] =
        {"culling", "passes[].cull", "cull",
         "A scene draw that keeps some triangles. The generator adds passes that test each "
         "triangle "
         "and list those to keep, in their order: NAME.size, NAME.test, NAME.place and NAME.list. "
         "The draw itself draws the lists from the buffers NAME.draws and NAME.indices; NAME.whole "
         "draws the scene for layers whose list has no room. In bodies of the two draws `whole` is "
         "0 and 1. At most 64 layers.",
         "{keep: keeps_triangle.glsl, each: views, room: 4096}"},
    [SECTION_DEPTH_BIAS] = {"a depth bias", "passes[].depth_bias", "depth_bias",
                            "What is added to the depth of triangles, against shadows of a surface "
                            "on itself: constant * r + slope * the largest change of depth from "
                            "texel to texel. r is 2^-23 of the power of two at or below the "
                            "triangle's largest depth. Some drivers scale r by a factor.",
                            "{constant: 2, slope: 1.5}"},
    [SECTION_ACCESS] =
        {"an access", "passes[].reads[]", "access",
         "An element of `reads`, `writes` or `updates`: a resource's name, or a map.",
         "{name: gbuffer_normal, sampler: soft}"},
    [SECTION_BLEND] =
        {"a blend", "passes[].blend", "blend",
         "How a draw combines a colour (src) with what the target holds (dst): src * its factor, "
         "operation, dst * its factor. `min` and `max` take no factors. A word is short for a map: "
         "`add` for {src: one, dst: one}; `premultiplied` for {src: one, dst: "
         "one_minus_src_alpha}; `over` for the same with src: src_alpha and alpha_src: one; "
         "`multiply` for {src: dst_color, dst: zero}; `min` and `max` for {op: min} and {op: max}. "
         "Overlapping triangles blend in their order on every device: instances one after the "
         "other, triangles as their indices stand. How the device rounds is not defined: the "
         "standards ask for at least the precision of the target. So `min`, `max` and masks leave "
         "the same bits on every device, but for NaN and zeros of either sign. `add` of 32-bit "
         "floats is one addition, which devices round to nearest. Products may be fused with the "
         "sum, and 16-bit floats and 8-bit codes may be truncated: with a factor other than one "
         "and zero, or one of these targets, two drivers of one maker agree, and between others a "
         "contract allows for the difference.",
         "{src: src_alpha, dst: one, alpha_src: zero}"},
    [SECTION_RANGES] = {"`ranges`", "passes[].ranges", "ranges",
                        "Runs of a buffer that every invocation of a workgroup reads alike. The "
                        "body iterates with "
                        "`for (Type v : NAME) { ... }`; the generator decides where the elements "
                        "live and how the loop is written.",
                        "lights: {of: vpls, count: 32}"},
    [SECTION_DEFINES] = {"`defines`", "passes[].defines", "defines",
                         "Macros of the body: integer literals, different from pass to pass, that "
                         "`#if` and lengths of arrays can use. What is the same in all passes is a "
                         "parameter or a constant; what shall change without compiling is a "
                         "parameter with `uniform` or `live`.",
                         "{TAPS: 2 * radius + 1}"},
    [SECTION_ALLOW] = {"`allow`", "passes[].allow", "allow",
                       "Kinds of `--sanitize` that the pass means, each with the reason.",
                       "{arithmetic: \"log(0) is -infinity, which max() drops\"}"},
    [SECTION_RANGE] = {"a range", "passes[].ranges.NAME", "range", "One range.",
                       "{of: vpls, count: 32, first: \"0\"}"},
    [SECTION_VALUES] =
        {"`values`", "values", "values",
         "What a whole shader, one with `#version` or of SPIR-V, finds in its uniforms, in the "
         "members of its uniform blocks and push constants, and in its inputs: vertex attributes, "
         "and in a fullscreen draw without vertex part the fragment's inputs. A value is a GLSL "
         "expression that begins with its type, over parameters, constants, `frame` and built-in "
         "inputs of the stage. A name without a value has that of the parameter of its name. "
         "Those of a pass go before those of the spec.",
         "{size: \"vec2(frame.width, frame.height)\", count: \"uint(frame.index)\"}"},
    [SECTION_ASSERT] =
        {"an assertion", "asserts[]", "assert",
         "A condition that must hold for the values in force; frame sizes count as 1920 x 1080, "
         "live parameters "
         "with their value.",
         "{that: clusters <= 64, level: error, message: \"{clusters} clusters are too many\"}"},
    [SECTION_CONTRACTS] =
        {"`contracts`", "contracts", "contracts",
         "How far the two backends may differ: the same bits, or within a tolerance. A denormal "
         "float counts as a zero of its sign, since drivers may flush it. NaN and infinity never "
         "pass. A pass whose resources all have a tolerance may use operations that are not "
         "exact; `diptych-gen --prove` lists those of other passes.",
         "default: exact"},
    [SECTION_CONTRACT] = {"a contract", "contracts.NAME", "contract",
                          "A tolerance: exactly one of the keys, but for `margin`, which stands "
                          "beside `flips`, and `outliers`, which stands beside `of_exact`. "
                          "Tolerances are numbers, fractions or percentages.",
                          "{ulp: 4}"},
    [SECTION_IMAGE_CONTRACT] =
        {"the contract `image`", "contracts.NAME.image", "image_contract",
         "A bound for every channel of every texel, and the share of texels that may break it.",
         "{max: 5/255, outliers: 0.1%}"},
    [SECTION_OUTPUT] = {"`output`", "output", "output", "Which images are the picture.",
                        "{display: picture}"},
};

#define REQUIRED true
#define OPTIONAL false

const struct key table_keys[] = {
    /* the document */
    {SECTION_TOP, "pipeline", KEY_NAME, SECTION_NONE, NULL, OPTIONAL, "**required** in a spec",
     "Name of the pipeline: of the generated files and of their symbols.", "ssvp"},
    {SECTION_TOP, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What the pipeline does.",
     "\"two bounces of diffuse light\""},
    {SECTION_TOP, "include", KEY_FILES, SECTION_NONE, NULL, OPTIONAL, "none",
     "Files with sections of this spec. Each is read once; its passes come first.",
     "[shared/gbuffer.yaml]"},
    {SECTION_TOP, "exactness", KEY_CHOICE, SECTION_NONE, "exact|bounded|fast", OPTIONAL, "exact",
     "`exact`: the same bits from both backends, but for passes with `exactness: fast`; `bounded`: "
     "also but for those with "
     "`bounded`; `fast`: in all passes that do not say `exact`, the shader compiler is left free, "
     "and "
     "dispatches may use subgroup operations, if the device has them (OpenGL: "
     "GL_KHR_shader_subgroup). In which order these reduce is the device's.",
     "exact"},
    {SECTION_TOP, "target", KEY_CHOICE, SECTION_NONE, "auto|software|gpu", OPTIONAL, "auto",
     "The kind of device that storage classes, loop shapes and workgroups are chosen for. "
     "`software` "
     "is for drivers that run on the CPU, and reads the scene's vertices and indices from texel "
     "buffers. `auto` plans both, and the runtime takes one when it knows the device: `gpu` also "
     "where "
     "the scene is too long for the device's texel buffers. Both have the same bits.",
     "gpu"},
    {SECTION_TOP, "origin", KEY_CHOICE, SECTION_NONE, "bottom|top", OPTIONAL, "bottom",
     "Which row of a picture is row 0 of an image: of files and inputs, and of pictures that are "
     "written. Nothing else depends on it: row 0 is at NDC y = -1.",
     "top"},
    {SECTION_TOP, "params", KEY_MAP, SECTION_PARAMS, NULL, OPTIONAL, NULL, "Parameters.",
     "{clusters: 8}"},
    {SECTION_TOP, "constants", KEY_MAP, SECTION_CONSTANTS, NULL, OPTIONAL, NULL,
     "Named integer expressions.", "{half: first_vpls / 2}"},
    {SECTION_TOP, "structs", KEY_MAP, SECTION_STRUCTS, NULL, OPTIONAL, NULL,
     "Element types of buffers.", "{Center: {position: vec3, members: uint}}"},
    {SECTION_TOP, "buffers", KEY_MAP, SECTION_BUFFERS, NULL, OPTIONAL, NULL, "Buffers.",
     "{centers: {of: Center, count: clusters}}"},
    {SECTION_TOP, "images", KEY_MAP, SECTION_IMAGES, NULL, OPTIONAL, NULL, "Images.",
     "{picture: {format: rgba8, size: frame}}"},
    {SECTION_TOP, "samplers", KEY_MAP, SECTION_SAMPLERS, NULL, OPTIONAL, NULL,
     "Point sets and filtering states.", "{soft: {kind: filter, filter: linear}}"},
    {SECTION_TOP, "metrics", KEY_MAP, SECTION_METRICS, NULL, OPTIONAL, NULL, "Distances.",
     "{near: {position: 1, normal: 0}}"},
    {SECTION_TOP, "interleaves", KEY_MAP, SECTION_INTERLEAVES, NULL, OPTIONAL, NULL,
     "Tiles of interleaved sampling.", "{tile: {x: 4, y: 4}}"},
    {SECTION_TOP, "passes", KEY_LIST, SECTION_PASS, NULL, OPTIONAL, "**required** in a spec",
     "The passes. An element `{include: FILE}` stands for the passes of a file.",
     "[{name: fill, dispatch: picture, writes: [picture], shader: fill.glsl}]"},
    {SECTION_TOP, "values", KEY_MAP, SECTION_VALUES, NULL, OPTIONAL, "none",
     "Values of the uniforms and inputs of whole shaders, by name.",
     "{count: \"uint(frame.index)\"}"},
    {SECTION_TOP, "groups", KEY_MAP, SECTION_GROUPS, NULL, OPTIONAL, NULL,
     "Passes and resources to use several times.", "{maps: {args: [points], passes: []}}"},
    {SECTION_TOP, "asserts", KEY_LIST, SECTION_ASSERT, NULL, OPTIONAL, NULL,
     "Conditions on the values in force.", "[{that: clusters > 0, message: \"no clusters\"}]"},
    {SECTION_TOP, "contracts", KEY_MAP, SECTION_CONTRACTS, NULL, OPTIONAL, NULL,
     "How far the backends may differ, per resource.", "{default: exact}"},
    {SECTION_TOP, "jitter", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "0",
     "Moves the camera's picture by `frame.jitter`, a fraction of a pixel, for temporal "
     "antialiasing: the number of positions before they repeat, at most 1024; 0: off. May use live "
     "parameters. The positions are those of Halton's sequence to the bases 2 and 3.",
     "\"taa ? 8 : 0\""},
    {SECTION_TOP, "output", KEY_MAP, SECTION_OUTPUT, NULL, OPTIONAL, NULL,
     "Which images are the picture.", "{display: picture}"},

    /* parameters and constants */
    {SECTION_PARAMS, "*", KEY_VALUE, SECTION_PARAM, NULL, OPTIONAL, NULL,
     "A parameter, by its name.", "8"},
    {SECTION_PARAM, "value", KEY_VALUE, SECTION_NONE, NULL, REQUIRED, NULL,
     "The value: a number, a bool or a list of numbers.", "[4, 4]"},
    {SECTION_PARAM, "type", KEY_CHOICE, SECTION_NONE, param_types + 1, OPTIONAL,
     "int, float or bool, ivecN or vecN, by the value",
     "The type. Without it an integer is int, a real float, a list ivecN or vecN.", "uint"},
    {SECTION_PARAM, "min", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Smallest value of every component.", "1"},
    {SECTION_PARAM, "max", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Largest value of every component.", "64"},
    {SECTION_PARAM, "step", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, NULL, "Step of a slider.",
     "0.05"},
    {SECTION_PARAM, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "What it changes, with its unit.", "\"clusters of k-means\""},
    {SECTION_PARAM, "live", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: changes at run time. Counts and sizes cannot depend on it; `when` can.", "true"},
    {SECTION_PARAM, "uniform", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: shaders read the value, and constants made of it, from the uniform block of the live "
     "parameters, where they otherwise have a literal. So an edit of it compiles no shader, but "
     "the "
     "compiler cannot compute ahead with it, and it cannot be the length of an array. Counts and "
     "sizes can depend on it.",
     "true"},
    {SECTION_CONSTANTS, "*", KEY_EXPR, SECTION_CONSTANT, NULL, OPTIONAL, NULL,
     "A constant, by its name.", "second_vpls / clusters"},
    {SECTION_CONSTANT, "value", KEY_EXPR, SECTION_NONE, NULL, REQUIRED, NULL,
     "Integer expression over parameters, constants, sizes of files, frame.width and frame.height.",
     "ceil_div(frame.width, 2)"},
    {SECTION_CONSTANT, "literal", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: a literal in shaders also where it is made of uniform parameters, an edit of which "
     "then "
     "compiles the shaders that use it.",
     "true"},
    {SECTION_CONSTANT, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What it is.",
     "\"half the width\""},

    /* structs */
    {SECTION_STRUCTS, "*", KEY_MAP, SECTION_STRUCT, NULL, OPTIONAL, NULL, "A struct, by its name.",
     "{position: vec3, members: uint}"},
    {SECTION_STRUCT, "*", KEY_TYPE, SECTION_FIELD, field_types + 1, OPTIONAL, NULL,
     "A field, by its name.", "vec3"},
    {SECTION_FIELD, "type", KEY_TYPE, SECTION_NONE, field_types + 1, REQUIRED, NULL,
     "The field's type.", "float"},
    {SECTION_FIELD, "count", KEY_INTEGER, SECTION_NONE, NULL, OPTIONAL, "no array",
     "Elements, for an array.", "4"},

    /* buffers and images */
    {SECTION_BUFFERS, "*", KEY_MAP, SECTION_BUFFER, NULL, OPTIONAL, NULL, "A buffer, by its name.",
     "{of: uint, count: 256}"},
    {SECTION_BUFFER, "of", KEY_NAME, SECTION_NONE, NULL, REQUIRED, NULL,
     "Element: a struct, or a scalar or vector type.", "Vpl"},
    {SECTION_BUFFER, "count", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "required without `file`",
     "Number of elements, at least 1.", "first_vpls + second_vpls"},
    {SECTION_BUFFER, "file", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, "no file",
     "Holds the content: a NumPy array beside the spec, `.npy`, of 32-bit numbers in C order. Its "
     "shape is (n) for a scalar, (n, 3) for vec3; a struct is a structured dtype without padding, "
     "of the same fields in the same order, mat4 by columns. `NAME.count` in expressions is n.",
     "kernel.npy"},
    {SECTION_BUFFER, "input", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false", INPUT_DOC, "true"},
    {SECTION_BUFFER, "keep", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false", KEEP_DOC, "true"},
    {SECTION_BUFFER, "history", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: keeps last frame's content; zero before the first.", "true"},
    {SECTION_BUFFER, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "What it holds, with units.", "\"virtual point lights\""},
    {SECTION_IMAGES, "*", KEY_MAP, SECTION_IMAGE, NULL, OPTIONAL, NULL, "An image, by its name.",
     "{format: rgba16f, size: frame}"},
    {SECTION_IMAGE, "format", KEY_CHOICE, SECTION_NONE, formats + 1, REQUIRED, NULL,
     "Format of a texel. Without ending, numbers from 0 to 1 in integer steps; `_snorm`: from -1 "
     "to "
     "1; `f`: floats; `ui` and `i`: unsigned and signed integers. r11g11b10f has floats without a "
     "sign, of 11, 11 and 10 bits. A dispatch that uses one of those that Vulkan calls extended, "
     "such as r16ui and the packed ones, needs shaderStorageImageExtendedFormats; a device that "
     "cannot draw into, filter or blend a format names it.",
     "rgba16f"},
    {SECTION_IMAGE, "size", KEY_SIZE, SECTION_NONE, NULL, OPTIONAL,
     "required without `file`; frame for an input",
     "`frame`, or width and height as integer expressions, 1 to 16384; or width, height and depth, "
     "1 to 2048, of a 3D image, which a dispatch writes.",
     "[frame.width / 2, 256]"},
    {SECTION_IMAGE, "layers", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "no array",
     "Layers, 1 to 2048; makes the image an array, also with one layer. Of cubes: six for each.",
     "clusters"},
    {SECTION_IMAGE, "cube", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: a cube map, or with `layers` an array of them. `NAME_sample` takes a direction. Other "
     "accesses see layers: +x, -x, +y, -y, +z, -z of the first cube, and so on.",
     "true"},
    {SECTION_IMAGE, "mips", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "1",
     "Mip levels; does not depend on the frame.", "4"},
    {SECTION_IMAGE, "filter_mips", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: when mip 0 is written, passes NAME.mip_1 and so on fill the other mips, each by means "
     "of "
     "the one above it.",
     "true"},
    {SECTION_IMAGE, "history", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "true: keeps last frame's content; zero before the first.", "true"},
    {SECTION_IMAGE, "file", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, "no file",
     "Holds the content: a PNG, JPEG, OpenEXR or HDR picture beside the spec, of the image's size. "
     "`NAME.width` and `NAME.height` in expressions are that size. The last row of the picture is "
     "row 0; further `mips` are box-filtered in linear light.",
     "grade.png"},
    {SECTION_IMAGE, "encoding", KEY_CHOICE, SECTION_NONE, "linear|srgb", OPTIONAL, "linear",
     "srgb: the picture of `file` or `--input` holds sRGB codes, and an image of a float format "
     "gets the linear light. `rgba8_srgb` keeps codes and decodes them when they are read.",
     "srgb"},
    {SECTION_IMAGE, "input", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false", INPUT_DOC, "true"},
    {SECTION_IMAGE, "keep", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false", KEEP_DOC, "true"},
    {SECTION_IMAGE, "clear", KEY_NUMBERS, SECTION_NONE, NULL, OPTIONAL, "0; 1 for depth",
     "What a draw that writes the image starts from, and what it holds when its writer was "
     "skipped.",
     "[0, 0, 0, 1]"},
    {SECTION_IMAGE, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "What it holds, with units.", "\"irradiance, W/m2\""},

    /* samplers, metrics, interleaves */
    {SECTION_SAMPLERS, "*", KEY_MAP, SECTION_SAMPLER, NULL, OPTIONAL, NULL,
     "A sampler, by its name.", "{kind: filter, filter: linear}"},
    {SECTION_SAMPLER, "kind", KEY_CHOICE, SECTION_NONE, "hammersley|filter", REQUIRED, NULL,
     "A point set, or filtering state.", "hammersley"},
    {SECTION_SAMPLER, "count", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, NULL,
     "hammersley: number of points; required.", "second_vpls / clusters"},
    {SECTION_SAMPLER, "map", KEY_CHOICE, SECTION_NONE, "square|polar_disk|concentric_disk",
     OPTIONAL, "square", "hammersley: the unit square, or how it is mapped to the unit disk.",
     "concentric_disk"},
    {SECTION_SAMPLER, "filter", KEY_CHOICE, SECTION_NONE, "nearest|linear", OPTIONAL, "nearest",
     "filter: between texels.", "linear"},
    {SECTION_SAMPLER, "mip_filter", KEY_CHOICE, SECTION_NONE, "nearest|linear", OPTIONAL, "nearest",
     "filter: between mip levels.", "linear"},
    {SECTION_SAMPLER, "wrap", KEY_CHOICE, SECTION_NONE, "clamp|repeat|mirror|border", OPTIONAL,
     "clamp", "filter: beyond the edge. `border`: the colour of the key `border`.", "repeat"},
    {SECTION_SAMPLER, "border", KEY_CHOICE, SECTION_NONE,
     "transparent_black|opaque_black|opaque_white", OPTIONAL, "transparent_black",
     "wrap: border: the colour beyond the edge, as far as the format has its channels; a depth is "
     "0, "
     "or 1 for opaque_white. Not for integer formats. Cubes have no edge.",
     "opaque_white"},
    {SECTION_SAMPLER, "compare", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "false",
     "filter: true for a depth comparison, `NAME_compare(uv, reference)`.", "true"},
    {SECTION_SAMPLER, "anisotropy", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, "1",
     "filter: 1 to 16.", "8"},
    {SECTION_SAMPLER, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What it is for.",
     "\"points on the disk\""},
    {SECTION_METRICS, "*", KEY_MAP, SECTION_METRIC, NULL, OPTIONAL, NULL, "A metric, by its name.",
     "{position: 0.6, normal: 0.4}"},
    {SECTION_METRIC, "position", KEY_WEIGHT, SECTION_NONE, NULL, REQUIRED, NULL,
     "Weight of the distance: a number, or a parameter of type float.", "0.6"},
    {SECTION_METRIC, "normal", KEY_WEIGHT, SECTION_NONE, NULL, REQUIRED, NULL,
     "Weight of the normals' term, likewise.", "normal_weight"},
    {SECTION_METRIC, "position_field", KEY_NAME, SECTION_NONE, NULL, OPTIONAL, "position",
     "Field of a struct that is its position.", "center"},
    {SECTION_METRIC, "normal_field", KEY_NAME, SECTION_NONE, NULL, OPTIONAL, "normal",
     "Field of a struct that is its normal.", "axis"},
    {SECTION_METRIC, "normal_term", KEY_CHOICE, SECTION_NONE, "one_minus_dot|dot", OPTIONAL,
     "one_minus_dot", "1 - max(na.nb, 0), or max(na.nb, 0).", "dot"},
    {SECTION_METRIC, "scale", KEY_LENGTH, SECTION_NONE, NULL, OPTIONAL, "scene_radius",
     "The length that distances are divided by: `scene_radius`, or a number above 0.", "1.0"},
    {SECTION_METRIC, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What it measures.",
     "\"how unlike two lights are\""},
    {SECTION_INTERLEAVES, "*", KEY_MAP, SECTION_INTERLEAVE, NULL, OPTIONAL, NULL,
     "An interleave, by its name.", "{x: 4, y: 4}"},
    {SECTION_INTERLEAVE, "x", KEY_EXPR, SECTION_NONE, NULL, REQUIRED, NULL,
     "Width of the tile; baked.", "4"},
    {SECTION_INTERLEAVE, "y", KEY_EXPR, SECTION_NONE, NULL, REQUIRED, NULL,
     "Height of the tile; baked.", "tile_size.y"},
    {SECTION_INTERLEAVE, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What it is for.",
     "\"shading classes\""},

    /* culling */
    {SECTION_CULL, "keep", KEY_TEXT, SECTION_NONE, NULL, REQUIRED, NULL,
     "GLSL file with `bool keeps_triangle(vec3 a, vec3 b, vec3 c, TYPE element)`; without `each` "
     "the "
     "last argument is missing. It may use the frame, parameters and `element`. `frustum`: what "
     "the "
     "view can see.",
     "keeps_triangle.glsl"},
    {SECTION_CULL, "each", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, "one list",
     "Buffer with an element for each layer: a list for each.", "views"},
    {SECTION_CULL, "again", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "0",
     "With `each`: a second list for each layer, drawn by that many instances. `keeps_triangle` "
     "then returns a uint: 1 for the first list, 2 for the second, 3 for both. Instances of a "
     "layer begin at (1 + again) * layer, with the one of the first list. The whole scene is drawn "
     "by those of the second.",
     "4"},
    {SECTION_CULL, "room", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "1048576",
     "Triangles that a list may have, on average over the layers.", "4096"},
    {SECTION_CULL, "most", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "1048576",
     "Triangles of the largest scene that is culled; larger ones are drawn whole.", "65536"},
    {SECTION_CULL, "faces", KEY_CHOICE, SECTION_NONE, "none|back|front", OPTIONAL, "none",
     "Faces that are dropped.", "back"},

    /* groups and repeats */
    {SECTION_GROUPS, "*", KEY_MAP, SECTION_GROUP, NULL, OPTIONAL, NULL, "A group, by its name.",
     "{args: [points], passes: []}"},
    {SECTION_GROUP, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What it makes.",
     "\"visibility maps\""},
    {SECTION_GROUP, "args", KEY_NAMES, SECTION_NONE, NULL, OPTIONAL, "none",
     "Names that each use gives a meaning.", "[points, count]"},
    {SECTION_GROUP, "constants", KEY_MAP, SECTION_CONSTANTS, NULL, OPTIONAL, NULL,
     "Constants of each instance.", "{half: count / 2}"},
    {SECTION_GROUP, "buffers", KEY_MAP, SECTION_BUFFERS, NULL, OPTIONAL, NULL,
     "Buffers of each instance.", "{views: {of: View, count: count}}"},
    {SECTION_GROUP, "images", KEY_MAP, SECTION_IMAGES, NULL, OPTIONAL, NULL,
     "Images of each instance.", "{depth: {format: d32f, size: [256, 256], layers: count}}"},
    {SECTION_GROUP, "asserts", KEY_LIST, SECTION_ASSERT, NULL, OPTIONAL, NULL,
     "Conditions on the values of each instance.", "[{that: count > 0, message: \"no points\"}]"},
    {SECTION_GROUP, "passes", KEY_LIST, SECTION_PASS, NULL, REQUIRED, NULL,
     "Passes, repeats and uses of other groups.",
     "[{name: fill, dispatch: count, writes: [views], shader: fill.glsl}]"},
    {SECTION_GROUP, "exactness", KEY_CHOICE, SECTION_NONE, "exact|bounded|fast", OPTIONAL,
     "that of the spec", "Of its passes that do not say.", "bounded"},
    {SECTION_USE, "group", KEY_NAME, SECTION_NONE, NULL, REQUIRED, NULL, "The group.", "maps"},
    {SECTION_USE, "as", KEY_NAME, SECTION_NONE, NULL, OPTIONAL, "the group's name",
     "The name of the instance.", "second"},
    {SECTION_USE, "with", KEY_MAP, SECTION_WITH, NULL, OPTIONAL, "none",
     "A value for each argument.", "{points: second_vpls}"},
    {SECTION_USE, "repeat", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, "once",
     "NAME in FIRST .. LAST: an instance for each number.", "k in 0 .. 2"},
    {SECTION_WITH, "*", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "The value of an argument: a name, an integer expression or a file.", "second_vpls"},
    {SECTION_REPEAT, "repeat", KEY_TEXT, SECTION_NONE, NULL, REQUIRED, NULL,
     "NAME in FIRST .. LAST, both included; no pass if LAST is below FIRST. The limits depend on "
     "baked parameters alone.",
     "k in 0 .. levels - 1"},
    {SECTION_REPEAT, "passes", KEY_LIST, SECTION_PASS, NULL, REQUIRED, NULL,
     "The passes, in this order for each number.",
     "[{name: down, dispatch: 64, updates: [glow], shader: down.glsl}]"},

    /* passes */
    {SECTION_PASS, "repeat", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, "once",
     "NAME in FIRST .. LAST: the pass for each number, both included.", "k in 0 .. levels - 1"},
    {SECTION_PASS, "name", KEY_NAME, SECTION_NONE, NULL, REQUIRED, NULL, "Name of the pass.",
     "shade"},
    {SECTION_PASS, "doc", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL, "What it does.",
     "\"irradiance by all lights\""},
    {SECTION_PASS, "draw", KEY_CHOICE, SECTION_DRAW, "scene|fullscreen", OPTIONAL, NULL,
     "A draw: all triangles of the scene, one triangle that covers the targets, or a number of "
     "vertices that the body makes.",
     "scene"},
    {SECTION_PASS, "dispatch", KEY_EXPRS, SECTION_NONE, NULL, OPTIONAL, NULL,
     "A dispatch by invocations: one to three integer expressions, or an image's name for one "
     "invocation per texel.",
     "[frame.width, frame.height]"},
    {SECTION_PASS, "groups", KEY_EXPRS, SECTION_NONE, NULL, OPTIONAL, NULL,
     "A dispatch by workgroups.", "clusters"},
    {SECTION_PASS, "interleave", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, NULL,
     "A dispatch over an interleave's classes: x and y of `invocation()` are over the class's "
     "pixels, z is the class. Workgroups of all classes follow each other.",
     "tile"},
    {SECTION_PASS, "indirect", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Buffer with the arguments: alone of a dispatch, beside `draw: scene` of indexed draws, "
     "beside "
     "a draw of vertices of such, one per element.",
     "draw_arguments"},
    {SECTION_PASS, "local", KEY_EXPRS, SECTION_NONE, NULL, OPTIONAL,
     "[64, 1, 1], or [8, 8, 1] in two dimensions; with ranges on CPU drivers 256 "
     "invocations",
     "Size of a workgroup; at most 1024 invocations.", "[8, 8, 1]"},
    {SECTION_PASS, "gpu_local", KEY_EXPRS, SECTION_NONE, NULL, OPTIONAL, "`local`",
     "Size of a workgroup in the plan for GPUs. For a body that gives the same result with "
     "workgroups of any size.",
     "256"},
    {SECTION_PASS, "view", KEY_CHOICE, SECTION_NONE, "camera|light", OPTIONAL, "camera",
     "draw: scene: what `view` is in the body.", "light"},
    {SECTION_PASS, "layers", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "not layered",
     "draw: that many layers of the targets, and instances of the scene; the vertex part chooses "
     "gl_Layer.",
     "clusters"},
    {SECTION_PASS, "indices", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, "the scene's",
     "draw: scene: buffer of uint with the indices to draw.", "visible_indices"},
    {SECTION_PASS, "reads", KEY_NAMES, SECTION_ACCESS, NULL, OPTIONAL, "none",
     "What the pass reads.", "[vpls, {name: gbuffer_normal, sampler: soft}]"},
    {SECTION_PASS, "writes", KEY_NAMES, SECTION_ACCESS, NULL, OPTIONAL, "none",
     "What the pass makes anew, as a whole. Images of a draw are its targets, in the order of "
     "their locations.",
     "[irradiance]"},
    {SECTION_PASS, "updates", KEY_NAMES, SECTION_ACCESS, NULL, OPTIONAL, "none",
     "What the pass reads and changes.", "[clusters]"},
    {SECTION_PASS, "uses", KEY_NAMES, SECTION_NONE, NULL, OPTIONAL, "none",
     "Point sets, metrics and interleaves that the body calls.", "[vpl_distance]"},
    {SECTION_PASS, "shader", KEY_BODY, SECTION_NONE, NULL, REQUIRED, NULL,
     "GLSL file of the body, beside the spec or below the templates; or two that make one body. A "
     "file with `#version` is a whole shader and keeps its own declarations, one of SPIR-V (.spv) "
     "is, too; of two, the first is the vertex part.",
     "shade.glsl"},
    {SECTION_PASS, "exactness", KEY_CHOICE, SECTION_NONE, "exact|bounded|fast", OPTIONAL,
     "that of its group, else of the spec",
     "`exact`: the same bits on every device, also if the spec is `fast`. `fast`: the shader "
     "compiler is left "
     "free. `bounded`: the same, unless the spec is `exact`: for what colours, not for what "
     "decides. "
     "`compare` judges a pass that its own `exactness` or its group's leaves free against its "
     "exact twin: see the contract "
     "`of_exact`.",
     "bounded"},
    {SECTION_PASS, "when", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "always",
     "The pass runs when this is not 0; may use live parameters. Skipped, it clears what it "
     "writes.",
     "bounces > 1"},
    {SECTION_PASS, "after", KEY_NAMES, SECTION_NONE, NULL, OPTIONAL, "none",
     "Passes that must run before.", "[cluster]"},
    {SECTION_PASS, "ranges", KEY_MAP, SECTION_RANGES, NULL, OPTIONAL, "none",
     "Runs of buffers that a workgroup reads alike.", "{lights: {of: vpls, count: 32}}"},
    {SECTION_PASS, "defines", KEY_MAP, SECTION_DEFINES, NULL, OPTIONAL, "none",
     "Macros of the body, by name.", "{TAPS: 2 * radius + 1}"},
    {SECTION_PASS, "allow", KEY_MAP, SECTION_ALLOW, NULL, OPTIONAL, "none",
     "Undefined behaviour that the body means, with the reason: `--sanitize` does not tell it, and "
     "warns when it finds none.",
     "{arithmetic: \"log(0) is -infinity, which max() drops\"}"},
    {SECTION_PASS, "values", KEY_MAP, SECTION_VALUES, NULL, OPTIONAL, "none",
     "Values of the uniforms and inputs of its whole shader, by name.",
     "{size: \"vec2(frame.width, frame.height)\"}"},
    {SECTION_PASS, "cull", KEY_CHOICE, SECTION_CULL, "none|back|front", OPTIONAL, "none",
     "draw: faces that are dropped, or which triangles of the scene are kept.", "back"},
    {SECTION_PASS, "depth", KEY_CHOICE, SECTION_NONE, "off|less|less_equal|greater|always",
     OPTIONAL, "less with a depth target, else off", "draw: the depth test.", "less_equal"},
    {SECTION_PASS, "depth_write", KEY_BOOL, SECTION_NONE, NULL, OPTIONAL, "true",
     "draw: whether depth is written.", "false"},
    {SECTION_PASS, "blend", KEY_CHOICE, SECTION_BLEND, BLENDS, OPTIONAL, "off",
     "draw: how colours are combined, in targets without a `blend` of their own.", "add"},
    {SECTION_PASS, "clip_distances", KEY_INTEGER, SECTION_NONE, NULL, OPTIONAL, "0",
     "draw: clip distances that the vertex part writes, up to 8.", "1"},
    {SECTION_PASS, "viewport", KEY_RECT, SECTION_NONE, NULL, OPTIONAL, "all of the targets",
     "draw: x, y, width and height, in texels, of the area that NDC -1 to 1 is mapped to; may use "
     "live parameters. With a width or height of 0 the draw draws nothing.",
     "[0, 0, frame.width / 2, frame.height]"},
    {SECTION_PASS, "scissor", KEY_RECT, SECTION_NONE, NULL, OPTIONAL, "all of the targets",
     "draw: x, y, width and height of the texels that the draw may change; likewise. Targets in "
     "`writes` are cleared outside of it, too.",
     "[8, 8, 64, 64]"},
    {SECTION_PASS, "depth_bias", KEY_MAP, SECTION_DEPTH_BIAS, NULL, OPTIONAL, "none",
     "draw: what is added to the depth of triangles.", "{constant: 2, slope: 1.5}"},
    {SECTION_DRAW, "vertices", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL,
     "required without `indirect`", "Vertices of an instance; may use live parameters.", "6"},
    {SECTION_DRAW, "instances", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "1",
     "Instances; may use live parameters.", "particles_alive"},
    {SECTION_DRAW, "topology", KEY_CHOICE, SECTION_NONE, "triangles|lines|points", OPTIONAL,
     "triangles",
     "Three vertices make a triangle, two a line of one texel's width, one a point of "
     "`gl_PointSize` texels.",
     "points"},
    {SECTION_DEPTH_BIAS, "constant", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, "0",
     "Multiple of the smallest difference of depths.", "2"},
    {SECTION_DEPTH_BIAS, "slope", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, "0",
     "Multiple of the triangle's slope.", "1.5"},
    {SECTION_PASS_INCLUDE, "include", KEY_TEXT, SECTION_NONE, NULL, REQUIRED, NULL, "The file.",
     "shared/tonemap.yaml"},
    {SECTION_ACCESS, "name", KEY_REFERENCE, SECTION_NONE, NULL, REQUIRED, NULL, "The resource.",
     "shadow_depth"},
    {SECTION_ACCESS, "as", KEY_NAME, SECTION_NONE, NULL, OPTIONAL, "its name",
     "What the body calls it in place of its name, so that one body serves passes over different "
     "resources, or that it tells mips and layers of one image apart.",
     "points"},
    {SECTION_ACCESS, "sampler", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, "by texel",
     "reads: the filtering sampler of `NAME_sample` and `NAME_compare`.", "soft"},
    {SECTION_ACCESS, "previous", KEY_INTEGER, SECTION_NONE, NULL, OPTIONAL, "0",
     "reads: what the image held that many frames ago, up to 64; zero before the first. The image "
     "NAME.before_1 keeps it, and a pass NAME.keep_1 fills that at the end of each frame.",
     "1"},
    {SECTION_ACCESS, "mip", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL,
     "0; all for a sampler without `layer`", "The mip level; baked.", "1"},
    {SECTION_ACCESS, "layer", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, "all",
     "reads and updates: one layer of an array image, which the body sees as a plain image; baked.",
     "0"},
    {SECTION_ACCESS, "blend", KEY_CHOICE, SECTION_BLEND, BLENDS, OPTIONAL, "the pass's",
     "Colour target: how the draw's colours are combined with it.", "over"},
    /* in the order of the masks 1 to 15 */
    {SECTION_ACCESS, "mask", KEY_CHOICE, SECTION_NONE,
     "r|g|rg|b|rb|gb|rgb|a|ra|ga|rga|ba|rba|gba|rgba", OPTIONAL, "rgba",
     "Colour target: the channels that the draw writes; the others keep what they hold.", "rgb"},
    {SECTION_BLEND, "src", KEY_CHOICE, SECTION_NONE, FACTORS, OPTIONAL, "one",
     "Factor of the draw's colour.", "src_alpha"},
    {SECTION_BLEND, "dst", KEY_CHOICE, SECTION_NONE, FACTORS, OPTIONAL, "one",
     "Factor of the target's content.", "one_minus_src_alpha"},
    {SECTION_BLEND, "op", KEY_CHOICE, SECTION_NONE, OPERATIONS, OPTIONAL, "add",
     "`subtract`: src - dst; `reverse_subtract`: dst - src.", "reverse_subtract"},
    {SECTION_BLEND, "alpha_src", KEY_CHOICE, SECTION_NONE, FACTORS, OPTIONAL, "`src`",
     "Factor of the draw's alpha.", "one"},
    {SECTION_BLEND, "alpha_dst", KEY_CHOICE, SECTION_NONE, FACTORS, OPTIONAL, "`dst`",
     "Factor of the target's alpha.", "one_minus_src_alpha"},
    {SECTION_BLEND, "alpha_op", KEY_CHOICE, SECTION_NONE, OPERATIONS, OPTIONAL, "`op`",
     "Operation of alpha.", "max"},
    {SECTION_VALUES, "*", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "A value, by the name of the uniform, member or input.", "vec4(1.0)"},
    {SECTION_DEFINES, "*", KEY_EXPR, SECTION_NONE, NULL, OPTIONAL, NULL,
     "A macro, by its name: an integer; baked.", "2 * radius + 1"},
    {SECTION_ALLOW, "index", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why indices and texels beyond their range are meant.", "\"the border is never used\""},
    {SECTION_ALLOW, "arithmetic", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why arithmetic without a defined result is meant.",
     "\"log(0) is -infinity, which max() drops\""},
    {SECTION_ALLOW, "loop", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why loops of more than 65,000 turns are meant.", "\"a reference, for one device\""},
    {SECTION_ALLOW, "variable", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why variables without a value are meant.", "\"a seed of any value\""},
    {SECTION_ALLOW, "content", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why content that nothing has written is meant.", "\"a mask hides what is not written\""},
    {SECTION_ALLOW, "race", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why invocations may touch one element in any order.", "\"all store the same\""},
    {SECTION_ALLOW, "flow", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Why barriers that not all invocations reach are meant.", "\"a test of this check\""},
    {SECTION_RANGES, "*", KEY_MAP, SECTION_RANGE, NULL, OPTIONAL, NULL, "A range, by its name.",
     "{of: vpls, count: 32}"},
    {SECTION_RANGE, "of", KEY_REFERENCE, SECTION_NONE, NULL, REQUIRED, NULL,
     "The buffer, among the pass's reads.", "vpls"},
    {SECTION_RANGE, "count", KEY_EXPR, SECTION_NONE, NULL, REQUIRED, NULL,
     "Number of elements; baked.", "32"},
    {SECTION_RANGE, "first", KEY_TEXT, SECTION_NONE, NULL, OPTIONAL, "0",
     "First element: a GLSL int expression, the same for a whole workgroup.",
     "\"interleave_class() * 32\""},
    {SECTION_RANGE, "storage", KEY_CHOICE, SECTION_NONE, "auto|shared|buffer|uniform", OPTIONAL,
     "auto",
     "Where the elements are read from. `auto`: from a copy in shared memory if `loop: auto` "
     "unrolls the loop, and on a GPU; else in place, from a uniform block if one can "
     "hold "
     "the buffer (64 KiB, elements a multiple of 16 bytes; up to nine blocks per pass), or a "
     "storage "
     "buffer.",
     "shared"},
    {SECTION_RANGE, "loop", KEY_CHOICE, SECTION_NONE, "auto|unroll|roll", OPTIONAL, "auto",
     "How the loop is written. `auto` unrolls up to 32 elements and rolls longer loops. On CPU "
     "drivers longer loops that read no image are unrolled, too, the shortest first, as long as "
     "they have at most 256 elements together. On a GPU up to 64 elements are unrolled, as long as "
     "the code of all loops of the pass fits an instruction cache of 32 KB, as far as the length "
     "of the bodies tells.",
     "unroll"},

    /* assertions, contracts, output */
    {SECTION_ASSERT, "that", KEY_EXPR, SECTION_NONE, NULL, REQUIRED, NULL, "The condition.",
     "second_vpls >= 32 * clusters"},
    {SECTION_ASSERT, "level", KEY_CHOICE, SECTION_NONE, "warning|error", OPTIONAL, "error",
     "What a failure is.", "warning"},
    {SECTION_ASSERT, "message", KEY_TEXT, SECTION_NONE, NULL, REQUIRED, NULL,
     "What is said; {NAME} stands for the value of a parameter or constant.",
     "\"{clusters} clusters are too many\""},
    {SECTION_CONTRACTS, "default", KEY_CHOICE, SECTION_CONTRACT, "exact", OPTIONAL, "exact",
     "For resources not named here.", "exact"},
    {SECTION_CONTRACTS, "*", KEY_CHOICE, SECTION_CONTRACT, "exact", OPTIONAL, NULL,
     "For one resource, by its name.", "{ulp: 4}"},
    {SECTION_CONTRACT, "ulp", KEY_NUMBER, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Units in the last place: of float and half, codes of 8 and 16 bit formats, 1 for integers.",
     "4"},
    {SECTION_CONTRACT, "abs", KEY_AMOUNT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Absolute difference.", "0.001"},
    {SECTION_CONTRACT, "rel", KEY_AMOUNT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Difference relative to the larger value.", "1%"},
    {SECTION_CONTRACT, "image", KEY_MAP, SECTION_IMAGE_CONTRACT, NULL, OPTIONAL, NULL,
     "Of images: an absolute difference that a share of the texels may exceed.",
     "{max: 5/255, outliers: 0.1%}"},
    {SECTION_CONTRACT, "flips", KEY_INTEGER, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Of integers that name things, like labels: elements that may have another value, in a frame. "
     "Each is reported.",
     "1"},
    {SECTION_CONTRACT, "raster", KEY_AMOUNT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Of images that a scene draw writes: share of the texels that may differ, all of them at an "
     "edge: on either side a neighbour shows another triangle. Triangles are told apart by the "
     "draw's integer image, taken for their numbers, else by coverage. If the draw also writes "
     "depth, a texel may show another surface in the same place: the depths are no farther apart "
     "than those of two neighbours. Of depth itself only coverage counts. `compare` then judges "
     "each pass on equal inputs. Between drivers of different makers all exact images of scene "
     "draws have `raster: 10%`.",
     "0.1%"},
    {SECTION_CONTRACT, "of_exact", KEY_AMOUNT, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Of what a pass writes that its `exactness` leaves free: difference from what exact "
     "arithmetic makes of the same inputs, relative to "
     "the larger value, or to 0.001 if that is more. One code of a normalized format, and one step "
     "of a half, always pass. `compare` runs the exact "
     "twin of each such pass on every backend, on the pass's own inputs, and judges all passes on "
     "equal inputs. Where every pass that "
     "writes the resource is exact, the same as `exact`. Default for what such a pass writes: "
     "`0.001`.",
     "0.001"},
    {SECTION_CONTRACT, "outliers", KEY_AMOUNT, SECTION_NONE, NULL, OPTIONAL, "0",
     "of_exact: share of the elements that may differ by more, 0 to 1.", "0.1%"},
    {SECTION_CONTRACT, "margin", KEY_MEMBER, SECTION_NONE, NULL, OPTIONAL, "none",
     "flips: a buffer of float, or a float field of one, `BUFFER.FIELD`, that holds for every "
     "element how narrowly it was decided; written by the pass that writes the labels.",
     "label_margins"},
    {SECTION_IMAGE_CONTRACT, "max", KEY_AMOUNT, SECTION_NONE, NULL, REQUIRED, NULL,
     "Largest absolute difference of a texel that is no outlier.", "5/255"},
    {SECTION_IMAGE_CONTRACT, "outliers", KEY_AMOUNT, SECTION_NONE, NULL, OPTIONAL, "0",
     "Share of the texels that may differ by more, 0 to 1.", "0.1%"},
    {SECTION_OUTPUT, "linear", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Image with linear radiance, for EXR.", "radiance"},
    {SECTION_OUTPUT, "display", KEY_REFERENCE, SECTION_NONE, NULL, OPTIONAL, NULL,
     "Image with 8 bit sRGB codes, for PNG.", "picture"},
};
const size_t table_key_count = sizeof table_keys / sizeof *table_keys;

const struct key *table_find(enum section section, const char *name)
{
    const struct key *any = NULL;
    for (size_t i = 0; i < table_key_count; i++) {
        const struct key *key = &table_keys[i];
        if (key->section != section)
            continue;
        if (!strcmp(key->name, name))
            return key;
        if (!strcmp(key->name, "*"))
            any = key;
    }
    return any;
}

int table_choice(const char *choices, const char *word)
{
    size_t length = strlen(word);
    int number = 0;
    for (const char *at = choices; at; number++) {
        const char *end = strchr(at, '|');
        size_t size = end ? (size_t)(end - at) : strlen(at);
        if (size == length && !memcmp(at, word, length))
            return number;
        at = end ? end + 1 : NULL;
    }
    return -1;
}

const char *table_type_text(enum key_type type)
{
    static const char *const texts[] = {
        [KEY_NAME] = "a name",
        [KEY_REFERENCE] = "a name",
        [KEY_MEMBER] = "a name or NAME.FIELD",
        [KEY_TEXT] = "text",
        [KEY_BOOL] = "true or false",
        [KEY_NUMBER] = "a number",
        [KEY_AMOUNT] = "a number, a fraction like 5/255 or a percentage like 0.1%",
        [KEY_INTEGER] = "an integer, 0 or more",
        [KEY_EXPR] = "an integer expression",
        [KEY_EXPRS] = "an integer expression or a list of 1 to 3",
        [KEY_SIZE] = "`frame` or a list of 2 or 3 integer expressions",
        [KEY_RECT] = "a list of 4 integer expressions: x, y, width, height",
        [KEY_VALUE] = "a number, a bool or a list of 2 to 4 numbers",
        [KEY_NUMBERS] = "a number or a list of 1 to 4",
        [KEY_LENGTH] = "`scene_radius` or a number",
        [KEY_WEIGHT] = "a number or a parameter",
        [KEY_CHOICE] = "a word",
        [KEY_TYPE] = "a type",
        [KEY_NAMES] = "a list of names",
        [KEY_FILES] = "a list of file names",
        [KEY_BODY] = "a file name or a list of 1 or 2",
        [KEY_LIST] = "a list of maps",
        [KEY_MAP] = "a map",
    };
    return texts[type];
}
