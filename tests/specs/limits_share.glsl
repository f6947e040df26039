shared uint heap[words];

void main()
{
    int i = int(gl_LocalInvocationIndex);
    heap[i] = uint(i);
    barrier();
    sums[i] = heap[63 - i];
}
