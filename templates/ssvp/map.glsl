/* Hemi-octahedral maps (Cigolle et al., "A Survey of Efficient Representations for Independent Unit
 * Vectors", JCGT 2014) of what the eye of a cluster sees: a pyramid of four perspective views over
 * a square, so lines stay lines. Vectors here are in the eye's frame: x and y along the sides of the
 * square, z along the axis.
 *
 * The reach of a point is its distance by the metric max(|x|, |y|) + z / sqrt(2), .7 to 1.23 times
 * its length. Within each view it is a linear function. */
const float SLANT = 0.70710678;

float reach_of(vec3 local)
{
    return max(abs(local.x), abs(local.y)) + SLANT * local.z;
}

/* Through the centre of a texel, of reach 1. */
vec3 texel_ray(vec2 centre)
{
    vec2 p = centre * (2.0 * approximate_reciprocal(float(map_size))) - 1.0;
    return vec3(p, (1.0 - max(abs(p.x), abs(p.y))) * (1.0 / SLANT));
}
