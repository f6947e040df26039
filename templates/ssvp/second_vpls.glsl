/* Second-bounce VPLs: uniform samples of the unit disk in each cluster's paraboloid map. With r the
 * distance to the centre of the disk, Phi_2 = rho Phi_C 4 (1 - r^2) / ((1 + r^2)^3 N), the solid
 * angle of a texel times the cosine of the emitter (derived in the notes on formulae from dw = 4 dA
 * / (1 + r^2)^2 and cos = (1 - r^2) / (1 + r^2)); the weights sum to 1.
 *
 * N is the same for all clusters, as in the paper, or with second_by_flux in proportion to their
 * flux, so that every VPL carries about the same: bright clusters are not left with a few VPLs when
 * there are many clusters. */
#include "reuse.glsl"

struct DiskSample {
    int cluster;
    vec2 place;   /* on the unit disk */
    float number; /* of samples that the cluster has, its N; not an integer with second_by_flux */
};

float power(vec3 flux)
{
    return flux.r + flux.g + flux.b;
}

DiskSample equal_share(int k)
{
    DiskSample drawn;
    drawn.cluster = k / second_per_cluster;
    drawn.place = disk_points(k % second_per_cluster);
    drawn.number = float(second_per_cluster);
    return drawn;
}

/* The clusters lie on a line, each as long as its power, and VPLs stand on it at equal distances.
 * Where one stands within its cluster is its first coordinate, the radical inverse of its number the
 * second: the VPLs of a cluster are a Hammersley set, however many they are. */
DiskSample share_by_flux(int k)
{
    float all = power(cluster_views[0].flux);
    for (int c = 1; c < clusters; c++)
        all += power(cluster_views[c].flux);
    float place = (float(k) + 0.5) / float(second_total) * all;
    DiskSample drawn;
    drawn.cluster = 0;
    float before = 0.0;
    float passed = 0.0;
    for (int c = 0; c < clusters; c++) {
        float length_here = power(cluster_views[c].flux);
        bool beyond = passed <= place && length_here > 0.0;
        drawn.cluster = beyond ? c : drawn.cluster;
        before = beyond ? passed : before;
        passed += length_here;
    }
    float share = power(cluster_views[drawn.cluster].flux);
    float within = share > 0.0 ? clamp((place - before) / share, 0.0, 1.0) : 0.5;
    drawn.place = disk_points_map(vec2(within, hammersley(k, second_total).y));
    drawn.number = share > 0.0 ? float(second_total) * (share / all) : 1.0;
    return drawn;
}

void main()
{
    int k = invocation().x;
    if (k >= second_total)
        return;
    DiskSample drawn = second_by_flux == 1 ? share_by_flux(k) : equal_share(k);
    int c = drawn.cluster;
    vec2 p = shift_disk(drawn.place);
    ivec2 texel = ivec2(floor((p * 0.5 + 0.5) * float(paraboloid_size)));
    texel = clamp(texel, ivec2(0), ivec2(paraboloid_size - 1));
    ivec3 at = ivec3(texel, c);
    vec4 x = paraboloid_position(at);
    vec3 n = paraboloid_normal(at).xyz;
    float s = min(dot(p, p), 1.0);
    float square = (1.0 + s) * (1.0 + s);
    float weight = 4.0 * (1.0 - s) / (square * (1.0 + s) * drawn.number);
    vec3 flux = paraboloid_albedo(at).rgb * cluster_views[c].flux * weight;
    /* The surface that this VPL stands for: dw d^2 / cos. The light comes from all of the cluster, not
     * from the map's eye alone, so nothing is nearer than the cluster is wide. Half as much again,
     * since the VPLs of one cluster are spread evenly, those of several among each other are not:
     * measured against path tracing, less leaves spots, more takes light out of corners. */
    vec3 d = cluster_views[c].position - x.xyz;
    float far = max(dot(d, d), 1e-12 * frame.scene_radius * frame.scene_radius);
    float slope = max(dot(n, d) * inversesqrt(far), 0.1);
    second_vpl[k].position = x.xyz;
    second_vpl[k].area =
        1.5 * 4.0 * max(PI * far, cluster_views[c].area) / (square * float(second_total) * slope);
    second_vpl[k].normal = n;
    second_vpl[k].flux = x.w > 0.0 ? flux : vec3(0.0); /* the light left the scene */
}
