/* Light of a VPL, and its visibility by maps, at one receiver with position x and unit normal n.
 * Used by shade.glsl and instant_radiosity/shade.glsl.
 *
 * No branches: drivers that run on CPUs then keep all values in registers. Cosines stay
 * unnormalised, so that one division serves several. Lower bounds of `closest`, m2, only guard
 * divisions. */
#include "../shared/estimate.glsl"
#include "map.glsl"

/* Geometry term of a VPL, 1/m2, with the receiver at distance d. Point: cos cos / d^2. Disk, on its
 * axis: cos cos / (d^2 + area / pi). Beside the axis the disk is foreshortened, and so is its area
 * here. Therefore the sum over the disks of a surface keeps most of the light in corners, which see
 * the surface edge-on, and no receiver gets a bright spot. */
float geometry_term(vec3 d, vec3 normal, float disk, vec3 n, float closest)
{
    float square = approximate_max(dot(d, d), closest);
    float leaving = approximate_max(dot(normal, d), 0.0);
    float arriving = approximate_max(dot(-n, d), 0.0);
    float below = square * square + disk * leaving * sqrt_estimate(square);
    return leaving * arriving * reciprocal_estimate(below);
}

/* The receiver relative to an eye and its map. */
struct Sight {
    vec3 from_eye;
    float reach, inverse_reach;
    vec2 texel; /* of the map */
};

/* `middle`: centre of the map in texels. A receiver behind the horizon of the map uses a texel
 * before the horizon; other members of the cluster may see such a receiver. */
Sight sight(vec3 from_eye, vec3 tangent, vec3 bitangent, vec3 axis, vec2 middle)
{
    Sight s;
    s.from_eye = from_eye;
    vec3 local =
        vec3(dot(from_eye, tangent), dot(from_eye, bitangent), approximate_max(dot(from_eye, axis), 0.0));
    s.reach = approximate_max(reach_of(local), 1e-4 * frame.scene_radius);
    s.inverse_reach = reciprocal_estimate(s.reach);
    vec2 place = local.xy * (0.5 * float(map_size) * s.inverse_reach) + middle;
    float last = float(map_size - 1);
    s.texel = vec2(floor(approximate_clamp(place.x, last)), floor(approximate_clamp(place.y, last)));
    return s;
}

ivec2 texel_of(Sight s)
{
    return ivec2(approximate_int(s.texel.x), approximate_int(s.texel.y));
}

/* Whether the map's surface in the texel's direction, of reach `seen`, hides the receiver: it lies
 * before the receiver's tangent plane by more than `bias` times the reach. The receiver's own plane
 * never hides it. The reaches are compared if a receiver faces away from the eye. */
bool is_seen(Sight s, vec3 tangent, vec3 bitangent, vec3 axis, vec3 n, float seen, float bias)
{
    float height = -dot(n, s.from_eye);
    vec3 ray = texel_ray(s.texel + 0.5);
    float across = dot(n, tangent) * ray.x + dot(n, bitangent) * ray.y + dot(n, axis) * ray.z;
    float allowed = bias * s.reach;
    float plane = height - allowed + seen * across;
    float behind = s.reach - allowed - seen;
    float before = height > 0.0 ? plane : behind;
    return before <= 0.0;
}

/* Square of the distance from the receiver to the map's surface in the texel's direction, m2. */
float square_to_surface(Sight s, float seen)
{
    float part = approximate_max(1.0 - seen * s.inverse_reach, 0.0);
    return dot(s.from_eye, s.from_eye) * (part * part);
}
