/* Bounding boxes of the scene's blocks: runs of triangles that follow each other in the mesh, of one
 * length, all but the last ones. A workgroup bounds a block, every frame anew: a host may have moved it. */
#include "blocks.glsl"

shared vec3 lows[64];
shared vec3 highs[64];

void main()
{
    int block = int(gl_WorkGroupID.x);
    int lane = int(gl_LocalInvocationIndex);
    ivec2 run = block_triangles(block);
    vec3 low = vec3(1e30);
    vec3 high = vec3(-1e30);
    for (int k = 3 * run.x + lane; k < 3 * (run.x + run.y); k += 64) {
        SceneVertex v = scene_vertices[scene_indices[k]];
        low = min(low, vec3(v.px, v.py, v.pz));
        high = max(high, vec3(v.px, v.py, v.pz));
    }
    lows[lane] = low;
    highs[lane] = high;
    barrier();
    for (int stride = 32; stride > 0; stride /= 2) {
        if (lane < stride) {
            lows[lane] = min(lows[lane], lows[lane + stride]);
            highs[lane] = max(highs[lane], highs[lane + stride]);
        }
        barrier();
    }
    if (lane == 0) {
        block_bounds[block].low = lows[0];
        block_bounds[block].high = highs[0];
    }
}
