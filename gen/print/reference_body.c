/* The chapter of the reference on pass bodies: every name that the generator supplies to GLSL. The
 * names come from emit_glsl.c, glsl_access.c, glsl_body.c and templates/glsl; tests/gen/language.py
 * compares this table with them. */
#include "print.h"

struct body_name {
    const char *name;  /* as the body writes it; NAME is a name of the spec */
    const char *where; /* stages and passes that have it */
    const char *doc;
};

struct body_group {
    const char *title, *doc;
    const struct body_name *names; /* ended by a NULL name */
};

static const struct body_name place_names[] = {
    {"ivec3 invocation()", "compute",
     "Index of the invocation. `gl_GlobalInvocationID`, but for an `interleave`."},
    {"ivec3 dispatch_size()", "compute",
     "Invocations that the pass asked for. Workgroups are whole, so more may run: return early "
     "when `invocation()` is not below."},
    {"int interleave_class()", "compute, `interleave`", "Class of pixels of the workgroup."},
    {"ivec2 interleave_pixel()", "compute, `interleave`",
     "The invocation's pixel. Invocations beyond the last pixel of a class repeat it."},
    {"ivec2 interleave_split()", "compute, `interleave`", "Where that pixel lies in split order."},
    {"gl_VertexIndex", "vertex",
     "Vertex, from 0, or from `first_vertex` of an indirect draw; on both backends."},
    {"gl_InstanceIndex", "vertex",
     "Instance, from 0, or from `first_instance` of an indirect draw; on both backends."},
    {"vec4 fullscreen_position()", "vertex, `draw: fullscreen`",
     "Position of a vertex of the triangle that covers the targets."},
    {"vec3 vertex_position", "vertex, `draw: scene`", "Position in the scene."},
    {"vec3 vertex_normal", "vertex, `draw: scene`", "Unit normal."},
    {"vec2 vertex_uv", "vertex, `draw: scene`", "Texture coordinates."},
    {"uint vertex_material", "vertex, `draw: scene`", "Index into `scene_materials`."},
    {"uint vertex_triangle", "vertex, `draw: scene`",
     "Number of the triangle. To hand on as `flat`: of a triangle, its first vertex alone has its "
     "number."},
    {"gl_Position", "vertex", "To write: clip space of Vulkan."},
    {"gl_PointSize", "vertex, `topology: points`", "To write: texels along a side."},
    {"gl_Layer", "vertex, `layers`",
     "To write: layer of the targets, the same at all vertices of a triangle."},
    {"gl_ClipDistance", "vertex, `clip_distances`",
     "To write: as many as the pass has; below 0 is cut."},
    {"gl_FragCoord", "fragment", "`xy` is the texel plus 0.5, `z` the depth."},
    {"gl_PointCoord", "fragment, `topology: points`",
     "Place in the point, 0 to 1; (0, 0) is the corner of the smallest column and row."},
    {"gl_FrontFacing", "fragment, `draw: scene`",
     "Triangles are counter-clockwise from the front."},
    {0},
};

static const struct body_name frame_names[] = {
    {"frame.camera", "any", "`View` of the camera; `camera` for short."},
    {"frame.light_view", "any",
     "`View` from the light, orthographic or perspective, of all that it reaches; `light_view`."},
    {"frame.light", "any", "`Light`; `light` for short."},
    {"frame.scene_center", "any", "Centre of the scene's bounding sphere; `scene_center`."},
    {"frame.scene_radius", "any", "Its radius; `scene_radius`."},
    {"frame.width", "any", "Pixels of the frame, uint."},
    {"frame.height", "any", "Pixels of the frame, uint."},
    {"frame.index", "any", "Number of the frame, from 0, uint."},
    {"frame.triangle_count", "any", "Triangles of the scene, uint."},
    {"frame.time", "any",
     "Seconds, by `frames_per_second` of `--motion`, else 60 frames a second; in `view` and in a "
     "host by the clock."},
    {"frame.first", "any",
     "1 in the first frame, and in a host's first frame after a resize: resources with `history` "
     "are zero; else 0. uint."},
    {"frame.previous_camera", "any",
     "`View` of the camera in the frame before, without jitter; where `frame.first` is 1, of this "
     "frame."},
    {"frame.jitter", "any",
     "vec2: pixels by which the spec's `jitter` moves the camera's picture, -0.5 to 0.5; else 0. "
     "`camera.projection`, `view_projection` and `inverse_view_projection` have it. NDC without it "
     "is NDC minus `2 * frame.jitter / vec2(frame.width, frame.height)`."},
    {"View view", "`draw: scene`", "`camera` or `light_view`, by the pass's `view`."},
    {"View.view", "any", "World to view space, mat4."},
    {"View.projection", "any", "View to clip space, mat4."},
    {"View.view_projection", "any", "World to clip space, mat4."},
    {"View.inverse_view_projection", "any", "Clip to world space, mat4."},
    {"View.position", "any", "Eye."},
    {"View.direction", "any", "Unit vector into the view."},
    {"View.near_plane", "any", "Distance of depth 0."},
    {"View.far_plane", "any", "Distance of depth 1."},
    {"Light.kind", "any", "0 directional, 1 spot."},
    {"Light.position", "any", "Spot: its place."},
    {"Light.direction", "any", "Unit vector along which light travels."},
    {"Light.color", "any", "Directional: irradiance, W/m2; spot: intensity on the axis, W/sr."},
    {"Light.area", "any",
     "Directional: area that the light view covers, m2; spot: of its image plane at distance 1."},
    {"Light.cos_inner", "any", "Spot: cosine of the angle of full intensity."},
    {"Light.cos_outer", "any", "Spot: cosine of the angle beyond which it is dark."},
    {0},
};

