/* k-means over the first-bounce VPLs with the metric vpl_distance (paper, Equation 2; Dong et al.
 * 2009). One workgroup does all iterations. Every sum is serial in one invocation, the owner of the
 * cluster, so its order is fixed; ties go to the lowest index. VPLs of zero flux have no vote and
 * the label -1.
 *
 * Afterwards label[k] is the argmin over centres[].position and .normal, the centres that the
 * last iteration began with, and centres[].mean and .mean_normal are the means of the members so
 * labelled. Next frame begins with the means. label_margins[k] is how much farther than its own the
 * second nearest of those centres is.
 *
 * Mesa's software drivers let the loops of a shader turn 65,535 times, all of them together, and then
 * leave them (LP_MAX_TGSI_LOOP_ITERATIONS in gallivm). So long loops take a block at a turn, whose
 * loop of constant length the compiler unrolls: with every parameter at its max there are about
 * 56,000 turns. Large blocks take long to compile. */
#include "../shared/space.glsl"

shared vec3 centre_position[clusters];
shared vec3 centre_normal[clusters];
shared vec3 mean_position[clusters];
shared vec3 mean_normal[clusters];
shared int member_count[clusters];
shared int label[first_vpls];
shared float apart[first_vpls];
shared int candidate[64]; /* by lane */

const int BLOCK = 8;

float power(vec3 flux)
{
    return flux.r + flux.g + flux.b;
}

/* Last frame's mean; in the first frame, without reuse_centres, and when the light reached nothing until now, one of the
 * living VPLs, evenly spaced in their order. */
void seed(int c)
{
    int living = 0;
    for (int k = 0; k < first_vpls; k++)
        living += power(vpls[k].flux) > 0.0 ? 1 : 0;
    int wanted = (2 * c + 1) * living / (2 * clusters);
    int chosen = 0;
    int rank = 0;
    for (int k = 0; k < first_vpls; k++) {
        bool lives = power(vpls[k].flux) > 0.0;
        if (lives && rank == wanted)
            chosen = k;
        rank += lives ? 1 : 0;
    }
    bool seen = reuse_centres == 1 && centres[c].seen != 0u;
    centre_position[c] = seen ? centres[c].mean : vpls[chosen].position;
    vec3 normal = unit_or(vpls[chosen].normal, vec3(0.0, 0.0, 1.0));
    centre_normal[c] = seen ? centres[c].mean_normal : normal;
}

void assign(int k)
{
    int nearest = 0;
    float least = 0.0;
    float second = 0.0;
    for (int first = 0; first < clusters; first += BLOCK) {
        for (int j = 0; j < BLOCK; j++) {
            int c = first + j;
            if (c >= clusters)
                break;
            float d = vpl_distance(vpls[k].position, vpls[k].normal, centre_position[c],
                                   centre_normal[c]);
            if (c == 0 || d < least) {
                second = least;
                least = d;
                nearest = c;
            } else if (c == 1 || d < second) {
                second = d;
            }
        }
    }
    bool lives = power(vpls[k].flux) > 0.0;
    label[k] = lives ? nearest : -1;
    apart[k] = lives ? least : -1.0;
    label_margins[k] = lives && clusters > 1 ? second - least : -1.0;
}

/* Mean of the positions, normalised sum of the normals. Where normals cancel out, the normal of the
 * brightest member. A sum begins with its first term: 0.0 + x is x to a driver that has unrolled the
 * loop and knows the 0.0, also where x is -0.0. */
void average(int c)
{
    vec3 position = vec3(0.0);
    vec3 normal = vec3(0.0);
    vec3 dominant = centre_normal[c];
    float brightest = 0.0;
    int members = 0;
    for (int first = 0; first < first_vpls; first += BLOCK / 2) {
        for (int j = 0; j < BLOCK / 2; j++) {
            int k = first + j;
            if (k < first_vpls && label[k] == c) {
                position = members == 0 ? vpls[k].position : position + vpls[k].position;
                normal = members == 0 ? vpls[k].normal : normal + vpls[k].normal;
                float bright = power(vpls[k].flux);
                dominant = bright > brightest ? vpls[k].normal : dominant;
                brightest = max(bright, brightest);
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

/* Of the VPLs lane, lane + lanes, ..., the one that is farthest from its own centre; -1: none is
 * apart. */
int farthest_of(int lane, int lanes)
{
    int farthest = -1;
    float most = 0.0;
    for (int first = lane; first < first_vpls; first += BLOCK * lanes) {
        for (int j = 0; j < BLOCK; j++) {
            int k = first + j * lanes;
            if (k < first_vpls && apart[k] > most) {
                most = apart[k];
                farthest = k;
            }
        }
    }
    return farthest;
}

bool beats(int k, int other)
{
    if (k < 0 || other < 0)
        return k >= 0;
    return apart[k] > apart[other] || (apart[k] == apart[other] && k < other);
}

void move_to_farthest(int c, int lanes)
{
    int farthest = -1;
    for (int first = 0; first < lanes; first += BLOCK)
        for (int j = 0; j < BLOCK; j++)
            farthest = beats(candidate[first + j], farthest) ? candidate[first + j] : farthest;
    if (farthest >= 0) {
        mean_position[c] = vpls[farthest].position;
        mean_normal[c] = unit_or(vpls[farthest].normal, centre_normal[c]);
        apart[farthest] = -1.0;
    }
}

/* An empty cluster moves to the VPL that is farthest from its own centre; two of them take two
 * VPLs. One that finds none keeps its centre. */
void reseed_empty(int lane, int lanes)
{
    for (int c = 0; c < clusters; c++) {
        if (member_count[c] == 0) {
            candidate[lane] = farthest_of(lane, lanes);
            barrier();
            if (lane == 0)
                move_to_farthest(c, lanes);
            barrier();
        }
    }
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int lanes = int(gl_WorkGroupSize.x);
    if (lane < clusters)
        seed(lane);
    barrier();
    for (int i = 0; i < kmeans_iterations; i++) {
        for (int k = lane; k < first_vpls; k += lanes)
            assign(k);
        barrier();
        if (lane < clusters)
            average(lane);
        barrier();
        reseed_empty(lane, lanes);
        barrier();
        if (lane < clusters && i + 1 < kmeans_iterations) {
            centre_position[lane] = mean_position[lane];
            centre_normal[lane] = mean_normal[lane];
        }
        barrier();
    }
    for (int k = lane; k < first_vpls; k += lanes)
        labels[k] = label[k];
    if (lane < clusters) {
        int all = 0;
        for (int c = 0; c < clusters; c++)
            all += member_count[c];
        centres[lane].position = centre_position[lane];
        centres[lane].normal = centre_normal[lane];
        centres[lane].members = member_count[lane];
        centres[lane].mean = mean_position[lane];
        centres[lane].mean_normal = mean_normal[lane];
        centres[lane].seen = all > 0 ? 1u : 0u;
    }
}
