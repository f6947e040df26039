/* Clusters of first-bounce VPLs, each of which gets a paraboloid map. */
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

float point_power(int k)
{
    return vpls[k].flux.r + vpls[k].flux.g + vpls[k].flux.b;
}

Centre last_centre(int c)
{
    return centres[c];
}

void keep_label(int k, int label)
{
    labels[k] = label;
}

void keep_margin(int k, float margin)
{
    label_margins[k] = margin;
}

void keep_centre(int c, Centre centre)
{
    centres[c] = centre;
}

#include "lloyd.glsl"
