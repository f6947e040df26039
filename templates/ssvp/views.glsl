/* The view of each cluster's paraboloid map, the cluster's flux, and the surface that it stands for.
 * Includers say of which VPLs: POINTS and CENTRES, how many there are; point(k), point_label(k),
 * last_centre(c); keep_view(c, view), where results go. A mean can float in the air or
 * lie inside geometry (the paper warns of it), so the eye is the member nearest to it by the
 * metric, lifted along that member's normal; the map's axis is that normal too, since a hemisphere
 * around any other would look into the member's own surface. */
#include "../shared/space.glsl"

void main()
{
    int c = invocation().x;
    if (c >= CENTRES)
        return;
    Centre centre = last_centre(c);
    ClusterView view;
    view.position = centre.mean;
    view.normal = centre.mean_normal;
    view.flux = vec3(0.0);
    view.area = 0.0;
    view.member = -1;
    float least = 0.0;
    for (int k = 0; k < POINTS; k++) {
        if (point_label(k) != c)
            continue;
        Vpl vpl = point(k);
        view.flux += vpl.flux;
        view.area += vpl.area;
        float d = vpl_distance(vpl.position, vpl.normal, centre.mean, centre.mean_normal);
        if (view.member < 0 || d < least) {
            least = d;
            view.member = k;
            view.position = vpl.position;
            view.normal = vpl.normal;
        }
    }
    view.normal = unit_or(view.normal, vec3(0.0, 0.0, 1.0));
    tangent_frame(view.normal, view.tangent, view.bitangent);
    view.position += view.normal * (lift * frame.scene_radius);
    keep_view(c, view);
}
