// Cases of a switch from a list.
// expect: 10 200 3000 -1
#define KINDS(X) X(0, 10.0) X(1, 200.0) X(2, 3000.0)
float weigh(int kind)
{
    switch (kind) {
#define CASE(k, w) case k: return w * one;
    KINDS(CASE)
#undef CASE
    default: return -1.0;
    }
}
void main()
{
    for (int k = 0; k < 4; k++)
        result[k] = weigh(k);
}
