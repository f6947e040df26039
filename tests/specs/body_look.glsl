float of_frame()
{
    float sum = frame.scene_center.x + frame.scene_radius + scene_center.y + scene_radius;
    sum += float(frame.width + frame.height + frame.index + frame.triangle_count);
    sum += frame.time + float(frame.first) + frame.jitter.x + frame.previous_camera.far_plane;
    sum += frame.camera.near_plane + frame.light_view.far_plane + float(frame.light.kind);
    sum += camera.position.x + light_view.direction.y + light.position.z + light.direction.x + light.color.g;
    return sum + light.area + light.cos_inner + light.cos_outer + amount * float(half_width);
}

float cheap(float x)
{
    vec3 unit = approximate_normalize(vec3(x, 2.0, 3.0));
    float sum = approximate_reciprocal_estimate(x) + approximate_reciprocal(x) + approximate_divide(unit, x).x;
    sum += approximate_max(x, 0.0) + approximate_clamp(x, 1.0) + float(approximate_int(floor(x)));
    return sum + approximate_root_estimate(x) + approximate_inversesqrt(x) + approximate_sqrt(unit).y;
}

#ifdef COMPUTE
void main()
{
    int i = invocation().x;
    if (i >= points_count || i >= dispatch_size().x)
        return;
    tallies_atomicAdd(ivec2(0), 1u);
    tallies_atomicCompSwap(ivec2(1, 0), 0u, 1u);
    SceneVertex v = scene_vertices[scene_indices[i % 3]];
    points[i].place = vec3(v.px, v.py, v.pz);
    points[i].facing = vec3(v.nx, v.ny, v.nz);
    Point p = points[i];
    SceneObject o = scene_objects[scene_object(v.triangle)];
    p.place += (o.transform * o.inverse * vec4(o.center, o.radius)).xyz;
    p.facing *= float(o.first_index + o.index_count + o.material + o.mesh + uint(scene_objects.length()));
    vec4 texel = textureLod(scene_textures, vec3(v.u, v.v, 0.0), 0.0) * scene_materials[v.material].alpha_cutoff;
    float apart = near(p, p) + near(p.place, p.facing, vec3(0.0), vec3(1.0, 0.0, 0.0));
    apart += metric_dot(p.place, p.facing, vec3(0.0), vec3(1.0), 0.5, 0.5);
    apart += metric_one_minus_dot(p.place, p.facing, vec3(0.0), vec3(1.0), 0.5, 0.5);
    vec2 spot = spots(i) + spots_map(vec2(0.25)) + hammersley(i, spots_count);
    spot += polar_disk(vec2(0.5)) + concentric_disk(vec2(0.5));
    corners[i] = vec4(spot, apart, of_frame()) + texel;
#if defined(EXACT) && !defined(OPENGL) && !defined(VULKAN)
    corners[i] = vec4(0.0);
#endif
}
#endif
