/* Clusters of second-bounce VPLs, each of which gets a map of visibility. */
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

float point_power(int k)
{
    return second_vpl[k].flux.r + second_vpl[k].flux.g + second_vpl[k].flux.b;
}

vec3 last_mean(int c)
{
    return second_centres[c].mean;
}

vec3 last_normal(int c)
{
    return second_centres[c].mean_normal;
}

uint was_seen(int c)
{
    return second_centres[c].seen;
}

void keep_label(int k, int label)
{
    second_labels[k] = label;
}

void keep_margin(int k, float margin)
{
    second_label_margins[k] = margin;
}

void keep_centre(int c, vec3 position, vec3 normal, int members, uint seen)
{
    second_centres[c].position = position;
    second_centres[c].normal = normal;
    second_centres[c].members = members;
    second_centres[c].seen = seen;
}

void keep_mean(int c, vec3 position, vec3 normal)
{
    second_centres[c].mean = position;
    second_centres[c].mean_normal = normal;
}

#include "lloyd.glsl"
