/* Light of a VPL, and its visibility by maps, at one receiver with position x and unit normal n.
 * Used by shade_vpls.glsl and instant_radiosity/shade.glsl.
 *
 * No branches: drivers that run on CPUs then keep all values in registers. Cosines stay
 * unnormalised, so that one division serves several. Lower bounds of `closest`, m2, only guard
 * divisions. */

/* Geometry term of a VPL, 1/m2, with the receiver at distance d. Point: cos cos / d^2. Disk, on its
 * axis: cos cos / (d^2 + area / pi). Beside the axis the disk is foreshortened, and so is its area
 * here. Therefore the sum over the disks of a surface keeps most of the light in corners, which see
 * the surface edge-on, and no receiver gets a bright spot. */
float geometry_term(vec3 d, vec3 normal, float disk, vec3 n, float closest)
{
    float square = max(dot(d, d), closest);
    float leaving = max(dot(normal, d), 0.0);
    float arriving = max(-dot(n, d), 0.0);
    float distance = sqrt(square);
    return leaving * arriving * distance / (square * (square * distance + disk * leaving));
}

/* The receiver relative to an eye and its map. */
struct Sight {
    vec3 from_eye;
    float reach; /* length of from_eye */
    ivec2 texel; /* of the map */
};

/* `middle`: centre of the map in texels. A receiver behind the horizon of the map uses a texel
 * before the horizon; other members of the cluster may see such a receiver. */
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

/* The map's surface in the texel's direction, at distance `seen`, hides the receiver if it lies
 * before the receiver's tangent plane by more than `bias` times the distance. The receiver's own
 * plane never hides it, however coarse the map. Distances are compared if a receiver faces away
 * from the eye. */
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
