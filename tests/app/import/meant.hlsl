RWStructuredBuffer<float> meant : register(u0);
#include "zeros.hlsli"
static float begun = 2.5;
static float twice = begun * 2.0;
float2 first = {0.25, 3}, second = 1; // defaults
uniform int third = 2;
groupshared uint sum;
[numthreads(1, 1, 1)]
void main(uint i : SV_DispatchThreadID)
{
    float zero = zeros.Load(0);
    if (i == 0) {
        meant[0] = fmod(zero - 5.5, 2.0);
        meant[1] = (int(zero) - 7) % 3;
        meant[2] = ldexp(zero + 1.0, 3.0);
        meant[3] = begun + twice;
        sum = 4;
        InterlockedMax(sum, 3);
        InterlockedAdd(sum, 5);
        meant[4] = sum;
        meant[5] = first.y + second.x * 10 + third * 100;
        meant[6] = select(or(zero > 1, and(sum > 8, true)), select(first < 1, first, second).x, 7);
        uint size;
        zeros.GetDimensions(size);
        meant[7] = size / 65536 + ((uint2(2, 1) + zeros.Load(4)) << 33).x;
        uint64_t wide = sum;
        wide = wide << 40;
        meant[8] = uint(wide >> 39);
    }
}
