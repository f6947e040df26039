/* Direction of the centre of a map's texel in the cluster's frame; its length is 2 - z. Texels outside
 * the disk look behind the horizon; no lookup uses them. */
vec3 texel_ray(vec2 centre)
{
    vec2 p = centre * (2.0 / float(paraboloid_size)) - 1.0;
    return vec3(2.0 * p, 1.0 - dot(p, p));
}

/* The same, unit. */
vec3 texel_direction(vec2 centre)
{
    vec3 ray = texel_ray(centre);
    return ray * (1.0 / (2.0 - ray.z));
}