static const struct body_name scene_names[] = {
    {"SceneVertex scene_vertices[]", "`reads: [scene_vertices]`",
     "Vertices of the scene. On CPU drivers a texel buffer: read an element by its index, or "
     "`scene_vertices.length()`."},
    {"uint scene_indices[]", "`reads: [scene_indices]`",
     "Three indices for each triangle, stored in the same way."},
    {"SceneMaterial scene_materials[]", "`draw: scene`, or `reads: [scene_materials]`",
     "Materials."},
    {"SceneObject scene_objects[]", "`reads: [scene_objects]`",
     "Objects of the scene: a mesh of one material in one place. `scene_objects.length()` of "
     "them."},
    {"uint scene_object(uint triangle)", "`reads: [scene_objects]`",
     "Index into `scene_objects` of a triangle, by bisection."},
    {"sampler2DArray scene_textures", "`draw: scene`, or `reads: [scene_textures]`",
     "Textures, a layer each, linear colour when read."},
    {"vec4 scene_texture(vec2 uv, int layer)", "fragment, `draw: scene`",
     "Linear colour and alpha of a texture; white for layer -1."},
    {"SceneVertex.px", "any", "Position: `px`, `py`, `pz`."},
    {"SceneVertex.nx", "any", "Unit normal: `nx`, `ny`, `nz`."},
    {"SceneVertex.u", "any", "Texture coordinates: `u`, `v`."},
    {"SceneVertex.material", "any", "Index into `scene_materials`."},
    {"SceneVertex.triangle", "any", "Number of the triangle that has the vertex first."},
    {"SceneMaterial.albedo", "any", "Linear, 0 to 1; multiplies the texture."},
    {"SceneMaterial.texture_layer", "any", "Layer of `scene_textures`, or -1."},
    {"SceneMaterial.emission", "any", "Emitted radiance."},
    {"SceneMaterial.alpha_cutoff", "any", "Texture alpha below it is a hole; 0: opaque."},
    {"SceneObject.transform", "any",
     "mat4 from the mesh's own space to the scene. Vertices are in the scene already."},
    {"SceneObject.inverse", "any", "Its inverse; zero if there is none."},
    {"SceneObject.center", "any", "Centre of the box around the object."},
    {"SceneObject.radius", "any", "Of a sphere about the centre that holds the object."},
    {"SceneObject.first_index", "any", "Where its triangles start in `scene_indices`."},
    {"SceneObject.index_count", "any", "Indices of its triangles."},
    {"SceneObject.material", "any", "Index into `scene_materials`."},
    {"SceneObject.mesh", "any", "Objects with the same number are instances of one mesh."},
    {0},
};

