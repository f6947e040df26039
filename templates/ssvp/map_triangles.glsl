/* Numbers of the triangles that the eyes of clusters see, `number`, all maps in layered draws. See
 * map.glsl. The pass binds the eyes as `views`.
 *
 * A triangle within one view of the pyramid is drawn once: each corner finds its view. A triangle
 * across views is drawn by four more instances, each for one view. Clip planes leave out most of the
 * other views, the texel decides: of huge near triangles SwiftShader clips up to a quarter too much.
 * Depth is a constant / reach, which keeps the precision of far surfaces. */

#ifdef VERTEX
#include "map.glsl"

layout(location = 0) out vec2 uv;
layout(location = 1) flat out float alpha_cutoff;
layout(location = 2) flat out int texture_layer;
layout(location = 3) flat out uint triangle;
layout(location = 4) flat out int face; /* 0: of the corner; else x, -x, y, -y */

void main()
{
    int c = gl_InstanceIndex / 5;
    face = gl_InstanceIndex % 5;
    vec3 d = vertex_position - views[c].position;
    vec3 local = vec3(dot(d, views[c].tangent), dot(d, views[c].bitangent), dot(d, views[c].normal));
    uv = vertex_uv;
    alpha_cutoff = scene_materials[vertex_material].alpha_cutoff;
    texture_layer = scene_materials[vertex_material].texture_layer;
    triangle = vertex_triangle;
    bool turned = face == 0 ? abs(local.y) > abs(local.x) : face > 2;
    float ahead = turned ? local.y : local.x;
    float beside = turned ? local.x : local.y;
    bool back = face == 0 ? ahead < 0.0 : (face & 1) == 0;
    ahead = back ? -ahead : ahead;
    float reach = ahead + SLANT * local.z;
    gl_Position = vec4(local.xy, 1e-6 * frame.scene_radius, reach);
    gl_ClipDistance[0] = views[c].member < 0 ? -1.0 : local.z; /* clips all of an empty cluster */
    gl_ClipDistance[1] = 1.5 * ahead - beside;
    gl_ClipDistance[2] = 1.5 * ahead + beside;
    gl_Layer = c;
}
#endif

#ifdef FRAGMENT
#include "../shared/hole.glsl"

layout(location = 0) in vec2 uv;
layout(location = 1) flat in float alpha_cutoff;
layout(location = 2) flat in int texture_layer;
layout(location = 3) flat in uint triangle;
layout(location = 4) flat in int face;

void main()
{
    /* Averaged alpha of a mip would make half-open areas all hole or all solid. */
    vec2 p = gl_FragCoord.xy - 0.5 * float(map_size);
    float ahead = face > 2 ? p.y : p.x;
    float beside = face > 2 ? p.x : p.y;
    bool other = abs(beside) > ((face & 1) == 0 ? -ahead : ahead);
    if ((face > 0 && other) || is_hole(uv, texture_layer, alpha_cutoff, 0))
        discard;
    number = uvec4(triangle + 1u, 0u, 0u, 1u);
}
#endif
