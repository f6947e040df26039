/* A shader that names VULKAN is compiled for each API apart, for Vulkan to SPIR-V 1.5, which has a copy of structs. */
shared Integers copied;

void main()
{
    int at = invocation().x;
    Integers n = numbers[at];
    uint u = n.of[0], v = n.of[1] | 1u, w = n.of[2] & 31u;
    int a = int(n.of[3] >> 1), b = int(n.of[4] >> 1) | 1, c = int(n.of[5]);
    uint carry, borrow, high, low;
    int top, bottom;

    uint sum = uaddCarry(u, v, carry) + usubBorrow(u, v, borrow) + carry + borrow;
    umulExtended(u, v, high, low);
    imulExtended(a, c, top, bottom);
    Integers r;
    r.of[0] = u + v * w - (u / v) + (u % v) + sum;
    r.of[1] = uint(a / b + a % b - (-c));
    r.of[2] = (u >> w) ^ (u << w) ^ uint(c >> int(w));
    r.of[3] = (u | v) & ~(u & w);
    r.of[4] = bitfieldInsert(u, v, 3, 7) + bitfieldExtract(u, 2, 9) + uint(bitfieldExtract(c, 4, 6));
    r.of[5] = bitfieldReverse(u) + uint(bitCount(v));
    r.of[6] = uint(findLSB(v) + findMSB(u) * findMSB(c));
    r.of[7] = min(u, v) + max(u, w) + clamp(u, 7u, v | 8u);
    r.of[8] = uint(min(a, c) + max(a, c) + clamp(c, -9, 9) + abs(c) * sign(c));
    r.of[9] = high ^ low;
    r.of[10] = uint(top ^ bottom);
    bool less = u < v, more = a > c, same = u == w;
    bvec2 both = bvec2(less == more, less != same);
    r.of[11] = uint(any(both)) + uint(all(both)) + uint(u > v && a < c || !same) + uint(a <= c) + uint(a >= c) +
               uint(u <= v) + uint(u >= v) + uint(a != c);
    r.of[12] = less ? high : low;
    ivec4 parts = ivec4(a, b, c, at);
    parts.yw = parts.wy;
    r.of[13] = uint(parts[int(w & 3u)] + parts.zxy.x + (parts + 1)[int(u & 3u)]);
    switch (w & 3u) {
    case 0u:
        r.of[14] = u;
        break;
    case 1u:
        r.of[14] = v;
        break;
    default:
        r.of[14] = 0u;
    }
    r.of[15] = gl_LocalInvocationIndex + gl_WorkGroupID.x + gl_LocalInvocationID.x + gl_NumWorkGroups.x + gl_WorkGroupSize.x;
    if (gl_LocalInvocationIndex == 0u)
        copied = r;
    memoryBarrierShared();
    barrier();
    integers[at] = r;
    integers[at].of[3] += copied.of[9];
    counted_atomicAdd(ivec2(u & 7u, v & 7u), w);
    atomicMin(lowest[0], c);
    atomicMax(lowest[1], c);
    atomicAdd(lowest[2], c);
    atomicMin(highest[0], u);
    atomicMax(highest[1], u);
    atomicAnd(highest[2], u);
    atomicOr(highest[3], u);
    atomicXor(lowest[3], c);
}
