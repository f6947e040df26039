void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, picture_size())))
        return;
    vec3 stripes = fract(8.0 * local(p).xyz);
    picture_store(p, vec4(local(p).w * mix(stripes, vec3(label(p).x) / 4.0, 0.5), 1.0));
}