static const struct body_name resource_names[] = {
    {"NAME[i]", "buffer", "Element `i`. A buffer of a struct has its fields: `vpls[i].flux`."},
    {"NAME_count", "buffer, point set", "Elements of a buffer, points of a point set; int."},
    {"NAME(p)", "image in `reads` or `updates`",
     "Texel at `ivec2 p`, or `ivec3` with the layer behind, or in a 3D image; vec4, uvec4 or ivec4 "
     "by the format, float for depth. Beyond the edge it is undefined. A cube read by texel and by "
     "direction needs two accesses, one without `sampler`."},
    {"ivec2 NAME_size()", "image",
     "Width and height of the mip that `NAME(p)` reads; ivec3 of a 3D image."},
    {"NAME_store(p, value)", "compute, image in `writes` or `updates`",
     "Writes a texel. Integers beyond those of an 8 or 16 bit format become the nearest one."},
    {"NAME_atomicAdd(p, value)", "compute, image in `updates` of format r32ui or r32i",
     "Adds to a texel, uint or int, and gives the former value; also `atomicMin`, `atomicMax`, "
     "`atomicAnd`, `atomicOr`, `atomicXor`, `atomicExchange`. Elements of buffers have GLSL's: "
     "`atomicAdd(NAME[i], value)`. Integers that one of these functions leaves do not depend on "
     "the order of the invocations. Results of exchanges, of different functions on one texel, "
     "former values and sums of floats do."},
    {"NAME_atomicCompSwap(p, expected, value)", "the same",
     "Stores the value if the texel is as expected; depends on the order."},
    {"NAME", "fragment, image in `writes`",
     "The target, to assign; depth targets are written by the rasterizer alone."},
    {"NAME_sample(uv)", "image in `reads` with a `sampler`",
     "Filtered at `vec2 uv`, or `vec3` with the layer behind, or in a 3D image. A cube takes a "
     "`vec3` direction, an array of cubes a `vec4` with the cube's index behind; filtering crosses "
     "the edges of faces."},
    {"NAME_sample_lod(uv, lod)", "the same without `mip`", "Filtered at a mip level."},
    {"NAME_compare(uv, reference)", "depth image with a `compare` sampler",
     "Share of texels that pass the comparison, 0 to 1."},
    {"NAME_texture", "image in `reads`",
     "The GLSL sampler itself, for functions not listed here, such as `textureGather`. A second "
     "access of the pass to the same image is `NAME_texture_1`, and so on."},
    {"NAME_image", "compute, image in `updates`, or in `writes`",
     "The GLSL image itself; numbered likewise."},
    {"for (TYPE v : NAME) { }", "compute, `ranges`",
     "Runs over a range's elements. The body cannot leave it by break, continue or return."},
    {0},
};

static const struct body_name function_names[] = {
    {"vec2 NAME(int k)", "point set in `uses`",
     "Point `k`, in the unit square or, with `map`, on the unit disk."},
    {"vec2 NAME_map(vec2 u)", "point set with `map`", "The same map of any point of the square."},
    {"float NAME(pa, na, pb, nb)", "metric in `uses`", "Distance of two positions with normals."},
    {"float NAME(a, b)", "metric in `uses`",
     "The same of two structs that have the metric's fields, and that buffers of the pass have."},
    {"ivec2 NAME_tile", "interleave", "Size of the tile."},
    {"int NAME_classes", "interleave", "Classes: texels of the tile."},
    {"int NAME_class(ivec2 p)", "interleave", "Class of a pixel."},
    {"ivec2 NAME_split(ivec2 p, ivec2 size)", "interleave",
     "Where a pixel of an image of that size lies in split order."},
    {"ivec2 NAME_gather(ivec2 q, ivec2 size)", "interleave", "The inverse of `NAME_split`."},
    {"ivec2 NAME_class_size(int class_index, ivec2 size)", "interleave", "Pixels of a class."},
    {"vec2 hammersley(int k, int n)", "any", "Point `k` of `n` in the unit square."},
    {"vec2 polar_disk(vec2 u)", "any", "Unit square to unit disk, by polar coordinates."},
    {"vec2 concentric_disk(vec2 u)", "any", "Unit square to unit disk, concentric."},
    {"tile_class(p, tile)", "any", "`NAME_class` of any tile."},
    {"tile_split(p, size, tile)", "any", "`NAME_split` of any tile."},
    {"tile_gather(q, size, tile)", "any", "`NAME_gather` of any tile."},
    {"tile_class_size(class_index, size, tile)", "any", "`NAME_class_size` of any tile."},
    {"tile_offset(class_index, tile)", "any", "First pixel of a class."},
    {"metric_one_minus_dot(pa, na, pb, nb, position, normal)", "any",
     "A metric of any weights, `position` per metre; the term of normals is 1 - max(na . nb, 0)."},
    {"metric_dot(pa, na, pb, nb, position, normal)", "any", "The same with max(na . nb, 0)."},
    {0},
};

static const struct body_name approximate_names[] = {
    {"float approximate_reciprocal_estimate(float y)", "any",
     "1 / y within 3e-6, for normal y up to 2^64."},
    {"float approximate_reciprocal(float y)", "any", "1 / y within 2 ulp."},
    {"approximate_divide(x, float y)", "any", "x / y within 2 ulp, for float and vectors."},
    {"float approximate_root_estimate(float x)", "any",
     "1 / sqrt(x) within 2e-5, for positive normal x."},
    {"approximate_inversesqrt(x)", "any", "Within 2 ulp, for float and vectors."},
    {"approximate_sqrt(x)", "any", "Within 2 ulp, for float and vectors."},
    {"approximate_normalize(v)", "any", "Unit vector, within 4 ulp."},
    {"float approximate_max(float x, float least)", "any",
     "max(x, least), for x that is no NaN and least from 0 on."},
    {"float approximate_clamp(float x, float most)", "any", "clamp(x, 0.0, most) for the same."},
    {"int approximate_int(float x)", "any", "int(x) for whole numbers up to 2^22."},
    {0},
};

