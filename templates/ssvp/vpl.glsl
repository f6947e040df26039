/* What one VPL does to one receiver at the position x with the unit normal n, for shade_vpls.glsl.
 *
 * No branch: drivers that run on CPUs then keep the VPLs in registers. Cosines stay unnormalised and
 * one division serves the geometry term and the paraboloid projection. Lengths are bounded from below
 * by `closest`, m2, where they only guard a division. */

/* The receiver, as a VPL and the map of its cluster have it. */
struct Sight {
    float geometry; /* cos cos / d^2, 1/m2, softened */
    ivec3 texel;    /* of the map */
    vec3 from_eye;
    float reach;  /* its length */
};

/* The geometry term as numerator and denominator. A point's is cos cos / d^2. A disk's, on its axis, is cos
 * cos / (d^2 + area / pi); beside it the disk is seen foreshortened, and so is its area here: the sum
 * over the disks of a surface then keeps most of the light in corners, which see it from its plane,
 * and no receiver sees a spot. */
vec2 geometry_term(ClassVpl v, vec3 x, vec3 n, float closest)
{
    vec3 d = x - v.position;
    float square = max(dot(d, d), closest);
    float leaving = max(dot(v.normal, d), 0.0);
    float arriving = max(-dot(n, d), 0.0);
    float distance = sqrt(square);
    return vec2(leaving * arriving * distance, square * (square * distance + v.disk * leaving));
}

/* `middle` is that of the map in texels. Receivers behind the horizon of the map, which members of the
 * cluster that face elsewhere can see, take the depth before it. */
Sight sight(ClassVpl v, vec3 x, vec3 n, float closest, vec2 middle)
{
    Sight s;
    vec2 term = geometry_term(v, x, n, closest);
    s.from_eye = x - v.eye;
    float square = max(dot(s.from_eye, s.from_eye), closest);
    s.reach = sqrt(square);
    float w = s.reach + max(dot(s.from_eye, v.axis), 0.0);
    float reciprocal = 1.0 / (term.y * w);
    s.geometry = term.x * (w * reciprocal);
    vec2 uv = vec2(dot(s.from_eye, v.tangent), dot(s.from_eye, v.bitangent)) * (term.y * reciprocal);
    ivec2 texel = ivec2(uv * (0.5 * float(paraboloid_size)) + middle);
    s.texel = ivec3(clamp(texel, ivec2(0), ivec2(paraboloid_size - 1)), v.layer);
    return s;
}

/* 0 or 1. What the map has seen in the texel's direction, `seen` away, hides the receiver when it lies
 * before the receiver's tangent plane by more than `bias` times the distance: the receiver's own plane
 * never does, however coarse the map. A receiver that faces away from the eye, but not from the VPL, is
 * compared by distance. */
float visibility(Sight s, ClassVpl v, vec3 n, float seen, float bias)
{
    float height = -dot(n, s.from_eye);
    vec2 p = (vec2(s.texel.xy) + 0.5) * (2.0 / float(paraboloid_size)) - 1.0;
    float q = dot(p, p);
    float across = dot(n, v.tangent) * p.x + dot(n, v.bitangent) * p.y;
    float before = height * (1.0 + q) + seen * (2.0 * across + dot(n, v.axis) * (1.0 - q));
    before = height > 0.0 ? before : (s.reach - seen) * (1.0 + q);
    return before > bias * s.reach * (1.0 + q) ? 0.0 : 1.0;
}
