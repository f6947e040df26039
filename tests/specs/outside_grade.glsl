/* The nearest entry of the table. */
vec3 graded(vec3 color)
{
    ivec3 at = ivec3(color * float(steps - 1) + 0.5);
    return grade(ivec2(at.b * steps + at.r, at.g)).rgb;
}

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, picture_size())))
        return;
    vec3 tint = soft_sample_lod(vec2(0.5), 2.0).rgb;
    vec3 color = weights[0] * graded(photo(p).rgb) + weights[1] * blurred(p).rgb * tint;
    picture_store(p, vec4(min(color, vec3(1)), 1));
}
