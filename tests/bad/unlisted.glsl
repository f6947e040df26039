/* vpls in a comment is no use */
void main()
{
    vec3 sum = vec3(0.0);
    for (int k = 0; k < vpls_count; k++)
        sum += vpls[k].flux;
    ivec2 p = invocation().xy;
    vec4 extra = vec4(sum, 1.0);
    other_store(p, extra * near(sum, sum, sum, sum) * points(3).x * float(tile_class(p)));
    picture_store(p, extra);
}
