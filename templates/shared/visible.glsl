/* Number of the triangle that a view sees, 1 + triangle, to `number`. Holes of alpha-tested textures
 * are left out. Includers that define PEEL get the layer behind near_position. */
#include "space.glsl"

#ifdef VERTEX
layout(location = 0) out vec2 uv;
layout(location = 1) flat out float alpha_cutoff;
layout(location = 2) flat out int texture_layer;
layout(location = 3) flat out uint triangle;
#ifdef PEEL
layout(location = 4) out float depth;
#endif

void main()
{
    uv = vertex_uv;
    alpha_cutoff = scene_materials[vertex_material].alpha_cutoff;
    texture_layer = scene_materials[vertex_material].texture_layer;
    triangle = vertex_triangle;
#ifdef PEEL
    depth = dot(vertex_position - view.position, view.direction);
#endif
    gl_Position = transform_point(view.view_projection, vertex_position);
}
#endif

#ifdef FRAGMENT
#include "hole.glsl"

layout(location = 0) in vec2 uv;
layout(location = 1) flat in float alpha_cutoff;
layout(location = 2) flat in int texture_layer;
layout(location = 3) flat in uint triangle;
#ifdef PEEL
layout(location = 4) in float depth;
#endif

void main()
{
#ifdef PEEL
    ivec2 p = ivec2(gl_FragCoord.xy);
    if (depth <= near_position(p).w + separation * frame.scene_radius ||
        near_number(p).x == triangle + 1u)
        discard;
#endif
    if (is_hole(uv, texture_layer, alpha_cutoff, mip_of(uv)))
        discard;
    number = uvec4(triangle + 1u, 0u, 0u, 1u);
}
#endif
