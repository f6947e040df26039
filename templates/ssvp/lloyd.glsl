/* k-means over VPLs with the metric vpl_distance (paper, Equation 2; Dong et al. 2009), by Lloyd's
 * iterations. The pass binds `points`, `labels` and `margins` (one per point), and
 * `centres`, which carry the centres from frame to frame.
 *
 * One workgroup runs all iterations. Sums are of integers, so they are the same in any order; ties go
 * to the lowest index. VPLs of zero flux are ignored and have the label -1.
 *
 * The label of a VPL is the argmin over position and normal of the centres, as they were at the
 * start of the last iteration. mean and mean_normal are the means of the members with that label;
 * the next frame starts from the means. The margin of a label is the distance to the second nearest
 * of these centres minus the distance to the nearest.
 *
 * Mesa's software drivers limit all loops of a shader together to 65,535 iterations, then leave
 * them (LP_MAX_TGSI_LOOP_ITERATIONS in gallivm). If there would be more, long loops process a block
 * per iteration (kmeans_block); the compiler unrolls the inner loop of constant length. With every
 * parameter at its max there are about 56,000 iterations. Blocks compile slowly, and so do buffer
 * reads: values that are read twice are kept. Arrays have the largest size that any number of
 * points and centres needs, so that the shader does not depend on these numbers. */
#include "../shared/space.glsl"

shared vec3 centre_position[maps_limit];
shared vec3 centre_normal[maps_limit];
shared vec3 mean_position[maps_limit];
shared vec3 mean_normal[maps_limit];
shared int member_count[maps_limit];
shared int position_sum[3 * maps_limit]; /* of members, relative to the centre, in fixed point */
shared int normal_sum[3 * maps_limit];
shared int taken[maps_limit]; /* VPL that an empty cluster moves to; points_count: none */
shared int label[points_limit]; /* -1: no flux */
shared float apart[points_limit];
shared uint most_apart; /* largest distance of all lanes, as bits of a float */
shared int first_apart; /* first VPL at that distance; points_count: none */

float power_of(int k)
{
    return points[k].flux.r + points[k].flux.g + points[k].flux.b;
}

void none_apart()
{
    most_apart = 0u;
    first_apart = points_count;
}

/* Starts at last frame's mean. If there is none, or without reuse_centres, starts at one of the
 * VPLs with flux, evenly spaced in their order. */
void seed(int c)
{
    bool seen = reuse_centres == 1 && frame.first == 0u && centres[c].seen != 0u;
    int searched = seen ? 0 : points_count; /* a loop without rounds */
    int living = 0;
    for (int k = 0; k < searched; k++)
        living += label[k] >= 0 ? 1 : 0;
    int wanted = (2 * c + 1) * living / (2 * centres_count);
    int chosen = 0;
    int rank = 0;
    for (int k = 0; k < searched; k++) {
        bool lives = label[k] >= 0;
        chosen = lives && rank == wanted ? k : chosen;
        rank += lives ? 1 : 0;
    }
    centre_position[c] = seen ? centres[c].mean : points[chosen].position;
    vec3 normal = unit_or(points[chosen].normal, vec3(0.0, 0.0, 1.0));
    centre_normal[c] = seen ? centres[c].mean_normal : normal;
}

/* One in fixed point: 2048 normals do not overflow a sum, nor do positions in scene radii. */
float fixed_one()
{
    return min(approximate_divide(536870912.0, float(points_count)), 1048576.0);
}

void clear_sums(int c)
{
    for (int i = 0; i < 3; i++) {
        position_sum[3 * c + i] = 0;
        normal_sum[3 * c + i] = 0;
    }
    member_count[c] = 0;
}

void add_member(int c, vec3 position, vec3 normal)
{
    float one = fixed_one();
    vec3 p = (position - centre_position[c]) * approximate_divide(one, frame.scene_radius);
    for (int i = 0; i < 3; i++) {
        atomicAdd(position_sum[3 * c + i], approximate_int(roundEven(p[i])));
        atomicAdd(normal_sum[3 * c + i], approximate_int(roundEven(normal[i] * one)));
    }
    atomicAdd(member_count[c], 1);
}

/* Most points of an invocation. In large workgroups, as on GPUs, it assigns four of them together:
 * independent operations hide each other's latency. */
const int most_own = points_limit / int(gl_WorkGroupSize.x);
const int together = most_own <= 8 ? 4 : 1;

/* The labels of the points first, first + lanes, ... */
void assign(int first, int lanes)
{
    vec3 position[together];
    vec3 normal[together];
    int nearest[together];
    float least[together];
    float second[together];
    for (int i = 0; i < together; i++) {
        int k = min(first + i * lanes, points_count - 1);
        position[i] = points[k].position;
        normal[i] = points[k].normal;
        nearest[i] = 0;
        least[i] = 3e38;
        second[i] = 3e38;
    }
    for (int block = 0; block < centres_count; block += kmeans_block) {
        for (int j = 0; j < kmeans_block; j++) {
            int c = block + j;
            if (c >= centres_count)
                break;
            vec3 at = centre_position[c];
            vec3 facing = centre_normal[c];
            for (int i = 0; i < together; i++) {
                float d = vpl_distance(position[i], normal[i], at, facing);
                bool nearer = d < least[i];
                second[i] = nearer ? least[i] : d < second[i] ? d : second[i];
                least[i] = nearer ? d : least[i];
                nearest[i] = nearer ? c : nearest[i];
            }
        }
    }
    for (int i = 0; i < together; i++) {
        int k = first + i * lanes;
        if (k < points_count) {
            bool lives = label[k] >= 0;
            label[k] = lives ? nearest[i] : -1;
            apart[k] = lives ? least[i] : -1.0;
            margins[k] = lives && centres_count > 1 ? second[i] - least[i] : -1.0;
            if (lives)
                add_member(nearest[i], position[i], normal[i]);
        }
    }
}

