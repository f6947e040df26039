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

vec3 last_mean(int c)
{
    return centres[c].mean;
}

vec3 last_normal(int c)
{
    return centres[c].mean_normal;
}

uint was_seen(int c)
{
    return centres[c].seen;
}

void keep_label(int k, int label)
{
    labels[k] = label;
}

void keep_margin(int k, float margin)
{
    label_margins[k] = margin;
}

void keep_centre(int c, vec3 position, vec3 normal, int members, uint seen)
{
    centres[c].position = position;
    centres[c].normal = normal;
    centres[c].members = members;
    centres[c].seen = seen;
}

void keep_mean(int c, vec3 position, vec3 normal)
{
    centres[c].mean = position;
    centres[c].mean_normal = normal;
}

#include "lloyd.glsl"
