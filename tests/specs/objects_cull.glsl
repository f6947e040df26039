/* Whether a sphere reaches into the view: at each plane, its centre is less than the radius outside. */
bool is_in_view(vec3 center, float radius)
{
    mat4 rows = transpose(camera.view_projection);
    for (int i = 0; i < 3; i++) {
        vec4 low = i == 2 ? rows[2] : rows[3] + rows[i], high = rows[3] - rows[i];
        if (dot(low, vec4(center, 1.0)) < -radius * length(low.xyz) ||
            dot(high, vec4(center, 1.0)) < -radius * length(high.xyz))
            return false;
    }
    return true;
}

void main()
{
    uint i = uint(invocation().x), count = uint(scene_objects.length());
    if (i >= uint(draws_count))
        return;
    Draw draw = Draw(0u, 1u, 0u, 0, 0u);
    if (i < count && is_in_view(scene_objects[i].center, scene_objects[i].radius)) {
        draw.index_count = scene_objects[i].index_count;
        draw.first_index = scene_objects[i].first_index;
    }
    draws[i] = draw;
    if (i > 0u)
        return;
    told[0].count = count;
    for (uint k = 0u; k < 3u; k++)
        told[0].meshes[k] = scene_objects[min(k, count - 1u)].mesh;
    told[0].triangles = frame.triangle_count;
}
