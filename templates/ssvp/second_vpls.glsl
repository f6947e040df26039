/* Second-bounce VPLs: uniform samples of the unit disk, which is each cluster's hemisphere in
 * paraboloid projection (Heidrich, Seidel 1998), looked up in the cluster's map. With r the distance
 * to the centre of the disk, Phi_2 = rho Phi_C 4 (1 - r^2) / ((1 + r^2)^3 N), the solid
 * angle of a texel times the cosine of the emitter (derived in the notes on formulae from dw = 4 dA
 * / (1 + r^2)^2 and cos = (1 - r^2) / (1 + r^2)); the weights sum to 1.
 *
 * N is the same for all clusters, as in the paper. With second_by_flux N is proportional to the
 * cluster's flux, so that all VPLs carry similar flux: bright clusters get enough VPLs, even if
 * there are many clusters. */
#include "../shared/reuse.glsl"
#include "seen.glsl"

struct DiskSample {
    int cluster;
    vec2 place;        /* on the unit disk */
    float per_cluster; /* samples of the cluster, N; not an integer with second_by_flux */
};

float power_of_all()
{
    float all = 0.0;
    for (int c = 0; c < eyes_count; c++)
        all += eyes[c].power;
    return all;
}

DiskSample equal_share(int k)
{
    DiskSample drawn;
    drawn.cluster = k / second_per_cluster;
    drawn.place = disk_points(k % second_per_cluster);
    drawn.per_cluster = float(second_per_cluster);
    return drawn;
}

/* Clusters lie on a line, each as long as its power; VPLs lie on this line at equal distances. The
 * place within the cluster is the first coordinate, the radical inverse of the index the second. So
 * the VPLs of each cluster are a Hammersley set, whatever their number. */
DiskSample share_by_flux(int k, float all)
{
    float place = (float(k) + 0.5) / float(second_total) * all;
    DiskSample drawn;
    drawn.cluster = 0;
    float before = 0.0;
    float passed = 0.0;
    for (int c = 0; c < eyes_count; c++) {
        float length_here = eyes[c].power;
        bool beyond = passed <= place && length_here > 0.0;
        drawn.cluster = beyond ? c : drawn.cluster;
        before = beyond ? passed : before;
        passed += length_here;
    }
    float share = eyes[drawn.cluster].power;
    float within = share > 0.0 ? clamp((place - before) / share, 0.0, 1.0) : 0.5;
    drawn.place = disk_points_map(vec2(within, hammersley(k, second_total).y));
    drawn.per_cluster = share > 0.0 ? float(second_total) * (share / all) : 1.0;
    return drawn;
}

/* The map's texel in a direction of the hemisphere. */
ivec2 map_texel(vec3 local)
{
    vec2 p = approximate_divide(local.xy, reach_of(local));
    ivec2 texel = ivec2(floor((p * 0.5 + 0.5) * float(map_size)));
    return clamp(texel, ivec2(0), ivec2(map_size - 1));
}

/* N samples on the unit disk are N / pi per unit of its area, hence N (1 + s)^2 / (4 pi) per
 * steradian with s = r^2. A square metre covers cos / d^2 steradians. The whole cluster emits
 * light, not only the map's eye, so pi d^2 is at least the area of the cluster. The cosine is at
 * least a tenth. */
float samples_per_area(int c, float samples, float s, float square, float cosine)
{
    float spread = max(PI * square, eyes[c].area);
    return approximate_divide(samples * (1.0 + s) * (1.0 + s) * max(cosine, 0.1), 4.0 * spread);
}

/* Samples per m2 around x of the cluster c, which has `samples` in all. 0 if the cluster's map has
 * a surface in front of x. */
float samples_around(int c, float samples, vec3 x, vec3 n)
{
    vec3 d = x - eyes[c].position;
    float square = max(dot(d, d), 1e-12 * frame.scene_radius * frame.scene_radius);
    float inverse = approximate_inversesqrt(square);
    float far = square * inverse;
    float ahead = dot(d, eyes[c].normal);
    vec3 local = vec3(dot(d, eyes[c].tangent), dot(d, eyes[c].bitangent), max(ahead, 1e-6 * far));
    vec2 p = approximate_divide(local.xy, far + local.z);
    float seen = reach(ivec3(map_texel(local), c)).x;
    float cosine = -dot(n, d) * inverse;
    bool sees = seen < 1e29 && ahead > 0.0 && cosine > 0.0 && seen > 0.97 * reach_of(local);
    return sees ? samples_per_area(c, samples, min(dot(p, p), 1.0), square, cosine) : 0.0;
}

/* Area that a second-bounce VPL at x represents: 1 / (samples per m2 there, of all clusters).
 * `own`: samples per m2 of the VPL's own cluster. */
float area_of(int own_cluster, float own, float all, vec3 x, vec3 n)
{
    float sum = own;
    float per_power = approximate_divide(float(second_total), max(all, 1e-30));
    for (int c = 0; c < eyes_count; c++) {
        float power_here = eyes[c].power;
        float samples = second_by_flux == 1 ? power_here * per_power : float(second_per_cluster);
        bool another = c != own_cluster && power_here > 0.0;
        sum += another ? samples_around(c, samples, x, n) : 0.0;
    }
    return 1.0 / sum;
}

void main()
{
    int k = invocation().x;
    if (k >= second_total)
        return;
    float all = power_of_all();
    DiskSample drawn = second_by_flux == 1 ? share_by_flux(k, all) : equal_share(k);
    int c = drawn.cluster;
    vec2 p = shift_disk(drawn.place);
    float s = min(dot(p, p), 1.0);
    Seen seen = surface_of(ivec3(map_texel(vec3(2.0 * p, 1.0 - s)), c));
    float square = (1.0 + s) * (1.0 + s);
    float weight = 4.0 * (1.0 - s) / (square * (1.0 + s) * drawn.per_cluster);
    vec3 flux = seen.albedo * eyes[c].flux * weight;
    vec3 d = eyes[c].position - seen.position;
    float far = max(dot(d, d), 1e-12 * frame.scene_radius * frame.scene_radius);
    float own = samples_per_area(c, drawn.per_cluster, s, far, dot(seen.normal, d) * approximate_inversesqrt(far));
    second_vpl[k].position = seen.position;
    second_vpl[k].area = area_of(c, own, all, seen.position, seen.normal);
    second_vpl[k].normal = seen.normal;
    second_vpl[k].arriving = eyes[c].power / drawn.per_cluster;
    second_vpl[k].flux = seen.surface ? flux : vec3(0.0); /* the light left the scene */
}
