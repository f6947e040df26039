/* Paraboloid maps (Heidrich, Seidel 1998) of numbers of triangles, `number`, all eyes in layered
 * draws. The pass binds the maps' eyes as `views`.
 *
 * The projection is uv = d.xy / (1 + d.z) for the unit direction d in the cluster's frame, written
 * with the homogeneous coordinate |d| + d.z so that clipping at the horizon and the interpolation
 * of positions stay linear in space.
 *
 * Most triangles are smaller than a texel, so a fragment must be cheap. Vertices provide positions
 * in the cluster's frame, in lengths of 8 scene radii, where the texel's direction is known without a
 * transform. Depth is that of the triangle's plane along the texel's direction, as reach.glsl has it,
 * times the length of texel_ray, at most 3. */

#ifdef VERTEX
layout(location = 0) out vec3 local;
layout(location = 1) out vec2 uv;
layout(location = 2) flat out float alpha_cutoff;
layout(location = 3) flat out int texture_layer;
layout(location = 4) flat out uint triangle;

void main()
{
    int c = gl_InstanceIndex;
    vec3 d = vertex_position - views[c].position;
    local = vec3(dot(d, views[c].tangent), dot(d, views[c].bitangent), dot(d, views[c].normal));
    uv = vertex_uv;
    alpha_cutoff = scene_materials[vertex_material].alpha_cutoff;
    texture_layer = scene_materials[vertex_material].texture_layer;
    triangle = vertex_triangle;
    float w = length(d) + local.z;
    gl_Position = vec4(local.xy, 0.5 * w, w);
    gl_ClipDistance[0] = views[c].member < 0 ? -1.0 : local.z; /* clips all of an empty cluster */
    local *= 0.125 / frame.scene_radius;
    gl_Layer = c;
}
#endif

#ifdef FRAGMENT
#include "../shared/hole.glsl"
#include "texel.glsl"

layout(location = 0) in vec3 local;
layout(location = 1) in vec2 uv;
layout(location = 2) flat in float alpha_cutoff;
layout(location = 3) flat in int texture_layer;
layout(location = 4) flat in uint triangle;

void main()
{
    /* Averaged alpha of a mip would make half-open areas all hole or all solid. */
    if (is_hole(uv, texture_layer, alpha_cutoff, 0))
        discard;
    vec3 normal = cross(dFdx(local), dFdy(local)); /* of the triangle; not unit, either side */
    vec3 ray = texel_ray(gl_FragCoord.xy);
    float interpolated = dot(local, ray);
    float cut = dot(local, normal) * dot(ray, ray) / dot(ray, normal);
    bool sound = cut > 0.5 * interpolated && cut < 2.0 * interpolated;
    number = uvec4(triangle + 1u, 0u, 0u, 1u);
    gl_FragDepth = clamp(sound ? cut : interpolated, 0.0, 1.0);
}
#endif
