/* Where the paraboloid map of each cluster of first-bounce VPLs is seen from. */
const int POINTS = first_vpls;
const int CENTRES = clusters;

Vpl point(int k)
{
    return vpls[k];
}

int point_label(int k)
{
    return labels[k];
}

Centre last_centre(int c)
{
    return centres[c];
}

void keep_view(int c, ClusterView view)
{
    cluster_views[c] = view;
}

#include "views.glsl"
