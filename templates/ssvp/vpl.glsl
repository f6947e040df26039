/* What VPLs and the eyes of their maps do to one receiver at the position x with the unit normal n, for
 * shade_vpls.glsl.
 *
 * No branch: drivers that run on CPUs then keep all in registers. Cosines stay unnormalised, so that a
 * division serves several. Lengths are bounded from below by `closest`, m2, where they only guard a
 * division. */

/* 1/m2, of a VPL from which the receiver is d away. A point's is cos cos / d^2. A disk's, on its axis, is cos
 * cos / (d^2 + area / pi); beside it the disk is seen foreshortened, and so is its area here: the sum
 * over the disks of a surface then keeps most of the light in corners, which see it from its plane,
 * and no receiver sees a spot. */
float geometry_term(vec3 d, vec3 normal, float disk, vec3 n, float closest)
{
    float square = max(dot(d, d), closest);
    float leaving = max(dot(normal, d), 0.0);
    float arriving = max(-dot(n, d), 0.0);
    float distance = sqrt(square);
    return leaving * arriving * distance / (square * (square * distance + disk * leaving));
}

/* The receiver, as an eye and its map have it. */
struct Sight {
    vec3 from_eye;
    float reach; /* its length */
    ivec2 texel; /* of the map */
};

/* `middle` is that of the map in texels. Receivers behind the horizon of the map, which members of the
 * cluster that face elsewhere can see, take the depth before it. */
Sight sight(vec3 from_eye, vec3 tangent, vec3 bitangent, vec3 axis, float closest, vec2 middle)
{
    Sight s;
    s.from_eye = from_eye;
    s.reach = sqrt(max(dot(from_eye, from_eye), closest));
    float scale = 0.5 * float(paraboloid_size) / (s.reach + max(dot(from_eye, axis), 0.0));
    vec2 place = vec2(dot(from_eye, tangent), dot(from_eye, bitangent)) * scale + middle;
    s.texel = clamp(ivec2(place), ivec2(0), ivec2(paraboloid_size - 1));
    return s;
}

/* What the map has seen in the texel's direction, `seen` away, hides the receiver when it lies before
 * the receiver's tangent plane by more than `bias` times the distance: the receiver's own plane never
 * does, however coarse the map. A receiver that faces away from the eye, but not from the VPL, is
 * compared by distance. */
bool is_seen(Sight s, vec3 tangent, vec3 bitangent, vec3 axis, vec3 n, float seen, float bias)
{
    float height = -dot(n, s.from_eye);
    vec2 p = (vec2(s.texel) + (0.5 - 0.5 * float(paraboloid_size))) * (2.0 / float(paraboloid_size));
    float q = dot(p, p);
    float across = dot(n, tangent) * p.x + dot(n, bitangent) * p.y;
    float allowed = bias * s.reach;
    float plane = (height - allowed) * (1.0 + q) + seen * (2.0 * across + dot(n, axis) * (1.0 - q));
    float distance = s.reach - allowed - seen;
    float before = height > 0.0 ? plane : distance;
    return before <= 0.0;
}
