/* Paraboloid maps (Heidrich, Seidel 1998), all clusters in layered draws. The pass binds the maps'
 * eyes as `views`. Includers define MAP_SIZE, texels per side; map_of(k) and first_triangle(k) of
 * the instance k; and in their fragment part write_texel(reach, number), which stores a texel.
 *
 * The projection is uv = d.xy / (1 + d.z) for the unit direction d in the cluster's frame, written
 * with the homogeneous coordinate |d| + d.z so that clipping at the horizon and the interpolation
 * of positions stay linear in space.
 *
 * Only corners are projected, so triangles are still bent. Therefore the texel's own direction is
 * intersected with the plane of the triangle: where neighbours share a plane, the stored distance
 * is that of an exact map, however coarse the triangles.
 *
 * Most triangles are smaller than a texel, so a fragment must be cheap. Vertices provide positions
 * in the cluster's frame, where the texel's direction is known without a transform. Maps do not
 * store normals and albedo; readers get them by the triangle's number. */

#ifdef VERTEX
layout(location = 0) out vec3 local;
layout(location = 1) out vec2 uv;
layout(location = 2) flat out float alpha_cutoff;
layout(location = 3) flat out int texture_layer;
layout(location = 4) flat out uint first_number;

void main()
{
    int c = map_of(gl_InstanceIndex);
    vec3 d = vertex_position - views[c].position;
    local = vec3(dot(d, views[c].tangent), dot(d, views[c].bitangent), dot(d, views[c].normal));
    uv = vertex_uv;
    alpha_cutoff = scene_materials[vertex_material].alpha_cutoff;
    texture_layer = scene_materials[vertex_material].texture_layer;
    first_number = first_triangle(gl_InstanceIndex) + 1u;
    float w = length(d) + local.z;
    gl_Position = vec4(local.xy, 0.5 * w, w);
    gl_ClipDistance[0] = views[c].member < 0 ? -1.0 : local.z; /* clips all of an empty cluster */
    gl_Layer = c;
}
#endif

#ifdef FRAGMENT
layout(location = 0) in vec3 local;
layout(location = 1) in vec2 uv;
layout(location = 2) flat in float alpha_cutoff;
layout(location = 3) flat in int texture_layer;
layout(location = 4) flat in uint first_number;

/* Whether the fragment is in a hole of an alpha-tested texture. Reads the nearest texel of mip 0:
 * averaged alpha would make half-open areas all hole or all solid. */
bool in_hole()
{
    bool tested = alpha_cutoff > 0.0 && texture_layer >= 0;
    ivec2 size = textureSize(scene_textures, 0).xy;
    ivec2 texel = min(ivec2(fract(uv) * vec2(size)), size - 1);
    ivec3 at = tested ? ivec3(texel, texture_layer) : ivec3(0);
    return texelFetch(scene_textures, at, 0).a < alpha_cutoff && tested;
}

/* Unit direction of this texel in the cluster's frame. Texels outside the disk look behind the
 * horizon; no lookup uses them. */
vec3 texel_direction()
{
    vec2 p = gl_FragCoord.xy * (2.0 / float(MAP_SIZE)) - 1.0;
    float s = dot(p, p);
    return vec3(2.0 * p, 1.0 - s) / (1.0 + s);
}

void main()
{
    if (in_hole())
        discard;
    vec3 normal = cross(dFdx(local), dFdy(local)); /* of the triangle; not unit, either side */
    float interpolated = length(local);
    float cut = dot(local, normal) / dot(texel_direction(), normal);
    /* False if the texel's ray runs along the plane or misses it. */
    bool sound = cut > 0.5 * interpolated && cut < 2.0 * interpolated;
    float reach = sound ? cut : interpolated;
    write_texel(reach, first_number + uint(gl_PrimitiveID));
    gl_FragDepth = clamp(reach / (2.5 * frame.scene_radius), 0.0, 1.0);
}
#endif
