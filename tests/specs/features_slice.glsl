/* One layer per slab of the scene along x; gl_ClipDistance cuts what lies before it. */
#ifdef VERTEX
layout(location = 0) out vec3 where;
void main()
{
    vec3 p = (vertex_position - scene_center) / scene_radius;
    float slab = float(gl_InstanceIndex) / 3.0 - 0.5;
    gl_Layer = gl_InstanceIndex;
    gl_Position = vec4(p.xy, 0.5 + 0.5 * p.z, 1.0);
    gl_ClipDistance[0] = p.x - slab;
    where = p;
}
#endif
#ifdef FRAGMENT
layout(location = 0) in vec3 where;
void main()
{
    slices = vec4(where, length(where));
}
#endif
