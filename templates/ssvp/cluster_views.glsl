/* Where the paraboloid map of each cluster of first-bounce VPLs is seen from. */
const int POINTS = first_vpls;
const int CENTRES = clusters;

vec3 point_position(int k)
{
    return vpls[k].position;
}

vec3 point_normal(int k)
{
    return vpls[k].normal;
}

vec3 point_flux(int k)
{
    return vpls[k].flux;
}

float point_area(int k)
{
    return vpls[k].area;
}

int point_label(int k)
{
    return labels[k];
}

vec3 mean(int c)
{
    return centres[c].mean;
}

vec3 mean_normal(int c)
{
    return centres[c].mean_normal;
}

void keep_eye(int c, int member, vec3 position)
{
    cluster_views[c].member = member;
    cluster_views[c].position = position;
}

void keep_frame(int c, vec3 tangent, vec3 bitangent, vec3 normal)
{
    cluster_views[c].tangent = tangent;
    cluster_views[c].bitangent = bitangent;
    cluster_views[c].normal = normal;
}

void keep_source(int c, vec3 flux, float area)
{
    cluster_views[c].flux = flux;
    cluster_views[c].area = area;
}

#include "views.glsl"
