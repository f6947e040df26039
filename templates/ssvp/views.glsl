/* View of each cluster's map, with the area of the cluster. The pass binds its
 * inputs as `points`, `labels` and `centres`, its output as `views`. A mean can float
 * in the air or lie inside geometry (the paper warns of it). So the eye is the member nearest to
 * the mean by the metric, lifted along that member's normal. The normal is also the map's axis: any
 * other hemisphere would look into the member's own surface. Where maps are kept, later frames take
 * other members, so that the eyes of several frames spread over a cluster. */
#include "../shared/space.glsl"

/* A cluster's member with the least rank becomes its eye: 0 to 1, another order in every frame
 * (multiples of the inverse of the golden ratio, as integers of 2^-32). */
float random_rank(int k)
{
    return float((uint(k) * 2654435769u + frame.index * 3242174889u) >> 8) * (1.0 / 16777216.0);
}

/* Which points from `first` on are members, one bit each: loads that wait for none of each other. */
const int AT_ONCE = 32;
uint members_from(int first, int cluster)
{
    uint members = 0u;
    for (int i = 0; i < AT_ONCE; i++) {
        int k = min(first + i, points_count - 1);
        members |= uint(first + i == k && labels[k] == cluster) << i;
    }
    return members;
}

void main()
{
    int c = invocation().x;
    if (c >= centres_count)
        return;
    vec3 position = centres[c].mean;
    vec3 axis = centres[c].mean_normal;
    float area = 0.0;
    float least = 0.0;
    int member = -1;
    bool random = eyes_move == 1 && reuse_pattern == 0 && frame.index > 0u;
    for (int first = 0; first < points_count; first += AT_ONCE) {
        for (uint rest = members_from(first, c); rest != 0u; rest &= rest - 1u) {
            int k = first + findLSB(rest);
            area += points[k].area;
            float d = random ? random_rank(k)
                             : vpl_distance(points[k].position, points[k].normal, centres[c].mean,
                                            centres[c].mean_normal);
            if (member < 0 || d < least) {
                least = d;
                member = k;
                position = points[k].position;
                axis = points[k].normal;
            }
        }
    }
    axis = unit_or(axis, vec3(0.0, 0.0, 1.0));
    vec3 tangent, bitangent;
    tangent_frame(axis, tangent, bitangent);
    views[c].member = member;
    views[c].position = position + axis * (lift * frame.scene_radius);
    views[c].tangent = tangent;
    views[c].bitangent = bitangent;
    views[c].normal = axis;
    views[c].area = area;
}
