/* k-means over VPLs with the metric vpl_distance (paper, Equation 2; Dong et al. 2009), by Lloyd's
 * iterations. The pass binds `points`, `labels` and `margins` (one per point), and
 * `centres`, which carry the centres from frame to frame.
 *
 * One workgroup runs all iterations. One invocation per cluster computes its sums serially, so
 * their order is fixed; ties go to the lowest index. VPLs of zero flux are ignored and have the
 * label -1.
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
shared int label[points_limit];
shared float apart[points_limit];
shared float power[points_limit];
shared uint most_apart; /* largest distance of all lanes, as bits of a float */
shared int first_apart; /* first VPL at that distance; points_count: none */

void none_apart()
{
    most_apart = 0u;
    first_apart = points_count;
}

/* Starts at last frame's mean. If there is none, or without reuse_centres, starts at one of the
 * VPLs with flux, evenly spaced in their order. */
void seed(int c)
{
    int living = 0;
    for (int k = 0; k < points_count; k++)
        living += power[k] > 0.0 ? 1 : 0;
    int wanted = (2 * c + 1) * living / (2 * centres_count);
    int chosen = 0;
    int rank = 0;
    for (int k = 0; k < points_count; k++) {
        bool lives = power[k] > 0.0;
        if (lives && rank == wanted)
            chosen = k;
        rank += lives ? 1 : 0;
    }
    bool seen = reuse_centres == 1 && frame.first == 0u && centres[c].seen != 0u;
    centre_position[c] = seen ? centres[c].mean : points[chosen].position;
    vec3 normal = unit_or(points[chosen].normal, vec3(0.0, 0.0, 1.0));
    centre_normal[c] = seen ? centres[c].mean_normal : normal;
}

void assign(int k)
{
    int nearest = 0;
    float least = 0.0;
    float second = 0.0;
    vec3 position = points[k].position;
    vec3 normal = points[k].normal;
    for (int first = 0; first < centres_count; first += kmeans_block) {
        for (int j = 0; j < kmeans_block; j++) {
            int c = first + j;
            if (c >= centres_count)
                break;
            float d = vpl_distance(position, normal, centre_position[c], centre_normal[c]);
            if (c == 0 || d < least) {
                second = least;
                least = d;
                nearest = c;
            } else if (c == 1 || d < second) {
                second = d;
            }
        }
    }
    bool lives = power[k] > 0.0;
    label[k] = lives ? nearest : -1;
    apart[k] = lives ? least : -1.0;
    margins[k] = lives && centres_count > 1 ? second - least : -1.0;
}

/* Mean of the positions, normalised sum of the normals. If normals cancel out, takes the normal of
 * the brightest member. A sum starts with its first term, not with 0.0: after unrolling, a driver
 * may turn 0.0 + x into x, which differs for x = -0.0. */
void average(int c)
{
    vec3 position = vec3(0.0);
    vec3 normal = vec3(0.0);
    vec3 dominant = centre_normal[c];
    float brightest = 0.0;
    int members = 0;
    for (int first = 0; first < points_count; first += kmeans_block) {
        for (int j = 0; j < kmeans_block; j++) {
            int k = first + j;
            if (k < points_count && label[k] == c) {
                vec3 p = points[k].position;
                vec3 n = points[k].normal;
                position = members == 0 ? p : position + p;
                normal = members == 0 ? n : normal + n;
                dominant = power[k] > brightest ? n : dominant;
                brightest = max(power[k], brightest);
                members++;
            }
        }
    }
    float count = float(max(members, 1));
    bool cancels = dot(normal, normal) < 1e-4 * count * count;
    mean_position[c] = members > 0 ? position / count : centre_position[c];
    mean_normal[c] = unit_or(cancels ? dominant : normal, centre_normal[c]);
    member_count[c] = members;
}

/* Moves an empty cluster to the VPL farthest from its centre, the first if there are several. Two
 * empty clusters take two VPLs; a cluster that finds none keeps its centre. Distances here are not
 * negative, so their bits sort like the distances. */
void reseed_empty(int lane, int lanes)
{
    for (int c = 0; c < centres_count; c++) {
        if (member_count[c] == 0) {
            int farthest = -1;
            float most = 0.0;
            for (int first = lane; first < points_count; first += kmeans_block * lanes) {
                for (int j = 0; j < kmeans_block; j++) {
                    int k = first + j * lanes;
                    if (k < points_count && apart[k] > most) {
                        most = apart[k];
                        farthest = k;
                    }
                }
            }
            if (farthest >= 0)
                atomicMax(most_apart, floatBitsToUint(most));
            barrier();
            if (farthest >= 0 && floatBitsToUint(most) == most_apart)
                atomicMin(first_apart, farthest);
            barrier();
            if (lane == 0) {
                if (first_apart < points_count) {
                    mean_position[c] = points[first_apart].position;
                    mean_normal[c] = unit_or(points[first_apart].normal, centre_normal[c]);
                    apart[first_apart] = -1.0;
                }
                none_apart();
            }
            barrier();
        }
    }
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int lanes = int(gl_WorkGroupSize.x);
    for (int k = lane; k < points_count; k += lanes)
        power[k] = points[k].flux.r + points[k].flux.g + points[k].flux.b;
    if (lane == 0)
        none_apart();
    barrier();
    if (lane < centres_count)
        seed(lane);
    barrier();
    for (int i = 0; i < kmeans_iterations; i++) {
        for (int k = lane; k < points_count; k += lanes)
            assign(k);
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
