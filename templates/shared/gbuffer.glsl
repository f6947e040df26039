/* G-buffer, of the numbers of the triangles that the camera sees: position with the depth along the
 * view in w (0: background), unit normal turned to the camera, albedo. */
#include "space.glsl"
#include "surface.glsl"

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, position_size())))
        return;
    uint triangle = number(p).x;
    if (triangle == 0u) {
        position_store(p, vec4(0.0));
        normal_store(p, vec4(0.0));
        albedo_store(p, vec4(0.0));
        return;
    }
    vec2 texel = 2.0 / vec2(position_size());
    Surface s =
        surface_at(triangle - 1u, (vec2(p) + 0.5) * texel - 1.0, texel, camera.view_projection);
    float depth = max(dot(s.hit_position - camera.position, camera.direction), 1e-12);
    vec3 to_eye = unit_or(camera.position - s.hit_position, -camera.direction);
    position_store(p, vec4(s.hit_position, depth));
    normal_store(p, vec4(facing_normal(s.hit_normal, s.geometric, to_eye), 0.0));
    albedo_store(p, vec4(s.hit_albedo, 1.0));
}
