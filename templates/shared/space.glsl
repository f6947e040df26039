/* Points through matrices, unit vectors and frames. Included by every body of the shipped pipelines
 * that needs geometry. Products with a matrix are written out by columns, which fixes the order of
 * the sum on every driver. */
vec4 transform_point(mat4 m, vec3 p)
{
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}

/* Unit vector along v, or `otherwise` where v has no direction. */
vec3 unit_or(vec3 v, vec3 otherwise)
{
    float square = dot(v, v);
    return square > 1e-24 ? v * approximate_inversesqrt(square) : otherwise;
}

/* Two unit vectors that make a right-handed frame with the unit vector n (Duff et al. 2017,
 * "Building an Orthonormal Basis, Revisited", listing 3): no branch and no singular direction. */
void tangent_frame(vec3 n, out vec3 tangent, out vec3 bitangent)
{
    float side = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -approximate_reciprocal(side + n.z);
    float b = n.x * n.y * a;
    tangent = vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    bitangent = vec3(b, side + n.y * n.y * a, -n.y);
}
