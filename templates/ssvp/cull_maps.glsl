/* The draws of a paraboloid map: runs of the scene's blocks that are not wholly behind the plane through
 * its eye. The pass calls the maps' eyes `views` and the draws `draws`.
 *
 * A workgroup makes the draws of a map. An invocation joins those of its own blocks that follow each
 * other to runs, and writes them behind those of the invocations before it; what is left of the map's
 * draws is empty. Triangles stay in the mesh's order, which decides between two of the same depth. */
#include "blocks.glsl"

shared int run_count[64];

void keep_draw(int k, uint index_count, uint first_index)
{
    draws[k].index_count = index_count;
    draws[k].instance_count = index_count > 0u ? 1u : 0u;
    draws[k].first_index = first_index;
    draws[k].vertex_offset = 0;
    draws[k].first_instance = uint(k);
}

bool shows(int c, int block)
{
    vec3 middle = 0.5 * (block_bounds[block].low + block_bounds[block].high);
    vec3 reach = 0.5 * (block_bounds[block].high - block_bounds[block].low);
    vec3 axis = views[c].normal;
    float nearest = dot(middle - views[c].position, axis) + dot(reach, abs(axis));
    float slack = 1e-4 * frame.scene_radius; /* more than what rounding takes off */
    return block_triangles(block).y > 0 && nearest > -slack;
}

/* Finds the runs of the blocks from `first` to before `end`; counts them, or keeps them from the draw
 * `draw` on. */
int find_runs(int c, int first, int end, int draw, bool keep)
{
    int runs = 0;
    int start = 0;
    bool open = false;
    for (int block = first; block <= end; block++) {
        bool shown = block < end && shows(c, min(block, cull_blocks - 1));
        if (shown && !open)
            start = block;
        if (!shown && open) {
            ivec2 last = block_triangles(block - 1);
            int from = block_triangles(start).x;
            if (keep)
                keep_draw(draw + runs, uint(3 * (last.x + last.y - from)), uint(3 * from));
            runs++;
        }
        open = shown;
    }
    return runs;
}

void main()
{
    int c = int(gl_WorkGroupID.x);
    int lane = int(gl_LocalInvocationIndex);
    int first = lane * lane_blocks;
    int end = views[c].member < 0 ? first : min(first + lane_blocks, cull_blocks);
    run_count[lane] = find_runs(c, first, end, 0, false);
    barrier();
    int before = 0;
    int all = 0;
    for (int k = 0; k < 64; k++) {
        before += k < lane ? run_count[k] : 0;
        all += run_count[k];
    }
    find_runs(c, first, end, c * map_draws + before, true);
    for (int k = all + lane; k < map_draws; k += 64)
        keep_draw(c * map_draws + k, 0u, 0u);
}
