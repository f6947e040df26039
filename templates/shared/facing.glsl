/* Winding and modelled normals are not to be trusted: the unit normal is turned to the side of the
 * triangle that is seen from the direction `to_eye`. The triangle decides, not the interpolated
 * normal, which may face away at silhouettes. */
vec3 facing_normal(vec3 normal, vec3 geometric, vec3 to_eye)
{
    geometric = dot(geometric, to_eye) < 0.0 ? -geometric : geometric;
    vec3 n = unit_or(normal, unit_or(geometric, to_eye));
    float side = dot(n, geometric);
    if (side == 0.0)
        side = dot(n, to_eye);
    return side < 0.0 ? -n : n;
}
