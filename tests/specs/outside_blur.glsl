void main()
{
    ivec2 p = invocation().xy, size = photo_size();
    if (any(greaterThanEqual(p, size)))
        return;
    vec3 sum = vec3(0);
    for (int i = 0; i < kernel_count; i++)
        sum += kernel[i] * photo(ivec2(clamp(p.x + i - reach, 0, size.x - 1), p.y)).rgb;
    blurred_store(p, vec4(sum, 1));
}
