/* Numbers of the triangles that the eyes of clusters see, `number`, all maps in layered draws. See
 * map.glsl. The pass binds the eyes as `views`.
 *
 * A triangle within one view of the pyramid is drawn once: each corner finds its view. A triangle
 * across views is drawn by four more instances, each for one view. Clip planes leave out most of the
 * other views and what lies behind the eye, the texel decides: of huge near triangles SwiftShader
 * clips up to a quarter too much. All of an empty cluster is clipped.
 * Depth is a constant / reach, which keeps the precision of far surfaces. */

#include "../shared/hole.glsl"

#ifdef VERTEX
#include "map.glsl"

layout(location = 4) flat out uint triangle;
layout(location = 5) flat out int face; /* 0: of the corner; else x, -x, y, -y */

vec3 local_of(vec3 position, int c)
{
    vec3 d = position - views[c].position;
    return vec3(dot(d, views[c].tangent), dot(d, views[c].bitangent), dot(d, views[c].normal));
}

void main()
{
    int c = gl_InstanceIndex / 5;
    face = gl_InstanceIndex % 5;
    vec3 local = local_of(vertex_position, c);
    triangle = vertex_triangle;
    bool turned = face == 0 ? abs(local.y) > abs(local.x) : face > 2;
    float ahead = turned ? local.y : local.x;
    float beside = turned ? local.x : local.y;
    bool back = face == 0 ? ahead < 0.0 : (face & 1) == 0;
    ahead = back ? -ahead : ahead;
    float reach = ahead + SLANT * local.z;
    gl_Position = vec4(local.xy, 1e-6 * frame.scene_radius, reach);
    gl_ClipDistance[0] = views[c].member < 0 ? -1.0 : local.z + 0.5 * ahead;
    gl_ClipDistance[1] = 1.5 * ahead - beside;
    gl_ClipDistance[2] = 1.5 * ahead + beside;
    gl_Layer = c;
    Triangle t = own_triangle();
    vec3 b = local_of(corner_position(t.b), c);
    vec3 e = local_of(corner_position(t.c), c);
    float turn = back ? -1.0 : 1.0;
    pass_holes(t, gl_Position.xyw, vec3(b.xy, (turned ? b.y : b.x) * turn + SLANT * b.z),
               vec3(e.xy, (turned ? e.y : e.x) * turn + SLANT * e.z), vec2(float(map_size)));
}
#endif

#ifdef FRAGMENT
layout(location = 4) flat in uint triangle;
layout(location = 5) flat in int face;

void main()
{
    /* Averaged alpha of a mip would make half-open areas all hole or all solid. */
    vec2 p = gl_FragCoord.xy - 0.5 * float(map_size);
    float ahead = face > 2 ? p.y : p.x;
    float beside = face > 2 ? p.x : p.y;
    bool other = abs(beside) > ((face & 1) == 0 ? -ahead : ahead);
    if ((face > 0 && other) || is_hole(hole_scale(), true))
        discard;
    number = uvec4(triangle + 1u, 0u, 0u, 1u);
}
#endif
