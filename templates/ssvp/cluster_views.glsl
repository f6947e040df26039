/* The view of each cluster's paraboloid map, and the cluster's flux. A mean can float in the air or
 * lie inside geometry (the paper warns of it), so the eye is the member nearest to it by the
 * metric, lifted along that member's normal; the map's axis is that normal too, since a hemisphere
 * around any other would look into the member's own surface. */
#include "../shared/space.glsl"

void main()
{
    int c = invocation().x;
    if (c >= clusters)
        return;
    vec3 position = centres[c].mean;
    vec3 axis = centres[c].mean_normal;
    vec3 flux = vec3(0.0);
    float least = 0.0;
    int member = -1;
    for (int k = 0; k < first_vpls; k++) {
        if (labels[k] != c)
            continue;
        flux += vpls[k].flux;
        float d = vpl_distance(vpls[k].position, vpls[k].normal, centres[c].mean,
                               centres[c].mean_normal);
        if (member < 0 || d < least) {
            least = d;
            member = k;
            position = vpls[k].position;
            axis = vpls[k].normal;
        }
    }
    axis = unit_or(axis, vec3(0.0, 0.0, 1.0));
    vec3 tangent, bitangent;
    tangent_frame(axis, tangent, bitangent);
    cluster_views[c].position = position + axis * (lift * frame.scene_radius);
    cluster_views[c].member = member;
    cluster_views[c].tangent = tangent;
    cluster_views[c].bitangent = bitangent;
    cluster_views[c].normal = axis;
    cluster_views[c].flux = flux;
}
