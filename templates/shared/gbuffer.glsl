/* G-buffer, of the numbers of the triangles that the camera sees: position with the depth along the
 * view in w (0: background), unit normal turned to the camera, albedo. */
#include "space.glsl"
#include "surface.glsl"

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    uint triangle = number(p).x;
    position = vec4(0.0);
    normal = vec4(0.0);
    albedo = vec4(0.0);
    if (triangle == 0u)
        return;
    vec2 size = vec2(number_size());
    vec2 texel = 2.0 * vec2(approximate_reciprocal(size.x), approximate_reciprocal(size.y));
    Surface s =
        surface_at(triangle - 1u, (vec2(p) + 0.5) * texel - 1.0, texel, camera.view_projection);
    vec3 to_eye = camera.position - s.hit_position;
    position = vec4(s.hit_position, max(-dot(to_eye, camera.direction), 1e-12));
    normal = vec4(facing_normal(s.hit_normal, s.geometric, to_eye), 0.0);
    albedo = vec4(s.hit_albedo, 1.0);
}
