void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, picture_size())))
        return;
    vec3 c = vec3(p.x % 16, p.y, p.x / 16) * (1.0 / 15.0);
    vec3 s = mix(c, c * c * (3.0 - 2.0 * c), 0.35);
    float y = dot(s, vec3(0.2126, 0.7152, 0.0722));
    vec3 tint = vec3(1.0, 0.0, -1.0) * (0.25 * (2.0 * y - 1.0)) * s * (1.0 - s);
    picture_store(p, vec4(clamp(s + tint, 0.0, 1.0), 1.0));
}
