/* Where the map of visibility of each cluster of second-bounce VPLs is seen from. */
const int POINTS = second_total;
const int CENTRES = second_maps;

Vpl point(int k)
{
    return second_vpl[k];
}

int point_label(int k)
{
    return second_labels[k];
}

Centre last_centre(int c)
{
    return second_centres[c];
}

void keep_view(int c, ClusterView view)
{
    second_views[c] = view;
}

#include "views.glsl"
