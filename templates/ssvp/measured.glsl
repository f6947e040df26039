/* Reach of the surface in a texel of a map, of the number of its triangle: where the ray through the
 * texel's centre meets the triangle. 1e30: no surface. */
#include "../shared/triangle.glsl"
#include "map.glsl"

float measured_reach(ivec3 at, uint found)
{
    if (found == 0u)
        return 1e30;
    Triangle t = triangle_of(found - 1u);
    vec3 eye = views[at.z].position;
    vec3 a = corner_position(t.a) - eye;
    vec3 b = corner_position(t.b) - eye;
    vec3 c = corner_position(t.c) - eye;
    vec3 right = views[at.z].tangent;
    vec3 up = views[at.z].bitangent;
    vec3 axis = views[at.z].normal;
    vec3 x = vec3(dot(a, right), dot(b, right), dot(c, right));
    vec3 y = vec3(dot(a, up), dot(b, up), dot(c, up));
    vec3 z = vec3(dot(a, axis), dot(b, axis), dot(c, axis));
    vec3 ray = texel_ray(vec2(at.xy) + 0.5);
    vec3 ahead = abs(ray.y) > abs(ray.x) ? (ray.y < 0.0 ? -y : y) : (ray.x < 0.0 ? -x : x);
    vec3 reaches = ahead + SLANT * z; /* of the corners, in the texel's view */
    vec3 areas = ray_areas(x - ray.x * reaches, y - ray.y * reaches);
    float sum = areas.x + areas.y + areas.z;
    vec3 weights = within_triangle(areas * (sum == 0.0 ? 0.0 : approximate_reciprocal(sum)));
    return dot(weights, reaches);
}
