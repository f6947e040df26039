/* Number of the triangle that a view sees, 1 + triangle, to `number`. Holes of alpha-tested textures
 * are left out. A pass of the light's view defines OF_LIGHT. Includers that define PEEL get the layer
 * behind near_position. */
#include "space.glsl"
#include "hole.glsl"

#ifdef VERTEX
layout(location = 4) flat out uint triangle;
#ifdef PEEL
layout(location = 5) flat out float depth_times_one;
#endif

vec3 corner_place(SceneVertex v)
{
    return transform_point(view.view_projection, corner_position(v)).xyw;
}

void main()
{
#ifdef OF_LIGHT
    vec2 pixels = vec2(float(rsm_size));
#else
    vec2 pixels = vec2(float(frame.width), float(frame.height));
#endif
    triangle = vertex_triangle;
    gl_Position = transform_point(view.view_projection, vertex_position);
    Triangle t = own_triangle();
    float w = pass_holes(t, gl_Position.xyw, corner_place(t.b), corner_place(t.c), pixels);
#ifdef PEEL
    depth_times_one = w;
#endif
}
#endif

#ifdef FRAGMENT
layout(location = 4) flat in uint triangle;
#ifdef PEEL
layout(location = 5) flat in float depth_times_one;
#endif

void main()
{
    float scale = hole_scale();
#ifdef PEEL
    ivec2 p = ivec2(gl_FragCoord.xy);
    if (depth_times_one * scale <= near_position(p).w + separation * frame.scene_radius ||
        near_number(p).x == triangle + 1u)
        discard;
#endif
    if (is_hole(scale, false))
        discard;
    number = uvec4(triangle + 1u, 0u, 0u, 1u);
}
#endif
