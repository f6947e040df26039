/* Unit direction of the centre of a map's texel in the cluster's frame. Texels outside the disk look
 * behind the horizon; no lookup uses them. */
vec3 texel_direction(vec2 centre)
{
    vec2 p = centre * (2.0 / float(paraboloid_size)) - 1.0;
    float s = dot(p, p);
    return vec3(2.0 * p, 1.0 - s) / (1.0 + s);
}
