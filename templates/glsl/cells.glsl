/* What --sanitize knows of a dispatch, for race, flow, and content of `shared` variables; all zero when the dispatch begins.
 * First 64 words for each of 1,024 workgroups, two for each of 32 barriers: the site of the one that came first, + 2, with its path
 * above 22 bits, or 1 for the end; ~least invocation + 1 that came to the end. Then cells, of words of `shared` variables, and behind them of all that the pass stores to: content (shared variables: 0,
 * nothing; 1, a value; else its mark), the last store, the first and the last other access, and place and site of the store. */
layout(std430, @cells@) coherent buffer Diptych_cells {
    uint diptych_cells[];
};

uint diptych_group()
{
    return (gl_WorkGroupID.z * gl_NumWorkGroups.y + gl_WorkGroupID.y) * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

/* The first word of a cell. words: of all `shared` variables. */
uint diptych_shared_cell(const uint word, const uint words)
{
    uint cell = diptych_group() * words + word;
    bool beside = any(bvec3(word >= words, diptych_group() >= diptych_shared_cells / words, cell >= diptych_shared_cells));
    return mix(65536u + 6u * cell, diptych_none_at, beside);
}

uint diptych_cell(const uint at, const uint base)
{
    return mix(65536u + 6u * (diptych_shared_cells + base + at), diptych_none_at, at == diptych_none_at);
}

uint diptych_shared_read(const uint cell, const uint word, const uint number)
{
    uint content = cell == diptych_none_at ? 1u : diptych_cells[cell];
    return content == 0u ? diptych_mark(word, number) : mix(content, 0u, content == 1u);
}

void diptych_shared_write(const uint cell, const uint mark)
{
    if (cell != diptych_none_at)
        diptych_cells[cell] = max(mark, 1u);
}

/* ---- Races ----------------------------------------------------------------------------------- */

/* Barriers that the invocation has passed. */
uint diptych_epoch = 0u;

/* What the invocation has found: races, and a barrier that not all reach. */
Diptych_found diptych_raced = Diptych_found(0u, 0u, 0u, 0u, 0u, 0u, 0u), diptych_parted = Diptych_found(0u, 0u, 0u, 0u, 0u, 0u, 0u);

/* Invocations by workgroup, from 1, so that a division tells the workgroup. */
const uint diptych_local = gl_WorkGroupSize.x * gl_WorkGroupSize.y * gl_WorkGroupSize.z, diptych_last = 0x3fffffu;

uint diptych_invocation()
{
    return diptych_group() * diptych_local + gl_LocalInvocationIndex + 1u;
}

/* In the order of their places, as reports have them. */
uint diptych_place_of(const uint invocation)
{
    uint group = invocation / diptych_local, local = invocation % diptych_local;
    uvec3 size = gl_WorkGroupSize, groups = gl_NumWorkGroups, extent = diptych_extent();
    uvec3 place = diptych_place_at(uvec3(group % groups.x, group / groups.x % groups.y, group / groups.x / groups.y),
                                   uvec3(local % size.x, local / size.x % size.y, local / size.x / size.y));
    return (place.z * extent.y + place.y) * extent.x + place.x;
}

/* An access: its epoch in 10 bits, and the invocation. The invocation, if it is not this one and nothing orders the two; else
 * the last number. */
uint diptych_meets(const uint access, const uint me)
{
    uint other = access & diptych_last;
    bool foreign = other - 1u - diptych_group() * diptych_local >= diptych_local; /* of another workgroup */
    bool apart = any(bvec2(foreign, access >> 22 == (diptych_epoch & 1023u)));
    return mix(diptych_last, other, all(bvec3(access != 0u, other != me, apart)));
}

/* Inverted, the least invocation, or site + 1, of an epoch is the greatest number. */
uint diptych_upside_down(const uint access)
{
    return mix((access & 0xffc00000u) | (diptych_last - (access & diptych_last)), 0u, access == 0u);
}

/* `at`: the texel or word that both touch. The least pair is kept. */
void diptych_tell_race(const uint cell, const uint other, const uint me, const uint at)
{
    uint first = min(other, me) - 1u, second = max(other, me) - 1u, times = diptych_raced.times + 1u;
    if (other == diptych_last)
        return;
    if (diptych_raced.site == 0u || first < diptych_raced.a || (first == diptych_raced.a && second < diptych_raced.b))
        diptych_raced = Diptych_found(diptych_upside_down(diptych_cells[cell + 4u]) & diptych_last,
                                      (diptych_upside_down(diptych_cells[cell + 5u]) & diptych_last) - 1u, 0u, first, second, at,
                                      diptych_frame_size());
    diptych_raced.times = times;
}

/* words: that follow each other, of one value. */
void diptych_stores(const uint first_cell, const uint at, const uint words, const uint site, const uint what)
{
    uint me = diptych_invocation(), epoch = diptych_epoch << 22;
    if (!all(bvec2(first_cell != diptych_none_at, me < diptych_last))@single@)
        return;
    for (uint k = 0u; k < words; k++) {
        uint cell = first_cell + 6u * k;
        atomicMax(diptych_cells[cell + 4u], diptych_upside_down(epoch | (site + 1u)));
        atomicMax(diptych_cells[cell + 5u], diptych_upside_down(epoch | ((what >> 5) + 1u)));
        uint before = diptych_upside_down(atomicMax(diptych_cells[cell + 1u], diptych_upside_down(epoch | me)));
        uint first = diptych_upside_down(diptych_cells[cell + 2u]), last = diptych_cells[cell + 3u];
        diptych_tell_race(cell, min(diptych_meets(before, me), min(diptych_meets(first, me), diptych_meets(last, me))), me, at + k);
    }
}

/* A load, or an atomic operation. */
void diptych_loads(const uint first_cell, const uint at, const uint words)
{
    uint me = diptych_invocation(), access = diptych_epoch << 22 | me;
    if (!all(bvec2(first_cell != diptych_none_at, me < diptych_last))@single@)
        return;
    for (uint k = 0u; k < words; k++) {
        uint cell = first_cell + 6u * k;
        atomicMax(diptych_cells[cell + 2u], diptych_upside_down(access));
        atomicMax(diptych_cells[cell + 3u], access);
        diptych_tell_race(cell, diptych_meets(diptych_upside_down(diptych_cells[cell + 1u]), me), me, at + k);
    }
}

/* ---- Control flow ---------------------------------------------------------------------------- */

/* what: the site of a barrier; 0xffffffff: the end. path: how it came there. Told is the least invocation that has come to the end. */
void diptych_arrives(const uint what, const uint path)
{
    uint slot = 64u * diptych_group() + 2u * diptych_epoch, other = 0u, me = diptych_invocation();
    bool ends = what == 0xffffffffu;
    uint own = ends ? 1u : (what + 2u) | (path ^ path >> 10 ^ path >> 20) << 22;
    if (all(bvec2(diptych_epoch < 32u, diptych_group() < 1024u))) {
        if (ends)
            atomicMax(diptych_cells[slot + 1u], ~me);
        other = atomicCompSwap(diptych_cells[slot], 0u, own);
        me = other == 1u ? ~diptych_cells[slot + 1u] : me;
    }
    diptych_epoch++;
    if (any(bvec3(other == 0u, other == own, diptych_parted.site != 0u)))
        return;
    uint site = ends ? (other & 0x3fffffu) - 2u : what;
    diptych_parted = Diptych_found(site + 1u, site, 1u, me - 1u, 0u, 0u, 0u);
}

void diptych_passes_barrier()
{
    diptych_epoch++;
}

/* The report of the least pair is kept: of few invocations both are in the key. */
void diptych_finish_race()
{
    uint most = gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_NumWorkGroups.z * diptych_local;
    uint key = most < 65536u ? diptych_raced.a * most + diptych_raced.b : diptych_raced.a;
    diptych_raced.a = diptych_place_of(diptych_raced.a);
    diptych_raced.b = diptych_place_of(diptych_raced.b);
    diptych_report(~key, diptych_raced);
}

void diptych_finish_flow()
{
    diptych_arrives(0xffffffffu, 0u);
    diptych_report(~diptych_place_of(diptych_parted.a), diptych_parted);
}
