/* The pixel, from (0, 0), that the camera sees a point in. */
vec2 pixel_of(View from, vec3 point)
{
    vec4 clip = from.view_projection * vec4(point, 1.0);
    return (0.5 * clip.xy / clip.w + 0.5) * vec2(frame.width, frame.height);
}

/* Undoes the projection of texel p. */
vec3 unproject(ivec2 p)
{
    vec2 ndc = 2.0 * (vec2(p) + 0.5) / vec2(frame.width, frame.height) - 1.0;
    vec4 point = camera.inverse_view_projection * vec4(ndc, depth(p), 1.0);
    return point.xyz / point.w;
}

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, away_size())))
        return;
    vec2 center = vec2(p) + 0.5;
    vec4 now = seen(p), last = before(p), result = vec4(0.0);
    vec2 motion = vec2(0.0);
    if (now.w == 1.0) {
        motion = pixel_of(camera, now.xyz) - frame.jitter - pixel_of(frame.previous_camera, now.xyz);
        result.y = length(pixel_of(camera, now.xyz) - center);
        result.z = length(unproject(p) - now.xyz) / scene_radius;
        result.w = 1.0;
    }
    if (frame.first == 1u)
        result.x = length(motion);
    else if (last.w == 1.0)
        result.x = length(pixel_of(frame.previous_camera, last.xyz) + told[0].jitter - center);
    away_store(p, result);
    picture_store(p, vec4(0.5 + motion / 32.0, 0.5, 1.0));
}
