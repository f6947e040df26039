/* Triangles of the scene by number, and where a ray meets one. Included by passes that read
 * scene_vertices and scene_indices. */
struct Triangle {
    SceneVertex a, b, c;
};

Triangle triangle_of(uint number)
{
    return Triangle(scene_vertices[scene_indices[3u * number]],
                    scene_vertices[scene_indices[3u * number + 1u]],
                    scene_vertices[scene_indices[3u * number + 2u]]);
}

vec3 corner_position(SceneVertex v)
{
    return vec3(v.px, v.py, v.pz);
}

vec3 corner_normal(SceneVertex v)
{
    return vec3(v.nx, v.ny, v.nz);
}

vec2 corner_uv(SceneVertex v)
{
    return vec2(v.u, v.v);
}

/* Twice the areas of the triangles that the ray at x = y = 0 makes with two of three corners each.
 * Divided by their sum they are the corners' weights where the ray meets their plane, correct in
 * perspective also where corners lie behind the eye (Olano, Greer 1997). x, y: of the corners, times
 * their depth where projected. */
vec3 ray_areas(vec3 x, vec3 y)
{
    return x.yzx * y.zxy - x.zxy * y.yzx;
}

/* The nearest weights within the triangle: thin triangles have uncertain weights. */
vec3 within_triangle(vec3 weights)
{
    float b = clamp(weights.y, 0.0, 1.0);
    float c = clamp(weights.z, 0.0, 1.0 - b);
    return vec3(1.0 - b - c, b, c);
}
