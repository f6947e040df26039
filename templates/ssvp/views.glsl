/* The view of each cluster's paraboloid map, the cluster's flux, and the surface that it stands for.
 * Includers say of which VPLs: POINTS and CENTRES, how many there are; point_position(k), point_normal(k),
 * point_flux(k), point_area(k) and point_label(k), a VPL; mean(c) and mean_normal(c); keep_eye(c, member,
 * position), keep_frame(c, tangent, bitangent, normal) and keep_source(c, flux, area), where results go.
 * A mean can float in the air or
 * lie inside geometry (the paper warns of it), so the eye is the member nearest to it by the
 * metric, lifted along that member's normal; the map's axis is that normal too, since a hemisphere
 * around any other would look into the member's own surface. */
#include "../shared/space.glsl"

void main()
{
    int c = invocation().x;
    if (c >= CENTRES)
        return;
    vec3 position = mean(c);
    vec3 axis = mean_normal(c);
    vec3 flux = vec3(0.0);
    float area = 0.0;
    float least = 0.0;
    int member = -1;
    for (int k = 0; k < POINTS; k++) {
        if (point_label(k) != c)
            continue;
        flux += point_flux(k);
        area += point_area(k);
        float d = vpl_distance(point_position(k), point_normal(k), mean(c), mean_normal(c));
        if (member < 0 || d < least) {
            least = d;
            member = k;
            position = point_position(k);
            axis = point_normal(k);
        }
    }
    axis = unit_or(axis, vec3(0.0, 0.0, 1.0));
    vec3 tangent, bitangent;
    tangent_frame(axis, tangent, bitangent);
    keep_eye(c, member, position + axis * (lift * frame.scene_radius));
    keep_frame(c, tangent, bitangent, axis);
    keep_source(c, flux, area);
}
