/* Unit vector along the normal or against it, on the side of the triangle that `to_eye` sees; winding
 * and modelled normals are not reliable. The triangle decides the side, because the interpolated normal
 * may face away at silhouettes. No argument needs to be unit. */
vec3 facing_normal(vec3 normal, vec3 geometric, vec3 to_eye)
{
    geometric = dot(geometric, to_eye) < 0.0 ? -geometric : geometric;
    vec3 way = dot(geometric, geometric) > 1e-24 ? geometric : to_eye;
    vec3 n = unit_or(dot(normal, normal) > 1e-24 ? normal : way, vec3(0.0, 0.0, 1.0));
    float side = dot(n, geometric);
    if (side == 0.0)
        side = dot(n, to_eye);
    return side < 0.0 ? -n : n;
}
