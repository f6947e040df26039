RWStructuredBuffer<float> meant;
ByteAddressBuffer zeros;
[numthreads(1, 1, 1)]
void main(uint i : SV_DispatchThreadID)
{
    float zero = zeros.Load(0);
    if (i == 0) {
        meant[0] = fmod(zero - 5.5, 2.0);
        meant[1] = (int(zero) - 7) % 3;
        meant[2] = ldexp(zero + 1.0, 3.0);
    }
}
