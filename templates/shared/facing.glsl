/* Turns the unit normal to the side of the triangle that `to_eye` sees; winding and modelled
 * normals are not reliable. The triangle decides the side, because the interpolated normal may face
 * away at silhouettes. */
vec3 facing_normal(vec3 normal, vec3 geometric, vec3 to_eye)
{
    geometric = dot(geometric, to_eye) < 0.0 ? -geometric : geometric;
    vec3 n = unit_or(normal, unit_or(geometric, to_eye));
    float side = dot(n, geometric);
    if (side == 0.0)
        side = dot(n, to_eye);
    return side < 0.0 ? -n : n;
}
