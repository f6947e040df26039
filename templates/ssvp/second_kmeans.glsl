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

Centre last_centre(int c)
{
    return second_centres[c];
}

void keep_label(int k, int label)
{
    second_labels[k] = label;
}

void keep_margin(int k, float margin)
{
    second_label_margins[k] = margin;
}

void keep_centre(int c, Centre centre)
{
    second_centres[c] = centre;
}

#include "lloyd.glsl"