static const struct body_name other_names[] = {
    {"PI", "any", "float."},
    {"COMPUTE", "`#ifdef`", "Defined in compute stages."},
    {"VERTEX", "`#ifdef`", "Defined in vertex stages."},
    {"FRAGMENT", "`#ifdef`", "Defined in fragment stages."},
    {"OPENGL", "`#ifdef`", "Defined for OpenGL."},
    {"VULKAN", "`#ifdef`",
     "Defined for Vulkan. A body that names VULKAN or OPENGL is compiled for each API; of others, "
     "OpenGL's SPIR-V is made from Vulkan's."},
    {"EXACT", "`#ifdef`", "Defined unless `exactness: fast`."},
    {0},
};

static const struct body_group groups[] = {
    {"Where an invocation stands",
     "A body is one file with a `main` for each stage, parted by `#ifdef VERTEX` and `#ifdef "
     "FRAGMENT`. A fullscreen draw may leave the vertex part out.",
     place_names},
    {"The frame",
     "A pipeline that does not use the scene runs without `--scene`. Then the camera looks from "
     "(0, 0, 4) at the origin, light of 1 W/m2 falls straight down, and the scene is a box from -1 "
     "to 1 without triangles.",
     frame_names},
    {"The scene", "", scene_names},
    {"Buffers, images and ranges",
     "NAME is the resource's, or what the pass calls it with `as`. A pass sees what it lists.",
     resource_names},
    {"Point sets, metrics, interleaves", "Those that the pass lists in `uses`.", function_names},
    {"Cheap functions",
     "For loops that need no last bit, or whose arguments lie in known ranges: the same bits on "
     "every device, at less than half of the operations of `/` and `sqrt`, which round correctly, "
     "and of `max`, `clamp` and `int`. With `exactness: fast`, the device's.",
     approximate_names},
    {"Parameters, constants, structs and macros",
     "Parameters and constants are there by their names, of the type that the spec gives them; a "
     "constant is an int. So are structs. The pass's `defines` are macros of integer literals. "
     "`#include \"FILE\"` looks beside the including file, then in templates and templates/glsl. A "
     "body may declare any name itself, also one of this chapter, but for names of the spec that "
     "the pass lists. Without `exactness: fast`, `/` and `sqrt` round to nearest, as `+ - *` do; "
     "the other built-in functions whose result depends on the driver are those of "
     "templates/glsl/exact.glsl: `inversesqrt` within 2 ulp, other functions of one number within "
     "4, `sin` and `cos` for |x| up to 65536, `tan` up to 8192. Inputs below 2^-126 count as zero. "
     "Float to integer saturates, NaN gives 0; shifts take the low five bits of their count; `pow` "
     "of a negative number is defined for whole exponents; `min` and `max` with NaN give the first "
     "operand. Constant expressions are glslang's: in double precision, rounded once.",
     other_names},
};

void emit_body_reference(struct text *out)
{
    text_add(out, "\n<a id=\"body\"></a>\n## What a body sees\n\n"
                  "A pass body is plain GLSL 4.60. The generator declares what the body names; "
                  "what it does not name is left out.\n\n"
                  "Orientation is the same on both backends. Clip space has depth 0 to 1. Row 0 of "
                  "an image is NDC y = -1, column 0 is NDC x = -1: texel (0, 0) covers uv from (0, "
                  "0) on, and `2 * (p + 0.5) / NAME_size() - 1` is a texel's NDC. PNG and EXR "
                  "files are written with the last row on top.\n\n"
                  "Mips: `NAME(p)`, `NAME_size()` and `NAME_store` see the access's `mip`, 0 "
                  "without one. With a `sampler` and no `mip`, `NAME_sample` picks the mip by "
                  "derivatives in fragment stages and reads mip 0 in others. Several mips or "
                  "layers of an image that a pass reads alike need a name each, by `as`, and have "
                  "their own size and functions. A pass may read one mip and write another, also "
                  "by a draw. An access with a `layer` sees a plain image. Layers of a cube are "
                  "its faces; column and row of a face are those of OpenGL and Vulkan.\n");
    for (size_t i = 0; i < DT_ARRAY_COUNT(groups); i++) {
        text_add(out, "\n### %s\n\n%s%s| name | where | meaning |\n|---|---|---|\n",
                 groups[i].title, groups[i].doc, *groups[i].doc ? "\n\n" : "");
        for (const struct body_name *name = groups[i].names; name->name; name++)
            text_add(out, "| `%s` | %s | %s |\n", name->name, name->where, name->doc);
    }
}