void assign_own(int lane, int lanes)
{
    if (most_own <= 2 * together) {
        assign(lane, lanes);
        if (together * lanes < points_count)
            assign(lane + together * lanes, lanes);
    } else {
        for (int first = lane; first < points_count; first += together * lanes)
            assign(first, lanes);
    }
}

/* The normal of the brightest member, the first if there are several. */
vec3 brightest_normal(int c)
{
    float most = 0.0;
    int brightest = -1;
    for (int first = 0; first < points_count; first += kmeans_block) {
        for (int j = 0; j < kmeans_block; j++) {
            int k = first + j;
            if (k < points_count && label[k] == c) {
                float power = power_of(k);
                brightest = power > most ? k : brightest;
                most = power > most ? power : most;
            }
        }
    }
    return brightest < 0 ? centre_normal[c] : points[brightest].normal;
}

/* Mean of the positions, normalised sum of the normals. If normals cancel out, takes the normal of
 * the brightest member. */
void average(int c)
{
    float one = fixed_one();
    float count = float(max(member_count[c], 1));
    vec3 position = vec3(position_sum[3 * c], position_sum[3 * c + 1], position_sum[3 * c + 2]);
    vec3 normal = vec3(normal_sum[3 * c], normal_sum[3 * c + 1], normal_sum[3 * c + 2]);
    normal *= approximate_reciprocal(one);
    if (dot(normal, normal) < 1e-4 * count * count)
        normal = brightest_normal(c);
    mean_position[c] = centre_position[c] + position * approximate_divide(frame.scene_radius, one * count);
    mean_normal[c] = unit_or(normal, centre_normal[c]);
}

/* The point of this lane that is farthest from its centre, the first if there are several; -1: none.
 * most: its distance. */
int farthest_own(int lane, int lanes, out float most)
{
    int farthest = -1;
    most = 0.0;
    if (together > 1) {
        for (int i = 0; i < most_own; i++) {
            int k = min(lane + i * lanes, points_count - 1);
            bool farther = apart[k] > most;
            farthest = farther ? k : farthest;
            most = farther ? apart[k] : most;
        }
        return farthest;
    }
    for (int first = lane; first < points_count; first += kmeans_block * lanes) {
        for (int j = 0; j < kmeans_block; j++) {
            int k = first + j * lanes;
            if (k < points_count && apart[k] > most) {
                most = apart[k];
                farthest = k;
            }
        }
    }
    return farthest;
}

/* Moves an empty cluster to the VPL farthest from its centre, the first if there are several. Two
 * empty clusters take two VPLs; a cluster that finds none keeps its centre. Distances here are not
 * negative, so their bits sort like the distances. */
void reseed_empty(int lane, int lanes)
{
    if (lane < centres_count)
        taken[lane] = points_count;
    barrier();
    for (int c = 0; c < centres_count; c++) {
        if (member_count[c] == 0) {
            float most;
            int farthest = farthest_own(lane, lanes, most);
            if (farthest >= 0)
                atomicMax(most_apart, floatBitsToUint(most));
            barrier();
            if (farthest >= 0 && floatBitsToUint(most) == most_apart)
                atomicMin(first_apart, farthest);
            barrier();
            if (lane == 0) {
                taken[c] = first_apart;
                if (first_apart < points_count)
                    apart[first_apart] = -1.0;
                none_apart();
            }
            barrier();
        }
    }
    if (lane < centres_count && taken[lane] < points_count) {
        mean_position[lane] = points[taken[lane]].position;
        mean_normal[lane] = unit_or(points[taken[lane]].normal, centre_normal[lane]);
    }
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int lanes = int(gl_WorkGroupSize.x);
    for (int k = lane; k < points_count; k += lanes)
        label[k] = power_of(k) > 0.0 ? 0 : -1;
    if (lane == 0)
        none_apart();
    barrier();
    if (lane < centres_count)
        seed(lane);
    barrier();
    for (int i = 0; i < kmeans_iterations; i++) {
        if (lane < centres_count)
            clear_sums(lane);
        barrier();
        assign_own(lane, lanes);
        barrier();
        if (lane < centres_count)
            average(lane);
        barrier();
        reseed_empty(lane, lanes);
        barrier();
        if (lane < centres_count && i + 1 < kmeans_iterations) {
            centre_position[lane] = mean_position[lane];
            centre_normal[lane] = mean_normal[lane];
        }
        barrier();
    }
    for (int k = lane; k < points_count; k += lanes)
        labels[k] = label[k];
    if (lane < centres_count) {
        int all = 0;
        for (int c = 0; c < centres_count; c++)
            all += member_count[c];
        centres[lane].position = centre_position[lane];
        centres[lane].normal = centre_normal[lane];
        centres[lane].members = member_count[lane];
        centres[lane].seen = all > 0 ? 1u : 0u;
        centres[lane].mean = mean_position[lane];
        centres[lane].mean_normal = mean_normal[lane];
    }
}
