// Shared variables of one invocation.
// expect: 3 6 1
shared float cells[4];
shared struct { int n; } counter;
void main()
{
    for (int i = 0; i < 4; i++)
        cells[i] = float(i) * one;
    counter.n = 0;
    barrier();
    result[0] = cells[3];
    float sum = 0.0;
    for (int i = 0; i < cells.length(); i++)
        sum += cells[i];
    result[1] = sum;
    atomicAdd(counter.n, 1);
    memoryBarrierShared();
    result[2] = float(counter.n);
}
