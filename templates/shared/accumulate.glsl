/* Mean of indirect light over frames: reprojection by the last frame's camera, bilinear among
 * texels that show the same plane. A surface that the last frame did not show starts anew. */
#include "space.glsl"
#include "estimate.glsl"

/* Mean of the last frame at x, with the unit normal n; alpha: number of its frames, 0 where x was
 * not seen. Texels count that are at most `tolerance` off the tangent plane, in m. A texel at NDC p
 * and depth z is away + z (slope . p - turned.z) off it, where `turned` is n in the last view. */
vec4 mean_before(vec3 x, vec3 n, float tolerance)
{
    ivec2 size = settled_size();
    vec4 clip = transform_point(frame.previous_camera.view_projection, x);
    vec2 ndc = clip.xy * reciprocal_close(max(clip.w, 1e-12));
    if (clip.w <= 0.0 || any(greaterThan(abs(ndc), vec2(1.0))))
        return vec4(0.0);
    vec2 place = (ndc * 0.5 + 0.5) * vec2(size) - 0.5;
    ivec2 corner = ivec2(floor(place));
    vec2 f = place - vec2(corner);
    mat4 to_view = frame.previous_camera.view;
    mat4 projection = frame.previous_camera.projection;
    vec3 turned = to_view[0].xyz * n.x + to_view[1].xyz * n.y + to_view[2].xyz * n.z;
    vec2 slope = turned.xy * vec2(reciprocal_close(projection[0].x),
                                  reciprocal_close(projection[1].y));
    float away = dot(n, frame.previous_camera.position - x);
    vec2 texel = vec2(reciprocal_close(float(size.x)), reciprocal_close(float(size.y)));
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int k = 0; k < 4; k++) {
        ivec2 o = ivec2(k & 1, k >> 1);
        ivec2 q = clamp(corner + o, ivec2(0), size - 1);
        float z = settled_depth(q).x;
        vec2 at = (2.0 * vec2(q) + 1.0) * texel - 1.0;
        float off_plane = abs(away + z * (dot(slope, at) - turned.z));
        float weight = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
        weight = z > 0.0 && off_plane < tolerance ? weight : 0.0;
        sum += settled(q) * weight;
        weights += weight;
    }
    return weights > 0.01 ? sum * reciprocal_close(weights) : vec4(0.0);
}

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, irradiance_size())))
        return;
    vec4 x = gbuffer_position(p);
    vec3 n = gbuffer_normal(p).xyz;
    /* Half a pixel, at the depth of x. */
    float height = float(irradiance_size().y);
    float half_pixel = x.w * reciprocal_close(frame.camera.projection[1].y * height);
    vec4 before = x.w > 0.0 ? mean_before(x.xyz, n, half_pixel) : vec4(0.0);
    float frames = min(before.a + 1.0, mean_frames[0]);
    vec3 mean = before.rgb + (irradiance(p).rgb - before.rgb) * reciprocal_close(frames);
    irradiance_store(p, vec4(mean, frames));
}
