/* Where the map of visibility of each cluster of second-bounce VPLs is seen from. */
const int POINTS = second_total;
const int CENTRES = second_maps;

vec3 point_position(int k)
{
    return second_vpl[k].position;
}

vec3 point_normal(int k)
{
    return second_vpl[k].normal;
}

vec3 point_flux(int k)
{
    return second_vpl[k].flux;
}

float point_area(int k)
{
    return second_vpl[k].area;
}

int point_label(int k)
{
    return second_labels[k];
}

vec3 mean(int c)
{
    return second_centres[c].mean;
}

vec3 mean_normal(int c)
{
    return second_centres[c].mean_normal;
}

void keep_eye(int c, int member, vec3 position)
{
    second_views[c].member = member;
    second_views[c].position = position;
}

void keep_frame(int c, vec3 tangent, vec3 bitangent, vec3 normal)
{
    second_views[c].tangent = tangent;
    second_views[c].bitangent = bitangent;
    second_views[c].normal = normal;
}

void keep_source(int c, vec3 flux, float area)
{
    second_views[c].flux = flux;
    second_views[c].area = area;
}

#include "views.glsl"
